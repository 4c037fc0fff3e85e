//! Self-gravity of all populations at once: a = -G sum_j m_j d_ij / (d_ij^2 + eps_i^2 + eps_j^2)^(3/2), by a tree or by all pairs.
//!
//! Particles are threaded along the Morton curve; a binary tree over them carries mass, centre of mass, softening and second moments.
//! Groups of up to 64 targets share one walk and one list of nodes and particles (Barnes 1990), which vectorised kernels sum in f32
//! relative to the group, or in f64 if the wanted error is tight. A node is taken whole where the estimated error of its
//! acceleration is below a fixed part of the acceleration of the group, so the error asked for is nearly the error obtained.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::points::sort::{Cube, Curve};
use crate::points::sum::Parts;
use crate::points::{Tree, Vec3};

pub mod direct;
pub mod kernel;
pub mod lanes;
pub mod moments;
pub mod walk;

use direct::{Blocks, Frame, Group, NO_SOURCE, Sources, Target};
use kernel::Pull;
use lanes::Real;
use moments::Moment;
use walk::{Criterion, Lens, Lists, Region};

/// Most targets in a group.
pub const GROUP: usize = 64;
/// Most particles in a leaf.
const LEAF: usize = 12;

/// How exact the tree is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// wanted rms relative error of the acceleration
    ForceError(f64),
    /// largest ratio of a node's size (centre of mass to furthest corner) to its distance
    OpeningAngle(f64),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Tree,
    Direct,
    /// whichever costs less
    Automatic,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    pub accuracy: Accuracy,
    pub method: Method,
    /// G
    pub constant: f64,
}

/// What a call did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    pub targets: u64,
    /// pairs of a target and a particle or node
    pub interactions: u64,
}

pub struct Gravity {
    settings: Settings,
    level: Level,
    curve: Curve,
    tree: Tree,
    groups: Vec<u32>,
    /// positions and squares of the softening lengths along the curve
    x: Vec<Vec3>,
    eps2: Vec<f64>,
    sources: Sources,
    moments: Vec<Moment>,
    lenses: Vec<Lens>,
    /// place along the curve of each of the caller's particles
    place: Vec<u32>,
    /// for each place along the curve one more than its number among the active, or zero
    slot: Vec<u32>,
    pub debug_scale: Vec<f64>,
}

