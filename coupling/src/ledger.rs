//! The ledger: what is conserved, how well, and which operator changed what of which population.

use std::ops::{Add, AddAssign, Sub};

use nalgebra::Vector2;
use nbody::Bodies;
use nbody::points::{Domain, Vec3, length, sum};

use crate::System;

/// Leaves a task.
const LEAVES: usize = 32;

/// Sums over a population, code units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Totals {
    pub mass: f64,
    pub momentum: Vec3,
    /// Of the orbits, and of the spins of bodies.
    pub angular_momentum: Vec3,
    pub kinetic: f64,
    pub internal: f64,
    /// Sum of |m v| and of m sqrt(u), which heat could make of it: the scale that errors of momentum are relative to.
    pub momentum_scale: f64,
    /// Sum of |m x cross v| and of m |x| sqrt(u).
    pub angular_scale: f64,
}

impl Totals {
    /// Adds a particle, without its scales.
    fn count(&mut self, m: f64, x: Vec3, v: Vec3, u: f64) {
        let momentum = m * v;
        self.mass += m;
        self.momentum += momentum;
        self.angular_momentum += x.cross(&momentum);
        self.kinetic += 0.5 * v.dot(&momentum);
        self.internal += m * u;
    }

    /// The sum with the scales, which take longer.
    fn scaled(m: &[f64], x: &[Vec3], v: &[Vec3], u: &[f64]) -> Self {
        let scales = sum::ordered(m.len(), Self::default(), |range| {
            range.fold(Self::default(), |total, i| {
                let momentum = m[i] * v[i];
                let heat = m[i] * u.get(i).map_or(0.0, |u| u.abs().sqrt());
                total
                    + Self {
                        momentum_scale: length(momentum) + heat,
                        angular_scale: length(x[i].cross(&momentum)) + heat * length(x[i]),
                        ..Self::default()
                    }
            })
        });
        Self::over(m, x, v, u) + scales
    }

    /// Of the gas near the active particles.
    fn of_near(gas: &gas::Gas) -> Self {
        let (leaves, p) = (gas.near(), &gas.particles);
        sum::ordered_by(LEAVES, leaves.len(), Self::default(), |range| {
            let near = leaves[range].iter();
            near.flat_map(|&leaf| gas.tree.nodes[leaf as usize].range())
                .fold(Self::default(), |mut total, i| {
                    total.count(p.m[i], p.x[i], p.v[i], p.u[i]);
                    total
                })
        })
    }

    /// Adds impulses that `bodies` have yet to receive.
    fn expects(&mut self, bodies: &Bodies, pending: &[Vec3]) {
        for (x, impulse) in bodies.x.iter().zip(pending) {
            self.momentum += impulse;
            self.angular_momentum += x.cross(impulse);
        }
    }

    fn over(m: &[f64], x: &[Vec3], v: &[Vec3], u: &[f64]) -> Self {
        sum::ordered(m.len(), Self::default(), |range| {
            range.fold(Self::default(), |mut total, i| {
                total.count(m[i], x[i], v[i], u.get(i).copied().unwrap_or(0.0));
                total
            })
        })
    }
}

impl Totals {
    /// What errors of momentum and angular momentum are relative to, with what had to be stilled for heat to be dissipated.
    fn scales(&self, dissipated: f64) -> Vector2<f64> {
        let stilled = (self.mass * dissipated.abs()).sqrt();
        let lever = match self.momentum_scale {
            0.0 => 0.0,
            momentum => self.angular_scale / momentum,
        };
        Vector2::new(
            self.momentum_scale + stilled,
            self.angular_scale + stilled * lever,
        )
    }
}

impl Add for Totals {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            mass: self.mass + o.mass,
            momentum: self.momentum + o.momentum,
            angular_momentum: self.angular_momentum + o.angular_momentum,
            kinetic: self.kinetic + o.kinetic,
            internal: self.internal + o.internal,
            momentum_scale: self.momentum_scale + o.momentum_scale,
            angular_scale: self.angular_scale + o.angular_scale,
        }
    }
}

impl AddAssign for Totals {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Totals {
    type Output = Self;

