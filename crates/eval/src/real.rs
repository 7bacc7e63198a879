//! The two float types with which kernels compute.

use crate::lanes::Lanes;
use std::fmt::Debug;
use std::ops::Neg;
use zeroset_interval::{Format, Interval, Vector128 as Vector, round::f32_up};

/// A float type with which kernels compute: `f32` or `f64`.
pub trait Real:
    sealed::Sealed
    + Copy
    + Debug
    + Default
    + PartialOrd
    + Neg<Output = Self>
    + Into<f64>
    + Send
    + Sync
    + 'static
{
    /// Format of a lane on a machine.
    const FORMAT: Format;
    /// Number of lanes in a vector of the [software machine](zeroset_interval::Software).
    const VECTOR_LANES: usize;
    /// Largest finite number.
    const LARGEST: Self;

    /// Least positive normal number.
    const LEAST_NORMAL: Self;
    /// Largest error of a sum that is rounded up, relative to the sum.
    const UNIT: f64;

    /// Returns `value` rounded to nearest.
    fn nearest(value: f64) -> Self;
    /// Returns `value` rounded up.
    fn above(value: f64) -> Self;
    /// Returns whether all numbers in `range` are finite numbers of this type, once rounded.
    fn is_finite(range: Interval) -> bool {
        let largest = Self::LARGEST.into();
        -largest <= range.lo && range.hi <= largest
    }
    /// Loads one vector of `lanes`; `index` counts vectors.
    fn load(lanes: &Lanes<Self>, index: usize) -> Vector;
    /// Stores `vector` in `lanes`; `index` counts vectors.
    fn store(vector: Vector, index: usize, lanes: &mut Lanes<Self>);
    /// Returns one bit per lane, the lowest for the first lane. A bit is set if the mask is set in
    /// its lane.
    fn bits(mask: Vector) -> u32;
}

impl Real for f32 {
    const FORMAT: Format = Format::F32;
    const VECTOR_LANES: usize = 4;
    const LARGEST: Self = Self::MAX;
    const LEAST_NORMAL: Self = Self::MIN_POSITIVE;
    const UNIT: f64 = Self::EPSILON as f64;

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn above(value: f64) -> Self {
        f32_up::from_f64(value)
    }
    fn load(lanes: &Lanes<Self>, index: usize) -> Vector {
        Vector::from_f32(vector(lanes, index))
    }
    fn store(vector: Vector, index: usize, lanes: &mut Lanes<Self>) {
        lanes[4 * index..4 * index + 4].copy_from_slice(&vector.f32());
    }
    fn bits(mask: Vector) -> u32 {
        gather(mask.bits_32().map(|lane| lane != 0))
    }
}

impl Real for f64 {
    const FORMAT: Format = Format::F64;
    const VECTOR_LANES: usize = 2;
    const LARGEST: Self = Self::MAX;
    const LEAST_NORMAL: Self = Self::MIN_POSITIVE;
    const UNIT: f64 = Self::EPSILON;

    #[inline(always)]
    fn nearest(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn above(value: f64) -> Self {
        value
    }
    fn load(lanes: &Lanes<Self>, index: usize) -> Vector {
        Vector::from_f64(vector(lanes, index))
    }
    fn store(vector: Vector, index: usize, lanes: &mut Lanes<Self>) {
        lanes[2 * index..2 * index + 2].copy_from_slice(&vector.f64());
    }
    fn bits(mask: Vector) -> u32 {
        gather(mask.bits_64().map(|lane| lane != 0))
    }
}

fn vector<T: Copy, const N: usize>(lanes: &Lanes<T>, index: usize) -> [T; N] {
    std::array::from_fn(|lane| lanes[N * index + lane])
}

fn gather<const N: usize>(set: [bool; N]) -> u32 {
    (0..N).map(|lane| u32::from(set[lane]) << lane).sum()
}

/// Rounds bounds outward to ends in `T`.
pub(crate) fn outward<T: Real>(bounds: Interval) -> Interval {
    Interval { lo: -T::above(-bounds.lo).into(), hi: T::above(bounds.hi).into() }
}

/// Returns a number of `T` within `bounds`, near their middle. It is 0 if both bounds are infinite.
pub(crate) fn middle<T: Real>(bounds: Interval) -> f64 {
    // Some constants have infinite bounds, such as 0 times a number beyond all floats.
    let middle = if bounds == Interval::ENTIRE { 0.0 } else { 0.5 * bounds.lo + 0.5 * bounds.hi };
    let most = T::LARGEST.into();
    let nearest: f64 = T::nearest(middle.clamp(-most, most)).into();
    nearest.clamp(bounds.lo, bounds.hi)
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;

    #[test]
    fn vectors_hold_neighbouring_lanes() {
        fn check<T: Real>() {
            let given = Lanes(std::array::from_fn(|lane| T::nearest(lane as f64)));
            let mut copied = Lanes::splat(T::default());
            for index in 0..LANES / T::VECTOR_LANES {
                T::store(T::load(&given, index), index, &mut copied);
            }
            assert_eq!(copied, given);
        }
        check::<f32>();
        check::<f64>();
    }

    #[test]
    fn masks_have_their_first_lane_lowest() {
        assert_eq!(f32::bits(Vector::F32([0, !0, 0, !0])), 0b1010);
        assert_eq!(f64::bits(Vector::F64([!0, 0])), 0b01);
    }

    #[test]
    fn middles_are_numbers() {
        let middle_of = |lo, hi| middle::<f32>(outward::<f32>(Interval { lo, hi }));
        assert_eq!(middle_of(1.0, 2.0), 1.5);
        assert_eq!(middle_of(f64::NEG_INFINITY, f64::INFINITY), 0.0);
        assert_eq!(middle_of(f64::MAX, f64::INFINITY), f64::from(f32::MAX));
        assert_eq!(middle_of(f64::NEG_INFINITY, -1e300), -f64::from(f32::MAX));
    }
}
