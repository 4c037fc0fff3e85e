//! Dust superparticles that follow a gas disk or fill a block.
//!
//! Superparticles have equal masses. Radii follow dn/da ~ a^slope between min and max (slope -3.5 for a collisional cascade), so the mass
//! inside a is ~ a^(4 + slope) - min^(4 + slope); the k-th of n has the radius at the mass quantile (k + 1/2)/n. Which place gets which is
//! dealt out in turn along the points, so that every neighbourhood holds the whole distribution.

use dust::Superparticles;
use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Vec3};

use super::disk::Disk;
use super::glass::Density;
use super::layer::Layer;
use super::{Resolution, mirrored};

/// Radii of grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sizes {
    One(f64),
    /// dn/da ~ a^slope.
    PowerLaw {
        min: f64,
        max: f64,
        slope: f64,
    },
}

impl Sizes {
    /// The radius below which the part `u` of the mass lies.
    pub fn quantile(&self, u: f64) -> f64 {
        match *self {
            Self::One(radius) => radius,
            Self::PowerLaw { min, max, slope } => {
                let power = slope + 4.0;
                let ratio = (max / min).ln();
                // min [1 + u ((max/min)^power - 1)]^(1/power), also for a power near zero.
                let grown = if power.abs() < 1e-8 {
                    u * ratio
                } else {
                    (u * (power * ratio).exp_m1()).ln_1p() / power
                };
                min * grown.exp()
            }
        }
    }

    fn check(&self) {
        let sound = match *self {
            Self::One(radius) => radius > 0.0,
            Self::PowerLaw { min, max, slope } => 0.0 < min && min <= max && slope.is_finite(),
        };
        assert!(sound, "radii of grains are positive and ascend: {self:?}");
    }
}

/// Dust of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grains {
    pub particles: usize,
    /// Mass of all dust.
    pub mass: f64,
    pub sizes: Sizes,
    /// Density of a grain.
    pub material_density: f64,
    /// Scale height of the dust by the gas's.
    pub scale_height: f64,
}

impl Grains {
    /// Superparticles distributed as the gas of `disk`, flattened to the dust's own scale height, moving with `velocity(x, grain_radius)`.
    ///
    /// Smoothing lengths are those of the disk's gas at their places, zero without gas particles.
    pub fn disk(
        &self,
        disk: &Disk,
        resolution: Resolution,
        seed: u64,
        first_id: u64,
        velocity: impl Fn(Vec3, f64) -> Vec3,
    ) -> Superparticles {
        assert!(self.scale_height >= 0.0, "a scale height is not negative");
        let mut random = stream(seed, Purpose::DustPositions, 0, 0);
        let mut x = Layer::new(disk, self.scale_height).pressed(self.particles, &mut random);
        let centre = x.iter().sum::<Vec3>() / x.len().max(1) as f64;
        x.iter_mut().for_each(|x| *x -= centre);
        let mut dust = self.block(x, first_id);
        for i in 0..dust.x.len() {
            dust.v[i] = velocity(dust.x[i], dust.grain_radius[i]);
        }
        if disk.particles > 0 {
            let gas = Layer::new(disk, 1.0);
            let mass = gas.mass / disk.particles as f64;
            let h = |&x: &Vec3| resolution.smoothing_length(mass / gas.density(x), 3);
            dust.h = dust.x.iter().map(h).collect();
        }
        dust
    }

    /// Superparticles at rest at the points `x`; `particles` is not used.
    pub fn block(&self, x: Vec<Vec3>, first_id: u64) -> Superparticles {
        self.sizes.check();
        assert!(
            self.mass > 0.0 && self.material_density > 0.0,
            "masses and densities are positive"
        );
        let n = x.len();
        let mut dust = Superparticles {
            id: (first_id..).take(n).collect(),
            m: vec![self.mass / n as f64; n],
            x,
            grain_radius: self.radii(n),
            grain_density: vec![self.material_density; n],
            ..Superparticles::default()
        };
        dust.resize(n);
        dust
    }

    /// The n radii, dealt out so that any run of neighbours in the list has an even share of all.
    fn radii(&self, n: usize) -> Vec<f64> {
        let mut order: Vec<(f64, usize)> = (0..n).map(|i| (mirrored(i, 2), i)).collect();
        order.sort_unstable_by(|a, b| a.partial_cmp(b).expect("digits make a number"));
        let mut radii = vec![0.0; n];
        for (rank, &(_, i)) in order.iter().enumerate() {
            radii[i] = self.sizes.quantile((rank as f64 + 0.5) / n as f64);
        }
        radii
    }
}
