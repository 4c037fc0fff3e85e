//! Instruction sets: one source compiled for the few that matter, chosen while the program runs.

/// Runs `op` with `simd` as the widest of AVX-512, AVX2 and SSE2 that `level` has; on other processors with what they have.
///
/// Three instead of the five that [`fearless_simd::dispatch`] makes: compilation takes as much longer as there are sets.
#[macro_export]
macro_rules! widest {
    ($level:expr, $simd:ident => $op:expr) => {{
        #[cfg(target_arch = "x86_64")]
        {
            use ::fearless_simd::Simd as _;
            match $level {
                ::fearless_simd::Level::Avx512($simd) => $simd.vectorize(
                    #[inline(always)]
                    || $op,
                ),
                ::fearless_simd::Level::Avx2($simd) => $simd.vectorize(
                    #[inline(always)]
                    || $op,
                ),
                other => {
                    let $simd = other.as_sse2().expect("SSE2 belongs to x86-64");
                    $simd.vectorize(
                        #[inline(always)]
                        || $op,
                    )
                }
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            ::fearless_simd::dispatch!($level, $simd => $op)
        }
    }};
}
