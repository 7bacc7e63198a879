//! The size of a window on a wave whose argument is not linear. The window shows as much of the
//! wave as can be resolved.
//!
//! All results are sampled, not proven. This module depends neither on surfaces nor on kernels.

use super::DEFAULT_HALF;
use std::f64::consts::PI;
use zeroset_space::places_about;

/// A wave's argument as a function of the place.
pub type Wave<'a> = dyn Fn([f64; 3]) -> f64 + 'a;

/// A wave is shown where the magnitude of its argument is below this.
const WAVES: f64 = 4.5 * PI;

/// Exponents, to base 2, of the smallest and the largest half side that are tried. Exponents
/// between them are tried in steps of 1/`STEPS`.
const FIRST: i32 = -5;
const LAST: i32 = 7;
const STEPS: i32 = 8;

/// A wave gives the window a size only if its argument grows by more than this factor between an
/// eighth of the largest half side and that half side. Angles, quotients and logarithms grow less.
/// A cube root doubles.
const GROWS: f64 = 1.8;

/// Half the side of the cube around `centre` in which a wave's argument stays small. The cube
/// extends only along the axes for which `axes` is true. Uses the first wave whose argument grows
/// with the distance; `None` if there is no such wave.
pub fn half_side_for_waves(waves: &[&Wave<'_>], centre: [f64; 3], axes: [bool; 3]) -> Option<f64> {
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
    let count = halves.partition_point(|half| largest(wave, *half) <= WAVES);
    Some(count.checked_sub(1).map_or(DEFAULT_HALF, |last| halves[last]))
}
