//! Triangles of polygons, so that each edge has the same corners on both sides.

use super::plane::{Line, Points};
use super::polygon::Polygon;
use num_rational::BigRational;
use rustc_hash::FxHashMap;

/// A corner of a polygon, and the edges on which it is.
#[derive(Clone, Copy)]
struct Corner {
    point: u32,
    /// The same number twice if the corner is within an edge.
    edges: [usize; 2],
}

impl Corner {
    fn is_on(&self, edge: usize) -> bool {
        self.edges.contains(&edge)
    }
}

/// Triangles of polygons. A point of one polygon that is within an edge of another becomes a corner
/// there, too.
pub fn join(polygons: &[Polygon], points: &Points) -> Vec<[u32; 3]> {
    let mut numbers: FxHashMap<Line, usize> = FxHashMap::default();
    // The points on each line, and how far they are along it.
    let mut lines: Vec<Vec<(BigRational, u32)>> = Vec::new();
    let mut of_edges: Vec<Vec<usize>> = Vec::new();
    for polygon in polygons {
        let mut own = Vec::new();
        for (k, corner) in polygon.corners.iter().enumerate() {
            let line = points.line([polygon.plane, polygon.edges[k]], *corner);
            let direction = line.0.clone();
            let next = lines.len();
            let number = *numbers.entry(line).or_insert(next);
            if number == next {
                lines.push(Vec::new());
            }
            let end = polygon.corners[(k + 1) % polygon.corners.len()];
            let both = [*corner, end].map(|point| (points.along(&direction, point), point));
            lines[number].extend(both);
            own.push(number);
        }
        of_edges.push(own);
    }
    for line in &mut lines {
        line.sort_unstable();
        line.dedup();
    }
    let places: Vec<FxHashMap<u32, usize>> = lines
        .iter()
        .map(|line| line.iter().enumerate().map(|(k, (_, point))| (*point, k)).collect())
        .collect();
    let mut triangles = Vec::new();
    for (polygon, of_edges) in polygons.iter().zip(of_edges) {
        let count = polygon.corners.len();
        let mut corners = Vec::new();
        for k in 0..count {
            let [from, to] = [k, (k + 1) % count].map(|k| polygon.corners[k]);
            corners.push(Corner { point: from, edges: [(k + count - 1) % count, k] });
            let [from, to] = [from, to].map(|point| places[of_edges[k]][&point]);
            let within =
                |place: usize| Corner { point: lines[of_edges[k]][place].1, edges: [k, k] };
            if from < to {
                corners.extend((from + 1..to).map(within));
            } else {
                corners.extend((to + 1..from).rev().map(within));
            }
        }
        divide(corners, &mut triangles);
    }
    triangles
}

/// Adds triangles of a convex polygon, each with an area. Corners may be within edges.
fn divide(mut corners: Vec<Corner>, triangles: &mut Vec<[u32; 3]>) {
    let is_flat = |some: &[Corner]| {
        let [one, other] = some[0].edges;
        [one, other].iter().any(|edge| some.iter().all(|corner| corner.is_on(*edge)))
    };
    while corners.len() > 3 {
        let count = corners.len();
        let ear = |k: &usize| {
            let [before, after] = [(k + count - 1) % count, (k + 1) % count];
            let mut rest = corners.clone();
            rest.remove(*k);
            !is_flat(&[corners[before], corners[*k], corners[after]]) && !is_flat(&rest)
        };
        let k = (0..count).find(ear).expect("a convex polygon with an area");
        let [before, after] = [(k + count - 1) % count, (k + 1) % count];
        triangles.push([before, k, after].map(|k| corners[k].point));
        corners.remove(k);
    }
    triangles.push([0, 1, 2].map(|k| corners[k].point));
}