    /// The difference; scales subtract too and mean nothing in it.
    fn sub(self, o: Self) -> Self {
        Self {
            mass: self.mass - o.mass,
            momentum: self.momentum - o.momentum,
            angular_momentum: self.angular_momentum - o.angular_momentum,
            kinetic: self.kinetic - o.kinetic,
            internal: self.internal - o.internal,
            momentum_scale: self.momentum_scale - o.momentum_scale,
            angular_scale: self.angular_scale - o.angular_scale,
        }
    }
}

/// Whom a census counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    Everybody,
    /// The star, of the gas what is near the active particles, and bodies or not.
    Near {
        bodies: bool,
    },
}

/// Totals of gas, dust, planetesimals (with planets) and star, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Census(pub [Totals; 4]);

impl Census {
    /// Names of the populations, in order.
    pub const NAMES: [&'static str; 4] = ["gas", "dust", "planetesimals", "star"];

    /// Counts those in `scope`, without the scales.
    pub fn within(scope: Scope, system: &System) -> Self {
        match scope {
            Scope::Everybody => Self::of(system),
            Scope::Near { bodies } => Self::near(system, bodies),
        }
    }

    fn near(system: &System, bodies: bool) -> Self {
        let count = |all: &Bodies, pending: &[Vec3]| {
            let mut total = Totals::over(&all.m, &all.x, &all.v, &[]);
            total.angular_momentum += spin(&all.spin);
            total.expects(all, pending);
            total
        };
        let mut totals = [Totals::default(); 4];
        totals[0] = Totals::of_near(&system.gas);
        if bodies {
            totals[2] = count(&system.bodies, &system.pending_bodies);
        }
        totals[3] = count(&system.star, &system.pending_star);
        Self(totals)
    }

    /// Counts the system as it stands, without the scales. Impulses that bodies have yet to receive count as theirs.
    pub fn of(system: &System) -> Self {
        Self::by(system, Totals::over)
    }

    /// The same with the scales that errors are relative to.
    pub fn scaled(system: &System) -> Self {
        Self::by(system, Totals::scaled)
    }

    fn by(system: &System, totals: impl Fn(&[f64], &[Vec3], &[Vec3], &[f64]) -> Totals) -> Self {
        let (gas, dust) = (&system.gas.particles, &system.dust.particles);
        let bodies = |b: &Bodies| {
            let mut total = totals(&b.m, &b.x, &b.v, &[]);
            total.angular_momentum += spin(&b.spin);
            total
        };
        let mut totals = [
            totals(&gas.m, &gas.x, &gas.v, &gas.u),
            totals(&dust.m, &dust.x, &dust.v, &[]),
            bodies(&system.bodies),
            bodies(&system.star),
        ];
        for (k, bodies, pending) in [
            (2, &system.bodies, &system.pending_bodies),
            (3, &system.star, &system.pending_star),
        ] {
            totals[k].expects(bodies, pending);
        }
        Self(totals)
    }

    pub fn sum(&self) -> Totals {
        self.0.iter().fold(Totals::default(), |sum, &t| sum + t)
    }
}

fn spin(spin: &[Vec3]) -> Vec3 {
    sum::ordered(spin.len(), Vec3::zeros(), |range| {
        range.fold(Vec3::zeros(), |sum, i| sum + spin[i])
    })
}

/// What one operator has changed since the start, by population.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    pub operator: String,
    pub change: Census,
}

/// The books of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ledger {
    /// The census at the start.
    pub initial: Census,
    /// Potential energy at the start.
    pub initial_potential: f64,
    /// A line an operator.
    pub entries: Vec<Entry>,
    /// Heat taken out by equations of state that prescribe the temperature, and what the background pressure's forces are short of.
    pub radiated: f64,
    /// Mass accreted by the star: gas, dust, planetesimals.
    pub accreted: [f64; 3],
    /// Kinetic and potential energy that accretion and collisions turned into heat and rotation, which nobody follows.
    pub dissipated: f64,
    /// Momentum and angular momentum that drag took out of the system because feedback is off, and momentum that the frame took.
    pub given_away: Totals,
    /// How often a floor on the internal energy was used.
    pub floors: u64,
    /// How often drag found gas so one-sided that it did not keep angular momentum.
    pub lopsided: u64,
    /// How often a grain did not grow since it would have outweighed its swarm.
    pub whole: u64,
    /// The last census, while it still says how the system stands.
    last: Option<(Scope, Census)>,
}

