//! Pieces, genus and area of a mesh.

use glam::DVec3;
use zeroset_mesh::{Connected, Mesh};

/// The shape of a mesh, and so of the surface, if the mesh is proven to have the surface's shape.
#[derive(Clone, Debug, Default)]
pub struct Shape {
    /// The connected pieces.
    pub pieces: Vec<Piece>,
}

/// A piece of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Number of handles, or `None` if the piece has a rim.
    pub genus: Option<u32>,
    /// True if the piece is closed, and its triangles face what it encloses: a hollow.
    pub is_hollow: bool,
}

/// The shape of a mesh. Pieces are in the order of their first vertices.
pub fn shape(mesh: &Mesh) -> Shape {
    let mut sets = Connected::new(mesh.vertices.len(), &mesh.triangles);
    let mut numbers = vec![u32::MAX; mesh.vertices.len()];
    let mut counts: Vec<Counts> = Vec::new();
    for vertex in 0..mesh.vertices.len() as u32 {
        let first = sets.first(vertex) as usize;
        if numbers[first] == u32::MAX {
            numbers[first] = counts.len() as u32;
            counts.push(Counts::default());
        }
        counts[numbers[first] as usize].vertices += 1;
    }
    let mut sides: Vec<[u32; 3]> = Vec::with_capacity(3 * mesh.triangles.len());
    for &[a, b, c] in &mesh.triangles {
        let number = numbers[sets.first(a) as usize];
        let piece = &mut counts[number as usize];
        let [p, q, r] = [a, b, c].map(|vertex| mesh.vertices[vertex as usize]);
        piece.triangles += 1;
        piece.volume += p.dot(q.cross(r));
        sides.extend([[a, b], [b, c], [c, a]].map(|[a, b]| [number, a.min(b), a.max(b)]));
    }
    sides.sort_unstable();
    for edge in sides.chunk_by(|one, other| one == other) {
        let piece = &mut counts[edge[0][0] as usize];
        piece.edges += 1;
        piece.has_rim |= edge.len() != 2;
    }
    Shape { pieces: counts.iter().map(Counts::piece).collect() }
}

/// Numbers of a piece.
#[derive(Default)]
struct Counts {
    vertices: i64,
    edges: i64,
    triangles: i64,
    /// Six times the volume inside.
    volume: f64,
    has_rim: bool,
}

impl Counts {
    fn piece(&self) -> Piece {
        let euler = self.vertices - self.edges + self.triangles;
        let genus = if self.has_rim { None } else { u32::try_from((2 - euler) / 2).ok() };
        Piece { genus, is_hollow: !self.has_rim && self.volume < 0.0 }
    }
}

/// The area of all triangles.
pub fn area(mesh: &Mesh) -> f64 {
    let of = |[a, b, c]: &[u32; 3]| {
        let [p, q, r] = [a, b, c].map(|vertex| mesh.vertices[*vertex as usize]);
        0.5 * (q - p).cross(r - p).length()
    };
    mesh.triangles.iter().map(of).sum()
}

/// The smallest box around a mesh, or `None` if it is empty.
pub fn hull(mesh: &Mesh) -> Option<[DVec3; 2]> {
    let low = mesh.vertices.iter().copied().reduce(DVec3::min)?;
    let high = mesh.vertices.iter().copied().reduce(DVec3::max)?;
    Some([low, high])
}
