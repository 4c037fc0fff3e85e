//! Density: the smoothing length that encloses the wanted number of neighbours, and the sums over them.
//!
//! V_d H^d n_i = neighbours,   n_i = sum_j W(r_ij, H_i),   rho_i = sum_j m_j W(r_ij, H_i) - e m_i W(0, H_i)
//! g_i = (S_m - d sum m_j w) / S,   S = -sum q dw/dq,   S_m = -sum m_j q dw/dq;   grad_h = g_i / m_i
//! div v = -1/rho_i sum_j (m_j - g_i) v_ij.grad W,   curl v likewise
//!
//! e corrects the density for what the particle itself counts too much; the force follows from it all the same. Where h stands at its bound for want of particles it does not follow them, and g = 0.
//! Sources: Springel & Hernquist (2002); Hopkins (2013), eq. 12 for the number-density constraint;
//! Dehnen & Aly (2012) for e.

use std::cell::RefCell;
use std::ops::Range;

use fearless_simd::{Level, Select, Simd, SimdBase, dispatch, f64x8};
use nbody::points::sum::{CHUNK, Parts};
use nbody::points::{Clock, Fault, Population, Tree, Vec3};
use rayon::prelude::*;

use crate::kernel::unit_sphere;
use crate::neighbours::{Candidates, LANES, Lanes, List, Search, bounding, total};
use crate::viscosity::Flow;
use crate::{CubicSpline, Gas, Hydro, Kernel, KernelKind, WendlandC2};

/// How much farther than the predicted support a search goes, so that the solution lies inside.
const SLACK: f64 = 1.04;

/// A distance that no two particles apart have; keeps coincident ones from dividing by zero.
const TINY: f64 = 1e-150;

/// The solver for H gives up after this many evaluations.
const TRIES: usize = 100;

impl Gas {
    /// Renews what follows from the state: for active particles h and all of `derived`; for the others, which are predicted, pressure and
    /// sound speed. `centre` is where the star stands, for gas whose temperature depends on it. Returns the number of active particles.
    pub fn density(&mut self, hydro: &Hydro, clock: &Clock, centre: Vec3) -> Result<usize, Fault> {
        self.thermal_state(hydro, centre);
        match hydro.kernel {
            KernelKind::CubicSpline => self.density_with::<CubicSpline>(hydro, clock),
            KernelKind::WendlandC2 => self.density_with::<WendlandC2>(hydro, clock),
        }
    }

    /// Pressure and sound speed of all gas as predicted; gas bound to a temperature is brought to it.
    fn thermal_state(&mut self, hydro: &Hydro, centre: Vec3) {
        let (x, rho) = (&self.particles.x, &self.derived.rho);
        let (p, cs) = (&mut self.derived.p, &mut self.derived.cs);
        p.par_iter_mut()
            .zip(cs)
            .zip(&mut self.rates.u_pred)
            .enumerate()
            .with_min_len(CHUNK)
            .for_each(|(i, ((p, cs), u))| {
                *u = hydro.eos.bound_energy(x[i] - centre).unwrap_or(*u);
                *p = hydro.eos.pressure(rho[i], *u);
                *cs = hydro.eos.sound_speed(*u);
            });
    }

