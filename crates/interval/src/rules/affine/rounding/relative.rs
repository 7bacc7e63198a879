//! Relative errors of slopes and bends: how far the operations of a rule can move a result from
//! that of exact arithmetic.
//!
//! An operation multiplies its exact result by a factor within 1 ± u. So a result is the exact one
//! times a factor, of which bounds follow from those of the operands, as long as no two numbers of
//! opposite sign are added. An exact sum has one factor, whatever its signs.

use super::super::functions::ExpansionPoint;
use super::problem::{FORMAT, unit};
use crate::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::{Format, Machine};
use crate::rules::Rule;
use crate::rules::affine::functions::{Derivatives, UNITS};

/// A value, of which nothing is known but this.
#[derive(Clone, Copy, Debug)]
struct Relative {
    /// Bounds of the factor. `None` if there are no bounds.
    factor: Option<[f64; 2]>,
    /// Values of the same number have the same sign.
    sign: usize,
}

/// The number of all values that are not below 0.
const POSITIVE: usize = 0;

/// The number of signs that are not known.
#[derive(Default)]
struct Factors(usize);

impl Factors {
    fn unknown_sign(&mut self) -> usize {
        self.0 += 1;
        self.0
    }

    /// An input.
    fn input(&mut self) -> Relative {
        Relative { factor: Some([1.0; 2]), sign: self.unknown_sign() }
    }

    fn sign_of_sum(&mut self, a: Relative, b: Relative) -> usize {
        if a.sign == b.sign { a.sign } else { self.unknown_sign() }
    }

    fn sign_of_product(&mut self, a: Relative, b: Relative) -> usize {
        match (a.sign, b.sign) {
            (a, b) if a == b => POSITIVE,
            (POSITIVE, sign) | (sign, POSITIVE) => sign,
            _ => self.unknown_sign(),
        }
    }
}

/// A result that is rounded.
fn rounded(factor: Option<[f64; 2]>, sign: usize) -> Relative {
    // Factors are computed in `f64`, which errs by far less than is added here.
    let u = unit() * (1.0 + 1e-6);
    let factor = factor.map(|[low, high]| [low * (1.0 - u), high * (1.0 + u)]);
    Relative { factor, sign }
}

fn hull(a: Relative, b: Relative) -> Option<[f64; 2]> {
    let ([a_low, a_high], [b_low, b_high]) = (a.factor?, b.factor?);
    Some([a_low.min(b_low), a_high.max(b_high)])
}

impl Machine for Factors {
    type V = Relative;

    fn number(&mut self, _: Format, value: f64) -> Relative {
        let sign = if value >= 0.0 { POSITIVE } else { self.unknown_sign() };
        Relative { factor: Some([1.0; 2]), sign }
    }

    fn bits(&mut self, _: Format, _: u64) -> Relative {
        Relative { factor: Some([1.0; 2]), sign: POSITIVE }
    }

    fn add(&mut self, a: Relative, b: Relative) -> Relative {
        let factor = hull(a, b);
        let is_safe = factor == Some([1.0; 2]) || a.sign == b.sign;
        rounded(factor.filter(|_| is_safe), self.sign_of_sum(a, b))
    }

    fn sub(&mut self, a: Relative, b: Relative) -> Relative {
        let opposite = self.neg(b);
        self.add(a, opposite)
    }

    fn mul(&mut self, a: Relative, b: Relative) -> Relative {
        let factor = a.factor.zip(b.factor).map(|(a, b)| [a[0] * b[0], a[1] * b[1]]);
        rounded(factor, self.sign_of_product(a, b))
    }

    fn mul_add(&mut self, a: Relative, b: Relative, c: Relative) -> Relative {
        let product = self.mul(a, b);
        self.add(product, c)
    }

    fn div(&mut self, a: Relative, b: Relative) -> Relative {
        let factor = a.factor.zip(b.factor).map(|(a, b)| [a[0] / b[1], a[1] / b[0]]);
        rounded(factor, self.sign_of_product(a, b))
    }

    fn sqrt(&mut self, a: Relative) -> Relative {
        rounded(a.factor.map(|factor| factor.map(f64::sqrt)), POSITIVE)
    }

    fn neg(&mut self, a: Relative) -> Relative {
        Relative { sign: self.unknown_sign(), ..a }
    }

    fn abs(&mut self, a: Relative) -> Relative {
        Relative { sign: POSITIVE, ..a }
    }

    fn min(&mut self, a: Relative, b: Relative) -> Relative {
        Relative { factor: hull(a, b), sign: self.sign_of_sum(a, b) }
    }

    fn max(&mut self, a: Relative, b: Relative) -> Relative {
        let is_positive = a.sign == POSITIVE || b.sign == POSITIVE;
        let sign = if is_positive { POSITIVE } else { self.sign_of_sum(a, b) };
        Relative { factor: hull(a, b), sign }
    }

    /// Conditions choose between values, and both count.
    fn lt(&mut self, _: Relative, _: Relative) -> Relative {
        Relative { factor: None, sign: self.unknown_sign() }
    }

    fn select(&mut self, _: Relative, a: Relative, b: Relative) -> Relative {
        self.min(a, b)
    }

    integers_and_bits_are_not_recorded!(Relative);
}

/// A function's slope and bend, as its rule computes them.
type Shape = fn(&mut Rule<'_, Factors>, &ExpansionPoint<Relative>) -> Derivatives<Relative>;

/// The error that a rule states of its slope covers the error of its operations. Its bend is at
/// least the exact one. Constants may be half a unit off.
#[test]
fn slopes_and_bends_count_enough_units() {
    let shapes: [(&str, Shape); 8] = [
        ("ln", |rule, at| rule.shape_of_ln(at)),
        ("cbrt", |rule, at| rule.shape_of_cbrt(at)),
        ("asin", |rule, at| rule.shape_of_asin(at)),
        ("acos", |rule, at| rule.shape_of_acos(at)),
        ("atan", |rule, at| rule.shape_of_atan(at)),
        ("asinh", |rule, at| rule.shape_of_asinh(at)),
        ("acosh", |rule, at| rule.shape_of_acosh(at)),
        ("atanh", |rule, at| rule.shape_of_atanh(at)),
    ];
    for (name, shape) in shapes {
        let mut m = Factors::default();
        let [x, neg_lo] = [(); 2].map(|()| m.input());
        let most = Relative { sign: POSITIVE, ..x };
        let enclosure = Enclosure::total(m.input(), m.input());
        let point = Operand::new(enclosure, Interval::ENTIRE);
        let at = ExpansionPoint { x, point, neg_lo, most, here: enclosure, value: enclosure };
        let Derivatives { slope, off, bend } = shape(&mut Rule { m: &mut m, format: FORMAT }, &at);
        let [low, high] = slope.factor.expect("no cancellation");
        let needed = (1.0 - low).max(high - 1.0) / unit() + 0.5;
        // For a cube root, the error of its value comes on top.
        let stated = off.factor.map_or(1.0, |factor| factor[0]) * UNITS;
        let [least, _] = bend[0].factor.expect("no cancellation");
        let short = (1.0 - least) / unit() + 0.5;
        println!("{name}: slope {needed:.2} units of {stated:.2}, bend {short:.2} of {UNITS}");
        assert!(needed <= stated, "{name}: the slope may be {needed} units off, {stated} counted");
        // The factor of the bend is that of b + b·u·UNITS.
        let bend = least * (1.0 - unit()) * (1.0 + UNITS * unit());
        assert!(bend >= 1.0, "{name}: the bend may be {short} units too small");
        // With fewer units, some of the statements would be false.
        assert!(needed > 1.0, "{name}");
    }
}
