//! Fields: the tree's pulls of some populations on those targets that feel just these.

use nbody::Kind;
use nbody::gravity::{Gravity as Solver, Settings};
use nbody::points::Vec3;

use super::{PLANETESIMALS, PLANETS, Plan};
use crate::System;
use crate::operator::Meter;

/// A tree over some populations, for the targets that feel just these.
pub struct Field {
    pub sources: [bool; 3],
    pub targets: [bool; 3],
    pub solver: Solver,
    x: Vec<Vec3>,
    m: Vec<f64>,
    softening: Vec<f64>,
    active: Vec<u32>,
    acceleration: Vec<Vec3>,
    potential: Vec<f64>,
    built: Option<[usize; 3]>,
}

impl Field {
    pub fn new(sources: [bool; 3], targets: [bool; 3], settings: Settings) -> Self {
        Self {
            sources,
            targets,
            solver: Solver::new(settings),
            x: Vec::new(),
            m: Vec::new(),
            softening: Vec::new(),
            active: Vec::new(),
            acceleration: Vec::new(),
            potential: Vec::new(),
            built: None,
        }
    }

    /// Whether anybody feels the field now: else the tree may stay as it is.
    pub fn is_due(&self, system: &System) -> bool {
        system.feels(self.targets)
    }

    /// Brings the tree to the present positions: anew when everybody is active or the numbers have changed.
    pub fn update(&mut self, system: &System, plan: &Plan) {
        self.x.clear();
        self.m.clear();
        self.softening.clear();
        let (gas, dust) = (&system.gas.particles, &system.dust.particles);
        let take = |k: usize| self.sources[k] || self.targets[k];
        let pulling = |k: usize, m: f64| if self.sources[k] { m } else { 0.0 };
        let mut numbers = [0; 3];
        if take(0) {
            self.x.extend_from_slice(&gas.x);
            self.m.extend(gas.m.iter().map(|&m| pulling(0, m)));
            self.softening.extend(gas.h.iter().map(|&h| plan.gas.of(h)));
            numbers[0] = gas.x.len();
        }
        if take(1) {
            self.x.extend_from_slice(&dust.x);
            self.m.extend(dust.m.iter().map(|&m| pulling(1, m)));
            self.softening
                .extend(dust.h.iter().map(|&h| plan.dust.of(h)));
            numbers[1] = dust.x.len();
        }
        if take(2) {
            let bodies = &system.bodies;
            // Planets pull pair by pair, outside the tree.
            let small = |i: usize| {
                if bodies.kind[i] == Kind::Planet as u32 {
                    0.0
                } else {
                    bodies.m[i]
                }
            };
            self.x.extend_from_slice(system.seen.places(&bodies.x));
            self.m
                .extend((0..bodies.x.len()).map(|i| pulling(2, small(i))));
            self.softening.extend_from_slice(&bodies.softening);
            numbers[2] = bodies.x.len();
        }
        if system.clock.synchronous() || self.built != Some(numbers) {
            self.solver.build(&self.x, &self.m, &self.softening);
            self.built = Some(numbers);
        } else {
            self.solver.refit(&self.x, &self.m, &self.softening);
        }
    }

    /// Lists the targets that are active now, in the order of the tree's points.
    fn choose(&mut self, system: &System, plan: &Plan) -> [usize; 3] {
        let numbers = self.built.unwrap_or_default();
        self.active.clear();
        let mut ends = [0; 3];
        let mut first = 0;
        for k in 0..3 {
            if self.targets[k] {
                let active = |i: usize| match k {
                    0 if system.gas.has_field() => system.gas.field_ends(&system.clock, i),
                    0 => system.active(system.gas.particles.end[i]),
                    1 => system.active(system.dust.particles.end[i]),
                    // Planets feel nothing through the tree: they receive what they do to others, unless they do nothing.
                    _ => {
                        let planet = system.bodies.kind[i] == Kind::Planet as u32;
                        let idle = system.bodies.m[i] == 0.0 && plan.pulls[PLANETESIMALS][PLANETS];
                        system.bodies_active() && (!planet || idle)
                    }
                };
                self.active.extend(
                    (0..numbers[k])
                        .filter(|&i| active(i))
                        .map(|i| (first + i) as u32),
                );
            }
            ends[k] = self.active.len();
            first += numbers[k];
        }
        ends
    }

    /// Finds the field at the active targets and hands it to them.
    pub fn act(&mut self, system: &mut System, plan: &Plan, meter: &mut dyn Meter) {
        let ends = self.choose(system, plan);
        let n = self.active.len();
        self.acceleration.resize(n, Vec3::zeros());
        self.potential
            .resize(if system.reporting { n } else { 0 }, 0.0);
        let count = self
            .solver
            .field(&self.active, &mut self.acceleration, &mut self.potential);
        meter.count(n, count.interactions);
        let numbers = self.built.unwrap_or_default();
        let potential = |k: usize| self.potential.get(k).copied().unwrap_or(0.0);
        let gas = &mut system.gas.rates;
        let felt = if gas.field.is_empty() {
            &mut gas.gravity
        } else {
            &mut gas.field
        };
        for k in 0..ends[0] {
            let i = self.active[k] as usize;
            felt[i] = self.acceleration[k];
            if system.reporting {
                gas.potential[i] = potential(k);
            }
        }
        for k in ends[0]..ends[1] {
            let i = self.active[k] as usize - numbers[0];
            system.dust.rates.gravity[i] = self.acceleration[k];
            system.dust.rates.potential[i] = potential(k);
        }
        for k in ends[1]..ends[2] {
            let i = self.active[k] as usize - numbers[0] - numbers[1];
            system.bodies.a[i] = self.acceleration[k];
            system.bodies.potential[i] = potential(k);
        }
    }
}