    fn density_with<K: Kernel>(&mut self, hydro: &Hydro, clock: &Clock) -> Result<usize, Fault> {
        let (particles, derived) = (&mut self.particles, &mut self.derived);
        let out = Out {
            h: Parts::new(&mut particles.h),
            alpha: Parts::new(&mut particles.alpha),
            rho: Parts::new(&mut derived.rho),
            p: Parts::new(&mut derived.p),
            grad_h: Parts::new(&mut derived.grad_h),
            div_v: Parts::new(&mut derived.div_v),
            curl_v: Parts::new(&mut derived.curl_v),
            v_sig: Parts::new(&mut derived.v_sig),
            near_span: Parts::new(&mut derived.near_span),
        };
        let root = self.tree.nodes.first();
        let extent = root.map_or(0.0, |root| hydro.domain.in_plane(root.hi - root.lo).norm());
        let sweep = Sweep {
            hydro,
            clock,
            tree: &self.tree,
            x: &particles.x,
            m: &particles.m,
            end: &particles.end,
            span: &particles.span,
            cs: &derived.cs,
            v: &self.rates.v_pred,
            u: &self.rates.u_pred,
            largest: hydro.largest_reach(extent),
            law: Law::new::<K>(hydro),
            level: Level::new(),
        };
        let tally = (self.tree.leaves.par_iter())
            .map(|&leaf| {
                let range = self.tree.nodes[leaf as usize].range();
                BUFFERS.with_borrow_mut(|buffers| sweep.leaf::<K>(range, buffers, &out))
            })
            .reduce(Tally::default, Tally::and);
        match tally.failed {
            None => Ok(tally.targets),
            Some((i, reach)) => Err(Fault::DensityNotConverged {
                population: Population::Gas,
                id: particles.id[i],
                smoothing_length: reach / hydro.support(),
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

#[derive(Default)]
struct Buffers {
    candidates: Candidates,
    list: List,
    r: Vec<Lanes>,
    pending: Vec<Target>,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
}

/// A particle whose H is sought within `radius`, beginning at `start`.
#[derive(Clone, Copy)]
struct Target {
    i: usize,
    start: f64,
    radius: f64,
}

/// What became of a target.
enum Outcome {
    Done(Local),
    /// H is larger; to be tried again within this radius.
    Wider(f64),
    /// There is none; last try.
    Failed(f64),
}

/// The sums over the neighbours of a particle.
struct Local {
    h: f64,
    rho: f64,
    grad_h: f64,
    div_v: f64,
    curl_v: f64,
    v_sig: f64,
    near_span: u32,
}

/// The columns that the sweep writes.
struct Out<'a> {
    h: Parts<'a, f64>,
    alpha: Parts<'a, f64>,
    rho: Parts<'a, f64>,
    p: Parts<'a, f64>,
    grad_h: Parts<'a, f64>,
    div_v: Parts<'a, f64>,
    curl_v: Parts<'a, f64>,
    v_sig: Parts<'a, f64>,
    near_span: Parts<'a, u32>,
}

struct Sweep<'a> {
    hydro: &'a Hydro,
    clock: &'a Clock,
    tree: &'a Tree,
    x: &'a [Vec3],
    m: &'a [f64],
    end: &'a [u32],
    span: &'a [u32],
    cs: &'a [f64],
    v: &'a [Vec3],
    u: &'a [f64],
    /// The largest H.
    largest: f64,
    law: Law,
    level: Level,
}

impl Sweep<'_> {
    fn leaf<K: Kernel>(&self, range: Range<usize>, buffers: &mut Buffers, out: &Out) -> Tally {
        let mut tally = Tally::default();
        let mut pending = std::mem::take(&mut buffers.pending);
        pending.clear();
        for i in range.clone() {
            if self.clock.synchronous() || self.end[i] == self.clock.tick {
                pending.push(self.target(i, &range, out));
            }
        }
        tally.targets = pending.len();
        while !pending.is_empty() {
            let search = Search {
                tree: self.tree,
                domain: &self.hydro.domain,
                x: self.x,
                reach: pending.iter().fold(0.0, |reach, t| reach.max(t.radius)),
                extent: &[],
            };
            let span = bounding(pending.iter().map(|t| self.x[t.i]));
            buffers.candidates.gather(&search, span, |_| 0.0);
            pending.retain_mut(|target| {
                match dispatch!(self.level, simd => self.solve::<K, _>(simd, target, buffers)) {
                    Outcome::Done(local) => {
                        self.write(target.i, &local, out);
                        false
                    }
                    Outcome::Wider(radius) => {
                        target.radius = radius;
                        true
                    }
                    Outcome::Failed(reach) => {
                        let failed = Some((target.i, reach));
                        tally = tally.and(Tally { targets: 0, failed });
                        false
                    }
                }
            });
        }
        buffers.pending = pending;
        tally
    }

    /// Where to begin: at the predicted h, else at the density of the leaf.
    fn target(&self, i: usize, leaf: &Range<usize>, out: &Out) -> Target {
        // SAFETY: a leaf's task alone touches the leaf's particles.
        let h = unsafe { out.h.part(i..i + 1) }[0];
        let start = if h > 0.0 {
            h * self.hydro.support()
        } else {
            let (lo, hi) = bounding(self.x[leaf.clone()].iter().copied());
            let side = self.hydro.domain.in_plane(hi - lo).norm();
            let density = leaf.len() as f64 / side.powi(self.hydro.dimensions() as i32);
            self.hydro.reach_at(density)
        };
        // A single point has no density.
        let start = if start == 0.0 { self.largest } else { start }.min(self.largest);
        let radius = (SLACK * start).min(self.largest);
        Target { i, start, radius }
    }

    #[inline(always)]
    fn solve<K: Kernel, S: Simd>(
        &self,
        simd: S,
        target: &mut Target,
        buffers: &mut Buffers,
    ) -> Outcome {
        let Buffers {
            candidates,
            list,
            r,
            ..
        } = buffers;
        let place = candidates.place(self.x[target.i]);
        // A hair more, so that what lies on the radius counts when H does.
        let limit = target.radius * target.radius * (1.0 + 1e-14);
        candidates.list(simd, place, (limit, &[]), list);
        r.clear();
        r.extend(list.r2().iter().map(|r2| r2.map(f64::sqrt)));
        match self.law.solve::<K, S>(simd, r, target.start, target.radius) {
            Trial::Found(reach) => {
                Outcome::Done(self.sums::<K, S>(simd, target.i, (reach, true), buffers))
            }
            Trial::Short(number) if target.radius < self.largest && number > 0.0 => {
                let growth = (self.law.wanted / number).powf(1.0 / self.law.d);
                target.start = target.radius;
                Outcome::Wider((target.radius * (SLACK * growth).clamp(1.1, 1.6)).min(self.largest))
            }
            Trial::Short(number) if number > 0.0 => {
                Outcome::Done(self.sums::<K, S>(simd, target.i, (self.largest, false), buffers))
            }
            Trial::Short(_) => Outcome::Failed(target.radius),
            Trial::Failed(reach) => Outcome::Failed(reach),
        }
    }

    /// The sums over the listed neighbours of particle i at support H = `reach`; `free` says whether H follows the particles.
    #[inline(always)]
    fn sums<K: Kernel, S: Simd>(
        &self,
        simd: S,
        i: usize,
        (reach, free): (f64, bool),
        buffers: &Buffers,
    ) -> Local {
        let place = buffers.candidates.place(self.x[i]);
        let (inverse, cs) = (1.0 / reach, self.cs[i]);
        let mut sums = Sums::new(simd);
        for (numbers, r) in buffers.list.numbers().iter().zip(&buffers.r) {
            let block = self.block(i, place, numbers, &buffers.candidates);
            let lanes = |lanes: Lanes| f64x8::from_slice(simd, &lanes);
            let (d, dv, r) = (block.d.map(lanes), block.dv.map(lanes), lanes(*r));
            let q = (r * inverse).min(1.0);
            let (m, slope) = (lanes(block.m), K::slope(q));
            let approach = dv[0] * d[0] + dv[1] * d[1] + dv[2] * d[2];
            let fall = q * q * slope;
            sums.mass += m * K::value(q);
            sums.slope -= fall;
            sums.mass_slope -= m * fall;
            sums.div += slope * approach;
            sums.mass_div += m * slope * approach;
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                let turn = slope * (dv[b] * d[c] - dv[c] * d[b]);
                sums.curl[a] += turn;
                sums.mass_curl[a] += m * turn;
            }
            let inside = q.simd_lt(1.0);
            let speed = lanes(block.cs) + cs - approach.min(0.0) * 3.0 / r.max(TINY);
            sums.v_sig = sums
                .v_sig
                .max(inside.select(speed, f64x8::splat(simd, 0.0)));
            let far = f64x8::splat(simd, f64::INFINITY);
            sums.near_span = sums.near_span.min(inside.select(lanes(block.span), far));
        }
        self.local(i, (reach, free), &sums)
    }

    #[inline(always)]
    fn block(
        &self,
        i: usize,
        place: [f64; 3],
        numbers: &[u32; LANES],
        candidates: &Candidates,
    ) -> Block {
        let mut block = Block::default();
        let v = self.v[i];
        for (l, &k) in numbers.iter().enumerate() {
            let k = k as usize;
            let j = candidates.index[k] as usize;
            let (v_j, d) = (
                self.v[j],
                [candidates.x[k], candidates.y[k], candidates.z[k]],
            );
            for a in 0..3 {
                block.d[a][l] = d[a] - place[a];
                block.dv[a][l] = v_j[a] - v[a];
            }
            block.m[l] = self.m[j];
            block.cs[l] = self.cs[j];
            // Its own step does not limit a particle, nor do those before the first.
            let span = self.span[j];
            block.span[l] = if j == i || span == 0 {
                f64::INFINITY
            } else {
                f64::from(span)
            };
        }
        block
    }

    fn local(&self, i: usize, (reach, free): (f64, bool), sum: &Sums<impl Simd>) -> Local {
        let total = |lanes: f64x8<_>| total(lanes.into());
        let d = self.law.d;
        let mass = total(sum.mass) - self.law.excess * self.m[i];
        let g = if free {
            (total(sum.mass_slope) - d * mass) / total(sum.slope)
        } else {
            0.0
        };
        let volume = reach.powi(self.hydro.dimensions() as i32);
        let rho = self.law.norm / volume * mass;
        let scale = self.law.norm / (volume * reach * reach * rho);
        let curl = |a: usize| total(sum.mass_curl[a]) - g * total(sum.curl[a]);
        Local {
            h: reach / self.hydro.support(),
            rho,
            grad_h: g / self.m[i],
            div_v: -scale * (total(sum.mass_div) - g * total(sum.div)),
            curl_v: scale * Vec3::from_fn(|a, _| curl(a)).norm(),
            v_sig: Lanes::from(sum.v_sig).into_iter().fold(0.0, f64::max),
            // Infinite without neighbours: the cast saturates.
            near_span: Lanes::from(sum.near_span)
                .into_iter()
                .fold(f64::INFINITY, f64::min) as u32,
        }
    }

    fn write(&self, i: usize, local: &Local, out: &Out) {
        let flow = Flow {
            div_v: local.div_v,
            curl_v: local.curl_v,
            cs: self.cs[i],
            h: local.h,
        };
        let own = i..i + 1;
        // SAFETY: a leaf's task alone touches the leaf's particles.
        unsafe {
            out.h.part(own.clone())[0] = local.h;
            out.alpha.part(own.clone())[0] = self.hydro.viscosity.alpha(flow);
            out.rho.part(own.clone())[0] = local.rho;
            out.p.part(own.clone())[0] = self.hydro.eos.pressure(local.rho, self.u[i]);
            out.grad_h.part(own.clone())[0] = local.grad_h;
            out.div_v.part(own.clone())[0] = local.div_v;
            out.curl_v.part(own.clone())[0] = local.curl_v;
            out.v_sig.part(own.clone())[0] = local.v_sig;
            out.near_span.part(own)[0] = local.near_span;
        }
    }
}

/// Some neighbours: separations, relative velocities and what else a sum needs.
#[derive(Default)]
struct Block {
    d: [Lanes; 3],
    dv: [Lanes; 3],
    m: Lanes,
    cs: Lanes,
    span: Lanes,
}

/// Sums over neighbours, without and with their masses.
struct Sums<S: Simd> {
    mass: f64x8<S>,
    slope: f64x8<S>,
    mass_slope: f64x8<S>,
    div: f64x8<S>,
    mass_div: f64x8<S>,
    curl: [f64x8<S>; 3],
    mass_curl: [f64x8<S>; 3],
    v_sig: f64x8<S>,
    near_span: f64x8<S>,
}

impl<S: Simd> Sums<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let zero = f64x8::splat(simd, 0.0);
        Self {
            mass: zero,
            slope: zero,
            mass_slope: zero,
            div: zero,
            mass_div: zero,
            curl: [zero; 3],
            mass_curl: [zero; 3],
            v_sig: zero,
            near_span: f64x8::splat(simd, f64::INFINITY),
        }
    }
}

