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

use std::sync::Mutex;

use fearless_simd::Level;
use nbody::points::sum::Parts;
use nbody::points::{Clock, Fault, Population, Vec3};
use rayon::prelude::*;

use crate::leaves::FEW;
use crate::neighbours::Frame;
use crate::units::Units;
use crate::workspace::Element;
use crate::{Formulation, Gas, Hydro, Precision};

mod law;
mod out;
mod pack;
mod shear;
mod sums;
mod sweep;

use law::Law;
use out::{Out, Seen, State};
use pack::Pack;
use sums::QUADS;
use sweep::Sweep;
pub use sweep::Target;

/// Relative error of what particles bring into sums of pressures that are solved for, and how often these are repeated at most.
const CONTENT: f64 = 1e-6;
const REPEATS: usize = 30;

/// Particles a task.
const MANY: usize = 256;

/// What switches of the viscosity remember: alpha, and the trace of the velocity gradient.
type Switches = (Vec<f64>, Vec<f64>);

impl Gas {
    /// Renews what follows from the state: for active particles h and all of `derived`; for the others, which are predicted, pressure and
    /// sound speed. `centre` is where the star stands, for gas whose temperature depends on it. Returns the number of active particles.
    pub fn density(&mut self, hydro: &Hydro, clock: &Clock, centre: Vec3) -> Result<usize, Fault> {
        self.look(hydro, clock);
        if hydro.eos.follows_density() && self.derived.rho.first() == Some(&0.0) {
            // New gas: the sums look at sound speeds, which nobody knows before the first.
            self.density_near(hydro, clock, centre)?;
        }
        let switches = hydro.solves_pressure().then(|| self.switches(hydro));
        let settled = self.density_near(hydro, clock, centre)?;
        if !self.beyond.is_empty() {
            self.density_far(hydro, clock, centre)?;
        }
        if let Some(switches) = switches {
            self.solve_pressure(hydro, (clock, centre), switches)?;
        }
        self.states_exist(hydro, clock)?;
        Ok(settled)
    }

    /// The density of the active particles that are listed in `beyond`.
    fn density_far(&mut self, hydro: &Hydro, clock: &Clock, centre: Vec3) -> Result<usize, Fault> {
        // Gas that thinned out faster than predicted is sought among all.
        self.look_far(hydro, clock);
        self.thermal_state(hydro, centre);
        let mut late = std::mem::take(&mut self.beyond);
        late.sort_unstable();
        let found = self.density_by(hydro, (clock, centre), Some(&late));
        late.clear();
        self.beyond = late;
        found
    }

    /// What switches of the viscosity remember.
    fn switches(&mut self, hydro: &Hydro) -> Switches {
        self.remember(hydro);
        let p = &self.particles;
        (p.alpha.clone(), p.trace_v.clone())
    }

    /// Repeats the sums of the active particles until what they bring into them goes with the pressures.
    fn solve_pressure(
        &mut self,
        hydro: &Hydro,
        of: (&Clock, Vec3),
        switches: Switches,
    ) -> Result<(), Fault> {
        for _ in 0..REPEATS {
            if self.renew_contents(hydro) <= CONTENT {
                break;
            }
            let p = &mut self.particles;
            p.alpha.clone_from(&switches.0);
            p.trace_v.clone_from(&switches.1);
            self.beyond.clear();
            self.density_by(hydro, of, None)?;
        }
        Ok(())
    }

    /// Gives the active particles contents nearer to those that go with their pressures, if any differs by more than is allowed: the largest relative
    /// difference.
    fn renew_contents(&mut self, hydro: &Hydro) -> f64 {
        let (d, u, eos) = (&self.derived, &self.rates.u_pred, &hydro.eos);
        let active = &self.vicinity.active;
        let of = |&i: &u32| {
            let i = i as usize;
            let q = d.p[i] + eos.offset();
            let rho = eos.density(q, u[i], d.rho[i]);
            let off = q / rho / d.content[i] - 1.0;
            (
                off.abs(),
                d.content[i] * (1.0 + eos.pace(q, rho, u[i]) * off),
            )
        };
        let renewed: Vec<_> = active.par_iter().with_min_len(MANY).map(of).collect();
        let most = renewed
            .iter()
            .fold(0.0, |most: f64, (off, _)| most.max(*off));
        if most > CONTENT {
            for (&i, (_, content)) in active.iter().zip(renewed) {
                self.derived.content[i as usize] = content;
            }
        }
        most
    }

    /// A fault for the first active particle that the equation of state has no pressure or sound speed for.
    fn states_exist(&self, hydro: &Hydro, clock: &Clock) -> Result<(), Fault> {
        if hydro.eos.is_everywhere() {
            return Ok(());
        }
        let (p, cs) = (&self.derived.p, &self.derived.cs);
        let lost = |i: &&u32| {
            let i = **i as usize;
            !(p[i].is_finite() && cs[i].is_finite())
        };
        match self.vicinity.active.iter().find(lost) {
            None => Ok(()),
            Some(&i) => Err(Fault::NoState {
                population: Population::Gas,
                id: self.particles.id[i as usize],
                density: self.derived.rho[i as usize],
                energy: self.rates.u_pred[i as usize],
                time: clock.time(),
            }),
        }
    }

    /// The density of the active particles as far as the vicinity goes.
    pub(crate) fn density_near(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        centre: Vec3,
    ) -> Result<usize, Fault> {
        self.remember(hydro);
        self.thermal_state(hydro, centre);
        let known = hydro.formulation != Formulation::Pressure || hydro.exponent == 1.0;
        if !known && self.derived.rho.contains(&0.0) {
            // What is summed follows from densities too.
            self.density_by(hydro, (clock, centre), None)?;
            self.thermal_state(hydro, centre);
        }
        self.density_by(hydro, (clock, centre), None)
    }

