//! A window on a graph over one or two axes: the ground that is shown, and the heights over it.
//!
//! All results are sampled, except for ends that [`bounds`](super::bounds) has proven. This module
//! depends neither on cameras nor on pictures.

use super::ground::{self, Ground};
use super::heights::{Grid, Heights, ROUNDING, ShownHeights, choose_heights};
use super::shape::{GraphAxes, Growth};
use super::tops::around_tops;
use super::window::{WindowChooser, few_digits};
use super::{DEFAULT_HALF, FLAT, SPACE, THIN, climb, fading};
use zeroset_space::Cell;

/// If a graph has heights in a part of the window only, the bound of that part is rounded to this
/// share of the half side.
const GRAIN_OF_GROUND: f64 = 1e-3;

/// A graph over one axis that fades out is a strip. Its width is this share of its length.
const STRIP: f64 = 0.6;

/// Number of stretches between samples of a graph over one axis, which may be steep at its ends.
const FURTHER: u32 = 4096;

/// An end of the ground is at the center if it is within this share of the window's half side.
const AT_CENTRE: f64 = 0.05;

/// A window is kept if its half side is nearly the distance up to which a graph that fades out is
/// shown, or up to this many times that distance.
const NEARLY: f64 = 1.3;
const FADED: f64 = 8.0;

/// A window that shows this share of all heights is not enlarged.
const ALL_HEIGHTS: f64 = 0.95;

/// Largest number of isolated extrema of a graph that fades out and is shown as far as it does.
/// Waves that fade out have more.
const MOST_TOPS: usize = 8;

