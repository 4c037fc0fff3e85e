//! The order of particles in memory: along the Morton curve, so that near in space is near in memory.

use rayon::prelude::*;

use super::Vec3;
use super::sum::{CHUNK, Parts};

/// Bits an axis of a Morton key.
pub const BITS: u32 = 21;

/// The cube that keys are counted in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cube {
    pub corner: Vec3,
    pub side: f64,
}

impl Cube {
    /// The smallest cube that holds all finite positions, a little widened. Never of zero side.
    pub fn around(x: &[Vec3]) -> Self {
        let (lo, hi) = bounds(x);
        let side = (hi - lo).max();
        let side = if side.is_finite() && side > 0.0 {
            side * (1.0 + 1e-9)
        } else {
            1.0
        };
        let corner = if lo.x.is_finite() { lo } else { Vec3::zeros() };
        Self { corner, side }
    }

    /// Morton key of a position: 21 bits an axis, x lowest. Positions outside land on the nearest cell.
    pub fn key(&self, x: Vec3) -> u64 {
        let cells = f64::from(1u32 << BITS);
        let cell = |axis: usize| {
            ((x[axis] - self.corner[axis]) / self.side * cells).clamp(0.0, cells - 1.0) as u64
        };
        spread(cell(0)) | spread(cell(1)) << 1 | spread(cell(2)) << 2
    }
}

/// Lower and upper corner of the box around all positions.
pub fn bounds(x: &[Vec3]) -> (Vec3, Vec3) {
    let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    x.par_chunks(super::sum::CHUNK)
        .map(|part| {
            part.iter()
                .fold(empty, |(lo, hi), p| (lo.inf(p), hi.sup(p)))
        })
        .reduce(|| empty, |a, b| (a.0.inf(&b.0), a.1.sup(&b.1)))
}

