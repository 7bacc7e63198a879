//! Operations on the light of sixteen pixels at once.

use crate::color::LinearRgb;
use fearless_simd::{f32x16, prelude::*};
use glam::Vec3;
use zeroset_eval::LANES;

/// The vectors of sixteen lanes, one array per coordinate.
#[inline(always)]
pub fn by_axis<S: Simd>(simd: S, vectors: &[[f32; 3]; LANES]) -> [f32x16<S>; 3] {
    let mut axes = [[0.0; LANES]; 3];
    for (lane, vector) in vectors.iter().enumerate() {
        (0..3).for_each(|axis| axes[axis][lane] = vector[axis]);
    }
    let [x, y, z] = axes;
    [f32x16::simd_from(simd, x), f32x16::simd_from(simd, y), f32x16::simd_from(simd, z)]
}

/// The colors of sixteen lanes, given by their primaries.
#[inline(never)]
pub fn by_lane<S: Simd>(primaries: [f32x16<S>; 3]) -> [LinearRgb; LANES] {
    let mut parts = [[0.0; LANES]; 3];
    for (part, amounts) in parts.iter_mut().zip(primaries) {
        amounts.store_slice(part);
    }
    std::array::from_fn(|lane| LinearRgb(parts.each_ref().map(|part| part[lane])))
}

/// One vector in all lanes.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, vector: Vec3) -> [f32x16<S>; 3] {
    let Vec3 { x, y, z } = vector;
    [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)]
}

/// The share of light that is not hidden. In `hidden`, 255 means that all light is hidden.
#[inline(always)]
pub fn left<S: Simd>(simd: S, hidden: &[u8; LANES]) -> f32x16<S> {
    1.0 - f32x16::simd_from(simd, hidden.map(f32::from)) / 255.0
}

/// The scalar product in each lane.
#[inline(always)]
pub fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// A smooth step from 0 at `low` to 1 at `high`.
#[inline(always)]
pub fn smooth_step<S: Simd>(value: f32x16<S>, low: f32, high: f32) -> f32x16<S> {
    let share = ((value - low) * (1.0 / (high - low))).max(0.0).min(1.0);
    share * share * (3.0 - 2.0 * share)
}

/// The share of light from a rectangular panel in the directions `way`: 1 on the panel, 0 beside
/// it, and between at its edges. Its middle lies in the direction `middle`. `half` is half its
/// width and half its height. `up` points upward along it, or `forward` if the middle is straight
/// above or below.
#[inline(always)]
pub fn panel<S: Simd>(
    simd: S,
    way: [f32x16<S>; 3],
    middle: [f32x16<S>; 3],
    [up, forward]: [Vec3; 2],
    half: [f32; 2],
) -> f32x16<S> {
    let rise = dot(middle, splat(simd, up));
    let is_above = (rise * rise).simd_gt(STRAIGHT);
    let [up, forward] = [up, forward].map(|way| splat(simd, way));
    let up = [0, 1, 2].map(|axis| is_above.select(forward[axis], up[axis]));
    let rise = dot(middle, up);
    // The part of `up` that is perpendicular to `middle`, with the length of 1 / `steep`.
    let steep = 1.0 / (1.0 - rise * rise).max(1e-6).sqrt();
    let upward = (dot(way, up) - rise * dot(way, middle)) * steep;
    let across = dot(way, cross(middle, up)) * steep;
    let ahead = smooth_step(dot(way, middle), 0.0, 0.2);
    let [wide, tall] = half;
    ahead
        * (1.0 - smooth_step(across.abs(), wide - EDGE, wide + EDGE))
        * (1.0 - smooth_step(upward.abs(), tall - EDGE, tall + EDGE))
}

/// A panel is straight above if the square of the cosine exceeds this.
const STRAIGHT: f32 = 0.95;

/// Half the width of the edges of a panel of light.
const EDGE: f32 = 0.03;

/// The vector product in each lane.
#[inline(always)]
fn cross<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Tone mapping: bright light is compressed into the range rather than clipped.
#[inline(always)]
pub fn tone_map<S: Simd>(simd: S, amount: f32x16<S>) -> f32x16<S> {
    if amount.simd_le(KNEE).all_true() {
        return amount;
    }
    // Reinhard's curve (2002) with a white point, from the knee on, where its slope is 1.
    let above = (amount - KNEE).max(0.0) * (1.0 / (1.0 - KNEE));
    let curve = above * (1.0 + above / (WHITE * WHITE)) / (1.0 + above);
    amount.min(f32x16::splat(simd, KNEE)) + (1.0 - KNEE) * curve
}

/// Light up to this amount is not changed.
const KNEE: f32 = 0.7;
/// Amount above the knee that becomes full light, in units of the distance from the knee to 1.
const WHITE: f32 = 2.0;

/// The 40th power of a cosine, which makes a highlight small. The cosine's square is `above` /
/// `below`. In lanes in which the power is too small to be visible, it is 0. `None` if it is too
/// small in all lanes.
#[inline(always)]
pub fn highlight_power<S: Simd>(simd: S, above: f32x16<S>, below: f32x16<S>) -> Option<f32x16<S>> {
    /// A highlight is invisible if the cosine's square is at most this. The cosine's 40th power is
    /// then at most about 1e-6.
    const LEAST: f32 = 0.5;
    let is_seen = above.simd_gt(LEAST * below);
    if is_seen.all_false() {
        return None;
    }
    let square = above / below;
    let fourth = square * square;
    let eighth = fourth * fourth;
    let tenth = eighth * square;
    let twentieth = tenth * tenth;
    Some(is_seen.select(twentieth * twentieth, f32x16::splat(simd, 0.0)))
}
