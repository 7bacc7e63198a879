//! The edges in which triangles meet.

use rustc_hash::FxHashMap;

/// The edges of triangles.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    /// Number of edges.
    pub count: usize,
    /// True if there is an edge, and each belongs to two triangles.
    pub is_closed: bool,
    /// True if no two triangles run along an edge in the same direction.
    pub has_sides: bool,
}

impl Edges {
    /// The edges of triangles, given by the numbers of their vertices.
    pub fn of(triangles: &[[u32; 3]]) -> Self {
        // Per edge, how often triangles run along it in either direction.
        let mut counts: FxHashMap<[u32; 2], [u32; 2]> = FxHashMap::default();
        for &[a, b, c] in triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let count = counts.entry([from.min(to), from.max(to)]).or_default();
                count[usize::from(from > to)] += 1;
            }
        }
        Self {
            count: counts.len(),
            is_closed: !counts.is_empty() && counts.values().all(|[one, other]| one + other == 2),
            has_sides: counts.values().all(|count| count.iter().all(|count| *count <= 1)),
        }
    }
}
