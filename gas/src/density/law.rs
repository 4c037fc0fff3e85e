//! The condition on H, V_d H^d n = neighbours, and its solution.

use fearless_simd::{Simd, SimdBase, SimdFloat};

use crate::kernel::unit_sphere;
use crate::lanes::{Lanes, Machine, Real, load, same};
use crate::{Hydro, Kernel};

/// The solver for H gives up after this many evaluations.
const TRIES: usize = 100;

/// The condition on H.
pub struct Law {
    pub d: f64,
    pub wanted: f64,
    tolerance: f64,
    /// Of the kernel.
    pub norm: f64,
    /// Neighbour number by the sum of kernel values.
    weight: f64,
    /// What the particle itself counts too much in its density, a mass.
    pub excess: f64,
}

/// What became of the search for H within a radius.
pub enum Trial {
    Found(f64),
    /// The radius holds this many neighbours, fewer than wanted.
    Short(f64),
    Failed(f64),
}

impl Law {
    pub fn new<K: Kernel>(hydro: &Hydro) -> Self {
        let d = hydro.dimensions();
        let weight = unit_sphere(d) * K::norm(d);
        assert!(
            hydro.neighbours > weight * K::value(0.0),
            "more neighbours than the particle itself"
        );
        Self {
            d: d as f64,
            wanted: hydro.neighbours,
            tolerance: hydro.tolerance,
            norm: K::norm(d),
            weight,
            excess: K::self_excess(hydro.neighbours, d) * K::value(0.0),
        }
    }

    /// Sums over the distances `r` of w(q) and of -q dw/dq, at H = `reach`.
    #[inline(always)]
    fn sums<K: Kernel, S: Simd, E: Real, R: Machine<S, E>>(
        &self,
        simd: S,
        r: &[E],
        reach: f64,
    ) -> (f64, f64) {
        let inverse = same::<S, E>(simd, 1.0 / reach);
        let one = same::<S, E>(simd, 1.0);
        let mut value = same::<S, E>(simd, 0.0);
        let mut slope = value;
        for r in r.chunks_exact(Lanes::<S, E>::LEN) {
            let q = (load(simd, r, 0) * inverse).min(one);
            value += K::value(q);
            slope = (q * q).mul_add(-K::slope(q), slope);
        }
        (R::total(value), R::total(slope))
    }

    /// Newton's method in ln H for ln of the neighbour number, kept between bounds; the number grows with H.
    #[inline(always)]
    pub fn solve<K: Kernel, S: Simd, E: Real, R: Machine<S, E>>(
        &self,
        simd: S,
        r: &[E],
        start: f64,
        radius: f64,
    ) -> Trial {
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut reach = start.min(radius);
        for _ in 0..TRIES {
            let (value, slope) = self.sums::<K, S, E, R>(simd, r, reach);
            let number = self.weight * value;
            let excess = (number / self.wanted).ln();
            if excess >= 0.0 {
                high = reach;
            } else if reach >= radius {
                return Trial::Short(number);
            } else {
                low = reach;
            }
            let step = -excess * value / slope;
            if step.abs() <= self.tolerance || high - low <= self.tolerance * reach {
                return Trial::Found(reach);
            }
            let next = reach * step.clamp(-0.5, 0.5).exp();
            reach = if next > low && next < high {
                next.min(radius)
            } else {
                0.5 * (low + high.min(radius))
            };
        }
        Trial::Failed(reach)
    }
}
