//! A cluster of neighbouring groups of targets: who is active, how large accelerations are there, which criterion follows, the sums.
//!
//! The wanted relative error e turns into a node's largest error tau(e) a, where a is the harmonic mean square acceleration of the
//! group, 1/a^2 = <1/a_i^2>: the mean that the rms relative error weighs with. It is estimated from a sample of the targets
//! with the widest opening angle that the cluster as a whole admits.

use std::ops::Range;

use fearless_simd::Level;

use crate::points::Vec3;

use super::Count;
use super::direct::{Blocks, Frame, Group, Target};
use super::kernel::Pull;
use super::lanes::Real;
use super::moments::Moment;
use super::sources::Sources;
use super::walk::{Criterion, Forest, Lists, Region};

/// Targets of a group whose acceleration is estimated.
const SAMPLE: usize = 4;
/// A target with less than this part of its group's acceleration is done again by a criterion of its own.
const OUTLIER: f64 = 0.1;

/// What all clusters read.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub forest: Forest<'a>,
    pub sources: &'a Sources,
    pub moments: &'a [Moment],
    /// which of the caller's particles each one along the curve is
    pub order: &'a [u32],
    /// for each of the caller's particles one more than its number among the active, or zero
    pub turn: &'a [u32],
    pub groups: &'a [u32],
    /// [`Criterion::Widest`] if each group's criterion is to follow from its accelerations and `tolerance`
    pub criterion: Criterion,
    /// largest error of one node's acceleration in units of the target's acceleration
    pub tolerance: f64,
    pub potential: bool,
    /// separation in units of a group's size below which pairs are summed in f64
    pub closest: f64,
    /// length within which pairs are summed in f64 whatever the group's size
    pub resolved: f64,
    pub level: Level,
}

/// A group with active targets.
struct Active {
    /// its part of the cluster's targets
    first: usize,
    end: usize,
    region: Region,
    frame: Frame,
    criterion: Criterion,
    /// mean acceleration; zero if the criterion does not need it
    typical: f64,
}

/// Buffers of one thread.
pub struct Cluster<E> {
    groups: Vec<Active>,
    targets: Vec<Target>,
    turns: Vec<u32>,
    pulled: Vec<Target>,
    /// group, target and acceleration of those that need a stricter criterion than their group's
    outliers: Vec<(usize, usize, f64)>,
    pulls: Vec<Pull>,
    lists: Lists,
    blocks: Blocks<E>,
}

impl<E: Real> Default for Cluster<E> {
    fn default() -> Self {
        Self {
            groups: Vec::new(),
            targets: Vec::new(),
            turns: Vec::new(),
            pulled: Vec::new(),
            outliers: Vec::new(),
            pulls: Vec::new(),
            lists: Lists::default(),
            blocks: Blocks::default(),
        }
    }
}

impl<E: Real> Cluster<E> {
    /// Calls `give` with the pull on each active target of the cluster at node `home`, by its number among the active;
    /// G = 1 and total mass 1.
    pub fn solve(&mut self, scene: &Scene, home: usize, mut give: impl FnMut(u32, Pull)) -> Count {
        self.take_active(scene, home);
        if self.groups.is_empty() {
            return Count::default();
        }
        let region = self.region(home);
        self.choose(scene, &region);
        let by_strictness = |a: &&Active, b: &&Active| a.criterion.compare(&b.criterion);
        let strict = self
            .groups
            .iter()
            .min_by(by_strictness)
            .map(|g| g.criterion);
        let loose = self
            .groups
            .iter()
            .max_by(by_strictness)
            .map(|g| g.criterion);
        if let (Some(strict), Some(loose)) = (strict, loose) {
            self.lists.share(scene.forest, &region, strict, loose);
        }
        let mut count = Count::default();
        self.outliers.clear();
        for g in 0..self.groups.len() {
            let (first, end) = (self.groups[g].first, self.groups[g].end);
            let small = OUTLIER * self.groups[g].typical;
            self.complete(scene, g);
            count.interactions += self.pull(scene, g, first..end);
            count.targets += (end - first) as u64;
            for (i, pull) in (first..end).zip(&self.pulls) {
                if size(pull) < small {
                    self.outliers.push((g, i, size(pull)));
                }
                give(self.turns[i], *pull);
            }
        }
        for k in 0..self.outliers.len() {
            let (g, i, a) = self.outliers[k];
            let criterion = Criterion::Error(scene.tolerance * a);
            self.groups[g].criterion = criterion;
            self.lists
                .share(scene.forest, &self.groups[g].region, criterion, criterion);
            self.complete(scene, g);
            count.interactions += self.pull(scene, g, i..i + 1);
            give(self.turns[i], self.pulls[0]);
        }
        count
    }

    fn complete(&mut self, scene: &Scene, g: usize) {
        let group = &self.groups[g];
        self.lists
            .complete(scene.forest, &group.region, group.criterion);
    }

