//! Legends of color maps, and round numbers for scales.

use zeroset_style::ColorMap;

/// A legend, which explains the color scale of a picture.
#[derive(Clone, Debug)]
pub struct Legend {
    /// The color map.
    pub map: &'static ColorMap,
    /// The formula of the value that is shown by color.
    pub value: String,
    /// The value that the map's first color stands for.
    pub low: f64,
    /// The value that the map's last color stands for.
    pub high: f64,
    /// Difference in value between adjacent contour lines, if there are any.
    pub step: Option<f64>,
}

impl PartialEq for Legend {
    fn eq(&self, other: &Self) -> bool {
        let parts = |one: &Self| (one.map.name, one.low, one.high, one.step);
        parts(self) == parts(other) && self.value == other.value
    }
}

/// The smallest number of the form 1, 2 or 5 times a power of ten that is not below `least`.
/// `least` must be positive.
pub fn round_step(least: f64) -> f64 {
    let power = 10.0_f64.powf(least.log10().floor());
    let factor = [1.0, 2.0, 5.0, 10.0].into_iter().find(|factor| factor * power >= least);
    factor.unwrap_or(10.0) * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_round_numbers() {
        assert_eq!(
            [round_step(0.9), round_step(1.0), round_step(3.1), round_step(60.0)],
            [1.0, 1.0, 5.0, 100.0]
        );
        assert!((round_step(0.013) - 0.02).abs() < 1e-12);
    }
}
