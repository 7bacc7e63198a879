//! The choice of the vectors that code is compiled for.

/// Runs `$op` with a token of the widest compiled vectors that a [`fearless_simd::Level`] allows.
///
/// On x86-64 `$op` is compiled for SSE2, AVX2 and AVX-512. [`fearless_simd::dispatch`] would add
/// SSE4.2, which only processors without AVX2 would run. Development builds compile AVX-512 for
/// unit tests of the crate alone: it computes the bits of AVX2, and compiling takes its time.
#[macro_export]
macro_rules! dispatch {
    ($level:expr, $simd:ident => $op:expr) => {
        match $level {
            #[cfg(all(target_arch = "x86_64", any(test, not(debug_assertions))))]
            fearless_simd::Level::Avx512(token) => $crate::dispatch!(@with token, $simd => $op),
            #[cfg(target_arch = "x86_64")]
            level => match (level.as_avx2(), level.as_sse2()) {
                (Some(token), _) => $crate::dispatch!(@with token, $simd => $op),
                (_, Some(token)) => $crate::dispatch!(@with token, $simd => $op),
                (None, None) => unreachable!("x86-64 has SSE2"),
            },
            #[cfg(not(target_arch = "x86_64"))]
            level => fearless_simd::dispatch!(level, $simd => $op),
        }
    };
    (@with $token:ident, $simd:ident => $op:expr) => {
        fearless_simd::Simd::vectorize(
            $token,
            #[inline(always)]
            || {
                let $simd = $token;
                $op
            },
        )
    };
}
