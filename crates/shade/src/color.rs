//! Colors in sRGB bytes and in linear light.

use fearless_simd::{f32x16, prelude::*, u32x16};
use std::sync::OnceLock;
use zeroset_eval::LANES;

/// A color in linear light: amounts of red, green and blue of the sRGB primaries, 1 at full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearRgb(pub [f32; 3]);

/// A table that converts an amount of light exactly to the nearest sRGB byte, by one lookup and one
/// addition.
///
/// Amounts that agree in their upper 16 bits have at most two different bytes, which are adjacent.
/// Their common table entry has the smaller byte in its upper half. Adding an amount's lower 16
/// bits to the entry carries into the byte if the amount belongs to the larger byte.
pub(crate) struct SrgbTable([u32; ENTRIES]);

/// Number of bits in the lower half of a float.
const LOWER: u32 = 16;

/// Amounts up to this are black: byte 1 begins at 1.5e-4.
pub(crate) const BLACK: f32 = 1.0 / 8192.0;

/// Number of entries. The upper halves from black to full light differ only in their last 11 bits.
/// So an index is reduced to these bits, and needs no bounds check.
const ENTRIES: usize = 2048;

impl SrgbTable {
    /// The table, built when it is first requested.
    pub fn get() -> &'static Self {
        static CODES: OnceLock<SrgbTable> = OnceLock::new();
        CODES.get_or_init(|| {
            // For each byte, the least amount that belongs to the next byte: the curve's value half
            // way between both bytes, rounded up.
            let next: Vec<u32> = (0..255)
                .map(|byte| {
                    let half_way = decode((f64::from(byte) + 0.5) / 255.0);
                    let nearest = half_way as f32;
                    let is_below = f64::from(nearest) < half_way;
                    (if is_below { nearest.next_up() } else { nearest }).to_bits()
                })
                .collect();
            let mut codes = [0; ENTRIES];
            for upper in BLACK.to_bits() >> LOWER..=1.0_f32.to_bits() >> LOWER {
                let least = upper << LOWER;
                let byte = next.partition_point(|&next| next <= least);
                let until_next = next.get(byte).map_or(1 << LOWER, |next| next - least);
                codes[upper as usize % ENTRIES] =
                    (byte << LOWER) as u32 + (1 << LOWER) - until_next.min(1 << LOWER);
            }
            Self(codes)
        })
    }

    /// The byte nearest to an amount from [`BLACK`] to 1.
    #[inline]
    pub fn byte(&self, amount: f32) -> u8 {
        let bits = amount.to_bits();
        let entry = self.0[(bits >> LOWER) as usize % ENTRIES];
        ((entry + (bits & ((1 << LOWER) - 1))) >> LOWER) as u8
    }

    /// The bytes of sixteen colors, given by their primaries.
    #[inline(always)]
    pub fn bytes<S: Simd>(&self, simd: S, primaries: [f32x16<S>; 3]) -> [[u8; 3]; LANES] {
        let mut all = u32x16::splat(simd, 0);
        for amounts in primaries.into_iter().rev() {
            let bits: u32x16<S> = amounts.to_bits();
            let mut entries = [0; LANES];
            ((bits >> LOWER) & (ENTRIES - 1) as u32).store_slice(&mut entries);
            for entry in &mut entries {
                *entry = self.0[*entry as usize % ENTRIES];
            }
            let entries = u32x16::simd_from(simd, entries);
            all = (all << 8) | ((entries + (bits & ((1 << LOWER) - 1))) >> LOWER);
        }
        let mut lanes = [0_u32; LANES];
        all.store_slice(&mut lanes);
        let mut bytes = [[0; 3]; LANES];
        for (bytes, lane) in bytes.iter_mut().zip(lanes) {
            let [red, green, blue, _] = lane.to_le_bytes();
            *bytes = [red, green, blue];
        }
        bytes
    }
}

