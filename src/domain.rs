//! Where to look when nobody says: `--domain auto`.
//!
//! Shells of cubes from ±2⁸ inward are proven empty by intervals. If the outermost are, the surface
//! is bounded as far as was looked, and its box is tightened; otherwise a window around the origin
//! is chosen.

use zeroset_eval::{Boxes, FindZeros, Kernel, LANES};
use zeroset_interval::Interval;

/// The largest cube looked at is ±2 to this power, the smallest ±2 to that.
const LARGEST: i32 = 8;
const SMALLEST: i32 = -4;

/// Half the extent of the largest cube.
pub const REACH: f64 = 256.0;

/// The least half extent chosen for an unbounded surface, and that for one with a periodic
/// function.
const LEAST: f64 = 2.0;
const LEAST_PERIODIC: f64 = std::f64::consts::TAU;

/// A shell's 56 cells are halved this often, or until more than so many cells are left: beyond
/// that, a surface that passes through would only cost time.
const SHELL_DEPTH: u32 = 4;
const SHELL_CELLS: usize = 2048;

/// A bounded surface's box is found to within 2 to minus this of the cube around it.
const BOX_DEPTH: u32 = 6;

/// No cube smaller than this is searched: its cells would have corners with more digits than an
/// `f32` has.
const FINEST: f32 = 1.0 / 256.0;

/// Space left around a bounded surface, as a share of its extent on each axis.
const SPACE: f64 = 0.05;

/// A domain, and what was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutoDomain {
    /// The corner with the smallest coordinates.
    pub low: [f64; 3],
    /// The corner with the largest coordinates.
    pub high: [f64; 3],
    /// What was found.
    pub finding: Finding,
}

/// What is known of where a surface lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finding {
    /// Nothing of it lies within ±[`REACH`] outside the domain: proven.
    Bounded,
    /// It could not be shown to be bounded; the domain is a window.
    Unbounded,
    /// It has no point within ±[`REACH`]: proven.
    Empty,
}

impl Finding {
    /// One phrase for a note.
    pub fn describe(self) -> &'static str {
        match self {
            Self::Bounded => "bounded: proven up to ±256",
            Self::Unbounded => "unbounded, clipped",
            Self::Empty => "empty: proven up to ±256",
        }
    }
}

/// Chooses a domain that shows all `surfaces`, whose kernels must hold within ±[`REACH`].
/// `periodic` tells whether a trigonometric function of a coordinate occurs. `wanted` is asked
/// between evaluations; once false, it must stay false, and the answer is `None`.
pub fn find_while(
    surfaces: &[&dyn Kernel<FindZeros>],
    periodic: bool,
    wanted: &dyn Fn() -> bool,
) -> Option<AutoDomain> {
    let possible = Possible { surfaces, wanted };
    let occupied = |exponent: i32| {
        let side = 2.0_f32.powi(exponent - 1);
        // The cube ±2^exponent in cells of half its half extent; for all but the smallest, the
        // inner eight cells are the next smaller cube's own.
        let cells = (0..64).filter_map(|n: i32| {
            let place = [n % 4 - 2, n / 4 % 4 - 2, n / 16 - 2];
            let inner = place.iter().all(|&k| k == -1 || k == 0);
            let low = place.map(|k| k as f32 * side);
            (exponent == SMALLEST || !inner).then_some(Cell { low, side })
        });
        possible.anywhere(&cells.collect::<Vec<_>>())
    };
    let cube = |half: f64| ([-half; 3], [half; 3]);
    let found = match (SMALLEST..=LARGEST).rev().find(|&exponent| occupied(exponent)) {
        None => {
            let (low, high) = cube(LEAST);
            AutoDomain { low, high, finding: Finding::Empty }
        }
        Some(LARGEST) => {
            let first = (SMALLEST..LARGEST).find(|&exponent| occupied(exponent));
            let least = if periodic { LEAST_PERIODIC } else { LEAST };
            let (low, high) = cube(2.0_f64.powi(first.unwrap_or(LARGEST)).max(least));
            AutoDomain { low, high, finding: Finding::Unbounded }
        }
        Some(exponent) => {
            let half = 2.0_f32.powi(exponent);
            let whole = Cell { low: [-half; 3], side: 2.0 * half };
            let (low, high) = possible.tight(whole);
            let (low, high) = roomy(low.map(f64::from), high.map(f64::from));
            AutoDomain { low, high, finding: Finding::Bounded }
        }
    };
    // What was cut short has seen too little.
    wanted().then_some(found)
}

