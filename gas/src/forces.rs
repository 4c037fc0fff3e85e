//! Pair forces of pressure and viscosity, and the impulses that they give.
//!
//! m_i dv_i/dt = -sum_j [ m_i (m_j - g_i) P_i/rho_i^2 grad W(r, H_i) + m_j (m_i - g_j) P_j/rho_j^2 grad W(r, H_j) + m_i m_j Pi_ij grad W_ij ]
//! m_i du_i/dt =  sum_j [ m_i (m_j - g_i) P_i/rho_i^2 grad W(r, H_i) + m_i m_j Pi_ij grad W_ij / 2 ] . v_ij
//!
//! with W_ij the mean of the two kernels. Both members of a pair compute the same force from the same numbers. A pair steps with the
//! shorter step of the two: its force counts where at least one member is active, and the impulse goes to both.
//! Sources: Springel & Hernquist (2002); Hopkins (2013); pairwise steps: Saitoh & Makino (2009, 2010).

use std::ops::Range;

use fearless_simd::{Level, Simd, SimdBase};
use nbody::points::sum::Parts;
use nbody::points::{Clock, Tree, Vec3};
use rayon::prelude::*;

use crate::lanes::{Job, Lanes, Machine, Quad, Real};
use crate::neighbours::{Around, FEW, Frame, Packed, Region, Search};
use crate::units::Units;
use crate::vicinity::Vicinity;
use crate::workspace::Element;
use crate::{
    CubicSpline, Derived, Gas, Hydro, Kernel, KernelKind, Particles, Precision, WendlandC2,
};

mod pair;
mod sums;

use pair::{Flux, Member, QUADS, Separation};
use sums::{Even, Mixed, Sums, Total};

/// A tick that never comes.
pub(crate) const NEVER: u32 = u32::MAX;

impl Gas {
    /// Forces of the pairs that have an active member: rates of the active particles, and the impulses that close the steps ending now and
    /// open those beginning now, in which `next` is the clock. Returns the number of particles that had such a pair.
    pub fn forces(&mut self, hydro: &Hydro, clock: &Clock, next: &Clock) -> usize {
        match (hydro.kernel, hydro.precision) {
            (KernelKind::CubicSpline, Precision::Single) => {
                self.forces_with::<CubicSpline, f32>(hydro, clock, next)
            }
            (KernelKind::CubicSpline, Precision::Double) => {
                self.forces_with::<CubicSpline, f64>(hydro, clock, next)
            }
            (KernelKind::WendlandC2, Precision::Single) => {
                self.forces_with::<WendlandC2, f32>(hydro, clock, next)
            }
            (KernelKind::WendlandC2, Precision::Double) => {
                self.forces_with::<WendlandC2, f64>(hydro, clock, next)
            }
        }
    }

