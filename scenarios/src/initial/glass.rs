//! A glass: points settled until the pressure of an isothermal SPH gas balances the gradient of a wanted density.
//!
//! E = sum_i ln(n_i / rho(x_i)),  n_i = sum_j W(r_ij, H_i),  V_d H_i^d n_i = 64 (Wendland C2, support H)
//! shift <- inertia * shift - pace * H^2 / (1 + pace * H^2 k / 2) dE/dx,  x <- x + shift,  k = -d^2 ln rho / dx^2 where that is large
//!
//! dE/dx is the force of Lagrangian SPH (with grad-h terms) at sound speed one in the potential -ln rho, by the sweeps of the gas itself. So
//! where the points come to rest, the pressure that a simulation will feel is balanced, not only the analytic one.
//! Points start near their place: a few tens of sweeps cure the noise between neighbours, not a wrong profile.

use std::f64::consts::PI;

use gas::{Eos, Gas, Hydro, Particles, Precision, Viscosity};
use nbody::points::sum::CHUNK;
use nbody::points::{Clock, Columns, Domain, Vec3};
use rayon::prelude::*;

/// A wanted density.
pub trait Density: Sync {
    /// Gradient of the density's logarithm; and minus its slope along each axis where kernels may be wider than what falls there, else zero.
    fn log_gradient(&self, x: Vec3) -> [Vec3; 2];
}

/// The same density everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Uniform;

impl Density for Uniform {
    fn log_gradient(&self, _: Vec3) -> [Vec3; 2] {
        [Vec3::zeros(); 2]
    }
}

const NEIGHBOURS: f64 = 64.0;
/// Shift by H^2 times force, and what is left of a shift in the next; near the fastest that stays stable.
const PACE: f64 = 0.07;
const INERTIA: f64 = 0.4;
/// Longest shift by H.
const LONGEST: f64 = 0.1;
/// Sweeps between two sorts.
const RESORT: usize = 10;

/// Radius of the ball (disk in two dimensions) of a volume.
pub fn radius(volume: f64, dimensions: usize) -> f64 {
    let ball = if dimensions == 2 { PI } else { 4.0 / 3.0 * PI };
    (volume / ball).powf(1.0 / dimensions as f64)
}

/// Points on their way to rest.
#[derive(Debug)]
pub struct Glass<'a, D> {
    /// The points as gas of mass and sound speed one; `v` is the last shift, and predicted velocities are zero.
    gas: Gas,
    hydro: Hydro,
    target: &'a D,
}

impl<'a, D: Density> Glass<'a, D> {
    /// Points at rest, of which one takes up `volume(x)` where the density is as wanted.
    pub fn new(x: Vec<Vec3>, volume: impl Fn(Vec3) -> f64, domain: Domain, target: &'a D) -> Self {
        let eos = Eos::Isothermal {
            sound_speed: 1.0,
            gamma: 2.0,
        };
        let hydro = Hydro {
            precision: Precision::Single,
            neighbours: NEIGHBOURS,
            viscosity: Viscosity::None,
            ..Hydro::new(domain, eos)
        };
        let d = domain.dimensions();
        let h = |&x: &Vec3| radius(NEIGHBOURS * volume(x), d) / hydro.support();
        let n = x.len();
        let mut particles = Particles {
            h: x.iter().map(h).collect(),
            m: vec![1.0; n],
            x,
            ..Particles::default()
        };
        particles.resize(n);
        let gas = Gas::new(particles);
        let mut glass = Self { gas, hydro, target };
        glass.measure();
        glass
    }

    /// Moves the points `sweeps` times; at the end kernels belong to the last positions.
    pub fn settle(&mut self, sweeps: usize) {
        for sweep in 0..sweeps {
            if sweep > 0 {
                self.measure();
            }
            self.push();
            self.advance();
            if sweep % RESORT == RESORT - 1 {
                self.gas.sort();
            } else {
                self.gas.tree.refit(&self.gas.particles.x);
            }
        }
        self.gas.sort();
        self.measure();
    }

    /// Positions, and the radius of each point's kernel.
    pub fn points(self) -> (Vec<Vec3>, Vec<f64>) {
        let (support, Particles { x, mut h, .. }) = (self.hydro.support(), self.gas.particles);
        h.iter_mut().for_each(|h| *h *= support);
        (x, h)
    }

