//! Time steps of the gas: how long they are, and the kicks and drifts that they are made of.
//!
//! dt <= 2 C h / v_sig (less by strong viscosities),   dt <= C_f sqrt(h / |hydro + gravity - a_star|),   dt <= C_o / Omega about the star,
//! dt <= 4 times the shortest step of a neighbour (Saitoh & Makino 2009);   a field with steps of its own has no part in
//! the acceleration here (`field`)
//!
//! At a tick: `density`, `steps`, `forces`, `close`, `open`; then `refit` to the next tick, where who is looked at has drifted. A closed synchronous step has x, v
//! and u at one time. Pair impulses also reach particles in mid-step; gravity of a particle is kicked at its own ends. Second order.

use nbody::points::clock::Pacing;
use nbody::points::sum::{self, Parts};
use nbody::points::{Clock, Fault, Population, Vec3, clock};

use crate::leaves::UNSEEN;
use crate::{Gas, Hydro};

mod kicks;

/// The least part of its internal energy that a kick leaves to a particle.
const LEAST_PART: f64 = 0.1;

/// Logarithm of the factor by which h is let change in a step by the divergence seen at its begin: next to gas a million times denser, whose
/// kernel's edge has no finite relative slope, that would have no bound.
const SWELLING: f64 = std::f64::consts::LN_2;

/// Energy that left or entered the gas other than by its forces, code units of energy; and momentum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heat {
    /// Taken away from gas that is bound to a temperature.
    pub radiated: f64,
    /// Put in to keep internal energies positive.
    pub floored: f64,
    /// How often that was needed.
    pub floors: usize,
    /// Momentum that the frame of a shearing box gave, and what pulls in it.
    pub frame: Vec3,
}

impl Heat {
    /// The sum of both.
    pub fn and(self, other: Self) -> Self {
        Self {
            radiated: self.radiated + other.radiated,
            floored: self.floored + other.floored,
            floors: self.floors + other.floors,
            frame: self.frame + other.frame,
        }
    }
}

impl std::ops::Add for Heat {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        self.and(other)
    }
}

/// The shortest step, and the first particle that has it.
#[derive(Clone, Copy)]
struct Shortest {
    span: u32,
    of: usize,
}

impl Default for Shortest {
    fn default() -> Self {
        Self {
            span: clock::TICKS,
            of: usize::MAX,
        }
    }
}

impl std::ops::Add for Shortest {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        if other.span < self.span { other } else { self }
    }
}

impl Gas {
    /// Chooses the steps that begin now, in ticks of `next`; returns the shortest. What is not active keeps in `next_span` the step it has.
    pub fn steps(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        next: &Clock,
        pacing: &Pacing,
    ) -> Result<u32, Fault> {
        let mut next_span = std::mem::take(&mut self.rates.next_span);
        let mut next_field_span = std::mem::take(&mut self.rates.next_field_span);
        let chosen = Parts::new(&mut next_span);
        let chosen_field = Parts::new(&mut next_field_span);
        let mut div_v = std::mem::take(&mut self.derived.div_v);
        let rates = Parts::new(&mut div_v);
        let most = SWELLING * hydro.dimensions() as f64;
        let active = &self.vicinity.active;
        let shortest = sum::ordered(active.len(), Shortest::default(), |range| {
            active[range].iter().fold(Shortest::default(), |least, &i| {
                let i = i as usize;
                let dt = self.wanted_step(hydro, clock, pacing, i);
                let mut span = next.span(dt).unwrap_or(0);
                if self.has_field() {
                    let whole = if self.field_ends(clock, i) {
                        let dt = self.wanted_field_step(hydro, pacing, i);
                        let whole = next.span(dt).unwrap_or(0);
                        // SAFETY: each active particle is listed once.
                        unsafe { chosen_field.part(i..i + 1)[0] = whole };
                        whole
                    } else {
                        self.particles.field_span[i]
                    };
                    span = span.min(whole);
                }
                // SAFETY: each active particle is listed once.
                unsafe {
                    chosen.part(i..i + 1)[0] = span;
                    let rate = &mut rates.part(i..i + 1)[0];
                    let most = most / (f64::from(span) * next.unit());
                    *rate = rate.clamp(-most, most);
                }
                least + Shortest { span, of: i }
            })
        });
        self.derived.div_v = div_v;
        self.rates.next_span = next_span;
        self.rates.next_field_span = next_field_span;
        let Shortest { span, of } = shortest;
        if span > 0 {
            return Ok(span);
        }
        let own = self.wanted_step(hydro, clock, pacing, of);
        let of_field = match self.has_field() {
            true => self.wanted_field_step(hydro, pacing, of),
            false => f64::INFINITY,
        };
        let (population, id, time) = (Population::Gas, self.particles.id[of], clock.time());
        if own.is_nan() || of_field.is_nan() {
            let quantity = "the wanted time step";
            return Err(Fault::NonFinite {
                population,
                id,
                quantity,
                time,
            });
        }
        Err(Fault::StepTooSmall {
            population,
            id,
            step: own.min(of_field),
            shortest: next.unit(),
            time,
        })
    }

    /// The time that the next step of particle i may last; not a number if its state is none.
    pub fn wanted_step(&self, hydro: &Hydro, clock: &Clock, pacing: &Pacing, i: usize) -> f64 {
        let x = self.particles.x[i];
        let (h, near) = (self.particles.h[i], self.derived.near_span[i]);
        let courant = 2.0 * hydro.courant * hydro.viscosity.calm() * h / self.derived.v_sig[i];
        let own = self.rates.hydro[i] + self.rates.steady(i);
        let force = hydro.force_factor * (h / (own - pacing.central(x)).norm()).sqrt();
        if courant.is_nan() || force.is_nan() {
            return f64::NAN;
        }
        let limiter = if near == u32::MAX {
            f64::INFINITY
        } else {
            f64::from(hydro.limiter) * f64::from(near) * clock.unit()
        };
        courant.min(force).min(limiter).min(pacing.limit(x))
    }

    /// Whether the step of particle i ends now.
    pub fn active(&self, clock: &Clock, i: usize) -> bool {
        clock.synchronous() || self.particles.end[i] == clock.tick
    }

    /// The tick at which the next step ends.
    pub fn next_tick(&self) -> u32 {
        self.particles
            .end
            .iter()
            .copied()
            .min()
            .unwrap_or(clock::TICKS)
    }

    /// Ends all steps where they are, as before the first: the state stays, the clock of the gas begins anew. After a synchronous close.
    pub fn rest(&mut self) {
        self.particles.begin.fill(0);
        self.particles.span.fill(0);
        self.particles.end.fill(0);
        self.particles.field_begin.fill(0);
        self.particles.field_span.fill(0);
        self.now = UNSEEN;
        self.bound();
    }
}

#[cfg(test)]
mod tests;
