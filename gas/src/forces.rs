//! Pair forces of pressure and viscosity, and the impulses that they give.
//!
//! m_i dv_i/dt = -sum_j [ x_i (x_j - g_i) P_i/y_i^2 grad W(r, H_i) + x_j (x_i - g_j) P_j/y_j^2 grad W(r, H_j) + m_i m_j Pi_ij grad W_ij ]
//! m_i du_i/dt =  sum_j [ x_i (x_j - g_i) P_i/y_i^2 grad W(r, H_i) + m_i m_j Pi_ij grad W_ij / 2 ] . v_ij + conducted heat
//!
//! with x, y of the [`formulation`](crate::formulation), and W_ij the mean of the two kernels; forces have P less a [`background`](crate::background). Both members of a pair compute the same force from the same numbers. A pair steps with the
//! shorter step of the two: its force counts where at least one member is active, and the impulse goes to both.
//! Sources: Springel & Hernquist (2002); Hopkins (2013); pairwise steps: Saitoh & Makino (2009, 2010).

use fearless_simd::Level;
use nbody::points::Clock;

use crate::neighbours::Frame;
use crate::units::Units;
use crate::vicinity::Vicinity;
use crate::workspace::Element;
use crate::{Gas, Hydro, Precision};

mod out;
mod pack;
mod pair;
mod state;
mod sums;
mod sweep;

use out::Out;
pub use pack::Pace;
use pack::Pack;
use pair::{Flux, MORE, QUADS, STRAINED};
use state::States;
use sweep::Sweep;

/// A tick that never comes.
pub(crate) const NEVER: u32 = u32::MAX;

impl Gas {
    /// Forces of the pairs that have an active member: rates of the active particles, and the impulses that close the steps ending now and
    /// open those beginning now, in which `next` is the clock. Returns the number of particles that had such a pair.
    pub fn forces(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> usize {
        match hydro.precision {
            Precision::Single => self.forces_with::<f32>(hydro, clock, next),
            Precision::Double => self.forces_with::<f64>(hydro, clock, next),
        }
    }

    fn forces_with<E: Element>(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> usize {
        if self.is_empty() {
            return 0;
        }
        self.set_background(hydro, clock);
        let level = self.level.unwrap_or_else(Level::new);
        let mut packed = std::mem::take(E::packed(&mut self.packed));
        let (particles, derived, rates) = (&self.particles, &self.derived, &mut self.rates);
        let (support, h, m) = (hydro.support(), &particles.h, &particles.m);
        let active = |i: usize| clock.synchronous() || particles.end[i] == clock.tick;
        let Vicinity {
            near,
            leaves,
            near_branches,
            ..
        } = &self.vicinity;
        let own = |i: usize| support * h[i];
        (self.tree).largest_of(near, own, &mut self.extent);
        let own = |i: usize| if active(i) { support * h[i] } else { -1.0 };
        (self.tree).largest_of(leaves, own, &mut self.active_extent);
        self.wake.resize(m.len(), NEVER);
        let relative = |i: usize| hydro.domain.relative(particles.x[i], rates.v_pred[i]);
        let units = Units::new(hydro, (&self.tree, near), h, m, relative, &derived.cs);
        let frame = Frame {
            tree: &self.tree,
            domain: &hydro.domain,
            x: &particles.x,
            units,
        };
        let flux = Flux::new(hydro);
        let states = States {
            units,
            particles,
            derived,
            hydro,
            flux: &flux,
            background: self.background.pressure,
            offset: hydro.eos.offset() * units.length.powi(hydro.dimensions() as i32)
                / (units.mass * units.velocity * units.velocity),
        };
        let pack = Pack {
            clock,
            v: &rates.v_pred,
            u: &rates.u_pred,
            next_span: &rates.next_span,
            states: &states,
        };
        match flux.quads() {
            QUADS => packed.fill::<QUADS>(&frame, near, |i, d, coarser| pack.source(i, d, coarser)),
            STRAINED => {
                packed.fill::<STRAINED>(&frame, near, |i, d, coarser| pack.strained(i, d, coarser));
            }
            _ => packed.fill::<MORE>(&frame, near, |i, d, coarser| pack.more(i, d, coarser)),
        }
        pack.paces(&self.tree, near, &mut self.paces);
        let sweep = Sweep {
            clock,
            frame,
            packed: &packed,
            end: &particles.end,
            extent: [&self.extent, &self.active_extent],
            paces: &self.paces,
            level,
            flux,
            states: &states,
            out: Out::new(
                rates,
                (&mut self.wake, hydro.limiter),
                m,
                &units,
                [clock, next],
            ),
        };
        let targets = sweep.run(near_branches);
        *E::packed(&mut self.packed) = packed;
        targets
    }
}

#[cfg(test)]
mod tests;
