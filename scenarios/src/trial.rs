//! A trial: a scene that runs in memory and leaves no folder, for verification and for measurements.

use std::path::Path;

use coupling::ledger::{Census, Report};
use coupling::{Splitting, System};
use dust::{Dust, Superparticles};
use gas::{Gas, Particles};
use nbody::points::Fault;

use crate::assemble::{self, Assembly};
use crate::scene::Scene;
use crate::stopwatch::Stopwatch;

/// What there is to see at a stop: the closed system, its books, and the cost so far.
pub struct Stop<'a> {
    pub system: &'a System,
    pub books: &'a Report,
    pub watch: &'a Stopwatch,
}

/// A scene in place, before its first step or at the last of its stops.
pub struct Trial {
    pub scene: Scene,
    pub system: System,
    /// CPU time and counts since the start.
    pub watch: Stopwatch,
    splitting: Splitting,
}

impl Trial {
    /// A scene from its text with `overrides` (as of `--set`), its gas changed by `prepare` before the start; or why there is none.
    pub fn new(
        text: &str,
        overrides: &[String],
        prepare: impl FnOnce(&mut Particles),
    ) -> Result<Self, String> {
        Self::prepared(text, overrides, |gas, _| prepare(gas))
    }

    /// The same, its dust changed too.
    pub fn prepared(
        text: &str,
        overrides: &[String],
        prepare: impl FnOnce(&mut Particles, &mut Superparticles),
    ) -> Result<Self, String> {
        let scene = Scene::parse(text, "trial", Path::new("."), overrides)
            .map_err(|problems| format!("{problems:?}"))?;
        let mut system = assemble::start(&scene).map_err(|refusal| refusal.0)?;
        let mut particles = std::mem::take(&mut system.gas.particles);
        let mut grains = std::mem::take(&mut system.dust.particles);
        prepare(&mut particles, &mut grains);
        if !particles.x.is_empty() {
            system.gas = Gas::new(particles);
        }
        if !grains.x.is_empty() {
            system.dust = Dust::new(grains);
        }
        let Assembly {
            system, splitting, ..
        } = assemble::assembly(&scene, system).map_err(|refusal| refusal.0)?;
        Ok(Self {
            scene,
            system,
            watch: Stopwatch::new(Default::default(), 0.0),
            splitting,
        })
    }

    /// Runs from the start through `stops`, ascending times of which the first is the start, and calls `visit` at each. To be called once.
    pub fn run(&mut self, stops: &[f64], mut visit: impl FnMut(&Stop)) -> Result<(), Fault> {
        self.run_while(stops, |stop| {
            visit(stop);
            true
        })
    }

    /// The same until `visit` answers no.
    pub fn run_while(
        &mut self,
        stops: &[f64],
        mut visit: impl FnMut(&Stop) -> bool,
    ) -> Result<(), Fault> {
        let mut met = 0;
        loop {
            let system = &mut self.system;
            let now = system.clock.time();
            let stop = system.clock.synchronous() && now >= stops[met];
            met += usize::from(stop);
            system.reporting = stop;
            // Steps that begin at the last stop are chosen, but never done.
            let until = stops.get(met).copied().unwrap_or(now + 1.0);
            let longest = system.longest;
            self.splitting
                .close(system, until, longest, &mut self.watch)?;
            if stop {
                let census = Census::scaled(system);
                if met == 1 {
                    let potential = system.potential;
                    system.ledger.open(census, potential);
                }
                let row = system
                    .ledger
                    .report(now, census, system.potential, &system.domain);
                self.watch.stop();
                let going = visit(&Stop {
                    system,
                    books: &row,
                    watch: &self.watch,
                });
                if !going {
                    return Ok(());
                }
            }
            if met == stops.len() {
                return Ok(());
            }
            self.splitting.open(system, &mut self.watch)?;
            self.splitting.cross(system, &mut self.watch)?;
        }
    }

    /// CPU time of all threads since the start, s.
    pub fn cpu_s(&self) -> f64 {
        self.watch.cpu_s()
    }

    /// Updates of gas particles since the start.
    pub fn updates(&self) -> u64 {
        self.watch.laps[coupling::Phase::Density as usize].targets
    }
}