/// The box with some space on each side, its bounds rounded outward to few digits.
fn roomy(low: [f64; 3], high: [f64; 3]) -> ([f64; 3], [f64; 3]) {
    let largest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    // A hundredth of the extent, as a power of ten.
    let grain = 10.0_f64.powf((largest / 100.0).log10().floor());
    let axis = |axis: usize| {
        let space = SPACE * (high[axis] - low[axis]);
        // Division by the power of ten's reciprocal gives the decimal nearest to what is meant.
        let digits = |steps: f64| {
            if grain < 1.0 { steps / (1.0 / grain).round() } else { steps * grain }
        };
        // What is a whole number of grains but for rounding is not moved by another; the space
        // absorbs it.
        let snapped = |steps: f64, outward: f64| {
            let near = steps.round();
            if (steps - near).abs() < 1e-6 { near } else { outward }
        };
        let (below, above) = ((low[axis] - space) / grain, (high[axis] + space) / grain);
        let below = digits(snapped(below, below.floor()));
        let above = digits(snapped(above, above.ceil()));
        (below, above)
    };
    ([axis(0).0, axis(1).0, axis(2).0], [axis(0).1, axis(1).1, axis(2).1])
}

/// A cube of space whose corners are short binary fractions, so that halving it is exact.
#[derive(Clone, Copy)]
struct Cell {
    low: [f32; 3],
    side: f32,
}

impl Cell {
    fn halves(self) -> impl Iterator<Item = Self> {
        let side = self.side / 2.0;
        (0..8).map(move |n| {
            let step = |axis: usize| if n >> axis & 1 == 1 { side } else { 0.0 };
            Self { low: [0, 1, 2].map(|axis| self.low[axis] + step(axis)), side }
        })
    }

    fn high(self) -> [f32; 3] {
        self.low.map(|low| low + self.side)
    }
}

/// Which cells may hold a point of some surface.
struct Possible<'a> {
    surfaces: &'a [&'a dyn Kernel<FindZeros>],
    wanted: &'a dyn Fn() -> bool,
}