    /// Kernels and densities of the points where they are.
    fn measure(&mut self) {
        let found = (self.gas).density(&self.hydro, &Clock::standing(0.0), Vec3::zeros());
        found.expect("points at finite places have kernels");
    }

    /// Pressure forces.
    fn push(&mut self) {
        let clock = Clock::standing(0.0);
        self.gas.forces(&self.hydro, &clock, &clock);
    }

    /// Minus the gradient of E for point i, and the density's own part of its slope.
    fn force(&self, i: usize) -> [Vec3; 2] {
        let [wanted, slope] = self.target.log_gradient(self.gas.particles.x[i]);
        let pressure = self.hydro.domain.in_plane(self.gas.rates.hydro[i]);
        [pressure + wanted, slope]
    }

    /// Where the points are, and the forces that they feel there.
    #[cfg(test)]
    pub fn forces(&mut self) -> Vec<(Vec3, Vec3)> {
        self.push();
        let one = |i| (self.gas.particles.x[i], self.force(i)[0]);
        (0..self.gas.len()).map(one).collect()
    }

    fn advance(&mut self) {
        let shift = |i: usize| {
            let particles = &self.gas.particles;
            let support = self.hydro.support() * particles.h[i];
            let [force, slope] = self.force(i);
            let pace = slope.map(|slope| {
                let pace = PACE * support * support;
                pace / (1.0 + 0.5 * pace * slope)
            });
            let shift = INERTIA * particles.v[i] + pace.component_mul(&force);
            let longest = LONGEST * support;
            shift * (longest / shift.norm().max(longest))
        };
        let points = (0..self.gas.len()).into_par_iter().with_min_len(CHUNK);
        let shifts: Vec<Vec3> = points.map(shift).collect();
        let particles = &mut self.gas.particles;
        for (x, shift) in particles.x.iter_mut().zip(&shifts) {
            *x += shift;
            self.hydro.domain.wrap(x);
        }
        particles.v = shifts;
    }
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
        let near: Vec<f64> = (all.iter().map(|y| domain.nearest(y - x).norm()))
            .filter(|r| *r < 0.5 * SIZE)
            .collect();
        let sum = |support: f64| -> f64 {
            near.iter().map(|r| kernel(r / support)).sum::<f64>() / support.powi(d)
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

    impl Wave {
        fn log_density(x: Vec3) -> f64 {
            0.5 * (2.0 * PI * x.x / SIZE).sin()
        }
    }

    impl Density for Wave {
        fn log_gradient(&self, x: Vec3) -> [Vec3; 2] {
            let slope = PI / SIZE * (2.0 * PI * x.x / SIZE).cos();
            [Vec3::x() * slope, Vec3::zeros()]
        }
    }

    #[test]
    fn force_is_the_gradient_of_the_energy() {
        for axes in [[true; 3], [true, true, false]] {
            let domain = box_of(axes);
            let n = 250;
            let volume = domain.volume() / n as f64;
            let mut glass = Glass::new(scattered(n, &domain), |_| volume, domain, &Wave);
            // Finer than settling asks for: force and difference are of one kernel.
            glass.hydro.tolerance = 1e-6;
            glass.measure();
            glass.push();
            let all = glass.gas.particles.x.clone();
            for i in [0, 117, 249] {
                let n = number_density(all[i], &all, &domain);
                let support = glass.hydro.support() * glass.gas.particles.h[i];
                let error = support / radius(64.0 / n, domain.dimensions()) - 1.0;
                assert!(error.abs() < 3e-6, "{error}");
                for axis in (0..3).filter(|&axis| axes[axis]) {
                    let energy = |d: f64| -> f64 {
                        let mut x = all.clone();
                        x[i][axis] += d;
                        let one =
                            |&y: &Vec3| number_density(y, &x, &domain).ln() - Wave::log_density(y);
                        x.iter().map(one).sum()
                    };
                    let d = 1e-4;
                    let exact = -(energy(d) - energy(-d)) / (2.0 * d);
                    let error = (glass.force(i)[0][axis] - exact) * support;
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
                glass.points()
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
