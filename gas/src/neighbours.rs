//! Neighbours: all particles packed leaf by leaf, the region about a leaf gathered once, and the list of those near one target.
//!
//! Lengths are in units of the sweep, coordinates relative to the middle of a leaf, periodic images moved next to it, zero along missing
//! axes. What a sweep needs of a particle stands in a row of quads, so that a neighbour is one or two lines of memory. Distances in
//! the region are rounded: a list holds all neighbours and a few that lie a hair farther.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use nbody::points::sum::Parts;
use nbody::points::{Domain, Tree, Vec3};
use rayon::prelude::*;

use crate::lanes::{Lanes, MOST, Machine, Quad, Real, load, same};
use crate::units::Units;

/// Where the particles of a sweep are.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    pub tree: &'a Tree,
    pub domain: &'a Domain,
    pub x: &'a [Vec3],
    pub units: Units,
}

impl Frame<'_> {
    /// The middle of a leaf, on the grid.
    pub fn centre(&self, leaf: usize) -> Vec3 {
        let step = self.units.step;
        let steps = self.tree.nodes[leaf].centre().component_div(&step);
        steps.map(f64::round).component_mul(&step)
    }

    /// Calls `visit(node, shift)` for leaves whose box, moved by a shift of the domain, comes within max(`reach`, `extent[leaf]`) of the
    /// box [lo, hi], as [`Tree::near`] does.
    fn near(&self, (lo, hi): Span, reach: f64, extent: &[f64], mut visit: impl FnMut(u32, Vec3)) {
        let nodes = &self.tree.nodes;
        let root = &nodes[0];
        let far = reach.max(extent.first().copied().unwrap_or(0.0));
        let margin = Vec3::repeat(far);
        (self.domain).shifts(lo - margin, hi + margin, root.lo, root.hi, |shift| {
            let (lo, hi) = (lo - shift, hi - shift);
            let mut i = 0;
            while i < nodes.len() {
                let node = &nodes[i];
                let own = extent.get(i).copied().unwrap_or(0.0);
                let reach = reach.max(own);
                let gap = (node.lo - hi).sup(&(lo - node.hi)).sup(&Vec3::zeros());
                if own < 0.0 || gap.norm_squared() > reach * reach {
                    i = node.skip as usize;
                } else {
                    i += 1;
                    if node.skip as usize == i {
                        visit(i as u32 - 1, shift);
                    }
                }
            }
        });
    }
}

/// A box: its least and its largest coordinates.
pub type Span = (Vec3, Vec3);

/// All particles as the sweeps see them.
#[derive(Clone, Debug, Default)]
pub struct Packed<E> {
    /// Coordinates from the middle of the particle's leaf.
    x: [Vec<E>; 3],
    /// The particle's own reach, negative if it is not active.
    reach: Vec<E>,
    /// Rows of `stride` quads.
    quads: Vec<Quad<E>>,
    stride: usize,
}

impl<E: Real> Packed<E> {
    /// Packs all particles: `source(i, d)` is the reach and the row of particle i, which stands at d from the middle of its leaf.
    pub fn fill<const Q: usize>(
        &mut self,
        frame: &Frame,
        source: impl Fn(usize, Vec3) -> (f64, [Quad<E>; Q]) + Sync,
    ) {
        let n = frame.x.len();
        self.stride = Q;
        for column in self.x.iter_mut().chain([&mut self.reach]) {
            column.resize(n + MOST, E::default());
        }
        self.quads.resize(n * Q, Quad::default());
        let x = self.x.each_mut().map(|x| Parts::new(x));
        let (reaches, quads) = (Parts::new(&mut self.reach), Parts::new(&mut self.quads));
        let by_length = 1.0 / frame.units.length;
        frame.tree.leaves.par_iter().for_each(|&leaf| {
            let centre = frame.centre(leaf as usize);
            let range = frame.tree.nodes[leaf as usize].range();
            // SAFETY: a leaf's task alone touches the leaf's particles.
            let (mut x, reaches, quads) = unsafe {
                (
                    x.each_ref().map(|x| x.part(range.clone())),
                    reaches.part(range.clone()),
                    quads.part(range.start * Q..range.end * Q),
                )
            };
            let rows = quads.as_chunks_mut::<Q>().0;
            for (k, (row, i)) in rows.iter_mut().zip(range).enumerate() {
                let d = frame.domain.in_plane(frame.x[i] - centre);
                let (reach, quads) = source(i, d);
                *row = quads;
                reaches[k] = E::from_f64(reach);
                for (x, d) in x.iter_mut().zip(&d) {
                    x[k] = E::from_f64(d * by_length);
                }
            }
        });
    }

