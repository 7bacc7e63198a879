//! Classes of ray segments, by the parts that their evaluation leaves of them.

use super::super::local_ray::CUT;
use super::narrow::{EVEN_RATIO, LINEAR_RATIO, NONLINEAR_SHARE, STALL_RATIO, are_progress};
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::prelude::*;
use zeroset_eval::{Contractions, Lanes, Segments};

/// Lengths of segments that separate the classes, for all rays.
#[derive(Clone, Copy)]
pub(super) struct LengthLimits<T> {
    /// A shorter segment is not evaluated again.
    pub grain: T,
    /// A shorter segment is not cut, since rounding keeps the kernel from narrowing it.
    pub coarse: T,
}

/// Segments that are evaluated together, with the allowed lengths of their brackets.
#[derive(Default)]
pub(super) struct EvaluatedSegments<T: Scalar> {
    pub segments: Segments<T>,
    /// Maximum length of a hit's bracket.
    pub longest: Lanes<T>,
}

/// Classes of segments. Each is a set of lanes, as bits. A live lane is in exactly one class.
pub(super) struct SegmentClasses {
    /// Nothing of the segment is left.
    pub empty: u16,
    /// The remaining part is a bracket: its ends have opposite signs, and it is short enough. If
    /// the form was not nearly linear, it must be shorter still.
    pub short: u16,
    /// Those brackets in which the gradient's direction may change.
    pub uneven: u16,
    /// The remaining part is much shorter than the segment.
    pub shorter: u16,
    /// The remaining part is cut in two.
    pub cut: u16,
    /// The segment is undecided: for lack of precision, none of the above holds.
    pub open: u16,
}

impl SegmentClasses {
    /// Makes brackets undecided, for a rational form: a zero of its numerator need not be a zero of
    /// the function.
    pub fn leave_brackets_open(&mut self) {
        self.open |= std::mem::take(&mut self.short);
    }
}

impl<T: Scalar> EvaluatedSegments<T> {
    /// Classifies the segments in the `live` lanes by the kernel's results. Replaces each segment
    /// by its remaining part. If that part is cut, replaces it by the nearer half. `inside` has,
    /// for each ray, the range of s in which the ray is proven to lie in the region; `None` if all
    /// segments are proven to lie there.
    #[inline(always)]
    pub fn classify<S: Simd>(
        &mut self,
        simd: S,
        out: &Contractions<T>,
        inside: Option<&[Lanes<T>; 2]>,
        live: u16,
        limits: &LengthLimits<T>,
    ) -> SegmentClasses {
        let LengthLimits { grain, coarse } = *limits;
        let [stalled, steady, even, unsteady, share] =
            [STALL_RATIO, LINEAR_RATIO, EVEN_RATIO, NONLINEAR_SHARE, CUT].map(T::nearest);
        let (mut empty, mut short, mut shorter, mut cut, mut uneven) = (0, 0, 0, 0, 0);
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
            // The first limit is for forms that were nearly linear. The second is for all forms.
            let enough = length.simd_le(longest) & length.simd_le(before * steady);
            short |= part.bits(enough | length.simd_le(longest * unsteady));
            uneven |= part.bits(length.simd_gt(before * even));
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
        SegmentClasses {
            empty: live & !left,
            short,
            uneven: short & uneven,
            shorter,
            cut,
            open: left & !short & !shorter & !cut,
        }
    }
}
