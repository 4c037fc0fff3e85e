//! Accretion: what comes within the star's accretion radius becomes part of the star, and bodies that touch collide.
//!
//! Mass and momentum of the accreted go to the star; their angular momentum about it becomes its spin, their kinetic
//! energy there is booked as dissipated.

use nbody::collisions::{self, Collision, Field, Law};
use nbody::encounters::{Encounter, Finder};
use nbody::points::{Columns, Fault, Vec3};

use crate::System;
use crate::ledger::{Census, Scope};
use crate::operator::{Meter, Operator, Phase};

/// A conversion of particles or bodies, or an impact, for the log of events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Event {
    pub time: f64,
    pub kind: &'static str,
    /// Identity that stays (the star's is 0) and the other, which is gone but after a bounce or a hit-and-run.
    pub kept: u64,
    pub lost: u64,
    pub mass_kept: f64,
    pub mass_lost: f64,
    pub position: Vec3,
    /// Impact speed in units of the pair's escape speed, and angle to the normal.
    pub speed_ratio: f64,
    pub angle: f64,
    /// Mass of the largest body afterwards, and number of new bodies.
    pub mass_largest: f64,
    pub fragments: u64,
}

/// Removes what lies within the star's accretion radius: gas and dust at every tick, bodies at theirs. The star receives mass at once,
/// momentum at its next tick, and keeps its place.
#[derive(Default)]
pub struct Accretion {
    /// The members of each population that are accreted.
    inside: [Vec<usize>; 3],
}

impl Operator for Accretion {
    fn name(&self) -> &'static str {
        "accretion"
    }

    fn between_ticks(&self) -> bool {
        true
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        if system.star.x.is_empty() {
            return Ok(false);
        }
        // Gas and dust at every tick: inside, their steps would become ever shorter.
        let populations = if system.bodies_active() { 3 } else { 2 };
        for (population, inside) in self.inside.iter_mut().enumerate() {
            inside.clear();
            if population < populations {
                seek(system, population, inside);
            }
        }
        if self.inside.iter().all(Vec::is_empty) {
            return Ok(false);
        }
        system.gas.arrive(&system.domain, &system.clock);
        self.swallow(system);
        Ok(true)
    }
}

impl Accretion {
    /// Removes what lies within the accretion radius before the first step, which could not be short enough there.
    pub fn begin(&mut self, system: &mut System) {
        let Some((&centre, &radius)) = system.star.x.first().zip(system.star.radius.first()) else {
            return;
        };
        let places = [
            &system.gas.particles.x,
            &system.dust.particles.x,
            &system.bodies.x,
        ];
        self.inside = places.map(|x| {
            let near = |i: &usize| (x[*i] - centre).norm_squared() < radius * radius;
            (0..x.len()).filter(near).collect()
        });
        if self.inside.iter().any(|inside| !inside.is_empty()) {
            self.swallow(system);
            // Its momentum has no tick to wait for.
            system.settle_impulses();
            system.look();
        }
    }

    /// Feeds the star with those `inside`.
    fn swallow(&mut self, system: &mut System) {
        let census = Census::of(system);
        system.ledger.turn(Scope::Everybody, census);
        for (population, inside) in self.inside.iter().enumerate() {
            if !inside.is_empty() {
                accrete(system, population, inside);
            }
        }
        if system.bodies_active() {
            system.settle_impulses();
            system.look();
        }
        let census = Census::of(system);
        system.ledger.book(self.name(), Scope::Everybody, census);
    }
}

/// Lists the members of one population within the star's accretion radius.
fn seek(system: &mut System, population: usize, inside: &mut Vec<usize>) {
    let (centre, radius) = (system.seen.star_x[0], system.star.radius[0]);
    let near = |x: Vec3| (x - centre).norm_squared() < radius * radius;
    let x = match population {
        0 => {
            let (domain, clock) = (system.domain, system.clock);
            (system.gas).arrive_near((centre, radius), &domain, &clock, inside);
            inside.retain(|&i| near(system.gas.particles.x[i]));
            return;
        }
        1 => &system.dust.particles.x,
        _ => &system.bodies.x,
    };
    inside.extend((0..x.len()).filter(|&i| near(x[i])));
}