    /// Coordinates of particle i from the middle of its leaf.
    pub fn place(&self, i: usize) -> [E; 3] {
        self.x.each_ref().map(|x| x[i])
    }

    /// The row of particle i.
    pub fn row<const Q: usize>(&self, i: usize) -> [Quad<E>; Q] {
        std::array::from_fn(|q| self.quads[i * Q + q])
    }
}

/// A search about some targets of a leaf.
pub struct Search<'a, E> {
    pub frame: &'a Frame<'a>,
    pub packed: &'a Packed<E>,
    pub leaf: usize,
    /// Box around the targets, relative to the middle of the leaf.
    pub span: [[E; 3]; 2],
    /// Reach of the targets.
    pub reach: f64,
    /// Reach of the nodes of the tree, code units, as [`Tree::near`] wants it; if empty, the particles' own reach does not count.
    pub extent: &'a [f64],
    /// Whether only active particles count.
    pub active: bool,
}

/// A leaf that is near, and the end of its candidates.
#[derive(Clone, Copy, Debug)]
struct Run {
    node: u32,
    shift: Vec3,
    end: u32,
}

/// The particles that may be neighbours of some targets, and those that are neighbours of one.
#[derive(Debug, Default)]
pub struct Region<E> {
    runs: Vec<Run>,
    /// Numbers of the candidates among all particles, as bits.
    index: Vec<E>,
    x: [Vec<E>; 3],
    /// Square of the candidate's own reach, with a margin; negative if it is not active.
    limit: Vec<E>,
    len: usize,
    quads: Vec<Quad<E>>,
    stride: usize,
    numbers: Vec<E>,
    r2: Vec<E>,
    count: usize,
}

/// What separations count that are no neighbours: beyond any kernel.
const FAR: f64 = 1e30;

impl<E: Real> Region<E> {
    /// The margin for rounding at distances of `far`.
    fn margin(far: f64) -> f64 {
        8.0 * E::EPSILON * far
    }

    /// Gathers all particles within max(reach, own reach) of the box; returns the largest of these.
    #[inline(always)]
    pub fn gather<S: Simd>(&mut self, simd: S, search: &Search<'_, E>) -> f64 {
        let Search { frame, leaf, .. } = *search;
        let unit = frame.units.length;
        let origin = frame.centre(leaf);
        let absolute = |side: usize| {
            Vec3::from_fn(|a, _| origin[a] + unit * search.span[side][a].to_f64())
        };
        let (reach, mut visited) = (unit * search.reach, 0);
        self.runs.clear();
        let runs = &mut self.runs;
        let slack = Vec3::repeat(Self::margin(unit));
        let span = (absolute(0) - slack, absolute(1) + slack);
        frame.near(span, reach, search.extent, |node, shift| {
            visited += frame.tree.nodes[node as usize].count();
            runs.push(Run {
                node,
                shift,
                end: 0,
            });
        });
        let room = visited + MOST;
        let columns = self.x.iter_mut().chain([&mut self.index, &mut self.limit]);
        for column in columns {
            if column.len() < room {
                column.resize(room, E::default());
            }
        }
        self.len = 0;
        self.count = 0;
        let mut far = same::<S, E>(simd, 0.0);
        for run in 0..self.runs.len() {
            far = self.sift(simd, search, origin, run, far);
        }
        far.as_slice().iter().fold(0.0, |far, x| far.max(x.to_f64()))
    }