/// Places the bits of the lowest 21 three apart.
fn spread(v: u64) -> u64 {
    let mut v = v & 0x1f_ffff;
    v = (v | v << 32) & 0x001f_0000_0000_ffff;
    v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// The curve through a set of points: sorted keys, and the place that each point of the curve had before.
#[derive(Clone, Debug, Default)]
pub struct Curve {
    /// Morton keys, ascending.
    pub keys: Vec<u64>,
    /// `order[i]`: where the i-th point along the curve is in the unsorted set.
    pub order: Vec<u32>,
    pairs: Vec<Pair>,
    spare: Vec<Pair>,
    counts: Vec<[u32; BUCKETS]>,
}

/// A key and whose it is.
type Pair = (u64, u32);

/// Bits that one pass of the sort looks at.
const DIGIT: u32 = 11;
const BUCKETS: usize = 1 << DIGIT;
/// Passes, over the highest bits; what is alike in those is compared.
const PASSES: u32 = 4;
/// Bits below those that the passes look at.
const REST: u32 = 3 * BITS - PASSES * DIGIT;
/// Pairs that one task moves.
const SHARE: usize = 1 << 15;
/// Fewer than this many pairs are compared.
const FEW: usize = 1 << 11;
/// More pairs than this are worth more as free memory than the time that it takes to get it again.
pub const MANY: usize = 1 << 18;

impl Curve {
    /// Orders `x` along the Morton curve of `cube`; points of one cell keep their order.
    pub fn thread(&mut self, x: &[Vec3], cube: Cube) {
        assert!(x.len() < u32::MAX as usize, "particle numbers fit 32 bits");
        x.par_iter()
            .enumerate()
            .with_min_len(CHUNK)
            .map(|(i, &p)| (cube.key(p), i as u32))
            .collect_into_vec(&mut self.pairs);
        if x.len() < FEW {
            self.pairs.sort_unstable();
        } else {
            for pass in 0..PASSES {
                self.pass(REST + pass * DIGIT);
            }
            self.pairs
                .chunk_by_mut(|a, b| a.0 >> REST == b.0 >> REST)
                .filter(|alike| alike.len() > 1)
                .for_each(<[Pair]>::sort_unstable);
        }
        let pairs = self.pairs.par_iter().with_min_len(CHUNK);
        pairs.clone().map(|p| p.0).collect_into_vec(&mut self.keys);
        pairs.map(|p| p.1).collect_into_vec(&mut self.order);
        if self.pairs.len() > MANY {
            (self.pairs, self.spare) = (Vec::new(), Vec::new());
        }
    }

    /// Sorts the pairs by the digit above the lowest `shift` bits and leaves those alike in their order, a counting sort.
    fn pass(&mut self, shift: u32) {
        let digit = |pair: &Pair| (pair.0 >> shift) as usize % BUCKETS;
        self.pairs
            .par_chunks(SHARE)
            .map(|share| {
                let mut counts = [0; BUCKETS];
                for pair in share {
                    counts[digit(pair)] += 1;
                }
                counts
            })
            .collect_into_vec(&mut self.counts);
        let mut sum = 0;
        for bucket in 0..BUCKETS {
            for counts in &mut self.counts {
                let count = std::mem::replace(&mut counts[bucket], sum);
                sum += count;
            }
        }
        self.spare.resize(self.pairs.len(), (0, 0));
        let spare = Parts::new(&mut self.spare);
        self.pairs
            .par_chunks(SHARE)
            .zip(&mut self.counts)
            .for_each(|(share, places)| {
                for pair in share {
                    let place = &mut places[digit(pair)];
                    let k = *place as usize;
                    let own = k..k + 1;
                    // SAFETY: the counts give each pair a place of its own.
                    unsafe { spare.part(own)[0] = *pair };
                    *place += 1;
                }
            });
        std::mem::swap(&mut self.pairs, &mut self.spare);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_interleave_the_bits_of_the_axes() {
        let cube = Cube {
            corner: Vec3::zeros(),
            side: 1.0,
        };
        let slow = |x: Vec3| {
            let cell = |a: usize| (x[a] * f64::from(1 << BITS)) as u64;
            (0..BITS).fold(0u64, |key, bit| {
                (0..3).fold(key, |key, axis| {
                    key | (cell(axis) >> bit & 1) << (3 * bit + axis as u32)
                })
            })
        };
        for i in 0..1000 {
            let f = |k: f64| (f64::from(i) * k).fract();
            let x = Vec3::new(f(0.618_034), f(0.414_214), f(0.732_051));
            assert_eq!(cube.key(x), slow(x));
        }
    }

    #[test]
    fn many_points_are_threaded_as_by_comparison() {
        // On a line half of the bits are alike; in clumps the low ones decide; coincident points keep their order.
        let f = |i: u32, k: f64| (f64::from(i) * k).fract();
        let line = |i| Vec3::new(f(i, 0.618_034), 0.5, 0.5);
        let clumps =
            |i| Vec3::repeat(f64::from(i % 3)) + 1e-6 * Vec3::new(f(i, 0.4), f(i, 0.7), f(i, 0.3));
        let same = |_| Vec3::repeat(0.3);
        let n = 3 * SHARE as u32 + 17;
        for points in [&line as &dyn Fn(u32) -> Vec3, &clumps, &same] {
            let x: Vec<Vec3> = (0..n).map(points).collect();
            let cube = Cube::around(&x);
            let mut curve = Curve::default();
            curve.thread(&x, cube);
            let mut expected: Vec<u32> = (0..n).collect();
            expected.sort_by_key(|&i| cube.key(x[i as usize]));
            assert!(curve.order == expected);
        }
    }

    #[test]
    fn a_curve_is_a_sorted_permutation() {
        let x: Vec<Vec3> = (0..5000)
            .map(|i| {
                let f = |k: f64| (f64::from(i) * k).fract();
                Vec3::new(f(0.618_034), f(0.414_214), f(0.732_051))
            })
            .collect();
        let mut curve = Curve::default();
        curve.thread(&x, Cube::around(&x));
        assert!(curve.keys.is_sorted());
        let mut seen = curve.order.clone();
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, &o)| i == o as usize));
    }
}
