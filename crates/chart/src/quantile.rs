//! Medians and other quantiles.

/// The three quartiles of some values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quartiles {
    /// Value that a quarter of the values lie below.
    pub lower: f64,
    /// Value that half of the values lie below.
    pub median: f64,
    /// Value that a quarter of the values lie above.
    pub upper: f64,
}

impl Quartiles {
    /// The quartiles of values in any order; `None` if there are none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let [lower, median, upper] = [0.25, 0.5, 0.75].map(|share| quantile(values, share));
        Some(Self { lower: lower?, median: median?, upper: upper? })
    }
}

/// The value with about this share of all values below it; `None` if there are no values.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().checked_sub(1)?;
    Some(sorted[(last as f64 * share).round() as usize])
}

/// The geometric mean; `None` if there are no values.
pub fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logarithms: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (logarithms / values.len() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_values_that_occur() {
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 0.5), Some(2.0));
        assert_eq!(quantile(&[3.0, 1.0, 2.0], 1.0), Some(3.0));
        let quartiles = Quartiles::of(&[5.0, 1.0, 2.0, 4.0, 3.0]).expect("some");
        assert_eq!((quartiles.lower, quartiles.median, quartiles.upper), (2.0, 3.0, 4.0));
    }

    #[test]
    fn the_geometric_mean_is_that_of_ratios() {
        let mean = geometric_mean(&[1.0, 100.0]).expect("some");
        assert!((mean - 10.0).abs() < 1e-12);
        assert_eq!(geometric_mean(&[]), None);
    }
}
