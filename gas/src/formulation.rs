//! Formulations: the sum over neighbours whose volumes the pressure works on.
//!
//! y_i = sum_j x_j W(r_ij, H_i),   V_i = x_i / y_i,   f_ij = 1 - g_i / x_j,   g_i = (S_x - d sum x_j w) / S as in [`crate::density`]
//! m_i dv_i/dt = -sum_j x_i x_j [ f_ij P_i/y_i^2 grad W(r, H_i) + f_ji P_j/y_j^2 grad W(r, H_j) ]
//!
//! density:   x = m,                      y = rho, P from rho and u
//! pressure:  x = m P(rho, u)^zeta / rho, y = P^zeta: a step of density at equal pressure is no step of y; zeta = 1 unless set, less for shocks;
//!            of gas that is not ideal P / rho follows from y, see [`crate::eos`]
//! number:    x = 1,                      y = n = rho / m, P from rho and u: neighbours of other mass are no denser for it
//! smoothed:  x = m,                      y = rho, P = sum_j m_j (P/rho)_j W, as if u had been averaged
//!
//! The work that goes with y counts x as constant: energy is exact pair by pair, entropy to the order of the sums. Where
//! x = 0 all around, there is no pressure and no push. Without grad-h terms all g are zero, as in the first publications.
//! Sources: Saitoh & Makino (2013), ApJ 768, 44 (pressure, zeta in section 5); Hopkins (2013), MNRAS 428, 2840, eqs. 11 to 21 (grad-h
//! terms); Ott & Schnetter (2003), physics/0303112 (number); Makino (2013, lecture slides; smoothed).

use fearless_simd::{Select, Simd, SimdBase};

use crate::lanes::{Lanes, Machine, Real, same};

/// The formulation of a scene: in loops over pairs a branch that is always the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Formulation {
    #[default]
    Density,
    Pressure,
    Number,
    Smoothed,
}

/// P / rho below which gas pushes nobody, in units of a sweep: far below the rounding of its speeds squared.
const LEAST: f64 = 1e-26;

impl Formulation {
    pub const ALL: [Self; 4] = [Self::Density, Self::Pressure, Self::Number, Self::Smoothed];

    /// x of a particle of mass `m`, specific pressure `p_by_rho` and density `rho`; zeta is `exponent`.
    #[inline(always)]
    pub(crate) fn content(self, m: f64, p_by_rho: f64, rho: f64, exponent: f64) -> f64 {
        match self {
            Self::Density | Self::Smoothed => m,
            Self::Pressure if exponent == 1.0 => m * p_by_rho,
            Self::Pressure => m * (p_by_rho * rho).powf(exponent) / rho,
            Self::Number => 1.0,
        }
    }

    /// What is summed beside the mass: x, or what an average is taken of.
    #[inline(always)]
    pub(crate) fn summand(self, m: f64, p_by_rho: f64, rho: f64, exponent: f64) -> f64 {
        match self {
            Self::Smoothed => m * p_by_rho,
            _ => self.content(m, p_by_rho, rho, exponent),
        }
    }

    /// y of a particle.
    #[inline(always)]
    pub(crate) fn sum(self, m: f64, p_by_rho: f64, rho: f64, exponent: f64) -> f64 {
        match self {
            Self::Density | Self::Smoothed => rho,
            Self::Pressure => (p_by_rho * rho).powf(exponent),
            Self::Number => rho / m,
        }
    }

    /// P / y^2 of a particle, in units of a sweep.
    #[inline(always)]
    pub(crate) fn push(self, m: f64, p_by_rho: f64, rho: f64, exponent: f64) -> f64 {
        match self {
            Self::Density | Self::Smoothed => p_by_rho / rho,
            Self::Pressure if p_by_rho <= LEAST => 0.0,
            Self::Pressure if exponent == 1.0 => 1.0 / (p_by_rho * rho),
            Self::Pressure => (p_by_rho * rho).powf(1.0 - 2.0 * exponent),
            Self::Number => p_by_rho * m * m / rho,
        }
    }
}

impl Formulation {
    /// Whether y is the density.
    #[inline(always)]
    pub(crate) fn sums_mass(self) -> bool {
        matches!(self, Self::Density | Self::Smoothed)
    }

    /// Whether something is summed beside the mass.
    #[inline(always)]
    pub(crate) fn sums_more(self) -> bool {
        self != Self::Density
    }

    /// Whether the pressure is summed, and is not that of density and energy.
    pub(crate) fn sums_pressure(self) -> bool {
        matches!(self, Self::Pressure | Self::Smoothed)
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
            Self::Density | Self::Smoothed => m,
            Self::Pressure => m * (cs * cs) * same::<S, E>(simd, factor),
            Self::Number => same::<S, E>(simd, 1.0),
        }
    }

    /// P, where P / y^2 times `scale` is `push`.
    #[inline(always)]
    pub(crate) fn pressure<S: Simd, E: Real, R: Machine<S, E>>(
        self,
        simd: S,
        push: Lanes<S, E>,
        scale: Lanes<S, E>,
        (m, rho): (Lanes<S, E>, Lanes<S, E>),
    ) -> Lanes<S, E> {
        match self {
            Self::Density | Self::Smoothed => (rho * rho) * (push * R::reciprocal(simd, scale)),
            Self::Number => (rho * rho) * (push * R::reciprocal(simd, m * m * scale)),
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
