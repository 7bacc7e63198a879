//! A window on a surface that has no end, chosen by what is particular of it: its centre, where it
//! meets the lines through that along the axes and how near it comes, its critical points, its
//! periods, the heights of a graph.
//!
//! What is chosen is a matter of judgement, and nothing here is a proof. Knows neither cameras nor
//! pictures.

use super::FLAT;
use super::climb;
use super::critical::{Found, Seeker};
use super::ground;
use super::heights::{self, Grid, shown};
use super::shape::Shape;
use super::tops::around_tops;
use super::waves::{Wave, calm};
use zeroset_eval::{Kernel, Sample};
use zeroset_space::{BOX_DEPTH, Cell, PLAIN, Search};

/// A window reaches so many times farther than what is particular; so many times if it is a plane.
const ROOM: f64 = 2.5;
const ROOM_OF_PLANE: f64 = 1.3;

/// It reaches at least so many times farther than critical points that are not on the lines through
/// the centre: the surface that is near them goes on.
const ROOM_OF_CRITICAL: f64 = 1.45;

/// A window whose centre is nearer to the origin on an axis than this share of its half side is one
/// around the origin there; other centres have digits down to that share.
const CENTRED: f64 = 0.05;
const GRAIN: f64 = 0.01;

/// So are the ends of the ground over which a graph has heights, to this share.
const GRAIN_OF_GROUND: f64 = 1e-3;

/// A centre is known to within this share of its largest coordinate: what is nearer to it is at it.
const KNOWN: f64 = 1e-9;

/// A box is as good as a cube if its sides are no shorter than this share of the longest, and as
/// good as about the origin if opposite faces differ in distance by no more than this share of it.
const NEARLY_CUBE: f64 = 0.8;
const OFF_CENTRE: f64 = 0.1;

/// A window in which there is nothing is doubled less often than this.
const DOUBLINGS: i32 = 6;

/// A place on an axis is known to within this share of itself before it is looked for.
const NEAR: f64 = 0.01;

/// A surface along which nothing changes is so many times longer than wide.
const ROD: f64 = 1.6;

/// What is looked for lies between two to these powers; where functions grow exponentially, between
/// the last two.
const SMALLEST: i32 = -40;
const LARGEST: i32 = 41;
const LARGEST_OF_ANY: i32 = 5;

/// Where one surface is looked at.
pub struct Sight<'a> {
    pub search: &'a Search<'a>,
    pub shape: Shape,
    /// The function's values.
    pub values: &'a dyn Kernel<Sample, f64>,
    /// The place about which it is arranged.
    pub centre: [f64; 3],
    /// Those of what it waves with that is not linear.
    pub waves: Vec<&'a Wave<'a>>,
}