/// The condition on H.
struct Law {
    d: f64,
    wanted: f64,
    tolerance: f64,
    /// Of the kernel.
    norm: f64,
    /// Neighbour number by the sum of kernel values.
    weight: f64,
    /// What the particle itself counts too much in its density, a mass.
    excess: f64,
}

/// What became of the search for H within a radius.
enum Trial {
    Found(f64),
    /// The radius holds this many neighbours, fewer than wanted.
    Short(f64),
    Failed(f64),
}

impl Law {
    fn new<K: Kernel>(hydro: &Hydro) -> Self {
        let d = hydro.dimensions();
        let weight = unit_sphere(d) * K::norm(d);
        assert!(
            hydro.neighbours > weight * K::value(0.0),
            "more neighbours than the particle itself"
        );
        Self {
            d: d as f64,
            wanted: hydro.neighbours,
            tolerance: hydro.tolerance,
            norm: K::norm(d),
            weight,
            excess: K::self_excess(hydro.neighbours, d) * K::value(0.0),
        }
    }

    /// Newton's method in ln H for ln of the neighbour number, kept between bounds; the number grows with H.
    #[inline(always)]
    fn solve<K: Kernel, S: Simd>(&self, simd: S, r: &[Lanes], start: f64, radius: f64) -> Trial {
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut reach = start.min(radius);
        for _ in 0..TRIES {
            let inverse = 1.0 / reach;
            let zero = f64x8::splat(simd, 0.0);
            let (mut value, mut slope) = (zero, zero);
            for r in r {
                let q = (f64x8::from_slice(simd, r) * inverse).min(1.0);
                value += K::value(q);
                slope -= q * q * K::slope(q);
            }
            let (value, slope) = (total(value.into()), total(slope.into()));
            let number = self.weight * value;
            let excess = (number / self.wanted).ln();
            if excess >= 0.0 {
                high = reach;
            } else if reach >= radius {
                return Trial::Short(number);
            } else {
                low = reach;
            }
            let step = -excess * value / slope;
            if step.abs() <= self.tolerance || high - low <= self.tolerance * reach {
                return Trial::Found(reach);
            }
            let next = reach * step.clamp(-0.5, 0.5).exp();
            reach = if next > low && next < high {
                next.min(radius)
            } else {
                0.5 * (low + high.min(radius))
            };
        }
        Trial::Failed(reach)
    }
}

#[cfg(test)]
mod tests;
