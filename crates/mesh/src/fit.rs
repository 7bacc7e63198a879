//! A check whether triangles fit together.

use crate::Mesh;
use glam::DVec3;
use rustc_hash::FxHashMap;

/// Distance from a face of the domain, as a share of the domain's size, that rounding may cause.
const ROUNDING: f64 = 1e-9;

/// Returns the rims, and the misfits. A rim is an edge with more triangles on one side than on the
/// other. A misfit is an edge that does not lie between two triangles of the same orientation. The
/// edges of an equation's rim are no misfits on a face of the box with the corners `ends`, or
/// between two vertices for which `may_end` is true.
pub fn fit(
    mesh: &Mesh,
    ends: [DVec3; 2],
    is_solid: bool,
    may_end: &dyn Fn(u32) -> bool,
) -> (Vec<[u32; 2]>, Vec<(DVec3, DVec3)>) {
    let mut edges: FxHashMap<[u32; 2], [u32; 2]> = FxHashMap::default();
    edges.reserve(3 * mesh.triangles.len() / 2);
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            edges.entry([from.min(to), from.max(to)]).or_default()[usize::from(from < to)] += 1;
        }
    }
    let at = |vertex: u32| mesh.vertices[vertex as usize];
    let is_misfit = |(edge, sides): &([u32; 2], [u32; 2])| {
        let is_rim = sides[0] + sides[1] == 1 && !is_solid;
        let ends_here = || edge.iter().all(|one| may_end(*one)) || is_on_face(edge.map(at), ends);
        *sides != [1, 1] && !(is_rim && ends_here())
    };
    let is_uneven = |(_, sides): &(&[u32; 2], &[u32; 2])| sides[0] != sides[1];
    let rims = edges.iter().filter(is_uneven).map(|(edge, _)| *edge).collect();
    let misfits = edges.into_iter().filter(is_misfit).map(|([a, b], _)| (at(a), at(b)));
    (rims, misfits.collect())
}

/// Returns whether both points are on one face of the box between two corners.
fn is_on_face(points: [DVec3; 2], [low, high]: [DVec3; 2]) -> bool {
    (0..3).any(|axis| {
        let near = ROUNDING * (high[axis] - low[axis]);
        [low, high].iter().any(|end| points.iter().all(|p| (p[axis] - end[axis]).abs() <= near))
    })
}