    /// Picks the candidates of a run.
    #[inline(always)]
    fn sift<S: Simd>(
        &mut self,
        simd: S,
        search: &Search<'_, E>,
        origin: Vec3,
        run: usize,
        mut farthest: Lanes<S, E>,
    ) -> Lanes<S, E> {
        let Search { frame, packed, .. } = *search;
        let Run { node, shift, .. } = self.runs[run];
        let range = frame.tree.nodes[node as usize].range();
        let offset = (frame.domain).in_plane(frame.centre(node as usize) + shift - origin)
            / frame.units.length;
        let lo = splat(simd, search.span[0]);
        let hi = splat(simd, search.span[1]);
        let reach = same::<S, E>(simd, search.reach);
        let zero = same::<S, E>(simd, 0.0);
        let widest = (0..3).fold(0.0, |w: f64, a| {
            w.max((search.span[1][a].to_f64() - search.span[0][a].to_f64()).abs())
        });
        let margin = same::<S, E>(simd, Self::margin(widest));
        let stretch = same::<S, E>(simd, 1.0 + Self::margin(1.0));
        let own = !search.extent.is_empty();
        let mut at = self.len;
        let mut first = range.start;
        while first < range.end {
            let (mut x, mut gap2) = ([zero; 3], zero);
            for a in 0..3 {
                x[a] = load(simd, &packed.x[a], first) + same::<S, E>(simd, offset[a]);
                let gap = (lo[a] - x[a]).max(x[a] - hi[a]).max(zero);
                gap2 = gap.mul_add(gap, gap2);
            }
            let signed = if own {
                load(simd, &packed.reach, first)
            } else {
                zero
            };
            let limit = signed.abs().mul_add(stretch, margin);
            let far = reach.mul_add(stretch, margin).max(limit);
            let mut inside = gap2.simd_le(far * far);
            if search.active {
                inside &= signed.simd_gt(zero);
            }
            let left = (1u64 << (range.end - first).min(MOST)) - 1;
            let bits = inside.to_bitmask() & left;
            let inside = SimdMask::from_bitmask(simd, bits);
            farthest = farthest.max(Select::select(inside, far, zero));
            let index = E::numbers(simd, first, 1);
            store(index.compress(inside), &mut self.index, at);
            for (x, column) in x.into_iter().zip(&mut self.x) {
                store(x.compress(inside), column, at);
            }
            if own {
                let limit = (limit * limit).copysign(signed);
                store(limit.compress(inside), &mut self.limit, at);
            }
            at += bits.count_ones() as usize;
            first += Lanes::<S, E>::LEN;
        }
        self.len = at;
        self.runs[run].end = at as u32;
        farthest
    }

    /// Fetches the rows of the candidates, the first three values of each being their coordinates; `nobody` fills up lists.
    #[inline(always)]
    pub fn fetch<const Q: usize>(&mut self, packed: &Packed<E>, nobody: [Quad<E>; Q]) {
        assert!(packed.stride == Q);
        self.room::<Q>();
        let rows = self.quads.as_chunks_mut::<Q>().0;
        for (k, row) in rows.iter_mut().enumerate().take(self.len) {
            *row = packed.row(self.index[k].index());
            for (value, x) in row[0].0.iter_mut().zip(&self.x) {
                *value = x[k];
            }
        }
        rows[self.len] = nobody;
    }

    /// As [`Region::fetch`], but with the coordinates on the grid; returns how many times the grid is doubled for what is as far as `far`.
    #[inline(always)]
    pub fn fetch_on_grid<const Q: usize>(
        &mut self,
        search: &Search<'_, E>,
        far: f64,
        nobody: [Quad<E>; Q],
    ) -> i32 {
        let Search { frame, packed, .. } = *search;
        assert!(packed.stride == Q);
        let origin = frame.centre(search.leaf);
        let step = frame.units.step;
        let widest = search.span.iter().flatten();
        let widest = widest.fold(far, |w, x| w.max(far + x.to_f64().abs()));
        let room = E::STEPS * step.min() / frame.units.length;
        let coarser = (widest / room).log2().ceil().max(0.0) as i32;
        self.room::<Q>();
        let rows = self.quads.as_chunks_mut::<Q>().0;
        let mut start = 0;
        for run in &self.runs {
            let moved = frame.centre(run.node as usize) + run.shift - origin;
            let offset = frame.domain.in_plane(moved).component_div(&step);
            let offset = if E::STEPS.is_finite() {
                offset.map(f64::round)
            } else {
                offset
            };
            for k in start..run.end as usize {
                let mut row: [Quad<E>; Q] = packed.row(self.index[k].index());
                for (value, &offset) in row[0].0.iter_mut().zip(&offset) {
                    *value = E::moved(*value, offset, coarser);
                }
                rows[k] = row;
            }
            start = run.end as usize;
        }
        rows[self.len] = nobody;
        coarser
    }

