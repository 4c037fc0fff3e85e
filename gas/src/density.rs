//! Density: the smoothing length that encloses the wanted number of neighbours, and the sums over them.
//!
//! V_d H^d n_i = neighbours,   n_i = sum_j W(r_ij, H_i),   rho_i = sum_j m_j W(r_ij, H_i) - e m_i W(0, H_i)
//! g_i = (S_m - d sum m_j w) / S,   S = -sum q dw/dq,   S_m = -sum m_j q dw/dq;   grad_h = g_i / m_i
//! div v = -1/rho_i sum_j (m_j - g_i) v_ij.grad W,   curl v likewise
//!
//! e corrects the density for what the particle itself counts too much; the force follows from it all the same. Where h stands at its bound for want of particles it does not follow them, and g = 0.
//! Sources: Springel & Hernquist (2002); Hopkins (2013), eq. 12 for the number-density constraint;
//! Dehnen & Aly (2012) for e.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use fearless_simd::{Level, Simd, SimdBase};
use nbody::points::sum::Parts;
use nbody::points::{Clock, Fault, Population, Vec3};
use rayon::prelude::*;

use crate::lanes::{Job, Lanes, Machine, Quad, Real, load};
use crate::leaves::FEW as FEW_LEAVES;
use crate::neighbours::{FEW, Frame, Packed, Region, Search};
use crate::units::Units;
use crate::viscosity::Flow;
use crate::viscosity::cullen_dehnen::Compression;
use crate::workspace::Element;
use crate::{CubicSpline, Gas, Hydro, Kernel, KernelKind, Precision, Viscosity, WendlandC2};

mod law;
mod shear;
mod sums;

use law::{Law, Trial};
use sums::{Local, Own, QUADS, Sums};

/// How much farther than the predicted support a search goes, so that the solution lies inside.
const SLACK: f64 = 1.04;

impl Gas {
    /// Renews what follows from the state: for active particles h and all of `derived`; for the others, which are predicted, pressure and
    /// sound speed. `centre` is where the star stands, for gas whose temperature depends on it. Returns the number of active particles.
    pub fn density(&mut self, hydro: &Hydro, clock: &Clock, centre: Vec3) -> Result<usize, Fault> {
        self.look(hydro, clock);
        let settled = self.density_near(hydro, clock, centre)?;
        if self.beyond.is_empty() {
            return Ok(settled);
        }
        // Gas that thinned out faster than predicted is sought among all.
        self.look_far(hydro, clock);
        self.thermal_state(hydro, centre);
        let mut late = std::mem::take(&mut self.beyond);
        late.sort_unstable();
        let found = self.density_of(hydro, clock, Some(&late));
        late.clear();
        self.beyond = late;
        found.map(|found| settled + found)
    }

    /// The density of the active particles as far as the vicinity goes.
    pub(crate) fn density_near(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        centre: Vec3,
    ) -> Result<usize, Fault> {
        self.thermal_state(hydro, centre);
        self.density_of(hydro, clock, None)
    }

    /// The density of the active particles, or of those listed alone; leaves in `beyond` whose H is larger than the vicinity.
    fn density_of(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        listed: Option<&[u32]>,
    ) -> Result<usize, Fault> {
        match hydro.viscosity {
            Viscosity::CullenDehnen { .. } => {
                self.particles.trace_v.resize(self.particles.m.len(), 0.0);
                self.density_as::<true>(hydro, clock, listed)
            }
            _ => self.density_as::<false>(hydro, clock, listed),
        }
    }

    fn density_as<const GRADIENT: bool>(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        listed: Option<&[u32]>,
    ) -> Result<usize, Fault> {
        match (hydro.kernel, hydro.precision) {
            (KernelKind::CubicSpline, Precision::Single) => {
                self.density_with::<CubicSpline, f32, GRADIENT>(hydro, clock, listed)
            }
            (KernelKind::CubicSpline, Precision::Double) => {
                self.density_with::<CubicSpline, f64, GRADIENT>(hydro, clock, listed)
            }
            (KernelKind::WendlandC2, Precision::Single) => {
                self.density_with::<WendlandC2, f32, GRADIENT>(hydro, clock, listed)
            }
            (KernelKind::WendlandC2, Precision::Double) => {
                self.density_with::<WendlandC2, f64, GRADIENT>(hydro, clock, listed)
            }
        }
    }

