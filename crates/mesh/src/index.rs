//! A tree of boxes around triangles.
//!
//! The leaves are in the order of a space-filling curve, so that neighbors in space are mostly
//! neighbors in the tree. A triangle that changes keeps its leaf.

use glam::I64Vec3;
use smallvec::{SmallVec, smallvec};

/// Number of bits that boxes leave out of coordinates.
const COARSE: i64 = 10;

/// The box around some points: least and largest coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    pub low: I64Vec3,
    pub high: I64Vec3,
}

impl Bounds {
    pub fn of(points: impl IntoIterator<Item = I64Vec3>) -> Self {
        let empty = Self { low: I64Vec3::MAX, high: I64Vec3::MIN };
        points
            .into_iter()
            .fold(empty, |all, point| Self { low: all.low.min(point), high: all.high.max(point) })
    }

    pub fn meets(&self, other: &Self) -> bool {
        self.low.cmple(other.high).all() && other.low.cmple(self.high).all()
    }

    /// Returns whether a point is strictly inside.
    pub fn holds(&self, point: I64Vec3) -> bool {
        self.low.cmplt(point).all() && point.cmplt(self.high).all()
    }

    /// Returns whether a box is strictly inside.
    pub fn holds_all(&self, other: &Self) -> bool {
        self.holds(other.low) && self.holds(other.high)
    }
}

/// A box with coordinates that are rounded down, which keeps their order.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Coarse {
    low: [i32; 3],
    high: [i32; 3],
}

impl Coarse {
    const EMPTY: Self = Self { low: [i32::MAX; 3], high: [i32::MIN; 3] };

    fn around(bounds: &Bounds) -> Self {
        let coarse = |point: I64Vec3| point.to_array().map(|along| (along >> COARSE) as i32);
        Self { low: coarse(bounds.low), high: coarse(bounds.high) }
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }
}

/// Boxes of triangles.
#[derive(Default)]
pub struct Index {
    /// A complete binary tree: the children of node k are 2k and 2k + 1.
    nodes: Vec<Coarse>,
    /// The triangle of each leaf.
    triangles: Vec<u32>,
    /// The leaf of each triangle.
    leaves: Vec<u32>,
}

impl Index {
    /// The tree of some triangles, whose numbers are below `count`.
    pub fn new(count: usize, triangles: &[(u32, Bounds)]) -> Self {
        let mut sorted: Vec<(u64, u32)> = triangles
            .iter()
            .enumerate()
            .map(|(k, (_, bounds))| (on_curve((bounds.low + bounds.high) >> 1_i64), k as u32))
            .collect();
        sorted.sort_unstable();
        let width = sorted.len().next_power_of_two();
        let mut nodes = vec![Coarse::EMPTY; 2 * width];
        let mut leaves = vec![0; count];
        let mut numbers = Vec::with_capacity(sorted.len());
        for (leaf, (_, k)) in sorted.into_iter().enumerate() {
            let (number, bounds) = &triangles[k as usize];
            nodes[width + leaf] = Coarse::around(bounds);
            leaves[*number as usize] = leaf as u32;
            numbers.push(*number);
        }
        for node in (1..width).rev() {
            nodes[node] = nodes[2 * node].with(&nodes[2 * node + 1]);
        }
        Self { nodes, triangles: numbers, leaves }
    }

    /// Changes a triangle's box. `None` for a triangle that is no more.
    pub fn set(&mut self, triangle: u32, bounds: Option<&Bounds>) {
        let mut node = self.nodes.len() / 2 + self.leaves[triangle as usize] as usize;
        self.nodes[node] = bounds.map_or(Coarse::EMPTY, Coarse::around);
        while node > 1 {
            node /= 2;
            let both = self.nodes[2 * node].with(&self.nodes[2 * node + 1]);
            if self.nodes[node] == both {
                break;
            }
            self.nodes[node] = both;
        }
    }

    /// Calls `each` for all triangles whose boxes may meet `bounds`, until it returns false.
    /// Returns whether it never did.
    pub fn all_near(&self, bounds: &Bounds, each: &mut dyn FnMut(u32) -> bool) -> bool {
        let bounds = Coarse::around(bounds);
        let width = self.nodes.len() / 2;
        let mut open: SmallVec<[usize; 64]> = smallvec![1];
        while let Some(node) = open.pop() {
            if !self.nodes[node].meets(&bounds) {
                continue;
            }
            if node < width {
                open.extend([2 * node, 2 * node + 1]);
            } else if !each(self.triangles[node - width]) {
                return false;
            }
        }
        true
    }
}

/// The place of a point on Morton's curve through a grid of 2²¹ cells along each axis.
fn on_curve(point: I64Vec3) -> u64 {
    let spread = |along: i64| {
        let mut bits = (along >> 19) as u64 & 0x1f_ffff;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(point.x) | spread(point.y) << 1 | spread(point.z) << 2
}
