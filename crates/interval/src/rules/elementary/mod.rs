//! Rules of elementary functions. This file has the rules of sine, cosine and tangent. They use the
//! routines in [`trigonometric`], or those in [`near`] for operands near 0. [`monotone`] has the
//! rules of monotone functions, [`atan2`] that of the angle of a point.

pub(crate) mod approximator;
mod arc;
mod atan2;
pub(crate) mod bessel;
mod centred;
pub(crate) mod double_double;
mod erf;
mod exponential;
mod hyperbolic;
pub(crate) mod logarithm;
mod monotone;
pub(crate) mod near;
#[cfg(test)]
mod recorded;
pub(crate) mod trigonometric;

use super::Rule;
use crate::bounds::Interval;
use crate::enclosure::{Claims, Enclosure, Fact, Operand};
use crate::machine::{Format, Machine};
use approximator::{Approximator, at_ends, by_halves};
use double_double::Approximation;
use trigonometric::{HalfPi, WAVE_ERROR_F32};

impl<M: Machine> Rule<'_, M> {
    pub(super) fn sin(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        if self.is_near(a.range) {
            return self.near_waves(a)[0];
        }
        // Sine is 1 at π/2 + 2πj and −1 at −π/2 + 2πj, for integers j.
        self.wave(a, |approx, x, half_pi| approx.sin(x, half_pi), 0.25, -0.25)
    }

    pub(super) fn cos(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        if self.is_near(a.range) {
            return self.near_waves(a)[1];
        }
        self.wave(a, |approx, x, half_pi| approx.cos(x, half_pi), 0.0, 0.5)
    }

    /// Encloses sine or cosine. `f` approximates the function and counts quarter turns. The
    /// function is 1 at the angle `peak` and −1 at `trough`, in turns.
    fn wave(
        &mut self,
        a: &Operand<M::V>,
        f: impl Fn(&mut Approximator<'_, M>, M::V, &HalfPi) -> (Approximation<M::V>, M::V),
        peak: f64,
        trough: f64,
    ) -> Enclosure<M::V> {
        let half_pi = HalfPi::for_angles(a.range);
        let f = |approx: &mut Approximator<'_, M>, x| f(approx, x, half_pi);
        let one = self.number(1.0);
        let [neg_lo, hi, first, last] = self.values_and_turns(a, f, false, 0.25);
        let mut neg_lo = self.m.min(neg_lo, one);
        let mut hi = self.m.min(hi, one);
        let has_peak = self.has_turn([first, last], peak);
        let has_trough = self.has_turn([first, last], trough);
        hi = self.m.select(has_peak, one, hi);
        neg_lo = self.m.select(has_trough, one, neg_lo);
        if let Some(near) = self.within_limit(a, half_pi) {
            neg_lo = self.m.select(near, neg_lo, one);
            hi = self.m.select(near, hi, one);
        }
        Enclosure { neg_lo, hi, ..a.value }
    }

    /// Encloses sine and cosine at a single number, however large. Both are returned as [−lo, hi].
    pub(super) fn waves_of_point(&mut self, a: &Operand<M::V>) -> [[M::V; 2]; 2] {
        let half_pi = HalfPi::for_angles(a.range);
        let bounds = by_halves(self.m, self.format, [a.value.hi], |approx, [x]| {
            let [sin, cos] = approx.waves(x, half_pi);
            let [above, beyond] = [&sin, &cos].map(|wave| approx.upper(wave));
            let [below, beneath] = [&sin, &cos].map(|wave| approx.negated_lower(wave));
            [below, above, beneath, beyond]
        });
        let one = self.number(1.0);
        let near = self.within_limit(a, half_pi);
        let [below, above, beneath, beyond] = bounds.map(|bound| {
            let bound = self.m.min(bound, one);
            near.map_or(bound, |near| self.m.select(near, bound, one))
        });
        [[below, above], [beneath, beyond]]
    }

    pub(super) fn tan(&mut self, a: &Operand<M::V>) -> Enclosure<M::V> {
        let half_pi = HalfPi::for_angles(a.range);
        let tan = |approx: &mut Approximator<'_, M>, x| approx.tan(x, half_pi);
        let [neg_lo, hi, first, last] = self.values_and_turns(a, tan, true, 0.5);
        // Counted in half turns, the poles are at half integers.
        let pole = self.has_turn([first, last], 0.5);
        let mut free = self.not(pole);
        if let Some(near) = self.within_limit(a, half_pi) {
            free = self.m.and(free, near);
        }
        let infinity = self.infinity();
        let neg_lo = self.m.select(free, neg_lo, infinity);
        let hi = self.m.select(free, hi, infinity);
        let own = Claims::of_domain(Fact::False, Fact::Lanes(free));
        a.value.facts.and(self.m, &own).with([neg_lo, hi])
    }

    /// Evaluates a function at both ends of its operand. Returns −lo and hi of the values there,
    /// and −lo and hi of the angle as returned by [`turns`]. If the function `rises`, the value at
    /// the lower end is the least.
    fn values_and_turns(
        &mut self,
        a: &Operand<M::V>,
        f: impl Fn(&mut Approximator<'_, M>, M::V) -> (Approximation<M::V>, M::V),
        rises: bool,
        scale: f64,
    ) -> [M::V; 4] {
        let ends = [[self.m.neg(a.value.neg_lo)], [a.value.hi]];
        match self.format {
            Format::F32 => {
                let head = |approx: &mut Approximator<'_, M>, [x]: [M::V; 1]| {
                    let (near, quarters) = f(approx, x);
                    [near.sum.head, quarters]
                };
                at_ends(self.m, self.format, ends, head, |approx, [lo, first], [hi, last]| {
                    let values =
                        if rises { [lo, hi] } else { [approx.m.min(lo, hi), approx.m.max(lo, hi)] };
                    let [first, last] = turns(approx.m, first, last, scale);
                    let [least, most] =
                        values.map(|x| Approximation::new(x.into(), WAVE_ERROR_F32));
                    [approx.negated_lower(&least), approx.upper(&most), first, last]
                })
            }
            Format::F64 => {
                let [lo, hi] = self.m.repeat(ends, |m, [x]| {
                    let mut approx = Approximator { m, target: Format::F64 };
                    let (near, quarters) = f(&mut approx, x);
                    [approx.negated_lower(&near), approx.upper(&near), quarters]
                });
                let [neg_lo, most] = if rises {
                    [lo[0], hi[1]]
                } else {
                    [self.m.max(lo[0], hi[0]), self.m.max(lo[1], hi[1])]
                };
                let [first, last] = turns(self.m, lo[2], hi[2], scale);
                [neg_lo, most, first, last]
            }
        }
    }

    /// Lanes where the angles contain j + `offset` for some integer j. The angles are given as
    /// [−lo, hi] by [`turns`].
    fn has_turn(&mut self, [neg_lo, hi]: [M::V; 2], offset: f64) -> M::V {
        // Tests floor(hi − offset) ≥ ceil(lo − offset). Both differences are multiples of 1/8 below
        // 2^21, which are exact in `f32`.
        let (offset, zero) = (self.number(offset), self.zero());
        let last = self.m.sub(hi, offset);
        let last = self.m.floor(last);
        let neg_first = self.m.add(neg_lo, offset);
        let neg_first = self.m.floor(neg_first);
        let count = self.m.add(last, neg_first);
        self.m.le(zero, count)
    }

    /// Lanes where both ends are within the limit of angle reduction. `None` stands for all lanes.
    fn within_limit(&mut self, a: &Operand<M::V>, half_pi: &HalfPi) -> Option<M::V> {
        let limit = half_pi.limit(self.format);
        if (Interval { lo: -limit, hi: limit }).encloses(a.range) {
            return None;
        }
        let far = self.m.max(a.value.neg_lo, a.value.hi);
        let limit = self.number(limit);
        Some(self.m.le(far, limit))
    }
}

/// Multiplies the counts of quarter turns at both ends by `scale`, and returns them as [−lo, hi].
///
/// Each count is an integer ± ½, on the side of the integer where the angle is. The side can be
/// wrong only if the angle is closer to a multiple of a quarter turn than the error of its
/// reduction. Then sine and cosine are ±1 within their own error. No float is as close to a pole of
/// the tangent.
fn turns<M: Machine>(m: &mut M, lo: M::V, hi: M::V, scale: f64) -> [M::V; 2] {
    let minus = m.number(Format::F64, -scale);
    let plus = m.number(Format::F64, scale);
    [m.mul(lo, minus), m.mul(hi, plus)]
}
