//! Triangles that change: their corners, and which triangles are around each vertex.

use crate::index::{Bounds, Index};
use crate::simplify::quadric::Quadric;
use glam::{DVec3, I64Vec3};
use smallvec::SmallVec;

/// The number of a corner of a triangle that is no more.
const GONE: u32 = u32::MAX;

/// Numbers of a few vertices or triangles.
pub type Few = SmallVec<[u32; 16]>;
/// Directed edges.
pub type Edges = SmallVec<[[u32; 2]; 16]>;

/// The curve around a vertex.
pub struct Link {
    /// The curve's first and last vertex, if the vertex is on a rim. The curve turns to the left.
    pub rim: Option<[u32; 2]>,
}

/// Triangles, and all that is known of their vertices.
pub struct Triangulation {
    pub places: Vec<I64Vec3>,
    triangles: Vec<[u32; 3]>,
    /// The triangles around each vertex.
    pub around: Vec<SmallVec<[u32; 8]>>,
    pub quadrics: Vec<Quadric>,
    /// For each vertex, the distance that samples around it may have from the surface, as a share
    /// of the [largest one](crate::simplify::reduction::Setting::most).
    pub shares: Vec<f64>,
    /// For each vertex, the number of its changes.
    pub stamps: Vec<u32>,
    pub index: Index,
    changed: Vec<bool>,
}

impl Triangulation {
    pub fn new(places: Vec<I64Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let count = places.len();
        let mut all = Self {
            around: Vec::new(),
            quadrics: vec![Quadric::default(); count],
            shares: vec![1.0; count],
            stamps: vec![0; count],
            index: Index::default(),
            changed: vec![false; triangles.len()],
            places,
            triangles,
        };
        all.connect();
        all.sort();
        all
    }

    /// Finds the triangles around each vertex anew.
    pub fn connect(&mut self) {
        self.around = vec![SmallVec::new(); self.places.len()];
        for triangle in self.present().collect::<Vec<u32>>() {
            for vertex in self.corners(triangle) {
                self.around[vertex as usize].push(triangle);
            }
        }
    }

    /// Replaces the corners of a triangle, or removes it. Needs [`Self::connect`] and
    /// [`Self::sort`] afterwards.
    pub fn replace(&mut self, triangle: u32, corners: Option<[u32; 3]>) {
        self.triangles[triangle as usize] = corners.unwrap_or([GONE; 3]);
    }

    /// The numbers of triangles that there were at first.
    pub fn count(&self) -> usize {
        self.triangles.len()
    }

    /// Returns whether there still is a triangle.
    pub fn has(&self, triangle: u32) -> bool {
        self.corners(triangle)[0] != GONE
    }

    /// The triangles that changed.
    pub fn changed(&self) -> impl Iterator<Item = u32> {
        (0..self.triangles.len() as u32).filter(|one| self.changed[*one as usize])
    }

    /// Returns whether only one triangle has an edge.
    pub fn is_rim(&self, from: u32, to: u32) -> bool {
        let has_both = |one: &&u32| self.corners(**one).contains(&to);
        self.around(from).iter().filter(has_both).count() == 1
    }

