//! The size of a window on a graph over two axes, from its local maxima and minima ("tops").
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

use super::DEFAULT_HALF;
use super::climb::{self, Extremum};
use super::heights::{Grid, Heights};

/// A window that shows all extrema reaches this many times as far from the center as they do.
const MARGIN_OF_GRAPH: f64 = 1.6;

/// Largest number of isolated extrema that are all shown. If there are more, the window is about
/// `TOPS_ACROSS` extrema wide.
const MOST_TOPS: usize = 24;
const TOPS_ACROSS: f64 = 10.0;

/// Half the side of the square in which extrema are searched for, and of a second square if the
/// first has none.
const FAR: f64 = 8.0;
const FARTHER: f64 = 32.0;

/// A ridge or a plateau counts as ending if its extrema lie within this share of the half side.
const ENDS: f64 = 0.75;

/// Window sizes other than the default are the default times a power of two. Its exponent has at
/// most this magnitude.
const SCALES: i32 = 5;

/// Least and greatest ratio of a graph's height to the window's width. The height is the range of
/// the middle half of all heights. Below `LOW` a graph looks flat, above `HIGH` steep.
const LOW: f64 = 0.075;
const HIGH: f64 = 3.0;

/// A graph counts as having poles only if the range of the middle half of its heights grows by more
/// than this factor when the window is halved.
const GROWS: f64 = 1.2;

/// Half the side of a window on the extrema of a graph, or on some of them if there are many.
pub fn around_tops(heights: &Heights<'_>) -> f64 {
    let near = Tops::find(heights, FAR);
    let all = if near.half.is_some() { near } else { Tops::find(heights, FARTHER) };
    match all.half {
        Some(half) => DEFAULT_HALF.max(half),
        None if has_poles(heights) => in_scale(heights, true),
        None if near.goes_on => in_scale(heights, false),
        None => DEFAULT_HALF,
    }
}

/// The extrema of a graph in a square.
#[derive(Clone, Copy)]
struct Tops {
    /// Half the side of a window on the extrema, if there are any.
    half: Option<f64>,
    /// Whether a ridge or a plateau reaches the edge of the square, such as the ridge of x²y along
    /// x = 0. Such a ridge determines no window.
    goes_on: bool,
}

impl Tops {
    /// Finds the extrema up to `far` from the center along each axis.
    fn find(heights: &Heights<'_>, far: f64) -> Self {
        let tops = climb::tops(heights, &Grid::new(heights, far)).into_iter();
        let (alone, others): (Vec<Extremum>, Vec<Extremum>) = tops.partition(|top| top.is_isolated);
        let reach = |tops: &[Extremum]| {
            let ends = tops.iter().flat_map(|top| top.place);
            ends.fold(0.0_f64, |most, along| most.max(along.abs()))
        };
        let goes_on = reach(&others) > ENDS * far;
        let others = if goes_on { &[][..] } else { &others[..] };
        let half = if alone.len() > MOST_TOPS {
            let apart = 2.0 * far / (alone.len() as f64 / 2.0).sqrt();
            Some(TOPS_ACROSS / 2.0 * apart)
        } else {
            let has_any = !alone.is_empty() || !others.is_empty();
            has_any.then(|| MARGIN_OF_GRAPH * reach(&alone).max(reach(others)))
        };
        Self { half, goes_on }
    }
}

/// Returns whether the heights seem to have poles. Then some heights are far above and some far
/// below most others, and they spread further in a smaller window.
fn has_poles(heights: &Heights<'_>) -> bool {
    let [plain, inner] = [DEFAULT_HALF, DEFAULT_HALF / 2.0].map(|half| Grid::new(heights, half));
    plain.is_far_out() && spread(&inner) > GROWS * spread(&plain)
}

/// The extent of the range that holds the middle half of all heights.
fn spread(grid: &Grid) -> f64 {
    let [low, high] = grid.quantiles(0.25);
    high - low
}

/// Half the side of a window in which a graph is about as high as wide. Among such sizes, the
/// nearest to the default is chosen. `grows_inward` is true if heights grow when the window
/// shrinks.
fn in_scale(heights: &Heights<'_>, grows_inward: bool) -> f64 {
    let share = |half: f64| spread(&Grid::new(heights, half)) / (2.0 * half);
    let plain = share(DEFAULT_HALF);
    let fits = |share: f64| (LOW..=HIGH).contains(&share);
    if fits(plain) {
        return DEFAULT_HALF;
    }
    let side = if grows_inward == (plain > HIGH) { 1 } else { -1 };
    let mut halves = (1..=SCALES).map(|k| DEFAULT_HALF * f64::from(side * k).exp2());
    halves.find(|half| fits(share(*half))).unwrap_or(DEFAULT_HALF)
}
