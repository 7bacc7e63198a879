//! Sixteen lanes in vectors of whatever width the processor has.

use fearless_simd::prelude::*;
use std::ops::Range;
use zeroset_eval::LANES;

/// The first lanes of sixteen, as many at a time as one vector holds.
#[inline(always)]
pub(crate) fn parts<V: SimdBase<S>, S: Simd>(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count.min(LANES).div_ceil(V::LEN)).map(
        #[inline(always)]
        |part| part * V::LEN..(part + 1) * V::LEN,
    )
}

/// All widths of vectors that this processor has: what is computed in them does not hang on it.
#[cfg(test)]
pub(crate) fn levels() -> Vec<fearless_simd::Level> {
    use fearless_simd::Level;
    let best = Level::new();
    #[allow(unused_mut, reason = "other processors have one kind")]
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(
        best.as_sse4_2().map(Level::Sse4_2).into_iter().chain(best.as_avx2().map(Level::Avx2)),
    );
    levels
}