impl Gravity {
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            level: Level::new(),
            curve: Curve::default(),
            tree: Tree::default(),
            groups: Vec::new(),
            x: Vec::new(),
            eps2: Vec::new(),
            sources: Sources::default(),
            moments: Vec::new(),
            lenses: Vec::new(),
            place: Vec::new(),
            slot: Vec::new(),
            debug_scale: Vec::new(),
        }
    }

    /// Threads the particles, builds the tree and its moments. Particles without mass feel, but do not pull.
    pub fn build(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        self.curve.thread(x, Cube::around(x));
        self.place.resize(x.len(), 0);
        for (place, &i) in self.curve.order.iter().enumerate() {
            self.place[i as usize] = place as u32;
        }
        self.take(x, m, softening);
        self.tree.build(&self.x, &self.curve.keys, LEAF);
        self.group();
        self.weigh();
    }

    /// Takes the same particles, moved a little: new boxes and moments, but the order and the tree of the last build.
    pub fn refit(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        assert_eq!(x.len(), self.x.len(), "the particles of the last build");
        self.take(x, m, softening);
        self.tree.refit(&self.x);
        self.weigh();
    }

    fn take(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        assert_eq!(x.len(), m.len(), "a mass a particle");
        assert_eq!(x.len(), softening.len(), "a softening length a particle");
        let order = &self.curve.order;
        self.x.clear();
        self.x.extend(order.iter().map(|&i| x[i as usize]));
        self.eps2.clear();
        self.eps2.extend(order.iter().map(|&i| softening[i as usize].powi(2)));
        self.sources.take(order, x, m, softening);
    }

    /// Nodes of at most [`GROUP`] particles whose parent has more.
    fn group(&mut self) {
        self.groups.clear();
        let mut i = 0;
        while i < self.tree.nodes.len() {
            if self.tree.nodes[i].count() <= GROUP {
                self.groups.push(i as u32);
                i = self.tree.nodes[i].skip as usize;
            } else {
                i += 1;
            }
        }
    }

    fn weigh(&mut self) {
        moments::refresh(&self.tree, &self.sources, &mut self.moments);
        let by_error = matches!(self.settings.accuracy, Accuracy::ForceError(_));
        self.lenses = walk::lenses(&self.tree, &self.sources, &self.moments, by_error);
    }

    /// Accelerations of the particles numbered in `active`, and their potentials unless `potential` is empty.
    pub fn field(
        &mut self,
        active: &[u32],
        acceleration: &mut [Vec3],
        potential: &mut [f64],
    ) -> Count {
        assert_eq!(acceleration.len(), active.len(), "an acceleration a target");
        assert!(
            potential.is_empty() || potential.len() == active.len(),
            "a potential a target, or none"
        );
        self.slot.clear();
        self.slot.resize(self.x.len(), 0);
        for (k, &i) in active.iter().enumerate() {
            self.slot[self.place[i as usize] as usize] = k as u32 + 1;
        }
        let tight = match self.settings.accuracy {
            Accuracy::ForceError(error) => error < 1e-5,
            Accuracy::OpeningAngle(angle) => angle < 0.1,
        };
        let count = if tight {
            self.sweep::<f64>(acceleration, potential)
        } else {
            self.sweep::<f32>(acceleration, potential)
        };
        assert_eq!(count.targets as usize, active.len(), "a particle is active once");
        count
    }

    fn sweep<E: Real>(&self, acceleration: &mut [Vec3], potential: &mut [f64]) -> Count {
        let with_potential = !potential.is_empty();
        let (a, phi) = (Parts::new(acceleration), Parts::new(potential));
        let counts: Vec<Count> = self
            .groups
            .par_iter()
            .with_min_len(8)
            .map_init(Scratch::<E>::default, |scratch, &home| {
                let count = self.solve(scratch, home as usize, with_potential);
                let unit = self.settings.constant * self.sources.total * scratch.scale;
                for (&slot, pull) in scratch.slots.iter().zip(&scratch.pulls) {
                    let k = slot as usize;
                    // SAFETY: each particle is in one group, and `field` checks that it is active once.
                    let a = &mut unsafe { a.part(k..k + 1) }[0];
                    *a = Vec3::from(pull.a) * (unit * scratch.scale);
                    if with_potential {
                        // SAFETY: as above.
                        let phi = &mut unsafe { phi.part(k..k + 1) }[0];
                        *phi = pull.phi * unit;
                    }
                }
                count
            })
            .collect();
        counts.iter().fold(Count::default(), |sum, part| Count {
            targets: sum.targets + part.targets,
            interactions: sum.interactions + part.interactions,
        })
    }

    /// Pulls on the active targets of the group at node `home`, into `scratch`.
    fn solve<E: Real>(&self, scratch: &mut Scratch<E>, home: usize, potential: bool) -> Count {
        let node = &self.tree.nodes[home];
        scratch.targets.clear();
        scratch.slots.clear();
        let (mut lo, mut hi) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
        for i in node.range() {
            if self.slot[i] > 0 {
                let j = self.sources.before[i];
                let massive = self.sources.before[i + 1] > j;
                scratch.slots.push(self.slot[i] - 1);
                scratch.targets.push(Target {
                    x: self.x[i],
                    eps2: self.eps2[i],
                    source: if massive { j } else { NO_SOURCE },
                });
                (lo, hi) = (lo.inf(&self.x[i]), hi.sup(&self.x[i]));
            }
        }
        if scratch.targets.is_empty() {
            return Count::default();
        }
        let root = &self.tree.nodes[0];
        let whole = (root.hi - root.lo).norm();
        let unit = (0.5 * (hi - lo).norm()).max(1e-12 * whole);
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let closest = 1e-3;
        scratch.scale = 1.0 / unit;
        let frame = Frame {
            centre: 0.5 * (lo + hi),
            scale: scratch.scale,
            closest,
        };
        let region = Region {
            lo,
            hi,
            near: closest * unit,
            home,
        };
        let criterion = match (self.settings.method, self.settings.accuracy) {
            (Method::Direct, _) => Criterion::Never,
            (_, Accuracy::OpeningAngle(angle)) => Criterion::Angle(angle),
            (_, Accuracy::ForceError(error)) => {
                let scale = if self.debug_scale.is_empty() {
                    self.typical(scratch, frame, &region)
                } else {
                    let s: f64 = scratch
                        .slots
                        .iter()
                        .map(|&k| self.debug_scale[k as usize].powi(-2))
                        .sum();
                    (s / scratch.slots.len() as f64).powf(-0.5)
                };
                Criterion::Error(error * scale / (self.sources.total * self.settings.constant))
            }
        };
        scratch
            .lists
            .fill(&self.tree, &self.lenses, &region, criterion);
        scratch.pulls.clear();
        scratch
            .pulls
            .resize(scratch.targets.len(), Pull::default());
        let home = self.sources.of(node.range());
        let count = scratch.lists.count() + home.len();
        E::run(
            self.level,
            Group {
                frame,
                targets: &scratch.targets,
                home,
                lists: &scratch.lists,
                sources: &self.sources,
                moments: &self.moments,
                potential,
                blocks: &mut scratch.blocks,
                pulls: &mut scratch.pulls,
            },
        );
        let targets = scratch.targets.len() as u64;
        Count {
            targets,
            interactions: targets * count as u64,
        }
    }
}