/// Feeds the star with the members of one population that are `inside`.
fn accrete(system: &mut System, population: usize, inside: &[usize]) {
    let (centre, time) = (system.seen.star_x[0], system.clock.time());
    let (x, v, m, id): (&[Vec3], &[Vec3], &[f64], &[u64]) = match population {
        0 => (
            &system.gas.particles.x,
            &system.gas.particles.v,
            &system.gas.particles.m,
            &system.gas.particles.id,
        ),
        1 => (
            &system.dust.particles.x,
            &system.dust.particles.v,
            &system.dust.particles.m,
            &system.dust.particles.id,
        ),
        _ => (
            &system.bodies.x,
            &system.bodies.v,
            &system.bodies.m,
            &system.bodies.id,
        ),
    };
    let mut keep = vec![true; x.len()];
    for &i in inside {
        keep[i] = false;
    }
    let mut spin = Vec3::zeros();
    let kind = ["accreted-gas", "accreted-dust", "accreted-planetesimal"][population];
    for &i in inside {
        let (big, small) = (system.star.m[0], m[i]);
        let sum = big + small;
        let (dx, dv) = (x[i] - centre, v[i] - system.star.v[0]);
        let reduced = big * small / sum;
        spin += (x[i] - system.star.x[0]).cross(&(small * v[i]));
        if population == 2 {
            spin += system.bodies.spin[i];
        }
        system.ledger.dissipated += 0.5 * reduced * dv.norm_squared();
        if population == 0 {
            system.ledger.dissipated += small * system.gas.particles.u[i];
        }
        if dx.norm() > 0.0 {
            system.ledger.dissipated -= system.g * big * small / dx.norm();
        }
        system.ledger.accreted[population] += small;
        let escape = (2.0 * system.g * sum / dx.norm().max(f64::MIN_POSITIVE)).sqrt();
        let cosine = -dx.dot(&dv) / (dx.norm() * dv.norm()).max(f64::MIN_POSITIVE);
        system.events.push(Event {
            time,
            kind,
            kept: system.star.id[0],
            lost: id[i],
            mass_kept: big,
            mass_lost: small,
            position: x[i],
            speed_ratio: dv.norm() / escape,
            angle: cosine.clamp(-1.0, 1.0).acos(),
            mass_largest: sum,
            fragments: 0,
        });
        system.pending_star[0] += small * dv;
        system.star.m[0] = sum;
    }
    system.star.spin[0] += spin;
    match population {
        0 => system.gas.retain(&keep),
        1 => system.dust.retain(&keep),
        _ => {
            system.bodies.retain(&keep);
            let mut flags = keep.iter();
            system
                .pending_bodies
                .retain(|_| *flags.next().expect("one flag a body"));
        }
    }
}

/// Does what the law of collisions says to bodies that touched within their step, at the bodies' ticks.
pub struct Collisions {
    law: Law,
    /// Whether planetesimals pull each other; planets always do.
    self_gravity: bool,
    /// Whether the bodies' integrator finds the touches itself.
    found: bool,
    finder: Finder,
    touched: Vec<Encounter>,
}

impl Collisions {
    /// `found`: whether the bodies' integrator finds the touches itself.
    pub fn new(law: Law, self_gravity: bool, found: bool) -> Self {
        Self {
            law,
            self_gravity,
            found,
            finder: Finder::default(),
            touched: Vec::new(),
        }
    }

    /// Gathers the pairs that touched in the step of `dt` that ends now.
    fn gather(&mut self, system: &mut System, dt: f64) {
        self.touched.clear();
        self.touched.append(&mut system.touches);
        if !self.found {
            let found = self.finder.encounters(&system.bodies, &system.domain, dt);
            self.touched.extend_from_slice(found);
        }
    }
}

impl Operator for Collisions {
    fn name(&self) -> &'static str {
        "collisions"
    }

    fn between_ticks(&self) -> bool {
        true
    }

    fn counted(&self, system: &System) -> bool {
        system.bodies_active()
    }

    fn cross(&mut self, system: &mut System, _: f64, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        if !system.bodies_active() {
            return Ok(false);
        }
        let dt = f64::from(system.clock.tick - system.pace.begin) * system.clock.unit();
        self.gather(system, dt);
        if self.touched.is_empty() {
            return Ok(false);
        }
        // Impulses on their way go to whoever carries the momentum after the collision.
        system.settle_impulses();
        let field = Field {
            domain: system.domain,
            g: system.g,
            self_gravity: self.self_gravity,
            now: system.clock.time(),
        };
        let (bodies, next_id) = (&mut system.bodies, &mut system.next_id);
        let outcome = collisions::collide(bodies, &self.touched, &self.law, &field, next_id);
        if outcome.events.is_empty() {
            return Ok(true);
        }
        for event in &outcome.events {
            system.ledger.dissipated += event.energy_lost;
            system.events.push(Event::from(event));
        }
        system.bodies.retain(&outcome.keep);
        system.pending_bodies.clear();
        // An integrator that remembers other velocities has to begin anew: one number is no state of any.
        system.memory.truncate(1);
        system.look();
        Ok(true)
    }
}

impl From<&Collision> for Event {
    fn from(event: &Collision) -> Self {
        Self {
            time: event.time,
            kind: event.kind.name(),
            kept: event.id_kept,
            lost: event.id_lost,
            mass_kept: event.mass_kept,
            mass_lost: event.mass_lost,
            position: event.position,
            speed_ratio: event.speed,
            angle: event.angle,
            mass_largest: event.mass_largest,
            fragments: event.fragments as u64,
        }
    }
}
