//! Colors of panels, lists and pages over a picture.

use zeroset_render::overlay::Rgb;

/// Color behind text.
pub const GROUND: Rgb = 0x0020_2028;
/// Color of text.
pub const INK: Rgb = 0x00f0_f0f4;
/// Color of less important text.
pub const DIM: Rgb = 0x00a0_a0ac;
/// Color of a slider's track beyond its value.
pub const TRACK: Rgb = 0x0060_6070;
/// Color of the chosen item, and of a slider's track up to its value.
pub const CHOSEN: Rgb = 0x0070_a8e8;
