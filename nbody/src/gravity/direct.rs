//! The pull of lists of sources on one group of targets.
//!
//! Coordinates are taken relative to the group's centre in units of its size before they are rounded to the element type.
//! Pairs so close that rounding would be felt are left out by the kernel and summed here in f64 from the positions themselves.

use std::ops::Range;

use fearless_simd::Simd;

use crate::points::Vec3;

use super::kernel::quadrupole::{BATCH, QUADRUPOLES, Quadrupoles, pull_of_quadrupoles};
use super::kernel::{Block, POINTS, Points, Pull, Targets, each_near, pull_of_points};
use super::lanes::{Job, Lanes, Real};
use super::moments::Moment;
use super::sources::Sources;
use super::walk::Lists;

/// A target: position, square of its softening length, its number among the sources or `NO_SOURCE`.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    pub x: Vec3,
    pub eps2: f64,
    pub source: u32,
}

pub const NO_SOURCE: u32 = u32::MAX;

/// Coordinates of a group.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub centre: Vec3,
    /// one over the unit of length
    pub scale: f64,
    /// pairs nearer than this many units are summed in f64
    pub closest: f64,
}

/// Buffers of one thread.
pub struct Blocks<E> {
    points: Points<E>,
    /// which source each entry of `points` is
    index: Vec<u32>,
    quadrupoles: Quadrupoles<E>,
    targets: Targets<E>,
    hits: Vec<u32>,
}

impl<E: Real> Default for Blocks<E> {
    fn default() -> Self {
        Self {
            points: Block::with_capacity(POINTS),
            index: vec![0; POINTS],
            quadrupoles: Quadrupoles::default(),
            targets: Block::with_capacity(super::GROUP),
            hits: vec![0; super::GROUP],
        }
    }
}

/// The pull of everything in `lists` and of the sources `home` on `targets`.
pub struct Group<'a, E> {
    pub frame: Frame,
    pub targets: &'a [Target],
    pub home: Range<usize>,
    pub lists: &'a Lists,
    pub sources: &'a Sources,
    pub moments: &'a [Moment],
    pub potential: bool,
    pub blocks: &'a mut Blocks<E>,
    pub pulls: &'a mut [Pull],
}

impl<E: Real> Job<E> for Group<'_, E> {
    #[inline(always)]
    fn run<S: Simd, R: Lanes<S, E>>(self, simd: S) {
        if self.potential {
            self.sum::<S, R, true>(simd);
        } else {
            self.sum::<S, R, false>(simd);
        }
    }
}

