//! The changeover: what part of the bodies' pulls on each other belongs to the kick, where their drift does the rest.

use std::sync::{Arc, Mutex, MutexGuard};

use nbody::gravity::Settings;
use nbody::integrators::hybrid::{Hybrid, soft::Soft, typical};
use nbody::points::Vec3;
use nbody::{Bodies, Kind};
use rayon::prelude::*;

use crate::System;

/// The map of bodies that meet. Kick and drift share it: both need the tree of the bodies at this tick.
#[derive(Clone, Debug)]
pub struct Meetings(Arc<Mutex<Hybrid>>);

impl Meetings {
    pub fn new(hybrid: Hybrid) -> Self {
        Self(Arc::new(Mutex::new(hybrid)))
    }

    pub(crate) fn map(&self) -> MutexGuard<'_, Hybrid> {
        // A panic ends the run, so nobody sees what it left.
        self.0.lock().unwrap_or_else(|poison| poison.into_inner())
    }
}

/// What finds the soft part of the bodies' pulls on each other.
pub struct Changeover {
    meetings: Meetings,
    /// For bodies without gas and dust.
    soft: Soft,
}

impl Changeover {
    pub fn new(meetings: Meetings, settings: Settings) -> Self {
        Self {
            meetings,
            soft: Soft::new(settings),
        }
    }

    /// Finds the soft accelerations of bodies without gas and dust; their potentials by each other if they are to be reported. Many bodies
    /// are brought into the order of the curve. Returns the number of interactions.
    pub fn pull(&mut self, system: &mut System) -> u64 {
        assert!(system.bodies_active(), "nobody else ticks");
        let mut map = self.meetings.map();
        map.arrange(&mut system.bodies);
        let (star, bodies) = (&system.star, &mut system.bodies);
        self.soft.field(&mut map, star, bodies, system.reporting)
    }

    /// Chooses the cut-offs; returns the length within which pairs are to be exact in a field that is softened afterwards.
    pub fn choose(&self, system: &mut System) -> f64 {
        let mut map = self.meetings.map();
        map.choose(&system.star, &mut system.bodies, system.g);
        typical(&system.bodies.cutoff)
    }

    /// Takes off the bodies' accelerations what belongs to the drift.
    pub fn soften(&self, system: &mut System) {
        self.meetings.map().soften_all(&mut system.bodies, system.g);
    }

    /// Adds to `pulls` what [`Self::soften`] takes off.
    pub fn add_hard(&self, bodies: &Bodies, g: f64, pulls: &mut [Vec3]) {
        self.meetings.map().add_hard(bodies, g, pulls);
    }
}

/// Takes planets, whose potentials are summed pair by pair, out of those by the tree; `idle` ones without mass stay if they feel it.
pub fn leave_planets(system: &mut System, idle: bool) {
    let Bodies {
        m, kind, potential, ..
    } = &mut system.bodies;
    for ((phi, &m), &kind) in potential.iter_mut().zip(&*m).zip(&*kind) {
        if kind == Kind::Planet as u32 && !(idle && m == 0.0) {
            *phi = 0.0;
        }
    }
}

/// The bodies' pulls on each other, pair by pair.
pub fn add_mutual_pulls(bodies: &Bodies, g: f64, pulls: &mut [Vec3]) {
    let (x, softening) = (&bodies.x, &bodies.softening);
    let sources: Vec<usize> = (0..x.len()).filter(|&j| bodies.m[j] > 0.0).collect();
    pulls.par_iter_mut().enumerate().for_each(|(i, pull)| {
        for &j in sources.iter().filter(|&&j| j != i) {
            let d = x[j] - x[i];
            let q2 = d.norm_squared() + softening[i].powi(2) + softening[j].powi(2);
            if q2 == 0.0 {
                continue;
            }
            *pull += d * (g * bodies.m[j] / (q2 * q2.sqrt()));
        }
    });
}
