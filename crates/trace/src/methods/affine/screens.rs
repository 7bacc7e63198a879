//! Screen coordinates of up to sixteen tiles or rays, and the parts left of their segments.

use crate::scalar::{HALF, Scalar};
use fearless_simd::{f64x4, f64x8, prelude::*};
use zeroset_eval::{LANES, Lanes};

/// Screen coordinates of rays, or of the centers of tiles. For tiles, also their half extents.
pub(super) type ScreenRays<'a, T> = (&'a [Lanes<T>; 2], Option<&'a [Lanes<T>; 2]>);

/// Returns the screen coordinates of 4×4 places, row by row. `across` has the coordinates of the
/// columns, and `upward` has the coordinates of the rows.
#[inline(always)]
pub(super) fn spread<S: Simd>(simd: S, across: [f64; 4], upward: [f64; 4]) -> [[f64x8<S>; 2]; 2] {
    let across = f64x4::simd_from(simd, across);
    let across = across.combine(across);
    let row = |k: usize| f64x4::splat(simd, upward[k]);
    [[across; 2], [row(0).combine(row(1)), row(2).combine(row(3))]]
}

/// Segments that still have to be examined. The nearest is last.
pub(super) type PendingSegments<T = f64> = Vec<[T; 2]>;

/// The index of each lane, which is the order of lanes before any has moved.
pub(super) const LANE_INDICES: [u8; LANES] = {
    let mut things = [0; LANES];
    let mut lane = 1;
    while lane < LANES {
        things[lane] = lane as u8;
        lane += 1;
    }
    things
};

/// Returns whether the live lanes would fill fewer vectors of `T` if they were moved to the front.
/// Kernels use vectors as wide as those of `S`.
#[inline(always)]
pub(super) fn saves_a_vector<T, S: Simd>(live: u16) -> bool {
    let lanes = (S::f32s::LEN * size_of::<f32>() / size_of::<T>()) as u32;
    // Usually all live lanes are in the first vector, and nothing has to be counted.
    lanes < LANES as u32
        && live >> lanes != 0
        && live.count_ones().div_ceil(lanes) < (LANES as u32 - live.leading_zeros()).div_ceil(lanes)
}

/// Returns the live lanes after a move to the front. At least one lane must not be live.
#[inline]
pub(super) fn packed(live: u16) -> u16 {
    (1 << live.count_ones()) - 1
}

/// The parts left of segments, one per lane: near ends, then far ends.
pub(super) type Ends = [Lanes<f64>; 2];

/// Writes the parts left of segments as floats of `T`. `asked` has the segments' ends, which are
/// floats of `T`. An end of a part that differs from the segment's end is rounded outward. All
/// segments end within `size` of 0. Returns the lanes with a non-empty part, as bits.
#[inline(always)]
pub(super) fn outward<S: Simd, T: Scalar>(
    simd: S,
    asked: &Ends,
    left: &Ends,
    size: f64,
    [near, far]: [&mut Lanes<T>; 2],
) -> u16 {
    let [start, end] = [f64::wide(simd, &asked[0]), f64::wide(simd, &asked[1])];
    let [mut first, mut last] = [f64::wide(simd, &left[0]), f64::wide(simd, &left[1])];
    let mut any = 0;
    for k in 0..2 {
        any |= (first[k].simd_le(last[k]).to_bitmask() as u16) << (HALF * k);
        let room = T::PATH_ERROR * (first[k].abs() + size);
        first[k] = first[k].simd_eq(start[k]).select(first[k], first[k] - room);
        let room = T::PATH_ERROR * (last[k].abs() + size);
        last[k] = last[k].simd_eq(end[k]).select(last[k], last[k] + room);
    }
    T::narrow(first, near);
    T::narrow(last, far);
    any
}

/// Converts segments to `f64`.
#[inline(always)]
pub(super) fn ends<S: Simd, T: Scalar>(simd: S, near: &Lanes<T>, far: &Lanes<T>) -> Ends {
    let mut ends = [Lanes::splat(0.0); 2];
    f64::narrow(T::wide(simd, near), &mut ends[0]);
    f64::narrow(T::wide(simd, far), &mut ends[1]);
    ends
}
