//! Instruction sets: one vectorised source for f32 and f64 on AVX-512, AVX2 and whatever else the machine offers.

use fearless_simd::{Level, Simd, SimdBase, SimdFloat, SimdFloatElement};

/// f32 or f64.
pub trait Real: SimdFloatElement + PartialOrd {
    fn from_f64(value: f64) -> Self;
    fn to_f64(self) -> f64;
    /// Runs `job` with the widest instructions of this machine.
    fn run(level: Level, job: impl Job<Self>);
}

/// Work that is generic over the instruction set.
pub trait Job<E: Real> {
    fn run<S: Simd, R: Lanes<S, E>>(self, simd: S);
}

/// What the instruction sets do each in their own way.
pub trait Lanes<S: Simd, E: Real> {
    /// Terms of a power of 1 - q y^2 that [`Lanes::inverse_root`] wants to become exact: y^-n = q^(n/2) (1 + ...).
    const TERMS: usize;
    /// y near 1/sqrt(q).
    fn inverse_root(simd: S, q: E::Native<S>) -> E::Native<S>;
    /// Sum over the lanes.
    fn sum(v: E::Native<S>) -> f64;
}

/// Square root and division, for all instruction sets.
pub struct Exact;

impl<S: Simd, E: Real> Lanes<S, E> for Exact {
    const TERMS: usize = 0;

    #[inline(always)]
    fn inverse_root(simd: S, q: E::Native<S>) -> E::Native<S> {
        E::Native::<S>::splat(simd, E::from_f64(1.0)) / q.sqrt()
    }

    #[inline(always)]
    fn sum(v: E::Native<S>) -> f64 {
        v.as_slice().iter().fold(0.0, |sum, x| sum + x.to_f64())
    }
}

/// The estimate of the hardware.
pub struct Estimate;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{Estimate, Lanes};
    use fearless_simd::{Avx2, Avx512, ExtractToken, Simd, SimdInto, f32x8, f32x16, f64x8, kernel};

    kernel!(
        #[inline(always)]
        fn estimate_f32x16(token: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
            core::arch::x86_64::_mm512_rsqrt14_ps(q.into()).simd_into(token)
        }
    );
    kernel!(
        #[inline(always)]
        fn sum_f32x16(_token: Avx512, v: f32x16<Avx512>) -> f64 {
            f64::from(core::arch::x86_64::_mm512_reduce_add_ps(v.into()))
        }
    );
    kernel!(
        #[inline(always)]
        fn estimate_f64x8(token: Avx512, q: f64x8<Avx512>) -> f64x8<Avx512> {
            core::arch::x86_64::_mm512_rsqrt14_pd(q.into()).simd_into(token)
        }
    );
    kernel!(
        #[inline(always)]
        fn sum_f64x8(_token: Avx512, v: f64x8<Avx512>) -> f64 {
            core::arch::x86_64::_mm512_reduce_add_pd(v.into())
        }
    );
    kernel!(
        #[inline(always)]
        fn estimate_f32x8(token: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
            core::arch::x86_64::_mm256_rsqrt_ps(q.into()).simd_into(token)
        }
    );

    impl Lanes<Avx512, f32> for Estimate {
        const TERMS: usize = 1;

        #[inline(always)]
        fn inverse_root(simd: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
            estimate_f32x16(simd, q)
        }

        #[inline(always)]
        fn sum(v: f32x16<Avx512>) -> f64 {
            sum_f32x16(v.token(), v)
        }
    }

    impl Lanes<Avx512, f64> for Estimate {
        const TERMS: usize = 3;

        #[inline(always)]
        fn inverse_root(simd: Avx512, q: f64x8<Avx512>) -> f64x8<Avx512> {
            estimate_f64x8(simd, q)
        }

        #[inline(always)]
        fn sum(v: f64x8<Avx512>) -> f64 {
            sum_f64x8(v.token(), v)
        }
    }

    impl Lanes<Avx2, f32> for Estimate {
        const TERMS: usize = 1;

        #[inline(always)]
        fn inverse_root(simd: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
            estimate_f32x8(simd, q)
        }

        #[inline(always)]
        fn sum(v: f32x8<Avx2>) -> f64 {
            let (low, high) = v.token().split_f32x8(v);
            let s = low + high;
            f64::from((s[0] + s[1]) + (s[2] + s[3]))
        }
    }
}

macro_rules! runs {
    ($element:ty, $avx2:ty) => {
        impl Real for $element {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $element
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            fn run(level: Level, job: impl Job<Self>) {
                match level {
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx512(simd) => simd.vectorize(
                        #[inline(always)]
                        || job.run::<_, Estimate>(simd),
                    ),
                    #[cfg(target_arch = "x86_64")]
                    Level::Avx2(simd) => simd.vectorize(
                        #[inline(always)]
                        || job.run::<_, $avx2>(simd),
                    ),
                    #[cfg(target_arch = "x86_64")]
                    older => {
                        let simd = older.as_sse2().expect("SSE2 belongs to x86-64");
                        simd.vectorize(
                            #[inline(always)]
                            || job.run::<_, Exact>(simd),
                        )
                    }
                    #[cfg(not(target_arch = "x86_64"))]
                    other => fearless_simd::dispatch!(other, simd => job.run::<_, Exact>(simd)),
                }
            }
        }
    };
}

runs!(f32, Estimate);
runs!(f64, Exact);
