//! Barotropic gas of a collapsing core: isothermal while thin, adiabatic where it has become opaque.
//!
//! P = c_0^2 rho [1 + (rho / rho_c)^(gamma - 1)],   c_s^2 = dP/drho = c_0^2 [1 + gamma (rho / rho_c)^(gamma - 1)]
//! u = P / ((gamma - 1) rho): what the gas holds by its temperature. Above rho_c work stays in it, below it is radiated.
//! Limit: no gas of one density is hotter than other gas of the same, not even behind a shock.
//! Source: Larson (1969), MNRAS 145, 271; the sum of both limits: Commercon et al. (2008), A&A 482, 371.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Barotropic {
    /// c_0
    pub sound_speed: f64,
    /// rho_c
    pub critical_density: f64,
    pub gamma: f64,
}

impl Barotropic {
    /// (rho / rho_c)^(gamma - 1)
    #[inline]
    fn opacity(&self, rho: f64) -> f64 {
        (rho / self.critical_density).powf(self.gamma - 1.0)
    }

    /// P(rho).
    #[inline]
    pub fn pressure(&self, rho: f64) -> f64 {
        self.sound_speed * self.sound_speed * rho * (1.0 + self.opacity(rho))
    }

    /// c_s(rho).
    #[inline]
    pub fn sound_speed(&self, rho: f64) -> f64 {
        self.sound_speed * (1.0 + self.gamma * self.opacity(rho)).sqrt()
    }

    /// u(rho).
    #[inline]
    pub fn energy(&self, rho: f64) -> f64 {
        self.sound_speed * self.sound_speed * (1.0 + self.opacity(rho)) / (self.gamma - 1.0)
    }
}
