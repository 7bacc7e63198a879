//! Searches for boxes that may hold a point of a surface, by halving boxes within a limit of work.

use rayon::prelude::*;
use std::cell::{Cell as Counter, RefCell};
use zeroset_eval::{
    Boxes, ContractTiles, FindZeros, Kernel, LANES, Planes, Points, Sample, Tiles, Values, Zeros,
};

/// A box of space. Its ends may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The corner with the smallest coordinates.
    pub low: [f64; 3],
    /// The corner with the largest coordinates.
    pub high: [f64; 3],
}

impl Cell {
    /// The cube around the origin with half extent `half`.
    pub fn cube(half: f64) -> Self {
        Self { low: [-half; 3], high: [half; 3] }
    }

    /// The cube around `place` with half extent `half`.
    pub fn about(place: [f64; 3], half: f64) -> Self {
        Self { low: place.map(|along| along - half), high: place.map(|along| along + half) }
    }

    /// The box's extent along an axis.
    pub fn extent(&self, axis: usize) -> f64 {
        self.high[axis] - self.low[axis]
    }

    /// The largest of the box's three extents.
    pub fn largest(&self) -> f64 {
        (0..3).map(|axis| self.extent(axis)).fold(0.0, f64::max)
    }

    /// The largest magnitude of a coordinate in the box.
    pub fn reach(&self) -> f64 {
        (0..3).map(|axis| self.high[axis].max(-self.low[axis])).fold(0.0, f64::max)
    }

    /// The box's center.
    pub fn centre(&self) -> [f64; 3] {
        let ([a, b, c], [d, e, f]) = (self.low, self.high);
        [a.midpoint(d), b.midpoint(e), c.midpoint(f)]
    }

    /// The smallest box around both boxes.
    #[must_use]
    pub fn around(&self, other: &Self) -> Self {
        let ends = |pick: fn(f64, f64) -> f64, one: &[f64; 3], two: &[f64; 3]| {
            [0, 1, 2].map(|axis| pick(one[axis], two[axis]))
        };
        Self {
            low: ends(f64::min, &self.low, &other.low),
            high: ends(f64::max, &self.high, &other.high),
        }
    }

    /// Returns whether the box has finite, increasing ends on all axes.
    pub fn is_finite(&self) -> bool {
        let mut ends = self.low.iter().zip(&self.high);
        ends.all(|(low, high)| low.is_finite() && high.is_finite() && low <= high)
    }

    /// Returns whether `other` lies inside this box.
    pub fn holds(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.low[axis] && other.high[axis] <= self.high[axis])
    }

    /// The eight boxes that result from halving all sides. Together they cover this box exactly.
    pub fn parts(self) -> impl Iterator<Item = Self> {
        let middle = self.centre();
        (0..8).map(move |n| {
            let mut part = self;
            for (axis, middle) in middle.into_iter().enumerate() {
                if n >> axis & 1 == 1 { part.low[axis] = middle } else { part.high[axis] = middle }
            }
            part
        })
    }
}

/// `place` moved along each axis by −1, 0 or 1 times the axis's element of `steps`: 27 places. The
/// 14th is `place` itself.
pub fn places_about(place: [f64; 3], steps: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
    (0..27).map(move |n: i32| {
        let sides = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1].map(f64::from);
        [0, 1, 2].map(|axis| place[axis] + sides[axis] * steps[axis])
    })
}

/// A search for cells that may hold a point of a surface, with a limit on evaluations.
pub struct CellSearch<'a> {
    /// The surfaces' kernels, in interval arithmetic.
    pub surfaces: Vec<&'a dyn Kernel<FindZeros, f64>>,
    /// The surfaces' kernels in affine arithmetic. They are evaluated for cells that interval
    /// arithmetic does not prove empty. The list is empty until the kernels are worth compiling.
    pub forms: Vec<&'a dyn Kernel<ContractTiles, f64>>,
    /// Returns whether the search is still wanted. It is called between evaluations. Once it has
    /// returned false, it must return false forever.
    pub wanted: &'a dyn Fn() -> bool,
    /// Number of evaluations left. Once it is 0, no cell can be proven empty.
    pub work: Counter<u64>,
}

