//! Self-gravity of all populations at once: a = -G sum_j m_j d_ij / (d_ij^2 + eps_i^2 + eps_j^2)^(3/2), by a tree or by all pairs.
//!
//! Particles are threaded along the Morton curve; a binary tree over them carries mass, centre of mass, softening and second moments.
//! Groups of up to 64 targets share one walk and one list of nodes and particles (Barnes 1990), which vectorised kernels sum in f32
//! relative to the group, or in f64 if the wanted error is tight. A node is taken whole where the estimated error of its
//! acceleration is below a fixed part of the acceleration of the group, so the error asked for is nearly the error obtained.
//! Nodes end with their quadrupoles. Octupoles, with twice the operations a node, would take these parts of the time of the sums at the same
//! rms error (1e5 particles): annulus 1.3 at 1e-4, 1.2 at 1e-5, 1.1 at 1e-6, 1 at 1e-7; Plummer sphere 1 at 1e-4, 0.7 at 1e-5, 0.6 at 1e-6.

use fearless_simd::Level;
use rayon::prelude::*;

use crate::points::sort::{Cube, Curve, MANY};
use crate::points::sum::Parts;
use crate::points::{Tree, Vec3};

mod cluster;
mod direct;
mod kernel;
mod lanes;
mod moments;
mod sources;
mod walk;

use cluster::{Cluster, Scene};
use lanes::Real;
use moments::Moment;
use sources::Sources;
use walk::{Criterion, Forest, Lens};

/// Most targets in a group.
pub const GROUP: usize = 128;
/// Most particles in a cluster: groups that share the upper part of their walk.
const CLUSTER: usize = 8 * GROUP;
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

/// One over a softened distance of this square; points at one place give each other nothing, neither pull nor potential.
pub fn per_distance(q2: f64) -> f64 {
    if q2 > 0.0 { 1.0 / q2.sqrt() } else { 0.0 }
}

/// What a call did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Count {
    pub targets: u64,
    /// pairs of a target and a particle or node
    pub interactions: u64,
}

/// Errors below this are beyond f32: its rounding alone makes an rms error of 5e-7.
const SINGLE: f64 = 2e-6;

/// Largest error of a node's acceleration, in units of the target's, that makes an rms error of `error`: two power laws, measured on an
/// annulus and a Plummer sphere of 1e5 particles, whose rms errors are between 0.55 and 1 of the wanted one.
fn tolerance(error: f64) -> f64 {
    let ratio = error / 1.92e-4;
    1e-4 * ratio.powf(if ratio < 1.0 { 1.48 } else { 1.13 })
}

/// The number of sources up to which all pairs cost less than the tree, measured on the same two cases: 1400 to 3500 for an error
/// of 1e-3, 4500 to 13 000 for 1e-5, and not much else for a few targets alone.
fn crossover(error: f64) -> f64 {
    2000.0 * (1e-3 / error).powf(0.3)
}

/// The solver: what it knows of the particles since the last [`Gravity::build`] or [`Gravity::refit`].
pub struct Gravity {
    settings: Settings,
    level: Level,
    curve: Curve,
    tree: Tree,
    groups: Vec<u32>,
    clusters: Vec<u32>,
    sources: Sources,
    moments: Vec<Moment>,
    lenses: Vec<Lens>,
    /// for each of the caller's particles one more than its number among the active, or zero
    turn: Vec<u32>,
    /// pairs within this length are summed in f64
    resolved: f64,
}

impl Gravity {
    pub fn new(settings: Settings) -> Self {
        let positive = match settings.accuracy {
            Accuracy::ForceError(value) | Accuracy::OpeningAngle(value) => value > 0.0,
        };
        assert!(positive, "an accuracy above zero");
        Self {
            settings,
            level: Level::new(),
            curve: Curve::default(),
            tree: Tree::default(),
            groups: Vec::new(),
            clusters: Vec::new(),
            sources: Sources::default(),
            moments: Vec::new(),
            lenses: Vec::new(),
            turn: Vec::new(),
            resolved: 0.0,
        }
    }

    /// Has pairs of particles that are not further apart than `length` summed in f64, for those who take parts of their force off again.
    pub fn resolve(&mut self, length: f64) {
        self.resolved = length;
    }

    /// The rms relative error that the settings amount to, roughly if they give an opening angle.
    fn wanted_error(&self) -> f64 {
        match (self.settings.method, self.settings.accuracy) {
            (Method::Direct, _) => 0.0,
            (_, Accuracy::ForceError(error)) => error,
            (_, Accuracy::OpeningAngle(angle)) => 0.02 * angle.powi(4),
        }
    }

