//! Sums of products in twice the precision of `f64`, to tell whether a linear function meets
//! bounds.

/// A sum of products, and how far it may be off.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dot {
    /// The sum, rounded.
    pub value: f64,
    /// What the exact sum may differ by from `value`, but for one rounding of `value`.
    slack: f64,
}

/// Source: Ogita, Rump and Oishi 2005, algorithm 5.3 (`Dot2`): as if computed in twice the
/// precision, and rounded.
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
    // γₙ² of the sum of magnitudes, and what products below the normal numbers lose.
    let unit = count * f64::EPSILON;
    Dot { value: head + tail, slack: unit * unit * size + count * 2f64.powi(-1072) }
}

impl Dot {
    /// Whether the exact sum is certainly above 0. Nothing is certain of what overflows.
    pub(super) fn is_positive(self) -> bool {
        self.value.is_finite() && self.value > self.slack
    }

    /// At least the magnitude of the exact sum; infinite if that is not known.
    pub(super) fn most(self) -> f64 {
        let most = self.value.abs() * (1.0 + 4.0 * f64::EPSILON) + self.slack;
        if most.is_finite() { most.next_up() } else { f64::INFINITY }
    }
}