impl CellSearch<'_> {
    /// Returns whether the search is still wanted.
    pub fn is_wanted(&self) -> bool {
        (self.wanted)()
    }

    /// Takes `evaluations` from `work`. Returns whether that many were left.
    pub fn spend(&self, evaluations: u64) -> bool {
        let left = self.work.get();
        self.work.set(left.saturating_sub(evaluations));
        left >= evaluations
    }

    /// The kernel's values at `places`. Each place takes one evaluation from `work`.
    pub fn values(&self, kernel: &dyn Kernel<Sample, f64>, places: &[[f64; 3]]) -> Vec<f64> {
        self.spend(places.len() as u64);
        let mut values = Vec::with_capacity(places.len());
        for points in Points::near(places) {
            let mut found = Values::<f64>::default();
            kernel.eval(&points, &mut found);
            values.extend_from_slice(&found.value[..points.count as usize]);
        }
        values
    }

    /// Returns the cells that are not proven empty, in the given order. If the search is no longer
    /// wanted, returns none, so that every search ends.
    pub fn open(&self, cells: &[Cell]) -> Vec<Cell> {
        if !self.is_wanted() {
            return Vec::new();
        }
        let Self { surfaces, forms, .. } = self;
        let open = self.remaining(cells, surfaces, |cells, surfaces| {
            BATCHES.with_borrow_mut(|Batches { boxes, zeros, .. }| {
                write_boxes(cells, boxes);
                surfaces.iter().fold(0, |all, surface| {
                    surface.eval(boxes, zeros);
                    all | zeros.possible
                })
            })
        });
        if forms.is_empty() {
            return open;
        }
        self.remaining(&open, forms, |cells, forms| {
            BATCHES.with_borrow_mut(|Batches { tiles, planes, .. }| {
                write_tiles(cells, tiles);
                forms.iter().fold(0, |all, form| {
                    form.eval(tiles, planes);
                    all | planes.possible
                })
            })
        })
    }

    /// Returns the cells that may hold a point of a surface, in the given order. `possible` tests
    /// up to sixteen cells and returns a bit for each that may. Once the evaluations are used up,
    /// untested cells are returned, too.
    fn remaining<K: Sync>(
        &self,
        cells: &[Cell],
        kernels: &[K],
        possible: impl Fn(&[Cell], &[K]) -> u16 + Sync,
    ) -> Vec<Cell> {
        // Evaluations are taken from `work` in order, so that results do not depend on threads.
        let paid = |cells: &[Cell]| self.spend((cells.len() * kernels.len()) as u64);
        let mask = |cells: &[Cell], is_paid| {
            if is_paid { possible(cells, kernels) } else { u16::MAX }
        };
        let batches = cells.chunks(LANES);
        if batches.len() < PARALLEL {
            let mut open = Vec::with_capacity(cells.len());
            for cells in batches {
                open.extend(lanes(cells, mask(cells, paid(cells))));
            }
            return open;
        }
        let batches: Vec<_> = batches.map(|cells| (cells, paid(cells))).collect();
        let open = |&(cells, is_paid): &(&[Cell], bool)| {
            lanes(cells, mask(cells, is_paid)).collect::<Vec<_>>()
        };
        batches.par_iter().flat_map_iter(open).collect()
    }

    /// Returns whether the space outside `inner`, divided into 26 infinite boxes, is proven empty.
    pub fn nothing_outside(&self, inner: &Cell) -> bool {
        let parts = (0..27).filter(|n| *n != 13).map(|n: usize| {
            let place = [n % 3, n / 3 % 3, n / 9];
            let end = |axis: usize, side: usize| match place[axis] + side {
                0 => f64::NEG_INFINITY,
                1 => inner.low[axis],
                2 => inner.high[axis],
                _ => f64::INFINITY,
            };
            Cell {
                low: [0, 1, 2].map(|axis| end(axis, 0)),
                high: [0, 1, 2].map(|axis| end(axis, 1)),
            }
        });
        self.open(&parts.collect::<Vec<_>>()).is_empty() && self.is_wanted()
    }

    /// Returns whether the space between `inner` and a larger box `outer` is proven empty.
    pub fn nothing_between(&self, inner: &Cell, outer: &Cell) -> bool {
        let mut left = vec![*outer];
        for _ in 0..SHELL_DEPTH {
            let parts = left.iter().flat_map(|cell| cell.parts());
            left = self.open(&parts.filter(|cell| !inner.holds(cell)).collect::<Vec<_>>());
            if left.is_empty() || left.len() > SHELL_CELLS {
                break;
            }
        }
        left.is_empty() && self.is_wanted()
    }

    /// A box around the cells of `whole` that are not proven empty, or `None` if all of `whole` is.
    /// The smallest cells have 2^−`depth` of `whole`'s sides. The search is repeated on the
    /// resulting box as long as each search shrinks the box noticeably.
    pub fn tight(&self, mut whole: Cell, depth: u32) -> Option<Cell> {
        for _ in 0..ROUNDS {
            let hull = self.hull(&whole, depth)?;
            let is_snug = |axis: usize| {
                hull.extent(axis) >= SNUG * whole.extent(axis)
                    || hull.extent(axis) < NARROW * hull.largest()
            };
            if (0..3).all(is_snug) || self.work.get() == 0 {
                return Some(hull);
            }
            whole = hull;
        }
        Some(whole)
    }

    /// The smallest box around the cells at depth `finest` that are not proven empty. Once no
    /// evaluations are left, coarser cells count, too.
    fn hull(&self, whole: &Cell, finest: u32) -> Option<Cell> {
        let mut hull: Option<Cell> = None;
        let mut open = vec![(*whole, 0)];
        let mut parts = Vec::with_capacity(LANES);
        while let Some((cell, depth)) = open.pop() {
            if hull.as_ref().is_some_and(|hull| hull.holds(&cell)) {
                continue;
            }
            if depth == finest || self.work.get() == 0 {
                hull = Some(hull.map_or(cell, |hull| hull.around(&cell)));
                continue;
            }
            parts.clear();
            parts.extend(cell.parts());
            open.extend(self.open(&parts).into_iter().map(|part| (part, depth + 1)));
        }
        hull
    }
}

