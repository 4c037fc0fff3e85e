//! Pair forces of pressure and viscosity, and the impulses that they give.
//!
//! m_i dv_i/dt = -sum_j [ m_i (m_j - g_i) P_i/rho_i^2 grad W(r, H_i) + m_j (m_i - g_j) P_j/rho_j^2 grad W(r, H_j) + m_i m_j Pi_ij grad W_ij ]
//! m_i du_i/dt =  sum_j [ m_i (m_j - g_i) P_i/rho_i^2 grad W(r, H_i) + m_i m_j Pi_ij grad W_ij / 2 ] . v_ij
//!
//! with W_ij the mean of the two kernels. Both members of a pair compute the same force from the same numbers. A pair steps with the
//! shorter step of the two: its force counts where at least one member is active, and the impulse goes to both.
//! Sources: Springel & Hernquist (2002); Hopkins (2013); pairwise steps: Saitoh & Makino (2009, 2010).

use std::cell::RefCell;
use std::ops::Range;

use fearless_simd::{Level, Simd, dispatch};
use nbody::points::sum::Parts;
use nbody::points::{Clock, Tree, Vec3};
use rayon::prelude::*;

use crate::neighbours::{Candidates, FAR, LANES, Lanes, List, Search, bounding, total};
use crate::{CubicSpline, Derived, Gas, Hydro, Kernel, KernelKind, Particles, WendlandC2};

/// A tick that never comes.
pub(crate) const NEVER: u32 = u32::MAX;

impl Gas {
    /// Forces of the pairs that have an active member: rates of the active particles, and the impulses that close the steps ending now and
    /// open those beginning now, in which `next` is the clock. Returns the number of particles that had such a pair.
    pub fn forces(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> usize {
        match hydro.kernel {
            KernelKind::CubicSpline => self.forces_with::<CubicSpline>(hydro, clock, next),
            KernelKind::WendlandC2 => self.forces_with::<WendlandC2>(hydro, clock, next),
        }
    }

    fn forces_with<K: Kernel>(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> usize {
        let (particles, derived, rates) = (&self.particles, &self.derived, &mut self.rates);
        let (support, h) = (hydro.support(), &particles.h);
        let active = |i: usize| clock.synchronous() || particles.end[i] == clock.tick;
        self.tree.largest(|i| support * h[i], &mut self.extent);
        let own = |i: usize| if active(i) { support * h[i] } else { -1.0 };
        self.tree.largest(own, &mut self.active_extent);
        self.wake.resize(particles.m.len(), NEVER);
        let out = Out {
            hydro: Parts::new(&mut rates.hydro),
            du: Parts::new(&mut rates.du),
            dv_close: Parts::new(&mut rates.dv_close),
            dv_open: Parts::new(&mut rates.dv_open),
            du_close: Parts::new(&mut rates.du_close),
            du_open: Parts::new(&mut rates.du_open),
            wake: Parts::new(&mut self.wake),
        };
        let d = hydro.dimensions();
        let sweep = Sweep {
            hydro,
            clock,
            next,
            tree: &self.tree,
            particles,
            derived,
            v: &rates.v_pred,
            next_span: &rates.next_span,
            extent: [&self.extent, &self.active_extent],
            support,
            norm: K::norm(d),
            power: d as i32 + 2,
            beta_ratio: hydro.viscosity.ratio(),
            level: Level::new(),
        };
        (self.tree.leaves.par_iter())
            .map(|&leaf| {
                let leaf = leaf as usize;
                BUFFERS.with_borrow_mut(|buffers| sweep.leaf::<K>(leaf, buffers, &out))
            })
            .sum()
    }
}

#[derive(Default)]
struct Buffers {
    candidates: Candidates,
    sources: Vec<Source>,
    /// H^2 of the candidates.
    reach2: Vec<f64>,
    list: List,
}

thread_local! {
    static BUFFERS: RefCell<Buffers> = RefCell::default();
}

/// The columns that the sweep writes.
struct Out<'a> {
    hydro: Parts<'a, Vec3>,
    du: Parts<'a, f64>,
    dv_close: Parts<'a, Vec3>,
    dv_open: Parts<'a, Vec3>,
    du_close: Parts<'a, f64>,
    du_open: Parts<'a, f64>,
    wake: Parts<'a, u32>,
}

/// What a particle brings into a pair.
#[derive(Clone, Copy, Debug)]
struct Source {
    v: [f64; 3],
    m: f64,
    g: f64,
    h: f64,
    /// H^2.
    reach2: f64,
    /// 1 / H.
    inverse: f64,
    /// Factor of the kernel's slope, norm / H^(d+2).
    slope: f64,
    /// P / rho^2 times `slope`.
    push: f64,
    rho: f64,
    cs: f64,
    alpha: f64,
    /// Ticks since the present step began, its planned span, and the next one's.
    age: f64,
    span: f64,
    next_span: f64,
    active: bool,
}

/// Some neighbours: separations, relative velocities and what else a pair needs, as in [`Source`].
#[derive(Default)]
struct Block {
    d: [Lanes; 3],
    dv: [Lanes; 3],
    m: Lanes,
    g: Lanes,
    h: Lanes,
    inverse: Lanes,
    slope: Lanes,
    push: Lanes,
    rho: Lanes,
    cs: Lanes,
    alpha: Lanes,
    age: Lanes,
    span: Lanes,
    next_span: Lanes,
    /// One where the pair has an active member, else zero.
    acts: Lanes,
}

/// What a particle gets, times its mass: as a rate, closing and opening.
#[derive(Default)]
struct Sums {
    force: [[Lanes; 3]; 3],
    heat: [Lanes; 3],
    /// The shortest next step of those that it meets, in ticks; infinite if it meets nobody.
    near: Lanes,
}

struct Sweep<'a> {
    hydro: &'a Hydro,
    clock: &'a Clock,
    next: &'a Clock,
    tree: &'a Tree,
    particles: &'a Particles,
    derived: &'a Derived,
    v: &'a [Vec3],
    next_span: &'a [u32],
    /// Largest H a node: of all its particles, and of its active ones (negative if there are none).
    extent: [&'a [f64]; 2],
    support: f64,
    norm: f64,
    power: i32,
    beta_ratio: f64,
    level: Level,
}

impl Sweep<'_> {
    fn leaf<K: Kernel>(&self, leaf: usize, buffers: &mut Buffers, out: &Out) -> usize {
        let range = self.tree.nodes[leaf].range();
        self.gather(leaf, range.clone(), buffers);
        range
            .map(|i| {
                let sums: Sums =
                    dispatch!(self.level, simd => self.target::<K, _>(simd, i, buffers));
                self.write(i, &sums, out);
                usize::from(sums.nearest().is_finite())
            })
            .sum()
    }

