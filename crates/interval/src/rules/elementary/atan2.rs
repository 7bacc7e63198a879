//! The angles of the points of a box in the plane.
//!
//! Above the x-axis, the angle grows from right to left. It grows with y right of the y-axis, and
//! falls with y left of it. So its extremes over a box are at two corners. The exception is a box
//! that meets the cut, where angles jump between π and −π.

use super::approximator::{Approximator, at_ends};
use crate::branch::Branch;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::Machine;
use crate::rules::Rule;

impl<M: Machine> Rule<'_, M> {
    /// Encloses the angle of (b, a) from (1, 0), in (−π, π]. It jumps at the cut a = 0, b < 0 and
    /// is undefined at the origin. If a box meets the cut from both sides, its low branch lies
    /// below the x-axis. The other branch lies on or above it.
    pub(in crate::rules) fn atan2(
        &mut self,
        a: &Operand<M::V>,
        b: &Operand<M::V>,
        branch: Branch,
    ) -> Enclosure<M::V> {
        let zero = self.zero();
        // An end that is 0 counts as above or to the right, so −0 becomes +0.
        let (mut y_lo, mut y_hi) = (self.lo(&a.value), self.m.add(a.value.hi, zero));
        let cut = self.meets_cut(a, b);
        if let Fact::Lanes(cut) = cut {
            match branch {
                Branch::Whole | Branch::Middle => {}
                Branch::Low => y_hi = self.m.select(cut, zero, y_hi),
                Branch::Rest | Branch::High => y_lo = self.m.select(cut, zero, y_lo),
            }
        }
        let (x_lo, x_hi) = (self.lo(&b.value), b.value.hi);
        let upper = self.m.le(zero, y_lo);
        let lower = self.m.le(y_hi, zero);
        let right = self.m.le(zero, x_lo);
        let mut reaches_right = self.gt(x_hi, zero);
        if b.range.lo >= 0.0 {
            // The origin has no angle. Its bounds must still lie within the bounds of boxes around
            // it.
            let flat = self.m.and(upper, lower);
            reaches_right = self.m.or(reaches_right, flat);
        }
        let sign_bit = self.sign_bit();
        // Above the x-axis, a box's least angle is at its right end, and its greatest at its left
        // end. The sign of x at an end decides which bound of y gives that angle. Below the x-axis,
        // all is mirrored: the angles swap ends, and the bounds of y swap.
        let at_right_upper = self.m.select(reaches_right, y_lo, y_hi);
        let at_left_upper = self.m.select(right, y_hi, y_lo);
        let at_right_lower = self.m.select(reaches_right, y_hi, y_lo);
        let at_left_lower = self.m.select(right, y_lo, y_hi);
        let at_right_lower = self.m.or(at_right_lower, sign_bit);
        let at_left_lower = self.m.or(at_left_lower, sign_bit);
        // In lanes where the box does not reach right of the y-axis, an upper end 0 of x becomes
        // −0, which counts as left.
        let negative = self.m.or(x_hi, sign_bit);
        let x_right = self.m.select(reaches_right, x_hi, negative);
        // If a box crosses the x-axis right of the y-axis, both extremes are at its left end.
        let least_y = self.m.select(lower, at_left_lower, y_lo);
        let least_y = self.m.select(upper, at_right_upper, least_y);
        let least_x = self.m.select(upper, x_right, x_lo);
        let greatest_y = self.m.select(lower, at_right_lower, y_hi);
        let greatest_y = self.m.select(upper, at_left_upper, greatest_y);
        let not_upper = self.not(upper);
        let only_lower = self.m.and(lower, not_upper);
        let greatest_x = self.m.select(only_lower, x_right, x_lo);
        let [neg_lo, hi] = self.angles([least_y, least_x], [greatest_y, greatest_x]);
        let pi = self.pi_above();
        let (mut neg_lo, mut hi) = (self.m.min(neg_lo, pi), self.m.min(hi, pi));
        let mut smooth = Fact::True;
        if let (Fact::Lanes(cut), Branch::Whole | Branch::Middle) = (cut, branch) {
            neg_lo = self.m.select(cut, pi, neg_lo);
            hi = self.m.select(cut, pi, hi);
            smooth = Fact::Lanes(self.not(cut));
        }
        let (off_x, off_y) = (self.nonzero(a), self.nonzero(b));
        let origin = off_x.nowhere.and(self.m, off_y.nowhere);
        if !matches!(origin, Fact::False) {
            // Lanes where nothing is defined must still have lo ≤ hi.
            let lo = self.m.neg(neg_lo);
            hi = self.m.max(hi, lo);
        }
        let value = self.combine(neg_lo, hi, a, b);
        let throughout = off_x.defined.or(self.m, off_y.defined);
        let mut value = value.restricted(self.m, &Claims::of_domain(origin, throughout));
        value.facts.continuous = value.facts.continuous.and(self.m, smooth);
        value
    }

    /// Bounds as [−lo, hi], from the corners (y, x) with the least and the greatest angle.
    fn angles(&mut self, least: [M::V; 2], greatest: [M::V; 2]) -> [M::V; 2] {
        let at = |approx: &mut Approximator<'_, M>, [y, x]: [M::V; 2]| {
            let near = approx.angle(y, x);
            [approx.negated_lower(&near), approx.upper(&near)]
        };
        at_ends(self.m, self.format, [least, greatest], at, |_, [neg_lo, _], [_, hi]| [neg_lo, hi])
    }

    /// Lanes where the box meets the cut from both sides.
    fn meets_cut(&mut self, a: &Operand<M::V>, b: &Operand<M::V>) -> Fact<M::V> {
        if b.range.lo >= 0.0 || a.range.lo >= 0.0 || a.range.hi < 0.0 {
            return Fact::False;
        }
        let zero = self.zero();
        let below = self.gt(a.value.neg_lo, zero);
        let above = self.m.le(zero, a.value.hi);
        let left = self.gt(b.value.neg_lo, zero);
        let both = self.m.and(below, above);
        Fact::Lanes(self.m.and(both, left))
    }

    /// The least number above π in the format.
    fn pi_above(&mut self) -> M::V {
        let (f32, f64) = (std::f32::consts::PI, std::f64::consts::PI); // above π, below π
        self.number(self.format.pick(f64::from(f32), f64.next_up()))
    }
}
