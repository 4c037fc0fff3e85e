//! Gravity of all populations on all: the tree's field of gas, dust and planetesimals, and the pulls of star and planets.
//!
//! a_i = -G sum_j m_j r_ij / (r_ij^2 + eps_i^2 + eps_j^2)^(3/2)
//!
//! Star and planets pull gas and dust pair by pair; what they receive in turn is summed when the gas is kicked, so that momentum is
//! exact. The star's pull on bodies belongs to their integrator where that has a Kepler step. The softening length of gas and dust is a fixed
//! part of the smoothing length, or a length of the scene.

use nbody::gravity::{Gravity as Solver, Settings};
use nbody::integrators::hybrid::{Hybrid, cutoff::Cutoff, soft::Soft};
use nbody::points::{Fault, Vec3, sum};
use nbody::{Bodies, Kind};
use rayon::prelude::*;

use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Which masses pull which: `pulls[a][b]` says whether a pulls b. The order is gas, dust, planetesimals, planets, star.
pub type Pulls = [[bool; 5]; 5];

/// Everything pulls everything.
pub const ALL_PULL: Pulls = [[true; 5]; 5];

const PLANETESIMALS: usize = 2;
const PLANETS: usize = 3;
const STAR: usize = 4;

/// Softening of a fluid population.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Softening {
    Length(f64),
    /// This times the smoothing length.
    Adaptive(f64),
}

impl Softening {
    /// The length for a particle of smoothing length `h`.
    pub fn of(self, h: f64) -> f64 {
        match self {
            Self::Length(length) => length,
            Self::Adaptive(factor) => factor * h,
        }
    }
}

/// What the gravity operator needs to know of a scene.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The tree's settings; none if gas, dust and planetesimals do not pull.
    pub tree: Option<Settings>,
    pub pulls: Pulls,
    pub gas: Softening,
    pub dust: Softening,
    /// Whether the star has its pull on bodies in the kick: for integrators without a Kepler step.
    pub star_in_kick: bool,
    /// What part of the bodies' pulls on each other is in the kick.
    pub mutual: Mutual,
}

/// Where the bodies' pulls on each other are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mutual {
    Kick,
    /// In the drift, whose integrator does all forces between bodies itself.
    Drift,
    /// Beyond each pair's cut-off in the kick, within it in the drift; cut-offs count in the bodies' step.
    Changeover {
        cutoff: Cutoff,
        step: f64,
    },
}

/// A tree over some populations, for the targets that feel just these.
struct Field {
    sources: [bool; 3],
    targets: [bool; 3],
    solver: Solver,
    x: Vec<Vec3>,
    m: Vec<f64>,
    softening: Vec<f64>,
    active: Vec<u32>,
    acceleration: Vec<Vec3>,
    potential: Vec<f64>,
    built: Option<[usize; 3]>,
}

/// The operator that finds the accelerations by gravity of whoever is active.
pub struct Gravity {
    plan: Plan,
    fields: Vec<Field>,
    /// What takes the bodies' pulls within cut-offs out of the kick.
    changeover: Option<Changeover>,
}

/// The soft part of the bodies' pulls on each other.
struct Changeover {
    hybrid: Hybrid,
    /// For bodies without gas and dust.
    soft: Soft,
}

impl Gravity {
    /// Groups the targets of the scene by what pulls them: one tree a group.
    pub fn new(plan: Plan) -> Self {
        let mut fields: Vec<Field> = Vec::new();
        if let Some(settings) = &plan.tree {
            for target in 0..3 {
                let mut sources = [0, 1, 2].map(|source| plan.pulls[source][target]);
                if target == 2 && plan.mutual == Mutual::Drift {
                    sources[2] = false;
                }
                if sources == [false; 3] {
                    continue;
                }
                match fields.iter_mut().find(|f| f.sources == sources) {
                    Some(field) => field.targets[target] = true,
                    None => {
                        let mut targets = [false; 3];
                        targets[target] = true;
                        fields.push(Field::new(sources, targets, *settings));
                    }
                }
            }
        }
        let changeover = match (plan.mutual, plan.tree) {
            (Mutual::Changeover { cutoff, step }, Some(settings)) => Some(Changeover {
                hybrid: Hybrid::new(cutoff, step, false),
                soft: Soft::new(settings),
            }),
            _ => None,
        };
        Self {
            plan,
            fields,
            changeover,
        }
    }
}

