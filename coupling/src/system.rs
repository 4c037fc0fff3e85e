//! The system: all populations of a scene in their domain, on one clock.

use std::ops::Add;

use dust::Dust;
use gas::Gas;
use nalgebra::Matrix3;
use nbody::Bodies;
use nbody::encounters::Encounter;
use nbody::points::{Clock, Domain, Vec3, sum};
use rayon::prelude::*;

use crate::Ledger;
use crate::gravity::Heavy;
use crate::stress::Stress;
use crate::torques::{Braked, Torque};

/// The common step of star and bodies, in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    pub begin: u32,
    pub span: u32,
    pub end: u32,
    pub next_span: u32,
}

/// Where star and bodies are seen now: between their own ticks a prediction, at their ticks their state. Bodies without gas and dust
/// are never seen between ticks: of them nothing is kept.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    pub star_x: Vec<Vec3>,
    pub star_v: Vec<Vec3>,
    pub x: Vec<Vec3>,
    pub v: Vec<Vec3>,
}

impl Seen {
    /// Where bodies are seen whose own positions are `x`.
    pub fn places<'a>(&'a self, x: &'a [Vec3]) -> &'a [Vec3] {
        if self.x.is_empty() { x } else { &self.x }
    }
}

/// Net impulse and torque (about the origin) of a field that should have none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stray {
    pub impulse: Vec3,
    pub torque: Vec3,
}

impl Stray {
    /// An impulse `p` at `x`.
    pub fn at(x: Vec3, p: Vec3) -> Self {
        Self {
            impulse: p,
            torque: x.cross(&p),
        }
    }
}

impl Add for Stray {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            impulse: self.impulse + o.impulse,
            torque: self.torque + o.torque,
        }
    }
}

/// Moments of mass of gas, dust and bodies together.
#[derive(Clone, Copy, Debug, Default)]
struct Figure {
    mass: f64,
    first: Vec3,
    second: Matrix3<f64>,
}

impl Figure {
    fn of(system: &System) -> Self {
        let sets = [
            (&system.gas.particles.m, &system.gas.particles.x),
            (&system.dust.particles.m, &system.dust.particles.x),
            (&system.bodies.m, &system.bodies.x),
        ];
        sets.into_iter().fold(Self::default(), |figure, (m, x)| {
            figure
                + sum::ordered(m.len(), Self::default(), |range| {
                    range.fold(Self::default(), |figure, i| {
                        figure
                            + Self {
                                mass: m[i],
                                first: m[i] * x[i],
                                second: m[i] * x[i] * x[i].transpose(),
                            }
                    })
                })
        })
    }

    /// The tensor of inertia about `centre`, the centre of mass.
    fn inertia(&self, centre: Vec3) -> Matrix3<f64> {
        let spread = self.second - self.mass * centre * centre.transpose();
        Matrix3::identity() * spread.trace() - spread
    }
}