    fn forces_with<K: Kernel, E: Element>(
        &mut self,
        hydro: &Hydro,
        clock: &Clock,
        next: &Clock,
    ) -> usize {
        if self.is_empty() {
            return 0;
        }
        let level = self.level.unwrap_or_else(Level::new);
        let mut packed = std::mem::take(E::packed(&mut self.packed));
        let (particles, derived, rates) = (&self.particles, &self.derived, &mut self.rates);
        let (support, h) = (hydro.support(), &particles.h);
        let Vicinity {
            near,
            leaves,
            near_branches,
            ..
        } = &self.vicinity;
        let active = |i: usize| clock.synchronous() || particles.end[i] == clock.tick;
        let own = |i: usize| support * h[i];
        (self.tree).largest_of(near, own, &mut self.extent);
        let own = |i: usize| if active(i) { support * h[i] } else { -1.0 };
        (self.tree).largest_of(leaves, own, &mut self.active_extent);
        self.wake.resize(particles.m.len(), NEVER);
        let units = Units::new(
            hydro,
            (&self.tree, near),
            h,
            &particles.m,
            &rates.v_pred,
            &derived.cs,
        );
        let frame = Frame {
            tree: &self.tree,
            domain: &hydro.domain,
            x: &particles.x,
            units,
        };
        let d = hydro.dimensions();
        let pack = Pack {
            units,
            clock,
            particles,
            derived,
            v: &rates.v_pred,
            next_span: &rates.next_span,
            support,
            push: K::norm(d),
            power: d as i32,
        };
        packed.fill::<QUADS>(&frame, near, |i, d, coarser| pack.source(i, d, coarser));
        pack.paces(&self.tree, near, &mut self.paces);
        let sweep = Sweep {
            clock,
            next,
            frame,
            packed: &packed,
            m: &particles.m,
            end: &particles.end,
            next_span: &rates.next_span,
            extent: [&self.extent, &self.active_extent],
            paces: &self.paces,
            three: d == 3,
            limiter: hydro.limiter,
            level,
            flux: Flux {
                norm: K::norm(d),
                beta_ratio: hydro.viscosity.ratio(),
                h_by_reach: 1.0 / support,
            },
            out: Out {
                hydro: Parts::new(&mut rates.hydro),
                du: Parts::new(&mut rates.du),
                dv_close: Parts::new(&mut rates.dv_close),
                dv_open: Parts::new(&mut rates.dv_open),
                du_close: Parts::new(&mut rates.du_close),
                du_open: Parts::new(&mut rates.du_open),
                wake: Parts::new(&mut self.wake),
            },
        };
        let targets = sweep.run::<K>(near_branches);
        *E::packed(&mut self.packed) = packed;
        targets
    }
}

/// The columns from which particles are packed.
struct Pack<'a> {
    units: Units,
    clock: &'a Clock,
    particles: &'a Particles,
    derived: &'a Derived,
    v: &'a [Vec3],
    next_span: &'a [u32],
    support: f64,
    /// Factor of the kernel's slope.
    push: f64,
    /// Dimensions.
    power: i32,
}

impl Pack<'_> {
    fn pace(&self, i: usize) -> Pace {
        Pace {
            age: self.clock.tick - self.particles.begin[i],
            span: self.particles.span[i],
            next_span: self.next_span[i],
        }
    }

    /// The paces of some leaves. Steps that end too early count as mixed: their weights are no powers of two.
    fn paces(&self, tree: &Tree, leaves: &[u32], paces: &mut Vec<Pace>) {
        paces.resize(tree.nodes.len(), Pace::MIXED);
        let paces = Parts::new(paces);
        leaves.par_iter().with_min_len(64).for_each(|&leaf| {
            let leaf = leaf as usize;
            let mut range = tree.nodes[leaf].range();
            let first = self.pace(range.start);
            let same = first.age == first.span && range.all(|i| self.pace(i) == first);
            // SAFETY: each leaf is listed once.
            unsafe { paces.part(leaf..leaf + 1)[0] = if same { first } else { Pace::MIXED } };
        });
    }

    /// Reach and row of particle i, which stands at `d` from the middle of its leaf, where steps are doubled `coarser` times.
    #[inline(always)]
    fn source<E: Real>(&self, i: usize, d: Vec3, coarser: i32) -> (f64, [Quad<E>; QUADS]) {
        let (p, derived, units) = (self.particles, self.derived, &self.units);
        let real = E::from_f64;
        let (m, reach) = (p.m[i] / units.mass, self.support * p.h[i] / units.length);
        let rho = derived.rho[i] * (units.length.powi(self.power) / units.mass);
        let specific = derived.p[i] / (derived.rho[i] * units.velocity * units.velocity);
        let push = self.push / reach.powi(self.power + 2) * specific / rho;
        let x = (d * 0.5f64.powi(coarser)).component_div(&units.step);
        let x = x.map(E::place);
        let v = self.v[i].map(|v| E::place(v / units.velocity_step));
        let active = self.clock.synchronous() || p.end[i] == self.clock.tick;
        let ticks = |n: u32| real(f64::from(n));
        (
            if active { reach } else { -reach },
            [
                Quad([x.x, x.y, x.z, real(m)]),
                Quad([v.x, v.y, v.z, real(derived.grad_h[i] * m)]),
                Quad([reach, push, rho, derived.cs[i] / units.velocity].map(real)),
                Quad([
                    real(p.alpha[i]),
                    ticks(self.clock.tick - p.begin[i]),
                    ticks(p.span[i]),
                    ticks(self.next_span[i]),
                ]),
            ],
        )
    }
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

