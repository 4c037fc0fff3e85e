//! The sweep over all active particles, leaf by leaf: H of each, and the sums over its neighbours.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use fearless_simd::{Level, Simd, SimdBase};
use nbody::points::Clock;
use rayon::prelude::*;

use super::law::{Law, Trial};
use super::out::Out;
use super::sums::{Local, Own, Sums};
use crate::Hydro;
use crate::lanes::{Job, Lanes, Machine, load};
use crate::neighbours::{FEW, Frame, Packed, Region, Search};
use crate::workspace::Element;

/// How much farther than the predicted support a search goes, so that the solution lies inside.
const SLACK: f64 = 1.04;

/// What the sweep over a leaf counted: active particles, and the first one without a solution.
#[derive(Clone, Copy, Default)]
pub struct Tally {
    pub targets: usize,
    pub failed: Option<(usize, f64)>,
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

/// A particle whose H is sought within `radius`, beginning at `start`.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    i: usize,
    start: f64,
    radius: f64,
}

/// What became of a target.
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all are done, and none is kept"
)]
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

/// All that the leaves share; lengths, velocities and masses in the units of the frame.
pub struct Sweep<'a, E> {
    pub hydro: &'a Hydro,
    pub clock: &'a Clock,
    pub frame: Frame<'a>,
    pub packed: &'a Packed<E>,
    pub end: &'a [u32],
    pub m: &'a [f64],
    /// The largest H.
    pub largest: f64,
    /// Smoothing length in code units a unit of H.
    pub h_by_reach: f64,
    pub law: Law,
    pub level: Level,
    pub out: Out<'a>,
    /// The particles that are to be done, if not all that are active; ascending.
    pub listed: Option<&'a [u32]>,
    /// How far is packed around each leaf, code units, by node; and who needs more.
    pub seen: &'a [f64],
    pub beyond: Mutex<Vec<u32>>,
}

/// The sweep over the leaves of a branch.
struct Branch<'a, E, const GRADIENT: bool> {
    sweep: &'a Sweep<'a, E>,
    branch: usize,
    region: &'a mut Region<E>,
    pending: &'a mut Vec<Target>,
    /// How far the leaves around have been sought, code units.
    sought: f64,
}

impl<E: Element, const GRADIENT: bool> Job<E> for Branch<'_, E, GRADIENT> {
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
                let failed = sweep.settle::<GRADIENT, S, R>(simd, leaf, region, pending);
                tally = tally.and(Tally { targets: 0, failed });
            }
        }
        tally
    }
}

impl<E: Element> Sweep<'_, E> {
    pub fn run<const GRADIENT: bool>(&self, branches: &[u32]) -> Tally {
        let tallies = branches.par_iter().map(|&branch| {
            E::with_workspace(|space| {
                let branch = branch as usize;
                let sought = self.reach(branch);
                (space.region.around).find(&self.frame, branch, sought, &[]);
                let branch = Branch::<E, GRADIENT> {
                    sweep: self,
                    branch,
                    region: &mut space.region,
                    pending: &mut space.pending,
                    sought,
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
        let h = unsafe { self.out.h().part(range.clone()) };
        let active = range.zip(h).filter(|(i, _)| self.active(*i));
        let largest = active.fold(0.0, |largest: f64, (_, h)| largest.max(*h));
        (SLACK * largest / self.h_by_reach).min(self.largest) * self.frame.units.length
    }

    /// Settles what can be settled of `pending`; returns the first particle without a solution.
    #[inline(always)]
    fn settle<const GRADIENT: bool, S: Simd, R: Machine<S, E>>(
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
            match self.solve::<GRADIENT, S, R>(simd, &mut target, region) {
                Outcome::Done { local, reach } => self.out.write(target.i, &local, reach),
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
        let h = unsafe { self.out.h().part(i..i + 1) }[0];
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
    fn solve<const GRADIENT: bool, S: Simd, R: Machine<S, E>>(
        &self,
        simd: S,
        target: &mut Target,
        region: &mut Region<E>,
    ) -> Outcome {
        region.near::<S, R>(simd, self.packed.place(target.i), target.radius);
        let r = region.distances(simd);
        match (self.law).solve::<S, E, R>(simd, r, target.start, target.radius) {
            Trial::Found(reach) => {
                self.sums::<GRADIENT, S, R>(simd, target.i, (reach, true), region)
            }
            Trial::Short(number) if target.radius < self.largest && number > 0.0 => {
                let growth = (self.law.wanted / number).powf(1.0 / self.law.d);
                target.start = target.radius;
                Outcome::Wider((target.radius * (SLACK * growth).clamp(1.1, 1.6)).min(self.largest))
            }
            Trial::Short(number) if number > 0.0 => {
                self.sums::<GRADIENT, S, R>(simd, target.i, (self.largest, false), region)
            }
            Trial::Short(_) => Outcome::Failed(target.radius),
            Trial::Failed(reach) => Outcome::Failed(reach),
        }
    }

    /// The sums over the listed neighbours of particle i at support H = `reach`; `free` says whether H follows the particles.
    #[inline(always)]
    fn sums<const GRADIENT: bool, S: Simd, R: Machine<S, E>>(
        &self,
        simd: S,
        i: usize,
        (reach, free): (f64, bool),
        region: &Region<E>,
    ) -> Outcome {
        let units = &self.frame.units;
        let own = Own {
            row: self.packed.row(i),
            m: self.m[i] / units.mass,
            reach,
            velocity_step: units.velocity_step / units.velocity,
            shear: units.shear,
        };
        let mut sums = Sums::new(simd);
        for first in (0..region.count()).step_by(Lanes::<S, E>::LEN) {
            let columns = [
                region.quad_near::<S, R>(simd, self.packed, 0, first),
                region.quad_near::<S, R>(simd, self.packed, 1, first),
            ];
            let d = region.separations(simd, first);
            let r = load(simd, region.distances(simd), first);
            sums.add::<GRADIENT, R>(simd, &self.law, &own, columns, (d, r));
        }
        let local = sums.local::<GRADIENT, R>(&self.law, &own, free, self.hydro.domain.axes);
        Outcome::Done { local, reach }
    }
}
