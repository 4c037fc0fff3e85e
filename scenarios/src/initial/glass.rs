//! A glass: points settled until the pressure of an isothermal SPH gas balances the gradient of a wanted density.
//!
//! E = sum_i ln(n_i / rho(x_i)),  n_i = sum_j W(r_ij, H_i),  V_d H_i^d n_i = 64 (Wendland C2, support H)
//! shift <- inertia * shift - pace * H^2 dE/dx,  x <- x + shift
//!
//! dE/dx is the force of Lagrangian SPH (with grad-h terms) at sound speed one in the potential -ln rho. So where the points come to rest,
//! the pressure that a simulation will feel is balanced, not only the analytic one. Densities in a force are those of the sweep before.
//! Points start near their place: a few tens of sweeps cure the noise between neighbours, not a wrong profile.

use std::f64::consts::PI;
use std::ops::Range;

use nbody::points::sort::{Cube, Curve};
use nbody::points::sum::Parts;
use nbody::points::{Domain, Tree, Vec3};
use rayon::prelude::*;

/// A wanted density.
pub trait Density: Sync {
    /// Density, up to a constant factor.
    fn density(&self, x: Vec3) -> f64;
    /// Gradient of the density's logarithm.
    fn log_gradient(&self, x: Vec3) -> Vec3;
}

/// The same density everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Uniform;

impl Density for Uniform {
    fn density(&self, _: Vec3) -> f64 {
        1.0
    }

    fn log_gradient(&self, _: Vec3) -> Vec3 {
        Vec3::zeros()
    }
}

const NEIGHBOURS: f64 = 64.0;
const LEAF: usize = 16;
/// Shift by H^2 times force, and what is left of a shift in the next; near the fastest that stays stable.
const PACE: f64 = 0.02;
const INERTIA: f64 = 0.7;
/// Longest shift by H.
const LONGEST: f64 = 0.05;
/// Sweeps between two sorts.
const RESORT: usize = 10;

/// Radius of the ball (disk in two dimensions) of a volume.
pub fn radius(volume: f64, dimensions: usize) -> f64 {
    (volume / ball(dimensions)).powf(1.0 / dimensions as f64)
}

fn ball(dimensions: usize) -> f64 {
    if dimensions == 2 { PI } else { 4.0 / 3.0 * PI }
}

/// What one sweep finds for a point.
#[derive(Clone, Copy, Debug)]
struct Sum {
    /// n
    density: f64,
    /// d ln n / d ln H
    slope: f64,
    force: Vec3,
}

/// Points on their way to rest.
#[derive(Debug)]
pub struct Glass<'a, D> {
    /// Positions, along the Morton curve of the last sort.
    pub x: Vec<Vec3>,
    /// Radius of each point's kernel.
    pub support: Vec<f64>,
    /// Number density of the last sweep.
    pub density: Vec<f64>,
    /// Force by pressure and wanted gradient of the last sweep.
    pub force: Vec<Vec3>,
    domain: Domain,
    target: &'a D,
    shift: Vec<Vec3>,
    /// 1 / (n Omega), and that by H^(d+2).
    weight: Vec<f64>,
    pull: Vec<f64>,
    sums: Vec<Sum>,
    tree: Tree,
    curve: Curve,
    extent: Vec<f64>,
}

impl<'a, D: Density> Glass<'a, D> {
    /// Points at rest, of which one takes up `volume(x)` where the density is as wanted.
    pub fn new(x: Vec<Vec3>, volume: impl Fn(Vec3) -> f64, domain: Domain, target: &'a D) -> Self {
        let n = x.len();
        let support: Vec<f64> = x
            .iter()
            .map(|&x| radius(NEIGHBOURS * volume(x), domain.dimensions()))
            .collect();
        let density: Vec<f64> = x.iter().map(|&x| 1.0 / volume(x)).collect();
        let zero = Sum {
            density: 0.0,
            slope: 0.0,
            force: Vec3::zeros(),
        };
        let mut glass = Self {
            weight: density.iter().map(|n| 1.0 / n).collect(),
            pull: vec![0.0; n],
            x,
            support,
            density,
            force: vec![Vec3::zeros(); n],
            domain,
            target,
            shift: vec![Vec3::zeros(); n],
            sums: vec![zero; n],
            tree: Tree::default(),
            curve: Curve::default(),
            extent: Vec::new(),
        };
        glass.sort();
        // The first sweeps find kernels and densities; nothing moves yet.
        for _ in 0..4 {
            glass.measure();
        }
        glass
    }

