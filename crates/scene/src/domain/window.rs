//! A window on an unbounded surface, chosen by its features: its center, its intersections with the
//! lines through the center along the axes, its distance from the center, its critical points, its
//! periods, the heights of a graph.
//!
//! The choice is a heuristic; nothing here is a proof. This module depends neither on cameras nor
//! on pictures.

use super::critical::{CriticalDistances, CriticalSearch};
use super::shape::{GraphShape, Growth};
use super::waves::{Wave, half_side_for_waves};
use super::{BOX_DEPTH, DEFAULT_HALF, FLAT};
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

/// Accuracy of a center, relative to its largest coordinate. A place within this accuracy counts as
/// the center.
const KNOWN: f64 = 1e-9;

/// Conditions for a ball. All sides are at least `NEARLY_CUBE` of the longest. The distances of
/// opposite faces from the center differ by at most `OFF_CENTRE` of the longest side.
const NEARLY_CUBE: f64 = 0.8;
const OFF_CENTRE: f64 = 0.1;

/// Periods whose ratio is at most this share the window's size. Otherwise each axis shows its own.
const UNEVEN: f64 = 4.0;

/// Number of window sizes that are tried while the window is empty. Each size is twice the previous
/// one.
const DOUBLINGS: i32 = 6;

/// Relative accuracy of the first estimate of where a plane crosses an axis.
const NEAR: f64 = 0.01;

/// Length of the window along an axis on which the function does not depend, in multiples of its
/// width.
const ROD: f64 = 1.6;

/// Exponents, to base 2, of the smallest and the largest distance that are searched.
/// `LARGEST_OF_ANY` replaces `LARGEST` for functions that may grow exponentially.
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
    /// Whether the surface bounds a solid.
    pub is_solid: bool,
    /// Whether the box may have any proportions, since it is stretched for display.
    pub is_stretched: bool,
    /// The proven [bounds](super::bounds) of the surface. Ends without a proof are infinite.
    pub bounds: Cell,
    /// Per axis, whether a graph was found to continue beyond the lower and the upper end of the
    /// window.
    pub cut: [[bool; 2]; 3],
}

/// A window on a surface.
pub struct Window {
    pub cell: Cell,
    /// Whether the surface looks better clipped to a ball.
    pub is_round: bool,
    /// Per axis, whether a graph continues beyond the lower and the upper end.
    pub cut: [[bool; 2]; 3],
}

