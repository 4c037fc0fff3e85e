//! Kicks: the changes of velocity by gravity, pressure and viscosity, at both ends of a particle's step.
//!
//! Gas is kicked pair by pair by the impulses of its force sweep, and by gravity; dust and bodies by gravity. What star and planets
//! give to gas and dust they receive in turn at once, if they are active, or at their next tick.

use gas::Hydro;
use nbody::points::clock::{Centre, Pacing};
use nbody::points::{Clock, Fault, Vec3, sum};

use crate::System;
use crate::gravity::{Heavy, Softening, heavies};
use crate::ledger::Census;
use crate::operator::{Meter, Operator, Phase};
use crate::system::Stray;

/// Finds density, pressure and what else a gas particle needs before forces.
pub struct Density {
    pub hydro: Hydro,
}

impl Operator for Density {
    fn name(&self) -> &'static str {
        "density"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Density);
        let centre = system
            .seen
            .star_x
            .first()
            .copied()
            .unwrap_or_else(Vec3::zeros);
        let targets = system.gas.density(&self.hydro, &system.clock, centre)?;
        meter.count(targets, 0);
        Ok(())
    }
}

/// What star and planets receive of the pulls that they exert on gas and dust.
#[derive(Clone, Copy, Debug)]
pub struct Reaction {
    /// Whether the star pulls the fluid.
    pub pulled: bool,
    /// Whether the fluid pulls star, and planets.
    pub on: [bool; 2],
    pub softening: Softening,
}

/// The weight in time of a kick, and the step that it is part of.
struct Weight {
    time: f64,
    step: f64,
}

impl Weight {
    /// Of the kick that closes a step.
    fn closing(system: &System, begin: u32, span: u32) -> Self {
        Self {
            time: system.closing(begin, span),
            step: f64::from(span) * system.clock.unit(),
        }
    }

    /// Of the kick that opens a step.
    fn opening(system: &System, span: u32) -> Self {
        Self {
            time: system.opening(span),
            step: f64::from(span) * system.next.unit(),
        }
    }
}

/// The particles that react, with the weight in time of their kick now.
struct Kicked<'a> {
    x: &'a [Vec3],
    m: &'a [f64],
    h: &'a [f64],
    gravity: &'a [Vec3],
    /// Places of those that are kicked.
    active: &'a [u32],
}

impl Kicked<'_> {
    /// Net impulse and torque of the pulls `pull(i)`, each with its weight in time, on those that are kicked.
    fn stray(&self, pull: impl Fn(usize) -> (Vec3, f64) + Sync) -> Stray {
        sum::ordered(self.active.len(), Stray::default(), |range| {
            (self.active[range].iter()).fold(Stray::default(), |sum, &i| {
                let i = i as usize;
                let (pull, weight) = pull(i);
                sum + Stray::at(self.x[i], pull * (self.m[i] * weight))
            })
        })
    }
}

impl Reaction {
    /// The star, if it pulls the fluid.
    fn centre(self, system: &System) -> Centre {
        match system.seen.star_x.first() {
            Some(&x) if self.pulled => Centre {
                x,
                gm: system.g * system.star.m[0],
            },
            _ => Centre::default(),
        }
    }

    /// What star and planets receive that balances their pulls on `kicked`, in steps of `pace(i)`.
    fn act(
        self,
        (g, heavies, mut received): (f64, &[Heavy], Vec<Vec3>),
        centre: &Centre,
        kicked: &Kicked,
        pace: impl Fn(usize) -> Weight + Sync,
    ) -> Given {
        let active = kicked.active;
        let lacking = |i: usize, dt: f64| centre.lacking(kicked.x[i], dt);
        received.clear();
        received.extend(heavies.iter().map(|heavy| {
            if !self.on[usize::from(!heavy.star)] {
                return Vec3::zeros();
            }
            sum::ordered(active.len(), Vec3::zeros(), |range| {
                active[range].iter().fold(Vec3::zeros(), |sum, &i| {
                    let (i, Weight { time, step }) = (i as usize, pace(i as usize));
                    let mut pull = g * heavy.pull(kicked.x[i], self.softening.of(kicked.h[i])).0;
                    if heavy.star {
                        pull += lacking(i, step);
                    }
                    sum - pull * (kicked.m[i] * time)
                })
            })
        }));
        let given = kicked.stray(|i| {
            let Weight { time, step } = pace(i);
            let gravity = kicked.gravity.get(i).copied();
            let gravity = gravity.unwrap_or_else(Vec3::zeros);
            (gravity + lacking(i, step), time)
        });
        let stray = (heavies.iter().zip(&received))
            .fold(given, |sum, (heavy, &back)| sum + Stray::at(heavy.x, back));
        Given { received, stray }
    }
}