/// Where particles stand on the clock: ticks since the present step began, its planned span, and the next one's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    age: u32,
    span: u32,
    next_span: u32,
}

impl Pace {
    /// Of a leaf whose particles differ.
    const MIXED: Self = Self {
        age: NEVER,
        span: 0,
        next_span: 0,
    };

    /// What closes and what opens the steps of pairs at this pace, in ticks.
    fn weights(&self) -> [f64; 2] {
        let half = 0.5 * f64::from(self.span);
        [f64::from(self.age) - half, 0.5 * f64::from(self.next_span)]
    }
}

/// The grid that coordinates about a leaf lie on.
struct Grid<E> {
    /// Units of length a step along each axis, and units of velocity a step of velocity.
    length: [E; 3],
    velocity: E,
    /// How many times steps are doubled where the leaf is packed, and where its neighbours are gathered.
    from: i32,
    to: i32,
}

/// All that the leaves share.
struct Sweep<'a, E> {
    clock: &'a Clock,
    next: &'a Clock,
    frame: Frame<'a>,
    packed: &'a Packed<E>,
    m: &'a [f64],
    end: &'a [u32],
    next_span: &'a [u32],
    /// Largest H a node: of its particles in near leaves, and of its active ones (negative if there are none).
    extent: [&'a [f64]; 2],
    /// The pace of each leaf, by node.
    paces: &'a [Pace],
    three: bool,
    /// How many times longer than a neighbour's a step may be.
    limiter: u32,
    flux: Flux,
    level: Level,
    out: Out<'a>,
}

/// The sweep over the leaves of a branch.
struct Branch<'a, E, K> {
    sweep: &'a Sweep<'a, E>,
    branch: usize,
    /// The pace of all around, unless it is mixed.
    pace: Option<Pace>,
    region: &'a mut Region<E>,
    kernel: std::marker::PhantomData<K>,
}

impl<E: Element, K: Kernel> Job<E> for Branch<'_, E, K> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Simd, R: Machine<S, E>>(self, simd: S) -> usize {
        let Self {
            sweep,
            branch,
            pace,
            region,
            ..
        } = self;
        let nodes = &sweep.frame.tree.nodes;
        let mut met = 0;
        for leaf in sweep.leaves(branch) {
            let coarser = sweep.gather(simd, leaf, region);
            let grid = sweep.grid(leaf, coarser);
            let range = nodes[leaf].range();
            for i in range.clone() {
                if (i - range.start) % FEW == 0 {
                    let (span, reach) = sweep.span(i..(i + FEW).min(range.end));
                    region.focus(simd, span, reach, true);
                }
                met += usize::from(match pace {
                    Some(pace) => {
                        let mut sums = Even::new(simd);
                        sweep.target::<K, S, R, _>(simd, i, &grid, region, &mut sums);
                        sweep.write(i, &sums.total::<R>(pace, region.count()))
                    }
                    None => {
                        let mut sums = Mixed::new(simd);
                        sweep.target::<K, S, R, _>(simd, i, &grid, region, &mut sums);
                        sweep.write(i, &sums.total::<R>())
                    }
                });
            }
        }
        met
    }
}

