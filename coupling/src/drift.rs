//! Drifts: everybody moves to the next tick. Star and bodies move by their own integrator when their step ends there; before that
//! they are seen through its prediction.

use nbody::integrators::gauss_radau::GaussRadau;
use nbody::integrators::wisdom_holman::jacobi::{Jacobi, Scheme};
use nbody::integrators::{Ahead, Stuck, leapfrog, wisdom_holman};
use nbody::points::{Fault, Population, Vec3};

use crate::System;
use crate::operator::{Meter, Operator, Phase};

mod meetings;

pub use meetings::{DriftHermite, DriftHybrid};

/// Moves the gas.
pub struct DriftGas;

impl Operator for DriftGas {
    fn name(&self) -> &'static str {
        "drift gas"
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let domain = system.domain;
        system.gas.drift(dt, &domain);
        Ok(true)
    }
}

/// Moves the dust.
pub struct DriftDust;

impl Operator for DriftDust {
    fn name(&self) -> &'static str {
        "drift dust"
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        let domain = system.domain;
        system.dust.drift(dt, &domain);
        Ok(true)
    }
}

/// The time since the bodies' step began.
fn elapsed(system: &System) -> f64 {
    f64::from(system.clock.tick - system.pace.begin) * system.clock.unit()
}

/// Moves star and bodies by straight lines.
pub struct DriftStraight;

impl Operator for DriftStraight {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        let active = system.bodies_active();
        if active {
            leapfrog::drift(&mut system.star, dt);
            leapfrog::drift(&mut system.bodies, dt);
            system.look();
            return Ok(true);
        }
        let seen = &mut system.seen;
        for (bodies, x) in [
            (&system.star, &mut seen.star_x),
            (&system.bodies, &mut seen.x),
        ] {
            for ((seen, x), v) in x.iter_mut().zip(&bodies.x).zip(&bodies.v) {
                *seen = *x + *v * dt;
            }
        }
        Ok(false)
    }
}

/// A body that its integrator cannot move.
fn fault(system: &System, stuck: Stuck) -> Fault {
    let id = system.bodies.id.get(stuck.place).copied().unwrap_or(0);
    Fault::Stuck {
        population: Population::Planetesimals,
        id,
        reason: stuck.refusal.to_string(),
        time: system.clock.time(),
    }
}

/// Moves star and bodies by the Kepler map of Wisdom & Holman (1991) in democratic heliocentric coordinates.
#[derive(Default)]
pub struct DriftKepler {
    ahead: Ahead,
}

impl Operator for DriftKepler {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let dt = elapsed(system);
        meter.count(system.bodies.x.len(), 0);
        if system.bodies_active() {
            let moved = wisdom_holman::drift(&mut system.star, &mut system.bodies, system.g, dt);
            moved.map_err(|stuck| fault(system, stuck))?;
            system.look();
            return Ok(true);
        }
        let seen =
            wisdom_holman::predict(&system.star, &system.bodies, system.g, dt, &mut self.ahead);
        seen.map_err(|stuck| fault(system, stuck))?;
        let seen = &mut system.seen;
        seen.x.clone_from(&self.ahead.x);
        seen.v.clone_from(&self.ahead.v);
        seen.star_x.fill(self.ahead.x_star);
        seen.star_v.fill(self.ahead.v_star);
        Ok(false)
    }
}

/// Moves star and bodies on each other by a Wisdom-Holman map in Jacobi coordinates, in equal steps of about `step` within each base
/// step. Nothing else may kick the bodies. The map's memory is in [`System::memory`].
pub struct DriftJacobi {
    pub scheme: Scheme,
    pub step: f64,
}

impl Operator for DriftJacobi {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        system.pace.next_span = crate::kick::span(&system.next, f64::INFINITY)?;
        Ok(())
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        assert!(system.bodies_active(), "nobody else ticks");
        meter.enter(Phase::Bodies);
        let (star, bodies) = (&mut system.star, &mut system.bodies);
        let map = Jacobi::restored(self.scheme, system.g, star, bodies, &system.memory);
        let mut map = map.unwrap_or_else(|| Jacobi::of(self.scheme, system.g, star, bodies));
        let dt = elapsed(system);
        let steps = (dt / self.step * (1.0 - 1e-12)).ceil().max(1.0);
        meter.count(system.bodies.x.len() * steps as usize, 0);
        let moved = map.advance(dt / steps, steps as u64);
        moved.map_err(|stuck| fault(system, stuck))?;
        let stored = map.store(&mut system.star, &mut system.bodies);
        stored.map_err(|stuck| fault(system, stuck))?;
        system.memory = map.state();
        system.look();
        Ok(true)
    }
}

