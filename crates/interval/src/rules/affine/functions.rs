//! Forms of smooth functions of one variable.
//!
//! Over bounds with the middle m and the half-width h, f(x) = f(m) + f′(m)(x − m) + ½f″(ξ)(x − m)²,
//! where ξ is between x and m. The slope is any number α near f′(m): what it is off by, times h, is
//! part of the error, as is the last term, which is one-sided where f″ has one sign. Square roots
//! have a closed form; sine and cosine, which share their work, stand in [`waves`](super::waves).

use super::{Form, FormOperand};
use crate::bounds::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::Machine;
use crate::rules::{Rule, enclose};
use std::f64::consts::{LOG2_E, LOG10_E};
use zeroset_ops::Op;

/// What is known of a function's slope at the middle, and of its bend over the bounds.
struct Shape<V> {
    /// α.
    slope: V,
    /// At least |f′(m) − α|.
    off: V,
    /// At least −f″ and f″ over the bounds, and at least 0.
    bend: [V; 2],
}

/// Computed in so few operations, a number without cancellations is off by less than so many units
/// of itself.
const UNITS: f64 = 32.0;

impl<M: Machine> Rule<'_, M> {
    /// √x − αx for α = 1/(√lo + √hi) is at most 1/(4α), and least at one of the ends.
    pub(super) fn form_sqrt<const N: usize>(&mut self, a: &FormOperand<M::V, N>) -> Form<M::V, N> {
        let bounds = self.operand(a);
        let value = self.sqrt(&bounds);
        let (zero, one, quarter) = (self.zero(), self.number(1.0), self.number(0.25));
        let lo = self.m.neg(bounds.value.neg_lo);
        let lo = self.m.max(lo, zero);
        let sum = self.m.sub(value.hi, value.neg_lo);
        let slope = self.m.div(one, sum);
        let most = self.m.div(quarter, slope);
        let at_lo = self.m.mul(slope, lo);
        let at_lo = self.m.add(at_lo, value.neg_lo);
        // √hi is at least hi over its own upper bound.
        let opposite = self.m.neg(bounds.value.hi);
        let neg_root = self.m.div(opposite, value.hi);
        let at_hi = self.m.mul(slope, bounds.value.hi);
        let at_hi = self.m.add(at_hi, neg_root);
        let neg_least = self.m.max(at_lo, at_hi);
        let (middle, half) = self.middle(neg_least, most);
        let form = self.form_line(&a.value, slope, middle, half);
        self.beside(&form, &value)
    }

    pub(super) fn form_curve<const N: usize>(
        &mut self,
        op: Op,
        a: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let bounds = self.operand(a);
        let value = enclose(self.m, self.format, op, &[bounds]);
        let (middle, reach) = self.middle(bounds.value.neg_lo, bounds.value.hi);
        let point = self.point(middle, &bounds);
        let here = enclose(self.m, self.format, op, &[point]);
        let Some(shape) = self.shape(op, &bounds, &point, &here, &value) else {
            return self.form_between(&value);
        };
        let form = self.form_taylor(&a.value, [middle, reach], &here, &shape);
        self.beside(&form, &value)
    }

    /// One number within an operand's bounds.
    pub(super) fn point(&mut self, at: M::V, bounds: &Operand<M::V>) -> Operand<M::V> {
        Operand { value: Enclosure::total(self.m.neg(at), at), ..*bounds }
    }

    /// f(m) + α(a − m) and the rest.
    fn form_taylor<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        [middle, reach]: [M::V; 2],
        here: &Enclosure<M::V>,
        shape: &Shape<M::V>,
    ) -> Form<M::V, N> {
        let off = self.m.mul(shape.off, reach);
        let half = self.number(0.5);
        let square = self.m.mul(reach, reach);
        let square = self.m.mul(square, half);
        let ends = [(here.neg_lo, shape.bend[0]), (here.hi, shape.bend[1])];
        let [neg_lo, hi] = ends.map(|(end, bend)| {
            let curved = self.m.mul(bend, square);
            let rest = self.m.add(curved, off);
            self.m.add(end, rest)
        });
        let (offset, half) = self.middle(neg_lo, hi);
        let moved = self.form_moved(a, middle);
        self.form_line(&moved, shape.slope, offset, half)
    }

    /// a − m, the bounds left as they are.
    pub(super) fn form_moved<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        middle: M::V,
    ) -> Form<M::V, N> {
        let [centre] = self.pairwise([a.centre], [middle], M::sub);
        let size = self.m.abs(centre);
        let magnitude = match self.spread(a) {
            Some(spread) => self.m.add(size, spread),
            None => size,
        };
        // What a − m rounds is far below what is counted for centres of its size.
        let rounding = self.rounded(None, 1.0, size);
        let error = self.error_of(a);
        let error = self.sum_of(error, Some(rounding));
        Form { centre, error, magnitude: Some(magnitude), units: 0.0, ..*a }
    }

    /// The slope of `op` at a point, and its bend over bounds in which it has the enclosure
    /// `value`; `None` if this is not how its form is made. Where it is not smooth the bend is not
    /// finite, or the bounds are.
    fn shape(
        &mut self,
        op: Op,
        bounds: &Operand<M::V>,
        point: &Operand<M::V>,
        here: &Enclosure<M::V>,
        value: &Enclosure<M::V>,
    ) -> Option<Shape<M::V>> {
        let (zero, one) = (self.zero(), self.number(1.0));
        let x = point.value.hi;
        let square = self.m.mul(x, x);
        let most = self.m.max(bounds.value.neg_lo, bounds.value.hi);
        Some(match op {
            // Its own slope and bend.
            Op::Exp => {
                let (slope, off) = self.middle(here.neg_lo, here.hi);
                Shape { slope, off, bend: [zero, value.hi] }
            }
            Op::Ln => self.shape_of_logarithm(1.0, x, bounds.value.neg_lo),
            Op::Log2 => self.shape_of_logarithm(LOG2_E, x, bounds.value.neg_lo),
            Op::Log10 => self.shape_of_logarithm(LOG10_E, x, bounds.value.neg_lo),
            Op::Cbrt => self.shape_of_cbrt(here, value),
            // 1 + tan² and 2·tan·(1 + tan²).
            Op::Tan => {
                let [neg_lo, hi] = self.one_plus_square(here);
                let (slope, off) = self.middle(neg_lo, hi);
                let most = self.m.max(value.neg_lo, value.hi);
                let power = self.m.mul(most, most);
                let power = self.m.add(power, one);
                let twice = self.m.add(most, most);
                let bend = self.m.mul(power, twice);
                Shape { slope, off, bend: [bend, bend] }
            }
            Op::Asin => self.shape_of_asin(x, most),
            Op::Acos => {
                let shape = self.shape_of_asin(x, most);
                Shape { slope: self.m.neg(shape.slope), ..shape }
            }
            // 1/(1 + x²) and −2x/(1 + x²)², at most 3√3/8.
            Op::Atan => {
                let divisor = self.m.add(square, one);
                let slope = self.m.div(one, divisor);
                let bend = self.m.add(most, most);
                let limit = self.number(0.656_25);
                let bend = self.m.min(bend, limit);
                self.algebraic(slope, bend)
            }
            // Each is the other's slope, and its own bend.
            Op::Sinh | Op::Cosh => {
                let other = if op == Op::Sinh { Op::Cosh } else { Op::Sinh };
                let derivative = enclose(self.m, self.format, other, &[*point]);
                let (slope, off) = self.middle(derivative.neg_lo, derivative.hi);
                let bend = [value.neg_lo, value.hi].map(|end| self.m.max(end, zero));
                Shape { slope, off, bend }
            }
            // 1 − tanh² and −2·tanh·(1 − tanh²), at most 4/(3√3).
            Op::Tanh => {
                let [neg_lo, hi] = self.one_plus_square(here);
                // 1 − t² = 2 − (1 + t²).
                let two = self.number(2.0);
                let (most, neg_least) = (self.m.add(two, neg_lo), self.m.sub(hi, two));
                let (slope, off) = self.middle(neg_least, most);
                let limit = self.number(0.781_25);
                Shape { slope, off, bend: [limit, limit] }
            }
            // 1/√(x² + 1) and −x/(x² + 1)^1.5, at most 2/(3√3).
            Op::Asinh => {
                let sum = self.m.add(square, one);
                let root = self.m.sqrt(sum);
                let slope = self.m.div(one, root);
                let limit = self.number(0.390_625);
                let bend = self.m.min(most, limit);
                self.algebraic(slope, bend)
            }
            Op::Acosh => self.shape_of_acosh(x, bounds.value.neg_lo),
            Op::Atanh => self.shape_of_atanh(x, most),
            Op::Neg
            | Op::Abs
            | Op::Sign
            | Op::Floor
            | Op::Ceil
            | Op::Round
            | Op::Trunc
            | Op::Fract
            | Op::Sqr
            | Op::Sqrt
            | Op::Sin
            | Op::Cos
            | Op::Add
            | Op::Sub
            | Op::Mul
            | Op::Div
            | Op::Pow
            | Op::Mod
            | Op::Atan2
            | Op::Min
            | Op::Max
            | Op::SelectNegative
            | Op::Otherwise
            | Op::WhereNonneg
            | Op::WherePositive
            | Op::WhereNonzero
            | Op::WhereDefined => return None,
        })
    }

    /// 1/x and −1/x², times the logarithm of e.
    fn shape_of_logarithm(&mut self, log_e: f64, x: M::V, neg_lo: M::V) -> Shape<M::V> {
        let zero = self.zero();
        let base = self.nearest(log_e);
        let slope = self.m.div(base, x);
        let lo = self.m.neg(neg_lo);
        let least = self.m.max(lo, zero);
        let bend = self.m.div(base, least);
        let bend = self.m.div(bend, least);
        let shape = self.algebraic(slope, bend);
        Shape { bend: [shape.bend[0], zero], ..shape }
    }

    /// 1/(3c²) and −2/(9c⁵) for c = ∛x: the bend is greatest nearest to 0.
    fn shape_of_cbrt(&mut self, here: &Enclosure<M::V>, value: &Enclosure<M::V>) -> Shape<M::V> {
        let one = self.number(1.0);
        let zero = self.zero();
        let (near, _) = self.middle(here.neg_lo, here.hi);
        let width = self.m.add(here.neg_lo, here.hi);
        let three = self.number(3.0);
        let square = self.m.mul(near, near);
        let triple = self.m.mul(square, three);
        let slope = self.m.div(one, triple);
        let share = self.number(0.25);
        // How far a relative error of c makes the slope off, twice over.
        let size = self.m.abs(near);
        let relative = self.m.div(width, size);
        let four = self.number(4.0);
        let relative = self.m.mul(relative, four);
        let carried = self.m.mul(relative, slope);
        // From the value's side nearer to 0.
        let least = self.m.min(value.neg_lo, value.hi);
        let least = self.m.neg(least);
        let power = self.m.mul(least, least);
        // Divided one by one: a quotient that underflows is rounded up, a power that overflows
        // would hide it.
        let bend = self.m.div(share, power);
        let bend = self.m.div(bend, power);
        let bend = self.m.div(bend, least);
        let positive = self.gt(least, zero);
        let infinity = self.infinity();
        let bend = self.m.select(positive, bend, infinity);
        let shape = self.algebraic(slope, bend);
        Shape { off: self.m.add(shape.off, carried), ..shape }
    }

    /// 1/√(1 − x²) and x/(1 − x²)^1.5.
    fn shape_of_asin(&mut self, x: M::V, most: M::V) -> Shape<M::V> {
        let one = self.number(1.0);
        let (above, below) = (self.m.add(one, x), self.m.sub(one, x));
        let product = self.m.mul(above, below);
        let root = self.m.sqrt(product);
        let slope = self.m.div(one, root);
        let (above, below) = (self.m.add(one, most), self.m.sub(one, most));
        let product = self.m.mul(above, below);
        let root = self.m.sqrt(product);
        let cube = self.m.mul(root, product);
        let bend = self.m.div(most, cube);
        self.algebraic(slope, bend)
    }

    /// 1/√(x² − 1) and −x/(x² − 1)^1.5, greatest at the lower end.
    fn shape_of_acosh(&mut self, x: M::V, neg_lo: M::V) -> Shape<M::V> {
        let one = self.number(1.0);
        let (above, below) = (self.m.add(x, one), self.m.sub(x, one));
        let product = self.m.mul(above, below);
        let root = self.m.sqrt(product);
        let slope = self.m.div(one, root);
        let lo = self.m.neg(neg_lo);
        let lo = self.m.max(lo, one);
        let (above, below) = (self.m.add(lo, one), self.m.sub(lo, one));
        let square = self.m.mul(above, below);
        let root = self.m.sqrt(square);
        let bend = self.m.div(lo, square);
        let bend = self.m.div(bend, root);
        let infinity = self.infinity();
        let fits = self.m.lt(product, infinity);
        let bend = self.m.select(fits, bend, infinity);
        self.algebraic(slope, bend)
    }

    /// 1/(1 − x²) and 2x/(1 − x²)².
    fn shape_of_atanh(&mut self, x: M::V, most: M::V) -> Shape<M::V> {
        let one = self.number(1.0);
        let zero = self.zero();
        let (above, below) = (self.m.add(one, x), self.m.sub(one, x));
        let product = self.m.mul(above, below);
        let slope = self.m.div(one, product);
        let (above, below) = (self.m.add(one, most), self.m.sub(one, most));
        let below = self.m.max(below, zero);
        let product = self.m.mul(above, below);
        let product = self.m.mul(product, product);
        let twice = self.m.add(most, most);
        let bend = self.m.div(twice, product);
        self.algebraic(slope, bend)
    }

    /// −lo and hi of 1 + x².
    fn one_plus_square(&mut self, x: &Enclosure<M::V>) -> [M::V; 2] {
        let square = self.sqr(&Operand::new(*x, Interval::ENTIRE));
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        [self.m.add(square.neg_lo, minus_one), self.m.add(square.hi, one)]
    }

    /// A slope and a bound on the bend, to either side, that a few operations without cancellation
    /// gave.
    fn algebraic(&mut self, slope: M::V, bend: M::V) -> Shape<M::V> {
        let share = self.number(UNITS * self.unit());
        let size = self.m.abs(slope);
        let (off, more) = (self.m.mul(size, share), self.m.mul(bend, share));
        let bend = self.m.add(bend, more);
        let off = self.above_tiny(Some(off)).expect("a bound");
        Shape { slope, off, bend: [bend, bend] }
    }
}
