//! Artificial conduction: heat that flows between particles of different energy where their pressures differ.
//!
//! du_i/dt = sum_j m_j alpha_u v_sig_u / rho_ij (u_i - u_j) F_ij,   v_sig_u = sqrt(|P_i - P_j| / rho_ij)
//!
//! with F_ij = dW/dr < 0 of the mean kernel and rho_ij the mean of the pair: heat goes from the hotter to the colder, as much as the one
//! loses the other gains, and none where the pressures agree. For ideal gas, of which u follows from c_s^2 by a constant factor.
//! Limit: the pressure of a hydrostatic gas differs from particle to particle too, and conduction levels its u.
//! Source: Price (2008), JCP 227, 10040, eqs. 8, 26 and 28.

use fearless_simd::{Simd, SimdBase};

use crate::lanes::{Lanes, Machine, Real, same};

/// How strongly gas conducts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conduction {
    /// alpha_u; none if zero.
    pub alpha: f64,
}

impl Conduction {
    pub const NONE: Self = Self { alpha: 0.0 };
}

/// What both particles of a pair make the same of, or change the sign of alone.
pub struct Contrast<S: Simd, E: Real> {
    /// u of the one less that of the other, or their c_s^2.
    pub u: Lanes<S, E>,
    /// Difference of the pressures.
    pub p: Lanes<S, E>,
    /// 1 / rho_ij
    pub volume: Lanes<S, E>,
}

impl<S: Simd, E: Real> Contrast<S, E> {
    /// alpha_u v_sig_u (u_i - u_j) / rho_ij, where `strength` is alpha_u, times u by c_s^2 where that stands for u.
    #[inline(always)]
    pub fn flux<R: Machine<S, E>>(&self, simd: S, strength: f64) -> Lanes<S, E> {
        let v2 = self.p.abs() * self.volume;
        let tiny = same::<S, E>(simd, E::TINY);
        let v_sig = v2 * R::inverse_root(simd, v2.max(tiny));
        v_sig * (self.u * (self.volume * same::<S, E>(simd, strength)))
    }
}