/// What a kick gives to star and planets, one by one, and what is left over: the net effect of the tree's field.
struct Given {
    received: Vec<Vec3>,
    stray: Stray,
}

fn receive(system: &mut System, heavies: Vec<Heavy>, Given { received, stray }: Given) {
    system.stray = system.stray + stray;
    for (heavy, &impulse) in heavies.iter().zip(&received) {
        let pending = if heavy.star {
            &mut system.pending_star
        } else {
            &mut system.pending_bodies
        };
        pending[heavy.place] += impulse;
    }
    (system.heavies, system.given) = (heavies, received);
    if system.bodies_active() {
        system.settle_impulses();
        system.look();
    }
}

/// Kicks of the gas.
pub struct KickGas {
    pub hydro: Hydro,
    pub reaction: Reaction,
    pub pacing: Steps,
}

/// How long steps of gas and dust may be, whatever the particle's own criteria say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    pub longest: f64,
    /// Part of 1/Omega about the star.
    pub orbit: f64,
}

impl Steps {
    fn of(self, system: &System) -> Pacing {
        match system.seen.star_x.first() {
            Some(&centre) => Pacing {
                longest: self.longest,
                centre,
                gm: system.g * system.star.m[0],
                orbit: self.orbit,
            },
            None => Pacing::free(self.longest),
        }
    }
}

impl KickGas {
    /// Lets star and planets react to the pulls that kick at `pace`, and notes the net effect of the field that kicks with `of_field`.
    fn react(
        &self,
        system: &mut System,
        pace: impl Fn(&System, usize) -> Weight + Sync,
        of_field: impl Fn(&System, usize) -> f64 + Sync,
    ) {
        let heavies = heavies(system);
        let memory = std::mem::take(&mut system.given);
        let centre = self.reaction.centre(system);
        let gas = &system.gas.particles;
        let kicked = Kicked {
            x: &gas.x,
            m: &gas.m,
            h: &gas.h,
            gravity: &system.gas.rates.gravity,
            active: system.gas.active_ones(),
        };
        let mut given = (self.reaction).act((system.g, &heavies, memory), &centre, &kicked, |i| {
            pace(system, i)
        });
        if system.gas.has_field() {
            let field = kicked.stray(|i| {
                let ends = system.gas.field_ends(&system.clock, i);
                let weight = if ends { of_field(system, i) } else { 0.0 };
                (system.gas.rates.field[i], weight)
            });
            given.stray = given.stray + field;
        }
        receive(system, heavies, given);
    }

    /// Books what `kick` changes: of the gas only what is near the active particles, and whoever reacts.
    fn book(&self, system: &mut System, kick: impl FnOnce(&mut System)) {
        let bodies = system.bodies_active() || self.reaction.on[1];
        let before = Census::near(system, bodies);
        kick(system);
        let after = Census::near(system, bodies);
        let change = Census(std::array::from_fn(|k| after.0[k] - before.0[k]));
        system.ledger.add(self.name(), &change);
    }
}

impl Operator for KickGas {
    fn name(&self) -> &'static str {
        "kick gas"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Hydro);
        if system.clock.step == 0 {
            // The first step's choice of a step needs accelerations; the weights of closing are still zero.
            system.gas.forces(&self.hydro, &system.clock, &system.clock);
        }
        system.gas.steps(
            &self.hydro,
            &system.clock,
            &system.next,
            &self.pacing.of(system),
        )?;
        let targets = system.gas.forces(&self.hydro, &system.clock, &system.next);
        meter.count(targets, 0);
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        self.book(system, |system| {
            self.react(
                system,
                |s, i| Weight::closing(s, s.gas.particles.begin[i], s.gas.particles.span[i]),
                |s, i| s.gas.field_closing(&s.clock, i),
            );
            let centre = self.reaction.centre(system);
            let heat = system.gas.close(&self.hydro, &system.clock, &centre);
            system.ledger.take(heat);
        });
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        self.book(system, |system| {
            self.react(
                system,
                |s, i| Weight::opening(s, s.gas.rates.next_span[i]),
                |s, i| s.opening(s.gas.rates.next_field_span[i]),
            );
            let centre = self.reaction.centre(system);
            let (clock, next) = (&system.clock, &system.next);
            let heat = system.gas.open(&self.hydro, clock, next, &centre);
            system.ledger.take(heat);
        });
        Ok(true)
    }
}

/// Kicks of the dust.
pub struct KickDust {
    pub pacing: Steps,
    /// Part of the time in which gravity, but for the star's, moves a grain by a smoothing length.
    pub force: f64,
    pub reaction: Reaction,
    /// Places of the dust whose step ends now.
    active: Vec<u32>,
}

