//! Individual cut-off radii: how far around a body its forces belong to the hard part.
//!
//! c = max(hill r_H, crossing e v dt, 2.5 R/gamma), r_H = p (m/3M)^(1/3) the Hill radius, e v = e sqrt(G M/p) the random velocity, p the
//! semi-latus rectum: constants of the orbit, rounded up to two bits, so that a cut-off stays what it is while perturbations are
//! small. A pair's cut-off is the larger of two. Touching bodies are always within the inner radius.
//! Measured with the defaults by `examples/encounters.rs`, 100 steps a year, one thread, CPU s a year and end |dE/E|: disc N = 100,
//! 100 yr: 0.008, 2e-9; N = 300: 0.07, 2e-9; N = 1000, 10 yr: 0.58, 8e-9; annulus N = 1e4, 1.1 yr: 2.5, 3e-9. Crossings 0 to 3 and the
//! disc's 2 to 5 Hill radii differ without order. 2 Hill radii: annulus 5e-10, but places after a deep encounter at 105 steps an orbit
//! are 12 times worse.
//! Source: Ishigaki, Kominami, Makino, Fujimoto & Iwasawa (2021), section 2.2, for individual radii.

use super::changeover::INNER;
use crate::points::Vec3;

/// How cut-off radii are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutoff {
    /// In Hill radii.
    pub hill: f64,
    /// In paths that a body's random velocity takes it in a step.
    pub crossing: f64,
}

/// Defaults by the energy error against cost of `examples/encounters.rs`.
impl Default for Cutoff {
    fn default() -> Self {
        Self {
            hill: 3.0,
            crossing: 1.0,
        }
    }
}

/// Radii of contact in units of the sum of two radii, at which the hard part must be whole.
const CONTACT: f64 = 2.5;

/// What the cut-offs of one step depend on.
#[derive(Clone, Copy, Debug)]
pub struct Centre {
    /// G times the star's mass.
    pub mu: f64,
    pub g: f64,
    pub dt: f64,
}

impl Cutoff {
    /// The cut-off of a body of mass `m` and radius `radius` at `q` from the star, moving with `u`.
    #[inline]
    pub fn radius(&self, centre: &Centre, m: f64, radius: f64, (q, u): (Vec3, Vec3)) -> f64 {
        let Centre { mu, g, dt } = *centre;
        let p = q.cross(&u).norm_squared() / mu;
        let beta = 2.0 * mu / q.norm() - u.norm_squared();
        let e2 = (1.0 - p * beta / mu).max(0.0);
        let hill = self.hill * p * (g * m / (3.0 * mu)).cbrt();
        let path = self.crossing * dt.abs() * (e2 * mu / p).sqrt();
        // Without angular momentum about the star there is no such path.
        let path = if path.is_finite() { path } else { 0.0 };
        rounded_up(hill.max(path).max(CONTACT / INNER * radius))
    }
}

/// The next number with two bits after the leading one.
fn rounded_up(value: f64) -> f64 {
    const REST: u64 = (1 << 50) - 1;
    f64::from_bits((value.to_bits() + REST) & !REST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_goes_up_by_at_most_a_quarter() {
        for k in 1..1000 {
            let value = f64::from(k) * 0.0137;
            let up = rounded_up(value);
            assert!(up >= value && up <= 1.25 * value);
            assert_eq!(rounded_up(up), up);
        }
        assert_eq!(rounded_up(0.0), 0.0);
    }

    #[test]
    fn the_cutoff_is_the_largest_of_three() {
        let centre = Centre {
            mu: 4.0,
            g: 2.0,
            dt: 0.01,
        };
        let cutoff = Cutoff {
            hill: 3.0,
            crossing: 2.0,
        };
        let circular = (Vec3::x(), Vec3::y() * 2.0);
        let of = |m, radius, state| cutoff.radius(&centre, m, radius, state);
        // Hill: (2e-3/3)^(1/3) of the distance 1 for a mass of 2e-3 about 2... in units G M = 4.
        let hill = 3.0 * (2.0 * 6e-3 / 12.0f64).cbrt();
        assert_eq!(of(6e-3, 0.0, circular), rounded_up(hill));
        assert_eq!(of(0.0, 0.01, circular), rounded_up(0.25));
        // e = 0.44 at the pericentre of a body 1.2 times as fast as a circular orbit: p = 1.44.
        let path = 2.0 * 0.01 * 0.44 * (4.0 / 1.44f64).sqrt();
        let fast = of(0.0, 0.0, (Vec3::x(), Vec3::y() * 2.4));
        assert!((fast / rounded_up(path) - 1.0).abs() < 1e-12);
        assert_eq!(of(0.0, 0.0, (Vec3::x(), Vec3::x())), 0.0);
    }
}
