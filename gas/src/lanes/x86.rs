//! AVX-512 and AVX2: estimates of roots and reciprocals bettered by Newton's method, rows turned into columns by shuffles.

use core::arch::x86_64::*;

use fearless_simd::{
    Avx2, Avx512, ExtractToken, Simd, SimdBase, SimdFloat, SimdInto, f32x8, f32x16, f64x8, kernel,
};

use super::{Machine, Quad, Real};

/// The estimates of the hardware.
pub struct Estimate;

kernel!(
    #[inline(always)]
    fn inverse_root_f32x16(token: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
        _mm512_rsqrt14_ps(q.into()).simd_into(token)
    }
);
kernel!(
    #[inline(always)]
    fn reciprocal_f32x16(token: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
        _mm512_rcp14_ps(q.into()).simd_into(token)
    }
);
kernel!(
    #[inline(always)]
    fn total_f32x16(_token: Avx512, v: f32x16<Avx512>) -> f64 {
        f64::from(_mm512_reduce_add_ps(v.into()))
    }
);
kernel!(
    #[inline(always)]
    fn inverse_root_f64x8(token: Avx512, q: f64x8<Avx512>) -> f64x8<Avx512> {
        _mm512_rsqrt14_pd(q.into()).simd_into(token)
    }
);
kernel!(
    #[inline(always)]
    fn total_f64x8(_token: Avx512, v: f64x8<Avx512>) -> f64 {
        _mm512_reduce_add_pd(v.into())
    }
);
kernel!(
    #[inline(always)]
    fn inverse_root_f32x8(token: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
        _mm256_rsqrt_ps(q.into()).simd_into(token)
    }
);
kernel!(
    #[inline(always)]
    fn reciprocal_f32x8(token: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
        _mm256_rcp_ps(q.into()).simd_into(token)
    }
);

