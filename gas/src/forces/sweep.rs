//! The sweep over all pairs, leaf by leaf: each particle gets what its pairs give it.

use std::ops::Range;

use fearless_simd::{Level, Simd, SimdBase};
use nbody::points::Clock;
use rayon::prelude::*;

use super::out::Out;
use super::pack::{Pace, nobody};
use super::pair::{Flux, MORE, Member, QUADS, STRAINED, Separation};
use super::state::States;
use super::sums::{Even, Mixed, Sums};
use crate::lanes::{Job, Lanes, Machine, Quad, same};
use crate::neighbours::{Around, FEW, Frame, Packed, Region, Search};
use crate::workspace::Element;

/// The grid that coordinates about a leaf lie on.
pub struct Grid<E> {
    /// Units of length a step along each axis, and units of velocity a step of velocity.
    pub length: [E; 3],
    pub velocity: E,
    /// -dv_y/dx of the shear that velocities are relative to.
    pub shear: E,
    /// How many times steps are doubled where the leaf is packed, and where its neighbours are gathered.
    from: i32,
    to: i32,
}

/// All that the leaves share.
pub struct Sweep<'a, E> {
    pub clock: &'a Clock,
    pub frame: Frame<'a>,
    pub packed: &'a Packed<E>,
    pub end: &'a [u32],
    /// Largest H a node: of its particles in near leaves, and of its active ones (negative if there are none).
    pub extent: [&'a [f64]; 2],
    /// The pace of each leaf, by node.
    pub paces: &'a [Pace],
    pub flux: Flux,
    pub states: &'a States<'a>,
    pub level: Level,
    pub out: Out<'a>,
}

/// The sweep over the leaves of a branch, of particles whose rows have `Q` quads.
struct Branch<'a, E, const Q: usize> {
    sweep: &'a Sweep<'a, E>,
    branch: usize,
    /// The pace of all around, unless it is mixed.
    pace: Option<Pace>,
    region: &'a mut Region<E>,
}

impl<'a, E, const Q: usize> Branch<'a, E, Q> {
    fn new(
        sweep: &'a Sweep<'a, E>,
        branch: usize,
        pace: Option<Pace>,
        region: &'a mut Region<E>,
    ) -> Self {
        Self {
            sweep,
            branch,
            pace,
            region,
        }
    }
}

impl<E: Element, const Q: usize> Job<E> for Branch<'_, E, Q> {
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
            let coarser = sweep.gather::<Q, S>(simd, leaf, region);
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
                        sweep.target::<Q, S, R, _>(simd, i, &grid, region, &mut sums);
                        let total = sums.total::<R>(pace, region.count());
                        sweep.out.write(i, &total, sweep.active(i))
                    }
                    None => {
                        let mut sums = Mixed::new(simd);
                        sweep.target::<Q, S, R, _>(simd, i, &grid, region, &mut sums);
                        sweep.out.write(i, &sums.total::<R>(), sweep.active(i))
                    }
                });
            }
        }
        met
    }
}

impl<E: Element> Sweep<'_, E> {
    pub fn run(&self, branches: &[u32]) -> usize {
        let branches = branches.par_iter().map(|&branch| {
            E::with_workspace(|space| {
                let branch = branch as usize;
                let extent = self.extent[usize::from(self.extent[1][branch] < 0.0)];
                let around = &mut space.region.around;
                around.find(&self.frame, branch, self.extent[0][branch], extent);
                if around.is_empty() {
                    (self.leaves(branch))
                        .for_each(|leaf| self.out.rest(self.frame.tree.nodes[leaf].range()));
                    return 0;
                }
                let pace = self.pace(branch, around);
                let region = &mut space.region;
                match self.flux.quads() {
                    QUADS => E::run(
                        self.level,
                        Branch::<E, QUADS>::new(self, branch, pace, region),
                    ),
                    STRAINED => E::run(
                        self.level,
                        Branch::<E, STRAINED>::new(self, branch, pace, region),
                    ),
                    _ => E::run(
                        self.level,
                        Branch::<E, MORE>::new(self, branch, pace, region),
                    ),
                }
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
            shear: E::from_f64(units.shear),
            from: self.packed.middle(leaf).coarser,
            to,
        }
    }

    /// Gathers what may meet the leaf's particles: everything if some of them are active, else active particles alone.
    #[inline(always)]
    fn gather<const Q: usize, S: Simd>(&self, simd: S, leaf: usize, region: &mut Region<E>) -> i32 {
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
        region.fetch::<Q>(&search, far, nobody())
    }

    #[inline(always)]
    fn target<const Q: usize, S: Simd, R: Machine<S, E>, A: Sums<S, E>>(
        &self,
        simd: S,
        i: usize,
        grid: &Grid<E>,
        region: &mut Region<E>,
        sums: &mut A,
    ) {
        let flux = self.flux.of::<Q>();
        let mut row = [Quad::default(); MORE];
        row[..Q].copy_from_slice(&self.packed.row::<Q>(i));
        row[0] = E::moved(row[0], [0.0; 3], grid.from, grid.to);
        let mut own = Member::<S, E>::alone::<R>(simd, &row, &flux);
        own.work += same::<S, E>(simd, self.states.left_out(i));
        let reach = row[2].0[0].to_f64();
        let place = self.packed.place(i);
        region.meet(simd, place, reach * reach, !self.active(i));
        let mut columns = [[same::<S, E>(simd, 0.0); 4]; MORE];
        for first in (0..region.count()).step_by(Lanes::<S, E>::LEN) {
            for (part, column) in columns[..Q].iter_mut().enumerate() {
                *column = region.quad::<S, R>(simd, part, first);
            }
            let other = Member::new::<R>(simd, columns, &flux);
            let pair = Separation::new(simd, &row, &columns, grid);
            let (force, heat) = flux.between::<S, E, R>(simd, &own, &other, &pair);
            sums.add(simd, &own, &other, force, heat);
        }
    }
}