impl Add for Figure {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Self {
            mass: self.mass + o.mass,
            first: self.first + o.first,
            second: self.second + o.second,
        }
    }
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
    /// What the tree's field has given to gas, dust and bodies in sum since everybody was last active. Without truncation it would be
    /// zero whenever everybody is.
    pub stray: Stray,
    /// Impulses (momenta) that star and bodies receive at their next tick; bodies without gas and dust receive none.
    pub pending_star: Vec<Vec3>,
    pub pending_bodies: Vec<Vec3>,
    pub gas: Gas,
    pub dust: Dust,
    pub ledger: Ledger,
    /// The longest base step, and the step of star and bodies: chosen at the start of a run and kept.
    pub longest: f64,
    pub bodies_step: f64,
    /// The longest base step that the tolerance of drag's splitting allows.
    pub drag_step: f64,
    /// What an integrator of bodies remembers between steps; empty for those that remember nothing.
    pub memory: Vec<f64>,
    /// The identity that the next new body has.
    pub next_id: u64,
    /// Pairs of bodies that an integrator found touching inside the step that ends now, beside those on straight paths.
    pub touches: Vec<Encounter>,
    /// Whether potentials are wanted at this tick.
    pub reporting: bool,
    /// Whether gas or dust have changed their masses since everything was prepared at this tick.
    pub reweighed: bool,
    /// What the bodies' pulls on each other add to their `a` that their integrator does in its drift, when last reported; empty unless
    /// that is wanted.
    pub held_back: Vec<Vec3>,
    /// The integrator of bodies that a run chose at its start, by a number of the chooser's.
    pub chosen: u64,
    /// Memory for the list of those that pull pair by pair, and for what they receive.
    pub(crate) heavies: Vec<Heavy>,
    pub(crate) given: Vec<Vec3>,
    /// What has happened since the events were last written.
    pub events: Vec<crate::accretion::Event>,
    /// Potential energy of the whole system when last reported.
    pub potential: f64,
    /// The pulls on planets when last reported, and what drag has given them since.
    pub torques: Vec<Torque>,
    pub braked: Braked,
    /// The stress of the gas in rings about the star; empty unless somebody measures it.
    pub stress: Stress,
    /// How often places of the gas were solved for since the start of the run.
    pub solves: gas::Solves,
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
            stray: Stray::default(),
            pending_star: Vec::new(),
            pending_bodies: Vec::new(),
            gas: Gas::default(),
            dust: Dust::default(),
            ledger: Ledger::default(),
            longest: f64::INFINITY,
            bodies_step: f64::INFINITY,
            drag_step: f64::INFINITY,
            memory: Vec::new(),
            next_id: 0,
            touches: Vec::new(),
            reporting: false,
            reweighed: false,
            held_back: Vec::new(),
            chosen: 0,
            heavies: Vec::new(),
            given: Vec::new(),
            events: Vec::new(),
            potential: 0.0,
            torques: Vec::new(),
            solves: gas::Solves::default(),
            braked: Braked {
                since: time,
                ..Braked::default()
            },
            stress: Stress {
                time,
                ..Stress::default()
            },
        }
    }

    /// Begins the count of new bodies' identities after all that there are.
    pub fn number_on(&mut self) {
        let ids = [
            &self.star.id,
            &self.bodies.id,
            &self.gas.particles.id,
            &self.dust.particles.id,
        ];
        self.next_id = ids.into_iter().flatten().max().map_or(0, |last| last + 1);
    }

    /// Whether a step that ends at `end` ends now.
    pub fn active(&self, end: u32) -> bool {
        self.clock.synchronous() || end == self.clock.tick
    }

    /// Lists the places of the dust whose step ends now.
    pub(crate) fn list_active_dust(&self, places: &mut Vec<u32>) {
        places.clear();
        let ends = self.dust.particles.end.iter().enumerate();
        places.extend(
            ends.filter(|(_, end)| self.active(**end))
                .map(|(i, _)| i as u32),
        );
    }

    /// Whether star and bodies are active now.
    pub fn bodies_active(&self) -> bool {
        self.active(self.pace.end)
    }

    /// Whether any gas, dust or bodies of those asked for feel the field of all masses now: at the end of their step, or of that of the field.
    pub fn feels(&self, [gas, dust, bodies]: [bool; 3]) -> bool {
        let clock = &self.clock;
        let ends = |column: &[u32]| column.contains(&clock.tick);
        let gas_feels = || match self.gas.has_field() {
            true => self.gas.field_due(clock),
            false => ends(&self.gas.particles.end),
        };
        clock.synchronous()
            || bodies && self.bodies_active()
            || dust && ends(&self.dust.particles.end)
            || gas && gas_feels()
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
        self.pending_star.resize(self.star.x.len(), Vec3::zeros());
        if self.gas.is_empty() && self.dust.is_empty() {
            (self.seen.x, self.seen.v) = (Vec::new(), Vec::new());
        } else {
            self.seen.x.clone_from(&self.bodies.x);
            self.seen.v.clone_from(&self.bodies.v);
            let n = self.bodies.x.len();
            self.pending_bodies.resize(n, Vec3::zeros());
        }
    }

    /// Gives star and bodies their summed impulses.
    pub fn settle_impulses(&mut self) {
        for (bodies, pending) in [
            (&mut self.star, &mut self.pending_star),
            (&mut self.bodies, &mut self.pending_bodies),
        ] {
            for ((v, &m), impulse) in bodies.v.iter_mut().zip(&bodies.m).zip(pending.iter_mut()) {
                if *impulse != Vec3::zeros() {
                    *v += *impulse / m;
                    *impulse = Vec3::zeros();
                }
            }
        }
    }

    /// Takes the stray impulse and torque of the tree's field out of gas, dust and bodies, by one velocity and one rotation about their centre
    /// of mass for all. To be called when everybody's step is closed.
    pub fn recall_stray(&mut self) {
        let stray = std::mem::take(&mut self.stray);
        let figure = Figure::of(self);
        if figure.mass == 0.0 || stray == Stray::default() {
            return;
        }
        let shift = stray.impulse / figure.mass;
        let centre = figure.first / figure.mass;
        let torque = stray.torque - centre.cross(&stray.impulse);
        let inertia = figure.inertia(centre);
        // Particles on a line, or a single one, have no rotation that takes up every torque; of a single one rounding leaves an inertia.
        let spread = inertia.trace() > 1e-9 * figure.second.trace();
        let turnable = spread && inertia.determinant() > 1e-9 * inertia.trace().powi(3);
        let omega = inertia
            .try_inverse()
            .filter(|_| turnable)
            .map_or_else(Vec3::zeros, |inverse| inverse * torque);
        let change = |x: Vec3| shift + omega.cross(&(x - centre));
        let (gas, dust, bodies) = (&mut self.gas, &mut self.dust, &mut self.bodies);
        for (x, v) in [
            (&gas.particles.x, &mut gas.particles.v),
            (&gas.particles.x, &mut gas.rates.v_pred),
            (&dust.particles.x, &mut dust.particles.v),
            (&dust.particles.x, &mut dust.rates.v_pred),
            (&bodies.x, &mut bodies.v),
        ] {
            v.par_iter_mut()
                .zip(x)
                .with_min_len(sum::CHUNK)
                .for_each(|(v, &x)| *v -= change(x));
        }
        self.look();
    }

    /// The next tick at which anybody is active.
    pub fn next_tick(&self) -> u32 {
        let ends = |column: &[u32]| {
            column
                .iter()
                .copied()
                .min()
                .unwrap_or(nbody::points::clock::TICKS)
        };
        let bodies = if self.star.x.is_empty() && self.bodies.x.is_empty() {
            nbody::points::clock::TICKS
        } else {
            self.pace.end
        };
        ends(&self.gas.particles.end)
            .min(ends(&self.dust.particles.end))
            .min(bodies)
    }
}

#[cfg(test)]
mod tests;
