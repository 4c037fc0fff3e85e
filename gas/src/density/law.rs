//! The condition on H, V_d H^d n = neighbours, and its solution.

use fearless_simd::{Simd, SimdBase, SimdFloat};

use crate::kernel::unit_sphere;
use crate::lanes::{Lanes, Machine, Real, load, same};
use crate::{Formulation, Gradient, Hydro, KernelKind};

/// The solver for H gives up after this many evaluations.
const TRIES: usize = 100;

/// Bound of the error that a Newton step leaves by the step's square; from half the ratio of second to first derivative of ln n (ln H).
const NEWTON: f64 = 4.0;

/// ln x, without a call for x near one.
#[inline(always)]
fn logarithm(x: f64) -> f64 {
    let z = (x - 1.0) / (x + 1.0);
    let z2 = z * z;
    if z2 < 0.0025 {
        // The series of 2 artanh z; what is left out is below 1e-12.
        2.0 * z * (1.0 + z2 * (1.0 / 3.0 + z2 * (0.2 + z2 * (1.0 / 7.0 + z2 / 9.0))))
    } else {
        x.ln()
    }
}

/// exp x, without a call for x near zero; to 2e-8 there, which a next guess may be wrong by.
#[inline(always)]
fn exponential(x: f64) -> f64 {
    if x.abs() < 0.05 {
        1.0 + x * (1.0 + x * (0.5 + x * (1.0 / 6.0 + x / 24.0)))
    } else {
        x.exp()
    }
}

/// The condition on H.
pub struct Law {
    pub kernel: KernelKind,
    pub formulation: Formulation,
    /// Whether the sums follow H.
    pub grad_h: bool,
    /// Whether the velocity gradient is looked at as a whole, and whether it weighs neighbours by their contents, since forces do.
    pub wants_tensor: bool,
    pub weighs_contents: bool,
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
    pub fn new(hydro: &Hydro) -> Self {
        let (kernel, d) = (hydro.kernel, hydro.dimensions());
        let weight = unit_sphere(d) * kernel.norm(d);
        assert!(
            hydro.neighbours > weight * kernel.value(0.0),
            "more neighbours than the particle itself"
        );
        Self {
            kernel,
            formulation: hydro.formulation,
            grad_h: hydro.grad_h && hydro.gradient == Gradient::Standard,
            wants_tensor: hydro.wants_tensor(),
            weighs_contents: hydro.stressed() && !hydro.stress_by_mass(),
            d: d as f64,
            wanted: hydro.neighbours,
            tolerance: hydro.tolerance,
            norm: kernel.norm(d),
            weight,
            excess: kernel.self_excess(hydro.neighbours, d) * kernel.value(0.0),
        }
    }

    /// Sums over the distances `r` of w(q) and of -q dw/dq, at H = `reach`.
    #[inline(always)]
    fn sums<S: Simd, E: Real, R: Machine<S, E>>(&self, simd: S, r: &[E], reach: f64) -> (f64, f64) {
        let inverse = same::<S, E>(simd, 1.0 / reach);
        let one = same::<S, E>(simd, 1.0);
        let mut value = same::<S, E>(simd, 0.0);
        let mut slope = value;
        for r in r.chunks_exact(Lanes::<S, E>::LEN) {
            let q = (load(simd, r, 0) * inverse).min(one);
            value += self.kernel.value(q);
            slope = (q * q).mul_add(-self.kernel.slope(q), slope);
        }
        (R::total(value), R::total(slope))
    }

    /// Newton's method in ln H for ln of the neighbour number, kept between bounds; the number grows with H.
    #[inline(always)]
    pub fn solve<S: Simd, E: Real, R: Machine<S, E>>(
        &self,
        simd: S,
        r: &[E],
        start: f64,
        radius: f64,
    ) -> Trial {
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut reach = start.min(radius);
        for _ in 0..TRIES {
            let (value, slope) = self.sums::<S, E, R>(simd, r, reach);
            let number = self.weight * value;
            let excess = logarithm(number / self.wanted);
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
            let next = reach * exponential(step.clamp(-0.5, 0.5));
            reach = if next > low && next < high {
                // The error that is left is of the order of the step's square.
                if NEWTON * step * step <= self.tolerance && next <= radius {
                    return Trial::Found(next);
                }
                next.min(radius)
            } else {
                0.5 * (low + high.min(radius))
            };
        }
        Trial::Failed(reach)
    }
}
