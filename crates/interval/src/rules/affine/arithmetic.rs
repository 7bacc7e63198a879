//! Affine forms of sums, products and quotients.
//!
//! A sum that is rounded up errs by less than a [unit](Rule::unit) of its result. A product errs by
//! less than a unit of its result plus the least positive number. So the center and slopes of a
//! form err together by a small number of units of the sum of their magnitudes. The numbers of
//! units here are a little larger, which covers the rounding of that sum. A form counts its units
//! and adds them to its error only when the error is used: once for a sum of many terms.
//!
//! A sum that overflows downward rounds up to a finite number, which is not a valid center. But
//! neither the center nor a slope exceeds the form's rounded magnitude. So the magnitude is then
//! infinite, and so is the error.

use super::{Form, FormOperand};
use crate::bounds::Interval;
use crate::branch::Branch;
use crate::enclosure::{Enclosure, Exponent};
use crate::machine::Machine;
use crate::rules::Rule;
use zeroset_ops::Op;

impl<M: Machine> Rule<'_, M> {
    pub(super) fn form_neg<const N: usize>(&mut self, a: &Form<M::V, N>) -> Form<M::V, N> {
        Form {
            centre: self.m.neg(a.centre),
            slopes: a.slopes.map(|slopes| slopes.map(|slope| self.m.neg(slope))),
            bounds: a.bounds.map(|[neg_lo, hi]| [hi, neg_lo]),
            ..*a
        }
    }

    pub(super) fn form_neg_operand<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
    ) -> FormOperand<M::V, N> {
        let range = Interval { lo: -a.range.hi, hi: -a.range.lo };
        FormOperand { value: self.form_neg(&a.value), range, exponent: Exponent::Real }
    }

    /// Adds the rounding error of `units` units of `magnitude` to `error`.
    pub(super) fn rounded(&mut self, error: Option<M::V>, units: f64, magnitude: M::V) -> M::V {
        let units = self.number(units * self.unit());
        match error {
            Some(error) => self.m.mul_add(magnitude, units, error),
            None => self.m.mul(magnitude, units),
        }
    }

    pub(super) fn form_sum<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        b: &Form<M::V, N>,
    ) -> Form<M::V, N> {
        self.form_sum_by(M::add, a, b)
    }

    /// The form of a − b. If `a` depends on no symbol, the negated b is added. Else b is
    /// subtracted.
    pub(super) fn form_difference<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        b: &Form<M::V, N>,
    ) -> Form<M::V, N> {
        if a.slopes.is_none() {
            let b = self.form_neg(b);
            return self.form_sum(a, &b);
        }
        let b = Form { bounds: b.bounds.map(|[neg_lo, hi]| [hi, neg_lo]), ..*b };
        self.form_sum_by(M::sub, a, &b)
    }

    /// The form of a + b, or of a − b if `a` depends on a symbol. `op` adds or subtracts the
    /// centers and slopes. For a difference, the caller must negate the bounds of `b`.
    fn form_sum_by<const N: usize>(
        &mut self,
        op: impl Fn(&mut M, M::V, M::V) -> M::V + Copy,
        a: &Form<M::V, N>,
        b: &Form<M::V, N>,
    ) -> Form<M::V, N> {
        let [centre] = self.pairwise([a.centre], [b.centre], op);
        let slopes = match (a.slopes, b.slopes) {
            (Some(a), Some(b)) => Some(self.pairwise(a, b, op)),
            (a, b) => a.or(b),
        };
        let (a_magnitude, b_magnitude) = (self.magnitude_of(a), self.magnitude_of(b));
        let magnitude = self.m.add(a_magnitude, b_magnitude);
        Form {
            centre,
            slopes,
            error: self.sum_of(a.error, b.error),
            magnitude: Some(magnitude),
            // `a.units` counts units of a's magnitude, `b.units` units of b's. The larger number
            // covers both.
            units: a.units.max(b.units) + 1.25,
            bounds: match (a.bounds, b.bounds) {
                (Some(a), Some(b)) => Some([self.m.add(a[0], b[0]), self.m.add(a[1], b[1])]),
                _ => None,
            },
            facts: a.facts.and(self.m, &b.facts),
        }
    }

    /// The form of a · b. At least one operand must have slopes.
    pub(super) fn form_product<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        if a.value.slopes.is_none() {
            return self.form_product(b, a);
        }
        let (a_bounds, b_bounds) = (a.value.bounds, b.value.bounds);
        let bounds = match (a_bounds, b_bounds) {
            (Some(_), Some(_)) => {
                let (a, b) = (self.operand_from_bounds(a), self.operand_from_bounds(b));
                let value = self.mul(&a, &b);
                Some([value.neg_lo, value.hi])
            }
            _ => None,
        };
        let facts = a.value.facts.and(self.m, &b.value.facts);
        let form = match b.value.slopes {
            None => self.form_scaled(a, b),
            Some(_) => self.form_product_varying(&a.value, &b.value),
        };
        Form { bounds, facts, ..form }
    }

    /// The form of `a` times a factor without symbols. The factor's error must include its
    /// rounding.
    fn form_scaled<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        factor: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let b = &factor.value;
        let exact = factor.range.singleton();
        let a = if exact.is_some() { a.value } else { self.including_rounding(a).value };
        // A factor that is a single number is used directly: computing the middle of its bounds may
        // overflow.
        let by = exact.map_or(b.centre, |number| self.number(number));
        let slopes = a.slopes.map(|slopes| self.pairwise(slopes, [by; N], M::mul));
        let size = match exact {
            Some(number) => self.number(number.abs()),
            None => self.m.abs(by),
        };
        let a_magnitude = self.magnitude_of(&a);
        let magnitude = self.m.mul(a_magnitude, size);
        let mut error = self.tiny();
        if let Some(a_error) = a.error {
            error = self.m.mul_add(a_error, size, error);
        }
        if exact.is_none()
            && let Some(factor_error) = b.error
        {
            // The largest magnitude of a, with its error, is multiplied by the error of the factor.
            let most = match a.error {
                Some(error) => self.m.add(a_magnitude, error),
                None => a_magnitude,
            };
            error = self.m.mul_add(most, factor_error, error);
        }
        Form {
            centre: self.m.mul(a.centre, by),
            slopes,
            error: Some(error),
            magnitude: Some(magnitude),
            units: a.units + 1.25,
            ..a
        }
    }

    /// The form of a · b for two operands with slopes, without the bounds that interval arithmetic
    /// gives.
    fn form_product_varying<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        b: &Form<M::V, N>,
    ) -> Form<M::V, N> {
        let (a_slopes, b_slopes) = (a.slopes.expect("it varies"), b.slopes.expect("it varies"));
        let [a_spread, b_spread] = [a, b].map(|form| self.spread(form).expect("it varies"));
        let [a_size, b_size] = [a, b].map(|form| self.m.abs(form.centre));
        let a_magnitude = self.m.add(a_size, a_spread);
        let b_magnitude = self.m.add(b_size, b_spread);
        // The last symbol runs along the ray, and its square is in [0, 1]. Half the coefficient of
        // this square is added to the center.
        let half = self.number(0.5);
        let depth = self.m.mul(a_slopes[N - 1], b_slopes[N - 1]);
        let centre = self.m.mul(a.centre, b.centre);
        let centre = self.m.mul_add(depth, half, centre);
        let slopes = std::array::from_fn(|k| {
            let first = self.m.mul(a.centre, b_slopes[k]);
            self.m.mul_add(a_slopes[k], b.centre, first)
        });
        // The error bounds all products of symbols, except for the half that was added to the
        // center. The rounding of that half is included.
        let size = self.m.abs(depth);
        let tiny = self.tiny();
        let mut error = if N == 1 {
            self.m.mul_add(size, half, tiny)
        } else {
            // The order matters: if `depth` is ∞, so are the spreads, and the error is NaN.
            let spreads = self.m.mul_add(a_spread, b_spread, tiny);
            let share = self.number(-0.5 * (1.0 - 8.0 * self.unit()));
            self.m.mul_add(size, share, spreads)
        };
        let mut b_most = b_magnitude;
        if let Some(b_error) = self.error_of(b) {
            b_most = self.m.add(b_magnitude, b_error);
            error = self.m.mul_add(b_error, a_magnitude, error);
        }
        if let Some(a_error) = self.error_of(a) {
            error = self.m.mul_add(b_most, a_error, error);
        }
        // The error is larger than the part of the center that comes from the square of the last
        // symbol. So if the center overflows, the magnitude is infinite.
        let magnitude = self.m.mul_add(a_magnitude, b_magnitude, error);
        let form = Form::total(centre, Some(slopes), Some(error));
        Form { magnitude: Some(magnitude), units: 3.0, ..form }
    }

    pub(super) fn form_square<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let form = self.form_square_of(&a.value);
        let bounds = a.value.bounds.map(|_| {
            let a = self.operand(a);
            let value = self.sqr(&a);
            [value.neg_lo, value.hi]
        });
        Form { bounds, ..form }
    }

    /// The form of the square, without bounds. For the sum S of the symbols' terms, (c + S)² = c² +
    /// 2c·S + S². S² is in [0, R²], where R is the sum of |slopes|.
    fn form_square_of<const N: usize>(&mut self, a: &Form<M::V, N>) -> Form<M::V, N> {
        let slopes = a.slopes.expect("it varies");
        let spread = self.spread(a).expect("it varies");
        let size = self.m.abs(a.centre);
        let most = self.m.add(size, spread);
        let half = self.number(0.5);
        let curved = self.m.mul(spread, spread);
        let curved = self.m.mul(curved, half);
        let [twice] = self.pairwise([a.centre], [a.centre], M::add);
        let mut error = self.plus_tiny(curved);
        let magnitude = self.m.mul_add(most, most, error);
        if let Some(a_error) = self.error_of(a) {
            let two = self.number(2.0);
            let both = self.m.mul_add(most, two, a_error);
            error = self.m.mul_add(both, a_error, error);
        }
        let centre = self.m.mul_add(a.centre, a.centre, curved);
        let slopes = self.pairwise([twice; N], slopes, M::mul);
        let form = Form::total(centre, Some(slopes), Some(error));
        Form { magnitude: Some(magnitude), units: 3.0, facts: a.facts, ..form }
    }

    /// The form of a/b: the product of a with the form of 1/b.
    pub(super) fn form_quotient<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let (a_bounds, b_bounds) = (self.operand(a), self.operand(b));
        let value = self.div(&a_bounds, &b_bounds);
        let reciprocal = self.form_reciprocal(&b.value, &b_bounds.value);
        let form = match (a.value.slopes, reciprocal.slopes) {
            (Some(_), Some(_)) => self.form_product_varying(&a.value, &reciprocal),
            (Some(_), None) => {
                let reciprocal = self.including_rounding(&FormOperand::new(reciprocal));
                self.form_scaled(a, &reciprocal)
            }
            (None, _) => {
                self.form_scaled(&FormOperand::new(reciprocal), &FormOperand::new(a.value))
            }
        };
        self.with_bounds(&form, &value)
    }

    /// The form of 1/b. For x in [lo, hi] above 0 and β = 1/(lo·hi), 1/x + βx is greatest at an
    /// end, and at least 2√β. The form is mirrored for b below 0. If b may be 0, the error is
    /// infinite and the form claims nothing.
    fn form_reciprocal<const N: usize>(
        &mut self,
        b: &Form<M::V, N>,
        bounds: &Enclosure<M::V>,
    ) -> Form<M::V, N> {
        let (zero, one) = (self.zero(), self.number(1.0));
        let below = self.m.lt(bounds.hi, bounds.neg_lo);
        let lo = self.m.neg(bounds.neg_lo);
        let opposite = self.m.neg(bounds.hi);
        let near = self.m.select(below, opposite, lo);
        let far = self.m.select(below, bounds.neg_lo, bounds.hi);
        let product = self.m.mul(near, far);
        let steep = self.m.div(one, product);
        let [at_near, at_far] = [near, far].map(|end| {
            let inverse = self.m.div(one, end);
            self.m.mul_add(steep, end, inverse)
        });
        let most = self.m.max(at_near, at_far);
        // This is −2√β rounded up: twice −β/√β, where √β is rounded up.
        let root = self.m.sqrt(steep);
        let negated = self.m.neg(steep);
        let negated = self.m.div(negated, root);
        let neg_least = self.m.add(negated, negated);
        let (middle, half) = self.middle(neg_least, most);
        let opposite = self.m.neg(middle);
        let middle = self.m.select(below, opposite, middle);
        let slope = self.m.neg(steep);
        let form = self.form_line(b, slope, middle, half);
        let apart = self.gt(near, zero);
        let infinity = self.infinity();
        let error = form.error.map(|error| self.m.select(apart, error, infinity));
        Form { error, ..form }
    }

    /// The form slope·a + middle ± half.
    pub(super) fn form_line<const N: usize>(
        &mut self,
        a: &Form<M::V, N>,
        slope: M::V,
        middle: M::V,
        half: M::V,
    ) -> Form<M::V, N> {
        let size = self.m.abs(slope);
        let a_magnitude = self.magnitude_of(a);
        let offset = self.m.abs(middle);
        let magnitude = self.m.mul_add(a_magnitude, size, offset);
        let mut error = half;
        if let Some(a_error) = self.error_of(a) {
            error = self.m.mul_add(a_error, size, error);
        }
        let error = self.plus_tiny(error);
        let centre = self.m.mul_add(a.centre, slope, middle);
        let slopes = a.slopes.map(|slopes| self.pairwise(slopes, [slope; N], M::mul));
        let form = Form::total(centre, slopes, Some(error));
        Form { magnitude: Some(magnitude), units: 2.5, facts: a.facts, ..form }
    }

    /// The form of a power: products for an integer exponent up to ±64, exp(b·ln a) for a real
    /// exponent, bounds for other exponents.
    pub(super) fn form_power<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let (base, exponent) = (self.operand(a), self.operand(b));
        let value = self.pow(&base, &exponent, Branch::Whole);
        let form = match b.exponent {
            Exponent::Integer(n)
                if n.unsigned_abs() <= 64 && n != 0 && a.value.slopes.is_some() =>
            {
                let power = self.by_squaring(
                    a.value,
                    n.unsigned_abs(),
                    |rule, a, b| rule.form_product_varying(&a, &b),
                    |rule, a| rule.form_square_of(&a),
                );
                if n > 0 {
                    power
                } else {
                    let bounds = self.operand(&FormOperand::new(power));
                    self.form_reciprocal(&power, &bounds.value)
                }
            }
            Exponent::Real => self.form_real_power(a, b),
            Exponent::Integer(_) | Exponent::LargeInteger { .. } => {
                return self.form_between(&value);
            }
        };
        self.with_bounds(&form, &value)
    }

    /// The form of exp(b·ln a). In lanes where a may not be positive, bounds replace the form.
    fn form_real_power<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
        b: &FormOperand<M::V, N>,
    ) -> Form<M::V, N> {
        let logarithm = if a.value.slopes.is_some() {
            self.form_curve(Op::Ln, Self::shape_of_ln, a)
        } else {
            self.bounded(Op::Ln, &[*a])
        };
        let product = self.form_product(&FormOperand::new(logarithm), &FormOperand::new(b.value));
        self.form_curve(Op::Exp, Self::shape_of_exp, &FormOperand::new(product))
    }
}