    /// Separation, in units of the group's size, below which rounded coordinates would spoil a pair's force.
    fn closest(&self) -> f64 {
        let error = self.wanted_error();
        if error < SINGLE {
            1e-9
        } else {
            (2e-6 / error).clamp(1e-3, 5e-2)
        }
    }

    /// Threads the particles, builds the tree and its moments. Particles without mass feel, but do not pull.
    pub fn build(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        self.curve.thread(x, Cube::around(x));
        self.take(x, m, softening);
        let bounds = |range| self.sources.bounds(range);
        self.tree.build_within(&self.curve.keys, LEAF, &bounds);
        if x.len() > MANY {
            self.curve.keys = Vec::new();
        }
        self.group();
        self.weigh();
    }

    /// Takes the same particles, moved a little: new boxes and moments, but the order and the tree of the last build.
    pub fn refit(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        assert_eq!(
            x.len(),
            self.curve.order.len(),
            "the particles of the last build"
        );
        self.take(x, m, softening);
        self.tree.refit_within(&|range| self.sources.bounds(range));
        self.weigh();
    }

    fn take(&mut self, x: &[Vec3], m: &[f64], softening: &[f64]) {
        assert_eq!(x.len(), m.len(), "a mass a particle");
        assert_eq!(x.len(), softening.len(), "a softening length a particle");
        self.sources.take(&self.curve.order, x, m, softening);
    }

    /// Groups are the nodes of at most [`GROUP`] particles whose parent has more; likewise clusters.
    fn group(&mut self) {
        for (parts, most) in [(&mut self.groups, GROUP), (&mut self.clusters, CLUSTER)] {
            parts.clear();
            let mut i = 0;
            while let Some(node) = self.tree.nodes.get(i) {
                if node.count() <= most {
                    parts.push(i as u32);
                    i = node.skip as usize;
                } else {
                    i += 1;
                }
            }
        }
    }

    fn weigh(&mut self) {
        moments::refresh(&self.tree, &self.sources, &mut self.moments);
        let by_error = matches!(self.settings.accuracy, Accuracy::ForceError(_));
        walk::prepare(
            &self.tree,
            &self.sources,
            &self.moments,
            by_error,
            &mut self.lenses,
        );
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
        self.turn.clear();
        self.turn.resize(self.curve.order.len(), 0);
        for (k, &i) in active.iter().enumerate() {
            self.turn[i as usize] = k as u32 + 1;
        }
        let count = if self.wanted_error() < SINGLE {
            self.sweep::<f64>(acceleration, potential)
        } else {
            self.sweep::<f32>(acceleration, potential)
        };
        assert_eq!(
            count.targets as usize,
            active.len(),
            "a particle is active once"
        );
        count
    }

    fn sweep<E: Real>(&self, acceleration: &mut [Vec3], potential: &mut [f64]) -> Count {
        let all_pairs = match self.settings.method {
            Method::Direct => true,
            Method::Tree => false,
            Method::Automatic => self.sources.count() as f64 <= crossover(self.wanted_error()),
        };
        let (criterion, tolerance) = match self.settings.accuracy {
            _ if all_pairs => (Criterion::Never, 0.0),
            Accuracy::OpeningAngle(angle) => (Criterion::Angle(angle), 0.0),
            Accuracy::ForceError(error) => (Criterion::Widest, tolerance(error)),
        };
        let scene = Scene {
            forest: Forest {
                tree: &self.tree,
                lenses: &self.lenses,
            },
            sources: &self.sources,
            moments: &self.moments,
            order: &self.curve.order,
            turn: &self.turn,
            groups: &self.groups,
            criterion,
            tolerance,
            potential: !potential.is_empty(),
            closest: self.closest(),
            resolved: self.resolved,
            level: self.level,
        };
        let unit = self.settings.constant * self.sources.total;
        let (a, phi) = (Parts::new(acceleration), Parts::new(potential));
        let counts: Vec<Count> = self
            .clusters
            .par_iter()
            .map_init(Cluster::<E>::default, |cluster, &home| {
                cluster.solve(&scene, home as usize, |k, pull| {
                    let k = k as usize;
                    // SAFETY: each particle is in one cluster, and `field` checks that it is active once.
                    let a = &mut unsafe { a.part(k..k + 1) }[0];
                    *a = Vec3::from(pull.a) * unit;
                    if scene.potential {
                        // SAFETY: as above.
                        let phi = &mut unsafe { phi.part(k..k + 1) }[0];
                        *phi = pull.phi * unit;
                    }
                })
            })
            .collect();
        counts.iter().fold(Count::default(), |sum, part| Count {
            targets: sum.targets + part.targets,
            interactions: sum.interactions + part.interactions,
        })
    }
}

#[cfg(test)]
mod tests;
