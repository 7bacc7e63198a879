//! What is done with the light of sixteen pixels at once.

use fearless_simd::{f32x16, prelude::*};
use glam::Vec3;
use zeroset_eval::LANES;

/// The vectors of sixteen lanes by their coordinates.
#[inline(always)]
pub fn by_axis<S: Simd>(simd: S, vectors: &[[f32; 3]; LANES]) -> [f32x16<S>; 3] {
    let mut axes = [[0.0; LANES]; 3];
    for (lane, vector) in vectors.iter().enumerate() {
        (0..3).for_each(|axis| axes[axis][lane] = vector[axis]);
    }
    let [x, y, z] = axes;
    [f32x16::simd_from(simd, x), f32x16::simd_from(simd, y), f32x16::simd_from(simd, z)]
}

/// The same vector in all lanes.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, vector: Vec3) -> [f32x16<S>; 3] {
    let Vec3 { x, y, z } = vector;
    [f32x16::splat(simd, x), f32x16::splat(simd, y), f32x16::splat(simd, z)]
}

/// What is left where so much is hidden.
#[inline(always)]
pub fn left<S: Simd>(simd: S, hidden: &[u8; LANES]) -> f32x16<S> {
    1.0 - f32x16::simd_from(simd, hidden.map(f32::from)) / 255.0
}

/// The scalar products.
#[inline(always)]
pub fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// Light as a picture shows it: what is brighter than most of the range is brought into it, rather
/// than cut off.
#[inline(always)]
pub fn toned<S: Simd>(simd: S, amount: f32x16<S>) -> f32x16<S> {
    if amount.simd_le(KNEE).all_true() {
        return amount;
    }
    // Reinhard's curve (2002) with a white point, from the knee on, where its slope is 1.
    let above = (amount - KNEE).max(0.0) * (1.0 / (1.0 - KNEE));
    let curve = above * (1.0 + above / (WHITE * WHITE)) / (1.0 + above);
    amount.min(f32x16::splat(simd, KNEE)) + (1.0 - KNEE) * curve
}

/// Up to here light is shown as it is.
const KNEE: f32 = 0.7;
/// What becomes full light, in units from the knee to 1.
const WHITE: f32 = 2.0;

/// The 40th power of a cosine, which makes a highlight as small as it is, given its square as a
/// quotient; 0 in lanes where it is too faint to be seen. `None` if that is so in every lane.
#[inline(always)]
pub fn shine<S: Simd>(simd: S, above: f32x16<S>, below: f32x16<S>) -> Option<f32x16<S>> {
    /// Of this the power is 1e-6.
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
