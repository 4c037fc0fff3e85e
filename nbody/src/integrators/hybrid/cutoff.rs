//! Individual cut-off radii: how far around a body its forces belong to the hard part.
//!
//! c = 1.15 max(hill r_H, crossing e v dt, 2.5 R/gamma), r_H = L (m/3M)^(1/3) the Hill radius, e v = e sqrt(G M/p) the random velocity, p the
//! semi-latus rectum, L = p on ellipses, twice the pericentre distance beyond. A body keeps its cut-off until it is below 0.9 or above 1.6
//! of that maximum: the map keeps its energy while cut-offs stay what they are. A pair's cut-off is the larger of two. Touching bodies
//! are always within the inner radius.
//! Measured (`examples/encounters.rs`, 100 steps a year, one thread, CPU s a year and end |dE/E|): disc N = 100, 100 yr: 0.008 and 2e-9;
//! N = 300: 0.05 and 9e-10; N = 1000: 0.44 and 2e-9; annulus N = 1e4, 1.1 yr: 1.9 and 1.7e-9, by 200 steps 3.3 and 4e-10; N = 1e5, 0.1 yr: 29 and
//! 7e-11. Crossings 0 to 3 differ by less than noise.
//! 2 Hill radii: annulus 5e-10, but after a deep encounter at 105 steps an orbit places are 12 times worse.
//! Source: Ishigaki, Kominami, Makino, Fujimoto & Iwasawa (2021), section 2.2, for individual radii.

use rayon::prelude::*;

use super::changeover::INNER;
use crate::bodies::Bodies;
use crate::points::Vec3;
use crate::points::sum::CHUNK;

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
    /// The cut-off of a body of mass `m` and radius `radius` at `q` from the star, moving with `u`, that had the cut-off `old` or none yet
    /// (zero).
    #[inline]
    pub fn radius(&self, centre: &Centre, [m, radius, old]: [f64; 3], (q, u): (Vec3, Vec3)) -> f64 {
        let Centre { mu, g, dt } = *centre;
        let p = q.cross(&u).norm_squared() / mu;
        let beta = 2.0 * mu / q.norm() - u.norm_squared();
        let e2 = (1.0 - p * beta / mu).max(0.0);
        let length = p * (2.0 / (1.0 + e2.sqrt())).min(1.0);
        let hill = self.hill * length * (g * m / (3.0 * mu)).cbrt();
        let path = self.crossing * dt.abs() * (e2 * mu / p).sqrt();
        // Without angular momentum about the star there is no such path.
        let path = if path.is_finite() { path } else { 0.0 };
        let least = hill.max(path).max(CONTACT / INNER * radius);
        if SHORT * least <= old && old <= LONG * least {
            old
        } else {
            MARGIN * least
        }
    }
}

/// A new cut-off, and the shortest and longest that a body keeps, in units of what is needed.
const MARGIN: f64 = 1.15;
const SHORT: f64 = 0.9;
const LONG: f64 = 1.6;

/// Cut-offs, in place of the old ones or of zeros, of bodies about the place and velocity `about`.
pub fn choose(
    cutoff: &Cutoff,
    centre: &Centre,
    bodies: &Bodies,
    about: (Vec3, Vec3),
    cutoffs: &mut [f64],
) {
    let one = |(i, c): (usize, &mut f64)| {
        let state = (bodies.x[i] - about.0, bodies.v[i] - about.1);
        *c = cutoff.radius(centre, [bodies.m[i], bodies.radius[i], *c], state);
    };
    if cutoffs.len() <= CHUNK {
        cutoffs.iter_mut().enumerate().for_each(one);
    } else {
        let all = cutoffs.par_iter_mut().enumerate();
        all.with_min_len(CHUNK).for_each(one);
    }
}

/// Twice the median of `cutoffs`: pairs within are to be exact in a field that is softened afterwards.
pub fn typical(cutoffs: &[f64]) -> f64 {
    let mut some: Vec<f64> = cutoffs
        .iter()
        .step_by(1 + cutoffs.len() / 1000)
        .copied()
        .collect();
    if some.is_empty() {
        return 0.0;
    }
    let middle = some.len() / 2;
    2.0 * *some.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cutoff_is_kept_while_it_is_about_right() {
        let centre = Centre {
            mu: 1.0,
            g: 1.0,
            dt: 0.01,
        };
        let circular = (Vec3::x(), Vec3::y());
        let of = |m: f64, old| Cutoff::default().radius(&centre, [m, 0.0, old], circular);
        let fresh = of(3e-6, 0.0);
        assert!((fresh / 0.0345 - 1.0).abs() < 1e-12);
        assert_eq!(of(4e-6, fresh), fresh);
        assert_eq!(of(7e-6, fresh), of(7e-6, 0.0));
        assert_eq!(of(1e-6, fresh), of(1e-6, 0.0));
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
        let of = |m, radius, state| cutoff.radius(&centre, [m, radius, 0.0], state);
        // Hill: (2e-3/3)^(1/3) of the distance 1 for a mass of 2e-3 about 2... in units G M = 4.
        let hill = 3.0 * (2.0 * 6e-3 / 12.0f64).cbrt();
        assert_eq!(of(6e-3, 0.0, circular), MARGIN * hill);
        assert_eq!(of(0.0, 0.01, circular), MARGIN * 0.25);
        // e = 0.44 at the pericentre of a body 1.2 times as fast as a circular orbit: p = 1.44.
        let path = 2.0 * 0.01 * 0.44 * (4.0 / 1.44f64).sqrt();
        let fast = of(0.0, 0.0, (Vec3::x(), Vec3::y() * 2.4));
        assert!((fast / (MARGIN * path) - 1.0).abs() < 1e-12);
        assert_eq!(of(0.0, 0.0, (Vec3::x(), Vec3::x())), 0.0);
    }
}