/// Moves star and bodies on each other by the Gauss-Radau integrator of 15th order (Everhart 1985; Rein & Spiegel 2015), forces by direct sum.
///
/// Between the bodies' ticks they are seen where the Kepler map would take them. The integrator's memory is in [`System::memory`].
pub struct DriftRadau {
    /// Whether bodies are kicked from outside, so that the integrator has to take their velocities anew at each tick.
    kicked: bool,
    /// The interval at which its results are wanted.
    step: f64,
    kepler: DriftKepler,
}

impl DriftRadau {
    pub fn new(kicked: bool, step: f64) -> Self {
        Self {
            kicked,
            step,
            kepler: DriftKepler::default(),
        }
    }
}

impl Operator for DriftRadau {
    fn name(&self) -> &'static str {
        "drift bodies"
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        if !self.kicked && system.bodies_active() {
            system.pace.next_span = crate::kick::span(&system.next, self.step)?;
        }
        Ok(())
    }

    fn cross(
        &mut self,
        system: &mut System,
        dt: f64,
        meter: &mut dyn Meter,
    ) -> Result<bool, Fault> {
        if !system.bodies_active() {
            return self.kepler.cross(system, dt, meter);
        }
        meter.enter(Phase::Bodies);
        let n = system.star.x.len() + system.bodies.x.len();
        let begin = system.clock.time() - elapsed(system);
        let mut integrator = match GaussRadau::restored(&system.memory) {
            Some(integrator) if !self.kicked && integrator.x().len() == n => integrator,
            _ => GaussRadau::of(begin, &system.star, &system.bodies),
        };
        let pairs = Pairs::of(system);
        let mut sums = 0;
        let done = integrator.advance_to(system.clock.time(), |x, a| {
            sums += 1;
            pairs.add(x, a);
        });
        meter.count(n, sums * pairs.interactions());
        done.map_err(|stall| Fault::Stuck {
            population: Population::Planetesimals,
            id: 0,
            reason: stall.to_string(),
            time: system.clock.time(),
        })?;
        integrator.store(&mut system.star, &mut system.bodies);
        system.memory = integrator.state();
        system.look();
        Ok(true)
    }
}

/// Masses and softening lengths of star and bodies, for the direct sum. Massless bodies feel, but do not pull.
struct Pairs {
    g: f64,
    m: Vec<f64>,
    softening: Vec<f64>,
    /// Places of those with mass, and of those without.
    massive: Vec<usize>,
    massless: Vec<usize>,
}

impl Pairs {
    fn of(system: &System) -> Self {
        let both = |star: &[f64], bodies: &[f64]| star.iter().chain(bodies).copied().collect();
        let m: Vec<f64> = both(&system.star.m, &system.bodies.m);
        let (massive, massless) = (0..m.len()).partition(|&i| m[i] > 0.0);
        Self {
            g: system.g,
            softening: both(&system.star.softening, &system.bodies.softening),
            m,
            massive,
            massless,
        }
    }

    /// Pulls a sum over all pairs takes; a pair of masses pulls both ways at once.
    fn interactions(&self) -> u64 {
        let massive = self.massive.len() as u64;
        massive * massive.saturating_sub(1) / 2 + massive * self.massless.len() as u64
    }

    fn add(&self, x: &[Vec3], a: &mut [Vec3]) {
        for (k, &i) in self.massive.iter().enumerate() {
            for &j in &self.massive[..k] {
                let f = self.pull(x, i, j);
                a[i] += f * self.m[j];
                a[j] -= f * self.m[i];
            }
        }
        for &i in &self.massless {
            for &j in &self.massive {
                a[i] += self.pull(x, i, j) * self.m[j];
            }
        }
    }

    /// The pull on i towards j by mass of j.
    fn pull(&self, x: &[Vec3], i: usize, j: usize) -> Vec3 {
        let d = x[j] - x[i];
        let soft = self.softening[i] * self.softening[i] + self.softening[j] * self.softening[j];
        let r2 = d.norm_squared() + soft;
        // Points at one place have no direction to pull in.
        if r2 > 0.0 {
            d * (self.g / (r2 * r2.sqrt()))
        } else {
            Vec3::zeros()
        }
    }
}

#[cfg(test)]
mod tests;