impl Field {
    fn new(sources: [bool; 3], targets: [bool; 3], settings: Settings) -> Self {
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

    /// Brings the tree to the present positions: anew when everybody is active or the numbers have changed.
    fn update(&mut self, system: &System, plan: &Plan) {
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
            self.x.extend_from_slice(&system.seen.x);
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
    fn act(&mut self, system: &mut System, plan: &Plan, meter: &mut dyn Meter) {
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
        for k in 0..ends[0] {
            let i = self.active[k] as usize;
            system.gas.rates.gravity[i] = self.acceleration[k];
            system.gas.rates.potential[i] = potential(k);
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

/// A massive body that pulls pair by pair.
#[derive(Clone, Copy, Debug)]
pub struct Heavy {
    pub x: Vec3,
    pub m: f64,
    pub softening: f64,
    /// Its place among the bodies, or among the stars.
    pub place: usize,
    pub star: bool,
}

/// The stars and planets of the system that pull, where they are seen now.
pub fn heavies(system: &System) -> Vec<Heavy> {
    let of = |bodies: &Bodies, x: &[Vec3], star: bool| -> Vec<Heavy> {
        (0..bodies.x.len())
            .filter(|&i| star || (bodies.kind[i] == Kind::Planet as u32 && bodies.m[i] > 0.0))
            .map(|i| Heavy {
                x: x[i],
                m: bodies.m[i],
                softening: bodies.softening[i],
                place: i,
                star,
            })
            .collect()
    };
    let mut all = of(&system.star, &system.seen.star_x, true);
    all.extend(of(&system.bodies, &system.seen.x, false));
    all
}

impl Heavy {
    /// Its place in [`Pulls`].
    fn rank(&self) -> usize {
        if self.star { STAR } else { PLANETS }
    }

    /// Acceleration of a point at `x` with softening length `softening`, and the potential there, for G = 1.
    pub fn pull(&self, x: Vec3, softening: f64) -> (Vec3, f64) {
        let dx = self.x - x;
        let own = if self.star { 0.0 } else { softening };
        let r2 = dx.norm_squared() + self.softening * self.softening + own * own;
        if r2 > 0.0 {
            let inverse = 1.0 / r2.sqrt();
            (
                dx * (self.m * inverse * inverse * inverse),
                -self.m * inverse,
            )
        } else {
            (Vec3::zeros(), 0.0)
        }
    }
}

impl Operator for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        silence(system);
        let alone = system.gas.is_empty() && system.dust.is_empty();
        let softly = alone && self.changeover.is_some();
        // Bodies alone have their soft pulls from elsewhere; potentials come from the whole ones.
        if !softly || system.reporting {
            self.pull(system, meter);
        }
        if system.bodies_active() {
            meter.enter(Phase::Gravity);
            self.soften(system, softly);
        }
        Ok(())
    }
}

impl Gravity {
    /// All pulls of all on whoever is active, but for those that belong to a drift; potentials if they are to be reported.
    fn pull(&mut self, system: &mut System, meter: &mut dyn Meter) {
        if let Some(Changeover { hybrid, .. }) = &mut self.changeover
            && system.bodies_active()
        {
            hybrid.choose(&system.star, &mut system.bodies, system.g);
            for field in &mut self.fields {
                field.solver.resolve(hybrid.typical());
            }
        }
        for field in &mut self.fields {
            meter.enter(Phase::Tree);
            field.update(system, &self.plan);
            meter.enter(Phase::Gravity);
            field.act(system, &self.plan, meter);
        }
        meter.enter(Phase::Gravity);
        let heavies = heavies(system);
        if system.reporting {
            if self.plan.mutual == Mutual::Drift && self.plan.tree.is_some() {
                add_mutual_potentials(system);
            }
            add_potentials(system, &self.plan, &heavies);
        }
        self.pull_fluids(system, &heavies);
        if system.bodies_active() {
            self.pull_bodies(system, &heavies);
        }
    }

    /// Leaves of the bodies' pulls on each other what belongs to the kick, and keeps for a report what does not.
    fn soften(&mut self, system: &mut System, softly: bool) {
        let reporting = system.reporting;
        if reporting {
            system.held_back.clone_from(&system.bodies.a);
        }
        let (star, bodies, g) = (&system.star, &mut system.bodies, system.g);
        match &mut self.changeover {
            Some(Changeover { hybrid, soft }) if softly => soft.field(hybrid, star, bodies),
            Some(Changeover { hybrid, .. }) => hybrid.soften_all(bodies, g),
            None => {}
        }
        if reporting {
            for (held, a) in system.held_back.iter_mut().zip(&bodies.a) {
                *held -= a;
            }
            if self.plan.mutual == Mutual::Drift && self.plan.tree.is_some() {
                add_mutual_pulls(bodies, g, &mut system.held_back);
            }
        }
    }
}

/// The bodies' pulls on each other, pair by pair.
fn add_mutual_pulls(bodies: &Bodies, g: f64, pulls: &mut [Vec3]) {
    let (x, softening) = (&bodies.x, &bodies.softening);
    let sources: Vec<usize> = (0..x.len()).filter(|&j| bodies.m[j] > 0.0).collect();
    pulls.par_iter_mut().enumerate().for_each(|(i, pull)| {
        for &j in sources.iter().filter(|&&j| j != i) {
            let d = x[j] - x[i];
            let q2 = d.norm_squared() + softening[i].powi(2) + softening[j].powi(2);
            *pull += d * (g * bodies.m[j] / (q2 * q2.sqrt()));
        }
    });
}

/// The planetesimals' potentials by each other, for integrators that do their forces themselves.
fn add_mutual_potentials(system: &mut System) {
    let (bodies, x, g) = (&mut system.bodies, &system.seen.x, system.g);
    let small = |i: usize| bodies.kind[i] != Kind::Planet as u32;
    let softening = &bodies.softening;
    // Only masses pull: without this, test particles would cost the square of their number.
    let sources: Vec<usize> = (0..x.len())
        .filter(|&j| small(j) && bodies.m[j] > 0.0)
        .collect();
    let phi = |i: usize| -> f64 {
        let others = sources.iter().filter(|&&j| j != i);
        others
            .map(|&j| {
                -bodies.m[j]
                    / ((x[j] - x[i]).norm_squared() + softening[i].powi(2) + softening[j].powi(2))
                        .sqrt()
            })
            .sum()
    };
    let added: Vec<f64> = (0..x.len())
        .into_par_iter()
        .map(|i| if small(i) { g * phi(i) } else { 0.0 })
        .collect();
    for (potential, more) in bodies.potential.iter_mut().zip(added) {
        *potential += more;
    }
}

/// A population as the sum of potentials sees it.
struct Members<'a> {
    x: &'a [Vec3],
    m: &'a [f64],
    softening: Vec<f64>,
    potential: &'a mut [f64],
    /// Places of planets: they have their own sum.
    planets: Vec<usize>,
}

impl Members<'_> {
    /// Adds the potentials of `heavies`; returns the potential energy: half of what stood there before, all of what is added.
    fn add(&mut self, heavies: &[Heavy], g: f64) -> f64 {
        let Self {
            x,
            m,
            softening,
            potential,
            planets,
        } = self;
        let halves = sum::ordered(x.len(), 0.0, |range| {
            range.fold(0.0, |sum, i| sum + m[i] * potential[i])
        });
        let added: Vec<f64> = (0..x.len())
            .into_par_iter()
            .with_min_len(sum::CHUNK)
            .map(|i| {
                let planet = planets.contains(&i);
                let others = heavies
                    .iter()
                    .filter(|heavy| heavy.star || !planet || heavy.place != i);
                others
                    .map(|heavy| g * heavy.pull(x[i], softening[i]).1)
                    .sum()
            })
            .collect();
        let whole = sum::ordered(x.len(), 0.0, |range| {
            range.fold(0.0, |sum, i| sum + m[i] * added[i])
        });
        let double: f64 = planets.iter().map(|&i| m[i] * added[i]).sum();
        for (phi, more) in potential.iter_mut().zip(added) {
            *phi += more;
        }
        0.5 * halves + whole - double
    }
}

/// Adds the potentials of star and planets to those of the tree, and sums the potential energy.
fn add_potentials(system: &mut System, plan: &Plan, heavies: &[Heavy]) {
    let g = system.g;
    let (gas, dust, bodies) = (&mut system.gas, &mut system.dust, &mut system.bodies);
    let soft = |softening: Softening, h: &[f64]| h.iter().map(|&h| softening.of(h)).collect();
    let fluid = |x, m, h, softening, potential| Members {
        x,
        m,
        softening: soft(softening, h),
        potential,
        planets: Vec::new(),
    };
    let (p, d) = (&gas.particles, &dust.particles);
    let mut energy = fluid(&p.x, &p.m, &p.h, plan.gas, &mut gas.rates.potential).add(heavies, g);
    energy += fluid(&d.x, &d.m, &d.h, plan.dust, &mut dust.rates.potential).add(heavies, g);
    let planets = (0..bodies.x.len())
        .filter(|&i| bodies.kind[i] == Kind::Planet as u32)
        .collect();
    let softening = bodies.softening.clone();
    energy += Members {
        x: &system.seen.x,
        m: &bodies.m,
        softening,
        potential: &mut bodies.potential,
        planets,
    }
    .add(heavies, g);
    for (k, heavy) in heavies.iter().enumerate() {
        for other in &heavies[..k] {
            let softening = if heavy.star || other.star {
                0.0
            } else {
                other.softening
            };
            energy += g * other.m * heavy.pull(other.x, softening).1;
        }
    }
    system.potential = energy;
}

/// Zeroes the accelerations of whoever is active.
fn silence(system: &mut System) {
    let (clock, synchronous) = (system.clock.tick, system.clock.synchronous());
    let bodies_active = system.bodies_active();
    for (gravity, &end) in system
        .gas
        .rates
        .gravity
        .iter_mut()
        .zip(&system.gas.particles.end)
    {
        if synchronous || end == clock {
            *gravity = Vec3::zeros();
        }
    }
    for (gravity, &end) in system
        .dust
        .rates
        .gravity
        .iter_mut()
        .zip(&system.dust.particles.end)
    {
        if synchronous || end == clock {
            *gravity = Vec3::zeros();
        }
    }
    if bodies_active {
        system.bodies.a.fill(Vec3::zeros());
        system.star.a.fill(Vec3::zeros());
    }
    if system.reporting {
        system.gas.rates.potential.fill(0.0);
        system.dust.rates.potential.fill(0.0);
        system.bodies.potential.fill(0.0);
    }
}

impl Gravity {
    /// The pulls of star and planets on active gas and dust.
    fn pull_fluids(&self, system: &mut System, heavies: &[Heavy]) {
        let (tick, synchronous, g) = (system.clock.tick, system.clock.synchronous(), system.g);
        let felt = |target: usize| -> Vec<Heavy> {
            heavies
                .iter()
                .copied()
                .filter(|h| self.plan.pulls[h.rank()][target])
                .collect()
        };
        let (gas, dust) = (&mut system.gas, &mut system.dust);
        for (heavies, softening, x, h, end, gravity) in [
            (
                felt(0),
                self.plan.gas,
                &gas.particles.x,
                &gas.particles.h,
                &gas.particles.end,
                &mut gas.rates.gravity,
            ),
            (
                felt(1),
                self.plan.dust,
                &dust.particles.x,
                &dust.particles.h,
                &dust.particles.end,
                &mut dust.rates.gravity,
            ),
        ] {
            if heavies.is_empty() {
                continue;
            }
            gravity
                .par_iter_mut()
                .enumerate()
                .with_min_len(sum::CHUNK)
                .for_each(|(i, gravity)| {
                    if synchronous || end[i] == tick {
                        for heavy in &heavies {
                            *gravity += g * heavy.pull(x[i], softening.of(h[i])).0;
                        }
                    }
                });
        }
    }

