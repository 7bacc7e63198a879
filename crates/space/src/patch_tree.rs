//! The cells of a parametric surface's rectangle, in a tree that grows where it is used.
//!
//! A cell is a part of the rectangle of the parameters u and v. A node holds 16 cells, and an
//! approximation of the surface over each. They are as many columns and rows as make the cells
//! about as long as wide in space. A cell becomes a node of its own when it is first divided, and
//! stays so. Nothing here knows rays or pixels.

use std::sync::OnceLock;
use zeroset_eval::{BoundPatches, Boxes, Kernel, LANES, Patches};

/// Number of columns of cells of the first node.
const COLUMNS: usize = 4;

/// A part of the rectangle: the ranges of u and of v.
pub type PatchCell = [[f64; 2]; 2];

/// The error of a cell is large if it is above this share of the cell's extent.
const ROUGH: f64 = 0.5;

/// Each range of a cell of the tree is longer than its part of the rectangle, by this share of its
/// length on either side. A zero near a border lies well inside a cell, where it can be proven.
const OVERLAP: f64 = 1.0 / 32.0;

/// Per axis, the lowest and the highest coordinate.
pub type Bounds = [[f64; 2]; 3];

/// The cells of a surface, and the kernel that approximates it over them.
pub struct PatchTree {
    kernel: Box<dyn Kernel<BoundPatches, f64>>,
    /// A rectangle that contains the exact one.
    outer: PatchCell,
    /// A rectangle that the exact one contains.
    inner: PatchCell,
    root: OnceLock<Box<PatchNode>>,
}

/// Sixteen cells, which together are a cell of the node above.
pub struct PatchNode {
    /// The surface over each cell.
    pub cells: Patches<f64>,
    /// The cell that is divided.
    whole: PatchCell,
    /// Number of parts along u; along v there are [`LANES`] divided by it.
    columns: usize,
    parts: [OnceLock<Box<PatchNode>>; LANES],
}

impl PatchTree {
    /// The tree of a surface. The kernel must be compiled for `outer`. `inner` lies in the exact
    /// rectangle, and that lies in `outer`.
    pub fn new(
        kernel: Box<dyn Kernel<BoundPatches, f64>>,
        outer: PatchCell,
        inner: PatchCell,
    ) -> Self {
        Self { kernel, outer, inner, root: OnceLock::new() }
    }

    /// A rectangle that contains the exact one.
    pub fn outer(&self) -> PatchCell {
        self.outer
    }

    /// A rectangle that the exact one contains.
    pub fn inner(&self) -> PatchCell {
        self.inner
    }

    /// The node of the whole rectangle.
    pub fn root(&self) -> &PatchNode {
        self.root.get_or_init(|| Box::new(self.divide_with(OVERLAP, self.outer, COLUMNS)))
    }