    /// The places of all vertices that have a triangle, and the triangles.
    pub fn compact(&self, place: impl Fn(I64Vec3) -> DVec3) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let mut numbers = vec![GONE; self.places.len()];
        let mut places = Vec::new();
        let mut number = |vertex: u32| {
            let number = &mut numbers[vertex as usize];
            if *number == GONE {
                *number = places.len() as u32;
                places.push(place(self.place(vertex)));
            }
            *number
        };
        let triangles = self.present().map(|one| self.corners(one).map(&mut number)).collect();
        (places, triangles)
    }

    /// Makes the index anew.
    pub fn sort(&mut self) {
        let present: Vec<_> = self.present().map(|one| (one, self.bounds(one))).collect();
        self.index = Index::new(self.triangles.len(), &present);
    }

    pub fn place(&self, vertex: u32) -> I64Vec3 {
        self.places[vertex as usize]
    }

    pub fn around(&self, vertex: u32) -> &[u32] {
        &self.around[vertex as usize]
    }

    pub fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    pub fn bounds(&self, triangle: u32) -> Bounds {
        bounds(&self.places, &self.corners(triangle))
    }

    /// The numbers of all triangles that there still are.
    pub fn present(&self) -> impl Iterator<Item = u32> {
        (0..self.triangles.len() as u32).filter(|one| self.has(*one))
    }

    /// Finds the curve around a vertex. `None` if the edges that face the vertex are neither closed
    /// curves nor one open curve.
    pub fn link(&self, vertex: u32) -> Option<Link> {
        let edges: Edges =
            self.around(vertex).iter().map(|one| facing(self.corners(*one), vertex)).collect();
        let count = |end: u32, k: usize| edges.iter().filter(|edge| edge[k] == end).count();
        let (mut first, mut last) = (Few::new(), Few::new());
        for &[from, to] in &edges {
            if count(from, 0) != 1 || count(to, 1) != 1 {
                return None;
            }
            first.extend((count(from, 1) == 0).then_some(from));
            last.extend((count(to, 0) == 0).then_some(to));
        }
        match (&first[..], &last[..]) {
            ([], []) if !edges.is_empty() => Some(Link { rim: None }),
            ([first], [last]) => Some(Link { rim: Some([*first, *last]) }),
            _ => None,
        }
    }

    /// All vertices that share a triangle with a vertex, each once.
    pub fn neighbors(&self, vertex: u32) -> Few {
        let mut all = Few::new();
        for triangle in self.around(vertex) {
            for corner in self.corners(*triangle) {
                if corner != vertex && !all.contains(&corner) {
                    all.push(corner);
                }
            }
        }
        all
    }

    /// Moves `keep` to a place, and replaces `drop` by it.
    pub fn apply(&mut self, keep: u32, drop: Option<u32>, to: I64Vec3) {
        let moves = self.place(keep) != to;
        let mut changed: Few = self.around(keep).iter().copied().filter(|_| moves).collect();
        for triangle in drop.iter().flat_map(|drop| self.around(*drop)) {
            if !changed.contains(triangle) {
                changed.push(*triangle);
            }
        }
        self.places[keep as usize] = to;
        for triangle in changed {
            let corners = self.corners(triangle);
            self.changed[triangle as usize] = true;
            if drop.is_some_and(|drop| corners.contains(&drop)) {
                if corners.contains(&keep) {
                    for corner in corners {
                        self.around[corner as usize].retain(|one| *one != triangle);
                    }
                    self.triangles[triangle as usize] = [GONE; 3];
                    self.index.set(triangle, None);
                    continue;
                }
                let replaced = corners.map(|one| if Some(one) == drop { keep } else { one });
                self.triangles[triangle as usize] = replaced;
                self.around[keep as usize].push(triangle);
            }
            let bounds = self.bounds(triangle);
            self.index.set(triangle, Some(&bounds));
        }
        if let Some(drop) = drop {
            self.around[drop as usize].clear();
            self.stamps[drop as usize] += 1;
            let dropped = self.quadrics[drop as usize];
            self.quadrics[keep as usize] += dropped;
            let share = self.shares[drop as usize];
            self.shares[keep as usize] = self.shares[keep as usize].min(share);
        }
        self.stamps[keep as usize] += 1;
    }
}

/// The edge of a triangle that faces one of its corners, in the triangle's direction.
pub fn facing([a, b, c]: [u32; 3], vertex: u32) -> [u32; 2] {
    match vertex {
        _ if vertex == a => [b, c],
        _ if vertex == b => [c, a],
        _ => [a, b],
    }
}

fn bounds(places: &[I64Vec3], triangle: &[u32; 3]) -> Bounds {
    Bounds::of(triangle.map(|vertex| places[vertex as usize]))
}
