//! Positions and texts of axis ticks. Ticks are at multiples of π if both ends of the axis are
//! multiples of π/2, and else at round numbers.

use super::legend::round_step;
use std::f64::consts::{FRAC_PI_2, PI};
use zeroset_scene::coordinate::multiple_of_pi;

/// Approximate number of ticks on an axis.
const TICKS: f64 = 4.0;

/// Largest number of ticks, which matters only if rounding leads to a tiny step.
const MOST: usize = 16;

/// Tolerance for rounding errors: in units of π/2 for ends, and in steps for ticks.
const NEAR: f64 = 1e-9;

/// Steps smaller than π, in units of π.
const PARTS: [f64; 2] = [0.25, 0.5];

/// Positions and texts of the ticks between two ends, and the step between them.
pub fn ticks(low: f64, high: f64) -> (Vec<(f64, String)>, f64) {
    let in_halves = |end: f64| {
        let halves = end / FRAC_PI_2;
        ((halves - halves.round()).abs() < NEAR).then_some(halves.round())
    };
    let turns = in_halves(low).zip(in_halves(high)).filter(|(a, b)| a.abs().max(b.abs()) < 1e6);
    let least = (high - low) / TICKS;
    let (unit, step) = if turns.is_some() {
        let part = PARTS.into_iter().find(|part| part * PI >= least);
        (PI, part.unwrap_or_else(|| round_step(least / PI).max(1.0)))
    } else {
        (1.0, round_step(least))
    };
    // An end counts as a tick if only rounding separates it from a multiple of the step.
    let first = (low / unit / step - NEAR).ceil() as i64;
    let last = (high / unit / step + NEAR).floor() as i64;
    let tick = |tick: i64| {
        let value = tick as f64 * step;
        let text = if turns.is_some() { multiple_of_pi(value) } else { shown(value, step) };
        (value * unit, text)
    };
    ((first..=last).take(MOST).map(tick).collect(), step * unit)
}

/// Formats a multiple of `step` with no more decimals than needed.
fn shown(value: f64, step: f64) -> String {
    let digits = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    // Avoids `-0`.
    if value == 0.0 { text.trim_start_matches('-').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64) -> Vec<String> {
        ticks(low, high).0.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn ticks_are_round_numbers() {
        assert_eq!(texts(-2.0, 2.0), ["-2", "-1", "0", "1", "2"]);
        assert_eq!(texts(-0.9, 0.3), ["-0.5", "0.0"]);
        assert_eq!(texts(0.0, 250.0), ["0", "100", "200"]);
        let (places, step) = ticks(-1.2, 1.2);
        assert_eq!((places.len(), step), (3, 1.0));
    }

    #[test]
    fn multiples_of_pi_are_written_as_such() {
        assert_eq!(texts(-2.0 * PI, 2.0 * PI), ["-2π", "-π", "0", "π", "2π"]);
        assert_eq!(texts(-PI, PI), ["-π", "-π/2", "0", "π/2", "π"]);
        assert_eq!(texts(0.0, PI), ["0", "π/4", "π/2", "3π/4", "π"]);
        assert_eq!(texts(-1.5 * PI, 0.5 * PI), ["-3π/2", "-π", "-π/2", "0", "π/2"]);
        assert_eq!(texts(-6.0 * PI, 6.0 * PI), ["-5π", "0", "5π"]);
        // A number close to a multiple of π does not count as a multiple.
        assert_eq!(texts(-PI - 1e-5, PI), ["-2", "0", "2"]);
    }
}