    /// Gathers what may meet the leaf's particles: everything if some of them are active, else active particles alone.
    fn gather(&self, leaf: usize, range: Range<usize>, buffers: &mut Buffers) {
        let all = self.extent[1][leaf] >= 0.0;
        let extent = self.extent[usize::from(!all)];
        let search = Search {
            tree: self.tree,
            domain: &self.hydro.domain,
            x: &self.particles.x,
            reach: self.extent[0][leaf],
            extent,
        };
        let span = bounding(self.particles.x[range].iter().copied());
        buffers.candidates.gather(&search, span, |j| {
            if all || self.active(j) {
                self.support * self.particles.h[j]
            } else {
                -1.0
            }
        });
        buffers.sources.clear();
        let index = &buffers.candidates.index;
        buffers
            .sources
            .extend(index.iter().map(|&j| self.source(j as usize)));
        buffers.reach2.clear();
        let reach2 = buffers.sources.iter().map(|source| source.reach2);
        buffers.reach2.extend(reach2);
    }

    fn active(&self, i: usize) -> bool {
        self.clock.synchronous() || self.particles.end[i] == self.clock.tick
    }

    fn source(&self, i: usize) -> Source {
        let (p, d) = (self.particles, self.derived);
        let reach = self.support * p.h[i];
        let slope = self.norm / reach.powi(self.power);
        Source {
            v: self.v[i].into(),
            m: p.m[i],
            g: d.grad_h[i] * p.m[i],
            h: p.h[i],
            reach2: reach * reach,
            inverse: 1.0 / reach,
            slope,
            push: slope * d.p[i] / (d.rho[i] * d.rho[i]),
            rho: d.rho[i],
            cs: d.cs[i],
            alpha: p.alpha[i],
            age: f64::from(self.clock.tick - p.begin[i]),
            span: f64::from(p.span[i]),
            next_span: f64::from(self.next_span[i]),
            active: self.active(i),
        }
    }

