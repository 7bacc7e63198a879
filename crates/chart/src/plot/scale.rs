//! Logarithmic axes with a separate band for zero, and axes of named places.

/// A mapping from values to positions on an axis, with the axis' labels.
#[derive(Clone, Debug)]
pub struct AxisScale {
    /// Logarithms of the axis' least and greatest value, margins included.
    low: f64,
    high: f64,
    /// Place of 0 on the scale of logarithms, if some value is 0.
    zero: Option<f64>,
    /// Number of named places; 0 if the axis is logarithmic.
    places: usize,
}

/// Width of zero's band, as a share of the axis.
const BAND: f64 = 0.09;
/// Axes with fewer decades than this have ticks at 2 and 5, too.
const FEW: f64 = 3.2;

impl AxisScale {
    /// A logarithmic axis for these values. Negative and non-finite values are ignored.
    pub fn logarithmic(values: impl Iterator<Item = f64> + Clone) -> Self {
        let has_zero = values.clone().any(|value| value == 0.0);
        let logarithms = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let low = logarithms.clone().fold(f64::INFINITY, f64::min);
        let high = logarithms.fold(f64::NEG_INFINITY, f64::max);
        let (low, high) = if low <= high { (low, high) } else { (-1.0, 0.0) };
        let margin = (0.04 * (high - low)).max(0.08);
        let (low, high) = (low - margin, high + margin);
        let zero = has_zero.then(|| low - BAND / (1.0 - BAND) * (high - low) * 0.55);
        Self { low, high, zero, places: 0 }
    }

    /// An axis with named places at equal distances. The places have the values 0, 1, 2 and so on.
    pub fn named(places: usize) -> Self {
        Self { low: 0.0, high: 1.0, zero: None, places }
    }

    fn ends(&self) -> (f64, f64) {
        let start = self.zero.map_or(self.low, |zero| 2.0 * zero - self.low);
        (start, self.high)
    }

    /// Position of a value, from 0 at the axis' start to 1 at its end; `None` if it is not on the
    /// axis.
    pub fn place(&self, value: f64) -> Option<f64> {
        if self.places > 0 {
            return Some((value + 0.5) / self.places as f64);
        }
        let logarithm = if value == 0.0 { self.zero? } else { value.log10() };
        let (start, end) = self.ends();
        logarithm.is_finite().then(|| (logarithm - start) / (end - start))
    }

    /// Position at which zero's band ends, if there is a band.
    pub fn band(&self) -> Option<f64> {
        let (start, end) = self.ends();
        self.zero.map(|_| (self.low - start) / (end - start))
    }

    /// Positions and labels of the ticks.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let mut ticks = Vec::new();
        ticks
            .extend(self.place(0.0).filter(|_| self.zero.is_some()).map(|at| (at, "0".to_owned())));
        let decades = self.high - self.low;
        let step = (decades / 9.0).ceil().max(1.0) as i32;
        let digits: &[f64] = if decades < FEW { &[1.0, 2.0, 5.0] } else { &[1.0] };
        for exponent in self.low.floor() as i32..=self.high.ceil() as i32 {
            if exponent.rem_euclid(step) != 0 {
                continue;
            }
            for digit in digits {
                let value = digit * 10.0_f64.powi(exponent);
                let inside = (self.low..=self.high).contains(&value.log10());
                ticks.extend(self.place(value).filter(|_| inside).map(|at| (at, written(value))));
            }
        }
        ticks
    }
}

/// A number in its shortest clear form.
pub fn written(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if (-3.0..5.0).contains(&exponent) {
        // A tick has one significant digit; further digits are rounding errors of a power.
        let decimals = (-exponent).max(0.0) as usize;
        return format!("{value:.decimals$}");
    }
    let digit = (value / 10.0_f64.powf(exponent)).round();
    let power: String = format!("{exponent}").chars().map(superscript).collect();
    if digit == 1.0 { format!("10{power}") } else { format!("{digit}·10{power}") }
}

fn superscript(character: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    character.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_apart_and_the_rest_in_order() {
        let scale = AxisScale::logarithmic([0.0, 1e-3, 10.0].into_iter());
        let places = [0.0, 1e-3, 1.0, 10.0].map(|v| scale.place(v).expect("a place"));
        assert!(places.is_sorted() && places[0] > 0.0 && places[3] < 1.0, "{places:?}");
        let band = scale.band().expect("a band");
        assert!(places[0] < band && band < places[1]);
        assert_eq!(AxisScale::logarithmic([1.0, 2.0].into_iter()).place(0.0), None);
        let texts: Vec<String> = scale.ticks().into_iter().map(|(_, text)| text).collect();
        assert_eq!(texts, ["0", "0.001", "0.01", "0.1", "1", "10"]);
    }

    #[test]
    fn numbers_are_short() {
        let expected = [(1e-9, "10⁻⁹"), (0.05, "0.05"), (200.0, "200"), (5e6, "5·10⁶")];
        for (value, text) in expected {
            assert_eq!(written(value), text);
        }
    }
}
