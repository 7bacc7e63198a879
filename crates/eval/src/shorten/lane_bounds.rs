//! Bounds in all lanes of a batch, and the thresholds that minima, maxima and blends pass on.

use super::thresholds::LaneSet;
use crate::lanes::{LANES, Lanes};
use crate::real::Real;
use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8};
use zeroset_interval::Interval;

/// Lanes of a vector.
const HALF: usize = LANES / 2;

/// Two bounds in each lane: the lower one, negated, and the upper one.
#[derive(Clone, Copy)]
pub struct LaneBounds(pub [Lanes<f64>; 2]);

impl LaneBounds {
    /// Bounds of no number. The hull with other bounds is those.
    pub const NONE: Self = Self([Lanes([f64::NEG_INFINITY; LANES]); 2]);

    /// The bounds in a lane.
    pub fn of(&self, lane: usize) -> Interval {
        let [neg_lo, hi] = &self.0;
        Interval { lo: -neg_lo[lane], hi: hi[lane] }
    }

    /// Widens the bounds in a lane so that they contain others.
    pub fn widen(&mut self, lane: usize, others: Interval) {
        let [neg_lo, hi] = &mut self.0;
        neg_lo[lane] = neg_lo[lane].max(-others.lo);
        hi[lane] = hi[lane].max(others.hi);
    }

    /// Widens the bounds in the lanes of a set so that they contain others.
    #[inline(always)]
    pub fn widen_all<S: Simd>(&mut self, simd: S, set: LaneSet, others: &Self) {
        let none = f64x8::splat(simd, f64::NEG_INFINITY);
        for (own, others) in self.0.iter_mut().zip(&others.0) {
            let halves = own.chunks_exact_mut(HALF).zip(others.chunks_exact(HALF));
            for (half, (own, others)) in halves.enumerate() {
                let bits = u64::from(set >> (HALF * half) & 0xff);
                let set = mask64x8::from_bitmask(simd, bits);
                let others = set.select(f64x8::from_slice(simd, others), none);
                f64x8::from_slice(simd, own).max(others).store_slice(own);
            }
        }
    }
}

/// Bounds of an operand's value in one lane.
#[derive(Clone, Copy)]
pub struct Known {
    pub values: Interval,
    /// True if the value is defined throughout.
    pub is_defined: bool,
}

impl Known {
    /// Whether the operand has a value throughout, which is nowhere 0.
    pub fn is_apart(&self) -> bool {
        self.is_defined && !self.values.contains(0.0)
    }
}

/// Bounds of an operand's value in all lanes, and the lanes in which it is defined throughout.
#[derive(Clone, Copy)]
pub enum KnownLanes<'a, T: Real> {
    /// Those that an evaluation found: −lo, hi, and a mask of all bits or none.
    Found(&'a super::StepBounds<T>),
    /// Those of a constant, which is defined.
    Constant(Interval),
    /// Nothing is known.
    Nothing,
}

impl<T: Real> KnownLanes<'_, T> {
    /// The bounds in a lane.
    pub fn of(&self, lane: usize) -> Known {
        let (values, is_defined) = match self {
            Self::Found(bounds) => (bounds.values(lane), bounds.is_defined(lane)),
            Self::Constant(bounds) => (*bounds, true),
            Self::Nothing => (Interval::ENTIRE, false),
        };
        Known { values, is_defined }
    }

    /// Half of the lanes: −lo, hi, and the set of those in which it is defined.
    #[inline(always)]
    fn half<S: Simd>(&self, simd: S, half: usize) -> ([f64x8<S>; 2], LaneSet) {
        match self {
            Self::Found(super::StepBounds { neg_lo, hi, defined }) => {
                let wide = |lanes: &Lanes<T>| {
                    let wide: [f64; HALF] =
                        std::array::from_fn(|lane| lanes[HALF * half + lane].into());
                    f64x8::from_slice(simd, &wide)
                };
                // A mask with all bits is no number.
                let not = wide(defined).simd_eq(f64x8::splat(simd, 0.0)).to_bitmask();
                ([wide(neg_lo), wide(hi)], !not as LaneSet & 0xff)
            }
            Self::Constant(Interval { lo, hi }) => {
                ([-lo, *hi].map(|end| f64x8::splat(simd, end)), 0xff)
            }
            Self::Nothing => ([f64x8::splat(simd, f64::INFINITY); 2], 0),
        }
    }
}

