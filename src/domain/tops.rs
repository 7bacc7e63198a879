//! The window on a graph over the ground, by its highest and lowest points.
//!
//! All of it is sampled. Knows neither surfaces nor kernels.

use super::heights::{Grid, Heights};
use super::window::PLAIN;

/// A graph's window reaches so many times farther than its highest and lowest points.
const ROOM_OF_GRAPH: f64 = 1.6;

/// Of what has more tops than these in a wide window, so many are shown across.
const MOST_TOPS: usize = 24;
const TOPS_ACROSS: f64 = 10.0;

/// How far from the centre tops are looked for; if there are none, so far.
const FAR: f64 = 8.0;
const FARTHER: f64 = 32.0;

/// Half the side of a window on the highest and lowest points of a graph; on some, if there are many.
pub fn around_tops(heights: &Heights<'_>) -> f64 {
    let mut tops = Grid::new(heights, FAR).tops;
    if tops.is_empty() {
        tops = Grid::new(heights, FARTHER).tops;
    }
    if tops.len() > MOST_TOPS {
        let apart = 2.0 * FAR / (tops.len() as f64 / 2.0).sqrt();
        return TOPS_ACROSS / 2.0 * apart;
    }
    let reach = tops.iter().map(|top| top.0.abs().max(top.1.abs()));
    PLAIN.max(ROOM_OF_GRAPH * reach.fold(0.0, f64::max))
}
