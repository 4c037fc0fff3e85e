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

use nbody::points::sum::Parts;
use nbody::points::{Clock, Tree, Vec3};
use rayon::prelude::*;

use crate::neighbours::{Candidates, List, Search, bounding};
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

/// The force of a pair on its first member: `pull` times the separation; and the heat that stays with the first member, a time.
struct Flux {
    pull: f64,
    heat: f64,
}

/// What a particle gets, times its mass.
#[derive(Default)]
struct Sums {
    force: [Vec3; 3],
    heat: [f64; 3],
    pairs: usize,
    near: u32,
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
}

impl Sweep<'_> {
    fn leaf<K: Kernel>(&self, leaf: usize, buffers: &mut Buffers, out: &Out) -> usize {
        let range = self.tree.nodes[leaf].range();
        self.gather(leaf, range.clone(), buffers);
        range
            .map(|i| {
                let sums = self.target::<K>(i, buffers);
                self.write(i, &sums, out);
                usize::from(sums.pairs > 0)
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

    fn target<K: Kernel>(&self, i: usize, buffers: &mut Buffers) -> Sums {
        let Buffers {
            candidates,
            sources,
            list,
        } = buffers;
        let own = self.source(i);
        let place = candidates.place(self.particles.x[i]);
        let limit = |k: usize| {
            let source: &Source = &sources[k];
            if own.active || source.active {
                own.reach2.max(source.reach2)
            } else {
                -1.0
            }
        };
        candidates.list(place, limit, list);
        let mut sums = Sums {
            near: NEVER,
            ..Sums::default()
        };
        for (&k, &r2) in list.numbers().iter().zip(list.r2()) {
            let source = &sources[k as usize];
            let d = candidates.separation(place, k as usize);
            let flux = self.flux::<K>(&own, source, d, r2);
            sums.add(flux, Vec3::from(d), weights(&own, source));
            sums.near = sums
                .near
                .min(self.next_span[candidates.index[k as usize] as usize]);
        }
        sums
    }

    #[inline(always)]
    fn flux<K: Kernel>(&self, a: &Source, b: &Source, d: [f64; 3], r2: f64) -> Flux {
        let r = r2.sqrt();
        let (slope_a, slope_b) = (K::slope(r * a.inverse), K::slope(r * b.inverse));
        let approach =
            (b.v[0] - a.v[0]) * d[0] + (b.v[1] - a.v[1]) * d[1] + (b.v[2] - a.v[2]) * d[2];
        let pressure_a = a.m * (b.m - a.g) * a.push * slope_a;
        let pressure_b = b.m * (a.m - b.g) * b.push * slope_b;
        let viscous = if approach < 0.0 {
            let h = 0.5 * (a.h + b.h);
            let mu = h * approach / (r2 + 0.01 * h * h);
            let alpha = 0.5 * (a.alpha + b.alpha);
            let strength = alpha * mu * (self.beta_ratio * mu - 0.5 * (a.cs + b.cs));
            let slope = 0.5 * (a.slope * slope_a + b.slope * slope_b);
            a.m * b.m * slope * strength / (0.5 * (a.rho + b.rho))
        } else {
            0.0
        };
        Flux {
            pull: pressure_a + pressure_b + viscous,
            heat: (pressure_a + 0.5 * viscous) * approach,
        }
    }

    fn write(&self, i: usize, sums: &Sums, out: &Out) {
        let by_mass = 1.0 / self.particles.m[i];
        let closing = by_mass * self.clock.unit();
        let opening = by_mass * self.next.unit();
        let span = self.next_span[i];
        let wake = if sums.near < span / 4 {
            self.next.waking(4 * sums.near)
        } else {
            NEVER
        };
        let own = i..i + 1;
        // SAFETY: a leaf's task alone touches the leaf's particles.
        unsafe {
            if self.active(i) {
                out.hydro.part(own.clone())[0] = by_mass * sums.force[0];
                out.du.part(own.clone())[0] = by_mass * sums.heat[0];
            }
            out.dv_close.part(own.clone())[0] = closing * sums.force[1];
            out.dv_open.part(own.clone())[0] = opening * sums.force[2];
            out.du_close.part(own.clone())[0] = closing * sums.heat[1];
            out.du_open.part(own.clone())[0] = opening * sums.heat[2];
            out.wake.part(own)[0] = wake;
        }
    }
}

/// Weights in ticks with which a pair closes its step and opens the next.
#[inline(always)]
fn weights(a: &Source, b: &Source) -> [f64; 2] {
    // As clock::closing and clock::opening: the later begin is the lesser age.
    let closing = a.age.min(b.age) - 0.5 * a.span.min(b.span);
    [closing, 0.5 * a.next_span.min(b.next_span)]
}

impl Sums {
    #[inline(always)]
    fn add(&mut self, flux: Flux, d: Vec3, [closing, opening]: [f64; 2]) {
        let force = flux.pull * d;
        self.force[0] += force;
        self.force[1] += closing * force;
        self.force[2] += opening * force;
        self.heat[0] += flux.heat;
        self.heat[1] += closing * flux.heat;
        self.heat[2] += opening * flux.heat;
        self.pairs += 1;
    }
}

#[cfg(test)]
mod tests;
