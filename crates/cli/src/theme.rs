//! Colors of panels, lists and pages over a picture.

use zeroset_render::overlay::Rgb;

/// Background of text.
pub const GROUND: Rgb = 0x0020_2028;
/// Text.
pub const INK: Rgb = 0x00f0_f0f4;
/// Less important text.
pub const DIM: Rgb = 0x00a0_a0ac;
/// A slider's track beyond its value.
pub const TRACK: Rgb = 0x0060_6070;
/// The chosen item, and a slider's track up to its value.
pub const CHOSEN: Rgb = 0x0070_a8e8;
