//! Segments of rays that were evaluated together, classified by their remaining parts.

use super::super::local_ray::CUT;
use super::narrow::{LINEAR_RATIO, NONLINEAR_SHARE, STALL_RATIO, are_progress};
use crate::scalar::Scalar;
use crate::simd_chunks::parts;
use fearless_simd::prelude::*;
use zeroset_eval::{Contractions, Lanes, Segments};

/// Lengths of segments that separate the classes. They are the same for all rays.
#[derive(Clone, Copy)]
pub(super) struct LengthLimits<T> {
    /// Length of the shortest segments.
    pub grain: T,
    /// Length of the shortest segments that are cut. The kernel cannot narrow shorter ones because
    /// of rounding.
    pub coarse: T,
}

/// Segments that are evaluated together, and how short their brackets must be.
#[derive(Default)]
pub(super) struct EvaluatedSegments<T: Scalar> {
    pub segments: Segments<T>,
    /// Maximum length of a hit's bracket.
    pub longest: Lanes<T>,
}

/// Classes of segments. A live lane's bit is set in exactly one of them.
pub(super) struct SegmentClasses {
    /// Nothing is left.
    pub empty: u16,
    /// The rest is a bracket: its ends have opposite signs, and it is short enough. How short
    /// depends on whether the form was nearly linear.
    pub short: u16,
    /// The segment got much shorter.
    pub shorter: u16,
    /// The segment is cut in two.
    pub cut: u16,
    /// None of these: precision does not suffice, so the segment is undecided.
    pub open: u16,
}

impl SegmentClasses {
    /// Makes brackets undecided, since a zero of a numerator need not be a zero of the function.
    pub fn leave_brackets_open(&mut self) {
        self.open |= std::mem::take(&mut self.short);
    }
}

impl<T: Scalar> EvaluatedSegments<T> {
    /// Classifies the segments in the `live` lanes by the kernel's results. Replaces each by its
    /// remaining part, or by the nearer half of that part if it is cut. `inside`: the values of s
    /// between which each ray is certainly in the region; `None` if all segments are.
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
        let [stalled, steady, unsteady, share] =
            [STALL_RATIO, LINEAR_RATIO, NONLINEAR_SHARE, CUT].map(T::nearest);
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
            // The first limit is for forms that were nearly linear, the second for all others.
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
        SegmentClasses {
            empty: live & !left,
            short,
            shorter,
            cut,
            open: left & !short & !shorter & !cut,
        }
    }
}
