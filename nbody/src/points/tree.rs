//! The tree: a binary hierarchy of boxes over particles that are sorted along the Morton curve.
//!
//! Nodes stand in depth-first order, parents before children; `skip` leads past a node's descendants, so a walk needs no stack.
//! Boxes are tight around the particles. Between builds the boxes can be refitted to moved particles in the old order.

use std::ops::Range;

use rayon::prelude::*;

use super::sort::MANY;
use super::sum::Parts;
use super::{Domain, Vec3};

/// A box with the particles first..end in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    pub lo: Vec3,
    pub hi: Vec3,
    pub first: u32,
    pub end: u32,
    /// The next node in depth-first order that is no descendant; a leaf's is its own number plus one.
    pub skip: u32,
}

impl Node {
    pub fn range(&self) -> Range<usize> {
        self.first as usize..self.end as usize
    }

    pub fn count(&self) -> usize {
        (self.end - self.first) as usize
    }

    pub fn centre(&self) -> Vec3 {
        0.5 * (self.lo + self.hi)
    }
}

/// Lower and upper corner of the box around a range of particles.
pub trait Bounds: Fn(Range<usize>) -> (Vec3, Vec3) + Sync {}

impl<F: Fn(Range<usize>) -> (Vec3, Vec3) + Sync> Bounds for F {}

fn bounds(x: &[Vec3]) -> (Vec3, Vec3) {
    let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    x.iter().fold(empty, |(lo, hi), p| (lo.inf(p), hi.sup(p)))
}

/// The tree over a sorted particle set.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    /// Depth-first; the root is node 0. Empty without particles.
    pub nodes: Vec<Node>,
    /// Numbers of the leaves, along the curve; their ranges together are 0..n.
    pub leaves: Vec<u32>,
}

impl Tree {
    /// Builds the tree over positions `x` with ascending Morton keys `keys`, at most `leaf_size` particles a leaf.
    ///
    /// A node is halved where its keys first differ; coincident particles are halved by number.
    pub fn build(&mut self, x: &[Vec3], keys: &[u64], leaf_size: usize) {
        assert_eq!(x.len(), keys.len(), "a key a particle");
        self.build_within(keys, leaf_size, &|range| bounds(&x[range]));
    }

    /// The same over particles whose `bounds` are known by their range along the curve, wherever they stand.
    pub fn build_within(&mut self, keys: &[u64], leaf_size: usize, bounds: &impl Bounds) {
        assert!(leaf_size > 0, "a leaf holds at least one particle");
        self.nodes.clear();
        self.leaves.clear();
        if !keys.is_empty() {
            self.branch(keys, 0, keys.len(), leaf_size);
            self.refit_within(bounds);
        }
        if keys.len() > MANY {
            self.nodes.shrink_to_fit();
            self.leaves.shrink_to_fit();
        }
    }

    fn branch(&mut self, keys: &[u64], first: usize, end: usize, leaf_size: usize) {
        let place = self.nodes.len();
        let unset = Vec3::zeros();
        self.nodes.push(Node {
            lo: unset,
            hi: unset,
            first: first as u32,
            end: end as u32,
            skip: 0,
        });
        if end - first <= leaf_size {
            self.leaves.push(place as u32);
        } else {
            let middle = parting(keys, first, end);
            self.branch(keys, first, middle, leaf_size);
            self.branch(keys, middle, end, leaf_size);
        }
        self.nodes[place].skip = self.nodes.len() as u32;
    }

    /// Fits all boxes to the present positions; the particles' order is that of the build.
    pub fn refit(&mut self, x: &[Vec3]) {
        self.refit_within(&|range| bounds(&x[range]));
    }

    /// The same by the `bounds` of ranges of particles.
    pub fn refit_within(&mut self, bounds: &impl Bounds) {
        if !self.nodes.is_empty() {
            fit(&mut self.nodes, 0, bounds);
        }
    }

    /// Fits the boxes of all nodes but leaves to those of their leaves.
    pub fn enclose(&mut self) {
        for at in (0..self.nodes.len()).rev() {
            if let Some((left, right)) = self.children(at) {
                let (left, right) = (self.nodes[left], self.nodes[right]);
                self.nodes[at].lo = left.lo.inf(&right.lo);
                self.nodes[at].hi = left.hi.sup(&right.hi);
            }
        }
    }

    /// The two children of a node; none for a leaf.
    pub fn children(&self, node: usize) -> Option<(usize, usize)> {
        let left = node + 1;
        (self.nodes[node].skip as usize > left).then(|| (left, self.nodes[left].skip as usize))
    }

    pub fn is_leaf(&self, node: usize) -> bool {
        self.nodes[node].skip as usize == node + 1
    }

    /// For every node a value, into `values`: of a leaf as `leaf` says, else what `both` makes of the children's.
    pub fn accumulate<T: Copy + Default + Send>(
        &self,
        values: &mut Vec<T>,
        leaf: &(impl Fn(&Node) -> T + Sync),
        both: &(impl Fn(T, T) -> T + Sync),
    ) {
        values.clear();
        values.resize(self.nodes.len(), T::default());
        if !values.is_empty() {
            self.rise(0, values, leaf, both);
        }
    }

