//! The walk: which nodes may pull on a group of targets by their moments, and which particles must do so one by one.
//!
//! A node is taken whole if its centre of mass is further than max(reach, bound) from the box around the targets. `bound` keeps
//! targets outside of the node. The expansion leaves out the octupole, so the error of a node's acceleration at distance d is about
//! tr S b / d^5, with S the second moments and b the distance from the centre of mass to the furthest corner of the box; reach is
//! where that equals the error allowed. Groups of a cluster walk the upper tree together and get the lists they would get alone.

use rayon::prelude::*;

use crate::points::{Node, Tree, Vec3};

use super::moments::Moment;
use super::sources::Sources;

/// Largest opening angle: distance in units of the distance from the centre of mass to the furthest corner of the box.
const WIDEST: f64 = 0.95;
/// A node of so few sources costs less as points than as a quadrupole.
const FEW: u32 = 2;

/// What the walk sees of a node.
#[derive(Clone, Copy, Debug)]
pub struct Lens {
    centre: Vec3,
    /// square of the distance that is enough for a unit error or angle
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

impl Criterion {
    /// Orders two criteria of one kind, the stricter first.
    pub fn compare(&self, other: &Self) -> std::cmp::Ordering {
        other.scale().total_cmp(&self.scale())
    }
}

/// Prepares the walk; `by_error` for [`Criterion::Error`], else for [`Criterion::Angle`].
pub fn prepare(
    tree: &Tree,
    sources: &Sources,
    moments: &[Moment],
    by_error: bool,
    lenses: &mut Vec<Lens>,
) {
    let lens = |(node, moment): (&Node, &Moment)| {
        let corner = (moment.centre - node.lo).sup(&(node.hi - moment.centre));
        let size2 = corner.norm_squared();
        let range = sources.of(node.range());
        let reach2 = if by_error {
            (moment.trace() * size2.sqrt()).powf(0.4)
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
    tree.nodes
        .par_iter()
        .zip(moments)
        .with_min_len(1024)
        .map(lens)
        .collect_into_vec(lenses);
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
    /// nodes that each group of a cluster has to decide on
    undecided: Vec<u32>,
    /// entries of `nodes` and `far` that all groups of a cluster share
    shared: (usize, usize),
}

/// The box around targets, and how near is near.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    pub lo: Vec3,
    pub hi: Vec3,
    pub near: f64,
    /// node that the targets are in
    pub home: usize,
}

impl Region {
    fn distance2(&self, x: Vec3) -> f64 {
        (self.lo - x)
            .sup(&(x - self.hi))
            .sup(&Vec3::zeros())
            .norm_squared()
    }

    /// Square of the distance from `x` to the corner furthest away.
    fn furthest2(&self, x: Vec3) -> f64 {
        (x - self.lo).sup(&(self.hi - x)).norm_squared()
    }

    fn apart(&self, node: &Node) -> bool {
        let gap = (self.lo - node.hi)
            .sup(&(node.lo - self.hi))
            .sup(&Vec3::zeros());
        gap.norm_squared() > self.near * self.near
    }
}

/// A tree with what the walk needs to know.
#[derive(Clone, Copy)]
pub struct Forest<'a> {
    pub tree: &'a Tree,
    pub lenses: &'a [Lens],
}

impl Lists {
    /// Walks the tree for a cluster of groups, as far as the answer is the same for all of them; `strict` and `loose` are the
    /// criteria of the groups that ask most and least.
    pub fn share(&mut self, forest: Forest, cluster: &Region, strict: Criterion, loose: Criterion) {
        let Forest { tree, lenses } = forest;
        self.nodes.clear();
        self.far.clear();
        self.undecided.clear();
        self.shared = (0, 0);
        let (strict, loose) = (strict.scale(), loose.scale());
        let all_pairs = strict.is_infinite();
        let near2 = cluster.near * cluster.near;
        let cluster_range = tree.nodes[cluster.home].range();
        let mut i = 0;
        while i < lenses.len() {
            let lens = &lenses[i];
            let node = &tree.nodes[i];
            let skip = lens.skip as usize;
            let leaf = skip == i + 1;
            let must_open =
                cluster.furthest2(lens.centre) <= (lens.reach2 * loose).max(lens.bound2);
            let group_inside = node.count() <= super::GROUP
                && cluster_range.start <= node.range().start
                && node.range().end <= cluster_range.end;
            let d2 = cluster.distance2(lens.centre);
            if lens.first == lens.end {
                i = skip;
            } else if !all_pairs && d2 > (lens.reach2 * strict).max(lens.bound2.max(near2)) {
                self.take(i, lens, cluster, node);
                i = skip;
            } else if group_inside {
                self.undecided.push(i as u32);
                i = skip;
            } else if (all_pairs || leaf && must_open) && cluster.apart(node) {
                self.add_points(cluster, node, lens);
                i = skip;
            } else if (all_pairs || must_open) && !leaf {
                i += 1;
            } else {
                self.undecided.push(i as u32);
                i = skip;
            }
        }
        self.shared = (self.nodes.len(), self.far.len());
    }

    /// Completes the lists for one group of the cluster, or for the cluster as a group. The sources of its own node are left out.
    pub fn complete(&mut self, forest: Forest, region: &Region, criterion: Criterion) {
        let Forest { tree, lenses } = forest;
        self.nodes.truncate(self.shared.0);
        self.far.truncate(self.shared.1);
        self.near.clear();
        let scale = criterion.scale();
        let all_pairs = scale.is_infinite();
        let near2 = region.near * region.near;
        let home = region.home..lenses[region.home].skip as usize;
        let undecided = std::mem::take(&mut self.undecided);
        for &top in &undecided {
            let mut i = top as usize;
            let end = lenses[i].skip as usize;
            while i < end {
                let lens = &lenses[i];
                let skip = lens.skip as usize;
                let d2 = region.distance2(lens.centre);
                if home.contains(&i) || lens.first == lens.end {
                    i = skip;
                } else if !all_pairs && d2 > (lens.reach2 * scale).max(lens.bound2.max(near2)) {
                    self.take(i, lens, region, &tree.nodes[i]);
                    i = skip;
                } else {
                    i += 1;
                    if skip == i {
                        self.add_points(region, &tree.nodes[i - 1], lens);
                    }
                }
            }
        }
        self.undecided = undecided;
    }

    fn take(&mut self, i: usize, lens: &Lens, region: &Region, node: &Node) {
        if lens.end - lens.first <= FEW && region.apart(node) {
            self.add_points(region, node, lens);
        } else {
            self.nodes.push(i as u32);
        }
    }

    fn add_points(&mut self, region: &Region, node: &Node, lens: &Lens) {
        let (list, shared) = if region.apart(node) {
            (&mut self.far, self.shared.1)
        } else {
            (&mut self.near, 0)
        };
        let grows = list.len() > shared;
        match list.last_mut() {
            Some(last) if grows && last.1 == lens.first => last.1 = lens.end,
            _ => list.push((lens.first, lens.end)),
        }
    }

    /// Nodes and sources.
    pub fn count(&self) -> usize {
        let ranges = self.far.iter().chain(&self.near);
        self.nodes.len() + ranges.map(|r| (r.1 - r.0) as usize).sum::<usize>()
    }
}
