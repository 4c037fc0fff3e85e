//! Surroundings: what acts on bodies by a formula instead of by particles, as operators at the bodies' ticks.
//!
//! Two kinds. A [`Law`] changes a body's velocity about the star over half a step (drag and torques of an analytic gas disk, a prescribed
//! migration); momentum, angular momentum and work go to a medium that nobody follows and are booked as given away, frictional heat as
//! radiated. A [`central::Pull`] is a static force between star and body with a potential: it has its reaction on the star.
//! Laws are exact or of second order in their half step, and stand in the list like kicks, so that the whole is of second order.

pub mod central;
pub mod disk;
pub mod drag;
pub mod local;
pub mod migration;
pub mod type_one;

use nbody::points::{Fault, Vec3, sum};
use nbody::{Bodies, Kind};
use rayon::prelude::*;

pub use central::{Central, Oblateness, Relativity};
pub use disk::{GasDisk, Rotation};
pub use drag::DiskDrag;
pub use local::Local;
pub use migration::Migration;
pub use type_one::TypeOne;

use crate::System;
use crate::ledger::Totals;
use crate::operator::{Meter, Operator, Phase};

/// A body as its surroundings see it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    pub id: u64,
    /// Position and velocity about the star.
    pub x: Vec3,
    pub v: Vec3,
    pub m: f64,
    /// Physical radius and mean density; zero for a point.
    pub radius: f64,
    pub density: f64,
    pub planet: bool,
    /// Mass of the star, and the constant of gravity.
    pub star_mass: f64,
    pub g: f64,
}

impl Target {
    /// G M of the star.
    pub fn gm(&self) -> f64 {
        self.g * self.star_mass
    }
}

/// What a law does to a body over some time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    pub dv: Vec3,
    /// Frictional heat by mass.
    pub heat: f64,
}

/// A force on bodies by a medium that nobody follows.
pub trait Law: Send + Sync {
    /// A word that ledger and log know it by.
    const NAME: &'static str;

    /// What happens to `target` over `span` at its present place.
    fn change(&self, target: &Target, span: f64) -> Change;
}

/// A law as an operator of a step.
pub struct External<L> {
    law: L,
    changes: Vec<Change>,
}

impl<L: Law> External<L> {
    pub fn new(law: L) -> Self {
        Self {
            law,
            changes: Vec::new(),
        }
    }

    /// Changes the bodies' velocities over `span` and books what the surroundings took.
    fn act(&mut self, system: &mut System, span: f64) {
        if system.star.x.is_empty() || span == 0.0 {
            return;
        }
        let law = &self.law;
        self.changes
            .resize(system.bodies.x.len(), Change::default());
        let seen = &*system;
        self.changes
            .par_iter_mut()
            .enumerate()
            .with_min_len(64)
            .for_each(|(i, change)| *change = law.change(&target(seen, i), span));
        let taken = taken(&system.bodies, &self.changes);
        let ledger = &mut system.ledger;
        ledger.radiated += taken.internal;
        ledger.given_away += Totals {
            internal: 0.0,
            kinetic: taken.kinetic - taken.internal,
            ..taken
        };
        for (v, change) in system.bodies.v.iter_mut().zip(&self.changes) {
            *v += change.dv;
        }
        system.look();
    }
}

/// Body `i` as its surroundings see it.
fn target(system: &System, i: usize) -> Target {
    let (star, bodies) = (&system.star, &system.bodies);
    Target {
        id: bodies.id[i],
        x: bodies.x[i] - star.x[0],
        v: bodies.v[i] - star.v[0],
        m: bodies.m[i],
        radius: bodies.radius[i],
        density: bodies.mean_density(i),
        planet: bodies.kind[i] == Kind::Planet as u32,
        star_mass: star.m[0],
        g: system.g,
    }
}

/// Momentum, angular momentum and kinetic energy that `changes` take from bodies; heat stands as internal energy.
fn taken(bodies: &Bodies, changes: &[Change]) -> Totals {
    sum::ordered(changes.len(), Totals::default(), |range| {
        range.fold(Totals::default(), |sum, i| {
            let (m, x, v, Change { dv, heat }) =
                (bodies.m[i], bodies.x[i], bodies.v[i], changes[i]);
            sum + Totals {
                momentum: -m * dv,
                angular_momentum: -m * x.cross(&dv),
                kinetic: -m * dv.dot(&(v + 0.5 * dv)),
                internal: m * heat,
                ..Totals::default()
            }
        })
    })
}

impl<L: Law> Operator for External<L> {
    fn name(&self) -> &'static str {
        L::NAME
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            self.act(system, system.closing(system.pace.begin, system.pace.span));
        }
        Ok(active)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            self.act(system, system.opening(system.pace.next_span));
        }
        Ok(active)
    }
}

#[cfg(test)]
mod tests;
