//! Candidates: the gas near a small box, copied into short columns relative to the box.

use nbody::points::{Domain, Vec3};

use crate::Gas;

/// Gas particles that may be neighbours of points in a box.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    /// Origin of the coordinates.
    pub(super) centre: Vec3,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: Vec<f64>,
    pub(super) m: Vec<f64>,
    pub(super) volume: Vec<f64>,
    pub(super) index: Vec<u32>,
}

impl Candidates {
    pub fn len(&self) -> usize {
        self.index.len()
    }

    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Collects all gas within `reach` of the box [lo, hi], images included, and some beyond.
    pub fn gather(&mut self, gas: &Gas, domain: &Domain, lo: Vec3, hi: Vec3, reach: f64) {
        self.centre = 0.5 * (lo + hi);
        for column in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.m,
            &mut self.volume,
        ] {
            column.clear();
        }
        self.index.clear();
        let (mut lo, mut hi) = (lo, hi);
        for axis in (0..3).filter(|&axis| !domain.axes[axis]) {
            // Distances along a missing axis do not count.
            (lo[axis], hi[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
        gas.tree.near(domain, (lo, hi), reach, &[], |range, shift| {
            for j in range {
                let x = domain.in_plane(gas.particles.x[j] + shift - self.centre);
                self.x.push(x.x);
                self.y.push(x.y);
                self.z.push(x.z);
                self.m.push(gas.particles.m[j]);
                self.volume.push(gas.particles.m[j] / gas.derived.rho[j]);
                self.index.push(j as u32);
            }
        });
    }
}

/// Radius of the sphere (disc) that would hold `neighbours` particles if all gas were as dense as the leaf nearest to `x`.
pub(super) fn radius_by_nearest_leaf(gas: &Gas, domain: &Domain, x: Vec3, neighbours: f64) -> f64 {
    let tree = &gas.tree;
    let distance = |node: usize| {
        let n = &tree.nodes[node];
        domain
            .in_plane((n.lo - x).sup(&(x - n.hi)).sup(&Vec3::zeros()))
            .norm_squared()
    };
    let dimensions = domain.dimensions() as f64;
    let mut node = 0;
    let mut radius = 0.0;
    loop {
        let n = &tree.nodes[node];
        let size = n.hi - n.lo;
        let volume: f64 = (0..3)
            .filter(|&axis| domain.axes[axis])
            .map(|axis| size[axis])
            .product();
        let own = (0.25 * neighbours * volume / n.count() as f64).powf(1.0 / dimensions);
        if own > 0.0 {
            radius = own;
        }
        match tree.children(node) {
            Some((left, right)) if distance(left) <= distance(right) => node = left,
            Some((_, right)) => node = right,
            None => return radius + distance(node).sqrt(),
        }
    }
}
