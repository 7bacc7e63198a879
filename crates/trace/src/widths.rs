//! For tests: what is computed in vectors does not hang on how wide they are.

use fearless_simd::Level;

/// All widths of vectors that this processor has.
pub(crate) fn levels() -> Vec<Level> {
    let best = Level::new();
    #[allow(unused_mut, reason = "other processors have one kind")]
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(
        best.as_sse4_2().map(Level::Sse4_2).into_iter().chain(best.as_avx2().map(Level::Avx2)),
    );
    levels
}
