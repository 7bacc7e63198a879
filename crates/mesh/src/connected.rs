//! Connected vertices of a mesh.

/// Disjoint sets of connected vertices.
pub struct Connected {
    parents: Vec<u32>,
}

impl Connected {
    /// The sets of the vertices, of which there are `vertices`, that triangles connect.
    ///
    /// # Panics
    /// If a triangle has the number of a missing vertex.
    pub fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        let mut sets = Self { parents: (0..vertices as u32).collect() };
        for [a, b, c] in triangles {
            sets.join(*a, *b);
            sets.join(*b, *c);
        }
        sets
    }

    /// The first vertex of a vertex's set.
    ///
    /// # Panics
    /// If there is no such vertex.
    pub fn first(&mut self, mut vertex: u32) -> u32 {
        while self.parents[vertex as usize] != vertex {
            let parent = self.parents[vertex as usize];
            self.parents[vertex as usize] = self.parents[parent as usize];
            vertex = parent;
        }
        vertex
    }

    fn join(&mut self, one: u32, other: u32) {
        let (one, other) = (self.first(one), self.first(other));
        self.parents[one.max(other) as usize] = one.min(other);
    }
}
