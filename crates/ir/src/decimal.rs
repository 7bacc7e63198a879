//! Writes constants as exact decimals.

use crate::constant::Constant;
use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

/// Largest number of digits after the point. All decimals that can be typed exactly have fewer.
const PLACES: usize = 4000;

impl Constant {
    /// The digits of the number, perhaps with a sign before and a point within them. `None` if the
    /// number is no decimal, such as 1/3 or π.
    pub fn digits(&self) -> Option<String> {
        let value = self.exact()?;
        let mut rest = value.denom().clone();
        let mut places = [0_usize; 2];
        for (count, prime) in places.iter_mut().zip([2, 5]) {
            let prime = BigInt::from(prime);
            while (&rest % &prime).is_zero() {
                rest /= &prime;
                *count += 1;
            }
        }
        let places = places[0].max(places[1]);
        if !rest.is_one() || places > PLACES {
            return None;
        }
        let scaled = value.numer() * num_traits::pow(BigInt::from(10), places) / value.denom();
        let digits = format!("{:0>width$}", scaled.abs().to_string(), width = places + 1);
        let (whole, fraction) = digits.split_at(digits.len() - places);
        let sign = if value.is_negative() { "-" } else { "" };
        let point = if places > 0 { "." } else { "" };
        Some(format!("{sign}{whole}{point}{fraction}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        for text in ["0", "12", "0.1", "0.0625", "123456789.000000001", "100"] {
            let value = Constant::decimal(text).expect("a decimal");
            assert_eq!(value.digits().as_deref(), Some(text));
            if !value.is_zero() {
                let opposite = Constant::rational(-value.exact().expect("exact"));
                assert_eq!(opposite.digits(), Some(format!("-{text}")));
            }
        }
        assert_eq!(Constant::ratio(1, 3).expect("not 0").digits(), None);
    }
}
