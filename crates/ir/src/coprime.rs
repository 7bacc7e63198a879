//! A quick proof that two polynomials have no common divisor, in the field of integers modulo a
//! prime.
//!
//! All variables but one get values. The image of a common divisor divides the images of both
//! polynomials. Its degree stays if the leading coefficient of either polynomial does not become 0
//! (Knuth, The Art of Computer Programming 2, section 4.6.1). So if the images are coprime for each
//! variable, the polynomials are.

use crate::graph::NodeId;
use crate::polynomial::Polynomial;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::ToPrimitive;

/// A prime, 2³¹ − 1.
const PRIME: u64 = (1 << 31) - 1;
/// Values of variables are powers of this.
const BASE: u64 = 1_103_515_245;

/// Returns whether two polynomials are proven to have constants as their only common divisors.
pub(crate) fn are_coprime(one: &Polynomial, other: &Polynomial) -> bool {
    let shared: Vec<NodeId> = one.variables().intersection(&other.variables()).copied().collect();
    shared.iter().all(|by| {
        let images = [one, other].map(|polynomial| image(polynomial, *by));
        let [Some(one_image), Some(other_image)] = images else { return false };
        let is_kept = |image: &[u64], of: &Polynomial| image.len() as u32 == of.degree(*by) + 1;
        (is_kept(&one_image, one) || is_kept(&other_image, other))
            && common_degree(one_image, other_image) == Some(0)
    })
}

/// The coefficients of the image of a polynomial in one variable, from the lowest degree. The last
/// is not 0. `None` if a coefficient has no image.
fn image(polynomial: &Polynomial, by: NodeId) -> Option<Vec<u64>> {
    let mut found = vec![0; polynomial.degree(by) as usize + 1];
    for (powers, coefficient) in polynomial.terms() {
        let mut term = residue(coefficient)?;
        let mut degree = 0;
        for (id, exponent) in powers {
            if id == by {
                degree = exponent as usize;
            } else {
                let value = power(BASE, id.index() as u64 + 1);
                term = term * power(value, u64::from(exponent)) % PRIME;
            }
        }
        found[degree] = (found[degree] + term) % PRIME;
    }
    Some(trimmed(found))
}

/// The degree of the greatest common divisor. `None` if both polynomials are 0.
fn common_degree(mut high: Vec<u64>, mut low: Vec<u64>) -> Option<usize> {
    while let Some(leading) = low.last() {
        let inverse = power(*leading, PRIME - 2);
        while high.len() >= low.len() {
            let factor = high[high.len() - 1] * inverse % PRIME;
            let shift = high.len() - low.len();
            for (at, value) in low.iter().enumerate() {
                high[shift + at] = (high[shift + at] + PRIME - factor * value % PRIME) % PRIME;
            }
            high = trimmed(high);
        }
        std::mem::swap(&mut high, &mut low);
    }
    high.len().checked_sub(1)
}

fn trimmed(mut coefficients: Vec<u64>) -> Vec<u64> {
    while coefficients.last() == Some(&0) {
        coefficients.pop();
    }
    coefficients
}

fn residue(value: &BigRational) -> Option<u64> {
    let prime = BigInt::from(PRIME);
    let part = |number: &BigInt| number.mod_floor(&prime).to_u64();
    let below = part(value.denom()).filter(|below| *below != 0)?;
    Some(part(value.numer())? * power(below, PRIME - 2) % PRIME)
}

fn power(base: u64, mut exponent: u64) -> u64 {
    let (mut square, mut product) = (base % PRIME, 1);
    while exponent > 0 {
        if exponent % 2 == 1 {
            product = product * square % PRIME;
        }
        square = square * square % PRIME;
        exponent /= 2;
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::{Axis, Graph};
    use crate::polynomial::Work;

    #[test]
    fn common_divisors_are_never_denied_and_most_coprime_pairs_are_seen() {
        let mut graph = Graph::new();
        let [x, y, z] = Axis::ALL.map(|axis| Polynomial::variable(graph.variable(axis)));
        let number = |value: i64| Polynomial::constant(BigRational::new(value.into(), 7.into()));
        let mut work = Work(20_000);
        let linear = |a: i64, b: i64, c: i64, work: &mut Work| {
            let scaled = |of: &Polynomial, by: i64, work: &mut Work| {
                of.times(&number(by), work).expect("small")
            };
            let sum = scaled(&x, a, work).plus(&scaled(&y, b, work));
            sum.plus(&scaled(&z, c, work)).plus(&number(a * b * c + 1))
        };
        let mut seen = 0;
        for n in 0_i64..40 {
            let common = linear(n % 3, 1 + n % 4, n % 5 - 2, &mut work);
            let one = linear(1, n, 2, &mut work);
            let other = linear(n, -3, n % 7, &mut work);
            seen += usize::from(are_coprime(&one, &other));
            let mut times = |factor: &Polynomial| factor.times(&common, &mut work).expect("small");
            let (one, other) = (times(&one), times(&other));
            assert!(!are_coprime(&one, &other), "{common:?} divides {one:?} and {other:?}");
        }
        assert!(seen >= 38, "{seen} of 40");
        // The leading coefficients may be 0 modulo the prime.
        let prime = Polynomial::constant(BigRational::from_integer(PRIME.into()));
        let one = x.times(&prime, &mut work).expect("small").plus(&number(1));
        assert!(!are_coprime(&one, &one));
    }
}
