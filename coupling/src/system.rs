//! The system: all populations of a scene in their domain, on one clock.

use dust::Dust;
use gas::Gas;
use nbody::Bodies;
use nbody::points::{Clock, Domain, Vec3};

use crate::Ledger;

/// The common step of star and bodies, in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    pub begin: u32,
    pub span: u32,
    pub end: u32,
    pub next_span: u32,
}

/// Where star and bodies are seen now: between their own ticks a prediction, at their ticks their state.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub star_x: Vec<Vec3>,
    pub star_v: Vec<Vec3>,
    pub x: Vec<Vec3>,
    pub v: Vec<Vec3>,
}

/// Everything that a scene models. A population that it leaves out is empty.
#[derive(Clone, Debug)]
pub struct System {
    pub domain: Domain,
    /// Constant of gravity.
    pub g: f64,
    pub clock: Clock,
    /// The clock in which steps begin that open now.
    pub next: Clock,
    pub star: Bodies,
    pub bodies: Bodies,
    pub pace: Pace,
    pub seen: Seen,
    /// Whether the star's pull on bodies is in their kick, and so in their `a`.
    pub star_in_kick: bool,
    /// Net impulse that the tree's field has given to gas, dust and bodies since everybody was last active. Without truncation it would be
    /// zero whenever everybody is.
    pub stray: Vec3,
    /// Impulses (momenta) that star and bodies receive at their next tick.
    pub pending_star: Vec<Vec3>,
    pub pending_bodies: Vec<Vec3>,
    pub gas: Gas,
    pub dust: Dust,
    pub ledger: Ledger,
    /// What an integrator of bodies remembers between steps; empty for those that remember nothing.
    pub memory: Vec<f64>,
    /// Whether potentials are wanted at this tick.
    pub reporting: bool,
    /// What has happened since the events were last written.
    pub events: Vec<crate::accretion::Event>,
    /// Potential energy of the whole system when last reported.
    pub potential: f64,
}

impl System {
    /// A system at rest on the clock at `time`.
    pub fn new(domain: Domain, g: f64, time: f64) -> Self {
        Self {
            domain,
            g,
            clock: Clock::standing(time),
            next: Clock::standing(time),
            star: Bodies::default(),
            bodies: Bodies::default(),
            pace: Pace::default(),
            seen: Seen::default(),
            star_in_kick: false,
            stray: Vec3::zeros(),
            pending_star: Vec::new(),
            pending_bodies: Vec::new(),
            gas: Gas::default(),
            dust: Dust::default(),
            ledger: Ledger::default(),
            memory: Vec::new(),
            reporting: false,
            events: Vec::new(),
            potential: 0.0,
        }
    }

    /// Whether a step that ends at `end` ends now.
    pub fn active(&self, end: u32) -> bool {
        self.clock.synchronous() || end == self.clock.tick
    }

    /// Whether star and bodies are active now.
    pub fn bodies_active(&self) -> bool {
        self.active(self.pace.end)
    }

    /// Weight, in time, with which a force taken now closes a step of the particle's own.
    pub fn closing(&self, begin: u32, span: u32) -> f64 {
        nbody::points::clock::closing(self.clock.tick, begin, span) * self.clock.unit()
    }

    /// Weight, in time, with which a force taken now opens a step of `span` ticks.
    pub fn opening(&self, span: u32) -> f64 {
        nbody::points::clock::opening(span) * self.next.unit()
    }

    /// Makes the bodies' state what is seen of them; to be called when they are active or newly placed.
    pub fn look(&mut self) {
        self.seen.star_x.clone_from(&self.star.x);
        self.seen.star_v.clone_from(&self.star.v);
        self.seen.x.clone_from(&self.bodies.x);
        self.seen.v.clone_from(&self.bodies.v);
        self.pending_star.resize(self.star.x.len(), Vec3::zeros());
        self.pending_bodies.resize(self.bodies.x.len(), Vec3::zeros());
    }

    /// Gives star and bodies their summed impulses.
    pub fn settle_impulses(&mut self) {
        for (bodies, pending) in [(&mut self.star, &mut self.pending_star), (&mut self.bodies, &mut self.pending_bodies)] {
            for ((v, &m), impulse) in bodies.v.iter_mut().zip(&bodies.m).zip(pending.iter_mut()) {
                if *impulse != Vec3::zeros() {
                    *v += *impulse / m;
                    *impulse = Vec3::zeros();
                }
            }
        }
    }

    /// Takes the stray impulse of the tree's field out of gas, dust and bodies, by one velocity for all. To be called when everybody's step is
    /// closed.
    pub fn recall_stray(&mut self) {
        let mass: f64 = [&self.gas.particles.m, &self.dust.particles.m, &self.bodies.m].into_iter().flatten().sum();
        let stray = std::mem::replace(&mut self.stray, Vec3::zeros());
        if mass == 0.0 || stray == Vec3::zeros() {
            return;
        }
        let shift = stray / mass;
        for v in [&mut self.gas.particles.v, &mut self.gas.rates.v_pred, &mut self.dust.particles.v, &mut self.dust.rates.v_pred] {
            v.iter_mut().for_each(|v| *v -= shift);
        }
        self.bodies.v.iter_mut().for_each(|v| *v -= shift);
        self.look();
    }

    /// The next tick at which anybody is active.
    pub fn next_tick(&self) -> u32 {
        let ends = |column: &[u32]| column.iter().copied().min().unwrap_or(nbody::points::clock::TICKS);
        let bodies = if self.star.x.is_empty() && self.bodies.x.is_empty() { nbody::points::clock::TICKS } else { self.pace.end };
        ends(&self.gas.particles.end).min(ends(&self.dust.particles.end)).min(bodies)
    }
}