    /// [`Tree::accumulate`] for `node` and its descendants, whose values are `values`.
    fn rise<T: Copy + Send>(
        &self,
        node: usize,
        values: &mut [T],
        leaf: &(impl Fn(&Node) -> T + Sync),
        both: &(impl Fn(T, T) -> T + Sync),
    ) -> T {
        let (own, rest) = values.split_at_mut(1);
        own[0] = match self.children(node) {
            None => leaf(&self.nodes[node]),
            Some((left, right)) => {
                let (lefts, rights) = rest.split_at_mut(right - left);
                let (a, b) = parallel_from(
                    self.nodes[node].count(),
                    || self.rise(left, lefts, leaf, both),
                    || self.rise(right, rights, leaf, both),
                );
                both(a, b)
            }
        };
        own[0]
    }

    /// For every node the largest `value` of its particles, into `most`.
    pub fn largest(&self, value: impl Fn(usize) -> f64 + Sync, most: &mut Vec<f64>) {
        let leaf = |node: &Node| node.range().fold(f64::NEG_INFINITY, |m, i| m.max(value(i)));
        self.accumulate(most, &leaf, &f64::max);
    }

    /// For every node the largest `value` of its particles in the leaves listed, into `most`; -1 where there are none, or none that is larger.
    pub fn largest_of(
        &self,
        leaves: &[u32],
        value: impl Fn(usize) -> f64 + Sync,
        most: &mut Vec<f64>,
    ) {
        most.clear();
        most.resize(self.nodes.len(), -1.0);
        let own = Parts::new(most);
        leaves.par_iter().with_min_len(16).for_each(|&leaf| {
            let at = leaf as usize;
            let range = self.nodes[at].range();
            // SAFETY: each leaf is listed once.
            let most = unsafe { &mut own.part(at..at + 1)[0] };
            *most = range.fold(-1.0f64, |most, i| most.max(value(i)));
        });
        for at in (0..self.nodes.len()).rev() {
            if let Some((left, right)) = self.children(at) {
                most[at] = most[left].max(most[right]);
            }
        }
    }

    /// Calls `visit(range, shift)` for leaves whose box, moved by a shift of the domain, comes within max(`reach`, `extent[leaf]`) of the
    /// box [lo, hi]. `extent` gives a node's own reach (as from [`Tree::largest`]), or is empty for none; a node with a negative extent is
    /// passed over. Every particle within reach is in a visited range; not every visited particle is within reach. The order is fixed.
    pub fn near(
        &self,
        domain: &Domain,
        (lo, hi): (Vec3, Vec3),
        reach: f64,
        extent: &[f64],
        mut visit: impl FnMut(Range<usize>, Vec3),
    ) {
        self.visit(domain, (lo, hi), reach, extent, |leaf, shift| {
            visit(self.nodes[leaf].range(), shift);
        });
    }

    /// [`Tree::near`] with the numbers of the leaves.
    pub fn visit(
        &self,
        domain: &Domain,
        (lo, hi): (Vec3, Vec3),
        reach: f64,
        extent: &[f64],
        mut visit: impl FnMut(usize, Vec3),
    ) {
        let Some(root) = self.nodes.first() else {
            return;
        };
        let far = reach.max(extent.first().copied().unwrap_or(0.0));
        let margin = Vec3::repeat(far);
        domain.shifts(lo - margin, hi + margin, root.lo, root.hi, |shift| {
            let (lo, hi) = (lo - shift, hi - shift);
            let mut i = 0;
            while i < self.nodes.len() {
                let node = &self.nodes[i];
                let own = extent.get(i).copied().unwrap_or(0.0);
                let reach = reach.max(own);
                let gap = (node.lo - hi).sup(&(lo - node.hi)).sup(&Vec3::zeros());
                if own < 0.0 || gap.norm_squared() > reach * reach {
                    i = node.skip as usize;
                } else {
                    i += 1;
                    if node.skip as usize == i {
                        visit(i - 1, shift);
                    }
                }
            }
        });
    }
}

/// Particles below which two subtrees are not worth two tasks.
const FEW: usize = 4096;

/// Both, at the same time if they are of many particles.
fn parallel_from<A: Send, B: Send>(
    particles: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    if particles > FEW {
        rayon::join(a, b)
    } else {
        (a(), b())
    }
}

/// Fits the boxes of a node, number `at`, and of its descendants, which follow it in `nodes`; returns its box.
fn fit(nodes: &mut [Node], at: usize, bounds: &impl Bounds) -> (Vec3, Vec3) {
    let (own, rest) = nodes.split_at_mut(1);
    let own = &mut own[0];
    (own.lo, own.hi) = match rest.first().map(|left| left.skip as usize - at - 1) {
        None => bounds(own.range()),
        Some(size) => {
            let (left, right) = rest.split_at_mut(size);
            let (a, b) = parallel_from(
                own.count(),
                || fit(left, at + 1, bounds),
                || fit(right, at + 1 + size, bounds),
            );
            (a.0.inf(&b.0), a.1.sup(&b.1))
        }
    };
    (own.lo, own.hi)
}

/// Where the sorted keys of first..end part: at the highest bit in which they differ.
fn parting(keys: &[u64], first: usize, end: usize) -> usize {
    let differ = keys[first] ^ keys[end - 1];
    if differ == 0 {
        return first + (end - first) / 2;
    }
    let bit = 63 - differ.leading_zeros();
    first + keys[first..end].partition_point(|key| key >> bit & 1 == 0)
}

#[cfg(test)]
mod tests;
