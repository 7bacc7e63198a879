//! What tells which value has which color, and the round numbers that are written beside scales.

use zeroset_style::ColorMap;

/// The scale of a color map in a picture.
#[derive(Clone, Debug)]
pub struct Legend {
    /// The colors.
    pub map: &'static ColorMap,
    /// What has them, as text.
    pub value: String,
    /// The value with the first color.
    pub low: f64,
    /// The value with the last color.
    pub high: f64,
    /// How far the values of contour lines are apart, if there are such lines of it.
    pub step: Option<f64>,
}

impl PartialEq for Legend {
    fn eq(&self, other: &Self) -> bool {
        let parts = |one: &Self| (one.map.name, one.low, one.high, one.step);
        parts(self) == parts(other) && self.value == other.value
    }
}

/// The smallest of 1, 2 and 5 times a power of ten that is not below `least`, which is above 0.
pub fn nice(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least);
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_numbers() {
        assert_eq!([nice(0.9), nice(1.0), nice(3.1), nice(60.0)], [1.0, 1.0, 5.0, 100.0]);
        assert!((nice(0.013) - 0.02).abs() < 1e-12);
    }
}