    /// Moves the points `sweeps` times; at the end kernels and densities belong to the last positions.
    pub fn settle(&mut self, sweeps: usize) {
        for sweep in 0..sweeps {
            if sweep % RESORT == 0 {
                self.sort();
            } else {
                self.tree.refit(&self.x);
            }
            self.measure();
            self.advance();
        }
        self.sort();
        for _ in 0..3 {
            self.measure();
        }
    }

    fn sort(&mut self) {
        self.curve.thread(&self.x, Cube::around(&self.x));
        let order = &self.curve.order;
        reorder(&mut self.x, order);
        reorder(&mut self.shift, order);
        reorder(&mut self.support, order);
        reorder(&mut self.density, order);
        reorder(&mut self.weight, order);
        self.tree.build(&self.x, &self.curve.keys, LEAF);
    }

    fn measure(&mut self) {
        let support = &self.support;
        self.tree.largest(|i| support[i], &mut self.extent);
        let power = -(self.domain.dimensions() as i32) - 2;
        for i in 0..self.x.len() {
            self.pull[i] = self.weight[i] * self.support[i].powi(power);
        }
        let mut sums = std::mem::take(&mut self.sums);
        let parts = Parts::new(&mut sums);
        self.tree
            .leaves
            .par_iter()
            .for_each_init(Candidates::default, |near, &leaf| {
                let range = self.tree.nodes[leaf as usize].range();
                near.gather(self, leaf as usize);
                // SAFETY: the ranges of leaves are disjoint.
                let sums = unsafe { parts.part(range.clone()) };
                self.sweep(range, near, sums);
            });
        self.sums = sums;
        self.adopt();
    }

    fn sweep(&self, range: Range<usize>, near: &mut Candidates, sums: &mut [Sum]) {
        let dimensions = self.domain.dimensions() as i32;
        let d = f64::from(dimensions);
        let norm = if dimensions == 2 {
            7.0 / PI
        } else {
            21.0 / (2.0 * PI)
        };
        for (i, sum) in range.zip(sums) {
            let inverse = 1.0 / self.support[i];
            near.select(self.x[i], self.support[i]);
            let found = near.pairs(inverse as f32);
            let own = found.own * self.pull[i];
            *sum = Sum {
                density: norm * inverse.powi(dimensions) * found.value,
                slope: -d + 20.0 * found.rim / found.value,
                force: 20.0 * norm * (own + found.others) + self.target.log_gradient(self.x[i]),
            };
        }
    }

    /// Takes over a sweep's densities and forces, and makes a Newton step towards the kernels' wanted neighbour number.
    fn adopt(&mut self) {
        let d = self.domain.dimensions() as f64;
        let wanted = NEIGHBOURS / ball(self.domain.dimensions());
        for (i, sum) in self.sums.iter().enumerate() {
            let grad_h = 1.0 + sum.slope / d;
            self.density[i] = sum.density;
            self.force[i] = sum.force;
            self.weight[i] = 1.0 / (grad_h.max(0.2) * sum.density);
            let excess = (self.support[i].powf(d) * sum.density / wanted).ln();
            self.support[i] *= (-excess / (d * grad_h.max(0.2))).clamp(-0.2, 0.2).exp();
        }
    }

    fn advance(&mut self) {
        for i in 0..self.x.len() {
            let h = self.support[i];
            let shift =
                INERTIA * self.shift[i] + PACE * h * h * self.domain.in_plane(self.force[i]);
            let longest = LONGEST * h;
            self.shift[i] = shift * (longest / shift.norm().max(longest));
            self.x[i] += self.shift[i];
            self.domain.wrap(&mut self.x[i]);
        }
    }
}

fn reorder<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
    *values = order.iter().map(|&i| values[i as usize]).collect();
}

/// Pairs that are summed side by side.
const LANES: usize = 8;

/// Sums over the pairs of a point: of (1-q)^4 (1+4q) and q^2 (1-q)^3 in its own kernel, and of the forces in its own and in the others'.
#[derive(Clone, Copy, Debug)]
struct Found {
    value: f64,
    rim: f64,
    own: Vec3,
    others: Vec3,
}

