//! Positions and texts of axis ticks. Ticks are at multiples of π if both ends of the axis are
//! multiples of π/2, and else at round numbers. Does not know how texts are drawn.

use crate::legend::round_step;
use std::f64::consts::{FRAC_PI_2, PI};
use zeroset_scene::coordinate::multiple_of_pi;

/// Approximate number of ticks on an axis.
const TICKS: f64 = 4.0;

/// Largest number of ticks, which matters only if rounding leads to a tiny step.
const MOST: usize = 16;

/// Tolerance for rounding errors: in units of π/2 for ends, and in steps for ticks.
const NEAR: f64 = 1e-9;

/// Two steps in a row differ by 2 or 2.5 times. A step divided by this number is between the next
/// smaller one and the one after that.
const BETWEEN_STEPS: f64 = 2.6;

/// Steps smaller than π, in units of π.
const PARTS: [f64; 2] = [0.25, 0.5];

/// Numbers are written without an exponent if their largest magnitude is within this range.
const PLAIN: std::ops::Range<f64> = 1e-3..1e5;

/// Positions and texts of the ticks between two ends, and the step between them.
pub fn ticks(low: f64, high: f64) -> (Vec<(f64, String)>, f64) {
    let in_halves = |end: f64| {
        let halves = end / FRAC_PI_2;
        ((halves - halves.round()).abs() < NEAR).then_some(halves.round())
    };
    // Both ends of a tiny axis are near the same multiple.
    let turns = in_halves(low).zip(in_halves(high));
    let turns = turns.filter(|(a, b)| a != b && a.abs().max(b.abs()) < 1e6);
    let least = (high - low) / TICKS;
    let (unit, mut step) = if turns.is_some() {
        let part = PARTS.into_iter().find(|part| part * PI >= least);
        (PI, part.unwrap_or_else(|| round_step(least / PI).max(1.0)))
    } else {
        (1.0, round_step(least))
    };
    let multiples = |step: f64| -> Vec<f64> {
        // An end counts as a tick if only rounding separates it from a multiple of the step.
        let first = (low / unit / step - NEAR).ceil() as i64;
        let last = (high / unit / step + NEAR).floor() as i64;
        (first..=last).take(MOST).map(|tick| tick as f64 * step).collect()
    };
    let mut values = multiples(step);
    // With one tick alone, nothing can be read off an axis. The next smaller step is at most half
    // of the axis.
    if values.len() < 2 {
        step = round_step(step / BETWEEN_STEPS);
        values = multiples(step);
    }
    let texts: Vec<String> = if turns.is_some() {
        values.iter().map(|value| multiple_of_pi(*value)).collect()
    } else {
        numbers(&values, step)
    };
    (values.iter().map(|value| value * unit).zip(texts).collect(), step * unit)
}

/// Formats multiples of `step`, all with as many decimals as they need, and all with the same
/// exponent if that is shorter. Zero is only `0`.
fn numbers(values: &[f64], step: f64) -> Vec<String> {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let decimals = |power: i32| power.saturating_sub(power_of_ten(step)).clamp(0, 17) as usize;
    let written = |suffix: &str, power: i32| -> Vec<String> {
        let digits = decimals(power);
        let number = |value: &f64| match *value {
            0.0 => "0".to_owned(),
            value => format!("{:.digits$}{suffix}", scaled(value, power)),
        };
        values.iter().map(number).collect()
    };
    let plain = written("", 0);
    if largest == 0.0 || PLAIN.contains(&largest) {
        return plain;
    }
    let power = power_of_ten(largest);
    let short = written(&format!("e{power}"), power);
    let length = |texts: &[String]| texts.iter().map(String::len).max();
    if length(&short) < length(&plain) { short } else { plain }
}

/// The exponent of a positive number's first digit.
fn power_of_ten(value: f64) -> i32 {
    (value.log10() + NEAR).floor() as i32
}

/// Returns value / 10^power.
fn scaled(value: f64, power: i32) -> f64 {
    // Negative powers of ten are no floats, so this divides only by positive ones.
    if power < 0 { value * 10_f64.powi(-power) } else { value / 10_f64.powi(power) }
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
        assert_eq!(texts(-0.9, 0.3), ["-0.5", "0"]);
        assert_eq!(texts(0.0, 2.0), ["0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(texts(0.0, 250.0), ["0", "100", "200"]);
        assert_eq!(texts(-4.9, 4.9), ["-4", "-2", "0", "2", "4"]);
        assert_eq!(texts(0.6, 6.2), ["2", "4", "6"]);
        assert_eq!(texts(-4.5 * PI, 4.5 * PI), ["-4π", "-2π", "0", "2π", "4π"]);
        let (places, step) = ticks(-1.2, 1.2);
        assert_eq!((places.len(), step), (3, 1.0));
    }

    #[test]
    fn exponents_are_written_where_they_are_shorter() {
        assert_eq!(texts(-2e-4, 2e-4), ["-2e-4", "-1e-4", "0", "1e-4", "2e-4"]);
        assert_eq!(texts(0.0, 2e-6), ["0", "0.5e-6", "1.0e-6", "1.5e-6", "2.0e-6"]);
        assert_eq!(texts(-0.002, 0.002), ["-0.002", "-0.001", "0", "0.001", "0.002"]);
        assert_eq!(texts(0.0, 4e12), ["0", "1e12", "2e12", "3e12", "4e12"]);
        assert_eq!(texts(0.0, 40_000.0), ["0", "10000", "20000", "30000", "40000"]);
        assert_eq!(texts(0.0, 250_000.0), ["0", "1e5", "2e5"]);
        // Many digits are no shorter with an exponent.
        assert_eq!(texts(1e6, 1e6 + 0.5), ["1000000.0", "1000000.2", "1000000.4"]);
        assert_eq!(texts(-1e-12, 1e-12), ["-1.0e-12", "-0.5e-12", "0", "0.5e-12", "1.0e-12"]);
        assert_eq!(texts(0.0, 0.0), ["0"]);
    }

    /// Every text is read back as its number: no digit is missing, and no sign is wrong.
    #[test]
    fn texts_are_the_numbers_of_their_ticks() {
        let mut random = fastrand::Rng::with_seed(0x5eed_71c5);
        for _ in 0..10_000 {
            let size = 10_f64.powf(24.0 * random.f64() - 12.0);
            let middle = if random.bool() { 0.0 } else { 10.0 * size * (random.f64() - 0.5) };
            let (low, high) = (middle - size * random.f64(), middle + size * random.f64());
            let (found, step) = ticks(low, high);
            assert!(found.len() > 1, "{found:?} of {low} to {high}");
            for (value, text) in &found {
                let read: f64 = text.parse().expect(text);
                assert!((read - value).abs() < 1e-6 * step, "{text} at {value} of {low} to {high}");
                assert!(text.len() < 16, "{text} of {low} to {high}");
            }
            let mut texts: Vec<&String> = found.iter().map(|(_, text)| text).collect();
            texts.dedup();
            assert_eq!(texts.len(), found.len(), "{found:?}");
        }
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
