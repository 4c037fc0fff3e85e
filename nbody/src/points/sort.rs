//! The order of particles in memory: along the Morton curve, so that near in space is near in memory.

use rayon::prelude::*;

use super::Vec3;

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
    pairs: Vec<(u64, u32)>,
}

impl Curve {
    /// Orders `x` along the Morton curve of `cube`; points of one cell keep their order.
    pub fn thread(&mut self, x: &[Vec3], cube: Cube) {
        assert!(x.len() < u32::MAX as usize, "particle numbers fit 32 bits");
        self.pairs.clear();
        self.pairs.par_extend(
            x.par_iter()
                .enumerate()
                .map(|(i, &p)| (cube.key(p), i as u32)),
        );
        self.pairs.par_sort_unstable();
        self.keys.clear();
        self.keys.extend(self.pairs.iter().map(|p| p.0));
        self.order.clear();
        self.order.extend(self.pairs.iter().map(|p| p.1));
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