/// A minimum, a maximum or a blend of two operands.
#[derive(Clone, Copy)]
pub struct Joint {
    pub is_max: bool,
    /// True if the step computes the negative.
    pub is_negated: bool,
    /// An upper bound of the width k of a blend.
    pub width: Option<f64>,
}

/// The thresholds that a joint passes on.
pub struct Passed {
    /// The thresholds of an operand that replaces the joint.
    pub own: LaneBounds,
    /// The thresholds of both operands where both are needed.
    pub each: LaneBounds,
    /// The lanes in which each operand is beyond the thresholds, so that the other replaces the
    /// joint.
    pub beyond: [LaneSet; 2],
}

/// An upper bound of a sum, if its summands are bounds and not negative infinity and infinity.
#[inline(always)]
fn sum_above<S: Simd>(simd: S, a: f64x8<S>, b: f64) -> f64x8<S> {
    let sum = a + b;
    // The error of a sum is at most half of this. Infinity stays.
    sum + sum.abs().min(f64x8::splat(simd, f64::MAX)) * f64::EPSILON
}

impl Joint {
    /// Finds the thresholds that the joint passes on. `docs/parts.md` has the proofs.
    #[inline(always)]
    pub fn pass_on<S: Simd, T: Real>(
        &self,
        simd: S,
        thresholds: &LaneBounds,
        operands: [KnownLanes<'_, T>; 2],
    ) -> Passed {
        // The maximum is the negative of the minimum of the negatives. So its bounds change places.
        let [neg_lo, hi] = if self.is_max { [1, 0] } else { [0, 1] };
        let [from_lo, from_hi] = if self.is_negated { [hi, neg_lo] } else { [neg_lo, hi] };
        let mut passed = Passed { own: LaneBounds::NONE, each: LaneBounds::NONE, beyond: [0; 2] };
        for half in 0..2 {
            let lanes = HALF * half..HALF * (half + 1);
            let [(a, a_defined), (b, b_defined)] =
                [operands[0].half(simd, half), operands[1].half(simd, half)];
            let given = |end: usize| f64x8::from_slice(simd, &thresholds.0[end][lanes.clone()]);
            // Thresholds are clamped to bounds of the minimum. A blend may be lower, but not its
            // operands.
            let lowest = a[neg_lo].max(b[neg_lo]);
            let highest = a[hi].min(b[hi]);
            let own_hi = given(from_hi).min(highest).max(-given(from_lo));
            let own_neg_lo = given(from_lo).min(lowest).max(-own_hi);
            let each_hi = self.width.map_or(own_hi, |width| sum_above(simd, own_hi, width));
            let store = |to: &mut LaneBounds, ends: [f64x8<S>; 2]| {
                ends[0].store_slice(&mut to.0[neg_lo][lanes.clone()]);
                ends[1].store_slice(&mut to.0[hi][lanes.clone()]);
            };
            store(&mut passed.own, [own_neg_lo, own_hi]);
            store(&mut passed.each, [own_neg_lo, each_hi]);
            // A dropped operand must not be where the result has no value.
            for (beyond, (known, defined)) in
                passed.beyond.iter_mut().zip([(a, a_defined), (b, b_defined)])
            {
                let above = (-known[neg_lo]).simd_gt(each_hi).to_bitmask() as LaneSet;
                *beyond |= (above & defined) << (HALF * half);
            }
        }
        passed
    }
}