impl<E: Real> Group<'_, E> {
    #[inline(always)]
    fn sum<S: Simd, R: Lanes<S, E>, const POTENTIAL: bool>(mut self, simd: S) {
        self.take_targets();
        let own = self.home.start as u32..self.home.end as u32;
        self.append(own);
        self.near::<S, R, POTENTIAL>(simd, true);
        for &(first, end) in &self.lists.near {
            let mut rest = first..end;
            while !rest.is_empty() {
                rest = self.append(rest);
                if self.blocks.points.len == POINTS {
                    self.near::<S, R, POTENTIAL>(simd, false);
                }
            }
        }
        self.near::<S, R, POTENTIAL>(simd, false);
        for &(first, end) in &self.lists.far {
            let mut rest = first..end;
            while !rest.is_empty() {
                rest = self.append(rest);
                if self.blocks.points.len == POINTS {
                    self.far::<S, R, POTENTIAL>(simd);
                }
            }
        }
        self.far::<S, R, POTENTIAL>(simd);
        for nodes in self.lists.nodes.chunks(QUADRUPOLES) {
            self.take_nodes(nodes);
            let blocks = &mut *self.blocks;
            pull_of_quadrupoles::<S, E, R, POTENTIAL>(
                simd,
                &blocks.targets,
                &blocks.quadrupoles,
                self.pulls,
            );
        }
    }

    #[inline(always)]
    fn take_targets(&mut self) {
        let Frame { centre, scale, .. } = self.frame;
        let block = &mut self.blocks.targets;
        block.len = self.targets.len();
        for (i, target) in self.targets.iter().enumerate() {
            let d = (target.x - centre) * scale;
            let row = [d.x, d.y, d.z, target.eps2 * scale * scale];
            for (column, value) in block.columns.iter_mut().zip(row) {
                column[i] = E::from_f64(value);
            }
        }
        block.pad();
    }

    /// Appends sources to the block of points until it is full; returns what is left over.
    #[inline(always)]
    fn append(&mut self, range: Range<u32>) -> Range<u32> {
        let Frame { centre, scale, .. } = self.frame;
        let block = &mut self.blocks.points;
        let count = (range.len()).min(POINTS - block.len);
        let (from, to) = (range.start as usize, block.len);
        let s = self.sources;
        let rows = from..from + count;
        let columns = [&s.x, &s.y, &s.z, &s.m].map(|column| &column[rows.clone()]);
        let origin = [centre.x, centre.y, centre.z, 0.0];
        let units = [scale, scale, scale, 1.0];
        for (c, at) in [0, 1, 2, 4].into_iter().enumerate() {
            let into = &mut block.columns[at][to..to + count];
            for (into, value) in into.iter_mut().zip(columns[c]) {
                *into = E::from_f64((value - origin[c]) * units[c]);
            }
        }
        let into = &mut block.columns[3][to..to + count];
        match s.own_eps2(rows) {
            Some(own) => {
                for (into, eps2) in into.iter_mut().zip(own) {
                    *into = E::from_f64(eps2 * (scale * scale));
                }
            }
            None => into.fill(E::from_f64(s.eps2(from) * (scale * scale))),
        }
        for (k, index) in self.blocks.index[to..to + count].iter_mut().enumerate() {
            *index = (from + k) as u32;
        }
        block.len += count;
        range.start + count as u32..range.end
    }

    #[inline(always)]
    fn take_nodes(&mut self, nodes: &[u32]) {
        let Frame { centre, scale, .. } = self.frame;
        let square = scale * scale;
        let batches = &mut self.blocks.quadrupoles.batches;
        batches.clear();
        for nodes in nodes.chunks(BATCH) {
            let mut batch = Quadrupoles::empty_batch();
            for (i, &node) in nodes.iter().enumerate() {
                let moment = &self.moments[node as usize];
                let d = (moment.centre - centre) * scale;
                let [xx, yy, zz, xy, xz, yz] = moment.second.map(|s| -3.0 * s * square);
                let trace = 0.5 * (xx + yy + zz);
                let eps2 = moment.eps2 * square;
                let row = [d.x, d.y, d.z, eps2, moment.m, xx, yy, zz, xy, xz, yz, trace];
                for (column, value) in batch.iter_mut().zip(row) {
                    column[i] = E::from_f64(value);
                }
            }
            batches.push(batch);
        }
    }

    #[inline(always)]
    fn far<S: Simd, R: Lanes<S, E>, const POTENTIAL: bool>(&mut self, simd: S) {
        let blocks = &mut *self.blocks;
        blocks.points.pad();
        pull_of_points::<S, E, R, POTENTIAL, false>(
            simd,
            &blocks.targets,
            &blocks.points,
            E::from_f64(0.0),
            self.pulls,
            &mut blocks.hits,
        );
        blocks.points.len = 0;
    }

    /// Pulls with the sources that may be close to a target; `home` if the targets themselves are among them.
    #[inline(always)]
    fn near<S: Simd, R: Lanes<S, E>, const POTENTIAL: bool>(&mut self, simd: S, home: bool) {
        let blocks = &mut *self.blocks;
        blocks.points.pad();
        let closest = E::from_f64(self.frame.closest * self.frame.closest);
        pull_of_points::<S, E, R, POTENTIAL, true>(
            simd,
            &blocks.targets,
            &blocks.points,
            closest,
            self.pulls,
            &mut blocks.hits,
        );
        for (k, target) in self.targets.iter().enumerate() {
            let own = blocks.targets.columns[3][k].to_f64();
            let itself = home && target.source != NO_SOURCE;
            let left_out = E::from_f64(2.0 * own) <= closest;
            if itself && !left_out && POTENTIAL {
                self.pulls[k].phi += self.sources.m[target.source as usize] / (2.0 * own).sqrt();
            }
            if blocks.hits[k] > u32::from(itself && left_out) {
                let pull = &mut self.pulls[k];
                let (sources, index) = (self.sources, &blocks.index);
                let scale = self.frame.scale;
                each_near(simd, &blocks.targets, k, &blocks.points, closest, |i| {
                    add_exactly(pull, target, sources, index[i], scale);
                });
            }
        }
        blocks.points.len = 0;
    }
}

/// Adds the pull of source `j` on `target`, unless they are the same particle or at the same place without softening.
fn add_exactly(pull: &mut Pull, target: &Target, sources: &Sources, j: u32, scale: f64) {
    let source = j as usize;
    let d = (sources.position(source) - target.x) * scale;
    let q2 = d.norm_squared() + (target.eps2 + sources.eps2(source)) * scale * scale;
    if j != target.source && q2 > 0.0 {
        let y = 1.0 / q2.sqrt();
        let w = sources.m[source] * y * y * y;
        for axis in 0..3 {
            pull.a[axis] += w * d[axis];
        }
        pull.phi -= sources.m[source] * y;
    }
}
