//! A window on a surface that has no end, chosen by what is particular of it: where it meets the axes and how near it comes to
//! the origin, its periods, the heights of a graph.
//!
//! What is chosen is a matter of judgement, and nothing here is a proof. Knows neither cameras nor pictures.

use super::cells::{BOX_DEPTH, Cell, Search};
use super::heights::{Grid, Heights, shown};
use super::shape::Shape;
use std::f64::consts::PI;
use zeroset_eval::{Kernel, LANES, Points, Sample, Values};

/// Half the side of the window on a surface that is like itself at every scale.
pub const PLAIN: f64 = 2.0;

/// A window reaches so many times farther than what is particular; so many times if it is a plane.
const ROOM: f64 = 2.5;
const ROOM_OF_PLANE: f64 = 1.3;

/// A graph's window reaches so many times farther than its highest and lowest points.
const ROOM_OF_GRAPH: f64 = 1.6;

/// What waves with another than a linear function of place is shown while that function's size is below this.
const WAVES: f64 = 4.5 * PI;

/// A box is as good as a cube if its sides are no shorter than this share of the longest, and as good as about the origin if
/// opposite faces differ in distance by no more than this share of it.
const NEARLY_CUBE: f64 = 0.8;
const OFF_CENTRE: f64 = 0.1;

/// A place on an axis is known to within this share of itself before it is looked for.
const NEAR: f64 = 0.01;

/// A surface along which nothing changes is so many times longer than wide.
const ROD: f64 = 1.6;

/// Of what has more tops than these in a wide window, so many are shown across.
const MOST_TOPS: usize = 24;
const TOPS_ACROSS: f64 = 10.0;

/// How far from the origin tops are looked for.
const FAR: f64 = 8.0;

/// What is looked for lies between two to these powers; where functions grow exponentially, between the last two.
const SMALLEST: i32 = -40;
const LARGEST: i32 = 41;
const LARGEST_OF_ANY: i32 = 5;

/// Where one surface is looked at.
pub struct Sight<'a> {
    pub search: &'a Search<'a>,
    pub shape: Shape,
    /// The function's values.
    pub values: &'a dyn Kernel<Sample, f64>,
    /// Those of the first argument of a sine that is not linear, if there is one.
    pub waves: Option<&'a dyn Fn([f64; 3]) -> f64>,
}

