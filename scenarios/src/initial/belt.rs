//! Bodies on Kepler orbits: a belt of planetesimals, and planets given by elements.
//!
//! Semi-major axes follow a surface density ~ a^slope; eccentricities and inclinations are Rayleigh distributed with the given rms
//! (x = rms sqrt(-ln u)); angles are uniform. Elements are heliocentric: the orbit of mu = G (M + m) about the star.

use std::f64::consts::PI;

pub use nbody::orbit::Elements;
use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Vec3};
use nbody::{Bodies, Kind};
use rand::{Rng, RngExt};

/// What bodies go around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Centre {
    pub x: Vec3,
    pub v: Vec3,
    pub mass: f64,
    pub g: f64,
}

/// What a body is but for its orbit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    pub kind: Kind,
    pub mass: f64,
    pub radius: f64,
    /// Of a body without mass; zero for the others.
    pub density: f64,
    pub softening: f64,
}

/// Radius of a sphere; zero for a body without a density, which has no size.
pub fn radius(mass: f64, density: f64) -> f64 {
    if density == 0.0 {
        return 0.0;
    }
    (3.0 * mass / (4.0 * PI * density)).cbrt()
}

/// Adds a body with position and velocity given.
pub fn place(bodies: &mut Bodies, id: u64, body: Body, (x, v): (Vec3, Vec3)) {
    let n = bodies.len();
    bodies.resize(n + 1);
    set(bodies, n, id, body, (x, v));
}

fn set(bodies: &mut Bodies, i: usize, id: u64, body: Body, (x, v): (Vec3, Vec3)) {
    bodies.id[i] = id;
    bodies.x[i] = x;
    bodies.v[i] = v;
    bodies.m[i] = body.mass;
    bodies.radius[i] = body.radius;
    if body.density > 0.0 {
        bodies.density.resize(bodies.x.len(), 0.0);
        bodies.density[i] = body.density;
    }
    bodies.softening[i] = body.softening;
    bodies.kind[i] = body.kind as u32;
}

/// Adds a body on an orbit about `centre`.
pub fn orbit(bodies: &mut Bodies, id: u64, body: Body, elements: &Elements, centre: &Centre) {
    let (x, v) = elements.state(centre.g * (centre.mass + body.mass));
    place(bodies, id, body, (centre.x + x, centre.v + v));
}

/// Parameters of a belt of equal planetesimals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belt {
    pub number: usize,
    /// Mass of one.
    pub mass: f64,
    pub density: f64,
    /// Of bodies without mass.
    pub radius: f64,
    pub softening: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// Exponent of the surface density, e.g. -1.5.
    pub slope: f64,
    /// Root of the mean squared eccentricity.
    pub eccentricity: f64,
    /// Root of the mean squared inclination, radians.
    pub inclination: f64,
}

impl Belt {
    /// Adds planetesimals with ids from `first_id` on; each draws its orbit from the stream of its id.
    pub fn add_to(&self, bodies: &mut Bodies, centre: &Centre, seed: u64, first_id: u64) {
        self.check();
        let body = Body {
            kind: Kind::Planetesimal,
            mass: self.mass,
            radius: if self.mass > 0.0 {
                radius(self.mass, self.density)
            } else {
                self.radius
            },
            density: if self.mass > 0.0 { 0.0 } else { self.density },
            softening: self.softening,
        };
        let n = bodies.len();
        bodies.resize(n + self.number);
        for (i, id) in (n..n + self.number).zip(first_id..) {
            let (x, v) = self
                .elements(seed, id)
                .state(centre.g * (centre.mass + body.mass));
            set(bodies, i, id, body, (centre.x + x, centre.v + v));
        }
    }

    /// The orbit of planetesimal `id`.
    pub fn elements(&self, seed: u64, id: u64) -> Elements {
        let mut random = stream(seed, Purpose::Orbits, id, 0);
        let mut angle = || 2.0 * PI * random.random::<f64>();
        let (node, pericentre, mean_anomaly) = (angle(), angle(), angle());
        Elements {
            semi_major_axis: self.axis(random.random()),
            eccentricity: rayleigh(self.eccentricity, 1.0, &mut random),
            inclination: rayleigh(self.inclination, PI, &mut random),
            node,
            pericentre,
            mean_anomaly,
        }
    }

    /// The semi-major axis inside of which the part `u` of the belt lies.
    fn axis(&self, u: f64) -> f64 {
        let power = self.slope + 2.0;
        let ratio = (self.outer_radius / self.inner_radius).ln();
        let grown = if power.abs() < 1e-8 {
            u * ratio
        } else {
            (u * (power * ratio).exp_m1()).ln_1p() / power
        };
        self.inner_radius * grown.exp()
    }

    fn check(&self) {
        assert!(
            0.0 < self.inner_radius && self.inner_radius <= self.outer_radius,
            "a belt ends outside of where it begins"
        );
        assert!(
            self.mass >= 0.0 && self.density >= 0.0,
            "masses and densities are not negative"
        );
        assert!(
            (0.0..1.0).contains(&self.eccentricity) && self.inclination >= 0.0,
            "orbits are ellipses"
        );
    }
}

