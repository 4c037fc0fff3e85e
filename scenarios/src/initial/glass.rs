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

mod pairs;

use pairs::Candidates;

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
                self.gather(near, leaf as usize);
                // SAFETY: the ranges of leaves are disjoint.
                let sums = unsafe { parts.part(range.clone()) };
                self.sweep(range, near, sums);
            });
        self.sums = sums;
        self.adopt();
    }

    fn gather(&self, near: &mut Candidates, leaf: usize) {
        let node = &self.tree.nodes[leaf];
        near.clear(node.centre());
        self.tree.near(
            &self.domain,
            (node.lo, node.hi),
            self.extent[leaf],
            &self.extent,
            |j, shift| {
                let (x, support) = (&self.x[j.clone()], &self.support[j.clone()]);
                near.gather(x, shift, support, &self.pull[j]);
            },
        );
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
            let found = near.sums(inverse as f32);
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

#[cfg(test)]
mod tests {
    use nbody::points::random::{Purpose, stream};
    use rand::RngExt;

    use super::super::lattice::Block;
    use super::*;

    const SIZE: f64 = 1.3;

    fn box_of(axes: [bool; 3]) -> Domain {
        Domain::periodic(Vec3::repeat(SIZE)).with_axes(axes)
    }

    fn scattered(n: usize, domain: &Domain) -> Vec<Vec3> {
        let mut random = stream(3, Purpose::GasPositions, 0, 0);
        let mut any = || domain.in_plane(Vec3::from_fn(|_, _| SIZE * random.random::<f64>()));
        (0..n).map(|_| any()).collect()
    }

    /// n of the point at x, its support found by bisection: all from the definition.
    fn number_density(x: Vec3, all: &[Vec3], domain: &Domain) -> f64 {
        let d = domain.dimensions() as i32;
        let room = if d == 2 { PI } else { 4.0 / 3.0 * PI };
        let norm = if d == 2 { 7.0 / PI } else { 10.5 / PI };
        let kernel = |q: f64| norm * (1.0 - q).max(0.0).powi(4) * (1.0 + 4.0 * q);
        let sum = |support: f64| -> f64 {
            let part = |y: &Vec3| kernel(domain.nearest(y - x).norm() / support);
            all.iter().map(part).sum::<f64>() / support.powi(d)
        };
        let (mut lo, mut hi) = (0.05, 0.5 * SIZE);
        for _ in 0..45 {
            let middle = 0.5 * (lo + hi);
            if room * middle.powi(d) * sum(middle) < 64.0 {
                lo = middle
            } else {
                hi = middle
            }
        }
        sum(lo)
    }

    /// A density with a gradient, periodic.
    struct Wave;

    impl Density for Wave {
        fn density(&self, x: Vec3) -> f64 {
            (0.5 * (2.0 * PI * x.x / SIZE).sin()).exp()
        }

        fn log_gradient(&self, x: Vec3) -> Vec3 {
            Vec3::x() * (PI / SIZE * (2.0 * PI * x.x / SIZE).cos())
        }
    }

    #[test]
    fn force_is_the_gradient_of_the_energy() {
        for axes in [[true; 3], [true, true, false]] {
            let domain = box_of(axes);
            let n = 250;
            let volume = domain.volume() / n as f64;
            let mut glass = Glass::new(scattered(n, &domain), |_| volume, domain, &Wave);
            for _ in 0..30 {
                glass.measure();
            }
            for i in [0, 117, 249] {
                let n = number_density(glass.x[i], &glass.x, &domain);
                assert!((glass.density[i] / n - 1.0).abs() < 1e-5, "{n}");
                for axis in (0..3).filter(|&axis| axes[axis]) {
                    let energy = |d: f64| -> f64 {
                        let mut x = glass.x.clone();
                        x[i][axis] += d;
                        let one =
                            |&y: &Vec3| number_density(y, &x, &domain).ln() - Wave.density(y).ln();
                        x.iter().map(one).sum()
                    };
                    let d = 1e-4;
                    let exact = -(energy(d) - energy(-d)) / (2.0 * d);
                    let error = (glass.force[i][axis] - exact) * glass.support[i];
                    assert!(error.abs() < 1e-4, "{error} of {exact}");
                }
            }
        }
    }

    #[test]
    fn points_at_rest_have_the_wanted_density() {
        let domain = box_of([true; 3]);
        let block = Block::new(Vec3::zeros(), Vec3::repeat(SIZE));
        let x = block.glass(SIZE / 16.0, 1, Purpose::GasPositions);
        let mean = x.len() as f64 / domain.volume();
        let noise = |x: &[Vec3]| {
            let square = |i: usize| (number_density(x[i], x, &domain) / mean - 1.0).powi(2);
            ((0..100).map(|k| square(k * x.len() / 100)).sum::<f64>() / 100.0).sqrt()
        };
        let settled = noise(&x);
        assert!(settled < 0.02, "{settled}");
    }

    #[test]
    fn the_same_bits_for_any_number_of_threads() {
        let domain = box_of([true; 3]);
        let n = 3000;
        let volume = domain.volume() / n as f64;
        let settled = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a thread pool");
            pool.install(|| {
                let mut glass = Glass::new(scattered(n, &domain), |_| volume, domain, &Wave);
                glass.settle(12);
                (glass.x, glass.support)
            })
        };
        let one = settled(1);
        assert!([2, 7].into_iter().all(|threads| settled(threads) == one));
        assert!(
            one.0
                .iter()
                .all(|x| (0..3).all(|a| x[a] >= 0.0 && x[a] < SIZE))
        );
    }
}
