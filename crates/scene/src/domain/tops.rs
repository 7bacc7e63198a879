//! The window on a graph over the ground, by its highest and lowest points.
//!
//! All of it is sampled. Knows neither surfaces nor kernels.

use super::climb::{self, Top};
use super::heights::{Grid, Heights};
use zeroset_space::PLAIN;

/// A graph's window reaches so many times farther than its highest and lowest points.
const ROOM_OF_GRAPH: f64 = 1.6;

/// Of what has more tops than these in a wide window, so many are shown across.
const MOST_TOPS: usize = 24;
const TOPS_ACROSS: f64 = 10.0;

/// How far from the centre tops are looked for; if there are none, so far.
const FAR: f64 = 8.0;
const FARTHER: f64 = 32.0;

/// A ridge or a plateau ends if it does within this share of the square in which it is looked for.
const ENDS: f64 = 0.75;

/// Other sizes of a window differ from the plain one by factors of up to two to this power.
const SCALES: i32 = 5;

/// Half of a graph's heights lie within so many times its width, at least and at most, where it is
/// neither flat nor steep.
const LOW: f64 = 0.075;
const HIGH: f64 = 3.0;

/// Towards a pole heights grow by this factor at least when the window is halved.
const GROWS: f64 = 1.2;

/// Half the side of a window on the highest and lowest points of a graph; on some, if there are
/// many.
pub fn around_tops(heights: &Heights<'_>) -> f64 {
    let near = Tops::find(heights, FAR);
    let all = if near.half.is_some() { near } else { Tops::find(heights, FARTHER) };
    match all.half {
        Some(half) => PLAIN.max(half),
        None if has_poles(heights) => in_scale(heights, true),
        None if near.goes_on => in_scale(heights, false),
        None => PLAIN,
    }
}

/// What is known of the tops of a graph.
#[derive(Clone, Copy)]
struct Tops {
    /// Half the side of a window on them, if there are any.
    half: Option<f64>,
    /// Whether others form a ridge or a plateau that goes on, as along an axis where a factor is 0:
    /// it has no place.
    goes_on: bool,
}

impl Tops {
    /// Looks for tops so far from the centre.
    fn find(heights: &Heights<'_>, far: f64) -> Self {
        let tops = climb::tops(heights, &Grid::new(heights, far)).into_iter();
        let (alone, others): (Vec<Top>, Vec<Top>) = tops.partition(|top| top.is_alone);
        let reach = |tops: &[Top]| {
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
            has_any.then(|| ROOM_OF_GRAPH * reach(&alone).max(reach(others)))
        };
        Self { half, goes_on }
    }
}

/// Whether heights grow inward, far up and far down.
fn has_poles(heights: &Heights<'_>) -> bool {
    let [plain, inner] = [PLAIN, PLAIN / 2.0].map(|half| Grid::new(heights, half));
    plain.is_far_out() && spread(&inner) > GROWS * spread(&plain)
}

/// Between which heights half of all lies: how far they are apart.
fn spread(grid: &Grid) -> f64 {
    let [low, high] = grid.without(0.25);
    high - low
}

/// Half the side of a window in which a graph is about as high as wide, the nearest to the plain
/// one. Whether heights grow inward tells where to look for it.
fn in_scale(heights: &Heights<'_>, grows_inward: bool) -> f64 {
    let share = |half: f64| spread(&Grid::new(heights, half)) / (2.0 * half);
    let plain = share(PLAIN);
    let fits = |share: f64| (LOW..=HIGH).contains(&share);
    if fits(plain) {
        return PLAIN;
    }
    let side = if grows_inward == (plain > HIGH) { 1 } else { -1 };
    let mut halves = (1..=SCALES).map(|k| PLAIN * f64::from(side * k).exp2());
    halves.find(|half| fits(share(*half))).unwrap_or(PLAIN)
}
