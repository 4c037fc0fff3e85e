//! A well-mixed box of dust: everybody may meet everybody.

use dust::coagulation::{Coagulation, Kernel, Place};
use dust::porosity::Aggregate;
use dust::{Dust, Superparticles};
use nbody::points::Columns;
use nbody::points::random::{Purpose, stream};
use rand::RngExt;

/// Gas around all of it, and the orbital frequency.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    pub rho: f64,
    pub c: f64,
    pub omega: f64,
}

pub struct Mixed {
    dust: Dust,
    coagulation: Coagulation,
    volume: f64,
    omega: f64,
    now: f64,
    step: u64,
}

/// Grains that a swarm stands for at the start, so many that none outweighs its swarm.
const GRAINS: f64 = 1e40;

impl Mixed {
    /// Swarms of grains of unit mass, in unit number density, whose own masses are spread over a factor.
    pub fn monomers(kernel: Kernel, n: usize, spread: f64, seed: u64) -> Self {
        let radius = (0.75 / std::f64::consts::PI).cbrt();
        let mut space = Self::new(kernel, n, (radius, 1.0), seed);
        let mut random = stream(seed, Purpose::GrainSizes, 0, 0);
        for m in &mut space.dust.particles.m {
            *m = GRAINS * spread.powf(random.random());
        }
        space.volume = space.dust.particles.m.iter().sum();
        space
    }

    /// Swarms of equal mass with grains of a radius and a density, in gas of which they are the part `ratio`.
    pub fn grains(
        kernel: Kernel,
        n: usize,
        grain: (f64, f64),
        gas: Surroundings,
        ratio: f64,
    ) -> Self {
        let mut space = Self::new(kernel, n, grain, 1);
        space.dust.particles.m.fill(GRAINS);
        space.volume = GRAINS * n as f64 / (ratio * gas.rho);
        space.omega = gas.omega;
        let derived = &mut space.dust.derived;
        derived.rho_gas.fill(gas.rho);
        derived.c_gas = vec![gas.c; n];
        derived.slip.resize(n, Default::default());
        space
    }

    fn new(kernel: Kernel, n: usize, (radius, density): (f64, f64), seed: u64) -> Self {
        let mut particles = Superparticles {
            id: (0..n as u64).collect(),
            ..Superparticles::default()
        };
        particles.resize(n);
        particles.grain_radius.fill(radius);
        particles.grain_density.fill(density);
        Self {
            dust: Dust::new(particles),
            coagulation: Coagulation::new(kernel, seed),
            volume: 0.0,
            omega: 0.0,
            now: 0.0,
            step: 0,
        }
    }

    /// Lets grains collide until `time`, dealt out anew after every step.
    pub fn advance(&mut self, time: f64, dt: f64) {
        let omega = self.omega;
        let place = |_: usize| Place { omega, height: 0.0 };
        while self.now < time - 1e-6 * dt {
            let key = (self.coagulation.seed, self.step);
            (self.coagulation.cells).mix(self.dust.len(), self.volume, key);
            self.coagulation
                .advance(&mut self.dust, &place, dt, self.step);
            (self.now, self.step) = (self.now + dt, self.step + 1);
        }
    }

    /// Mass of a grain of swarm `i`.
    fn grain(&self, i: usize) -> f64 {
        let p = &self.dust.particles;
        Aggregate::new(p.grain_radius[i], p.grain_density[i]).m
    }

    /// Sum of number times mass^`power` over the grains, by their mass.
    pub fn moment(&self, power: f64) -> f64 {
        let m = &self.dust.particles.m;
        let sum: f64 = (0..m.len())
            .map(|i| m[i] * self.grain(i).powf(power - 1.0))
            .sum();
        sum / self.volume
    }

    /// Mean radius by mass.
    pub fn mean_radius(&self) -> f64 {
        let radius = &self.dust.particles.grain_radius;
        radius.iter().sum::<f64>() / radius.len() as f64
    }

    /// Radius below which a part of the mass is; of swarms of equal mass.
    pub fn quantile(&self, part: f64) -> f64 {
        let mut radius = self.dust.particles.grain_radius.clone();
        radius.sort_unstable_by(f64::total_cmp);
        radius[(part * radius.len() as f64) as usize]
    }
}

/// Mean and its standard error.
pub fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let square = values.map(|x| (x - mean).powi(2)).sum::<f64>();
    (mean, (square / (n - 1.0) / n).sqrt())
}
