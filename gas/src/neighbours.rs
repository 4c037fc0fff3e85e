//! Neighbours: the region about a leaf, gathered once from all particles as they are packed, and the list of those near one target.
//!
//! Lengths are in units of the sweep, coordinates relative to the middle of a leaf, periodic images moved next to it, zero along missing
//! axes. What a sweep needs of a particle stands in a row of quads, so that a neighbour is one or two lines of memory. Distances in
//! the region are rounded: a list holds all neighbours and a few that lie a hair farther.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};
use nbody::points::Vec3;

use crate::lanes::{Lanes, MOST, Machine, Quad, Real, load, same};

mod packed;

pub use packed::{Frame, Packed, branches};
use packed::{coarser, gap2, larger};

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

/// Leaves near a branch of the tree, each with the shift that brings it there.
#[derive(Debug, Default)]
pub struct Around {
    leaves: Vec<(u32, Vec3)>,
}

impl Around {
    /// Finds the leaves within max(`reach`, own reach) of a branch; all in code units.
    pub fn find(&mut self, frame: &Frame, branch: usize, reach: f64, extent: &[f64]) {
        self.leaves.clear();
        let node = &frame.tree.nodes[branch];
        let leaves = &mut self.leaves;
        // A hair more, for what rounding moves.
        let slack = frame.domain.widened(1e-6 * frame.units.length);
        frame.near(
            (node.lo - slack, node.hi + slack),
            reach,
            extent,
            |leaf, shift| leaves.push((leaf, shift)),
        );
    }

    pub fn is_empty(&self) -> bool {
        self.leaves.is_empty()
    }

    /// Numbers of these leaves' nodes.
    pub fn nodes(&self) -> impl Iterator<Item = usize> {
        self.leaves.iter().map(|&(leaf, _)| leaf as usize)
    }
}

/// A leaf that is near, and the end of its candidates.
#[derive(Clone, Copy, Debug)]
struct Run {
    node: u32,
    /// Offset of its middle.
    offset: Vec3,
    end: u32,
}

/// Candidates, filled up to whole lanes with what may be anything.
#[derive(Debug, Default)]
struct Candidates<E> {
    /// Numbers of their rows, as bits.
    number: Vec<E>,
    x: [Vec<E>; 3],
    /// Square of the candidate's own reach, with a margin; negative if it is not active.
    limit: Vec<E>,
    len: usize,
}

impl<E: Real> Candidates<E> {
    /// Makes room for `len` candidates.
    #[inline(always)]
    fn room(&mut self, len: usize) {
        let room = len + 2 * MOST;
        if self.number.len() < room {
            self.number.resize(room, E::default());
            self.limit.resize(room, E::default());
            for x in &mut self.x {
                x.resize(room, E::default());
            }
        }
    }
}

/// The particles that may be neighbours of some targets, and those that are neighbours of one.
#[derive(Debug, Default)]
pub struct Region<E> {
    pub around: Around,
    runs: Vec<Run>,
    /// Of a leaf.
    wide: Candidates<E>,
    /// Of a few of its targets.
    close: Candidates<E>,
    quads: Vec<Quad<E>>,
    stride: usize,
    numbers: Vec<E>,
    /// Separations and distances of those listed.
    d: [Vec<E>; 4],
    count: usize,
}

impl<E: Real> Region<E> {
    /// The margin for rounding at distances of `far`.
    fn margin(far: f64) -> f64 {
        8.0 * E::EPSILON * far
    }

    /// Gathers all particles of the leaves around within max(reach, own reach) of the box; returns the largest of these.
    #[inline(always)]
    pub fn gather<S: Simd>(&mut self, simd: S, search: &Search<'_, E>) -> f64 {
        let Search { frame, leaf, .. } = *search;
        let unit = frame.units.length;
        let origin = search.packed.middle(leaf).x;
        let slack = frame.domain.widened(Self::margin(unit));
        let (mut lo, mut hi) = (origin, origin);
        for a in 0..3 {
            lo[a] += unit * search.span[0][a].to_f64() - slack[a];
            hi[a] += unit * search.span[1][a].to_f64() + slack[a];
        }
        let (reach, mut visited) = (unit * search.reach, 0);
        self.runs.clear();
        for &(leaf, shift) in &self.around.leaves {
            let node = &frame.tree.nodes[leaf as usize];
            let own = search.extent.get(leaf as usize).copied().unwrap_or(0.0);
            let far = larger(reach, own);
            if own >= 0.0 && gap2(node, lo - shift, hi - shift) <= far * far {
                visited += node.count();
                self.runs.push(Run {
                    node: leaf,
                    offset: search.packed.middle(leaf as usize).x + shift - origin,
                    end: 0,
                });
            }
        }
        self.wide.room(visited);
        self.wide.len = 0;
        self.close.len = 0;
        self.count = 0;
        let mut far = same::<S, E>(simd, 0.0);
        for run in 0..self.runs.len() {
            far = self.sift(simd, search, run, far);
        }
        far.as_slice()
            .iter()
            .fold(0.0, |far, x| far.max(x.to_f64()))
    }

