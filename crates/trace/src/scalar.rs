//! The float types in which rays and slabs are followed, and vectors of these types.
//!
//! All operations here round to nearest. Callers add the rounding error as slack.

use crate::simd_chunks::parts;
use fearless_simd::{SimdFloatElement, f32x16, f64x8, mask32x16, mask64x8, prelude::*};
use std::ops::{Add, Mul};
use zeroset_eval::{KernelFloat, LANES, Lanes};
use zeroset_interval::PATH_UNITS;

/// Number of lanes of an `f64` vector: half a batch.
pub(crate) const HALF: usize = LANES / 2;

/// A float type in which a tracer follows rays. It is the type of the tracer's kernels.
pub trait Scalar: KernelFloat + SimdFloatElement + Add<Output = Self> + Mul<Output = Self> {
    /// A vector of this type that fills a register.
    type Vector<S: Simd>: SimdFloat<S, Element = Self>;

    /// Largest depth of a traversal in slabs. Slabs of 2⁻²⁰ of the region are near the resolution
    /// of `f32`. In `f64`, slabs of 2⁻⁴⁰ are still hundreds of times thicker than the rounding of a
    /// coordinate.
    const MAX_DEPTH: u32;
    /// Relative error of a coordinate `start` + τ·`extent`. Five steps round: `start`, `extent`,
    /// the product, the sum, and a last addend. In `f32` each rounds by 2⁻²⁴; everything before is
    /// in `f64`. In `f64` each rounds by 2⁻⁵³; `extent` takes three more roundings, and the end of
    /// the region one. The bounds, 8·2⁻²⁴ and 16·2⁻⁵³, are nearly twice these sums.
    const COORDINATE_ERROR: Self;
    /// Amount by which the ends of a range of τ are moved outward. It exceeds the error of a
    /// quotient within [−1, 2]. That error is at most 4·2⁻²⁴ in `f32`. In `f64` it is at most
    /// 10·2⁻⁵³, since the operands are rounded too.
    const SHARE_ERROR: Self;
    /// Length of the shortest segments that are searched, as a share of the ray's length. It is a
    /// little more than the length that rounding adds.
    const GRAIN: f64;
    /// Rounding error of coordinates in kernels, as a share of the sum of their terms' magnitudes.
    const PATH_ERROR: f64 = PATH_UNITS * Self::UNIT;

    /// The float of an integer. It is exact below 2^[`Scalar::MAX_DEPTH`].
    #[inline]
    fn integer(value: u64) -> Self {
        Self::nearest(value as i64 as f64)
    }
    /// 2^−`n`, for `n` up to [`Scalar::MAX_DEPTH`].
    #[inline]
    fn halved(n: u32) -> Self {
        Self::nearest(f64::from_bits((1023 - u64::from(n)) << 52))
    }
    /// The numbers of all lanes, as two `f64` vectors.
    fn wide<S: Simd>(simd: S, lanes: &Lanes<Self>) -> [f64x8<S>; 2];
    /// Stores two vectors in lanes, rounded to nearest.
    fn narrow<S: Simd>(numbers: [f64x8<S>; 2], lanes: &mut Lanes<Self>);
    /// Moves the lanes whose bits are set in `kept` to the front, in order.
    fn pack<S: Simd>(simd: S, lanes: &mut Lanes<Self>, kept: u16);
    /// Copies lanes of `some` to lanes of `others`, in order. `from` and `to` have a bit for each
    /// of these lanes, and equally many bits.
    fn copy<S: Simd>(simd: S, some: &Lanes<Self>, from: u16, others: &mut Lanes<Self>, to: u16);
    /// Writes `number` to the lanes whose bits are set in `to`.
    #[inline(always)]
    fn set<S: Simd>(simd: S, number: Self, lanes: &mut Lanes<Self>, to: u16) {
        for part in parts::<S, Self::Vector<S>>(simd, LANES) {
            let old = part.load(lanes);
            part.store(part.mask(to).select(part.splat(number), old), lanes);
        }
    }
}

impl Scalar for f32 {
    type Vector<S: Simd> = S::f32s;
    const MAX_DEPTH: u32 = 20;
    const COORDINATE_ERROR: Self = 1.0 / 2_097_152.0; // 2^-21
    const SHARE_ERROR: Self = 1.0 / 1_048_576.0; // 2^-20
    const GRAIN: f64 = 1.0 / 262_144.0; // 2^-18