    /// The node of a cell.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn part<'a>(&self, node: &'a PatchNode, lane: usize) -> &'a PatchNode {
        let divide = || self.divide_with(OVERLAP, node.cell(lane), self.columns(node, lane));
        node.parts[lane].get_or_init(|| Box::new(divide()))
    }

    /// The number of columns in which to divide a cell for good. If its error is large, halves of
    /// the cell in either direction show which direction causes it.
    fn columns(&self, node: &PatchNode, lane: usize) -> usize {
        let [u, v] = node.cells.sides(lane);
        if node.cells.largest_error(lane) <= ROUGH * u.max(v) {
            return columns([1.0; 2], &node.cells, lane);
        }
        let [u, v] = node.cell(lane);
        let halves = self.over(&[[part(u, 0, 2), v], [u, part(v, 0, 2)]]);
        match halves.largest_error(0) / halves.largest_error(1) {
            ratio if ratio < 0.7 => LANES,
            ratio if ratio > 1.4 => 1,
            _ => COLUMNS,
        }
    }

    /// Divides a cell into [`LANES`] cells, in this number of [`columns`].
    pub fn divide(&self, whole: PatchCell, columns: usize) -> PatchNode {
        self.divide_with(0.0, whole, columns)
    }

    fn divide_with(&self, overlap: f64, whole: PatchCell, columns: usize) -> PatchNode {
        let (cells, parts) = (Patches::default(), Default::default());
        let mut node = PatchNode { cells, whole, columns, parts };
        let mut boxes = empty(LANES as u32);
        for lane in 0..LANES {
            let mut cell = node.cell(lane);
            for (range, [least, most]) in cell.iter_mut().zip(self.outer) {
                let more = overlap * (range[1] - range[0]);
                *range = [(range[0] - more).max(least), (range[1] + more).min(most)];
            }
            set(&mut boxes, lane, cell);
        }
        self.kernel.eval(&boxes, &mut node.cells);
        node
    }

    /// The surface over each of `cells`, of which there are at most [`LANES`] and at least one.
    /// They must lie in [`PatchTree::outer`].
    pub fn over(&self, cells: &[PatchCell]) -> Patches<f64> {
        let (mut boxes, mut found) = (empty(cells.len() as u32), Patches::default());
        for (lane, cell) in cells.iter().enumerate() {
            set(&mut boxes, lane, *cell);
        }
        self.kernel.eval(&boxes, &mut found);
        found
    }

    /// Bounds of the surface: per axis, the lowest and the highest coordinate, from all cells
    /// `depth` levels below the root. They may be infinite. `None` if the surface has no point.
    pub fn bounds(&self, depth: u32) -> Option<Bounds> {
        self.bounds_of(self.root(), depth, &|_| true)
    }

    /// As [`PatchTree::bounds`], but without the cells whose bounds are infinite.
    pub fn finite_bounds(&self, depth: u32) -> Option<Bounds> {
        self.bounds_of(self.root(), depth, &|bounds| {
            bounds.as_flattened().iter().all(|end| end.is_finite())
        })
    }

    fn bounds_of(
        &self,
        node: &PatchNode,
        depth: u32,
        counts: &dyn Fn(&Bounds) -> bool,
    ) -> Option<Bounds> {
        let of_cell = |lane: usize| {
            if node.cells.nowhere >> lane & 1 == 1 {
                return None;
            }
            if depth > 0 {
                return self.bounds_of(self.part(node, lane), depth - 1, counts);
            }
            Some([0, 1, 2].map(|axis| node.cells.coordinate(axis, lane))).filter(counts)
        };
        (0..LANES).filter_map(of_cell).reduce(|one, other| {
            std::array::from_fn(|axis| {
                [one[axis][0].min(other[axis][0]), one[axis][1].max(other[axis][1])]
            })
        })
    }
}

impl PatchNode {
    /// The cell with this number. Neighbors share their ends exactly.
    pub fn cell(&self, lane: usize) -> PatchCell {
        let [u, v] = self.whole;
        let rows = LANES / self.columns;
        [part(u, lane % self.columns, self.columns), part(v, lane / self.columns, rows)]
    }
}

/// The number of columns in which to divide a part of a cell, so that the parts are about as long
/// as wide in space. `shares` are the shares of the cell along u and v that the part has.
pub fn columns(shares: [f64; 2], cells: &Patches<f64>, lane: usize) -> usize {
    // The direction that causes an error is not known, so it counts for both.
    let error = cells.largest_error(lane);
    let [u, v] = cells.sides(lane);
    let ratio = (shares[0] * u + error) / (shares[1] * v + error);
    // 4 columns if the ratio is 1, and twice as many if it is 4.
    match ratio {
        ratio if ratio > 8.0 => 16,
        ratio if ratio > 2.0 => 8,
        ratio if ratio < 1.0 / 8.0 => 1,
        ratio if ratio < 1.0 / 2.0 => 2,
        _ => 4,
    }
}

/// One of `count` equal parts of a range.
fn part([low, high]: [f64; 2], number: usize, count: usize) -> [f64; 2] {
    let end = |number: usize| match number {
        0 => low,
        _ if number == count => high,
        _ => (low + (high - low) * (number as f64 / count as f64)).clamp(low, high),
    };
    [end(number), end(number + 1)]
}

/// Boxes whose third coordinate is 0, and of which `count` lanes are in use.
fn empty(count: u32) -> Boxes<f64> {
    Boxes { count, ..Boxes::default() }
}

fn set(boxes: &mut Boxes<f64>, lane: usize, cell: PatchCell) {
    for (axis, [low, high]) in cell.into_iter().enumerate() {
        (boxes.neg_lo[axis][lane], boxes.hi[axis][lane]) = (-low, high);
    }
}