    /// Picks the candidates of a run.
    #[inline(always)]
    fn sift<S: Simd>(
        &mut self,
        simd: S,
        search: &Search<'_, E>,
        run: usize,
        mut farthest: Lanes<S, E>,
    ) -> Lanes<S, E> {
        let Search { frame, packed, .. } = *search;
        let Run { node, offset, .. } = self.runs[run];
        let range = frame.tree.nodes[node as usize].range();
        let offset = offset / frame.units.length;
        let lo = splat(simd, search.span[0]);
        let hi = splat(simd, search.span[1]);
        let reach = same::<S, E>(simd, search.reach);
        let zero = same::<S, E>(simd, 0.0);
        let mut widest: f64 = 0.0;
        for a in 0..3 {
            widest = widest.max(search.span[1][a].to_f64() - search.span[0][a].to_f64());
        }
        let margin = same::<S, E>(simd, Self::margin(widest));
        let stretch = same::<S, E>(simd, 1.0 + Self::margin(1.0));
        let own = !search.extent.is_empty();
        let wide = &mut self.wide;
        let mut at = wide.len;
        let mut first = range.start;
        let mut numbers = E::numbers(simd, first * packed.stride, packed.stride);
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
            store(numbers.compress(inside), &mut wide.number, at);
            store(x[0].compress(inside), &mut wide.x[0], at);
            store(x[1].compress(inside), &mut wide.x[1], at);
            store(x[2].compress(inside), &mut wide.x[2], at);
            numbers = E::further::<S>(numbers, packed.stride * Lanes::<S, E>::LEN);
            if own {
                let limit = (limit * limit).copysign(signed);
                store(limit.compress(inside), &mut wide.limit, at);
            }
            at += bits.count_ones() as usize;
            first += Lanes::<S, E>::LEN;
        }
        wide.len = at;
        self.runs[run].end = at as u32;
        farthest
    }

    /// Picks from all candidates those within max(`reach`, own reach) of a smaller box. Their numbers are those of their rows among all
    /// particles, or, if `fetched`, in the region.
    #[inline(always)]
    pub fn focus<S: Simd>(&mut self, simd: S, span: [[E; 3]; 2], reach: f64, fetched: bool) {
        let Self { wide, close, .. } = self;
        close.room(wide.len);
        self.count = 0;
        let (lo, hi) = (splat(simd, span[0]), splat(simd, span[1]));
        let mut widest: f64 = 0.0;
        for x in span[0].iter().chain(&span[1]) {
            widest = widest.max(x.to_f64().abs());
        }
        let far = reach * (1.0 + Self::margin(1.0)) + Self::margin(widest);
        let far = same::<S, E>(simd, far * far);
        let zero = same::<S, E>(simd, 0.0);
        let lanes = Lanes::<S, E>::LEN;
        let end = wide.len.next_multiple_of(lanes);
        let [x, y, z] = &wide.x;
        let (x, y, z) = (&x[..end], &y[..end], &z[..end]);
        let (number, limit) = (&wide.number[..end], &wide.limit[..end]);
        let mut numbers = E::numbers(simd, 0, self.stride);
        let (mut first, mut at) = (0, 0);
        while first < end {
            let x = [
                load(simd, x, first),
                load(simd, y, first),
                load(simd, z, first),
            ];
            let mut gap2 = zero;
            for a in 0..3 {
                let gap = (lo[a] - x[a]).max(x[a] - hi[a]).max(zero);
                gap2 = gap.mul_add(gap, gap2);
            }
            let limit = load(simd, limit, first);
            let far = if fetched { far.max(limit.abs()) } else { far };
            let mut inside = gap2.simd_le(far);
            if first + lanes > wide.len {
                let left = (1 << (wide.len - first)) - 1;
                inside = SimdMask::from_bitmask(simd, inside.to_bitmask() & left);
            }
            store(x[0].compress(inside), &mut close.x[0], at);
            store(x[1].compress(inside), &mut close.x[1], at);
            store(x[2].compress(inside), &mut close.x[2], at);
            if fetched {
                store(numbers.compress(inside), &mut close.number, at);
                store(limit.compress(inside), &mut close.limit, at);
                numbers = E::further::<S>(numbers, self.stride * lanes);
            } else {
                let number = load(simd, number, first);
                store(number.compress(inside), &mut close.number, at);
            }
            at += inside.to_bitmask().count_ones() as usize;
            first += lanes;
        }
        close.len = at;
        // What fills up the last lanes is near nobody.
        for x in &mut close.x {
            store(same::<S, E>(simd, FAR), x, at);
        }
        store(zero, &mut close.limit, at);
    }

    /// Fetches the rows of the candidates, whose first quad begins with coordinates on the grid; `nobody` fills up lists. Returns how many
    /// times the grid is doubled for what is as far as `far`.
    #[inline(always)]
    pub fn fetch<const Q: usize>(
        &mut self,
        search: &Search<'_, E>,
        far: f64,
        nobody: [Quad<E>; Q],
    ) -> i32 {
        let Search { frame, packed, .. } = *search;
        assert!(packed.stride == Q);
        let step = frame.units.step;
        let mut widest = far;
        for x in search.span[0].iter().chain(&search.span[1]) {
            widest = widest.max(far + x.to_f64().abs());
        }
        let to = coarser::<E>(&frame.units, widest);
        self.stride = Q;
        let len = self.wide.len;
        let room = (len + 1) * Q;
        if self.quads.len() < room {
            self.quads.resize(room, Quad::default());
        }
        let rows = self.quads.as_chunks_mut::<Q>().0;
        let mut start = 0;
        for run in &self.runs {
            let end = run.end as usize;
            let from = packed.middle(run.node as usize).coarser;
            let offset = E::offset([
                run.offset.x / step.x,
                run.offset.y / step.y,
                run.offset.z / step.z,
            ]);
            for (row, index) in rows[start..end]
                .iter_mut()
                .zip(&self.wide.number[start..end])
            {
                let first = index.index();
                row.copy_from_slice(&packed.quads[first..first + Q]);
                row[0] = E::moved(row[0], offset, from, to);
            }
            start = end;
        }
        rows[len] = nobody;
        to
    }

    /// Makes room for lists of all candidates.
    #[inline(always)]
    fn room(&mut self) {
        let room = self.close.len + 2 * MOST;
        if self.numbers.len() < room {
            self.numbers.resize(room, E::default());
            for d in &mut self.d {
                d.resize(room, E::default());
            }
        }
    }

    /// Lists the candidates within `radius` of `place`: their numbers among all particles, separations and distances.
    #[inline(always)]
    pub fn near<S: Simd, R: Machine<S, E>>(&mut self, simd: S, place: [E; 3], radius: f64) {
        self.room();
        let place = splat(simd, place);
        let limit = same::<S, E>(simd, radius * radius * (1.0 + Self::margin(1.0)));
        let lanes = Lanes::<S, E>::LEN;
        let (mut first, mut count) = (0, 0);
        let end = self.close.len.next_multiple_of(lanes);
        let [x, y, z] = &self.close.x;
        let (x, y, z, number) = (&x[..end], &y[..end], &z[..end], &self.close.number[..end]);
        let [d_x, d_y, d_z, _] = &mut self.d;
        let numbers = &mut self.numbers;
        while first < end {
            let d = [
                load(simd, x, first) - place[0],
                load(simd, y, first) - place[1],
                load(simd, z, first) - place[2],
            ];
            let r2 = d[2].mul_add(d[2], d[1].mul_add(d[1], d[0] * d[0]));
            let inside = r2.simd_lt(limit);
            store(load(simd, number, first).compress(inside), numbers, count);
            store(d[0].compress(inside), d_x, count);
            store(d[1].compress(inside), d_y, count);
            store(d[2].compress(inside), d_z, count);
            count += inside.to_bitmask().count_ones() as usize;
            first += lanes;
        }
        self.count = count;
        // Filled up by the last one, at a distance beyond any kernel.
        if count > 0 {
            let last = Lanes::<S, E>::splat(simd, self.numbers[count - 1]);
            store(last, &mut self.numbers, count);
        }
        for d in &mut self.d {
            store(same::<S, E>(simd, FAR), d, count);
        }
        let tiny = same::<S, E>(simd, E::TINY);
        for first in (0..count).step_by(lanes) {
            let [x, y, z] = self.separations(simd, first);
            let r2 = z.mul_add(z, y.mul_add(y, x * x));
            let r = r2 * R::inverse_root(simd, r2.max(tiny));
            store(r, &mut self.d[3], first);
        }
    }

    /// Lists the candidates at r^2 < `limit` from `place`, or within their own reach; where `active`, only those that are.
    #[inline(always)]
    pub fn meet<S: Simd>(&mut self, simd: S, place: [E; 3], limit: f64, active: bool) {
        self.room();
        let place = splat(simd, place);
        let limit = same::<S, E>(simd, limit * (1.0 + Self::margin(1.0)));
        let lanes = Lanes::<S, E>::LEN;
        let (mut first, mut count) = (0, 0);
        let end = self.close.len.next_multiple_of(lanes);
        let [x, y, z] = &self.close.x;
        let (x, y, z, own) = (&x[..end], &y[..end], &z[..end], &self.close.limit[..end]);
        let (number, list) = (&self.close.number[..end], &mut self.numbers);
        while first < end {
            let d = [
                load(simd, x, first) - place[0],
                load(simd, y, first) - place[1],
                load(simd, z, first) - place[2],
            ];
            let r2 = d[2].mul_add(d[2], d[1].mul_add(d[1], d[0] * d[0]));
            let own = load(simd, own, first);
            let mut inside = r2.simd_lt(own.abs().max(limit));
            if active {
                inside &= own.simd_gt(same::<S, E>(simd, 0.0));
            }
            store(load(simd, number, first).compress(inside), list, count);
            count += inside.to_bitmask().count_ones() as usize;
            first += lanes;
        }
        self.count = count;
        let nobody = E::number(self.wide.len * self.stride);
        store(Lanes::<S, E>::splat(simd, nobody), &mut self.numbers, count);
    }

    /// Number of neighbours listed.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Distances of those that [`Region::near`] listed, filled up to whole lanes.
    #[inline(always)]
    pub fn distances<S: Simd>(&self, _simd: S) -> &[E] {
        &self.d[3][..self.count.next_multiple_of(Lanes::<S, E>::LEN)]
    }

    /// Separations of those that [`Region::near`] listed, from `first` on.
    #[inline(always)]
    pub fn separations<S: Simd>(&self, simd: S, first: usize) -> [Lanes<S, E>; 3] {
        [
            load(simd, &self.d[0], first),
            load(simd, &self.d[1], first),
            load(simd, &self.d[2], first),
        ]
    }

    /// One quad of the rows of those that [`Region::near`] listed, from `first` on.
    #[inline(always)]
    pub fn quad_near<S: Simd, R: Machine<S, E>>(
        &self,
        simd: S,
        packed: &Packed<E>,
        part: usize,
        first: usize,
    ) -> [Lanes<S, E>; 4] {
        let numbers = &self.numbers[first..first + Lanes::<S, E>::LEN];
        assert!(part < packed.stride && first < self.count);
        // SAFETY: `near` lists numbers of rows of the packed particles, of `stride` quads each, and fills up with one of them.
        unsafe { R::quad(simd, &packed.quads, part, numbers) }
    }

    /// One quad of the rows of those that [`Region::meet`] listed, from `first` on.
    #[inline(always)]
    pub fn quad<S: Simd, R: Machine<S, E>>(
        &self,
        simd: S,
        part: usize,
        first: usize,
    ) -> [Lanes<S, E>; 4] {
        let numbers = &self.numbers[first..first + Lanes::<S, E>::LEN];
        assert!(part < self.stride && first < self.count);
        // SAFETY: `meet` lists numbers of rows of the region, of `stride` quads each, and fills up with the row behind the last.
        unsafe { R::quad(simd, &self.quads, part, numbers) }
    }
}

/// What separations count that are no neighbours: beyond any kernel.
const FAR: f64 = 1e15;

/// Targets of a leaf that share their candidates.
pub const FEW: usize = 9;

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
