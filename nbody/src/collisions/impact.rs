//! An impact: two bodies at their first touch, as seen from their centre of mass.
//!
//! At the end of the step the second is at d from the first and goes with w. The line of centres at the touch, n, is that of the straight path
//! back; there the tangential speed is |d x w|/R, R = R_1 + R_2, and the speed is that of the pair's energy: v^2 = w^2 + 2 (G M/R - psi(d)), with
//! psi(r) = G M/sqrt(r^2 + eps^2) the pull that the run has between them. So angular momentum and energy are those of the run, and
//! a softened pair hits as fast as an unsoftened one. Bodies in one place touch along their relative velocity.
//! Ways out begin at the touch and end where the step does, on the same sums of energy and angular momentum.

use crate::bodies::{Bodies, Kind};
use crate::encounters::Encounter;
use crate::points::{Domain, Vec3};

/// The potential that bodies have between them in the run, by mass: psi(r), positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bond {
    /// Zero if the run has no pull between them.
    pub g: f64,
    pub softening2: f64,
}

impl Bond {
    /// psi at a distance; in one place without softening it is taken at `least`.
    pub fn depth(&self, mass: f64, distance: f64, least: f64) -> f64 {
        let r2 = distance * distance + self.softening2;
        let r = if r2 > 0.0 { r2.sqrt() } else { least };
        self.g * mass / r
    }
}

/// Two bodies that touched, the one that keeps its identity first.
#[derive(Clone, Copy, Debug)]
pub struct Impact {
    pub place: [usize; 2],
    pub g: f64,
    pub bond: Bond,
    /// Between two pieces, which are as soft as the softer of the two.
    pub piece_bond: Bond,
    pub m: [f64; 2],
    pub radius: [f64; 2],
    pub spin: [Vec3; 2],
    /// Separation and relative velocity of the second now.
    pub d: Vec3,
    pub w: Vec3,
    /// Line of centres at the touch, from the first to the second.
    pub n: Vec3,
    /// Time since the touch.
    pub since: f64,
}

/// Relative position and velocity of the second body.
pub type Way = (Vec3, Vec3);

impl Impact {
    pub fn of(bodies: &Bodies, place: [usize; 2], since: f64, field: &Field) -> Self {
        let [i, j] = place;
        let d = field.domain.nearest(bodies.x[j] - bodies.x[i]);
        let w = bodies.v[j] - bodies.v[i];
        let touch = d - w * since;
        let bond = field.bond(bodies, place);
        let softest = bodies.softening[i].max(bodies.softening[j]);
        let n = [touch, -w].into_iter().find_map(|n| n.try_normalize(0.0));
        Self {
            place,
            g: field.g,
            bond,
            piece_bond: Bond {
                softening2: 2.0 * softest * softest,
                ..bond
            },
            m: place.map(|k| bodies.m[k]),
            radius: place.map(|k| bodies.radius[k]),
            spin: place.map(|k| bodies.spin[k]),
            d,
            w,
            n: n.unwrap_or_else(Vec3::x),
            since,
        }
    }

    pub fn total(&self) -> f64 {
        self.m[0] + self.m[1]
    }

    /// The second's part of the mass; a half of nothing.
    pub fn share(&self) -> f64 {
        let total = self.total();
        if total > 0.0 { self.m[1] / total } else { 0.5 }
    }

    pub fn reduced(&self) -> f64 {
        self.m[0] * self.share()
    }

    pub fn reach(&self) -> f64 {
        self.radius[0] + self.radius[1]
    }

    /// Whether the bodies overlap but go apart already.
    pub fn recedes(&self) -> bool {
        self.n.dot(&self.w) > 0.0
    }

    /// Depth of the run's potential at a distance.
    pub fn depth(&self, distance: f64) -> f64 {
        self.bond.depth(self.total(), distance, self.reach())
    }

    /// Depth of the true potential at the touch, if the bodies pull each other.
    pub fn true_depth(&self) -> f64 {
        self.bond.g * self.total() / self.reach()
    }

    /// Speed at a touch where the potential has `depth`.
    fn speed_at(&self, depth: f64) -> f64 {
        let gained = depth - self.depth(self.d.norm());
        (self.w.norm_squared() + 2.0 * gained).max(0.0).sqrt()
    }

    /// Speed of the impact.
    pub fn speed(&self) -> f64 {
        self.speed_at(self.true_depth())
    }

    /// Escape speed at the touch, whether the run has the pull or not.
    pub fn escape(&self) -> f64 {
        (2.0 * self.g * self.total() / self.reach()).sqrt()
    }

    /// Sine of the angle between velocity and line of centres.
    pub fn sine(&self) -> f64 {
        let speed = self.speed();
        if speed > 0.0 {
            (self.tangential().norm() / speed).min(1.0)
        } else {
            0.0
        }
    }

    /// Velocity across the line of centres at the touch.
    pub fn tangential(&self) -> Vec3 {
        self.d.cross(&self.w).cross(&self.n) / self.reach()
    }

    /// Speed towards each other at the touch, in the run's own potential.
    pub fn approach(&self) -> f64 {
        let speed = self.speed_at(self.depth(self.reach()));
        let across = self.tangential().norm_squared();
        (speed * speed - across).max(0.0).sqrt()
    }

    /// Angular momentum about the centre of mass, spins included.
    pub fn angular_momentum(&self) -> Vec3 {
        self.d.cross(&self.w) * self.reduced() + self.spin[0] + self.spin[1]
    }

    /// Kinetic and mutual potential energy about the centre of mass.
    pub fn energy(&self) -> f64 {
        self.reduced() * (0.5 * self.w.norm_squared() - self.depth(self.d.norm()))
    }

    /// The way out from the touch, where the potential has `depth`, at least `apart` from each other now. A pair that would have turned
    /// round before is left where it touched.
    pub fn way_out(&self, normal: f64, tangential: Vec3, depth: f64, apart: f64) -> Way {
        let start = self.n * normal + tangential;
        let path = self.n * self.reach() + start * self.since;
        let distance = path.norm().max(apart);
        let across = tangential.norm() * self.reach() / distance;
        let speed2 = start.norm_squared() + 2.0 * (self.depth(distance) - depth);
        let outwards2 = speed2 - across * across;
        if outwards2 < 0.0 || outwards2.is_nan() {
            return (self.n * self.reach().max(apart), start);
        }
        let line = path.normalize();
        let side = self.n.cross(&tangential).cross(&line);
        let side = side.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
        (line * distance, line * outwards2.sqrt() + side * across)
    }
}

/// The space and the forces that bodies touch in.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    pub domain: Domain,
    pub g: f64,
    /// Whether planetesimals pull each other in the run; planets always pull.
    pub self_gravity: bool,
    /// End of the step.
    pub now: f64,
}

impl Field {
    pub fn bond(&self, bodies: &Bodies, place: [usize; 2]) -> Bond {
        let planet = place.iter().any(|&i| bodies.kind[i] == Kind::Planet as u32);
        Bond {
            g: if planet || self.self_gravity {
                self.g
            } else {
                0.0
            },
            softening2: place.iter().map(|&i| bodies.softening[i].powi(2)).sum(),
        }
    }
}

/// The impact of a due encounter; `kept` first.
pub fn impact(bodies: &Bodies, encounter: Encounter, field: &Field) -> Impact {
    let [i, j] = encounter.pair;
    let place = if super::outranks(bodies, i, j) {
        [i, j]
    } else {
        [j, i]
    };
    Impact::of(bodies, place, -(encounter.time + encounter.held), field)
}
