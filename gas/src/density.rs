//! Density: the smoothing length that encloses the wanted number of neighbours, and the sums over them.
//!
//! V_d H^d n_i = neighbours,   n_i = sum_j W(r_ij, H_i),   rho_i = sum_j m_j W(r_ij, H_i) - e m_i W(0, H_i)
//! g_i = (S_m - d sum m_j w) / S,   S = -sum q dw/dq,   S_m = -sum m_j q dw/dq
//! div v = -1/rho_i sum_j (m_j - g_i) v_ij.grad W,   curl v likewise
//!
//! The sum y of the [`formulation`](crate::formulation) has x for m in the first two lines; grad_h = g_i / x_i is that of y. e corrects the
//! sums for what the particle itself counts too much; the force follows from them all the same. Where h stands at its bound for want of particles it does not follow them, and g = 0.
//! Sources: Springel & Hernquist (2002); Hopkins (2013), eq. 12 for the number-density constraint;
//! Dehnen & Aly (2012) for e.

use fearless_simd::Level;
use nbody::points::sum::CHUNK;
use nbody::points::{Clock, Fault, Population, Vec3};
use rayon::prelude::*;

use crate::formulation::{Content, Mass, PressureVolume};
use crate::neighbours::{Frame, branches};
use crate::units::Units;
use crate::workspace::Element;
use crate::{CubicSpline, Formulation, Gas, Hydro, KernelKind, Precision, Viscosity, WendlandC2};

mod law;
mod out;
mod pack;
mod shear;
mod sums;
mod sweep;

use law::Law;
use out::{Out, State};
use pack::Pack;
use sums::{All, QUADS, Terms};
use sweep::Sweep;
pub use sweep::Target;

impl Gas {
    /// Renews what follows from the state: for active particles h and all of `derived`; for the others, which are predicted, pressure and
    /// sound speed. `centre` is where the star stands, for gas whose temperature depends on it. Returns the number of active particles.
    pub fn density(&mut self, hydro: &Hydro, clock: &Clock, centre: Vec3) -> Result<usize, Fault> {
        let gradient = self.remember(hydro);
        self.thermal_state(hydro, centre);
        match (hydro.formulation, gradient) {
            (Formulation::Density, false) => self.density_of::<Mass, false>(hydro, clock),
            (Formulation::Density, true) => self.density_of::<Mass, true>(hydro, clock),
            (Formulation::Pressure, false) => {
                self.density_of::<PressureVolume, false>(hydro, clock)
            }
            (Formulation::Pressure, true) => self.density_of::<PressureVolume, true>(hydro, clock),
        }
    }

    /// Makes room in the columns that a formulation and a switch remember; says whether the velocity gradient is wanted.
    fn remember(&mut self, hydro: &Hydro) -> bool {
        let n = self.particles.m.len();
        match hydro.formulation {
            Formulation::Density => self.derived.p_ratio.clear(),
            Formulation::Pressure => self.derived.p_ratio.resize(n, 1.0),
        }
        let gradient = matches!(hydro.viscosity, Viscosity::CullenDehnen { .. });
        if gradient {
            self.particles.trace_v.resize(n, 0.0);
        }
        gradient
    }

    fn density_of<C: Content, const GRADIENT: bool>(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
    ) -> Result<usize, Fault> {
        match (hydro.kernel, hydro.precision) {
            (KernelKind::CubicSpline, Precision::Single) => {
                self.density_with::<All<CubicSpline, C, GRADIENT>, f32>(hydro, clock)
            }
            (KernelKind::CubicSpline, Precision::Double) => {
                self.density_with::<All<CubicSpline, C, GRADIENT>, f64>(hydro, clock)
            }
            (KernelKind::WendlandC2, Precision::Single) => {
                self.density_with::<All<WendlandC2, C, GRADIENT>, f32>(hydro, clock)
            }
            (KernelKind::WendlandC2, Precision::Double) => {
                self.density_with::<All<WendlandC2, C, GRADIENT>, f64>(hydro, clock)
            }
        }
    }

    /// Pressure and sound speed of all gas as predicted; gas bound to a temperature is brought to it.
    fn thermal_state(&mut self, hydro: &Hydro, centre: Vec3) {
        let (x, rho) = (&self.particles.x, &self.derived.rho);
        let (p, cs) = (&mut self.derived.p, &mut self.derived.cs);
        let ratio = &self.derived.p_ratio;
        p.par_iter_mut()
            .zip(cs)
            .zip(&mut self.rates.u_pred)
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(i, ((p, cs), u))| {
                *u = hydro.eos.bound_energy(x[i] - centre).unwrap_or(*u);
                *p = hydro.eos.pressure(rho[i], *u) * ratio.get(i).unwrap_or(&1.0);
                *cs = hydro.eos.sound_speed(*u);
            });
    }

    fn density_with<T: Terms, E: Element>(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
    ) -> Result<usize, Fault> {
        if self.is_empty() {
            return Ok(0);
        }
        let level = self.level.unwrap_or_else(Level::new);
        let mut packed = std::mem::take(E::packed(&mut self.packed));
        let (particles, derived) = (&mut self.particles, &mut self.derived);
        let (h, m, v) = (&particles.h, &particles.m, &self.rates.v_pred);
        let units = Units::new(hydro, &self.tree, h, m, v, &derived.cs);
        let frame = Frame {
            tree: &self.tree,
            domain: &hydro.domain,
            x: &particles.x,
            units,
        };
        let pack = Pack {
            hydro,
            units,
            particles,
            cs: &derived.cs,
            v,
        };
        packed.fill::<QUADS>(&frame, |i, _, _| (0.0, pack.source::<T, E>(i)));
        let state = State {
            h: &mut particles.h,
            alpha: &mut particles.alpha,
            trace_v: &mut particles.trace_v,
        };
        let (u, begin) = (&self.rates.u_pred, &particles.begin);
        let out = Out::new((hydro, clock, &units), state, derived, u, begin);
        let root = &self.tree.nodes[0];
        let extent = hydro.domain.in_plane(root.hi - root.lo).norm();
        let sweep = Sweep {
            hydro,
            clock,
            frame,
            packed: &packed,
            end: &particles.end,
            m: &particles.m,
            largest: hydro.largest_reach(extent) / units.length,
            h_by_reach: units.length / hydro.support(),
            law: Law::new::<T::Kernel>(hydro),
            level,
            out,
        };
        branches(&self.tree, &mut self.branches);
        let tally = sweep.run::<T>(&self.branches);
        *E::packed(&mut self.packed) = packed;
        match tally.failed {
            None => Ok(tally.targets),
            Some((i, reach)) => Err(Fault::DensityNotConverged {
                population: Population::Gas,
                id: self.particles.id[i],
                smoothing_length: reach * units.length / hydro.support(),
                time: clock.time(),
            }),
        }
    }
}

#[cfg(test)]
mod tests;
