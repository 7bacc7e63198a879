//! Forms of smooth functions of one variable.
//!
//! For bounds with the middle m and the half-width h, f(x) = f(m) + f′(m)(x − m) + ½f″(ξ)(x − m)²,
//! where ξ is between x and m. The slope is any number α near f′(m). The error includes |f′(m) −
//! α|·h and a bound on the last term. If f″ has one sign, the last term lies on one side only.
//! Square roots have a closed form. Sine and cosine share their work; see [`waves`](super::waves).

use super::{Form, FormOperand};
use crate::bounds::Interval;
use crate::enclosure::{Enclosure, Operand};
use crate::machine::Machine;
use crate::rules::{Rule, enclose};
use zeroset_ops::Op;

/// The bounds of an operand and their middle, at which a function's derivatives are evaluated.
pub(super) struct ExpansionPoint<V> {
    /// The middle of the bounds.
    pub(super) x: V,
    /// The middle of the bounds, as an operand.
    pub(super) point: Operand<V>,
    /// Minus the lower end of the bounds.
    pub(super) neg_lo: V,
    /// The largest magnitude of a number within the bounds.
    pub(super) most: V,
    /// The function's enclosure at the middle; `value` is its enclosure over the bounds.
    pub(super) here: Enclosure<V>,
    pub(super) value: Enclosure<V>,
}

/// A function that computes a slope and bounds of the second derivative.
type DerivativesOf<R, V> = fn(&mut R, &ExpansionPoint<V>) -> Derivatives<V>;

/// The slope of a function, and bounds of its second derivative: the bend.
pub(super) struct Derivatives<V> {
    /// The slope α.
    pub(super) slope: V,
    /// An upper bound of |f′(m) − α|.
    pub(super) off: V,
    /// Upper bounds of −f″ and of f″, at least 0, over the operand's bounds.
    pub(super) bend: [V; 2],
}

/// Bound on the error of a result of few operations without cancellation, in units of the result.
pub(super) const UNITS: f64 = 32.0;

