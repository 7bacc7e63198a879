//! Vector instruction sets (SIMD levels), for tests that compare them.

use fearless_simd::Level;

/// Whether this level has fused multiplication and addition, with a single rounding.
pub fn is_fused(level: Level) -> bool {
    #[cfg(target_arch = "x86_64")]
    return level.as_avx2().is_some();
    #[cfg(not(target_arch = "x86_64"))]
    return !level.is_fallback();
}

/// All levels that this processor has and code is compiled for. Those that are
/// [fused](is_fused) compute the same bits.
pub fn levels() -> Vec<Level> {
    let best = Level::new();
    #[allow(unused_mut, reason = "other processors have one kind")]
    let mut levels = vec![Level::baseline(), best];
    #[cfg(target_arch = "x86_64")]
    levels.extend(best.as_avx2().map(Level::Avx2));
    levels
}