impl Sight<'_> {
    /// The window on the surface, and whether it looks better cut by a ball.
    pub fn window(mut self) -> (Cell, bool) {
        // Where there is nothing, or all is alike, the origin is as good a place as any, and easier
        // to read.
        let Shape { depends, period, is_plane, .. } = self.shape;
        let counts = |axis: usize| depends[axis] && period[axis].is_none() && !is_plane;
        self.centre = [0, 1, 2].map(|axis| if counts(axis) { self.centre[axis] } else { 0.0 });
        // A line that is off by rounding meets far away what it should be parallel to.
        let known = self.known();
        self.centre = self.centre.map(|along| super::rounded(along, known));
        let half = self.half();
        // What is particular moves with the surface, and so does the size.
        self.centre = self.centre.map(|along| {
            if along.abs() <= CENTRED * half { 0.0 } else { super::rounded(along, GRAIN * half) }
        });
        let cell = self.cell(half);
        (cell, self.is_round(&cell))
    }

    /// Whether a surface that goes on alike in all directions is cut off there: edges that a box
    /// makes are then taken for its own. What is flat, repeats, or is as high as a function of two
    /// axes is read against the box.
    fn is_round(&self, cell: &Cell) -> bool {
        let Shape { depends, period, ref waves, is_of_planes, height, .. } = self.shape;
        let is_flat = is_of_planes || height.is_some() || depends.contains(&false);
        let repeats = !waves.is_empty() || period.iter().any(Option::is_some);
        let largest = cell.largest();
        let is_cube = (0..3).all(|axis| {
            let off = cell.low[axis] + cell.high[axis] - 2.0 * self.centre[axis];
            cell.extent(axis) >= NEARLY_CUBE * largest && off.abs() <= OFF_CENTRE * largest
        });
        !is_flat && !repeats && is_cube
    }

    /// Half the side of the window that shows what is particular.
    fn half(&self) -> f64 {
        let Shape { period, is_plane, height, .. } = self.shape;
        let on_ground = |axis: usize| height.is_none_or(|(up, _)| axis != up);
        let periods = (0..3).filter(|axis| on_ground(*axis)).filter_map(|axis| period[axis]);
        let longest = periods.fold(0.0_f64, f64::max);
        if longest > 0.0 {
            return longest;
        }
        if let Some(half) = calm(&self.waves, self.centre, [0, 1, 2].map(on_ground)) {
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
            return if reach == 0.0 { PLAIN } else { few_digits(ROOM_OF_PLANE * reach) };
        }
        let plain = if reach == 0.0 { PLAIN } else { ROOM * reach };
        let Found { farthest, nearest } = self.critical(plain);
        let half = if reach > 0.0 {
            plain.max(ROOM_OF_CRITICAL * farthest.max(nearest.unwrap_or(0.0)))
        } else if farthest > 0.0 {
            ROOM_OF_CRITICAL * farthest
        } else {
            PLAIN
        };
        few_digits(half)
    }

    /// The window with this half side.
    fn cell(&self, half: f64) -> Cell {
        let Shape { depends, is_plane, height, .. } = self.shape;
        if let Some((up, factor)) = height {
            return self.graph(up, factor, half);
        }
        if is_plane && depends.iter().filter(|depends| **depends).count() == 1 {
            // Across an axis: around the place where it meets it.
            let mut window = Cell::cube(PLAIN);
            let axis = depends.iter().position(|depends| *depends).unwrap_or_default();
            let marks = self.landmarks();
            let near = marks.low[axis] + marks.high[axis];
            let about = PLAIN.max(NEAR * near.abs());
            (window.low[axis], window.high[axis]) = (near - about, near + about);
            let found = self.search.tight(window, BOX_DEPTH).unwrap_or(window).centre()[axis];
            // What is as good as a short decimal is one.
            let short = (found * 100.0).round() / 100.0;
            let middle = if short.is_finite() { short } else { found };
            (window.low[axis], window.high[axis]) = (middle - PLAIN / 2.0, middle + PLAIN / 2.0);
            return window;
        }
        // Where there is nothing, it is farther away.
        let halves = (0..DOUBLINGS).map(|k| half * f64::from(k).exp2());
        let mut cubes = halves.map(|half| (half, super::cube_about(self.centre, half)));
        let found = cubes.find_map(|(half, cube)| Some((half, self.pruned(cube)?)));
        let (half, window) = found.unwrap_or((half, super::cube_about(self.centre, half)));
        match self.shape.profile {
            Some(profile) => self.trimmed(window, profile, half),
            None => window,
        }
    }

    /// The window without what intervals cannot tell from heights of a function of one axis, as
    /// where 0 is divided by 0.
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
        super::thick(window, FLAT)
    }

    /// The cube around the centre.
    fn cube(&self, half: f64) -> Cell {
        Cell::about(self.centre, half)
    }

    /// Where critical points are that are about as far from the centre as the end of a window that
    /// is known, or as lengths are that people type.
    fn critical(&self, half: f64) -> Found {
        let sizes = [half, 4.0 * half, PLAIN, 4.0 * PLAIN];
        let is_new =
            |n: &usize| sizes[..*n].iter().all(|other| !(0.5..=2.0).contains(&(sizes[*n] / other)));
        let find = |n: usize| {
            let Self { search, values, centre, .. } = *self;
            Seeker { search, values, depends: self.shape.depends, centre, half: sizes[n] }.find()
        };
        (0..sizes.len()).filter(is_new).map(find).fold(Found::default(), Found::and)
    }

    /// The part of a window that may hold the surface, if there is any. Where nothing changes along
    /// an axis, as much of it as fits the rest.
    fn pruned(&self, window: Cell) -> Option<Cell> {
        let hull = self.search.tight(window, BOX_DEPTH)?;
        let Shape { depends, .. } = self.shape;
        let across = (0..3).filter(|axis| depends[*axis]);
        let widest = across.map(|axis| hull.extent(axis)).fold(0.0, f64::max) / 2.0;
        let mut hull = super::roomy(&hull);
        for (axis, depends) in depends.into_iter().enumerate() {
            if !depends {
                // A line is as long as the window.
                let is_line = widest < FLAT * window.high[axis];
                let most = window.high[axis];
                let half = if is_line { most } else { most.min(ROD * widest) };
                (hull.low[axis], hull.high[axis]) = (-half, half);
            }
            hull.low[axis] = hull.low[axis].max(window.low[axis]);
            hull.high[axis] = hull.high[axis].min(window.high[axis]);
        }
        Some(super::thick(hull, FLAT))
    }

    /// The heights of what is as high as a function of two axes, at places on the ground as seen
    /// from the centre: `factor` times the height is minus the function where the height is 0.
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

    /// The same of what is as high as a function of one axis: of a ridge that is as long as the
    /// window one place counts.
    fn ridge(&self, (up, along, factor): (usize, usize, f64), places: &[[f64; 2]]) -> Vec<f64> {
        let across = usize::from((up + 1) % 3 == along);
        let is_middle = |place: &&[f64; 2]| place[across] == 0.0;
        let middle: Vec<[f64; 2]> = places.iter().filter(is_middle).copied().collect();
        let mut heights = self.heights(up, factor, &middle).into_iter();
        let mut height = |place| if is_middle(&place) { heights.next() } else { None };
        places.iter().map(|place| height(place).unwrap_or(f64::NAN)).collect()
    }

    /// The window on what is as high as a function of two axes, with this half side on the ground.
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
        super::thick(window, FLAT)
    }

    /// A box, as seen from the centre, around that, the places where the surface meets the lines
    /// through it along the axes, or else a cube that it does not enter.
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

    /// What is nearer to the centre than this is at it.
    fn known(&self) -> f64 {
        KNOWN * self.centre.iter().fold(0.0_f64, |most, along| most.max(along.abs()))
    }

    /// How far from the centre the surface may meet half a line along an axis, as far as that is
    /// narrowed down to places.
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
        // Where nothing can be told any more, rounding has taken over, and before that it is what
        // is found.
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

    /// How far from the centre the surface may meet a part of a line along an axis; `None` if that
    /// is not narrowed down.
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

    /// About how far the surface stays away from the centre, in the largest coordinate; 0 if it
    /// does not.
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

/// Half an axis is looked through octave by octave, each halved so often; if more parts of one may
/// meet the surface than that, it lies along the axis, or intervals do not tell.
const HALVINGS: usize = 9;
const MOST_PLACES: usize = 16;

/// Of more octaves than these up to the farthest, nothing can be told only because of rounding.
const FEW_OCTAVES: usize = 2;

/// A length with three digits.
fn few_digits(length: f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(length)
}