impl<M: Machine> Rule<'_, M> {
    /// The form of √x. For α = 1/(√lo + √hi), √x − αx is at most 1/(4α), and is least at an end.
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
        // A lower bound of √hi is hi divided by the upper bound of √hi.
        let opposite = self.m.neg(bounds.value.hi);
        let neg_root = self.m.div(opposite, value.hi);
        let at_hi = self.m.mul(slope, bounds.value.hi);
        let at_hi = self.m.add(at_hi, neg_root);
        let neg_least = self.m.max(at_lo, at_hi);
        let (middle, half) = self.middle(neg_least, most);
        let form = self.form_line(&a.value, slope, middle, half);
        self.with_bounds(&form, &value)
    }

    /// The form of a function whose slope is at most 2 and whose second derivative is at most
    /// `bend`, both in magnitude. `ends` bound it at the ends of its operand, each as [−lo, hi];
    /// `value` encloses it.
    ///
    /// For any α, f(x) − αx lies between its values at the ends, or at most ⅛ · `bend` · width²
    /// outside. Here α is the slope of the chord.
    pub(super) fn form_chord<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        bounds: &Operand<M::V>,
        [first, last]: [[M::V; 2]; 2],
        value: &Enclosure<M::V>,
        bend: f64,
    ) -> Form<M::V, N> {
        let Enclosure { neg_lo, hi, .. } = bounds.value;
        let lo = self.m.neg(neg_lo);
        let width = self.m.add(neg_lo, hi);
        let rise = self.m.add(last[1], first[0]);
        let slope = self.m.div(rise, width);
        let (most, least) = (self.number(2.0), self.number(-2.0));
        let slope = self.m.min(slope, most);
        let slope = self.m.max(slope, least);
        let share = self.number(bend / 8.0);
        let scaled = self.m.mul(width, share);
        let curved = self.m.mul(scaled, width);
        let neg_hi = self.m.neg(hi);
        let sides = [[(first[0], lo), (last[0], hi)], [(first[1], neg_lo), (last[1], neg_hi)]];
        let [neg_least, most] = sides.map(|ends| {
            let [first, last] = ends.map(|(bound, place)| self.m.mul_add(slope, place, bound));
            let bound = self.m.max(first, last);
            self.m.add(bound, curved)
        });
        let (middle, half) = self.middle(neg_least, most);
        let form = self.form_line(&a.value, slope, middle, half);
        self.with_bounds(&form, value)
    }

    /// The form of a smooth function, with the slope and bend that `shape` returns. The bend or the
    /// bounds are infinite where the function is not smooth.
    pub(super) fn form_curve<const N: usize>(
        &mut self,
        op: Op,
        shape: DerivativesOf<Self, M::V>,
        a: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let bounds = self.operand(a);
        let Enclosure { neg_lo, hi, .. } = bounds.value;
        let value = enclose(self.m, self.format, op, &[bounds]);
        let (x, reach) = self.middle(neg_lo, hi);
        let point = self.point(x, &bounds);
        let here = enclose(self.m, self.format, op, &[point]);
        let most = self.m.max(neg_lo, hi);
        let shape = shape(self, &ExpansionPoint { x, point, neg_lo, most, here, value });
        let form = self.form_taylor(&a.value, [x, reach], &here, &shape);
        self.with_bounds(&form, &value)
    }

    /// The operand whose only value is `at`. Everything else is copied from `bounds`.
    pub(super) fn point(&mut self, at: M::V, bounds: &Operand<M::V>) -> Operand<M::V> {
        Operand { value: Enclosure::total(self.m.neg(at), at), ..*bounds }
    }

    /// The form f(m) + α(a − m), where m is `middle`. Its error bounds the rest of the Taylor
    /// series for operands that differ from m by at most `reach`. `here` encloses f(m).
    fn form_taylor<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        [middle, reach]: [M::V; 2],
        here: &Enclosure<M::V>,
        shape: &Derivatives<M::V>,
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

    /// The form of a − m. Its stored bounds are still those of a.
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
        // The subtraction errs by less than one unit of its result.
        let rounding = self.rounded(None, 1.0, size);
        let error = self.error_of(a);
        let error = self.sum_of(error, Some(rounding));
        Form { centre, error, magnitude: Some(magnitude), units: 0.0, ..*a }
    }

    /// For the exponential function, f′ = f″ = f.
    pub(super) fn shape_of_exp(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let (slope, off) = self.middle(at.here.neg_lo, at.here.hi);
        Derivatives { slope, off, bend: [self.zero(), at.value.hi] }
    }

    /// For the natural logarithm, f′ = 1/x and f″ = −1/x².
    pub(super) fn shape_of_ln(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        self.shape_of_logarithm(1.0, at)
    }

    /// For any logarithm, f′ = e₁/x and f″ = −e₁/x², where e₁ is the logarithm of e.
    pub(super) fn shape_of_logarithm(
        &mut self,
        log_e: f64,
        at: &ExpansionPoint<M::V>,
    ) -> Derivatives<M::V> {
        let zero = self.zero();
        let base = self.nearest(log_e);
        let slope = self.m.div(base, at.x);
        let lo = self.m.neg(at.neg_lo);
        let least = self.m.max(lo, zero);
        let bend = self.m.div(base, least);
        let bend = self.m.div(bend, least);
        let shape = self.algebraic(slope, bend);
        Derivatives { bend: [shape.bend[0], zero], ..shape }
    }

    /// For c = ∛x, f′ = 1/(3c²) and f″ = −2/(9c⁵). |f″| is greatest at the operand nearest to 0.
    pub(super) fn shape_of_cbrt(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let ExpansionPoint { here, value, .. } = at;
        let one = self.number(1.0);
        let zero = self.zero();
        let (near, _) = self.middle(here.neg_lo, here.hi);
        let width = self.m.add(here.neg_lo, here.hi);
        let three = self.number(3.0);
        let square = self.m.mul(near, near);
        let triple = self.m.mul(square, three);
        let slope = self.m.div(one, triple);
        let share = self.number(0.25);
        // This is twice the error that the relative error of c causes in the slope.
        let size = self.m.abs(near);
        let relative = self.m.div(width, size);
        let four = self.number(4.0);
        let relative = self.m.mul(relative, four);
        let carried = self.m.mul(relative, slope);
        // The magnitude of the function's value nearest to 0.
        let least = self.m.min(value.neg_lo, value.hi);
        let least = self.m.neg(least);
        let power = self.m.mul(least, least);
        // The division goes step by step. A quotient that underflows is rounded up, while a power
        // that overflows would make the bend 0.
        let bend = self.m.div(share, power);
        let bend = self.m.div(bend, power);
        let bend = self.m.div(bend, least);
        let positive = self.gt(least, zero);
        let infinity = self.infinity();
        let bend = self.m.select(positive, bend, infinity);
        let shape = self.algebraic(slope, bend);
        Derivatives { off: self.m.add(shape.off, carried), ..shape }
    }

    /// For the tangent, f′ = 1 + tan² and f″ = 2·tan·(1 + tan²).
    pub(super) fn shape_of_tan(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let [neg_lo, hi] = self.one_plus_square(&at.here);
        let (slope, off) = self.middle(neg_lo, hi);
        let most = self.m.max(at.value.neg_lo, at.value.hi);
        let power = self.m.mul(most, most);
        let power = self.m.add(power, one);
        let twice = self.m.add(most, most);
        let bend = self.m.mul(power, twice);
        Derivatives { slope, off, bend: [bend, bend] }
    }

    /// For the arcsine, f′ = 1/√(1 − x²) and f″ = x/(1 − x²)^1.5.
    pub(super) fn shape_of_asin(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let product = self.difference_of_squares(one, at.x);
        let root = self.m.sqrt(product);
        let slope = self.m.div(one, root);
        let product = self.difference_of_squares(one, at.most);
        let root = self.m.sqrt(product);
        let cube = self.m.mul(root, product);
        let bend = self.m.div(at.most, cube);
        self.algebraic(slope, bend)
    }

    /// For the arccosine, the derivatives are those of the arcsine, negated.
    pub(super) fn shape_of_acos(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let shape = self.shape_of_asin(at);
        Derivatives { slope: self.m.neg(shape.slope), ..shape }
    }

    /// For the arctangent, f′ = 1/(1 + x²), f″ = −2x/(1 + x²)² and |f″| ≤ 3√3/8.
    pub(super) fn shape_of_atan(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let square = self.m.mul(at.x, at.x);
        let divisor = self.m.add(square, one);
        let slope = self.m.div(one, divisor);
        let bend = self.m.add(at.most, at.most);
        let limit = self.number(0.656_25);
        let bend = self.m.min(bend, limit);
        self.algebraic(slope, bend)
    }

    /// For sinh, f′ = cosh; for cosh, f′ = sinh. `slope` is the operation of f′, and f″ = f.
    pub(super) fn shape_of_hyperbolic(
        &mut self,
        slope: Op,
        at: &ExpansionPoint<M::V>,
    ) -> Derivatives<M::V> {
        let zero = self.zero();
        let derivative = enclose(self.m, self.format, slope, &[at.point]);
        let (slope, off) = self.middle(derivative.neg_lo, derivative.hi);
        let bend = [at.value.neg_lo, at.value.hi].map(|end| self.m.max(end, zero));
        Derivatives { slope, off, bend }
    }

    /// For the hyperbolic tangent t, f′ = 1 − t², f″ = −2t(1 − t²) and |f″| ≤ 4/(3√3).
    pub(super) fn shape_of_tanh(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let [neg_lo, hi] = self.one_plus_square(&at.here);
        // 1 − t² is computed as 2 − (1 + t²).
        let two = self.number(2.0);
        let (most, neg_least) = (self.m.add(two, neg_lo), self.m.sub(hi, two));
        let (slope, off) = self.middle(neg_least, most);
        let limit = self.number(0.781_25);
        Derivatives { slope, off, bend: [limit, limit] }
    }

    /// For asinh, f′ = 1/√(x² + 1), f″ = −x/(x² + 1)^1.5 and |f″| ≤ 2/(3√3).
    pub(super) fn shape_of_asinh(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let square = self.m.mul(at.x, at.x);
        let sum = self.m.add(square, one);
        let root = self.m.sqrt(sum);
        let slope = self.m.div(one, root);
        let limit = self.number(0.390_625);
        let bend = self.m.min(at.most, limit);
        self.algebraic(slope, bend)
    }

    /// For acosh, f′ = 1/√(x² − 1) and f″ = −x/(x² − 1)^1.5. |f″| is greatest at the lower end.
    pub(super) fn shape_of_acosh(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let product = self.difference_of_squares(at.x, one);
        let root = self.m.sqrt(product);
        let slope = self.m.div(one, root);
        let lo = self.m.neg(at.neg_lo);
        let lo = self.m.max(lo, one);
        let square = self.difference_of_squares(lo, one);
        let root = self.m.sqrt(square);
        let bend = self.m.div(lo, square);
        let bend = self.m.div(bend, root);
        let infinity = self.infinity();
        let fits = self.m.lt(product, infinity);
        let bend = self.m.select(fits, bend, infinity);
        self.algebraic(slope, bend)
    }

    /// For atanh, f′ = 1/(1 − x²) and f″ = 2x/(1 − x²)².
    pub(super) fn shape_of_atanh(&mut self, at: &ExpansionPoint<M::V>) -> Derivatives<M::V> {
        let one = self.number(1.0);
        let zero = self.zero();
        let product = self.difference_of_squares(one, at.x);
        let slope = self.m.div(one, product);
        let (above, below) = (self.m.add(one, at.most), self.m.sub(one, at.most));
        let below = self.m.max(below, zero);
        let product = self.m.mul(above, below);
        let product = self.m.mul(product, product);
        let twice = self.m.add(at.most, at.most);
        let bend = self.m.div(twice, product);
        self.algebraic(slope, bend)
    }

    /// Computes a² − b² as (a + b)(a − b).
    fn difference_of_squares(&mut self, a: M::V, b: M::V) -> M::V {
        let (above, below) = (self.m.add(a, b), self.m.sub(a, b));
        self.m.mul(above, below)
    }

    /// Bounds of 1 + x², as −lo and hi.
    fn one_plus_square(&mut self, x: &Enclosure<M::V>) -> [M::V; 2] {
        let square = self.sqr(&Operand::new(*x, Interval::ENTIRE));
        let (one, minus_one) = (self.number(1.0), self.number(-1.0));
        [self.m.add(square.neg_lo, minus_one), self.m.add(square.hi, one)]
    }

    /// Derivatives from a slope and a bound on |f″|. Both must result from few operations without
    /// cancellation.
    fn algebraic(&mut self, slope: M::V, bend: M::V) -> Derivatives<M::V> {
        let share = self.number(UNITS * self.unit());
        let size = self.m.abs(slope);
        let (off, more) = (self.m.mul(size, share), self.m.mul(bend, share));
        let bend = self.m.add(bend, more);
        let off = self.plus_tiny(off);
        Derivatives { slope, off, bend: [bend, bend] }
    }
}
