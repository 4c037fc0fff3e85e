//! Static forces between star and body beyond Newton's: relativity and the star's oblateness, with their reaction on the star.
//!
//! Relativity: potential -3 (G M/c r)^2 by mass, M with the body's own. It has the pericentre advance of the first post-Newtonian order,
//! 6 pi G M/(c^2 a (1 - e^2)) an orbit, and being a function of position it keeps a kick symplectic, energy and momentum exact; the mean
//! motion and terms of the length of an orbit are not those of general relativity (relative error of order G M/(c^2 a)).
//! Oblateness: G M J2 R^2 (3 z^2/r^2 - 1)/(2 r^3), z along the pole; the pole stays, and the star's spin takes the torque.
//! Source: Nobili & Roxburgh (1986, IAU Symp. 114, 105); Murray & Dermott (1999), section 6.11.

use nbody::points::{Fault, Vec3, sum};
use rayon::prelude::*;

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// A force of the star on a body that has a potential.
pub trait Pull: Send + Sync {
    /// A word that ledger and log know it by.
    const NAME: &'static str;

    /// Acceleration and potential of a body of mass `m` at `r` from a star of mass `star`, if the star were held.
    fn field(&self, r: Vec3, m: f64, star: f64, g: f64) -> (Vec3, f64);
}

/// The pericentre advance of general relativity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relativity {
    pub speed_of_light: f64,
}

impl Pull for Relativity {
    const NAME: &'static str = "relativity";

    fn field(&self, r: Vec3, m: f64, star: f64, g: f64) -> (Vec3, f64) {
        let r2 = r.norm_squared();
        let c2 = self.speed_of_light * self.speed_of_light;
        // G^2 M (M + m): so the two-body motion advances by the total mass.
        let phi = -3.0 * (g * star) * (g * (star + m)) / (c2 * r2);
        (r * (2.0 * phi / r2), phi)
    }
}

/// The quadrupole of a flattened star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oblateness {
    pub j2: f64,
    pub equatorial_radius: f64,
    /// Unit vector.
    pub pole: Vec3,
}

impl Pull for Oblateness {
    const NAME: &'static str = "oblateness";

    fn field(&self, r: Vec3, _: f64, star: f64, g: f64) -> (Vec3, f64) {
        let k = 0.5 * g * star * self.j2 * self.equatorial_radius * self.equatorial_radius;
        let (r2, z) = (r.norm_squared(), self.pole.dot(&r));
        let s2 = z * z / r2;
        let r5 = r2 * r2 * r2.sqrt();
        let a = (r * (15.0 * s2 - 3.0) - self.pole * (6.0 * z)) * (k / r5);
        (a, k * (3.0 * s2 - 1.0) * r2 / r5)
    }
}

/// A pull as an operator of a step: a kick of its own.
pub struct Central<P> {
    pull: P,
    a: Vec<Vec3>,
}

impl<P: Pull> Central<P> {
    pub fn new(pull: P) -> Self {
        Self {
            pull,
            a: Vec::new(),
        }
    }

    fn kick(&self, system: &mut System, weight: f64) {
        if system.star.x.is_empty() || weight == 0.0 {
            return;
        }
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let centre = star.x[0];
        let Given(impulse, torque) = sum::ordered(self.a.len(), Given::default(), |range| {
            range.fold(Given::default(), |sum, i| {
                let impulse = self.a[i] * (bodies.m[i] * weight);
                sum + Given(impulse, (bodies.x[i] - centre).cross(&impulse))
            })
        });
        for (v, a) in bodies.v.iter_mut().zip(&self.a) {
            *v += *a * weight;
        }
        star.v[0] -= impulse / star.m[0];
        star.spin[0] -= torque;
        system.look();
    }
}

/// Impulse and torque.
#[derive(Clone, Copy, Default)]
struct Given(Vec3, Vec3);

impl std::ops::Add for Given {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self(self.0 + o.0, self.1 + o.1)
    }
}

impl<P: Pull> Operator for Central<P> {
    fn name(&self) -> &'static str {
        P::NAME
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        if system.star.x.is_empty() || !system.bodies_active() {
            return Ok(());
        }
        meter.enter(Phase::Bodies);
        let (centre, star, g) = (system.star.x[0], system.star.m[0], system.g);
        let bodies = &mut system.bodies;
        let field = |x: Vec3, m: f64| self.pull.field(x - centre, m, star, g);
        self.a.resize(bodies.x.len(), Vec3::zeros());
        self.a
            .par_iter_mut()
            .zip(bodies.x.par_iter().zip(&bodies.m))
            .with_min_len(sum::CHUNK)
            .for_each(|(a, (&x, &m))| *a = field(x, m).0);
        if system.reporting {
            for ((phi, &x), &m) in bodies.potential.iter_mut().zip(&bodies.x).zip(&bodies.m) {
                let more = field(x, m).1;
                *phi += more;
                system.potential += m * more;
            }
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            self.kick(system, system.closing(system.pace.begin, system.pace.span));
        }
        Ok(active)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            self.kick(system, system.opening(system.pace.next_span));
        }
        Ok(active)
    }
}