    /// Pressure and sound speed of what is near, as predicted; gas bound to a temperature is brought to it.
    fn thermal_state(&mut self, hydro: &Hydro, centre: Vec3) {
        let (x, rho) = (&self.particles.x, &self.derived.rho);
        let nodes = &self.tree.nodes;
        let p = Parts::new(&mut self.derived.p);
        let cs = Parts::new(&mut self.derived.cs);
        let u = Parts::new(&mut self.rates.u_pred);
        let near = self.vicinity.near.par_iter().with_min_len(FEW_LEAVES);
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
                u[k] = hydro.eos.bound_energy(x[i] - centre).unwrap_or(u[k]);
                p[k] = hydro.eos.pressure(rho[i], u[k]);
                cs[k] = hydro.eos.sound_speed(u[k]);
            }
        });
    }

    fn density_with<K: Kernel, E: Element, const GRADIENT: bool>(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
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
        let units = Units::new(hydro, (&self.tree, near), h, m, v, &derived.cs);
        let frame = Frame {
            tree: &self.tree,
            domain: &hydro.domain,
            x: &particles.x,
            units,
        };
        let (span, cs, trace_v) = (&particles.span, &derived.cs, &particles.trace_v);
        packed.fill::<QUADS>(&frame, near, |i, _, _| {
            let trace = if GRADIENT { trace_v[i] } else { 0.0 };
            (0.0, source(&units, m[i], v[i], cs[i], (span[i], trace)))
        });
        let out = Out {
            h: Parts::new(&mut particles.h),
            alpha: Parts::new(&mut particles.alpha),
            rho: Parts::new(&mut derived.rho),
            p: Parts::new(&mut derived.p),
            grad_h: Parts::new(&mut derived.grad_h),
            div_v: Parts::new(&mut derived.div_v),
            trace_v: Parts::new(&mut particles.trace_v),
            curl_v: Parts::new(&mut derived.curl_v),
            v_sig: Parts::new(&mut derived.v_sig),
            near_span: Parts::new(&mut derived.near_span),
        };
        let root = &self.tree.nodes[0];
        let extent = hydro.domain.in_plane(root.hi - root.lo).norm();
        let sweep = Sweep {
            hydro,
            clock,
            frame,
            packed: &packed,
            begin: &particles.begin,
            end: &particles.end,
            m: &particles.m,
            cs: &derived.cs,
            u: &self.rates.u_pred,
            largest: hydro.largest_reach(extent) / units.length,
            density: units.mass / units.length.powi(hydro.dimensions() as i32),
            h_by_reach: units.length / hydro.support(),
            law: Law::new::<K>(hydro),
            level,
            out,
            listed,
            seen: &self.vicinity.reach,
            beyond: Mutex::new(std::mem::take(&mut self.beyond)),
        };
        let tally = sweep.run::<K, GRADIENT>(&self.vicinity.active_branches);
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

/// What the sweep over a leaf counted: active particles, and the first one without a solution.
#[derive(Clone, Copy, Default)]
struct Tally {
    targets: usize,
    failed: Option<(usize, f64)>,
}

impl Tally {
    fn and(self, other: Self) -> Self {
        let first = |a: (usize, f64), b: (usize, f64)| if a.0 <= b.0 { a } else { b };
        Self {
            targets: self.targets + other.targets,
            failed: match (self.failed, other.failed) {
                (Some(a), Some(b)) => Some(first(a, b)),
                (a, b) => a.or(b),
            },
        }
    }
}

/// What a particle brings into the sums.
#[inline(always)]
fn source<E: Real>(
    units: &Units,
    m: f64,
    v: Vec3,
    cs: f64,
    (span, trace_v): (u32, f64),
) -> [Quad<E>; QUADS] {
    let zero = E::default();
    let sign = if trace_v == 0.0 {
        0.0
    } else {
        trace_v.signum()
    };
    let v = v.map(|v| E::place(v / units.velocity_step));
    // Before the first step there is none that could limit others.
    let span = if span == 0 {
        f64::INFINITY
    } else {
        f64::from(span)
    };
    let cs = E::from_f64(cs / units.velocity);
    [
        Quad([E::from_f64(m / units.mass), v.x, v.y, v.z]),
        Quad([cs, E::from_f64(span), E::from_f64(sign), zero]),
    ]
}

/// A particle whose H is sought within `radius`, beginning at `start`.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    i: usize,
    start: f64,
    radius: f64,
}

