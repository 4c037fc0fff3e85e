//! Dust strewn in a gas disk that is a formula: with its surface density, some part of its thickness, and the speed of its drift.
//!
//! Places are Halton's points (bases 3, 5, 7, 11), moved by a random shift that the seed sets: R at the quantile of the mass, any azimuth, and
//! heights of a Gaussian by Box & Muller (1958). They fill the disk more evenly than random points, and have no pattern.

use std::f64::consts::TAU;

use coupling::external::GasDisk;
use dust::{Sphere, StoppingLaw, Superparticles};
use nbody::points::Vec3;
use nbody::points::random::{Purpose, stream};
use rand::RngExt;

use super::grains::{Grains, Sizes};
use super::mirrored;

/// The ring of a disk that holds dust, and the star that it is about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring<'a> {
    pub disk: &'a GasDisk,
    pub inner_radius: f64,
    pub outer_radius: f64,
    /// G M of the star.
    pub gm: f64,
}

impl Ring<'_> {
    /// Mass of the gas in it.
    pub fn mass(&self) -> f64 {
        let (disk, power) = (self.disk, self.disk.slope + 2.0);
        let scaled = [self.inner_radius, self.outer_radius].map(|r| r / disk.reference_radius);
        let ratio = (scaled[1] / scaled[0]).ln();
        let grown = if power.abs() < 1e-8 {
            ratio
        } else {
            scaled[0].powf(power) * (power * ratio).exp_m1() / power
        };
        TAU * disk.surface_density * disk.reference_radius.powi(2) * grown
    }

    /// Radius inside of which the part `u` of the mass lies.
    fn radius(&self, u: f64) -> f64 {
        // Mass ~ R^(slope + 2), and that of grains of dn/da ~ a^s is ~ a^(s + 4).
        let law = Sizes::PowerLaw {
            min: self.inner_radius,
            max: self.outer_radius,
            slope: self.disk.slope - 2.0,
        };
        law.quantile(u)
    }
}

impl Grains {
    /// Superparticles strewn in `ring`, about a star at rest in the origin; they drift as `law` says for slow grains.
    pub fn strewn(
        &self,
        ring: &Ring,
        law: &StoppingLaw,
        seed: u64,
        first_id: u64,
    ) -> Superparticles {
        let mut random = stream(seed, Purpose::DustPositions, 0, 0);
        let shift: [f64; 4] = std::array::from_fn(|_| random.random());
        let place = |i: usize| {
            let [u, turn, height, phase] =
                std::array::from_fn(|k| (mirrored(i, [3, 5, 7, 11][k]) + shift[k]).fract());
            let r = ring.radius(u);
            let thickness = self.scale_height * ring.disk.aspect_ratio(r) * r;
            // 1 - u is never zero.
            let z = thickness * (-2.0 * (1.0 - height).ln()).sqrt() * (TAU * phase).cos();
            let (sin, cos) = (TAU * turn).sin_cos();
            Vec3::new(r * cos, r * sin, z)
        };
        let x = (0..self.particles).map(place).collect();
        let mut dust = self.block(x, first_id);
        for i in 0..dust.x.len() {
            let sphere = Sphere {
                radius: dust.grain_radius[i],
                density: dust.grain_density[i],
            };
            dust.v[i] = drift(ring, law, &sphere, dust.x[i]);
        }
        dust
    }
}

/// Velocity of a grain at `x`: of its drift, or where gas has no orbit that of circular motion.
fn drift(ring: &Ring, law: &StoppingLaw, sphere: &Sphere, x: Vec3) -> Vec3 {
    let moving = ring.disk.air(x, ring.gm).and_then(|air| {
        let stokes = law.stopping_time(sphere, &air.ambient, 0.0) * air.ambient.omega;
        ring.disk
            .drift(x, ring.gm, stokes)
            .filter(|_| stokes.is_finite())
    });
    moving.unwrap_or_else(|| {
        let circular = (ring.gm / x.norm().powi(3)).sqrt();
        circular * Vec3::new(-x.y, x.x, 0.0)
    })
}

#[cfg(test)]
mod tests {
    use coupling::external::Rotation;
    use nbody::points::Columns;

    use super::*;

    const DISK: GasDisk = GasDisk {
        surface_density: 2e-4,
        slope: -1.0,
        reference_radius: 2.0,
        aspect_ratio: 0.05,
        flaring: 0.25,
        inner_radius: 1.0,
        outer_radius: 4.0,
        rotation: Rotation::Pressure,
    };

    fn ring(disk: &GasDisk) -> Ring<'_> {
        Ring {
            disk,
            inner_radius: 1.2,
            outer_radius: 3.0,
            gm: 1.0,
        }
    }

    #[test]
    fn the_mass_of_a_ring_is_the_integral_of_its_surface_density() {
        for slope in [-2.0, -1.0, 0.5] {
            let disk = GasDisk { slope, ..DISK };
            let (n, ring) = (20_000, ring(&disk));
            let step = (ring.outer_radius - ring.inner_radius) / f64::from(n);
            let at = |k: i32| ring.inner_radius + (f64::from(k) + 0.5) * step;
            let sum: f64 = (0..n)
                .map(|k| TAU * at(k) * disk.surface_density(at(k)) * step)
                .sum();
            assert!((ring.mass() / sum - 1.0).abs() < 1e-8, "{slope}");
        }
    }

    #[test]
    fn strewn_dust_has_the_disk_s_profile_and_drifts() {
        let (ring, n) = (ring(&DISK), 8000);
        let grains = Grains {
            particles: n,
            mass: 1e-6,
            sizes: Sizes::One(1.0),
            material_density: 1.0,
            scale_height: 0.2,
        };
        let law = StoppingLaw::ConstantStokes(0.1);
        let dust = grains.strewn(&ring, &law, 1, 50);
        assert_eq!((dust.id[0], dust.id[n - 1]), (50, 8049));
        assert!((dust.m.iter().sum::<f64>() / 1e-6 - 1.0).abs() < 1e-12);
        assert!(dust.non_finite().is_none());
        for u in [0.2, 0.5, 0.8] {
            // Sigma ~ 1/R: the mass grows as R.
            let edge = 1.2 + 1.8 * u;
            let inside = dust.x.iter().filter(|x| x.xy().norm() < edge).count();
            let share = inside as f64 / n as f64;
            assert!((share - u).abs() < 1e-3, "{share} {u}");
        }
        let square =
            |x: &Vec3| (x.z / (0.2 * DISK.aspect_ratio(x.xy().norm()) * x.xy().norm())).powi(2);
        let rms = (dust.x.iter().map(square).sum::<f64>() / n as f64).sqrt();
        assert!((rms - 1.0).abs() < 0.003, "{rms}");
        let centre = dust.x.iter().sum::<Vec3>() / n as f64;
        assert!(centre.norm() < 5e-3, "{centre}");
        for (x, v) in dust.x.iter().zip(&dust.v) {
            let r = x.xy().norm();
            let h = DISK.aspect_ratio(r);
            if x.z.abs() > 0.2 * h * r {
                continue;
            }
            let inward = -(x.x * v.x + x.y * v.y) / r.sqrt();
            // 2 eta St/(1 + St^2) with eta = 2.75 h^2/2, 1.8 % less at 0.2 H.
            let expected = 2.75 * h * h * 0.1 / 1.01;
            assert!(
                (inward / expected - 1.0).abs() < 0.025,
                "{inward} {expected}"
            );
        }
    }
}