impl Possible<'_> {
    /// The cells that are not proven empty; none, so that every search ends, when it is no longer
    /// wanted.
    fn of(&self, cells: &[Cell]) -> Vec<Cell> {
        if !(self.wanted)() {
            return Vec::new();
        }
        let cell_box = |cell: &Cell| {
            let (low, high) = (cell.low, cell.high());
            [0, 1, 2].map(|axis| Interval { lo: low[axis].into(), hi: high[axis].into() })
        };
        let boxes = Boxes::around(&cells.iter().map(cell_box).collect::<Vec<_>>());
        let mut possible = vec![false; cells.len()];
        for surface in self.surfaces {
            let zeros = surface.ask_all(&boxes);
            for (index, possible) in possible.iter_mut().enumerate() {
                *possible |= zeros[index / LANES].possible >> (index % LANES) & 1 == 1;
            }
        }
        cells
            .iter()
            .zip(possible)
            .filter_map(|(cell, possible)| possible.then_some(*cell))
            .collect()
    }

    /// Whether some cell cannot be proven empty.
    fn anywhere(&self, cells: &[Cell]) -> bool {
        let mut left = self.of(cells);
        for _ in 0..SHELL_DEPTH {
            if left.is_empty() {
                return false;
            }
            if left.len() > SHELL_CELLS {
                return true;
            }
            let halves: Vec<Cell> = left.into_iter().flat_map(Cell::halves).collect();
            left = self.of(&halves);
        }
        !left.is_empty()
    }

    /// A box around everything in `whole` that is not proven empty, found ever finer around an ever
    /// smaller cube.
    fn tight(&self, mut whole: Cell) -> ([f32; 3], [f32; 3]) {
        loop {
            let (low, high) = self.hull(whole);
            let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f32::max);
            let side = 2.0_f32.powf(extent.log2().ceil());
            if side > whole.side / 4.0 || side < FINEST {
                return (low, high);
            }
            whole = Cell { low, side };
        }
    }

    /// The smallest box around the smallest cells of `whole` that are not proven empty; `whole` if
    /// all are.
    fn hull(&self, whole: Cell) -> ([f32; 3], [f32; 3]) {
        let smallest = whole.side / 2.0_f32.powi(BOX_DEPTH as i32);
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let mut open = vec![whole];
        while let Some(cell) = open.pop() {
            let ends = cell.high();
            let known = (0..3).all(|axis| low[axis] <= cell.low[axis] && ends[axis] <= high[axis]);
            if known {
                continue;
            }
            if cell.side > smallest {
                let halves: Vec<Cell> = cell.halves().collect();
                open.extend(self.of(&halves));
            } else {
                for axis in 0..3 {
                    low[axis] = low[axis].min(cell.low[axis]);
                    high[axis] = high[axis].max(ends[axis]);
                }
            }
        }
        if low[0] > high[0] { (whole.low, whole.high()) } else { (low, high) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell as Counter;
    use zeroset_eval::Zeros;

    fn find(surfaces: &[&dyn Kernel<FindZeros>], periodic: bool) -> AutoDomain {
        find_while(surfaces, periodic, &|| true).expect("wanted to the end")
    }

    #[test]
    fn a_search_that_is_no_longer_wanted_ends_without_an_answer() {
        let ball = Ball([3.0, 0.0, -20.0], 0.5);
        let asked = Counter::new(0);
        let until = |last: u32| {
            asked.set(0);
            find_while(&[&ball], false, &|| {
                asked.set(asked.get() + 1);
                asked.get() <= last
            })
        };
        assert!(until(u32::MAX).is_some());
        let all = asked.get();
        for last in [0, 1, all / 2, all - 1] {
            assert_eq!(until(last), None, "asked {last} of {all} times");
            assert!(asked.get() < last + 64, "{} evaluations after {last}", asked.get());
        }
    }

    /// |p − centre|² − r², as intervals in f64: exact enough for these sizes.
    struct Ball([f32; 3], f32);

    impl Kernel<FindZeros> for Ball {
        fn ask(&self, boxes: &Boxes, zeros: &mut Zeros) {
            *zeros = Zeros::default();
            for lane in 0..boxes.count as usize {
                let (mut low, mut high) = (0.0, 0.0);
                for axis in 0..3 {
                    let a = -boxes.neg_lo[axis][lane] - self.0[axis];
                    let b = boxes.hi[axis][lane] - self.0[axis];
                    high += a.abs().max(b.abs()).powi(2);
                    low += if a <= 0.0 && b >= 0.0 { 0.0 } else { a.abs().min(b.abs()).powi(2) };
                }
                let square = self.1 * self.1;
                zeros.possible |= u16::from(low <= square && square <= high) << lane;
            }
        }
    }

    /// The plane z = height.
    struct Plane(f32);

    impl Kernel<FindZeros> for Plane {
        fn ask(&self, boxes: &Boxes, zeros: &mut Zeros) {
            *zeros = Zeros::default();
            for lane in 0..boxes.count as usize {
                let (low, high) = (-boxes.neg_lo[2][lane], boxes.hi[2][lane]);
                zeros.possible |= u16::from(low <= self.0 && self.0 <= high) << lane;
            }
        }
    }

    #[test]
    fn a_ball_is_bounded_by_a_snug_box() {
        for (centre, radius) in
            [([0.0; 3], 1.0_f32), ([3.0, 0.0, -20.0], 0.5), ([-100.0, 7.0, 0.25], 0.03125)]
        {
            let found = find(&[&Ball(centre, radius)], false);
            assert_eq!(found.finding, Finding::Bounded);
            for (axis, c) in centre.into_iter().enumerate() {
                let (c, r) = (f64::from(c), f64::from(radius));
                assert!(found.low[axis] < c - r && c + r < found.high[axis], "{found:?}");
                assert!(found.high[axis] - found.low[axis] < 2.6 * r, "{found:?}");
            }
        }
    }

    #[test]
    fn a_plane_is_unbounded_and_seen() {
        let found = find(&[&Plane(0.0)], false);
        assert_eq!((found.finding, found.high), (Finding::Unbounded, [2.0; 3]));
        assert_eq!(find(&[&Plane(0.0)], true).high, [std::f64::consts::TAU; 3]);
        // Far away: the first cube that reaches it.
        assert_eq!(find(&[&Plane(100.0)], false).high, [128.0; 3]);
    }

    #[test]
    fn what_is_not_there_is_proven_empty() {
        assert_eq!(find(&[&Plane(300.0)], false).finding, Finding::Empty);
    }

    #[test]
    fn two_surfaces_share_a_domain() {
        let far = Ball([5.0, 0.0, 0.0], 1.0);
        let found = find(&[&Ball([0.0; 3], 1.0), &far], false);
        assert!(found.low[0] < -1.0 && found.high[0] > 6.0 && found.high[1] < 3.0, "{found:?}");
    }

    #[test]
    fn bounds_have_few_digits() {
        let (low, high) = roomy([-1.0; 3], [1.0; 3]);
        assert_eq!((low, high), ([-1.1; 3], [1.1; 3]));
        let (low, high) = roomy([-130.0; 3], [128.0; 3]);
        assert_eq!((low, high), ([-143.0; 3], [141.0; 3]));
    }
}
