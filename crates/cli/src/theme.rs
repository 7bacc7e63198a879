//! Colors of what lies over a picture: panels, lists, pages.

use zeroset_render::overlay::Rgb;

/// Behind letters.
pub const GROUND: Rgb = 0x0020_2028;
/// Letters.
pub const INK: Rgb = 0x00f0_f0f4;
/// Letters that say less.
pub const DIM: Rgb = 0x00a0_a0ac;
/// What is left of a slider's way.
pub const TRACK: Rgb = 0x0060_6070;
/// What is chosen, or done of a slider's way.
pub const CHOSEN: Rgb = 0x0070_a8e8;
