//! The vicinity of a tick: the particles whose steps end now, and the leaves that they may meet. Sweeps pack and work on these alone.
//!
//! A leaf is near if it comes within max(1.1 H of an active leaf, its own H) of that leaf; H are bounds of the predicted supports. An H
//! that turns out larger than that is sought among all gas.

use std::sync::atomic::{AtomicBool, Ordering};

use nbody::points::{Clock, Tree};
use rayon::prelude::*;

use crate::leaves::FEW;
use crate::neighbours::branches;
use crate::{Gas, Hydro};

/// How far active particles look for neighbours, in units of the largest predicted support of their leaf.
const MARGIN: f64 = 1.1;

/// Who is active, and what is near.
#[derive(Debug, Default)]
pub(crate) struct Vicinity {
    /// Active particles, in the order of memory.
    pub active: Vec<u32>,
    /// Leaves that hold active particles, leaves that are near, and the branches that hold these; numbers of nodes.
    pub leaves: Vec<u32>,
    pub near: Vec<u32>,
    pub active_branches: Vec<u32>,
    pub near_branches: Vec<u32>,
    /// How far active particles of a node may look for neighbours among the near leaves; code units, by node.
    pub reach: Vec<f64>,
    marks: Vec<AtomicBool>,
}

impl Clone for Vicinity {
    /// A vicinity is looked for anew at each tick.
    fn clone(&self) -> Self {
        Self {
            active: self.active.clone(),
            leaves: self.leaves.clone(),
            near: self.near.clone(),
            active_branches: self.active_branches.clone(),
            near_branches: self.near_branches.clone(),
            reach: self.reach.clone(),
            marks: Vec::new(),
        }
    }
}

impl Vicinity {
    /// Lists whose steps end at the tick of `clock`.
    fn list(&mut self, tree: &Tree, end: &[u32], clock: &Clock) {
        self.active.clear();
        self.leaves.clear();
        if clock.synchronous() {
            self.active.extend(0..end.len() as u32);
            self.leaves.extend_from_slice(&tree.leaves);
            return;
        }
        for &leaf in &tree.leaves {
            let range = tree.nodes[leaf as usize].range();
            let ends = &end[range.clone()];
            // Without an early exit: many at a time.
            if ends
                .iter()
                .fold(false, |any, &end| any | (end == clock.tick))
            {
                self.leaves.push(leaf);
                let active = range.filter(|&i| end[i] == clock.tick);
                self.active.extend(active.map(|i| i as u32));
            }
        }
    }

    /// Takes all leaves as near.
    fn all(&mut self, tree: &Tree) {
        self.marks.clear();
        self.marks
            .resize_with(tree.nodes.len(), || AtomicBool::new(true));
        self.near.clear();
        self.near.extend_from_slice(&tree.leaves);
        self.reach.clear();
        self.reach.resize(tree.nodes.len(), f64::INFINITY);
    }

    /// The largest nodes that sweeps work on one by one, of those that hold what is listed.
    fn branch_out(&mut self, tree: &Tree) {
        for (branching, leaves) in [
            (&mut self.active_branches, &self.leaves),
            (&mut self.near_branches, &self.near),
        ] {
            branches(tree, branching);
            let mut leaves = leaves.iter().copied().peekable();
            branching.retain(|&branch| {
                let end = tree.nodes[branch as usize].skip;
                let holds = leaves.peek().is_some_and(|&leaf| leaf < end);
                while leaves.next_if(|&leaf| leaf < end).is_some() {}
                holds
            });
        }
    }
}

impl Gas {
    /// Finds who is active at the tick of `clock` and what is near, and brings the near to that tick.
    pub(crate) fn look(&mut self, hydro: &Hydro, clock: &Clock) {
        let mut vicinity = std::mem::take(&mut self.vicinity);
        vicinity.list(&self.tree, &self.particles.end, clock);
        if clock.synchronous() {
            vicinity.all(&self.tree);
        } else {
            self.find(&mut vicinity, hydro, clock);
            let reach = &vicinity.reach;
            let waste = |&leaf: &u32| self.wasted(leaf as usize, reach[leaf as usize], hydro);
            let waste: f64 = vicinity.leaves.iter().map(waste).sum();
            self.waste += waste;
        }
        vicinity.branch_out(&self.tree);
        self.arrive_in(&vicinity.near, &hydro.domain, clock);
        self.vicinity = vicinity;
    }

    fn wasted(&self, leaf: usize, reach: f64, hydro: &Hydro) -> f64 {
        self.leaves[leaf].waste(&self.tree.nodes[leaf], reach, hydro.dimensions())
    }

    /// Takes all gas as near.
    pub(crate) fn look_far(&mut self, hydro: &Hydro, clock: &Clock) {
        self.arrive(&hydro.domain, clock);
        self.vicinity.all(&self.tree);
        self.vicinity.branch_out(&self.tree);
    }

    /// Marks and lists what is near the active leaves.
    fn find(&self, vicinity: &mut Vicinity, hydro: &Hydro, clock: &Clock) {
        let (tree, support, d) = (&self.tree, hydro.support(), hydro.dimensions());
        let Vicinity {
            leaves,
            near,
            reach,
            marks,
            ..
        } = vicinity;
        reach.resize(tree.nodes.len(), 0.0);
        marks.resize_with(tree.nodes.len(), AtomicBool::default);
        for at in (0..tree.nodes.len()).rev() {
            *marks[at].get_mut() = false;
            reach[at] = match tree.children(at) {
                None => support * self.leaves[at].largest_h(clock, d),
                Some((left, right)) => reach[left].max(reach[right]),
            };
        }
        leaves.par_iter().with_min_len(FEW).for_each(|&leaf| {
            let node = &tree.nodes[leaf as usize];
            let wide = hydro.domain.widened(0.0);
            let (span, own) = (
                (node.lo - wide, node.hi + wide),
                MARGIN * reach[leaf as usize],
            );
            tree.visit(&hydro.domain, span, own, reach, |near, _| {
                marks[near].store(true, Ordering::Relaxed);
            });
        });
        near.clear();
        let marked = |leaf: &&u32| marks[**leaf as usize].load(Ordering::Relaxed);
        near.extend(tree.leaves.iter().filter(marked));
        for reach in reach {
            *reach *= MARGIN;
        }
    }

    /// The particles whose steps end at the tick that density was last found at, in the order of memory.
    pub fn active_ones(&self) -> &[u32] {
        &self.vicinity.active
    }

    /// The leaves that these may meet: what kicks change now.
    pub fn near(&self) -> &[u32] {
        &self.vicinity.near
    }
}

#[cfg(test)]
mod tests;
