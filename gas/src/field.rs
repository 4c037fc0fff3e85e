//! Gravity of the gas: the pulls that have the steps of its forces, and a field with longer steps of its own (FAST).
//!
//! v -> v + D/2 f(x),   [ kick s/2, drift s, kick s/2 ] D/s times,   v -> v + D/2 f(x)
//!
//! f is the tree's field, D its step, s <= D that of pressure, viscosity and of what pulls pair by pair; the last may be large (a star) and costs little.
//! D <= C_f sqrt(h / |f|) with C_f = 0.7 C,   D <= C_o / Omega about the star. Between the ends of D a particle is seen as if it had been kicked all the while.
//! Sources: Tuckerman, Berne & Martyna (1992), section II (symmetric form); Saitoh & Makino (2010), PASJ 62, 301 (in SPH).

use nbody::points::clock::Pacing;
use nbody::points::sum::{CHUNK, Parts};
use nbody::points::{Clock, Vec3, clock};
use rayon::prelude::*;

use crate::{Gas, Hydro, Particles, Rates};

/// C_f by the factor of the other forces: here a collapse keeps its energy as well as with common steps.
const FIELD: f64 = 0.7;

/// What pulls the gas; columns are empty where nothing does.
#[derive(Clone, Copy)]
pub(crate) struct Pulls<'a> {
    pub gravity: &'a [Vec3],
    pub field: &'a [Vec3],
}

impl Pulls<'_> {
    /// The acceleration of particle i by gravity that has the steps of the forces.
    #[inline(always)]
    pub fn gravity(&self, i: usize) -> Vec3 {
        of(self.gravity, i)
    }

    /// The acceleration of particle i by both.
    #[inline(always)]
    pub fn of(&self, i: usize) -> Vec3 {
        of(self.gravity, i) + of(self.field, i)
    }
}

/// Entry i of a column that may be empty.
#[inline(always)]
fn of(column: &[Vec3], i: usize) -> Vec3 {
    column.get(i).copied().unwrap_or_else(Vec3::zeros)
}

impl Rates {
    /// Acceleration of particle i by all gravity.
    pub fn attraction(&self, i: usize) -> Vec3 {
        self.steady(i) + of(&self.field, i)
    }

    /// Acceleration of particle i by gravity that has the steps of the forces.
    pub fn steady(&self, i: usize) -> Vec3 {
        of(&self.gravity, i)
    }
}

impl Gas {
    /// Makes room for gravity that has the steps of the forces, or for a field with steps of its own.
    pub fn feel(&mut self, gravity: bool, field: bool) {
        let n = self.len();
        if gravity {
            self.rates.gravity.resize(n, Vec3::zeros());
        }
        if field {
            self.rates.field.resize(n, Vec3::zeros());
            for column in [
                &mut self.particles.field_begin,
                &mut self.particles.field_span,
                &mut self.rates.next_field_span,
            ] {
                column.resize(n, 0);
            }
        }
    }

    /// Whether the field has steps of its own.
    pub fn has_field(&self) -> bool {
        !self.rates.field.is_empty()
    }

    /// Whether the step of the field on particle i ends now, if there is one.
    pub fn field_ends(&self, clock: &Clock, i: usize) -> bool {
        ends(&self.particles, clock, i)
    }

    /// Whether any step of the field ends now.
    pub fn field_due(&self, clock: &Clock) -> bool {
        let n = self.particles.field_begin.len();
        let any = |i: usize| ends(&self.particles, clock, i);
        n > 0 && (clock.synchronous() || (0..n).into_par_iter().with_min_len(CHUNK).any(any))
    }

    /// The time that the next step of the field on particle i may last.
    pub(crate) fn wanted_field_step(&self, hydro: &Hydro, pacing: &Pacing, i: usize) -> f64 {
        let pull = self.rates.field[i].norm();
        let force = FIELD * hydro.force_factor * (self.particles.h[i] / pull).sqrt();
        if force.is_nan() {
            return f64::NAN;
        }
        force.min(pacing.limit(self.particles.x[i]))
    }

    /// Gives each active particle the gravity `pull(its gravity, its place)`.
    pub fn pull(&mut self, pull: impl Fn(Vec3, &Particles, usize) -> Vec3 + Sync) {
        self.feel(true, false);
        let (particles, gravity) = (&self.particles, Parts::new(&mut self.rates.gravity));
        let active = self.vicinity.active.par_iter().with_min_len(CHUNK);
        active.for_each(|&i| {
            let i = i as usize;
            // SAFETY: each active particle is listed once.
            let own = unsafe { &mut gravity.part(i..i + 1)[0] };
            *own = pull(*own, particles, i);
        });
    }

    /// Weight, in time, with which the field closes its step on particle i now; before that, what brings the particle to where it is seen.
    pub fn field_closing(&self, clock: &Clock, i: usize) -> f64 {
        let p = &self.particles;
        clock::closing(clock.tick, p.field_begin[i], p.field_span[i]) * clock.unit()
    }
}

/// Whether the step of the field on particle i ends now.
#[inline(always)]
pub(crate) fn ends(particles: &Particles, clock: &Clock, i: usize) -> bool {
    clock.synchronous() || particles.field_begin[i] + particles.field_span[i] == clock.tick
}

#[cfg(test)]
mod tests;
