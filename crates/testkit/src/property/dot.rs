//! Sums of products in twice the precision of `f64`, to compare a linear function with bounds.

/// A sum of products, and a bound of its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dot {
    /// The rounded sum.
    pub value: f64,
    /// Bound of the error that `value` had before its last rounding.
    slack: f64,
}

/// Returns a sum of products as if computed in twice the precision and rounded. Source: Ogita, Rump
/// and Oishi 2005, algorithm 5.3 (`Dot2`).
pub(super) fn dot(terms: impl IntoIterator<Item = (f64, f64)>) -> Dot {
    let (mut head, mut tail, mut size, mut count) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for (a, b) in terms {
        let product = a * b;
        let lost = a.mul_add(b, -product);
        let sum = head + product;
        let part = sum - head;
        tail += ((head - (sum - part)) + (product - part)) + lost;
        head = sum;
        size += product.abs();
        count += 1.0;
    }
    // The error is at most γₙ² times the sum of magnitudes, plus the errors of subnormal products.
    let unit = count * f64::EPSILON;
    Dot { value: head + tail, slack: unit * unit * size + count * 2f64.powi(-1072) }
}

impl Dot {
    /// Whether the exact sum is certainly above 0. False if it overflows.
    pub(super) fn is_positive(self) -> bool {
        self.value.is_finite() && self.value > self.slack
    }

    /// Returns an upper bound of the magnitude of the exact sum, infinite if none is known.
    pub(super) fn most(self) -> f64 {
        let most = self.value.abs() * (1.0 + 4.0 * f64::EPSILON) + self.slack;
        if most.is_finite() { most.next_up() } else { f64::INFINITY }
    }
}