/// One line of the history: everything in code units, errors relative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    pub time: f64,
    pub mass: [f64; 4],
    pub momentum: Vec3,
    pub angular_momentum: Vec3,
    pub kinetic: f64,
    pub internal: f64,
    pub potential: f64,
    pub radiated: f64,
    pub accreted: [f64; 3],
    pub error_mass: f64,
    pub error_momentum: f64,
    pub error_angular_momentum: f64,
    pub error_energy: f64,
}

impl Ledger {
    /// Books heat that left or entered the gas other than by its forces.
    pub fn take(&mut self, heat: gas::Heat) {
        self.radiated += heat.radiated - heat.floored;
        self.floors += heat.floors as u64;
        self.receive(heat.frame);
    }

    /// Books momentum that the frame of a shearing box gave: Coriolis force, tide, what pulls in it, and the change of velocity across faces.
    pub fn receive(&mut self, momentum: Vec3) {
        self.given_away.momentum -= momentum;
    }

    /// Opens the books on the system as it stands.
    pub fn open(&mut self, system: Census, potential: f64) {
        // Heat that brought the gas to its prescribed temperature came before the start.
        self.radiated = 0.0;
        // So did what the star swallowed at once.
        self.dissipated = 0.0;
        // And so did momentum that crossing faces gave to what was placed outside of them.
        self.given_away = Totals::default();
        // What closed before the first step began had no step to close.
        self.entries.clear();
        self.initial = system;
        self.initial_potential = potential;
        self.forget();
    }

    /// Takes the system as it stands as the state that the next entry is compared with.
    pub fn turn(&mut self, scope: Scope, system: Census) {
        self.last = Some((scope, system));
    }

    /// What changes now belongs to nobody.
    pub fn forget(&mut self) {
        self.last = None;
    }

    /// Whether the state of those in `scope` is known that the next entry is compared with.
    pub fn remembers(&self, scope: Scope) -> bool {
        self.last.is_some_and(|(known, _)| known == scope)
    }

    /// Books what has changed since the last entry as the work of `operator`.
    pub fn book(&mut self, operator: &str, scope: Scope, system: Census) {
        let last = self.last.map_or(system, |(_, last)| last);
        let change = Census(std::array::from_fn(|k| system.0[k] - last.0[k]));
        self.add(operator, &change);
        self.last = Some((scope, system));
    }

    /// Books `change` as the work of `operator`.
    pub fn add(&mut self, operator: &str, change: &Census) {
        let known = self.entries.iter().position(|e| e.operator == operator);
        let place = known.unwrap_or_else(|| {
            self.entries.push(Entry {
                operator: operator.to_owned(),
                change: Census::default(),
            });
            self.entries.len() - 1
        });
        for (sum, change) in self.entries[place].change.0.iter_mut().zip(&change.0) {
            *sum += *change;
        }
        self.last = None;
    }

    /// The books as one line. All conserved sums are compared with the start; one that the domain does not conserve has an error that is no number.
    pub fn report(&self, time: f64, system: Census, potential: f64, domain: &Domain) -> Report {
        let turns = (0..3).all(|axis| domain.period(axis) == 0.0);
        let (now, start) = (system.sum(), self.initial.sum());
        let lost = self.given_away;
        let energy =
            now.kinetic + now.internal + potential + self.radiated + self.dissipated + lost.kinetic;
        let energy_start = start.kinetic + start.internal + self.initial_potential;
        let energy_scale = match energy_start.abs() {
            0.0 => start.kinetic + start.internal + self.initial_potential.abs(),
            e => e,
        };
        let momentum_error = length(now.momentum + lost.momentum - start.momentum);
        let angular_error =
            length(now.angular_momentum + lost.angular_momentum - start.angular_momentum);
        let scales = now.scales(self.dissipated).sup(&start.scales(0.0));
        Report {
            time,
            mass: system.0.map(|t| t.mass),
            momentum: now.momentum,
            angular_momentum: now.angular_momentum,
            kinetic: now.kinetic,
            internal: now.internal,
            potential,
            radiated: self.radiated + self.dissipated,
            accreted: self.accreted,
            error_mass: relative(now.mass - start.mass, start.mass),
            error_momentum: relative(momentum_error, scales.x),
            error_angular_momentum: if turns {
                relative(angular_error, scales.y)
            } else {
                f64::NAN
            },
            error_energy: if domain.hill().is_none() {
                relative(energy - energy_start, energy_scale)
            } else {
                f64::NAN
            },
        }
    }
}

fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}