impl WindowChooser<'_> {
    /// Returns whether the window on a function of two axes is that of a graph. The window on a
    /// plane, or on a polynomial without turns far apart, is chosen by other features.
    pub(super) fn is_profile(&self) -> bool {
        let Some(graph) = self.shape.graph.filter(|_| !self.shape.is_plane) else { return false };
        let heights = |places: &[[f64; 2]]| self.heights(graph, places);
        let half = around_tops(&heights);
        let grid = Grid::new(&heights, half);
        let reach = grid.ends().map_or(0.0, |[low, high]| high - low);
        if self.is_stretched && reach > 0.0 && super::differ(reach, 2.0 * half) {
            return true;
        }
        if self.shape.growth == Growth::Polynomial {
            half > DEFAULT_HALF && climb::tops(&heights, &grid).len() > 1
        } else {
            grid.ends().is_some_and(|[low, high]| low < high)
        }
    }

    /// The heights of a graph at places relative to the center. A graph over one axis is a ridge:
    /// its heights are NaN at places that are not in the middle of the ridge.
    pub(super) fn heights(&self, graph: GraphAxes, places: &[[f64; 2]]) -> Vec<f64> {
        let GraphAxes { up, factor, along } = graph;
        let across = along.map(|along| usize::from((up + 1) % 3 == along));
        let is_middle = |place: &&[f64; 2]| across.is_none_or(|across| place[across] == 0.0);
        let point = |place: &[f64; 2]| {
            let mut point = self.centre;
            point[(up + 1) % 3] += place[0];
            point[(up + 2) % 3] += place[1];
            point
        };
        let points: Vec<[f64; 3]> = places.iter().filter(is_middle).map(point).collect();
        let values = self.search.values(self.values, &points).into_iter();
        let mut found = values.map(|value| self.centre[up] - value / factor);
        let mut height = |place| if is_middle(&place) { found.next() } else { None };
        places.iter().map(|place| height(place).unwrap_or(f64::NAN)).collect()
    }

    /// Half the sides of the window on a graph.
    pub(super) fn halves_of_graph(&self, graph: GraphAxes) -> [f64; 3] {
        let heights = |places: &[[f64; 2]]| self.heights(graph, places);
        let half = few_digits(around_tops(&heights));
        let axes = [(graph.up + 1) % 3, (graph.up + 2) % 3];
        let varies = axes.map(|axis| graph.along.is_none_or(|along| along == axis));
        let faded = fading::distances(&heights, varies);
        let plain = [half; 3];
        let is_shown = |far: f64| (far / NEARLY..=FADED * far).contains(&half);
        let Some(farthest) = faded.into_iter().flatten().reduce(f64::max) else { return plain };
        if faded.into_iter().flatten().all(is_shown) {
            return plain;
        }
        let range = |far: f64| [-far, far];
        let ground = Ground { ranges: faded.map(|far| range(far.unwrap_or(farthest))) };
        let mapped = |places: &[[f64; 2]]| heights(&ground.places(places));
        let grid = Grid::new(&mapped, ground.half());
        let tops = climb::tops(&mapped, &grid);
        let height = |grid: &Grid| grid.ends().map_or(0.0, |[low, high]| high - low);
        let is_whole =
            farthest > half && height(&Grid::new(&heights, half)) >= ALL_HEIGHTS * height(&grid);
        if is_whole || tops.iter().filter(|top| top.is_isolated).count() > MOST_TOPS {
            return plain;
        }
        let mut halves = [few_digits(farthest); 3];
        for (k, axis) in axes.into_iter().enumerate() {
            let far = if varies[k] { faded[k].unwrap_or(farthest) } else { STRIP * farthest };
            halves[axis] = few_digits(far);
        }
        halves
    }

    /// The ground of a graph, from the center: proven ends along axes on which the surface is
    /// bounded on both sides, elsewhere `halves` on both sides.
    fn ground_of(&self, up: usize, halves: [f64; 2]) -> Ground {
        let range = |k: usize| {
            let axis = (up + 1 + k) % 3;
            if self.is_bounded(axis) {
                [self.bounds.low, self.bounds.high].map(|end| end[axis] - self.centre[axis])
            } else {
                [-halves[k], halves[k]]
            }
        };
        Ground { ranges: [range(0), range(1)] }
    }

    /// The ends of the ground of a ridge, which is as wide as the ridge. `heights` are the heights
    /// over `ground`, and `across` is the axis of the ground along which they do not vary.
    fn ends_of_ridge(heights: &Heights<'_>, half: f64, across: usize) -> [[Option<f64>; 2]; 2] {
        let widened = |places: &[[f64; 2]]| {
            let mut places = places.to_vec();
            for place in &mut places {
                place[across] = 0.0;
            }
            heights(&places)
        };
        ground::ends(&widened, &Grid::new(&widened, half))
    }

    /// The window on a graph, with these half sides along its ground. `None` for a curve that
    /// leaves the window both above and below, unless it is stretched and a cube around the center
    /// shows little of it.
    pub(super) fn graph(&mut self, graph: GraphAxes, halves: [f64; 2]) -> Option<Cell> {
        let GraphAxes { up, along, .. } = graph;
        let axes = [(up + 1) % 3, (up + 2) % 3];
        let mut map = self.ground_of(up, halves);
        if let Some(along) = along {
            let across = usize::from(along == axes[0]);
            let half = map.half();
            let heights = |places: &[[f64; 2]]| self.heights(graph, &map.places(places));
            let [low, high] = Self::ends_of_ridge(&heights, half, across)[1 - across];
            let is_middle = |end: &f64| end.abs() <= AT_CENTRE * half;
            // A graph that begins in the middle of its window is shown at the window's full length.
            let range = &mut map.ranges[1 - across];
            match [low.filter(is_middle), high.filter(is_middle)] {
                [Some(_), None] => range[1] *= 2.0,
                [None, Some(_)] => range[0] *= 2.0,
                [None, None] | [Some(_), Some(_)] => {}
            }
        }
        let half = map.half();
        let heights = |places: &[[f64; 2]]| self.heights(graph, &map.places(places));
        let grid = Grid::new(&heights, half);
        let mut window = super::cube_about(self.centre, half);
        let ends = match along {
            Some(along) => Self::ends_of_ridge(&heights, half, usize::from(along == axes[0])),
            None => ground::ends(&heights, &grid),
        };
        for (k, axis) in axes.into_iter().enumerate() {
            let mut own = map.ranges[k];
            if self.is_bounded(axis) {
                let space = SPACE * (own[1] - own[0]);
                own = [own[0] - space, own[1] + space];
            }
            for (side, end) in
                [&mut window.low[axis], &mut window.high[axis]].into_iter().enumerate()
            {
                let centre = self.centre[axis];
                *end = if let Some(found) = ends[k][side] {
                    super::rounded(centre + map.along(k, found), half * GRAIN_OF_GROUND) + 0.0
                } else if own[side].abs() == half {
                    *end
                } else {
                    super::rounded(centre + own[side], half / 1000.0)
                };
            }
        }
        let tops: Vec<f64> = climb::tops(&heights, &grid).iter().map(|top| top.height).collect();
        let further = match along {
            Some(along) => {
                let own = |far| if along == axes[0] { [far, 0.0] } else { [0.0, far] };
                let far = |k: u32| half * (f64::from(k) / f64::from(FURTHER) * 2.0 - 1.0);
                heights(&(0..=FURTHER).map(|k| own(far(k))).collect::<Vec<_>>())
            }
            None => Vec::new(),
        };
        let proven = [self.bounds.low[up], self.bounds.high[up]];
        let mut thin = FLAT;
        if let Some(ShownHeights { ends, is_cut }) =
            choose_heights(&heights, &grid, &tops, &further, proven, self.is_stretched)
        {
            let [low, high] = ends.map(few_digits);
            (window.low[up], window.high[up]) = (low, high);
            self.cut[up] = is_cut;
            let cube = [self.centre[up] - half, self.centre[up] + half];
            let is_in_cube = || !self.is_stretched || !grid.is_little(cube);
            if along.is_some() && is_cut == [true; 2] && is_in_cube() {
                return None;
            }
            if self.is_stretched {
                thin = ROUNDING;
            } else if proven.iter().all(|end| end.is_finite()) {
                thin = THIN;
            }
        }
        Some(super::thickened(window, thin))
    }
}
