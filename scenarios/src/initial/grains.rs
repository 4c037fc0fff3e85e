//! Dust superparticles that follow a gas disk or fill a block.
//!
//! Superparticles have equal masses. Radii follow dn/da ~ a^slope between min and max (slope -3.5 for a collisional cascade), so the mass
//! inside a is ~ a^(4 + slope) - min^(4 + slope); the k-th of n has the radius at the mass quantile (k + 1/2)/n. Which place gets which is
//! dealt out in turn along the points, so that every neighbourhood holds the whole distribution.

use dust::Superparticles;
use nbody::points::random::{Purpose, stream};
use nbody::points::{Columns, Vec3};

use super::disk::Disk;
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
                let ratio = match max / min {
                    f64::INFINITY => max.ln() - min.ln(),
                    finite => finite.ln(),
                };
                // min [1 + u ((max/min)^power - 1)]^(1/power), also for a power near zero.
                let grown = if power.abs() < 1e-8 {
                    u * ratio
                } else {
                    growth(u, power * ratio) / power
                };
                // Half at a time: the whole factor may be no number.
                let half = (0.5 * grown).exp();
                min * half * half
            }
        }
    }

    fn check(&self) {
        let sound = match *self {
            Self::One(radius) => radius >= 0.0,
            Self::PowerLaw { min, max, slope } => 0.0 < min && min <= max && slope.is_finite(),
        };
        assert!(
            sound,
            "radii of grains are not negative and ascend: {self:?}"
        );
    }
}

/// ln[1 + u (e^p - 1)], also where e^p is no number.
fn growth(u: f64, p: f64) -> f64 {
    if p > 500.0 && u > 0.0 {
        p + u.ln()
    } else {
        (u * p.exp_m1()).ln_1p()
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
        let x = Layer::new(disk, self.scale_height).pressed(self.particles, &mut random);
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

#[cfg(test)]
mod tests {
    use super::super::disk::tests::flat;
    use super::*;

    fn grains() -> Grains {
        Grains {
            particles: 8000,
            mass: 1e-6,
            sizes: Sizes::PowerLaw {
                min: 1e-3,
                max: 1.0,
                slope: -3.5,
            },
            material_density: 1.5,
            scale_height: 0.2,
        }
    }

    #[test]
    fn radii_follow_the_power_law_in_every_neighbourhood() {
        for slope in [-3.5, -4.0, -5.0] {
            let sizes = Sizes::PowerLaw {
                min: 1e-3,
                max: 1.0,
                slope,
            };
            // Mass between radii as an integral of a^3 dn.
            let mass = |from: f64, to: f64| -> f64 {
                let n = 20_000;
                let step = (to / from).ln() / f64::from(n);
                let at = |k: i32| from * ((f64::from(k) + 0.5) * step).exp();
                (0..n).map(|k| at(k).powf(slope + 4.0) * step).sum()
            };
            for u in [0.01, 0.3, 0.9] {
                let part = mass(1e-3, sizes.quantile(u)) / mass(1e-3, 1.0);
                assert!((part - u).abs() < 1e-6, "{part} {u}");
            }
            let radii = Grains { sizes, ..grains() }.radii(1000);
            let (few, u) = (&radii[488..520], 0.37);
            let below = few.iter().filter(|&&a| a < sizes.quantile(u)).count();
            // Thirty-two in a row differ from an even share by at most one and a half.
            assert!((below as f64 - 32.0 * u).abs() < 1.5, "{below}");
            let mut sorted = radii;
            sorted.sort_by(f64::total_cmp);
            for (k, a) in sorted.iter().enumerate() {
                assert!((a / sizes.quantile((k as f64 + 0.5) / 1000.0) - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn dust_follows_the_disk_in_its_own_thickness() {
        let disk = Disk {
            particles: 1000,
            outer_radius: 2.0,
            ..flat()
        };
        let co_moving = |x: Vec3, _: f64| disk.rotation(x, 0.0);
        let dust = grains().disk(&disk, Resolution::default(), 1, 50, co_moving);
        assert_eq!((dust.id[0], dust.id[7999]), (50, 8049));
        assert!((dust.m.iter().sum::<f64>() / 1e-6 - 1.0).abs() < 1e-12);
        assert!(dust.h.iter().all(|h| *h > 0.0) && dust.v[3] == disk.rotation(dust.x[3], 0.0));
        let height = |x: &Vec3| x.z / disk.scale_height(x.xy().norm());
        let rms = (dust.x.iter().map(|x| height(x).powi(2)).sum::<f64>() / 8000.0).sqrt();
        assert!((rms / 0.2 - 1.0).abs() < 0.02, "{rms}");
        let layer = Layer::new(&disk, 1.0);
        for u in [0.2, 0.5, 0.8] {
            let edge = layer.radius(u);
            let inside = dust.x.iter().filter(|x| x.xy().norm() < edge).count() as f64 / 8000.0;
            assert!((inside - u).abs() < 0.01, "{inside} {u}");
        }
        let one = Grains {
            particles: 1,
            ..grains()
        };
        let one = one.disk(&disk, Resolution::default(), 1, 0, co_moving);
        assert!(one.len() == 1 && one.non_finite().is_none());
        let sheet = Grains {
            scale_height: 0.0,
            particles: 500,
            ..grains()
        };
        let sheet = sheet.disk(&disk, Resolution::default(), 1, 0, co_moving);
        assert!(sheet.x.iter().all(|x| x.z.abs() < 1e-15) && sheet.non_finite().is_none());
    }
}
