//! A window on an unbounded surface, chosen by its features: its center, its intersections with the
//! lines through the center along the axes, its distance from the center, its critical points, its
//! periods, the heights of a graph.
//!
//! The choice is a heuristic; nothing here is a proof. This module depends neither on cameras nor
//! on pictures.

use super::critical::{CriticalDistances, CriticalSearch};
use super::heights::{self, Grid, shown};
use super::shape::GraphShape;
use super::tops::around_tops;
use super::waves::{Wave, resolvable_half};
use super::{BOX_DEPTH, DEFAULT_HALF, FLAT, climb, ground};
use zeroset_eval::{Kernel, Sample};
use zeroset_space::{Cell, CellSearch};

/// Ratio of a window's extent to the extent of the features in it, in general and for a plane.
const MARGIN: f64 = 2.5;
const MARGIN_OF_PLANE: f64 = 1.3;

/// Least ratio of a window's half side to the distance of critical points from the center. Critical
/// points on the lines through the center along the axes do not count.
const MARGIN_OF_CRITICAL: f64 = 1.45;

/// A coordinate of a window's center becomes 0 if it is at most this share of the half side. Other
/// coordinates are rounded to `GRAIN` of the half side.
const CENTRED: f64 = 0.05;
const GRAIN: f64 = 0.01;

/// If a graph has heights in a part of the window only, the bound of that part is rounded to this
/// share of the half side.
const GRAIN_OF_GROUND: f64 = 1e-3;

/// Accuracy of a center, relative to its largest coordinate. A place within this accuracy counts as
/// the center.
const KNOWN: f64 = 1e-9;

/// Conditions for a ball. All sides are at least `NEARLY_CUBE` of the longest. The distances of
/// opposite faces from the center differ by at most `OFF_CENTRE` of the longest side.
const NEARLY_CUBE: f64 = 0.8;
const OFF_CENTRE: f64 = 0.1;

/// Number of window sizes that are tried while the window is empty. Each size is twice the previous
/// one.
const DOUBLINGS: i32 = 6;

/// Relative accuracy of the first estimate of where a plane crosses an axis.
const NEAR: f64 = 0.01;

/// Length of the window along an axis on which the function does not depend, in multiples of its
/// width.
const ROD: f64 = 1.6;

/// Exponents, to base 2, of the smallest and the largest distance that are searched.
/// `LARGEST_OF_ANY` replaces `LARGEST` for functions that are not polynomials and may grow
/// exponentially.
const SMALLEST: i32 = -40;
const LARGEST: i32 = 41;
const LARGEST_OF_ANY: i32 = 5;

/// The data from which the window on one surface is chosen.
pub struct WindowChooser<'a> {
    pub search: &'a CellSearch<'a>,
    pub shape: GraphShape,
    /// The kernel for the function's values.
    pub values: &'a dyn Kernel<Sample, f64>,
    pub centre: [f64; 3],
    /// The nonlinear arguments of the function's sines, cosines and tangents.
    pub waves: Vec<&'a Wave<'a>>,
}