    /// The density of the active particles, or of those listed alone; leaves in `beyond` whose H is larger than the vicinity.
    fn density_by(
        &mut self,
        hydro: &Hydro,
        (clock, centre): (&Clock, Vec3),
        listed: Option<&[u32]>,
    ) -> Result<usize, Fault> {
        let of = (clock, centre);
        match (hydro.precision, hydro.wants_gradient()) {
            (Precision::Single, false) => self.density_with::<f32, false>(hydro, of, listed),
            (Precision::Single, true) => self.density_with::<f32, true>(hydro, of, listed),
            (Precision::Double, false) => self.density_with::<f64, false>(hydro, of, listed),
            (Precision::Double, true) => self.density_with::<f64, true>(hydro, of, listed),
        }
    }

    /// Makes room in the columns that a formulation and a switch remember.
    fn remember(&mut self, hydro: &Hydro) {
        let n = self.particles.m.len();
        if hydro.formulation.sums_pressure() {
            self.derived.p_ratio.resize(n, 1.0);
        } else {
            self.derived.p_ratio.clear();
        }
        if hydro.solves_pressure() {
            self.derived.content.resize(n, 0.0);
        }
        if hydro.viscosity.switches() {
            self.derived.curl_v.resize(n, 0.0);
        }
        if hydro.viscosity.remembers() {
            self.particles.trace_v.resize(n, 0.0);
        }
        if hydro.stressed() {
            self.derived.correction.resize(n, Vec3::zeros());
            self.derived.correction_off.resize(n, Vec3::zeros());
        }
        if hydro.viscous_stress() || hydro.reconstructs() {
            self.derived.stress.resize(n, Vec3::zeros());
            self.derived.stress_off.resize(n, Vec3::zeros());
        }
    }

    /// Pressure and sound speed of what is near, as predicted; gas bound to a temperature is brought to it.
    fn thermal_state(&mut self, hydro: &Hydro, centre: Vec3) {
        let (x, rho, ratio) = (&self.particles.x, &self.derived.rho, &self.derived.p_ratio);
        let nodes = &self.tree.nodes;
        let p = Parts::new(&mut self.derived.p);
        let cs = Parts::new(&mut self.derived.cs);
        let content = Parts::new(&mut self.derived.content);
        let u = Parts::new(&mut self.rates.u_pred);
        let near = self.vicinity.near.par_iter().with_min_len(FEW);
        near.for_each(|&leaf| {
            let range = nodes[leaf as usize].range();
            // SAFETY: leaves have no particles in common.
            let (p, cs, u) = unsafe {
                (
                    p.part(range.clone()),
                    cs.part(range.clone()),
                    u.part(range.clone()),
                )
            };
            for (k, i) in range.enumerate() {
                if rho[i] == 0.0 && hydro.eos.follows_density() {
                    // New gas, before its first sums.
                    (p[k], cs[k]) = (0.0, 0.0);
                    continue;
                }
                let bound = hydro.eos.bound_energy(x[i] - centre, rho[i]);
                u[k] = bound.unwrap_or(u[k]);
                if hydro.solves_pressure() {
                    let q = (hydro.eos.pressure(rho[i], u[k]) + hydro.eos.offset()) * ratio[i];
                    let at = hydro.eos.density(q, u[k], rho[i]);
                    (p[k], cs[k]) = (q - hydro.eos.offset(), hydro.eos.sound_speed(at, u[k]));
                    // SAFETY: as above.
                    unsafe { content.part(i..i + 1)[0] = q / at };
                    continue;
                }
                p[k] = hydro.eos.pressure(rho[i], u[k]) * ratio.get(i).unwrap_or(&1.0);
                cs[k] = hydro.eos.sound_speed(rho[i], u[k]);
            }
        });
    }

    fn density_with<E: Element, const GRADIENT: bool>(
        &mut self,
        hydro: &Hydro,
        (clock, centre): (&Clock, Vec3),
        listed: Option<&[u32]>,
    ) -> Result<usize, Fault> {
        if self.is_empty() {
            return Ok(0);
        }
        let level = self.level.unwrap_or_else(Level::new);
        let mut packed = std::mem::take(E::packed(&mut self.packed));
        let (particles, derived) = (&mut self.particles, &mut self.derived);
        let (h, m, v) = (&particles.h, &particles.m, &self.rates.v_pred);
        let near = &self.vicinity.near;
        let relative = |i: usize| hydro.domain.relative(particles.x[i], v[i]);
        let units = Units::new(hydro, (&self.tree, near), h, m, relative, &derived.cs);
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
            rho: &derived.rho,
            content: &derived.content,
            v,
        };
        packed.fill::<QUADS>(&frame, near, |i, _, _| (0.0, pack.source::<E>(i)));
        let state = State {
            h: &mut particles.h,
            alpha: &mut particles.alpha,
            trace_v: &mut particles.trace_v,
            u: &mut self.rates.u_pred,
        };
        let seen = Seen {
            x: &particles.x,
            centre,
            begin: &particles.begin,
        };
        let out = Out::new((hydro, clock, &units), state, derived, seen);
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
            law: Law::new(hydro),
            level,
            out,
            listed,
            seen: &self.vicinity.reach,
            beyond: Mutex::new(std::mem::take(&mut self.beyond)),
        };
        let tally = sweep.run::<GRADIENT>(&self.vicinity.active_branches);
        self.beyond = sweep.beyond.into_inner().unwrap_or_default();
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