/// The amount of light that sRGB encodes as this share of the full value (IEC 61966-2-1).
fn decode(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The share of the full value by which sRGB encodes an amount of light (IEC 61966-2-1): the
/// inverse of [`decode`].
fn encode(amount: f64) -> f64 {
    if amount <= 0.003_130_8 { 12.92 * amount } else { 1.055 * amount.powf(1.0 / 2.4) - 0.055 }
}

impl LinearRgb {
    /// The color that sRGB encodes with these shares of the full values.
    pub fn from_encoded(shares: [f32; 3]) -> Self {
        Self(shares.map(|share| decode(share.into()) as f32))
    }

    /// The shares of the full values by which sRGB encodes the color.
    pub fn encoded(self) -> [f32; 3] {
        self.0.map(|amount| encode(amount.into()) as f32)
    }

    /// The color that sRGB encodes with these bytes (IEC 61966-2-1).
    pub fn from_srgb(bytes: [u8; 3]) -> Self {
        static AMOUNTS: OnceLock<[f32; 256]> = OnceLock::new();
        let amount = |byte: usize| decode(byte as f64 / 255.0) as f32;
        let amounts = AMOUNTS.get_or_init(|| std::array::from_fn(amount));
        Self(bytes.map(|byte| amounts[usize::from(byte)]))
    }

    /// The nearest sRGB bytes; amounts outside [0, 1] are clamped, NaN is black.
    pub fn to_srgb(self) -> [u8; 3] {
        let within = |amount| if amount > BLACK { f32::min(amount, 1.0) } else { BLACK };
        self.0.map(|amount| SrgbTable::get().byte(within(amount)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_eval::dispatch;
    use zeroset_testkit::simd::levels;

    #[test]
    fn sixteen_colors_at_once_have_the_bytes_of_each() {
        let codes = SrgbTable::get();
        let least = BLACK.to_bits();
        let most = 1.0_f32.to_bits();
        // The samples are an odd number of floats apart, so that their lower halves differ.
        let step = 48 * 1021;
        for level in levels() {
            for first in (least..=most - step).step_by(step as usize) {
                let amount = |n: usize| f32::from_bits(first + n as u32 * (step / 48));
                let primaries: [[f32; LANES]; 3] =
                    std::array::from_fn(|k| std::array::from_fn(|lane| amount(3 * lane + k)));
                let bytes = dispatch!(level, simd => {
                    let [red, green, blue] = primaries;
                    let simd_from = |amounts: [f32; LANES]| f32x16::simd_from(simd, amounts);
                    codes.bytes(simd, [simd_from(red), simd_from(green), simd_from(blue)])
                });
                let alone: [[u8; 3]; LANES] =
                    std::array::from_fn(|lane| primaries.map(|all| codes.byte(all[lane])));
                assert_eq!(bytes, alone, "from {first:#x} by {level:?}");
            }
        }
    }

    #[test]
    fn every_byte_survives_the_way_to_light_and_back() {
        for byte in 0..=255 {
            assert_eq!(LinearRgb::from_srgb([byte; 3]).to_srgb(), [byte; 3]);
        }
        // Half of the light is encoded as a much larger byte than half of 255.
        assert_eq!(LinearRgb([0.5; 3]).to_srgb(), [188; 3]);
        assert_eq!(LinearRgb([f32::NAN, -1.0, 2.0]).to_srgb(), [0, 0, 255]);
    }

    /// The sRGB byte of an amount, by the formula of the curve in f64.
    fn exact(amount: f32) -> u8 {
        (255.0 * encode(amount.into())).round() as u8
    }

    #[test]
    fn bytes_are_the_nearest() {
        // Floats spread over [0, 1], and the floats around the limits between bytes.
        for bits in (0..=1.0_f32.to_bits()).step_by(997) {
            let amount = f32::from_bits(bits);
            assert_eq!(SrgbTable::get().byte(amount.max(BLACK)), exact(amount), "{amount:e}");
        }
        for byte in 0..255 {
            let begin = decode((f64::from(byte) + 0.5) / 255.0) as f32;
            for amount in [begin.next_down(), begin, begin.next_up()] {
                assert_eq!(SrgbTable::get().byte(amount.max(BLACK)), exact(amount), "{amount:e}");
            }
        }
    }
}
