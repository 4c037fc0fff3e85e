//! Instruction sets: one vectorised source for f32 and f64 on AVX-512, AVX2 and whatever else the machine offers.
//!
//! Particles that a loop picks one by one are stored as rows of quads; [`Machine::quad`] turns one quad of some rows into columns.
//! Numbers of particles travel as bits of the element type, so that the same instructions compress them.

use fearless_simd::{
    Bytes, Level, Simd, SimdBase, SimdCvtFloat, SimdFloat, SimdFloatElement, SimdWiden,
};

/// The lanes of the machine.
pub type Lanes<S, E> = <E as SimdFloatElement>::Native<S>;

/// The largest number of lanes; what loops read or write beyond an end.
pub const MOST: usize = 16;

/// Four values of a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub struct Quad<E>(pub [E; 4]);

/// f32 or f64.
pub trait Real: SimdFloatElement + Default + Send + Sync + 'static {
    /// Relative spacing of numbers.
    const EPSILON: f64;
    /// A square of a distance that no two particles apart have, in units of the smoothing length.
    const TINY: f64;
    /// Steps of the grid that coordinates lie on, from the middle of a leaf outwards; infinite without a grid.
    const STEPS: f64;

    fn from_f64(value: f64) -> Self;
    fn to_f64(self) -> f64;
    /// The number k as bits.
    fn number(k: usize) -> Self;
    /// The number of these bits.
    fn index(self) -> usize;
    /// The number `first` and those that follow it at distances of `stride`, as bits.
    fn numbers<S: Simd>(simd: S, first: usize, stride: usize) -> Lanes<S, Self>;
    /// Numbers moved on by `by`.
    fn further<S: Simd>(numbers: Lanes<S, Self>, by: usize) -> Lanes<S, Self>;
    /// A coordinate counted in steps of the grid.
    fn place(steps: f64) -> Self;
    /// An offset of coordinates counted in steps, a whole number on a grid.
    fn offset(steps: [f64; 3]) -> [f64; 3];
    /// A quad whose first three values, coordinates in steps doubled `from` times, are moved by an offset and counted in steps doubled
    /// `to` times.
    fn moved(quad: Quad<Self>, offset: [f64; 3], from: i32, to: i32) -> Quad<Self>;
    /// The difference of coordinates in steps: exact for f32, but for one rounding.
    fn apart<S: Simd>(simd: S, there: Lanes<S, Self>, here: Self) -> Lanes<S, Self>;
    /// Adds to sums in double precision.
    fn accumulate<S: Simd>(sum: &mut S::f64s, value: Lanes<S, Self>);
    /// Runs `job` with the best instructions up to `level`.
    fn run<J: Job<Self>>(level: Level, job: J) -> J::Output;
}

/// Work that is generic over the instruction set.
pub trait Job<E: Real> {
    type Output;
    fn run<S: Simd, R: Machine<S, E>>(self, simd: S) -> Self::Output;
}

/// What the instruction sets do each in their own way.
pub trait Machine<S: Simd, E: Real> {
    /// 1/sqrt(q) to a few units of rounding.
    fn inverse_root(simd: S, q: Lanes<S, E>) -> Lanes<S, E>;

    /// 1/q to a few units of rounding.
    fn reciprocal(simd: S, q: Lanes<S, E>) -> Lanes<S, E>;

    /// The four columns of the quads at the places `numbers` + `part`.
    ///
    /// # Safety
    /// Each of the numbers plus `part` is the number of a quad in `quads`; there are as many numbers as lanes.
    unsafe fn quad(simd: S, quads: &[Quad<E>], part: usize, numbers: &[E]) -> [Lanes<S, E>; 4];

    /// Sum over the lanes.
    fn total(v: Lanes<S, E>) -> f64;

    /// Sums over the lanes of four vectors.
    #[inline(always)]
    fn totals(v: [Lanes<S, E>; 4]) -> [f64; 4] {
        let [a, b, c, d] = v;
        [
            Self::total(a),
            Self::total(b),
            Self::total(c),
            Self::total(d),
        ]
    }

    /// Sum over the lanes in double precision.
    #[inline(always)]
    fn double_total(v: S::f64s) -> f64 {
        v.as_slice().iter().fold(0.0, |sum, x| sum + x)
    }
}

/// The same value in all lanes.
#[inline(always)]
pub fn same<S: Simd, E: Real>(simd: S, value: f64) -> Lanes<S, E> {
    Lanes::<S, E>::splat(simd, E::from_f64(value))
}

/// The lanes from `k` on.
#[inline(always)]
pub fn load<S: Simd, E: Real>(simd: S, column: &[E], k: usize) -> Lanes<S, E> {
    Lanes::<S, E>::from_slice(simd, &column[k..k + Lanes::<S, E>::LEN])
}

/// Square root, division and one load a value, for all instruction sets.
pub struct Exact;

impl<S: Simd, E: Real> Machine<S, E> for Exact {
    #[inline(always)]
    fn inverse_root(simd: S, q: Lanes<S, E>) -> Lanes<S, E> {
        same::<S, E>(simd, 1.0) / q.sqrt()
    }

    #[inline(always)]
    fn reciprocal(simd: S, q: Lanes<S, E>) -> Lanes<S, E> {
        same::<S, E>(simd, 1.0) / q
    }