impl WindowChooser<'_> {
    /// Returns the window on the surface.
    pub fn window(mut self) -> Window {
        // Along an axis without features, the center is set to the origin, which is easier to read.
        let GraphShape { depends, period, is_plane, .. } = self.shape;
        let counts = |axis: usize| depends[axis] && period[axis].is_none() && !is_plane;
        self.centre = [0, 1, 2].map(|axis| if counts(axis) { self.centre[axis] } else { 0.0 });
        // A rounding error in the center would make lines through it meet surfaces that they are
        // parallel to.
        let known = self.known();
        self.centre = self.centre.map(|along| super::rounded(along, known));
        if self.shape.graph.is_some_and(|graph| graph.along.is_some()) && !self.is_profile() {
            self.shape.graph = None;
        }
        let halves = self.halves();
        let half = halves.into_iter().fold(0.0, f64::max);
        // The size does not depend on where the surface lies, so the center can be rounded to a
        // share of the size.
        self.centre = self.centre.map(|along| {
            if along.abs() <= CENTRED * half { 0.0 } else { super::rounded(along, GRAIN * half) }
        });
        let cell = self.cell(halves);
        let whole = match self.shape.graph {
            Some(_) => None,
            None => self.whole_where_bounded(&cell, half != DEFAULT_HALF),
        };
        let is_round = whole.is_none() && self.is_round(&cell);
        Window { cell: whole.unwrap_or(cell), is_round, cut: self.cut }
    }

    /// Returns whether the surface continues alike in all directions. A box would then cut edges
    /// that look like the surface's own. Planes, periodic surfaces and graphs over two axes look
    /// better in the box.
    fn is_round(&self, cell: &Cell) -> bool {
        let GraphShape { depends, period, ref waves, is_of_planes, graph, .. } = self.shape;
        let is_flat = is_of_planes || graph.is_some() || depends.contains(&false);
        let repeats = !waves.is_empty() || period.iter().any(Option::is_some);
        let largest = cell.largest();
        let is_cube = (0..3).all(|axis| {
            let off = cell.low[axis] + cell.high[axis] - 2.0 * self.centre[axis];
            cell.extent(axis) >= NEARLY_CUBE * largest && off.abs() <= OFF_CENTRE * largest
        });
        !is_flat && !repeats && is_cube
    }

    /// Half the sides of the window that shows the features.
    fn halves(&self) -> [f64; 3] {
        let GraphShape { period, graph, .. } = self.shape;
        let height = graph.filter(|graph| graph.along.is_none());
        let on_ground = |axis: usize| height.is_none_or(|graph| axis != graph.up);
        let on_ground = [0, 1, 2].map(on_ground);
        let periods = [0, 1, 2].map(|axis| period[axis].filter(|_| on_ground[axis]));
        let longest = periods.into_iter().flatten().fold(0.0_f64, f64::max);
        if longest > 0.0 {
            return [0, 1, 2].map(|axis| match periods[axis] {
                Some(_) if self.shape.has_cells[axis] => self.whole_cells(axis),
                Some(period) if longest > UNEVEN * period => period,
                _ => longest,
            });
        }
        if let Some(half) = half_side_for_waves(&self.waves, self.centre, on_ground) {
            return [few_digits(half); 3];
        }
        if let Some(graph) = self.shape.graph {
            return self.halves_of_graph(graph);
        }
        [self.half(); 3]
    }

    /// Half the side of a window of whole cells along an axis on which cells repeat: two cells if
    /// the surface does not cross the faces of the window, or else three.
    fn whole_cells(&self, axis: usize) -> f64 {
        let period = self.shape.period[axis].unwrap_or(DEFAULT_HALF);
        let is_clear = |half: &f64| {
            let mut face = Cell::cube(*half);
            for other in (0..3).filter(|other| *other != axis) {
                let half = self.shape.period[other].unwrap_or(*half);
                (face.low[other], face.high[other]) = (-half, half);
            }
            (face.low[axis], face.high[axis]) = (*half, *half);
            self.search.tight(face, BOX_DEPTH).is_none()
        };
        [period, 1.5 * period].into_iter().find(is_clear).unwrap_or(period)
    }

    /// Half the side of the window that shows the features of a surface that neither repeats nor is
    /// a graph.
    fn half(&self) -> f64 {
        let is_plane = self.shape.is_plane;
        let reach = self.landmarks().reach();
        if is_plane || self.shape.is_of_planes && self.is_solid {
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

    /// The window with these half sides.
    fn cell(&mut self, halves: [f64; 3]) -> Cell {
        let GraphShape { depends, is_plane, .. } = self.shape;
        let half = halves.into_iter().fold(0.0, f64::max);
        if let Some(graph) = self.shape.graph {
            let ground = [1, 2].map(|k| halves[(graph.up + k) % 3]);
            if let Some(window) = self.graph(graph, ground) {
                return window;
            }
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
        let about = |scale: f64| {
            let mut window = super::cube_about(self.centre, scale * half);
            for axis in (0..3).filter(|axis| halves[*axis] != half) {
                let side = scale * halves[axis];
                (window.low[axis], window.high[axis]) = (-side, side);
            }
            window
        };
        let scales = (0..DOUBLINGS).map(|k| f64::from(k).exp2());
        let found = { scales }.find_map(|scale| self.pruned(about(scale)));
        found.unwrap_or(about(1.0))
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
            CriticalSearch {
                search,
                values,
                depends: self.shape.depends,
                centre: centre.into(),
                half: sizes[n],
            }
            .find()
        };
        (0..sizes.len())
            .filter(is_new)
            .map(find)
            .fold(CriticalDistances::default(), CriticalDistances::and)
    }

    /// The part of a window that may hold the surface; `None` if the window is empty. Along an axis
    /// on which the function does not depend, the length is chosen to fit the other axes.
    pub(super) fn pruned(&self, window: Cell) -> Option<Cell> {
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
                let half = if is_line { most } else { most.min(few_digits(ROD * widest)) };
                (hull.low[axis], hull.high[axis]) = (-half, half);
            }
            hull.low[axis] = hull.low[axis].max(window.low[axis]);
            hull.high[axis] = hull.high[axis].min(window.high[axis]);
        }
        Some(super::thickened(hull, FLAT))
    }

    /// A box around the surface's intersections with the lines through the center along the axes,
    /// relative to the center. Without intersections, a cube that the surface does not enter.
    fn landmarks(&self) -> Cell {
        let is_slow = self.shape.growth != Growth::Unlimited;
        let largest = if is_slow { LARGEST } else { LARGEST_OF_ANY };
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
pub(super) fn few_digits(length: f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(length)
}
