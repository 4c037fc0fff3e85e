//! Ideal gas: P = (gamma - 1) rho u, c_s^2 = gamma P / rho = gamma (gamma - 1) u.

/// P(rho, u).
#[inline]
pub fn pressure(gamma: f64, rho: f64, u: f64) -> f64 {
    (gamma - 1.0) * rho * u
}

/// The adiabatic sound speed.
#[inline]
pub fn sound_speed(gamma: f64, u: f64) -> f64 {
    (gamma * (gamma - 1.0) * u).sqrt()
}