/// What became of a target.
enum Outcome {
    Done {
        local: Local,
        reach: f64,
    },
    /// H is larger; to be tried again within this radius.
    Wider(f64),
    /// There is none; last try.
    Failed(f64),
}

/// The columns that the sweep writes.
struct Out<'a> {
    h: Parts<'a, f64>,
    alpha: Parts<'a, f64>,
    rho: Parts<'a, f64>,
    p: Parts<'a, f64>,
    grad_h: Parts<'a, f64>,
    div_v: Parts<'a, f64>,
    /// Empty without the switch that needs it.
    trace_v: Parts<'a, f64>,
    curl_v: Parts<'a, f64>,
    v_sig: Parts<'a, f64>,
    near_span: Parts<'a, u32>,
}

/// All that the leaves share; lengths, velocities and masses in the units of the frame.
struct Sweep<'a, E> {
    hydro: &'a Hydro,
    clock: &'a Clock,
    frame: Frame<'a>,
    packed: &'a Packed<E>,
    begin: &'a [u32],
    end: &'a [u32],
    m: &'a [f64],
    cs: &'a [f64],
    u: &'a [f64],
    /// The largest H.
    largest: f64,
    /// Code units a unit of density, and smoothing length in code units a unit of H.
    density: f64,
    h_by_reach: f64,
    law: Law,
    level: Level,
    out: Out<'a>,
    /// The particles that are to be done, if not all that are active; ascending.
    listed: Option<&'a [u32]>,
    /// How far is packed around each leaf, code units, by node; and who needs more.
    seen: &'a [f64],
    beyond: Mutex<Vec<u32>>,
}

/// The sweep over the leaves of a branch.
struct Branch<'a, E, K, const GRADIENT: bool> {
    sweep: &'a Sweep<'a, E>,
    branch: usize,
    region: &'a mut Region<E>,
    pending: &'a mut Vec<Target>,
    /// How far the leaves around have been sought, code units.
    sought: f64,
    kernel: std::marker::PhantomData<K>,
}

impl<E: Element, K: Kernel, const GRADIENT: bool> Job<E> for Branch<'_, E, K, GRADIENT> {
    type Output = Tally;

    #[inline(always)]
    fn run<S: Simd, R: Machine<S, E>>(self, simd: S) -> Tally {
        let Self {
            sweep,
            branch,
            region,
            pending,
            mut sought,
            ..
        } = self;
        let nodes = &sweep.frame.tree.nodes;
        let mut tally = Tally::default();
        for leaf in (branch..nodes[branch].skip as usize).filter(|&i| sweep.frame.tree.is_leaf(i)) {
            tally = tally.and(sweep.targets(leaf, pending));
            while !pending.is_empty() {
                let (span, reach) = sweep.span(pending);
                if reach * sweep.frame.units.length > sought {
                    sought = reach * sweep.frame.units.length;
                    (region.around).find(&sweep.frame, branch, sought, &[]);
                }
                sweep.gather(simd, leaf, (span, reach), region);
                let failed = sweep.settle::<K, S, R, GRADIENT>(simd, leaf, region, pending);
                tally = tally.and(Tally { targets: 0, failed });
            }
        }
        tally
    }
}