    fn take_active(&mut self, scene: &Scene, home: usize) {
        self.groups.clear();
        self.targets.clear();
        self.turns.clear();
        let nodes = &scene.forest.tree.nodes;
        let end = nodes[home].skip;
        let from = scene.groups.partition_point(|&g| (g as usize) < home);
        let groups = scene.groups[from..].iter().take_while(|&&g| g < end);
        for &group in groups {
            let first = self.targets.len();
            for i in nodes[group as usize].range() {
                let turn = scene.turn[scene.order[i] as usize];
                if turn > 0 {
                    self.turns.push(turn - 1);
                    self.targets.push(scene.sources.target(i));
                }
            }
            if self.targets.len() > first {
                let active = self.active(scene, group as usize, first);
                self.groups.push(active);
            }
        }
    }

    /// The group whose targets are those from `first` on.
    fn active(&self, scene: &Scene, home: usize, first: usize) -> Active {
        let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        let (lo, hi) = self.targets[first..]
            .iter()
            .fold(empty, |(lo, hi), t| (lo.inf(&t.x), hi.sup(&t.x)));
        let frame = frame(scene, lo, hi);
        Active {
            first,
            end: self.targets.len(),
            region: Region {
                lo,
                hi,
                near: frame.closest / frame.scale,
                home,
            },
            frame,
            criterion: scene.criterion,
            typical: 0.0,
        }
    }

    /// The box around all targets.
    fn region(&self, home: usize) -> Region {
        let mut whole = self.groups[0].region;
        for group in &self.groups {
            whole.lo = whole.lo.inf(&group.region.lo);
            whole.hi = whole.hi.sup(&group.region.hi);
            whole.near = whole.near.max(group.region.near);
        }
        Region { home, ..whole }
    }

    /// Sets the groups' criteria.
    fn choose(&mut self, scene: &Scene, region: &Region) {
        let by_error = scene.criterion == Criterion::Widest;
        if by_error {
            self.sample(scene, region);
        }
        let mut rest = &self.pulls[..];
        for group in &mut self.groups {
            group.criterion = scene.criterion;
            if by_error {
                let (own, others) = rest.split_at(sampled(group).count());
                rest = others;
                let inverse_squares: f64 = own.iter().map(|pull| size(pull).powi(-2)).sum();
                group.typical = (own.len() as f64 / inverse_squares).sqrt();
                group.criterion = Criterion::Error(scene.tolerance * group.typical);
            }
        }
    }

    /// Pulls on a few targets of each group, the whole cluster taken as one group.
    fn sample(&mut self, scene: &Scene, cluster: &Region) {
        let frame = frame(scene, cluster.lo, cluster.hi);
        let region = Region {
            near: frame.closest / frame.scale,
            ..*cluster
        };
        let widest = Criterion::Widest;
        self.lists.share(scene.forest, &region, widest, widest);
        self.lists.complete(scene.forest, &region, widest);
        self.pulled.clear();
        for group in &self.groups {
            let targets = sampled(group).map(|i| self.targets[i]);
            self.pulled.extend(targets);
        }
        self.sum(scene, frame, region.home, false);
    }

    /// Pulls on some targets of group `g` by what is in the lists; returns the number of interactions.
    fn pull(&mut self, scene: &Scene, g: usize, targets: Range<usize>) -> u64 {
        let Active { frame, region, .. } = self.groups[g];
        self.pulled.clear();
        self.pulled.extend_from_slice(&self.targets[targets]);
        self.sum(scene, frame, region.home, scene.potential)
    }

    /// Pulls on `pulled` by what is in the lists and in the node `home`; returns the number of interactions.
    fn sum(&mut self, scene: &Scene, frame: Frame, home: usize, potential: bool) -> u64 {
        self.pulls.clear();
        self.pulls.resize(self.pulled.len(), Pull::default());
        let home = scene.sources.of(scene.forest.tree.nodes[home].range());
        let count = self.lists.count() + home.len();
        E::run(
            scene.level,
            Group {
                frame,
                targets: &self.pulled,
                home,
                lists: &self.lists,
                sources: scene.sources,
                moments: scene.moments,
                potential,
                blocks: &mut self.blocks,
                pulls: &mut self.pulls,
            },
        );
        for pull in &mut self.pulls {
            pull.a = pull.a.map(|a| a * frame.scale * frame.scale);
            pull.phi *= frame.scale;
        }
        (self.pulls.len() * count) as u64
    }
}

/// The frame of targets in a box.
fn frame(scene: &Scene, lo: Vec3, hi: Vec3) -> Frame {
    let root = &scene.forest.tree.nodes[0];
    // A lone target has no size; it takes the smallest whose fifth power f32 can span the whole with.
    let unit = (0.5 * (hi - lo).norm()).max(1e-7 * (root.hi - root.lo).norm());
    let unit = if unit > 0.0 { unit } else { 1.0 };
    Frame {
        centre: 0.5 * (lo + hi),
        scale: 1.0 / unit,
        closest: scene.closest.max(scene.resolved / unit),
    }
}

/// The targets of a group whose acceleration is estimated.
fn sampled(group: &Active) -> impl Iterator<Item = usize> + use<> {
    let stride = (group.end - group.first).div_ceil(SAMPLE);
    (group.first..group.end).step_by(stride)
}

/// Size of an acceleration.
fn size(pull: &Pull) -> f64 {
    pull.a.iter().map(|a| a * a).sum::<f64>().sqrt()
}