impl Sight<'_> {
    /// The window on the surface, and whether it looks better cut by a ball.
    pub fn window(&self) -> (Cell, bool) {
        let cell = self.cell();
        (cell, self.is_round(&cell))
    }

    /// Whether a surface that goes on alike in all directions is cut off there: edges that a box makes are then taken for its
    /// own. What is flat, repeats, or is as high as a function of two axes is read against the box.
    fn is_round(&self, cell: &Cell) -> bool {
        let Shape { depends, period, waves, is_of_planes, height, .. } = self.shape;
        let is_flat = is_of_planes || height.is_some() || depends.contains(&false);
        let repeats = waves.is_some() || period.iter().any(Option::is_some);
        let largest = cell.largest();
        let is_cube = (0..3).all(|axis| {
            let off = cell.low[axis] + cell.high[axis];
            cell.extent(axis) >= NEARLY_CUBE * largest && off.abs() <= OFF_CENTRE * largest
        });
        !is_flat && !repeats && is_cube
    }

    fn cell(&self) -> Cell {
        let Shape { depends, period, is_plane, height, .. } = self.shape;
        if let Some((axis, factor)) = height {
            return self.graph(axis, factor);
        }
        let longest = period.iter().flatten().fold(0.0_f64, |most, period| most.max(*period));
        if longest > 0.0 {
            return self.pruned(Cell::cube(longest), depends);
        }
        if let Some(waves) = self.waves {
            return self.pruned(Cell::cube(few_digits(Self::calm(waves, [true; 3]))), depends);
        }
        let marks = self.landmarks();
        let reach = (0..3).map(|axis| marks.high[axis].max(-marks.low[axis])).fold(0.0, f64::max);
        if is_plane && depends.iter().filter(|depends| **depends).count() == 1 {
            // Across an axis: around the place where it meets it.
            let mut window = Cell::cube(PLAIN);
            let axis = depends.iter().position(|depends| *depends).unwrap_or_default();
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
        if reach == 0.0 {
            return self.pruned(Cell::cube(PLAIN), depends);
        }
        let room = if is_plane { ROOM_OF_PLANE } else { ROOM };
        self.pruned(Cell::cube(few_digits(room * reach)), depends)
    }

    /// The part of a window that may hold the surface. Where nothing changes along an axis, as much of it as fits the rest.
    fn pruned(&self, window: Cell, depends: [bool; 3]) -> Cell {
        let Some(hull) = self.search.tight(window, BOX_DEPTH) else { return window };
        let across = (0..3).filter(|axis| depends[*axis]);
        let widest = across.map(|axis| hull.extent(axis)).fold(0.0, f64::max) / 2.0;
        let mut hull = super::roomy(&hull);
        for (axis, depends) in depends.into_iter().enumerate() {
            if !depends {
                let half = (ROD * widest).min(window.high[axis]);
                (hull.low[axis], hull.high[axis]) = (-half, half);
            }
            hull.low[axis] = hull.low[axis].max(window.low[axis]);
            hull.high[axis] = hull.high[axis].min(window.high[axis]);
        }
        super::thick(hull)
    }

    /// The window on what is as high as a function of two axes: `factor` times the height is minus that.
    fn graph(&self, up: usize, factor: f64) -> Cell {
        let Shape { period, .. } = self.shape;
        let ground = [(up + 1) % 3, (up + 2) % 3];
        let heights = |places: &[[f64; 2]]| -> Vec<f64> {
            let point = |place: &[f64; 2]| {
                let mut point = [0.0; 3];
                (point[ground[0]], point[ground[1]]) = (place[0], place[1]);
                point
            };
            let points: Vec<[f64; 3]> = places.iter().map(point).collect();
            self.values(self.values, &points).map(|value| -value / factor).collect()
        };
        let periods = ground.map(|axis| period[axis].unwrap_or(0.0));
        let half = if periods[0].max(periods[1]) > 0.0 {
            periods[0].max(periods[1])
        } else if let Some(waves) = self.waves {
            let mut flat = [true; 3];
            flat[up] = false;
            few_digits(Self::calm(waves, flat))
        } else {
            few_digits(around_tops(&heights))
        };
        let mut window = Cell::cube(half);
        if let Some([low, high]) = shown(&Grid::new(&heights, half)) {
            (window.low[up], window.high[up]) = (few_digits(low), few_digits(high));
        }
        super::thick(window)
    }

    /// Half the side of the cube in which the argument of a wave stays small; of a square on the ground if not all axes count.
    fn calm(waves: &dyn Fn([f64; 3]) -> f64, axes: [bool; 3]) -> f64 {
        let largest = |half: f64| {
            let corners = (0..27).map(|n: i32| {
                let place = [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1];
                [0, 1, 2].map(|k| if axes[k] { half * f64::from(place[k]) } else { 0.0 })
            });
            let values = corners.map(waves).filter(|value| value.is_finite());
            values.fold(0.0, |most: f64, value| most.max(value.abs()))
        };
        // In steps of an eighth of an octave.
        let halves: Vec<f64> = (-40..=56).map(|k| (f64::from(k) / 8.0).exp2()).collect();
        let calm = halves.partition_point(|half| largest(*half) <= WAVES);
        if calm == 0 { PLAIN } else { halves[calm - 1] }
    }

    fn values<'b>(
        &'b self,
        kernel: &'b dyn Kernel<Sample, f64>,
        points: &'b [[f64; 3]],
    ) -> impl Iterator<Item = f64> + use<'b> {
        points.chunks(LANES).flat_map(move |chunk| {
            let mut values = Values::<f64>::default();
            self.search.spend(chunk.len() as u64);
            kernel.ask(&Points::near(chunk)[0], &mut values);
            (0..chunk.len()).map(move |lane| values.value[lane])
        })
    }

    /// A box around the origin, the places where the surface meets the axes, and a cube that it does not enter.
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

    /// Where the surface may meet half an axis, as far as that is narrowed down to places.
    fn meets(&self, axis: usize, side: f64, largest: i32) -> Vec<f64> {
        let stretch = |from: f64, to: f64| {
            let mut cell = Cell::cube(0.0);
            (cell.low[axis], cell.high[axis]) = if side > 0.0 { (from, to) } else { (-to, -from) };
            cell
        };
        let octaves =
            (SMALLEST..largest).map(|k| stretch(f64::from(k).exp2(), f64::from(k + 1).exp2()));
        let octaves = self.search.open(&octaves.collect::<Vec<_>>());
        let mut places = Vec::new();
        for octave in octaves {
            let mut open = vec![octave];
            for _ in 0..HALVINGS {
                let halves = open.iter().flat_map(|cell| {
                    let middle = cell.centre()[axis];
                    let [mut near, mut far] = [*cell; 2];
                    (near.high[axis], far.low[axis]) = (middle, middle);
                    [near, far]
                });
                open = self.search.open(&halves.collect::<Vec<_>>());
                if open.len() > MOST_PLACES {
                    open.clear();
                }
            }
            places.extend(open.iter().map(|cell| cell.centre()[axis].abs()));
        }
        places
    }

    /// About how far the surface stays away from the origin, in the largest coordinate; 0 if it does not.
    fn nearest(&self, largest: i32) -> f64 {
        if !self.search.open(&[Cell::cube(0.0)]).is_empty() {
            return 0.0;
        }
        let sizes = (4 * SMALLEST..4 * largest).map(|k| (f64::from(k) / 4.0).exp2());
        let clear = |half: &f64| {
            self.search.nothing_between(&Cell::cube(half / 4096.0), &Cell::cube(*half))
        };
        let sizes: Vec<f64> = sizes.collect();
        let known = sizes.partition_point(clear);
        if known == 0 { 0.0 } else { sizes.get(known).copied().unwrap_or_default() }
    }
}

/// Half an axis is looked through octave by octave, each halved so often; if more parts of one may meet the surface than that,
/// it lies along the axis, or intervals do not tell.
const HALVINGS: usize = 9;
const MOST_PLACES: usize = 16;

/// A length with three digits.
fn few_digits(length: f64) -> f64 {
    format!("{length:.2e}").parse().unwrap_or(length)
}

/// Half the side of a window on the highest and lowest points of a graph; on some, if there are many.
fn around_tops(heights: &Heights<'_>) -> f64 {
    let tops = Grid::new(heights, FAR).tops;
    if tops.len() > MOST_TOPS {
        let apart = 2.0 * FAR / (tops.len() as f64 / 2.0).sqrt();
        return TOPS_ACROSS / 2.0 * apart;
    }
    let reach = tops.iter().map(|top| top.0.abs().max(top.1.abs()));
    PLAIN.max(ROOM_OF_GRAPH * reach.fold(0.0, f64::max))
}