impl<E: Element> Sweep<'_, E> {
    fn run<K: Kernel, const GRADIENT: bool>(&self, branches: &[u32]) -> Tally {
        let tallies = branches.par_iter().map(|&branch| {
            E::with_workspace(|space| {
                let branch = branch as usize;
                let sought = self.reach(branch);
                (space.region.around).find(&self.frame, branch, sought, &[]);
                let branch = Branch::<E, K, GRADIENT> {
                    sweep: self,
                    branch,
                    region: &mut space.region,
                    pending: &mut space.pending,
                    sought,
                    kernel: std::marker::PhantomData,
                };
                E::run(self.level, branch)
            })
        });
        tallies.reduce(Tally::default, Tally::and)
    }

    fn active(&self, i: usize) -> bool {
        match self.listed {
            None => self.clock.synchronous() || self.end[i] == self.clock.tick,
            Some(listed) => listed.binary_search(&(i as u32)).is_ok(),
        }
    }

    /// The largest radius within which the active particles of a branch are to be sought, as far as it is known.
    fn reach(&self, branch: usize) -> f64 {
        let range = self.frame.tree.nodes[branch].range();
        // SAFETY: a branch's task alone touches the branch's particles.
        let h = unsafe { self.out.h.part(range.clone()) };
        let active = range.zip(h).filter(|(i, _)| self.active(*i));
        let largest = active.fold(0.0, |largest: f64, (_, h)| largest.max(*h));
        (SLACK * largest / self.h_by_reach).min(self.largest) * self.frame.units.length
    }

    /// Settles what can be settled of `pending`; returns the first particle without a solution.
    #[inline(always)]
    fn settle<K: Kernel, S: Simd, R: Machine<S, E>, const GRADIENT: bool>(
        &self,
        simd: S,
        leaf: usize,
        region: &mut Region<E>,
        pending: &mut Vec<Target>,
    ) -> Option<(usize, f64)> {
        let (mut left, mut first) = (0, None);
        for k in 0..pending.len() {
            if k % FEW == 0 {
                let few = &pending[k..(k + FEW).min(pending.len())];
                let (span, reach) = self.span(few);
                region.focus(simd, span, reach, false);
            }
            let mut target = pending[k];
            match self.solve::<K, S, R, GRADIENT>(simd, &mut target, region) {
                Outcome::Done { local, reach } => self.write(target.i, &local, reach),
                Outcome::Wider(radius) if radius * self.frame.units.length > self.seen[leaf] => {
                    self.leave(target.i);
                }
                Outcome::Wider(radius) => {
                    pending[left] = Target { radius, ..target };
                    left += 1;
                }
                Outcome::Failed(reach) => first = first.or(Some((target.i, reach))),
            }
        }
        pending.truncate(left);
        first
    }

    /// Leaves a particle to a sweep that sees farther.
    #[cold]
    fn leave(&self, i: usize) {
        let mut beyond = self.beyond.lock().unwrap_or_else(PoisonError::into_inner);
        beyond.push(i as u32);
    }

    #[inline(always)]
    /// Fills `pending` with the active particles of a leaf.
    fn targets(&self, leaf: usize, pending: &mut Vec<Target>) -> Tally {
        let range = self.frame.tree.nodes[leaf].range();
        pending.clear();
        for i in range.clone() {
            if self.active(i) {
                pending.push(self.target(i, leaf, &range));
            }
        }
        Tally {
            targets: pending.len(),
            failed: None,
        }
    }

    #[inline(always)]
    /// Where to begin: at the predicted h, else at the density of the leaf.
    fn target(&self, i: usize, leaf: usize, range: &Range<usize>) -> Target {
        // SAFETY: a branch's task alone touches the branch's particles.
        let h = unsafe { self.out.h.part(i..i + 1) }[0];
        let unit = self.frame.units.length;
        let start = if h > 0.0 {
            h / self.h_by_reach
        } else {
            let node = &self.frame.tree.nodes[leaf];
            let side = self.hydro.domain.in_plane(node.hi - node.lo).norm();
            let density = range.len() as f64 / side.powi(self.hydro.dimensions() as i32);
            self.hydro.reach_at(density) / unit
        };
        // A single point has no density.
        let start = if start == 0.0 { self.largest } else { start }.min(self.largest);
        let radius = (SLACK * start).min(self.largest);
        Target { i, start, radius }
    }

    /// The box around some targets, and the largest radius in which they look.
    #[inline(always)]
    fn span(&self, targets: &[Target]) -> ([[E; 3]; 2], f64) {
        let mut span = [
            [E::from_f64(f64::INFINITY); 3],
            [E::from_f64(f64::NEG_INFINITY); 3],
        ];
        let mut reach: f64 = 0.0;
        for target in targets {
            reach = reach.max(target.radius);
            for (a, x) in self.packed.place(target.i).into_iter().enumerate() {
                span[0][a] = if x < span[0][a] { x } else { span[0][a] };
                span[1][a] = if x > span[1][a] { x } else { span[1][a] };
            }
        }
        (span, reach)
    }

    #[inline(always)]
    fn gather<S: Simd>(
        &self,
        simd: S,
        leaf: usize,
        (span, reach): ([[E; 3]; 2], f64),
        region: &mut Region<E>,
    ) {
        let search = Search {
            frame: &self.frame,
            packed: self.packed,
            leaf,
            span,
            reach,
            extent: &[],
            active: false,
        };
        region.gather(simd, &search);
    }

    #[inline(always)]
    fn solve<K: Kernel, S: Simd, R: Machine<S, E>, const GRADIENT: bool>(
        &self,
        simd: S,
        target: &mut Target,
        region: &mut Region<E>,
    ) -> Outcome {
        region.near::<S, R>(simd, self.packed.place(target.i), target.radius);
        let r = region.distances(simd);
        match (self.law).solve::<K, S, E, R>(simd, r, target.start, target.radius) {
            Trial::Found(reach) => {
                self.sums::<K, S, R, GRADIENT>(simd, target.i, (reach, true), region)
            }
            Trial::Short(number) if target.radius < self.largest && number > 0.0 => {
                let growth = (self.law.wanted / number).powf(1.0 / self.law.d);
                target.start = target.radius;
                Outcome::Wider((target.radius * (SLACK * growth).clamp(1.1, 1.6)).min(self.largest))
            }
            Trial::Short(number) if number > 0.0 => {
                self.sums::<K, S, R, GRADIENT>(simd, target.i, (self.largest, false), region)
            }
            Trial::Short(_) => Outcome::Failed(target.radius),
            Trial::Failed(reach) => Outcome::Failed(reach),
        }
    }

    /// The sums over the listed neighbours of particle i at support H = `reach`; `free` says whether H follows the particles.
    #[inline(always)]
    fn sums<K: Kernel, S: Simd, R: Machine<S, E>, const GRADIENT: bool>(
        &self,
        simd: S,
        i: usize,
        (reach, free): (f64, bool),
        region: &Region<E>,
    ) -> Outcome {
        let units = &self.frame.units;
        let own = Own {
            row: self.packed.row(i),
            reach,
            velocity_step: units.velocity_step / units.velocity,
        };
        let mut sums = Sums::new(simd);
        for first in (0..region.count()).step_by(Lanes::<S, E>::LEN) {
            let columns = [
                region.quad_near::<S, R>(simd, self.packed, 0, first),
                region.quad_near::<S, R>(simd, self.packed, 1, first),
            ];
            let d = region.separations(simd, first);
            let r = load(simd, region.distances(simd), first);
            sums.add::<K, R, GRADIENT>(simd, &own, columns, d, r);
        }
        let mut local = sums.local::<R>(&self.law, self.m[i] / units.mass, reach, free);
        if GRADIENT {
            local.gradient = sums.gradient::<R>(self.hydro.domain.axes, local.div_v);
        }
        Outcome::Done { local, reach }
    }

    #[inline(always)]
    fn write(&self, i: usize, local: &Local, reach: f64) {
        let units = &self.frame.units;
        let rate = units.velocity / units.length;
        let rho = local.rho * self.density;
        let flow = Flow {
            div_v: local.div_v * rate,
            curl_v: local.curl_v * rate,
            cs: self.cs[i],
            h: reach * self.h_by_reach,
        };
        let (own, out) = (i..i + 1, &self.out);
        let elapsed = self.clock.tick - self.begin[i];
        // SAFETY: a leaf's task alone touches the leaf's particles.
        let alpha = &mut unsafe { out.alpha.part(own.clone()) }[0];
        *alpha = self.hydro.viscosity.alpha(flow, *alpha, || {
            // SAFETY: as above.
            let trace = &mut unsafe { out.trace_v.part(own.clone()) }[0];
            let before = std::mem::replace(trace, local.gradient.div_v * rate);
            Compression {
                div_v: *trace,
                before,
                dt: f64::from(elapsed) * self.clock.unit(),
                shear2: local.gradient.shear2 * rate * rate,
                order: local.gradient.order,
                // Without the part of both sound speeds that a time step needs.
                v_sig: 0.5 * local.v_sig * units.velocity,
                reach: reach * units.length,
            }
        });
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            out.h.part(own.clone())[0] = flow.h;
            out.rho.part(own.clone())[0] = rho;
            out.p.part(own.clone())[0] = self.hydro.eos.pressure(rho, self.u[i]);
            out.grad_h.part(own.clone())[0] = local.g * units.mass / self.m[i];
            out.div_v.part(own.clone())[0] = flow.div_v;
            out.curl_v.part(own.clone())[0] = flow.curl_v;
            out.v_sig.part(own.clone())[0] = local.v_sig * units.velocity;
            // Infinite without neighbours: the cast saturates.
            out.near_span.part(own)[0] = local.near_span as u32;
        }
    }
}

#[cfg(test)]
mod tests;
