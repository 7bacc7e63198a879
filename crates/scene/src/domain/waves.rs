//! The size of a window on a wave whose argument is not linear. It shows as much as can be
//! resolved.
//!
//! All results are sampled, not proven. Knows neither surfaces nor kernels.

use super::DEFAULT_HALF;
use std::f64::consts::PI;
use zeroset_space::places_about;

/// The argument of a wave, by place.
pub type Wave<'a> = dyn Fn([f64; 3]) -> f64 + 'a;

/// A wave is shown where the magnitude of its argument is below this.
const WAVES: f64 = 4.5 * PI;

/// The sizes tried are powers of two from `FIRST` to `LAST`, in steps of 1/`STEPS`.
const FIRST: i32 = -5;
const LAST: i32 = 7;
const STEPS: i32 = 8;

/// An argument that grows by less than this factor from an eighth of the last size to the last has
/// no size of its own: an angle, a quotient, a logarithm. A cube root doubles.
const GROWS: f64 = 1.8;

/// Half the side of the cube around a place in which a wave's argument stays small; a square on the
/// ground if not all axes count. Uses the first argument that grows with the distance; `None` if
/// none does.
pub fn resolvable_half(waves: &[&Wave<'_>], centre: [f64; 3], axes: [bool; 3]) -> Option<f64> {
    let counted = |along: [f64; 3]| [0, 1, 2].map(|k| if axes[k] { along[k] } else { 0.0 });
    let largest = |wave: &Wave<'_>, half: f64| {
        let corners = places_about(counted(centre), counted([half; 3]));
        let values = corners.map(wave).filter(|value| value.is_finite());
        values.fold(0.0, |most: f64, value| most.max(value.abs()))
    };
    let far = f64::from(LAST).exp2();
    let grows = |wave: &&&Wave<'_>| largest(wave, far) > GROWS * largest(wave, far / 8.0);
    let wave = waves.iter().find(grows)?;
    let power = |k: i32| (f64::from(k) / f64::from(STEPS)).exp2();
    let halves: Vec<f64> = (STEPS * FIRST..=STEPS * LAST).map(power).collect();
    let resolvable_half = halves.partition_point(|half| largest(wave, *half) <= WAVES);
    Some(resolvable_half.checked_sub(1).map_or(DEFAULT_HALF, |last| halves[last]))
}
