//! The two float types in which kernels compute.

use crate::packet::{LANES, Lanes};
use std::fmt::Debug;
use std::ops::{BitOrAssign, Neg};
use zeroset_interval::{Facts, Format, Vector128 as Vector, round::f32_up};

/// A float type in which kernels compute: `f32` or `f64`.
///
/// A packet has four lanes in either; in 128-bit vectors, a quantity of a packet fills one vector of `f32` or two of
/// `f64`.
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
    /// The type of the lanes.
    const FORMAT: Format;
    /// Vectors that a quantity of a packet fills.
    const VECTORS: usize;
    /// The largest finite number.
    const LARGEST: Self;

    /// The unsigned integer of the same size: how a lane stores [`Facts`].
    type Word: Copy
        + Debug
        + Default
        + PartialEq
        + BitOrAssign
        + From<u32>
        + Into<u64>
        + Send
        + Sync;

    /// `value` rounded to nearest.
    fn nearest(value: f64) -> Self;
    /// `value` rounded up.
    fn above(value: f64) -> Self;
    /// The bits of a vector that holds this number in all lanes.
    fn splat(self) -> u128;
    /// The bits of a vector that holds these facts in all lanes.
    fn splat_facts(facts: Facts) -> u128;
    /// The vector with this index, of those that `lanes` fill.
    fn load(lanes: &Lanes<Self>, index: usize) -> Vector;
    /// Writes the vector with this index, of those that `lanes` fill.
    fn store(vector: Vector, index: usize, lanes: &mut Lanes<Self>);
    /// The lanes in which a mask is set; false for those that a vector does not have.
    fn is_set(mask: Vector) -> [bool; LANES];

    /// The facts that a lane stores.
    fn facts(word: Self::Word) -> Facts {
        Facts::from_bits(word.into() as u32)
    }
}

impl Real for f32 {
    const FORMAT: Format = Format::F32;
    const VECTORS: usize = 1;
    const LARGEST: Self = Self::MAX;
    type Word = u32;

    fn nearest(value: f64) -> Self {
        value as Self
    }
    fn above(value: f64) -> Self {
        f32_up::from_f64(value)
    }
    fn splat(self) -> u128 {
        u128::from(self.to_bits()) * (u128::MAX / u128::from(u32::MAX))
    }
    fn splat_facts(facts: Facts) -> u128 {
        Self::from_bits(facts.bits()).splat()
    }
    fn load(lanes: &Lanes<Self>, _: usize) -> Vector {
        Vector::from_f32(*lanes)
    }
    fn store(vector: Vector, _: usize, lanes: &mut Lanes<Self>) {
        *lanes = vector.f32();
    }
    fn is_set(mask: Vector) -> [bool; LANES] {
        mask.bits_32().map(|lane| lane != 0)
    }
}

impl Real for f64 {
    const FORMAT: Format = Format::F64;
    const VECTORS: usize = 2;
    const LARGEST: Self = Self::MAX;
    type Word = u64;

    fn nearest(value: f64) -> Self {
        value
    }
    fn above(value: f64) -> Self {
        value
    }
    fn splat(self) -> u128 {
        u128::from(self.to_bits()) * (u128::MAX / u128::from(u64::MAX))
    }
    fn splat_facts(facts: Facts) -> u128 {
        Self::from_bits(facts.bits().into()).splat()
    }
    fn load(lanes: &Lanes<Self>, index: usize) -> Vector {
        Vector::from_f64([lanes[2 * index], lanes[2 * index + 1]])
    }
    fn store(vector: Vector, index: usize, lanes: &mut Lanes<Self>) {
        lanes[2 * index..2 * index + 2].copy_from_slice(&vector.f64());
    }
    fn is_set(mask: Vector) -> [bool; LANES] {
        let [a, b] = mask.bits_64().map(|lane| lane != 0);
        [a, b, false, false]
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splats_fill_all_lanes() {
        assert_eq!(1.5_f32.splat(), 0x3fc0_0000_3fc0_0000_3fc0_0000_3fc0_0000);
        assert_eq!(1.5_f64.splat(), 0x3ff8_0000_0000_0000_3ff8_0000_0000_0000);
        assert_eq!(f64::splat_facts(Facts::TOTAL), 6 | 6 << 64);
    }

    #[test]
    fn vectors_hold_neighbouring_lanes() {
        let mut lanes = [0.0; LANES];
        for index in 0..f64::VECTORS {
            f64::store(f64::load(&[1.0, 2.0, 3.0, 4.0], index), index, &mut lanes);
        }
        assert_eq!(lanes, [1.0, 2.0, 3.0, 4.0]);
    }
}
