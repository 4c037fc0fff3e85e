//! Gravity of all populations on all: the tree's field of gas, dust and planetesimals, and the pulls of star and planets.
//!
//! a_i = -G sum_j m_j r_ij / (r_ij^2 + eps_i^2 + eps_j^2)^(3/2)
//!
//! Star and planets pull gas and dust pair by pair; what they receive in turn is summed when the gas is kicked, so that momentum is
//! exact. The star's pull on bodies belongs to their integrator where that has a Kepler step. The softening length of gas and dust is a fixed
//! part of the smoothing length, or a length of the scene.

mod changeover;
mod field;
mod heavy;
mod potentials;

use nbody::gravity::Settings;
use nbody::points::{Fault, Vec3};

use crate::System;
use crate::operator::{Meter, Operator, Phase};
use crate::torques;
use changeover::Changeover;
pub use changeover::Meetings;
use field::Field;
pub use heavy::{Heavy, heavies};
use potentials::{add_mutual_potentials, add_potentials};

/// Which masses pull which: `pulls[a][b]` says whether a pulls b. The order is gas, dust, planetesimals, planets, star.
pub type Pulls = [[bool; 5]; 5];

/// Everything pulls everything.
pub const ALL_PULL: Pulls = [[true; 5]; 5];

const GAS: usize = 0;
const DUST: usize = 1;
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
    /// Whether reports want what the kick leaves out of the bodies' accelerations.
    pub held_back: bool,
    /// Whether the tree's field on the gas has steps of its own.
    pub field_steps: bool,
}

/// Where the bodies' pulls on each other are.
#[derive(Clone, Debug)]
pub enum Mutual {
    Kick,
    /// In the drift, whose integrator does all forces between bodies itself.
    Drift,
    /// Beyond each pair's cut-off in the kick, within it in the drift.
    Changeover(Meetings),
}

/// The operator that finds the accelerations by gravity of whoever is active.
pub struct Gravity {
    plan: Plan,
    fields: Vec<Field>,
    /// What takes the bodies' pulls within cut-offs out of the kick.
    changeover: Option<Changeover>,
}

impl Gravity {
    /// Groups the targets of the scene by what pulls them: one tree a group.
    pub fn new(plan: Plan) -> Self {
        let fields = plan.tree.map_or_else(Vec::new, |tree| fields(&plan, tree));
        let changeover = match (&plan.mutual, plan.tree) {
            (Mutual::Changeover(meetings), Some(settings)) => {
                Some(Changeover::new(meetings.clone(), settings))
            }
            _ => None,
        };
        Self {
            plan,
            fields,
            changeover,
        }
    }

    /// Who looks at all gas whenever they feel a field: gas, dust and bodies.
    pub fn observers(&self) -> [bool; 3] {
        let mut observers = [false; 3];
        for field in &self.fields {
            if field.sources[0] || field.targets[0] {
                for (observer, target) in observers.iter_mut().zip(field.targets) {
                    *observer |= target;
                }
            }
        }
        observers
    }

    /// All pulls of all on whoever is active, but for those that belong to a drift; potentials if they are to be reported.
    fn pull(&mut self, system: &mut System, meter: &mut dyn Meter) {
        if let Some(changeover) = &self.changeover
            && system.bodies_active()
        {
            let near = changeover.choose(system);
            for field in &mut self.fields {
                field.solver.resolve(near);
            }
        }
        for field in &mut self.fields {
            if !field.is_due(system) {
                continue;
            }
            meter.enter(Phase::Tree);
            field.update(system, &self.plan);
            meter.enter(Phase::Gravity);
            field.act(system, &self.plan, meter);
        }
        meter.enter(Phase::Gravity);
        let heavies = heavies(system);
        if system.reporting {
            if matches!(self.plan.mutual, Mutual::Drift) && self.plan.tree.is_some() {
                add_mutual_potentials(system);
            }
            add_potentials(system, &self.plan, &heavies);
        }
        self.plan.pull_fluids(system, &heavies);
        if system.bodies_active() {
            self.plan.pull_bodies(system, &heavies);
        }
        system.heavies = heavies;
        if let Some(changeover) = &self.changeover
            && system.bodies_active()
        {
            changeover.soften(system);
        }
    }
}

/// One tree for each set of sources that some population feels.
fn fields(plan: &Plan, settings: Settings) -> Vec<Field> {
    let mut fields: Vec<Field> = Vec::new();
    for target in 0..3 {
        let mut sources = [0, 1, 2].map(|source| plan.pulls[source][target]);
        if target == 2 && matches!(plan.mutual, Mutual::Drift) {
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
                fields.push(Field::new(sources, targets, settings));
            }
        }
    }
    fields
}

impl Operator for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        let alone = system.gas.is_empty() && system.dust.is_empty();
        self.make_room(system);
        silence(system);
        match &mut self.changeover {
            Some(changeover) if alone => {
                meter.enter(Phase::Gravity);
                let interactions = changeover.pull(system);
                meter.count(system.bodies.x.len(), interactions);
                if system.reporting {
                    let idle = self.plan.pulls[PLANETESIMALS][PLANETS];
                    changeover::leave_planets(system, idle);
                    let heavies = heavies(system);
                    add_potentials(system, &self.plan, &heavies);
                    system.heavies = heavies;
                }
            }
            _ => self.pull(system, meter),
        }
        if system.reporting && self.plan.held_back && system.bodies_active() {
            self.hold_back(system);
        }
        if system.reporting {
            system.torques = torques::pulls(system, &self.plan);
        }
        Ok(())
    }
}

impl Gravity {
    /// Makes room in the columns of gas that gravity fills.
    fn make_room(&self, system: &mut System) {
        let field = self.fields.iter().any(|field| field.targets[0]);
        let heavy = self.plan.pulls[STAR][0] || self.plan.pulls[PLANETS][0];
        let apart = field && self.plan.field_steps;
        system.gas.feel(heavy || field && !apart, apart);
    }

    /// Keeps for a report what the kick leaves out of the bodies' pulls on each other.
    fn hold_back(&mut self, system: &mut System) {
        let mut held = std::mem::take(&mut system.held_back);
        held.clear();
        held.resize(system.bodies.x.len(), Vec3::zeros());
        let (bodies, g) = (&system.bodies, system.g);
        match &self.changeover {
            Some(changeover) => changeover.add_hard(bodies, g, &mut held),
            None if matches!(self.plan.mutual, Mutual::Drift) && self.plan.tree.is_some() => {
                changeover::add_mutual_pulls(bodies, g, &mut held);
            }
            None => {}
        }
        system.held_back = held;
    }
}

/// Zeroes the accelerations of whoever is active.
fn silence(system: &mut System) {
    let (clock, synchronous) = (system.clock.tick, system.clock.synchronous());
    let bodies_active = system.bodies_active();
    if !system.gas.rates.gravity.is_empty() {
        system.gas.pull(|_, _, _| Vec3::zeros());
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
    let potential = &mut system.gas.rates.potential;
    potential.clear();
    if system.reporting {
        potential.resize(system.gas.particles.m.len(), 0.0);
        system.dust.rates.potential.fill(0.0);
        system.bodies.potential.fill(0.0);
    }
}
