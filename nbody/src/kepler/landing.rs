//! Landing near the centre: a drift from far away that ends there gets back the energy and angular momentum that rounding has taken.
//!
//! There x' is the small difference of large terms, wrong by a rounding of r0, and mu/r' by (r0/r')^2 of that: an orbit of e = 1 - 1e-9 would
//! leave on another one, or for ever. The direction stays, r' and v' follow from h = x cross v and beta: v_t = h/r', v_r^2 = 2 mu/r' - beta - v_t^2.

use crate::points::Vec3;

/// Distance from the centre, by that of the start, below which an end is a landing: above it the energy is wrong by 1e-12 at most.
pub const NEAR: f64 = 0.01;

/// What a drift keeps.
pub struct Constants {
    pub mu: f64,
    /// 2 mu/r - v^2
    pub beta: f64,
    /// x cross v
    pub h: Vec3,
}

impl Constants {
    /// The state of this orbit next to `x`, `v`.
    pub fn state(&self, x: Vec3, v: Vec3) -> (Vec3, Vec3) {
        let square = self.h.norm_squared();
        let aside = match square {
            0.0 => Vec3::zeros(),
            _ => self.h * (x.dot(&self.h) / square),
        };
        let flat = x - aside;
        let distance = flat.norm();
        let q = self.pericentre(square);
        let r = distance.max(q);
        if distance == 0.0 || r == 0.0 {
            return (x, v);
        }
        let outwards = flat / distance;
        let inwards = (2.0 * self.mu / r - self.beta) - square / (r * r);
        let speed = inwards.max(0.0).sqrt().copysign(outwards.dot(&v));
        (outwards * r, outwards * speed + self.h.cross(&outwards) / r)
    }

    fn pericentre(&self, square: f64) -> f64 {
        let e2 = 1.0 - square * self.beta / (self.mu * self.mu);
        square / (self.mu * (1.0 + e2.max(0.0).sqrt()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kepler::drift;

    #[test]
    fn an_orbit_that_ends_a_step_at_its_pericentre_stays_the_same() {
        for rest in [1e-4, 1e-6, 1e-9] {
            let start = Vec3::new(2.0 - rest, 0.0, 0.0);
            let (mut x, mut v) = (start, Vec3::new(0.0, (rest / (2.0 - rest)).sqrt(), 0.0));
            let period = std::f64::consts::TAU;
            for _ in 0..10 {
                for _ in 0..100 {
                    drift(1.0, 0.01 * period, &mut x, &mut v).expect("an orbit");
                }
                // An energy of the size 1/q, rounded once an orbit at the pericentre, changes the period by so much.
                let bar = 1e-15 / rest;
                let energy = 0.5 * v.norm_squared() - 1.0 / x.norm();
                assert!((energy + 0.5).abs() < 20.0 * bar, "{rest:e}: {energy}");
                assert!((x - start).norm() < 1e-5, "{rest:e}: {x}");
            }
        }
    }
}