impl Gravity {
    fn typical<E: Real>(&self, scratch: &mut Scratch<E>, frame: Frame, region: &Region) -> f64 {
        let knob = |n: &str, d: f64| std::env::var(n).map_or(d, |v| v.parse().unwrap());
        let samples = knob("SAMPLES", 8.0) as usize;
        let stride = scratch.targets.len().div_ceil(samples);
        scratch.sample.clear();
        scratch.sample.extend(scratch.targets.iter().step_by(stride));
        scratch
            .lists
            .fill(&self.tree, &self.lenses, region, Criterion::Widest);
        scratch.pulls.clear();
        scratch.pulls.resize(scratch.sample.len(), Pull::default());
        let home = self.sources.of(self.tree.nodes[region.home].range());
        E::run(
            self.level,
            Group {
                frame,
                targets: &scratch.sample,
                home,
                lists: &scratch.lists,
                sources: &self.sources,
                moments: &self.moments,
                potential: false,
                blocks: &mut scratch.blocks,
                pulls: &mut scratch.pulls,
            },
        );
        let s: f64 = scratch
            .pulls
            .iter()
            .map(|p| p.a.iter().map(|a| a * a).sum::<f64>().powi(-1))
            .sum();
        let unit = self.settings.constant * self.sources.total * frame.scale * frame.scale;
        unit * (s / scratch.pulls.len() as f64).powf(-0.5)
    }
}

/// What a thread works with.
struct Scratch<E> {
    targets: Vec<Target>,
    sample: Vec<Target>,
    slots: Vec<u32>,
    pulls: Vec<Pull>,
    scale: f64,
    lists: Lists,
    blocks: Blocks<E>,
}

impl<E: Real> Default for Scratch<E> {
    fn default() -> Self {
        Self {
            targets: Vec::new(),
            sample: Vec::new(),
            slots: Vec::new(),
            pulls: Vec::new(),
            scale: 1.0,
            lists: Lists::default(),
            blocks: Blocks::default(),
        }
    }
}