    /// The pulls among star, planets and planetesimals that the kick has.
    fn pull_bodies(&self, system: &mut System, heavies: &[Heavy]) {
        let (g, pulls) = (system.g, &self.plan.pulls);
        let bodies = &mut system.bodies;
        let (x, kind, softening) = (&system.seen.x, &bodies.kind, &bodies.softening);
        let rank = |i: usize| {
            if kind[i] == Kind::Planet as u32 {
                PLANETS
            } else {
                PLANETESIMALS
            }
        };
        for heavy in heavies {
            if !(if heavy.star {
                self.plan.star_in_kick
            } else {
                self.plan.mutual != Mutual::Drift
            }) {
                continue;
            }
            bodies
                .a
                .par_iter_mut()
                .enumerate()
                .with_min_len(sum::CHUNK)
                .for_each(|(i, a)| {
                    if pulls[heavy.rank()][rank(i)] && (heavy.star || i != heavy.place) {
                        *a += g * heavy.pull(x[i], softening[i]).0;
                    }
                });
            // What the pulled ones give back; planets among themselves have it from the loop above.
            let back = sum::ordered(x.len(), Vec3::zeros(), |range| {
                range
                    .filter(|&i| {
                        pulls[rank(i)][heavy.rank()] && (heavy.star || rank(i) == PLANETESIMALS)
                    })
                    .fold(Vec3::zeros(), |sum, i| {
                        sum - bodies.m[i] * heavy.pull(x[i], softening[i]).0
                    })
            });
            if heavy.m > 0.0 {
                let own = if heavy.star {
                    &mut system.star.a
                } else {
                    &mut bodies.a
                };
                own[heavy.place] += g * back / heavy.m;
            }
        }
    }
}
