//! Forms of sine and cosine, built as in [`functions`](super::functions). Up to sign, each function
//! is the derivative of the other, and its own second derivative.

use super::{Form, FormOperand};
use crate::machine::Machine;
use crate::rules::{NEAR_UNITS, Rule};

/// The value of sine or cosine at one number.
#[derive(Clone, Copy)]
struct WaveValue<V> {
    value: V,
    /// The magnitude of `value`.
    size: V,
    /// Bound on the distance of `value` from the exact value.
    off: V,
}

/// The parts of an operand that the forms of both functions need.
struct CenteredOperand<V, const N: usize> {
    /// The operand's form minus the middle of the operand's bounds.
    moved: Form<V, N>,
    /// Half the width of the operand's bounds.
    reach: V,
    /// A quarter of `reach` squared.
    square: V,
}

impl<M: Machine> Rule<'_, M> {
    /// The forms of the sine and the cosine of `a`.
    pub(super) fn form_waves<const N: usize>(
        &mut self,
        a: &FormOperand<M::V, N>,
    ) -> [Form<M::V, N>; 2] {
        let bounds = self.operand(a);
        let (middle, reach) = self.middle(bounds.value.neg_lo, bounds.value.hi);
        let [sin, cos] = if self.is_near(a.range) {
            let share = self.number(NEAR_UNITS * self.unit());
            let values = self.near_waves_at(middle);
            values.map(|value| {
                let size = self.m.abs(value);
                WaveValue { value, size, off: self.m.mul(size, share) }
            })
        } else {
            let point = self.point(middle, &bounds);
            self.waves_of_point(&point).map(|[neg_lo, hi]| {
                let (value, off) = self.middle(neg_lo, hi);
                WaveValue { value, size: self.m.abs(value), off }
            })
        };
        let moved = self.form_moved(&a.value, middle);
        let quarter = self.number(0.25);
        let square = self.m.mul(reach, reach);
        let place = CenteredOperand { moved, reach, square: self.m.mul(square, quarter) };
        let opposite = WaveValue { value: self.m.neg(sin.value), ..sin };
        [(sin, cos), (cos, opposite)].map(|(here, slope)| self.form_wave(&place, &here, &slope))
    }

    /// The form v + α(a − m), for the value v and slope α at the middle m, with an error that
    /// bounds its distance from f. The second derivative is −f, so f(x) − v − α(x − m) is between
    /// −2p and 2q. Here p is reach²/4 times the function's greatest value, and q is −reach²/4 times
    /// its least. The form adds q − p ± (q + p).
    ///
    /// Rounding: center and slopes err by less than two units of |α|(|m| + Σ|slopes|). The center
    /// also errs by one unit of v + (q − p), and that sum by one unit of v and two of q + p.
    fn form_wave<const N: usize>(
        &mut self,
        place: &CenteredOperand<M::V, N>,
        here: &WaveValue<M::V>,
        slope: &WaveValue<M::V>,
    ) -> Form<M::V, N> {
        let (zero, one) = (self.zero(), self.number(1.0));
        let a = &place.moved;
        // Within `reach` of the middle, the function changes by at most `reach`.
        let change = self.m.add(place.reach, here.off);
        let above = self.m.add(change, here.value);
        let below = self.m.sub(change, here.value);
        let wide = [below, above].map(|end| self.m.min(end, one));
        let [q, p] = wide.map(|bend| {
            let bend = self.m.max(bend, zero);
            self.m.mul(bend, place.square)
        });
        let shift = self.m.sub(q, p);
        let offset = self.m.add(here.value, shift);
        let curved = self.m.add(q, p);
        let with_rounding = self.number(1.0 + 4.0 * self.unit());
        let mut error = self.m.mul_add(curved, with_rounding, here.off);
        error = self.m.mul_add(slope.off, place.reach, error);
        if let Some(a_error) = self.error_of(a) {
            error = self.m.mul_add(a_error, slope.size, error);
        }
        let error = self.plus_tiny(error);
        let magnitude = self.magnitude_of(a);
        let magnitude = self.m.mul_add(magnitude, slope.size, here.size);
        let error = self.rounded(Some(error), 2.5, magnitude);
        let centre = self.m.mul_add(a.centre, slope.value, offset);
        let slopes = a.slopes.map(|slopes| self.pairwise(slopes, [slope.value; N], M::mul));
        let value = a.facts.with(wide);
        self.with_bounds(&Form::total(centre, slopes, Some(error)), &value)
    }
}