kernel!(
    #[inline(always)]
    fn totals_f32x16(
        _token: Avx512,
        a: f32x16<Avx512>,
        b: f32x16<Avx512>,
        c: f32x16<Avx512>,
        d: f32x16<Avx512>,
    ) -> __m128 {
        let (a, b, c, d): (__m512, __m512, __m512, __m512) =
            (a.into(), b.into(), c.into(), d.into());
        let ab = _mm512_add_ps(_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let cd = _mm512_add_ps(_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        let (ab, cd) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
        let low = _mm512_castpd_ps(_mm512_unpacklo_pd(ab, cd));
        let high = _mm512_castpd_ps(_mm512_unpackhi_pd(ab, cd));
        let all = _mm512_add_ps(low, high);
        let half = _mm256_add_ps(
            _mm512_castps512_ps256(all),
            _mm512_extractf32x8_ps::<1>(all),
        );
        _mm_add_ps(
            _mm256_castps256_ps128(half),
            _mm256_extractf128_ps::<1>(half),
        )
    }
);
kernel!(
    #[inline(always)]
    fn totals_f32x8(
        _token: Avx2,
        a: f32x8<Avx2>,
        b: f32x8<Avx2>,
        c: f32x8<Avx2>,
        d: f32x8<Avx2>,
    ) -> __m128 {
        let ab = _mm256_hadd_ps(a.into(), b.into());
        let cd = _mm256_hadd_ps(c.into(), d.into());
        let all = _mm256_hadd_ps(ab, cd);
        _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps::<1>(all))
    }
);

/// Four values in double precision.
#[inline(always)]
fn four(v: __m128) -> [f64; 4] {
    // SAFETY: both are four f32 in a row.
    let v: [f32; 4] = unsafe { core::mem::transmute(v) };
    [
        f64::from(v[0]),
        f64::from(v[1]),
        f64::from(v[2]),
        f64::from(v[3]),
    ]
}

/// Where quads stand in memory.
type Places<E, const N: usize> = [*const E; N];

kernel!(
    #[inline(always)]
    fn quad_f32x16(token: Avx512, p: Places<f32, 16>) -> [f32x16<Avx512>; 4] {
        let mut rows = [_mm512_setzero_ps(); 4];
        for r in 0..4 {
            // SAFETY: `Machine::quad` promises that all places hold a quad.
            rows[r] = unsafe {
                let row = _mm512_castps128_ps512(_mm_load_ps(p[r]));
                let row = _mm512_insertf32x4::<1>(row, _mm_load_ps(p[r + 4]));
                let row = _mm512_insertf32x4::<2>(row, _mm_load_ps(p[r + 8]));
                _mm512_insertf32x4::<3>(row, _mm_load_ps(p[r + 12]))
            };
        }
        let low = _mm512_castps_pd(_mm512_unpacklo_ps(rows[0], rows[1]));
        let high = _mm512_castps_pd(_mm512_unpackhi_ps(rows[0], rows[1]));
        let low2 = _mm512_castps_pd(_mm512_unpacklo_ps(rows[2], rows[3]));
        let high2 = _mm512_castps_pd(_mm512_unpackhi_ps(rows[2], rows[3]));
        [
            _mm512_castpd_ps(_mm512_unpacklo_pd(low, low2)).simd_into(token),
            _mm512_castpd_ps(_mm512_unpackhi_pd(low, low2)).simd_into(token),
            _mm512_castpd_ps(_mm512_unpacklo_pd(high, high2)).simd_into(token),
            _mm512_castpd_ps(_mm512_unpackhi_pd(high, high2)).simd_into(token),
        ]
    }
);
kernel!(
    #[inline(always)]
    fn quad_f64x8(token: Avx512, p: Places<f64, 8>) -> [f64x8<Avx512>; 4] {
        let mut rows = [_mm512_setzero_pd(); 4];
        for r in 0..4 {
            // SAFETY: `Machine::quad` promises that all places hold a quad.
            rows[r] = unsafe {
                let row = _mm512_castpd256_pd512(_mm256_loadu_pd(p[r]));
                _mm512_insertf64x4::<1>(row, _mm256_loadu_pd(p[r + 4]))
            };
        }
        let even = _mm512_unpacklo_pd(rows[0], rows[1]);
        let odd = _mm512_unpackhi_pd(rows[0], rows[1]);
        let even2 = _mm512_unpacklo_pd(rows[2], rows[3]);
        let odd2 = _mm512_unpackhi_pd(rows[2], rows[3]);
        let near = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        let far = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        [
            _mm512_permutex2var_pd(even, near, even2).simd_into(token),
            _mm512_permutex2var_pd(odd, near, odd2).simd_into(token),
            _mm512_permutex2var_pd(even, far, even2).simd_into(token),
            _mm512_permutex2var_pd(odd, far, odd2).simd_into(token),
        ]
    }
);
kernel!(
    #[inline(always)]
    fn quad_f32x8(token: Avx2, p: Places<f32, 8>) -> [f32x8<Avx2>; 4] {
        let mut rows = [_mm256_setzero_ps(); 4];
        for r in 0..4 {
            // SAFETY: `Machine::quad` promises that all places hold a quad.
            rows[r] = unsafe {
                let row = _mm256_castps128_ps256(_mm_load_ps(p[r]));
                _mm256_insertf128_ps::<1>(row, _mm_load_ps(p[r + 4]))
            };
        }
        let low = _mm256_castps_pd(_mm256_unpacklo_ps(rows[0], rows[1]));
        let high = _mm256_castps_pd(_mm256_unpackhi_ps(rows[0], rows[1]));
        let low2 = _mm256_castps_pd(_mm256_unpacklo_ps(rows[2], rows[3]));
        let high2 = _mm256_castps_pd(_mm256_unpackhi_ps(rows[2], rows[3]));
        [
            _mm256_castpd_ps(_mm256_unpacklo_pd(low, low2)).simd_into(token),
            _mm256_castpd_ps(_mm256_unpackhi_pd(low, low2)).simd_into(token),
            _mm256_castpd_ps(_mm256_unpacklo_pd(high, high2)).simd_into(token),
            _mm256_castpd_ps(_mm256_unpackhi_pd(high, high2)).simd_into(token),
        ]
    }
);

/// Where the quads of some rows stand.
#[inline(always)]
fn places<E: Real, const N: usize>(quads: &[Quad<E>], part: usize, numbers: &[E]) -> Places<E, N> {
    let mut places = [core::ptr::null(); N];
    for (place, number) in places.iter_mut().zip(&numbers[..N]) {
        *place = quads.as_ptr().wrapping_add(number.index() + part).cast();
    }
    places
}

impl Machine<Avx512, f32> for Estimate {
    #[inline(always)]
    fn inverse_root(simd: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
        let y = inverse_root_f32x16(simd, q);
        y * (q * y * y).mul_add(f32x16::splat(simd, -0.5), 1.5)
    }

    #[inline(always)]
    fn reciprocal(simd: Avx512, q: f32x16<Avx512>) -> f32x16<Avx512> {
        let y = reciprocal_f32x16(simd, q);
        y * (-q).mul_add(y, 2.0)
    }

    #[inline(always)]
    unsafe fn quad(
        simd: Avx512,
        quads: &[Quad<f32>],
        part: usize,
        numbers: &[f32],
    ) -> [f32x16<Avx512>; 4] {
        quad_f32x16(simd, places(quads, part, numbers))
    }

    #[inline(always)]
    fn total(v: f32x16<Avx512>) -> f64 {
        total_f32x16(v.token(), v)
    }

    #[inline(always)]
    fn totals([a, b, c, d]: [f32x16<Avx512>; 4]) -> [f64; 4] {
        four(totals_f32x16(a.token(), a, b, c, d))
    }

    #[inline(always)]
    fn double_total(v: f64x8<Avx512>) -> f64 {
        total_f64x8(v.token(), v)
    }
}

impl Machine<Avx512, f64> for Estimate {
    #[inline(always)]
    fn inverse_root(simd: Avx512, q: f64x8<Avx512>) -> f64x8<Avx512> {
        let half = f64x8::splat(simd, -0.5);
        let y = inverse_root_f64x8(simd, q);
        let y = y * (q * y * y).mul_add(half, 1.5);
        y * (q * y * y).mul_add(half, 1.5)
    }

    #[inline(always)]
    fn reciprocal(simd: Avx512, q: f64x8<Avx512>) -> f64x8<Avx512> {
        f64x8::splat(simd, 1.0) / q
    }

    #[inline(always)]
    unsafe fn quad(
        simd: Avx512,
        quads: &[Quad<f64>],
        part: usize,
        numbers: &[f64],
    ) -> [f64x8<Avx512>; 4] {
        quad_f64x8(simd, places(quads, part, numbers))
    }

    #[inline(always)]
    fn total(v: f64x8<Avx512>) -> f64 {
        total_f64x8(v.token(), v)
    }

    #[inline(always)]
    fn double_total(v: f64x8<Avx512>) -> f64 {
        total_f64x8(v.token(), v)
    }
}

impl Machine<Avx2, f32> for Estimate {
    #[inline(always)]
    fn inverse_root(simd: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
        let y = inverse_root_f32x8(simd, q);
        y * (q * y * y).mul_add(f32x8::splat(simd, -0.5), 1.5)
    }

    #[inline(always)]
    fn reciprocal(simd: Avx2, q: f32x8<Avx2>) -> f32x8<Avx2> {
        let y = reciprocal_f32x8(simd, q);
        y * (-q).mul_add(y, 2.0)
    }

    #[inline(always)]
    unsafe fn quad(
        simd: Avx2,
        quads: &[Quad<f32>],
        part: usize,
        numbers: &[f32],
    ) -> [f32x8<Avx2>; 4] {
        quad_f32x8(simd, places(quads, part, numbers))
    }

    #[inline(always)]
    fn total(v: f32x8<Avx2>) -> f64 {
        let (low, high) = v.token().split_f32x8(v);
        let s = low + high;
        f64::from((s[0] + s[1]) + (s[2] + s[3]))
    }

    #[inline(always)]
    fn totals([a, b, c, d]: [f32x8<Avx2>; 4]) -> [f64; 4] {
        four(totals_f32x8(a.token(), a, b, c, d))
    }
}
