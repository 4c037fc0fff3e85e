//! Stiffened gas: a liquid or solid that is compressed a little.
//!
//! P = (gamma - 1) rho u - gamma p_0,   c_s^2 = gamma (P + p_0) / rho = gamma (gamma - 1) (u - p_0 / rho)
//! Limit: tension below P = -p_0 has no state; without tension and cold it is as hard as with.
//! Source: Harlow & Amsden (1971), LA-4700; Menikoff & Plohr (1989), Rev. Mod. Phys. 61, 75.

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffened {
    pub gamma: f64,
    /// p_0
    pub pressure: f64,
}

impl Stiffened {
    /// P(rho, u).
    #[inline]
    pub fn pressure(&self, rho: f64, u: f64) -> f64 {
        (self.gamma - 1.0) * rho * u - self.gamma * self.pressure
    }

    /// c_s(rho, u), adiabatic.
    #[inline]
    pub fn sound_speed(&self, rho: f64, u: f64) -> f64 {
        (self.gamma * (self.gamma - 1.0) * (u - self.pressure / rho)).sqrt()
    }

    /// u at the pressure `p`.
    #[inline]
    pub fn energy(&self, rho: f64, p: f64) -> f64 {
        (p + self.gamma * self.pressure) / ((self.gamma - 1.0) * rho)
    }
}
