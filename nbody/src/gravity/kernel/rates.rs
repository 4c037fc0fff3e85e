//! Rates of the kernels beside the processor's peak, measured in one run.
//!
//! `RAYON_NUM_THREADS=1 cargo test --release -p tridisk-nbody kernel_rates -- --ignored --nocapture`
//!
//! The peak is that of fused multiply-adds on registers alone, two operations a lane. Points take 25 operations a pair, quadrupoles 59,
//! with the reciprocal root counted as one; in f64 the series that sharpen it take four and six more.

use cpu_time::ThreadTime;
use fearless_simd::{Level, Simd, SimdBase, SimdFloat};
use std::hint::black_box;

use super::super::lanes::{Job, Lanes, Real};
use super::quadrupole::*;
use super::*;

/// Chains of multiply-adds that the peak is measured with: more than latency times throughput.
const CHAINS: usize = 12;
const TURNS: usize = 400_000;
/// Passes over a block in a turn, and turns.
const TIMES: usize = 40;
const ROUNDS: usize = 200;

/// Fused multiply-adds on registers: returns lanes times operations a turn.
struct Peak<'a, E> {
    factor: E,
    out: &'a mut [f64],
    operations: &'a mut f64,
}

impl<E: Real> Job<E> for Peak<'_, E> {
    #[inline(always)]
    fn run<S: Simd, R: Lanes<S, E>>(self, simd: S) {
        let factor = E::Native::<S>::splat(simd, self.factor);
        let mut chain = [factor; CHAINS];
        for _ in 0..TURNS {
            for value in &mut chain {
                *value = value.mul_add(factor, factor);
            }
        }
        for (out, value) in self.out.iter_mut().zip(chain) {
            *out = R::sum(value);
        }
        *self.operations = (2 * CHAINS * TURNS * E::Native::<S>::LEN) as f64;
    }
}

/// CPU seconds that `work` takes.
fn spent(work: impl FnOnce()) -> f64 {
    let start = ThreadTime::now();
    work();
    start.elapsed().as_secs_f64()
}

/// A block of points, or of quadrupoles, on 64 targets, many times over.
struct Often<'a, E> {
    targets: &'a Targets<E>,
    points: &'a Points<E>,
    quadrupoles: &'a Quadrupoles<E>,
    far: bool,
    times: usize,
    pulls: &'a mut [Pull],
    hits: &'a mut [u32],
}

impl<E: Real> Job<E> for Often<'_, E> {
    #[inline(always)]
    fn run<S: Simd, R: Lanes<S, E>>(self, simd: S) {
        let none = E::from_f64(0.0);
        for _ in 0..self.times {
            if self.far {
                let quadrupoles = black_box(self.quadrupoles);
                pull_of_quadrupoles::<S, E, R, false>(simd, self.targets, quadrupoles, self.pulls);
            } else {
                let points = black_box(self.points);
                pull_of_points::<S, E, R, false, false>(
                    simd,
                    self.targets,
                    points,
                    none,
                    self.pulls,
                    self.hits,
                );
            }
        }
    }
}

/// Some number between 0.1 and 1.1.
fn number(i: usize, column: usize) -> f64 {
    0.1 + ((i * 37 + column * 101) % 997) as f64 / 997.0
}

fn filled<E: Real, const C: usize>(n: usize) -> Block<E, C> {
    let mut block = Block::with_capacity(n);
    block.len = n;
    for (c, column) in block.columns.iter_mut().enumerate() {
        for (i, value) in column.iter_mut().enumerate() {
            *value = E::from_f64(number(i, c));
        }
    }
    block
}

/// Interactions and peak operations a second, in 1e9: the best of many short turns, taken alternately, since others use the processor too.
fn rates<E: Real>(level: Level, far: bool) -> [f64; 2] {
    let points = filled(POINTS);
    let batch = |b: usize| {
        std::array::from_fn(|c| std::array::from_fn(|i| E::from_f64(number(b * BATCH + i, c))))
    };
    let quadrupoles = Quadrupoles {
        batches: (0..QUADRUPOLES / BATCH).map(batch).collect(),
    };
    let targets = filled::<E, 4>(64);
    let mut pulls = [Pull::default(); 64];
    let (mut out, mut operations) = ([0.0; CHAINS], 0.0);
    let mut least = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        let kernel = spent(|| {
            let often = Often {
                targets: &targets,
                points: &points,
                quadrupoles: &quadrupoles,
                far,
                times: TIMES,
                pulls: &mut pulls,
                hits: &mut [0; 64],
            };
            E::run(level, often);
        });
        let peak = spent(|| {
            let peak = Peak {
                factor: black_box(E::from_f64(0.5)),
                out: &mut out,
                operations: &mut operations,
            };
            E::run(level, peak);
        });
        least = [least[0].min(kernel), least[1].min(peak)];
        black_box((&pulls, &out));
    }
    let sources = if far { QUADRUPOLES } else { POINTS };
    let interactions = (TIMES * sources * 64) as f64;
    [interactions / least[0] * 1e-9, operations / least[1] * 1e-9]
}

#[test]
#[ignore = "a measurement, for a quiet machine"]
fn kernel_rates() {
    let level = Level::new();
    println!(
        "| kernel | 1e9 interactions/s | of the peak | interactions per 1000 operations of the peak |"
    );
    println!("| --- | --- | --- | --- |");
    for (name, [rate, peak], operations) in [
        ("points, f32", rates::<f32>(level, false), 25.0),
        ("points, f64", rates::<f64>(level, false), 29.0),
        ("quadrupoles, f32", rates::<f32>(level, true), 59.0),
        ("quadrupoles, f64", rates::<f64>(level, true), 65.0),
    ] {
        let share = rate * operations / peak;
        println!(
            "| {name} | {rate:.2} | {share:.2} of {peak:.0} | {:.1} |",
            1e3 * rate / peak
        );
        assert!(share < 1.1, "no faster than the processor");
    }
}