    #[inline(always)]
    unsafe fn quad(simd: S, quads: &[Quad<E>], part: usize, numbers: &[E]) -> [Lanes<S, E>; 4] {
        let mut columns = [same::<S, E>(simd, 0.0); 4];
        for (l, number) in numbers.iter().enumerate() {
            for (column, &value) in columns.iter_mut().zip(&quads[number.index() + part].0) {
                column[l] = value;
            }
        }
        columns
    }

    #[inline(always)]
    fn total(v: Lanes<S, E>) -> f64 {
        v.as_slice().iter().fold(0.0, |sum, x| sum + x.to_f64())
    }
}

#[cfg(target_arch = "x86_64")]
mod x86;
#[cfg(target_arch = "x86_64")]
use x86::Estimate;

macro_rules! runs {
    ($avx2:ty) => {
        fn run<J: Job<Self>>(level: Level, job: J) -> J::Output {
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
                _ => match Level::baseline() {
                    Level::Sse2(simd) => simd.vectorize(
                        #[inline(always)]
                        || job.run::<_, Exact>(simd),
                    ),
                    other => unreachable!("{other:?} is no baseline of x86-64"),
                },
                #[cfg(not(target_arch = "x86_64"))]
                other => fearless_simd::dispatch!(other, simd => job.run::<_, Exact>(simd)),
            }
        }
    };
}

/// Added to a number below 2^51 it leaves the nearest integer in the lowest bits, ties to even.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

impl Real for f32 {
    const EPSILON: f64 = f32::EPSILON as f64;
    const TINY: f64 = 1e-24;
    const STEPS: f64 = (1 << 29) as f64;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value as f32
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }

    #[inline(always)]
    fn number(k: usize) -> Self {
        f32::from_bits(k as u32)
    }

    #[inline(always)]
    fn index(self) -> usize {
        self.to_bits() as usize
    }

    #[inline(always)]
    fn numbers<S: Simd>(simd: S, first: usize, stride: usize) -> S::f32s {
        let mut numbers = S::u32s::splat(simd, first as u32);
        for (l, number) in numbers.as_mut_slice().iter_mut().enumerate() {
            *number += (l * stride) as u32;
        }
        numbers.bitcast()
    }

    #[inline(always)]
    fn further<S: Simd>(numbers: S::f32s, by: usize) -> S::f32s {
        (numbers.bitcast::<S::u32s>() + by as u32).bitcast()
    }

    #[inline(always)]
    fn place(steps: f64) -> Self {
        f32::from_bits((steps + ROUNDING).to_bits() as u32)
    }

    #[inline(always)]
    fn offset(steps: [f64; 3]) -> [f64; 3] {
        steps.map(f64::round)
    }

    #[inline(always)]
    fn moved(mut quad: Quad<Self>, [x, y, z]: [f64; 3], from: i32, to: i32) -> Quad<Self> {
        if from == 0 && to == 0 {
            for (value, offset) in quad.0.iter_mut().zip([x, y, z, 0.0]) {
                *value = f32::from_bits(value.to_bits().wrapping_add(offset as i32 as u32));
            }
        } else {
            for (value, offset) in quad.0.iter_mut().zip([x, y, z]) {
                let steps = f64::from(value.to_bits() as i32) * 2f64.powi(from) + offset;
                *value = Self::place(steps * 0.5f64.powi(to));
            }
        }
        quad
    }

    #[inline(always)]
    fn apart<S: Simd>(_simd: S, there: S::f32s, here: Self) -> S::f32s {
        S::f32s::float_from(there.bitcast::<S::i32s>() - here.to_bits() as i32)
    }

    #[inline(always)]
    fn accumulate<S: Simd>(sum: &mut S::f64s, value: S::f32s) {
        let (low, high) = value.widen();
        *sum += low + high;
    }

    runs!(Estimate);
}

impl Real for f64 {
    const EPSILON: f64 = f64::EPSILON;
    const TINY: f64 = 1e-200;
    const STEPS: f64 = f64::INFINITY;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    #[inline(always)]
    fn number(k: usize) -> Self {
        f64::from_bits(k as u64)
    }

    #[inline(always)]
    fn index(self) -> usize {
        self.to_bits() as usize
    }

    #[inline(always)]
    fn numbers<S: Simd>(simd: S, first: usize, stride: usize) -> S::f64s {
        let mut numbers = S::u64s::splat(simd, first as u64);
        for (l, number) in numbers.as_mut_slice().iter_mut().enumerate() {
            *number += (l * stride) as u64;
        }
        numbers.bitcast()
    }

    #[inline(always)]
    fn further<S: Simd>(numbers: S::f64s, by: usize) -> S::f64s {
        (numbers.bitcast::<S::u64s>() + by as u64).bitcast()
    }

    #[inline(always)]
    fn place(steps: f64) -> Self {
        steps
    }

    #[inline(always)]
    fn offset(steps: [f64; 3]) -> [f64; 3] {
        steps
    }

    #[inline(always)]
    fn moved(mut quad: Quad<Self>, [x, y, z]: [f64; 3], _from: i32, _to: i32) -> Quad<Self> {
        for (value, offset) in quad.0.iter_mut().zip([x, y, z]) {
            *value += offset;
        }
        quad
    }

    #[inline(always)]
    fn apart<S: Simd>(_simd: S, there: S::f64s, here: Self) -> S::f64s {
        there - here
    }

    #[inline(always)]
    fn accumulate<S: Simd>(sum: &mut S::f64s, value: S::f64s) {
        *sum += value;
    }

    runs!(Exact);
}