    // `integer` and `halved` are evaluated for every slab, so they do not convert by way of `f64`.
    #[inline]
    fn integer(value: u64) -> Self {
        value as i64 as Self
    }
    #[inline]
    fn halved(n: u32) -> Self {
        Self::from_bits((127 - n) << 23)
    }
    #[inline(always)]
    fn wide<S: Simd>(simd: S, lanes: &Lanes<Self>) -> [f64x8<S>; 2] {
        let (low, high) = f32x16::from_slice(simd, &lanes[..]).widen();
        [low, high]
    }
    #[inline(always)]
    fn narrow<S: Simd>([low, high]: [f64x8<S>; 2], lanes: &mut Lanes<Self>) {
        low.narrow(high).store_slice(&mut lanes[..]);
    }
    #[inline(always)]
    fn pack<S: Simd>(simd: S, lanes: &mut Lanes<Self>, kept: u16) {
        let kept = mask32x16::from_bitmask(simd, u64::from(kept));
        f32x16::from_slice(simd, &lanes[..]).compress(kept).store_slice(&mut lanes[..]);
    }
    #[inline(always)]
    fn copy<S: Simd>(simd: S, some: &Lanes<Self>, from: u16, others: &mut Lanes<Self>, to: u16) {
        let [from, to] = [from, to].map(u64::from);
        let [from, to] = [mask32x16::from_bitmask(simd, from), mask32x16::from_bitmask(simd, to)];
        let first = f32x16::from_slice(simd, &some[..]).compress(from);
        let all = first.expand_merge(to, f32x16::from_slice(simd, &others[..]));
        all.store_slice(&mut others[..]);
    }
}

impl Scalar for f64 {
    type Vector<S: Simd> = S::f64s;
    const MAX_DEPTH: u32 = 40;
    const COORDINATE_ERROR: Self = 8.0 * Self::EPSILON; // 2^-49
    const SHARE_ERROR: Self = 8.0 * Self::EPSILON;
    const GRAIN: f64 = 1024.0 * Self::EPSILON; // 2^-42

    #[inline(always)]
    fn wide<S: Simd>(simd: S, lanes: &Lanes<Self>) -> [f64x8<S>; 2] {
        [f64x8::from_slice(simd, &lanes[..8]), f64x8::from_slice(simd, &lanes[8..])]
    }
    #[inline(always)]
    fn narrow<S: Simd>([low, high]: [f64x8<S>; 2], lanes: &mut Lanes<Self>) {
        low.store_slice(&mut lanes[..8]);
        high.store_slice(&mut lanes[8..]);
    }
    #[inline(always)]
    fn pack<S: Simd>(simd: S, lanes: &mut Lanes<Self>, kept: u16) {
        let [low, high] = [kept & 0xff, kept >> 8];
        let bits = |half: u16| mask64x8::from_bitmask(simd, u64::from(half));
        let first = f64x8::from_slice(simd, &lanes[..8]).compress(bits(low));
        let second = f64x8::from_slice(simd, &lanes[8..]).compress(bits(high));
        first.store_slice(&mut lanes[..8]);
        let after = low.count_ones() as usize;
        second.store_slice(&mut lanes[after..after + 8]);
    }
    #[inline(always)]
    fn copy<S: Simd>(simd: S, some: &Lanes<Self>, from: u16, others: &mut Lanes<Self>, to: u16) {
        let mut first = *some;
        Self::pack(simd, &mut first, from);
        let mut packed = [0.0; LANES + HALF];
        packed[..LANES].copy_from_slice(&first[..]);
        let mut next = 0;
        for (half, bits) in [to & 0xff, to >> HALF].into_iter().enumerate() {
            let others = &mut others[HALF * half..HALF * (half + 1)];
            let values = f64x8::from_slice(simd, &packed[next..next + HALF]);
            let set = mask64x8::from_bitmask(simd, u64::from(bits));
            values.expand_merge(set, f64x8::from_slice(simd, others)).store_slice(others);
            next += bits.count_ones() as usize;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact() {
        for n in 0..=f32::MAX_DEPTH {
            assert_eq!(f32::halved(n), 0.5_f32.powi(n as i32));
        }
        for n in 0..=f64::MAX_DEPTH {
            assert_eq!(f64::halved(n), 0.5_f64.powi(n as i32));
        }
    }
}
