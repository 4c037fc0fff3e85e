//! The walk: which nodes may pull on a group of targets by their moments, and which particles must do so one by one.
//!
//! A node is taken whole if its centre of mass is further than max(reach g, bound) from the box around the targets. `bound`
//! keeps targets outside of the node; reach^5 is the octupole's size that the expansion leaves out: the error of a node's
//! acceleration is about (m b^3) / d^5 with m b^2 the trace of the second moments.

use std::ops::Range;

use crate::points::{Node, Tree, Vec3};

use super::direct::Sources;
use super::moments::Moment;

/// Largest opening angle: distance in units of the distance from the centre of mass to the furthest corner of the box.
const WIDEST: f64 = 0.95;
/// A node of so few sources costs less as points than as a quadrupole.
const FEW: u32 = 2;

/// What the walk sees of a node.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    centre: Vec3,
    /// square of the distance that is enough for a unit error
    reach2: f64,
    /// square of the distance that must be kept in any case
    bound2: f64,
    first: u32,
    end: u32,
    skip: u32,
}

/// When a node is far enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Criterion {
    /// size of the node over distance
    Angle(f64),
    /// wanted error of one node's acceleration, in units of total mass over length squared
    Error(f64),
    /// as soon as no target can be inside
    Widest,
    /// never: all pairs
    Never,
}

impl Criterion {
    /// The square of a node's reach in units of what [`lenses`] holds.
    fn scale(self) -> f64 {
        match self {
            Self::Angle(angle) => angle.powi(-2),
            Self::Error(error) => error.powf(-0.4),
            Self::Widest => 0.0,
            Self::Never => f64::INFINITY,
        }
    }
}

/// Prepares the walk; `by_error` for [`Criterion::Error`], else for [`Criterion::Angle`].
pub fn lenses(tree: &Tree, sources: &Sources, moments: &[Moment], by_error: bool) -> Vec<Lens> {
    let lens = |(node, moment): (&Node, &Moment)| {
        let corner = (moment.centre - node.lo).sup(&(node.hi - moment.centre));
        let size2 = corner.norm_squared();
        let range = sources.of(node.range());
        let reach2 = if by_error && moment.m > 0.0 {
            moment.trace().powf(0.6) * moment.m.powf(-0.2)
        } else {
            size2
        };
        Lens {
            centre: moment.centre,
            reach2,
            bound2: size2 / (WIDEST * WIDEST),
            first: range.start as u32,
            end: range.end as u32,
            skip: node.skip,
        }
    };
    tree.nodes.iter().zip(moments).map(lens).collect()
}

/// What pulls on a group of targets.
#[derive(Clone, Debug, Default)]
pub struct Lists {
    /// nodes taken whole
    pub nodes: Vec<u32>,
    /// ranges of sources apart from the group
    pub far: Vec<(u32, u32)>,
    /// ranges of sources that touch the group
    pub near: Vec<(u32, u32)>,
}

/// The targets' box, and how near is near.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    pub lo: Vec3,
    pub hi: Vec3,
    pub near: f64,
    /// node that the targets are in; its sources are left out of the lists
    pub home: usize,
}

impl Region {
    fn distance2(&self, x: Vec3) -> f64 {
        (self.lo - x)
            .sup(&(x - self.hi))
            .sup(&Vec3::zeros())
            .norm_squared()
    }

    fn apart(&self, node: &Node) -> bool {
        let gap = (self.lo - node.hi)
            .sup(&(node.lo - self.hi))
            .sup(&Vec3::zeros());
        gap.norm_squared() > self.near * self.near
    }
}

impl Lists {
    /// Walks the tree for one group.
    pub fn fill(&mut self, tree: &Tree, lenses: &[Lens], region: &Region, criterion: Criterion) {
        self.nodes.clear();
        self.far.clear();
        self.near.clear();
        let scale = criterion.scale();
        let all_pairs = criterion == Criterion::Never;
        let near2 = region.near * region.near;
        let mut i = 0;
        while i < lenses.len() {
            let lens = &lenses[i];
            let d2 = region.distance2(lens.centre);
            if i == region.home || lens.first == lens.end {
                i = lens.skip as usize;
            } else if !all_pairs && d2 > (lens.reach2 * scale).max(lens.bound2.max(near2)) {
                if lens.end - lens.first <= FEW {
                    self.add(region, &tree.nodes[i], lens.first..lens.end);
                } else {
                    self.nodes.push(i as u32);
                }
                i = lens.skip as usize;
            } else if lens.skip as usize == i + 1 {
                self.add(region, &tree.nodes[i], lens.first..lens.end);
                i += 1;
            } else if all_pairs && region.apart(&tree.nodes[i]) {
                self.add(region, &tree.nodes[i], lens.first..lens.end);
                i = lens.skip as usize;
            } else {
                i += 1;
            }
        }
    }

    fn add(&mut self, region: &Region, node: &Node, range: Range<u32>) {
        let list = if region.apart(node) {
            &mut self.far
        } else {
            &mut self.near
        };
        match list.last_mut() {
            Some(last) if last.1 == range.start => last.1 = range.end,
            _ => list.push((range.start, range.end)),
        }
    }

    /// Nodes and sources.
    pub fn count(&self) -> usize {
        let ranges = self.far.iter().chain(&self.near);
        self.nodes.len() + ranges.map(|r| (r.1 - r.0) as usize).sum::<usize>()
    }
}