    #[inline(always)]
    fn target<K: Kernel, S: Simd>(&self, simd: S, i: usize, buffers: &mut Buffers) -> Sums {
        let Buffers {
            candidates,
            sources,
            reach2,
            list,
        } = buffers;
        let own = self.source(i);
        let place = candidates.place(self.particles.x[i]);
        candidates.list(simd, place, (own.reach2, reach2), list);
        let mut sums = Sums {
            near: [f64::INFINITY; LANES],
            ..Sums::default()
        };
        for (numbers, r2) in list.numbers().iter().zip(list.r2()) {
            let block = block(&own, place, numbers, candidates, sources);
            for (l, &r2) in r2.iter().enumerate() {
                let [pull, heat] = self.flux::<K>(&own, &block, r2, l);
                // The later begin of a pair is the lesser age.
                let closing = own.age.min(block.age[l]) - 0.5 * own.span.min(block.span[l]);
                let opening = 0.5 * own.next_span.min(block.next_span[l]);
                for (n, weight) in [1.0, closing, opening].into_iter().enumerate() {
                    for a in 0..3 {
                        sums.force[n][a][l] += weight * (pull * block.d[a][l]);
                    }
                    sums.heat[n][l] += weight * heat;
                }
                let meets = block.acts[l] > 0.0 && r2 < FAR;
                let near = if meets {
                    block.next_span[l]
                } else {
                    f64::INFINITY
                };
                sums.near[l] = sums.near[l].min(near);
            }
        }
        sums
    }

    /// The force of a pair on its first member by the separation, and the heat that stays with the first member, a time.
    #[inline(always)]
    fn flux<K: Kernel>(&self, a: &Source, b: &Block, r2: f64, l: usize) -> [f64; 2] {
        let r = r2.sqrt();
        let slope_a = K::slope((r * a.inverse).min(1.0));
        let slope_b = K::slope((r * b.inverse[l]).min(1.0));
        let approach = b.dv[0][l] * b.d[0][l] + b.dv[1][l] * b.d[1][l] + b.dv[2][l] * b.d[2][l];
        let pressure_a = a.m * (b.m[l] - a.g) * a.push * slope_a;
        let pressure_b = b.m[l] * (a.m - b.g[l]) * b.push[l] * slope_b;
        let h = 0.5 * (a.h + b.h[l]);
        let mu = h * approach.min(0.0) / (r2 + 0.01 * h * h);
        let alpha = 0.5 * (a.alpha + b.alpha[l]);
        let strength = alpha * mu * (self.beta_ratio * mu - 0.5 * (a.cs + b.cs[l]));
        let slope = 0.5 * (a.slope * slope_a + b.slope[l] * slope_b);
        let viscous = a.m * b.m[l] * slope * strength / (0.5 * (a.rho + b.rho[l]));
        [
            b.acts[l] * (pressure_a + pressure_b + viscous),
            b.acts[l] * ((pressure_a + 0.5 * viscous) * approach),
        ]
    }

    fn write(&self, i: usize, sums: &Sums, out: &Out) {
        let by_mass = 1.0 / self.particles.m[i];
        let closing = by_mass * self.clock.unit();
        let opening = by_mass * self.next.unit();
        let (near, span) = (sums.nearest(), self.next_span[i]);
        let wake = if near < f64::from(span / 4) {
            self.next.waking(4 * near as u32)
        } else {
            NEVER
        };
        let force = |n: usize| Vec3::from_fn(|a, _| total(sums.force[n][a]));
        let heat = |n: usize| total(sums.heat[n]);
        let own = i..i + 1;
        // SAFETY: a leaf's task alone touches the leaf's particles.
        unsafe {
            if self.active(i) {
                out.hydro.part(own.clone())[0] = by_mass * force(0);
                out.du.part(own.clone())[0] = by_mass * heat(0);
            }
            out.dv_close.part(own.clone())[0] = closing * force(1);
            out.dv_open.part(own.clone())[0] = opening * force(2);
            out.du_close.part(own.clone())[0] = closing * heat(1);
            out.du_open.part(own.clone())[0] = opening * heat(2);
            out.wake.part(own)[0] = wake;
        }
    }
}

impl Sums {
    fn nearest(&self) -> f64 {
        self.near.into_iter().fold(f64::INFINITY, f64::min)
    }
}

#[inline(always)]
fn block(
    own: &Source,
    place: [f64; 3],
    numbers: &[u32; LANES],
    candidates: &Candidates,
    sources: &[Source],
) -> Block {
    let mut block = Block::default();
    for (l, &k) in numbers.iter().enumerate() {
        let k = k as usize;
        let (s, d) = (
            &sources[k],
            [candidates.x[k], candidates.y[k], candidates.z[k]],
        );
        for a in 0..3 {
            block.d[a][l] = d[a] - place[a];
            block.dv[a][l] = s.v[a] - own.v[a];
        }
        (block.m[l], block.g[l], block.h[l]) = (s.m, s.g, s.h);
        (block.inverse[l], block.slope[l], block.push[l]) = (s.inverse, s.slope, s.push);
        (block.rho[l], block.cs[l], block.alpha[l]) = (s.rho, s.cs, s.alpha);
        (block.age[l], block.span[l], block.next_span[l]) = (s.age, s.span, s.next_span);
        block.acts[l] = f64::from(u8::from(own.active || s.active));
    }
    block
}

#[cfg(test)]
mod tests;
