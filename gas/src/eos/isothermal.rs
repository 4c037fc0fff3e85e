//! Isothermal gas: P = c_s^2 rho, with c_s the same everywhere or c_0 (R / R_0)^-exponent, R the distance from the z axis through the star.
//!
//! It counts as holding u = c_s^2 / (gamma - 1), which its place dictates.

use nbody::points::Vec3;

/// The energy that goes with a sound speed.
#[inline]
pub fn energy(gamma: f64, sound_speed: f64) -> f64 {
    sound_speed * sound_speed / (gamma - 1.0)
}

/// c_s(u), isothermal.
#[inline]
pub fn sound_speed(gamma: f64, u: f64) -> f64 {
    ((gamma - 1.0) * u).sqrt()
}

/// The sound speed at `x` from the star, where it is `sound_speed` at `radius`.
#[inline]
pub fn power_law(sound_speed: f64, radius: f64, exponent: f64, x: Vec3) -> f64 {
    sound_speed * (x.xy().norm() / radius).powf(-exponent)
}