impl WindowChooser<'_> {
    /// Returns the window on the surface, and whether it looks better clipped to a ball.
    pub fn window(mut self) -> (Cell, bool) {
        // Along an axis without features, the center is set to the origin, which is easier to read.
        let GraphShape { depends, period, is_plane, .. } = self.shape;
        let counts = |axis: usize| depends[axis] && period[axis].is_none() && !is_plane;
        self.centre = [0, 1, 2].map(|axis| if counts(axis) { self.centre[axis] } else { 0.0 });
        // A rounding error in the center would make lines through it meet surfaces that they are
        // parallel to.
        let known = self.known();
        self.centre = self.centre.map(|along| super::rounded(along, known));
        let half = self.half();
        // The size does not depend on where the surface lies, so the center can be rounded to a
        // share of the size.
        self.centre = self.centre.map(|along| {
            if along.abs() <= CENTRED * half { 0.0 } else { super::rounded(along, GRAIN * half) }
        });
        let cell = self.cell(half);
        (cell, self.is_round(&cell))
    }

    /// Returns whether the surface continues alike in all directions. A box would then cut edges
    /// that look like the surface's own. Planes, periodic surfaces and graphs over two axes look
    /// better in the box.
    fn is_round(&self, cell: &Cell) -> bool {
        let GraphShape { depends, period, ref waves, is_of_planes, height, .. } = self.shape;
        let is_flat = is_of_planes || height.is_some() || depends.contains(&false);
        let repeats = !waves.is_empty() || period.iter().any(Option::is_some);
        let largest = cell.largest();
        let is_cube = (0..3).all(|axis| {
            let off = cell.low[axis] + cell.high[axis] - 2.0 * self.centre[axis];
            cell.extent(axis) >= NEARLY_CUBE * largest && off.abs() <= OFF_CENTRE * largest
        });
        !is_flat && !repeats && is_cube
    }

    /// Half the side of the window that shows the features.
    fn half(&self) -> f64 {
        let GraphShape { period, is_plane, height, .. } = self.shape;
        let on_ground = |axis: usize| height.is_none_or(|(up, _)| axis != up);
        let periods = (0..3).filter(|axis| on_ground(*axis)).filter_map(|axis| period[axis]);
        let longest = periods.fold(0.0_f64, f64::max);
        if longest > 0.0 {
            return longest;
        }
        if let Some(half) = resolvable_half(&self.waves, self.centre, [0, 1, 2].map(on_ground)) {
            return few_digits(half);
        }
        if let Some((up, factor)) = height {
            return few_digits(around_tops(&|places| self.heights(up, factor, places)));
        }
        if let Some(profile) = self.shape.profile {
            return few_digits(around_tops(&|places| self.ridge(profile, places)));
        }
        let reach = self.landmarks().reach();
        if is_plane {
            return if reach == 0.0 { DEFAULT_HALF } else { few_digits(MARGIN_OF_PLANE * reach) };
        }
        let plain = if reach == 0.0 { DEFAULT_HALF } else { MARGIN * reach };
        let CriticalDistances { farthest, nearest } = self.critical(plain);
        let half = if reach > 0.0 {
            plain.max(MARGIN_OF_CRITICAL * farthest.max(nearest.unwrap_or(0.0)))
        } else if farthest > 0.0 {
            MARGIN_OF_CRITICAL * farthest
        } else {
            DEFAULT_HALF
        };
        few_digits(half)
    }

    /// The window with this half side.
    fn cell(&self, half: f64) -> Cell {
        let GraphShape { depends, is_plane, height, .. } = self.shape;
        if let Some((up, factor)) = height {
            return self.graph(up, factor, half);
        }
        if is_plane && depends.iter().filter(|depends| **depends).count() == 1 {
            // A plane across one axis: the window is around its intersection with that axis.
            let mut window = Cell::cube(DEFAULT_HALF);
            let axis = depends.iter().position(|depends| *depends).unwrap_or_default();
            let marks = self.landmarks();
            let near = marks.low[axis] + marks.high[axis];
            let about = DEFAULT_HALF.max(NEAR * near.abs());
            (window.low[axis], window.high[axis]) = (near - about, near + about);
            let found = self.search.tight(window, BOX_DEPTH).unwrap_or(window).centre()[axis];
            // The middle is rounded to two decimals.
            let short = (found * 100.0).round() / 100.0;
            let middle = if short.is_finite() { short } else { found };
            (window.low[axis], window.high[axis]) =
                (middle - DEFAULT_HALF / 2.0, middle + DEFAULT_HALF / 2.0);
            return window;
        }
        // An empty window means that the surface is farther away.
        let halves = (0..DOUBLINGS).map(|k| half * f64::from(k).exp2());
        let mut cubes = halves.map(|half| (half, super::cube_about(self.centre, half)));
        let found = cubes.find_map(|(half, cube)| Some((half, self.pruned(cube)?)));
        let (half, window) = found.unwrap_or((half, super::cube_about(self.centre, half)));
        match self.shape.profile {
            Some(profile) => self.trimmed(window, profile, half),
            None => window,
        }
    }

    /// Cuts off parts of the window in which a graph over one axis has no heights. Intervals may
    /// fail to exclude these parts, as where 0 is divided by 0.
    fn trimmed(&self, mut window: Cell, profile: (usize, usize, f64), half: f64) -> Cell {
        let up = profile.0;
        let heights = |places: &[[f64; 2]]| self.ridge(profile, places);
        let [lowest, highest] = heights::ends_of_ridge(&heights, half);
        let height = highest - lowest;
        if window.low[up] < lowest - height || window.high[up] > highest + height {
            let space = super::SPACE * height;
            let [low, high] = [lowest - space, highest + space].map(few_digits);
            window.low[up] = window.low[up].max(low);
            window.high[up] = window.high[up].min(high);
        }
        super::thickened(window, FLAT)
    }

    fn cube(&self, half: f64) -> Cell {
        Cell::about(self.centre, half)
    }

    /// Finds critical points in cubes around the center. Their half sides are `half`,
    /// [`DEFAULT_HALF`], which is typical of typed formulas, and four times each.
    fn critical(&self, half: f64) -> CriticalDistances {
        let sizes = [half, 4.0 * half, DEFAULT_HALF, 4.0 * DEFAULT_HALF];
        let is_new =
            |n: &usize| sizes[..*n].iter().all(|other| !(0.5..=2.0).contains(&(sizes[*n] / other)));
        let find = |n: usize| {
            let Self { search, values, centre, .. } = *self;
            CriticalSearch { search, values, depends: self.shape.depends, centre, half: sizes[n] }
                .find()
        };
        (0..sizes.len())
            .filter(is_new)
            .map(find)
            .fold(CriticalDistances::default(), CriticalDistances::and)
    }

    /// The part of a window that may hold the surface; `None` if the window is empty. Along an axis
    /// on which the function does not depend, the length is chosen to fit the other axes.
    fn pruned(&self, window: Cell) -> Option<Cell> {
        let hull = self.search.tight(window, BOX_DEPTH)?;
        let GraphShape { depends, .. } = self.shape;
        let across = (0..3).filter(|axis| depends[*axis]);
        let widest = across.map(|axis| hull.extent(axis)).fold(0.0, f64::max) / 2.0;
        let mut hull = super::with_margin(&hull);
        for (axis, depends) in depends.into_iter().enumerate() {
            if !depends {
                // A line is shown through the whole window.
                let is_line = widest < FLAT * window.high[axis];
                let most = window.high[axis];
                let half = if is_line { most } else { most.min(ROD * widest) };
                (hull.low[axis], hull.high[axis]) = (-half, half);
            }
            hull.low[axis] = hull.low[axis].max(window.low[axis]);
            hull.high[axis] = hull.high[axis].min(window.high[axis]);
        }
        Some(super::thickened(hull, FLAT))
    }

    /// The heights of a graph over two axes, at places relative to the center. The function is
    /// `factor` times the coordinate `up`, plus a function of the place.
    fn heights(&self, up: usize, factor: f64, places: &[[f64; 2]]) -> Vec<f64> {
        let point = |place: &[f64; 2]| {
            let mut point = self.centre;
            point[(up + 1) % 3] += place[0];
            point[(up + 2) % 3] += place[1];
            point
        };
        let points: Vec<[f64; 3]> = places.iter().map(point).collect();
        let values = self.search.values(self.values, &points).into_iter();
        values.map(|value| self.centre[up] - value / factor).collect()
    }

    /// The heights of a graph over the axis `along`, treated as a ridge over two axes. NaN at
    /// places that are not in the middle of the ridge.
    fn ridge(&self, (up, along, factor): (usize, usize, f64), places: &[[f64; 2]]) -> Vec<f64> {
        let across = usize::from((up + 1) % 3 == along);
        let is_middle = |place: &&[f64; 2]| place[across] == 0.0;
        let middle: Vec<[f64; 2]> = places.iter().filter(is_middle).copied().collect();
        let mut heights = self.heights(up, factor, &middle).into_iter();
        let mut height = |place| if is_middle(&place) { heights.next() } else { None };
        places.iter().map(|place| height(place).unwrap_or(f64::NAN)).collect()
    }

    /// The window on a graph over two axes, with this half side along both axes.
    fn graph(&self, up: usize, factor: f64, half: f64) -> Cell {
        let mut window = super::cube_about(self.centre, half);
        let heights = |places: &[[f64; 2]]| self.heights(up, factor, places);
        let grid = Grid::new(&heights, half);
        let ground = ground::ends(&heights, &grid);
        for (axis, side) in [(up + 1) % 3, (up + 2) % 3].into_iter().zip(ground) {
            for (end, side) in [&mut window.low[axis], &mut window.high[axis]].into_iter().zip(side)
            {
                *end = side.map_or(*end, |side| {
                    super::rounded(self.centre[axis] + side, half * GRAIN_OF_GROUND)
                });
            }
        }
        let tops: Vec<f64> = climb::tops(&heights, &grid).iter().map(|top| top.height).collect();
        if let Some(ends) = shown(&grid, &tops) {
            let [low, high] = ends.map(few_digits);
            (window.low[up], window.high[up]) = (low, high);
        }
        super::thickened(window, FLAT)
    }

    /// A box around the surface's intersections with the lines through the center along the axes,
    /// relative to the center. Without intersections, a cube that the surface does not enter.
    fn landmarks(&self) -> Cell {
        let largest = if self.shape.is_polynomial { LARGEST } else { LARGEST_OF_ANY };
        let mut marks = Cell::cube(0.0);
        for axis in 0..3 {
            for side in [1.0, -1.0] {
                for at in self.meets(axis, side, largest) {
                    marks.low[axis] = marks.low[axis].min(side * at);
                    marks.high[axis] = marks.high[axis].max(side * at);
                }
            }
        }
        if marks == Cell::cube(0.0) {
            marks = Cell::cube(self.nearest(largest));
        }
        marks
    }

    /// A place within this distance of the center counts as the center.
    fn known(&self) -> f64 {
        KNOWN * self.centre.iter().fold(0.0_f64, |most, along| most.max(along.abs()))
    }

    /// Distances from the center at which the surface may meet the half line on one `side` of an
    /// axis. Distances that cannot be narrowed down are left out.
    fn meets(&self, axis: usize, side: f64, largest: i32) -> Vec<f64> {
        let known = self.known();
        let stretch = |from: f64, to: f64| {
            let mut cell = self.cube(0.0);
            let (near, far) = (cell.low[axis] + side * from, cell.low[axis] + side * to);
            (cell.low[axis], cell.high[axis]) = (near.min(far), near.max(far));
            cell
        };
        let octaves = (SMALLEST..largest).map(|k| [f64::from(k).exp2(), f64::from(k + 1).exp2()]);
        let octaves =
            octaves.filter(|[from, _]| *from >= known).map(|[from, to]| stretch(from, to));
        let all: Vec<Cell> = octaves.collect();
        let mut left = self.search.open(&all).into_iter().peekable();
        let within = |octave: &Cell| match left.next_if(|open| open == octave) {
            Some(octave) => self.places(axis, octave),
            None => Some(Vec::new()),
        };
        let mut found: Vec<Option<Vec<f64>>> = all.iter().map(within).collect();
        // Octaves at either end that cannot be narrowed down are dominated by rounding. So is the
        // next octave, whose places are spurious.
        let near = found.iter().take_while(|places| places.is_none()).count();
        let far = found.iter().rev().take_while(|places| places.is_none()).count();
        let last = found.len() - far;
        if known > 0.0 || near > 0 {
            found.drain(..found.len().min(near + 1));
        }
        if far > FEW_OCTAVES {
            found.truncate(last.saturating_sub(near + 2));
        }
        found.into_iter().flatten().flatten().collect()
    }

    /// Distances from the center at which the surface may meet a part of a line along an axis.
    /// `None` if they cannot be narrowed down.
    fn places(&self, axis: usize, part: Cell) -> Option<Vec<f64>> {
        let mut open = vec![part];
        for _ in 0..HALVINGS {
            let halves = open.iter().flat_map(|cell| {
                let middle = cell.centre()[axis];
                let [mut near, mut far] = [*cell; 2];
                (near.high[axis], far.low[axis]) = (middle, middle);
                [near, far]
            });
            open = self.search.open(&halves.collect::<Vec<_>>());
            if open.len() > MOST_PLACES {
                return None;
            }
        }
        Some(open.iter().map(|cell| (cell.centre()[axis] - self.centre[axis]).abs()).collect())
    }

    /// The approximate distance of the surface from the center, in the maximum norm; 0 if the
    /// surface comes arbitrarily near.
    fn nearest(&self, largest: i32) -> f64 {
        let known = self.known();
        if !self.search.open(&[self.cube(known)]).is_empty() {
            return 0.0;
        }
        let sizes = (4 * SMALLEST..4 * largest).map(|k| (f64::from(k) / 4.0).exp2());
        let sizes = sizes.filter(|size| *size >= known);
        let clear =
            |half: &f64| self.search.nothing_between(&self.cube(half / 4096.0), &self.cube(*half));
        let sizes: Vec<f64> = sizes.collect();
        let known = sizes.partition_point(clear);
        if known == 0 { 0.0 } else { sizes.get(known).copied().unwrap_or_default() }
    }
}

/// Number of times that each octave of distances along an axis is halved. If more than
/// `MOST_PLACES` parts of an octave may meet the surface, the surface lies along the axis, or
/// intervals cannot decide.
const HALVINGS: usize = 9;
const MOST_PLACES: usize = 16;

/// If more octaves than this cannot be narrowed down at the far end, rounding is the cause.
const FEW_OCTAVES: usize = 2;

/// A length rounded to three digits.
fn few_digits(length: f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(length)
}