impl<E: Element> Sweep<'_, E> {
    fn run<K: Kernel>(&self, branches: &[u32]) -> usize {
        let branches = branches.par_iter().map(|&branch| {
            E::with_workspace(|space| {
                let branch = branch as usize;
                let extent = self.extent[usize::from(self.extent[1][branch] < 0.0)];
                let around = &mut space.region.around;
                around.find(&self.frame, branch, self.extent[0][branch], extent);
                if around.is_empty() {
                    (self.leaves(branch)).for_each(|leaf| self.rest(leaf));
                    return 0;
                }
                let pace = self.pace(branch, around);
                let branch = Branch::<E, K> {
                    sweep: self,
                    branch,
                    pace,
                    region: &mut space.region,
                    kernel: std::marker::PhantomData,
                };
                E::run(self.level, branch)
            })
        });
        branches.sum()
    }

    /// The box around some particles, and the largest of their reaches.
    #[inline(always)]
    fn span(&self, few: Range<usize>) -> ([[E; 3]; 2], f64) {
        let mut span = [
            [E::from_f64(f64::INFINITY); 3],
            [E::from_f64(f64::NEG_INFINITY); 3],
        ];
        let mut reach: f64 = 0.0;
        for i in few {
            reach = reach.max(self.packed.reach(i));
            for (a, x) in self.packed.place(i).into_iter().enumerate() {
                span[0][a] = if x < span[0][a] { x } else { span[0][a] };
                span[1][a] = if x > span[1][a] { x } else { span[1][a] };
            }
        }
        (span, reach)
    }

    /// The pace of a branch and all around it, unless it is mixed.
    fn pace(&self, branch: usize, around: &Around) -> Option<Pace> {
        let mut paces = around.nodes().map(|leaf| self.paces[leaf]);
        let pace = paces.next().filter(|&pace| pace != Pace::MIXED)?;
        // Without active particles the branch is not around itself.
        (self.extent[1][branch] >= 0.0 && paces.all(|other| other == pace)).then_some(pace)
    }

    /// The near leaves of a branch.
    #[inline(always)]
    fn leaves(&self, branch: usize) -> impl Iterator<Item = usize> {
        let (tree, near) = (self.frame.tree, self.extent[0]);
        let nodes = branch..tree.nodes[branch].skip as usize;
        nodes.filter(move |&node| tree.is_leaf(node) && near[node] >= 0.0)
    }

    /// What the particles of a leaf get that meets nobody.
    fn rest(&self, leaf: usize) {
        let (own, out) = (self.frame.tree.nodes[leaf].range(), &self.out);
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            out.dv_close.part(own.clone()).fill(Vec3::zeros());
            out.dv_open.part(own.clone()).fill(Vec3::zeros());
            out.du_close.part(own.clone()).fill(0.0);
            out.du_open.part(own.clone()).fill(0.0);
            out.wake.part(own).fill(NEVER);
        }
    }

    fn active(&self, i: usize) -> bool {
        self.clock.synchronous() || self.end[i] == self.clock.tick
    }

    /// The grid about a leaf on which steps are doubled `to` times.
    #[inline(always)]
    fn grid(&self, leaf: usize, to: i32) -> Grid<E> {
        let units = &self.frame.units;
        let scale = (0..to).fold(1.0 / units.length, |scale, _| 2.0 * scale);
        let mut length = [E::default(); 3];
        for (a, length) in length.iter_mut().enumerate() {
            *length = E::from_f64(units.step[a] * scale);
        }
        Grid {
            length,
            velocity: E::from_f64(units.velocity_step / units.velocity),
            from: self.packed.middle(leaf).coarser,
            to,
        }
    }

    /// Gathers what may meet the leaf's particles: everything if some of them are active, else active particles alone.
    #[inline(always)]
    fn gather<S: Simd>(&self, simd: S, leaf: usize, region: &mut Region<E>) -> i32 {
        let all = self.extent[1][leaf] >= 0.0;
        let node = &self.frame.tree.nodes[leaf];
        let (centre, unit) = (self.packed.middle(leaf).x, self.frame.units.length);
        let mut span = [[E::default(); 3]; 2];
        for a in (0..3).filter(|&a| self.frame.domain.axes[a]) {
            span[0][a] = E::from_f64((node.lo[a] - centre[a]) / unit);
            span[1][a] = E::from_f64((node.hi[a] - centre[a]) / unit);
        }
        let search = Search {
            frame: &self.frame,
            packed: self.packed,
            leaf,
            span,
            reach: self.extent[0][leaf] / unit,
            extent: self.extent[usize::from(!all)],
            active: !all,
        };
        let far = region.gather(simd, &search);
        region.fetch::<QUADS>(&search, far, nobody())
    }

    #[inline(always)]
    fn target<K: Kernel, S: Simd, R: Machine<S, E>, T: Sums<S, E>>(
        &self,
        simd: S,
        i: usize,
        grid: &Grid<E>,
        region: &mut Region<E>,
        sums: &mut T,
    ) {
        let mut row = self.packed.row(i);
        row[0] = E::moved(row[0], [0.0; 3], grid.from, grid.to);
        let own = Member::<S, E>::alone::<R>(simd, &row, self.three);
        let reach = row[2].0[0].to_f64();
        let place = self.packed.place(i);
        region.meet(simd, place, reach * reach, !self.active(i));
        for first in (0..region.count()).step_by(Lanes::<S, E>::LEN) {
            let columns = [
                region.quad::<S, R>(simd, 0, first),
                region.quad::<S, R>(simd, 1, first),
                region.quad::<S, R>(simd, 2, first),
                region.quad::<S, R>(simd, 3, first),
            ];
            let other = Member::new::<R>(simd, columns, self.three);
            let pair = Separation::new(simd, &row, &columns, grid.length, grid.velocity);
            let flux = (self.flux).between::<K, S, E, R>(simd, &own, &other, &pair);
            let force = [
                flux[0] * pair.d[0],
                flux[0] * pair.d[1],
                flux[0] * pair.d[2],
            ];
            sums.add(simd, &own, &other, force, flux[1]);
        }
    }

    /// Writes what particle i gets; returns whether it meets anybody.
    #[inline(always)]
    fn write(&self, i: usize, total: &Total) -> bool {
        let units = &self.frame.units;
        let energy = units.mass * units.velocity * units.velocity / units.length;
        let by_mass = energy / self.m[i];
        let closing = by_mass * self.clock.unit();
        let opening = by_mass * self.next.unit();
        let span = self.next_span[i];
        let wake = if total.near < f64::from(span / self.limiter) {
            self.next.waking(self.limiter * total.near as u32)
        } else {
            NEVER
        };
        let [rate, close, open] = total.force;
        let heat = total.heat.map(
            #[inline(always)]
            |heat| units.velocity * heat,
        );
        let (own, out) = (i..i + 1, &self.out);
        // SAFETY: a branch's task alone touches the branch's particles.
        unsafe {
            if self.active(i) {
                out.hydro.part(own.clone())[0] = scaled(by_mass, rate);
                out.du.part(own.clone())[0] = by_mass * heat[0];
            }
            out.dv_close.part(own.clone())[0] = scaled(closing, close);
            out.dv_open.part(own.clone())[0] = scaled(opening, open);
            out.du_close.part(own.clone())[0] = closing * heat[1];
            out.du_open.part(own.clone())[0] = opening * heat[2];
            out.wake.part(own)[0] = wake;
        }
        total.near.is_finite()
    }
}

#[inline(always)]
fn scaled(factor: f64, [x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(factor * x, factor * y, factor * z)
}

/// A row of what is beyond any kernel and has no mass.
fn nobody<E: Real>() -> [Quad<E>; QUADS] {
    // Beyond what the coordinates of the candidates span: the difference is a whole number still.
    let far = E::place(if E::STEPS.is_finite() {
        2.5 * E::STEPS
    } else {
        1e30
    });
    let (zero, one) = (E::from_f64(0.0), E::from_f64(1.0));
    let never = E::from_f64(f64::INFINITY);
    [
        Quad([far, far, far, zero]),
        Quad([zero; 4]),
        Quad([one, zero, one, zero]),
        Quad([zero, zero, zero, never]),
    ]
}

#[cfg(test)]
mod tests;
