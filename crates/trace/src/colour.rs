//! Colours as people write them and as light adds them.

use std::sync::OnceLock;

/// A colour in linear light: amounts of red, green and blue of the sRGB primaries, 1 at full.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearRgb(pub [f32; 3]);

/// The table of codes has one entry more. It is over the square root of the amount, which the code
/// nearly follows: neighbouring entries differ by less than a tenth of a code.
const LAST_CODE: usize = 4095;

/// The nearest sRGB byte of an amount within [0, 1].
fn encode(value: f32) -> u8 {
    let encoded =
        if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
    (255.0 * encoded).round() as u8
}

impl LinearRgb {
    /// The colour that sRGB encodes with these bytes (IEC 61966-2-1).
    pub fn from_srgb(bytes: [u8; 3]) -> Self {
        Self(bytes.map(|byte| {
            let value = f32::from(byte) / 255.0;
            if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        }))
    }

    /// The sRGB bytes, each within 0.55 of the exact code; amounts outside [0, 1] are clamped, NaN
    /// is black.
    pub fn to_srgb(self) -> [u8; 3] {
        static CODES: OnceLock<Vec<u8>> = OnceLock::new();
        let codes = CODES.get_or_init(|| {
            (0..=LAST_CODE).map(|n| encode((n as f32 / LAST_CODE as f32).powi(2))).collect()
        });
        // A NaN becomes 0 in the conversion to an index.
        self.0.map(|value| {
            let root = value.clamp(0.0, 1.0).sqrt();
            codes[(root * LAST_CODE as f32 + 0.5) as usize]
        })
    }

    /// The colour written `#rrggbb` or `rrggbb`, or `None` if `text` is neither.
    pub fn from_hex(text: &str) -> Option<Self> {
        let digits = text.strip_prefix('#').unwrap_or(text);
        if digits.len() != 6 || !digits.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return None;
        }
        let value = u32::from_str_radix(digits, 16).ok()?;
        let [_, red, green, blue] = value.to_be_bytes();
        Some(Self::from_srgb([red, green, blue]))
    }

    /// The light times `factor`, plus `white` of all three primaries.
    #[must_use]
    pub fn lit(self, factor: f32, white: f32) -> Self {
        Self(self.0.map(|value| value * factor + white))
    }

    /// From this colour at 0 to `other` at 1, in linear light.
    #[must_use]
    pub fn mixed(self, other: Self, share: f32) -> Self {
        Self([0, 1, 2].map(|k| self.0[k] + (other.0[k] - self.0[k]) * share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_byte_survives_the_way_to_light_and_back() {
        for byte in 0..=255 {
            assert_eq!(LinearRgb::from_srgb([byte; 3]).to_srgb(), [byte; 3]);
        }
        for n in 0..=10_000 {
            let value = n as f32 / 10_000.0;
            let [code, ..] = LinearRgb([value; 3]).to_srgb();
            assert!(code.abs_diff(encode(value)) <= 1, "{value}");
        }
        // Half of the light is much brighter than half of the code.
        assert_eq!(LinearRgb([0.5; 3]).to_srgb(), [188; 3]);
        assert_eq!(LinearRgb([f32::NAN, -1.0, 2.0]).to_srgb(), [0, 0, 255]);
    }

    #[test]
    fn hexadecimal_colours_are_read() {
        assert_eq!(LinearRgb::from_hex("#ff8000").map(LinearRgb::to_srgb), Some([255, 128, 0]));
        assert_eq!(LinearRgb::from_hex("FF8000").map(LinearRgb::to_srgb), Some([255, 128, 0]));
        for text in ["", "#fff", "#ff80000", "+f8000", "red", "#ff80é"] {
            assert_eq!(LinearRgb::from_hex(text), None, "{text}");
        }
    }
}