impl KickDust {
    pub fn new(pacing: Steps, force: f64, reaction: Reaction) -> Self {
        Self {
            pacing,
            force,
            reaction,
            active: Vec::new(),
        }
    }

    fn react(&self, system: &mut System, pace: impl Fn(&System, usize) -> Weight + Sync) {
        let heavies = heavies(system);
        let memory = std::mem::take(&mut system.given);
        let centre = self.reaction.centre(system);
        let dust = &system.dust.particles;
        let kicked = Kicked {
            x: &dust.x,
            m: &dust.m,
            h: &dust.h,
            gravity: &system.dust.rates.gravity,
            active: &self.active,
        };
        let given = (self.reaction).act((system.g, &heavies, memory), &centre, &kicked, |i| {
            pace(system, i)
        });
        receive(system, heavies, given);
    }
}

impl Operator for KickDust {
    fn name(&self) -> &'static str {
        "kick dust"
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Dust);
        let pacing = self.pacing.of(system);
        let ends = system.dust.particles.end.iter().enumerate();
        self.active.clear();
        self.active.extend(
            ends.filter(|(_, end)| system.active(**end))
                .map(|(i, _)| i as u32),
        );
        system
            .dust
            .steps(&pacing, self.force, &system.clock, &system.next)?;
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        self.react(system, |s, i| {
            Weight::closing(s, s.dust.particles.begin[i], s.dust.particles.span[i])
        });
        let centre = self.reaction.centre(system);
        system.dust.close(&system.clock, &centre);
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Dust);
        self.react(system, |s, i| Weight::opening(s, s.dust.rates.next_span[i]));
        let centre = self.reaction.centre(system);
        system.dust.open(&system.clock, &system.next, &centre);
        Ok(true)
    }
}

/// Kicks of star and bodies by what their own integrator does not do; sets their step, and closes the books on the tree's field.
pub struct KickBodies {
    /// Whether pulls are mutual, so that the tree's field should have no net impulse.
    pub mutual: bool,
    /// The wanted step of the bodies' integrator.
    pub step: f64,
}

impl KickBodies {
    fn kick(system: &mut System, weight: f64) {
        for bodies in [&system.star, &system.bodies] {
            let given = (0..bodies.x.len())
                .map(|i| Stray::at(bodies.x[i], bodies.a[i] * (bodies.m[i] * weight)));
            system.stray = given.fold(system.stray, |sum, stray| sum + stray);
        }
        for bodies in [&mut system.star, &mut system.bodies] {
            for (v, a) in bodies.v.iter_mut().zip(&bodies.a) {
                *v += *a * weight;
            }
        }
        system.settle_impulses();
        system.look();
    }
}

impl Operator for KickBodies {
    fn name(&self) -> &'static str {
        "kick bodies"
    }

    fn counted(&self, system: &System) -> bool {
        system.bodies_active()
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        if system.bodies_active() {
            system.pace.next_span = span(&system.next, self.step)?;
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            Self::kick(system, system.closing(system.pace.begin, system.pace.span));
        }
        if system.clock.synchronous() && self.mutual {
            system.recall_stray();
        }
        Ok(active)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Bodies);
        let active = system.bodies_active();
        if active {
            Self::kick(system, system.opening(system.pace.next_span));
        }
        Ok(active)
    }
}

/// A base step may be longer than the bodies' by this part, as far as times between reports are rounded, and still be one step of theirs.
const ROUNDING: f64 = 1e-9;

/// The span in ticks of a bodies' step of at most `step`.
pub(crate) fn span(next: &Clock, step: f64) -> Result<u32, Fault> {
    next.span(step * (1.0 + ROUNDING))
        .ok_or(Fault::StepTooSmall {
            population: nbody::points::Population::Planetesimals,
            id: 0,
            step,
            shortest: next.unit(),
            time: next.time(),
        })
}

#[cfg(test)]
mod tests {
    use nbody::points::clock::TICKS;

    use super::*;

    /// Bodies' steps in a hundred base steps that end at multiples of `step`.
    fn spans(step: f64) -> Vec<u32> {
        let mut clock = Clock::standing(0.0);
        (1..=100)
            .map(|k| {
                clock = clock.next_base(f64::from(k) * step, step);
                let one = span(&clock, step).expect("a step of many ticks");
                clock.tick = TICKS;
                one
            })
            .collect()
    }

    #[test]
    fn a_base_step_of_the_bodies_length_is_one_step_of_theirs_however_it_is_rounded() {
        let step = 0.01 * std::f64::consts::TAU;
        assert_eq!(spans(step), [TICKS; 100]);
        assert_eq!(
            span(&Clock::standing(0.0).next_base(1.0, 1.0), 0.4).expect("a step"),
            TICKS / 4
        );
    }
}