/// The cells whose bits are set in a mask.
fn lanes(cells: &[Cell], mask: u16) -> impl Iterator<Item = Cell> {
    let all = cells.iter().enumerate();
    all.filter(move |(lane, _)| mask >> lane & 1 == 1).map(|(_, cell)| *cell)
}

/// Memory for testing up to sixteen cells. Lanes that are not in use hold earlier cells.
struct Batches {
    boxes: Boxes<f64>,
    zeros: Zeros,
    /// Tiles of rays parallel to z. Screen coordinates are x and y.
    tiles: Tiles<f64>,
    planes: Planes<f64>,
}

thread_local! {
    /// The memory of a thread: writing all of it anew takes as long as a test.
    static BATCHES: RefCell<Batches> = RefCell::new(Batches::new());
}

impl Batches {
    fn new() -> Self {
        let (boxes, zeros, planes) = (Boxes::default(), Zeros::default(), Planes::default());
        Self { boxes, zeros, tiles: upright_tiles(), planes }
    }
}

/// Tiles of rays parallel to z, without a place.
fn upright_tiles() -> Tiles<f64> {
    let mut tiles = Tiles::default();
    for lane in 0..LANES {
        (tiles.origin[3][lane], tiles.origin[7][lane]) = (1.0, 1.0);
        tiles.direction[2][lane] = 1.0;
    }
    tiles
}

/// Up to sixteen cells as tiles of rays parallel to z. Screen coordinates are x and y.
///
/// # Panics
/// If there are more cells.
pub fn tiles_of(cells: &[Cell]) -> Tiles<f64> {
    let mut tiles = upright_tiles();
    write_tiles(cells, &mut tiles);
    tiles
}

/// Writes up to sixteen cells to a batch of boxes.
fn write_boxes(cells: &[Cell], boxes: &mut Boxes<f64>) {
    boxes.count = cells.len() as u32;
    for (lane, cell) in cells.iter().enumerate() {
        for axis in 0..3 {
            boxes.neg_lo[axis][lane] = -cell.low[axis];
            boxes.hi[axis][lane] = cell.high[axis];
        }
    }
}

/// Writes up to sixteen cells to tiles of rays parallel to z.
fn write_tiles(cells: &[Cell], tiles: &mut Tiles<f64>) {
    tiles.count = cells.len() as u32;
    for (lane, cell) in cells.iter().enumerate() {
        let centre = cell.centre();
        for (axis, centre) in [(0, centre[0]), (1, centre[1])] {
            let reach = (cell.high[axis] - centre).max(centre - cell.low[axis]);
            tiles.centre[axis][lane] = centre;
            tiles.half[axis][lane] = reach.next_up();
        }
        (tiles.near[lane], tiles.far[lane]) = (cell.low[2], cell.high[2]);
        for axis in 0..3 {
            tiles.error[axis][lane] = 0.0;
        }
    }
    tiles.allow_rounding();
}

/// Smallest number of batches for which several threads are used.
const PARALLEL: usize = 16;

/// Limits for [`CellSearch::nothing_between`]: the largest number of halvings, and the number of
/// undecided cells beyond which halving stops. If a surface passes between the boxes, more halvings
/// only cost time.
const SHELL_DEPTH: u32 = 6;
const SHELL_CELLS: usize = 2048;

/// A box is searched again if one of its sides shrank below `SNUG` of the side's former length.
/// `ROUNDS` is the maximum number of searches.
const SNUG: f64 = 0.75;
const ROUNDS: u32 = 400;

/// A side shorter than this share of the box's longest side does not cause another search.
const NARROW: f64 = 1e-3;