/// Points near a leaf, one coordinate a column, relative to the leaf's centre; and those of them near one point, relative to that.
/// Single precision: no length here is more than a few kernels.
#[derive(Debug, Default)]
struct Candidates {
    centre: Vec3,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    support: Vec<f32>,
    /// Weight of the point's own kernel gradient.
    pull: Vec<f32>,
    inside: Vec<bool>,
    near: Vec<u32>,
    pairs: [Vec<f32>; 5],
}

impl Candidates {
    fn gather<D: Density>(&mut self, glass: &Glass<D>, leaf: usize) {
        for column in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.support,
            &mut self.pull,
        ] {
            column.clear();
        }
        let node = &glass.tree.nodes[leaf];
        self.centre = node.centre();
        glass.tree.near(
            &glass.domain,
            (node.lo, node.hi),
            glass.extent[leaf],
            &glass.extent,
            |range, shift| {
                for j in range {
                    let x = glass.x[j] + shift - self.centre;
                    self.x.push(x.x as f32);
                    self.y.push(x.y as f32);
                    self.z.push(x.z as f32);
                    self.support.push(glass.support[j] as f32);
                    self.pull.push(glass.pull[j] as f32);
                }
            },
        );
        self.inside.resize(self.x.len(), false);
        self.near.resize(self.x.len() + 1, 0);
    }

    /// Leaves in `pairs` the separations dx, dy, dz, and inverse support and pull, of the points within either support.
    fn select(&mut self, x: Vec3, support: f64) {
        let n = self.x.len();
        let own = support as f32;
        let at = (x - self.centre).map(|c| c as f32);
        let (xs, ys, zs) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let (supports, inside) = (&self.support[..n], &mut self.inside[..n]);
        for j in 0..n {
            let (dx, dy, dz) = (at.x - xs[j], at.y - ys[j], at.z - zs[j]);
            let reach = if own > supports[j] { own } else { supports[j] };
            inside[j] = dx * dx + dy * dy + dz * dz < reach * reach;
        }
        let mut count = 0;
        for j in 0..n {
            // Without a branch: a guess would be wrong too often.
            self.near[count] = j as u32;
            count += usize::from(inside[j]);
        }
        for column in &mut self.pairs {
            column.clear();
        }
        for &j in &self.near[..count] {
            let j = j as usize;
            self.pairs[0].push(at.x - self.x[j]);
            self.pairs[1].push(at.y - self.y[j]);
            self.pairs[2].push(at.z - self.z[j]);
            self.pairs[3].push(1.0 / self.support[j]);
            self.pairs[4].push(self.pull[j]);
        }
        let full = count.next_multiple_of(LANES);
        for (column, out) in self
            .pairs
            .iter_mut()
            .zip([1.0, 0.0, 0.0, f32::INFINITY, 0.0])
        {
            column.resize(full, out);
        }
        // A filler at distance support is outside of the point's own kernel too.
        self.pairs[0][count..].fill(2.0 * own);
    }

    fn pairs(&self, inverse: f32) -> Found {
        let mut sums = [[0f32; LANES]; 8];
        let [x, y, z, inverses, pulls] = &self.pairs;
        let columns = x
            .chunks_exact(LANES)
            .zip(y.chunks_exact(LANES))
            .zip(z.chunks_exact(LANES))
            .zip(inverses.chunks_exact(LANES))
            .zip(pulls.chunks_exact(LANES));
        for ((((x, y), z), inverses), pulls) in columns {
            for k in 0..LANES {
                let r = (x[k] * x[k] + y[k] * y[k] + z[k] * z[k]).sqrt();
                let q = r * inverse;
                let rest = if q < 1.0 { 1.0 - q } else { 0.0 };
                let cube = rest * rest * rest;
                sums[0][k] += cube * rest * (1.0 + 4.0 * q);
                sums[1][k] += q * q * cube;
                let q = r * inverses[k];
                let rest = if q < 1.0 { 1.0 - q } else { 0.0 };
                let other = rest * rest * rest * pulls[k];
                sums[2][k] += cube * x[k];
                sums[3][k] += cube * y[k];
                sums[4][k] += cube * z[k];
                sums[5][k] += other * x[k];
                sums[6][k] += other * y[k];
                sums[7][k] += other * z[k];
            }
        }
        let total = |k: usize| f64::from(sums[k].iter().sum::<f32>());
        Found {
            value: total(0),
            rim: total(1),
            own: Vec3::new(total(2), total(3), total(4)),
            others: Vec3::new(total(5), total(6), total(7)),
        }
    }
}
