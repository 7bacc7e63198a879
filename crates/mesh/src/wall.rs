//! The thickness of walls that are thinner than the tetrahedra around them.

use crate::cells::Query;
use crate::leaf::{Kind, Leaf};
use crate::proof::linear_gradient;
use crate::refine::Refined;
use rayon::prelude::*;

/// The least distance between levels of one function that are 0 in one tetrahedron, in world units:
/// an estimate. `None` without such tetrahedra.
pub fn thinnest(refined: &Refined, query: &Query<'_>) -> Option<f64> {
    let thickness = |leaf: &Leaf| {
        let Kind::Open { local, .. } = &leaf.kind else { return None };
        let parts = &local.parts;
        let pairs =
            (0..parts.len()).flat_map(|k| (0..k).map(move |j| [parts[j].part, parts[k].part]));
        let gap = |pair: [u16; 2]| {
            let [one, other] = pair.map(|part| query.levels[usize::from(part)]);
            if one.group != other.group {
                return None;
            }
            let values = |part: u16| {
                let factor = query.levels[usize::from(part)].factor;
                leaf.cell.numbers.map(|corner| refined.values.at(corner, part) / factor)
            };
            let (own, of_other) = (values(pair[0]), values(pair[1]));
            let slope = linear_gradient(&query.space.corners(&leaf.cell), &own).length();
            Some((own[0] - of_other[0]).abs() / slope).filter(|gap| gap.is_finite())
        };
        pairs.filter_map(gap).min_by(f64::total_cmp)
    };
    refined.leaves.par_iter().filter_map(thickness).min_by(f64::total_cmp)
}
