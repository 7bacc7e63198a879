//! How far a graph extends before it fades out: bells, steps and other graphs that tend to a level
//! far from the center.
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

use super::heights::Heights;

/// Exponents, to base 2, of the smallest and the largest distance from the center that is sampled.
/// Heights that grow without bound, even as slowly as a logarithm, are not taken for fading.
const NEAREST: i32 = -24;
const FARTHEST: i32 = 24;

/// Number of samples in an octave of distances, for a graph over one axis and over two.
const STEPS: [i32; 2] = [8, 1];

/// A graph is shown up to `BEYOND` times the distance at which all but `REST` of its change from
/// the center outward has happened.
const REST: f64 = 0.25;
const BEYOND: f64 = 1.85;

/// Exponents of the least and the greatest distance that counts. Heights that fade out nearer to
/// the center belong to a pole.
const LEAST: i32 = -9;
const GREATEST: i32 = 12;

/// Share of the change that may happen beyond the greatest distance.
const REST_AT_GREATEST: f64 = 0.05;

/// Per axis, the distance from the center up to which a graph is shown. `None` along an axis on
/// which it does not fade out, or is constant.
pub fn distances(heights: &Heights<'_>, axes: [bool; 2]) -> [Option<f64>; 2] {
    let steps = STEPS[usize::from(axes == [true; 2])];
    let power = |k: i32| (f64::from(k) / f64::from(steps)).exp2();
    let outward: Vec<f64> = (steps * NEAREST..=steps * FARTHEST).map(power).collect();
    let mut along: Vec<f64> = outward.iter().rev().map(|far| -far).collect();
    along.push(0.0);
    along.extend(&outward);
    let middle = [0.0];
    let lines = axes.map(|varies| if varies { &along[..] } else { &middle[..] });
    let places: Vec<[f64; 2]> =
        lines[1].iter().flat_map(|y| lines[0].iter().map(|x| [*x, *y])).collect();
    let found = heights(&places);
    let columns = lines[0].len();
    if found.iter().any(|height| height.is_infinite()) {
        return [None; 2];
    }
    [0, 1].map(|axis| {
        // The changes on the half lines along this axis, by distance from the center.
        let mut changes: Vec<Vec<f64>> = Vec::new();
        for line in 0..lines[1 - axis].len() {
            let at =
                |n: usize| found[if axis == 0 { line * columns + n } else { n * columns + line }];
            if axes[axis] {
                let last = outward.len();
                changes.extend([
                    changes_outward((0..=last).map(|k| at(last - k))),
                    changes_outward((0..=last).map(|k| at(last + k))),
                ]);
            }
        }
        let whole = changes.iter().map(|line| line[0]).fold(0.0, f64::max);
        if whole == 0.0 || !whole.is_finite() {
            return None;
        }
        // The rest of the change at each distance, from the center outward.
        let rests: Vec<f64> = (1..=outward.len())
            .map(|k| changes.iter().map(|line| line[k]).fold(0.0, f64::max) / whole)
            .collect();
        // A logarithm changes as much in each octave.
        let faded = (steps * (GREATEST - NEAREST)) as usize;
        if rests[faded] > REST_AT_GREATEST {
            return None;
        }
        let first = rests.iter().rposition(|rest| *rest > REST)? + 1;
        // Between two samples, the rest is taken for a power of the distance.
        let (before, after) = (rests[first - 1], *rests.get(first)?);
        let share = if after > 0.0 { (before / REST).ln() / (before / after).ln() } else { 1.0 };
        let far = outward[first - 1] * (share.clamp(0.0, 1.0) / f64::from(steps)).exp2();
        let fits = f64::from(LEAST).exp2()..f64::from(GREATEST).exp2();
        fits.contains(&far).then_some(BEYOND * far)
    })
}

/// For each place on a half line, the range of the heights from there outward.
fn changes_outward(heights: impl DoubleEndedIterator<Item = f64>) -> Vec<f64> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut changes: Vec<f64> = heights
        .rev()
        .map(|height| {
            // The minimum and maximum ignore heights that are undefined.
            (low, high) = (low.min(height), high.max(height));
            (high - low).max(0.0)
        })
        .collect();
    changes.reverse();
    changes
}