/// A Rayleigh distributed number below `end`.
fn rayleigh(rms: f64, end: f64, random: &mut impl Rng) -> f64 {
    loop {
        // 1 - u lies in (0, 1], so that its logarithm is finite.
        let value = rms * (-(1.0 - random.random::<f64>()).ln()).sqrt();
        if value < end {
            return value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belt() -> Belt {
        Belt {
            number: 20_000,
            mass: 1e-10,
            density: 2.0,
            radius: 0.0,
            softening: 0.0,
            inner_radius: 0.8,
            outer_radius: 1.6,
            slope: -1.5,
            eccentricity: 0.02,
            inclination: 0.01,
        }
    }

    fn around_star(belt: &Belt, seed: u64, first_id: u64) -> Bodies {
        let mut bodies = Bodies::default();
        belt.add_to(&mut bodies, &STAR, seed, first_id);
        bodies
    }

    const STAR: Centre = Centre {
        x: Vec3::new(1.0, -2.0, 0.5),
        v: Vec3::new(0.1, 0.2, -0.3),
        mass: 2.0,
        g: 3.0,
    };

    #[test]
    fn a_state_has_the_energy_the_pole_and_the_laplace_vector_of_its_elements() {
        let mu = 1.7;
        for e in [0.0, 1e-9, 0.3, 0.9, 0.999] {
            for mean_anomaly in [-9.0, -3.0, -1e-7, 0.0, 0.4, 3.1, 3.2, 20.0] {
                let elements = Elements {
                    semi_major_axis: 2.5,
                    eccentricity: e,
                    inclination: 0.6,
                    node: 1.1,
                    pericentre: 4.0,
                    mean_anomaly,
                };
                let (x, v) = elements.state(mu);
                let energy = 0.5 * v.norm_squared() - mu / x.norm();
                assert!(
                    (energy * -2.0 * 2.5 / mu - 1.0).abs() < 1e-11 / (1.0 - e),
                    "{energy}"
                );
                let pole = x.cross(&v) / (mu * 2.5 * (1.0 - e * e)).sqrt();
                let (i, n) = (0.6f64, 1.1f64);
                let wanted = Vec3::new(i.sin() * n.sin(), -i.sin() * n.cos(), i.cos());
                assert!((pole - wanted).norm() < 1e-11 / (1.0 - e), "{pole}");
                let laplace = v.cross(&x.cross(&v)) / mu - x / x.norm();
                let node = Vec3::new(n.cos(), n.sin(), 0.0);
                let towards = node * 4f64.cos() + wanted.cross(&node) * 4f64.sin();
                assert!(
                    (laplace - e * towards).norm() < 1e-11 / (1.0 - e),
                    "{laplace}"
                );
                // Kepler's equation from the state: e sin E = x.v / sqrt(mu a), 1 - e cos E = r / a.
                if e > 0.1 {
                    let sin = x.dot(&v) / (mu * 2.5).sqrt();
                    let cos = 1.0 - x.norm() / 2.5;
                    let turns = (sin.atan2(cos) - sin - mean_anomaly) / (2.0 * PI);
                    assert!((turns - turns.round()).abs() < 1e-9, "{turns} at e {e}");
                }
            }
        }
    }

    #[test]
    fn a_belt_has_the_wanted_statistics() {
        let belt = belt();
        let n = belt.number as f64;
        let all: Vec<Elements> = (0..belt.number as u64)
            .map(|id| belt.elements(1, id))
            .collect();
        let mean = |f: &dyn Fn(&Elements) -> f64| all.iter().map(f).sum::<f64>() / n;
        // The variance of x^2 of a Rayleigh distribution is the square of its mean; bars are four standard errors.
        assert!((mean(&|o| o.eccentricity.powi(2)) / 0.02f64.powi(2) - 1.0).abs() < 4.0 / n.sqrt());
        assert!((mean(&|o| o.inclination.powi(2)) / 0.01f64.powi(2) - 1.0).abs() < 4.0 / n.sqrt());
        // The mean of a Rayleigh distribution is sqrt(pi)/2 of its rms, the variance 1 - pi/4.
        let straight = mean(&|o| o.eccentricity) / 0.02;
        assert!((straight - 0.5 * PI.sqrt()).abs() < 4.0 * (1.0 - PI / 4.0).sqrt() / n.sqrt());
        let inside = mean(&|o| f64::from(o.semi_major_axis < 1.2));
        let power = 0.5;
        let root = |a: f64| f64::powf(a, power);
        let wanted = (root(1.2) - root(0.8)) / (root(1.6) - root(0.8));
        assert!(
            (inside - wanted).abs() < 4.0 * 0.5 / n.sqrt(),
            "{inside} {wanted}"
        );
        let angles: [&dyn Fn(&Elements) -> f64; 3] =
            [&|o| o.node, &|o| o.pericentre, &|o| o.mean_anomaly];
        for angle in angles {
            for k in 1..4 {
                let wave = mean(&|o| (f64::from(k) * angle(o)).cos());
                assert!(wave.abs() < 4.0 * 0.5f64.sqrt() / n.sqrt(), "{wave}");
            }
        }
    }

    #[test]
    fn bodies_go_around_the_star_and_depend_on_their_id_alone() {
        let few = Belt {
            number: 10,
            ..belt()
        };
        let bodies = around_star(&few, 4, 100);
        assert_eq!(bodies.id, (100..110).collect::<Vec<u64>>());
        assert_eq!(around_star(&few, 4, 101).x[..9], bodies.x[1..]);
        assert_ne!(around_star(&few, 5, 100).x, bodies.x);
        for i in 0..10 {
            let (x, v) = (bodies.x[i] - STAR.x, bodies.v[i] - STAR.v);
            let a = few.elements(4, 100 + i as u64).semi_major_axis;
            let energy = 0.5 * v.norm_squared() - 3.0 * (2.0 + 1e-10) / x.norm();
            assert!((energy * -2.0 * a / 6.0 - 1.0).abs() < 1e-9);
            assert!((4.0 / 3.0 * PI * bodies.radius[i].powi(3) * 2.0 / 1e-10 - 1.0).abs() < 1e-12);
            assert_eq!(bodies.kind[i], Kind::Planetesimal as u32);
        }
    }
}
