//! Segments of rays that were asked together, told apart by what is left of them.

use super::super::local_ray::CUT;
use super::narrow::{STALLED, STEADY, UNSTEADY, are_progress};
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::prelude::*;
use zeroset_eval::{Contractions, Lanes, Segments};

/// Lengths of segments that decide what becomes of them, whichever ray they are on.
pub(super) struct Limits<T> {
    /// Of the shortest segments.
    pub grain: T,
    /// Of the shortest that are cut: below it is rounding that keeps them from getting shorter.
    pub coarse: T,
}

/// Segments that are asked together, and what decides about each.
#[derive(Default)]
pub(super) struct Asked<T: Scalar> {
    pub segments: Segments<T>,
    /// The longest bracket of a hit.
    pub longest: Lanes<T>,
}

/// What became of segments: a bit for each lane in use, in one of these.
pub(super) struct Sifted {
    /// Nothing is left.
    pub empty: u16,
    /// What is left is short enough for a bracket, and got so at once, or else is far shorter; its
    /// ends have opposite signs.
    pub short: u16,
    /// It got much shorter.
    pub shorter: u16,
    /// It is cut in two.
    pub cut: u16,
    /// None of these: arithmetic is at its end.
    pub open: u16,
}

impl Sifted {
    /// Leaves open whether there is a zero in a bracket: one of a numerator is none of the
    /// function's.
    pub fn doubt(&mut self) {
        self.open |= std::mem::take(&mut self.short);
    }
}

impl<T: Scalar> Asked<T> {
    /// Tells the segments in these lanes apart by what was asked of them, and puts what is left of
    /// each, or its nearer part, in its place. `inside`: between which values of s each ray is
    /// certainly in the region, if not all are throughout.
    #[inline(always)]
    pub fn sift<S: Simd>(
        &mut self,
        simd: S,
        out: &Contractions<T>,
        inside: Option<&[Lanes<T>; 2]>,
        live: u16,
        limits: &Limits<T>,
    ) -> Sifted {
        let Limits { grain, coarse } = *limits;
        let [stalled, steady, unsteady, share] = [STALLED, STEADY, UNSTEADY, CUT].map(T::nearest);
        let (mut empty, mut short, mut shorter, mut cut) = (0, 0, 0, 0);
        let mut within = if inside.is_some() { 0 } else { u16::MAX };
        let Self { segments, longest } = self;
        for part in parts::<S, T::Vector<S>>(simd, segments.count as usize) {
            let asked = [part.load(&segments.near), part.load(&segments.far)];
            if let Some([firsts, lasts]) = inside {
                let (first, last) = (part.load(firsts), part.load(lasts));
                within |= part.bits(first.simd_le(asked[0]) & asked[1].simd_le(last));
            }
            let (near, far, longest) =
                (part.load(&out.near), part.load(&out.far), part.load(longest));
            let (length, before) = (far - near, asked[1] - asked[0]);
            empty |= part.bits(length.simd_lt(T::default()));
            // Where the form was as good as linear, and where it was not.
            let enough = length.simd_le(longest) & length.simd_le(before * steady);
            short |= part.bits(enough | length.simd_le(longest * unsteady));
            let much = length.simd_le(before * stalled);
            shorter |= part.bits(much & length.simd_gt(grain));
            let between = length.mul_add(share, near);
            let progress = are_progress([near, far], between, before);
            cut |= part.bits(length.simd_gt(coarse) & progress);
            part.store(near, &mut segments.near);
            part.store(much.select(far, between), &mut segments.far);
        }
        let left = out.possible & live & !empty;
        let short = left & short & out.crossing & within;
        let shorter = left & shorter & !short;
        let cut = left & cut & !short & !shorter;
        Sifted { empty: live & !left, short, shorter, cut, open: left & !short & !shorter & !cut }
    }
}