    fn room<const Q: usize>(&mut self) {
        self.stride = Q;
        let room = (self.len + 1) * Q;
        if self.quads.len() < room {
            self.quads.resize(room, Quad::default());
        }
    }

    /// Lists the candidates at r^2 < `limit` from `place`, or within their own reach; where `active`, only those that are.
    #[inline(always)]
    pub fn list<S: Simd, const OWN: bool>(
        &mut self,
        simd: S,
        place: [E; 3],
        limit: f64,
        active: bool,
    ) {
        let lanes = Lanes::<S, E>::LEN;
        let room = self.len + 2 * MOST;
        if self.numbers.len() < room {
            self.numbers.resize(room, E::default());
            self.r2.resize(room, E::default());
        }
        let place = splat(simd, place);
        let limit = same::<S, E>(simd, limit * (1.0 + Self::margin(1.0)));
        let end = self.len;
        let x = self.x.each_ref().map(|x| &x[..end.next_multiple_of(lanes)]);
        let own = &self.limit[..if OWN { end.next_multiple_of(lanes) } else { 0 }];
        let mut count = 0;
        let mut first = 0;
        while first < end {
            let d = [
                load(simd, x[0], first) - place[0],
                load(simd, x[1], first) - place[1],
                load(simd, x[2], first) - place[2],
            ];
            let r2 = d[2].mul_add(d[2], d[1].mul_add(d[1], d[0] * d[0]));
            let mut inside = r2.simd_lt(if OWN {
                load(simd, own, first).abs().max(limit)
            } else {
                limit
            });
            if OWN && active {
                inside &= load(simd, own, first).simd_gt(same::<S, E>(simd, 0.0));
            }
            let bits = inside.to_bitmask();
            let numbers = E::numbers(simd, first * self.stride, self.stride);
            store(numbers.compress(inside), &mut self.numbers, count);
            store(r2.compress(inside), &mut self.r2, count);
            count += bits.count_ones() as usize;
            first += lanes;
        }
        // What stands behind the last candidate is near nobody.
        while count > 0 && self.numbers[count - 1].index() >= end * self.stride {
            count -= 1;
        }
        self.count = count;
        let nobody = Lanes::<S, E>::splat(simd, E::number(end * self.stride));
        store(nobody, &mut self.numbers, count);
        store(same::<S, E>(simd, FAR), &mut self.r2, count);
    }

    /// Number of neighbours listed.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Squares of the neighbours' distances, filled up to whole lanes.
    #[inline(always)]
    pub fn r2<S: Simd>(&mut self, _simd: S) -> &mut [E] {
        &mut self.r2[..self.count.next_multiple_of(Lanes::<S, E>::LEN)]
    }

    /// One quad of the rows of the neighbours from `first` on.
    #[inline(always)]
    pub fn quad<S: Simd, R: Machine<S, E>>(
        &self,
        simd: S,
        part: usize,
        first: usize,
    ) -> [Lanes<S, E>; 4] {
        let numbers = &self.numbers[first..first + Lanes::<S, E>::LEN];
        assert!(part < self.stride && first < self.count);
        // SAFETY: a list holds numbers of rows of the region, of `stride` quads each, and is filled up by the row behind the last.
        unsafe { R::quad(simd, &self.quads, part, numbers) }
    }
}

/// Each coordinate in all lanes.
#[inline(always)]
fn splat<S: Simd, E: Real>(simd: S, [x, y, z]: [E; 3]) -> [Lanes<S, E>; 3] {
    [
        Lanes::<S, E>::splat(simd, x),
        Lanes::<S, E>::splat(simd, y),
        Lanes::<S, E>::splat(simd, z),
    ]
}

/// Writes lanes to a column from `k` on.
#[inline(always)]
fn store<S: Simd, V: SimdBase<S>>(value: V, column: &mut [V::Element], k: usize) {
    value.store_slice(&mut column[k..k + V::LEN]);
}
