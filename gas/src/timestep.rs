//! Time steps of the gas: how long they are, and the kicks and drifts that they are made of.
//!
//! dt <= 2 C h / v_sig,   dt <= C_f sqrt(h / |hydro + gravity - a_star|),   dt <= C_o / Omega about the star,
//! dt <= 4 times the shortest step of a neighbour (Saitoh & Makino 2009)
//!
//! At a tick: `density`, `steps`, `forces`, `close`, `open`; then `drift` to the next tick and `refit`. A closed synchronous step has x, v
//! and u at one time. Pair impulses also reach particles in mid-step; gravity of a particle is kicked at its own ends. Second order.

use nbody::points::clock::Pacing;
use nbody::points::sum::CHUNK;
use nbody::points::{Clock, Domain, Fault, Population, clock};
use rayon::prelude::*;

use crate::{Gas, Hydro};

/// The least part of its internal energy that a kick leaves to a particle.
const LEAST_PART: f64 = 0.1;

/// Energy that left or entered the gas other than by its forces; code units of energy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Heat {
    /// Taken away from gas that is bound to a temperature.
    pub radiated: f64,
    /// Put in to keep internal energies positive.
    pub floored: f64,
    /// How often that was needed.
    pub floors: usize,
}

impl Heat {
    /// The sum of both.
    pub fn and(self, other: Self) -> Self {
        Self {
            radiated: self.radiated + other.radiated,
            floored: self.floored + other.floored,
            floors: self.floors + other.floors,
        }
    }
}

impl Gas {
    /// Chooses the steps that begin now, in ticks of `next`; returns the shortest.
    pub fn steps(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        next: &Clock,
        pacing: &Pacing,
    ) -> Result<u32, Fault> {
        let mut next_span = std::mem::take(&mut self.rates.next_span);
        next_span
            .par_iter_mut()
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(i, span)| {
                *span = if self.active(clock, i) {
                    let dt = self.wanted_step(hydro, clock, pacing, i);
                    next.span(dt).unwrap_or(0)
                } else {
                    self.particles.span[i]
                };
            });
        self.rates.next_span = next_span;
        match self.rates.next_span.iter().position(|&span| span == 0) {
            Some(i) => Err(Fault::StepTooSmall {
                population: Population::Gas,
                id: self.particles.id[i],
                step: self.wanted_step(hydro, clock, pacing, i),
                shortest: next.unit(),
                time: clock.time(),
            }),
            None => Ok(self
                .rates
                .next_span
                .iter()
                .copied()
                .min()
                .unwrap_or(clock::TICKS)),
        }
    }

    /// The time that the next step of particle i may last; not a number if its state is none.
    pub fn wanted_step(&self, hydro: &Hydro, clock: &Clock, pacing: &Pacing, i: usize) -> f64 {
        let x = self.particles.x[i];
        let (h, near) = (self.particles.h[i], self.derived.near_span[i]);
        let courant = 2.0 * hydro.courant * h / self.derived.v_sig[i];
        let force =
            hydro.force_factor * (h / (self.acceleration(i) - pacing.central(x)).norm()).sqrt();
        if courant.is_nan() || force.is_nan() {
            return f64::NAN;
        }
        let limiter = if near == u32::MAX {
            f64::INFINITY
        } else {
            4.0 * f64::from(near) * clock.unit()
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

    /// Kicks that close the steps ending now.
    pub fn close(&mut self, hydro: &Hydro, clock: &Clock) -> Heat {
        let mut heat = Heat::default();
        for i in 0..self.len() {
            let active = self.active(clock, i);
            let (p, r) = (&mut self.particles, &mut self.rates);
            p.v[i] += r.dv_close[i];
            if active {
                let ticks = clock::closing(clock.tick, p.begin[i], p.span[i]);
                p.v[i] += ticks * clock.unit() * r.gravity[i];
            }
            let du = r.du_close[i];
            self.warm(hydro, i, du, &mut heat);
            if active {
                self.settle(i, hydro, &mut heat);
            }
        }
        heat
    }

    /// Kicks that open the steps beginning now.
    pub fn open(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> Heat {
        let mut heat = Heat::default();
        for i in 0..self.len() {
            let active = self.active(clock, i);
            let (p, r) = (&mut self.particles, &mut self.rates);
            p.v[i] += r.dv_open[i];
            if active {
                p.v[i] += clock::opening(r.next_span[i]) * next.unit() * r.gravity[i];
                p.begin[i] = next.tick;
                p.span[i] = r.next_span[i];
                p.end[i] = next.tick + p.span[i];
            }
            p.end[i] = p.end[i].min(self.wake[i]);
            let du = r.du_open[i];
            self.warm(hydro, i, du, &mut heat);
        }
        heat
    }

    /// Adds `du` to the internal energy of particle i, but leaves it positive.
    fn warm(&mut self, hydro: &Hydro, i: usize, du: f64, heat: &mut Heat) {
        let u = &mut self.particles.u[i];
        let least = hydro.least_u.max(LEAST_PART * *u);
        let wanted = *u + du;
        *u = wanted;
        if wanted < least && hydro.eos.is_free() {
            *u = least;
            heat.floored += self.particles.m[i] * (least - wanted);
            heat.floors += 1;
        }
    }

    /// The prediction of particle i starts anew from its state; gas bound to a temperature gives off what it has too much.
    fn settle(&mut self, i: usize, hydro: &Hydro, heat: &mut Heat) {
        let (p, r) = (&mut self.particles, &mut self.rates);
        if hydro.eos.is_free() {
            r.u_pred[i] = p.u[i];
        } else {
            heat.radiated += p.m[i] * (p.u[i] - r.u_pred[i]);
            p.u[i] = r.u_pred[i];
        }
        r.v_pred[i] = p.v[i];
    }

    /// Moves all gas by the time `dt` and predicts what is seen of it.
    ///
    /// Positions leave the box of a periodic domain until [`Gas::refit`] brings them back.
    pub fn drift(&mut self, dt: f64, domain: &Domain) {
        let d = domain.dimensions() as i32;
        let (p, r) = (&mut self.particles, &mut self.rates);
        (p.x.par_iter_mut()
            .zip(&p.v)
            .zip(&mut r.v_pred)
            .zip(&r.hydro)
            .zip(&r.gravity))
        .with_min_len(CHUNK)
        .for_each(|((((x, v), v_pred), hydro), gravity)| {
            *x += dt * domain.in_plane(*v);
            *v_pred += dt * (hydro + gravity);
        });
        let rho = &mut self.derived.rho;
        (p.h.par_iter_mut()
            .zip(rho)
            .zip(&self.derived.div_v)
            .zip(&mut r.u_pred)
            .zip(&r.du))
        .with_min_len(CHUNK)
        .for_each(|((((h, rho), div_v), u), du)| {
            let stretch = (div_v * dt / f64::from(d)).exp();
            *h *= stretch;
            *rho /= stretch.powi(d);
            // Cooling as a decay: of the same first order, and positive.
            *u = if *du < 0.0 {
                *u * (du * dt / *u).exp()
            } else {
                *u + du * dt
            };
        });
    }

    /// Ends all steps where they are, as before the first: the state stays, the clock of the gas begins anew. After a synchronous close.
    pub fn rest(&mut self) {
        self.particles.begin.fill(0);
        self.particles.span.fill(0);
        self.particles.end.fill(0);
    }
}

#[cfg(test)]
mod tests;
