//! Formulations: the sum over neighbours whose volumes the pressure works on.
//!
//! y_i = sum_j x_j W(r_ij, H_i),   V_i = x_i / y_i,   f_ij = 1 - g_i / x_j,   g_i = (S_x - d sum x_j w) / S as in [`crate::density`]
//! m_i dv_i/dt = -sum_j x_i x_j [ f_ij P_i/y_i^2 grad W(r, H_i) + f_ji P_j/y_j^2 grad W(r, H_j) ]
//!
//! density:   x = m,          y = rho, P from rho and u
//! pressure:  x = m P/rho(u), y = P: a step of density at equal pressure is no step of y
//!
//! The work that goes with y counts x as constant: energy is exact pair by pair, entropy to the order of the sums. Where
//! x = 0 all around, there is no pressure and no push. P/rho follows from c_s^2 by a constant factor, so that x takes no room beside c_s.
//! Sources: Saitoh & Makino (2013), ApJ 768, 44; Hopkins (2013), MNRAS 428, 2840, eqs. 11 to 21 (grad-h terms).

use fearless_simd::{Select, Simd, SimdBase};

use crate::lanes::{Lanes, Machine, Real, same};

/// The formulation of a scene: in loops over pairs a branch that is always the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    #[default]
    Density,
    Pressure,
}

/// P / rho below which gas pushes nobody, in units of a sweep: far below the rounding of its speeds squared.
const LEAST: f64 = 1e-26;

impl Formulation {
    /// x of a particle of mass `m` and specific pressure `p_by_rho`.
    #[inline(always)]
    pub(crate) fn content(self, m: f64, p_by_rho: f64) -> f64 {
        match self {
            Self::Density => m,
            Self::Pressure => m * p_by_rho,
        }
    }

    /// P / y^2 of a particle of specific pressure `p_by_rho` and density `rho`, in units of a sweep.
    #[inline(always)]
    pub(crate) fn push(self, p_by_rho: f64, rho: f64) -> f64 {
        match self {
            Self::Density => p_by_rho / rho,
            Self::Pressure if p_by_rho > LEAST => 1.0 / (p_by_rho * rho),
            Self::Pressure => 0.0,
        }
    }
}

impl Formulation {
    /// Whether y is the density.
    #[inline(always)]
    pub(crate) fn sums_mass(self) -> bool {
        self == Self::Density
    }

    /// x of particles of mass `m` and sound speed `cs`; P / rho is `factor` times its square.
    #[inline(always)]
    pub(crate) fn contents<S: Simd, E: Real>(
        self,
        simd: S,
        m: Lanes<S, E>,
        cs: Lanes<S, E>,
        factor: f64,
    ) -> Lanes<S, E> {
        match self {
            Self::Density => m,
            Self::Pressure => m * (cs * cs) * same::<S, E>(simd, factor),
        }
    }

    /// P, where P / y^2 times `scale` is `push`.
    #[inline(always)]
    pub(crate) fn pressure<S: Simd, E: Real, R: Machine<S, E>>(
        self,
        simd: S,
        push: Lanes<S, E>,
        scale: Lanes<S, E>,
        rho: Lanes<S, E>,
    ) -> Lanes<S, E> {
        match self {
            Self::Density => (rho * rho) * (push * R::reciprocal(simd, scale)),
            Self::Pressure => {
                let zero = same::<S, E>(simd, 0.0);
                let one = same::<S, E>(simd, 1.0);
                let pushes = push.simd_gt(zero);
                let p = scale * R::reciprocal(simd, pushes.select(push, one));
                pushes.select(p, zero)
            }
        }
    }
}

#[cfg(test)]
mod tests;
