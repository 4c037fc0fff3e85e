//! Immersed particles: what drag needs to know of grains and of bodies.

use dust::{Dust, Sphere, StoppingLaw};
use nbody::Bodies;
use nbody::points::Vec3;

use crate::System;

/// Particles in gas, addressed by their place.
pub trait Immersed: Sync {
    fn position(&self, i: usize) -> Vec3;
    fn mass(&self, i: usize) -> f64;
    fn sphere(&self, i: usize) -> Sphere;
    /// `law` as it is for this particle.
    fn law(&self, i: usize, law: StoppingLaw) -> StoppingLaw;
    /// Orbital frequency; zero without a star.
    fn omega(&self, i: usize) -> f64;
    /// Particles from this on are bodies among grains.
    fn bodies(&self) -> u32 {
        u32::MAX
    }
    /// Velocity at this tick.
    fn velocity(&self, i: usize) -> Vec3;
    /// Acceleration by everything but drag, over the half step; none if that is not to be solved together with drag.
    fn acceleration(&self, i: usize) -> Option<Vec3>;
    /// Acceleration of the gas around by drag beyond what this particle makes it do, as it is expected; zero if nobody keeps it.
    fn excess(&self, _: usize) -> Vec3 {
        Vec3::zeros()
    }
    /// Takes what is to be expected of it next.
    fn keep_excess(&mut self, _: usize, _: Vec3) {}
    /// Smoothing length of the gas around; zero if unknown.
    fn smoothing(&self, i: usize) -> f64;
    /// Takes the smoothing length of the gas around, and the time in which sound and particle cross it.
    fn keep_smoothing(&mut self, i: usize, h: f64, crossing: f64);
    /// Takes the change of velocity, and notes stopping time and density of the gas around.
    fn push(&mut self, i: usize, dv: Vec3, t_stop: f64, rho_gas: f64);
    /// Whether the particles ask for the sound speed of the gas around, the velocity relative to it, or what to expect of it.
    fn asks(&self) -> bool {
        false
    }
    /// Is told these.
    fn hear(&mut self, _: usize, _c: f64, _slip: Vec3) {}
}

/// The star that orbital frequencies are about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Star {
    pub x: Vec3,
    /// G m; zero without a star
    pub gm: f64,
    /// orbital frequency everywhere, in a frame that turns with an orbit; else zero
    pub rate: f64,
}

impl Star {
    /// The star of a system, or the centre that its frame turns about.
    pub fn of(system: &System) -> Self {
        let at = system.seen.star_x.first().copied();
        at.map_or_else(
            || Self {
                rate: system.domain.hill().map_or(0.0, |hill| hill.rate),
                ..Self::default()
            },
            |x| Self {
                x,
                gm: system.g * system.star.m[0],
                rate: 0.0,
            },
        )
    }

    pub fn omega(&self, x: Vec3) -> f64 {
        if self.gm > 0.0 {
            (self.gm / (x - self.x).norm().powi(3)).sqrt()
        } else {
            self.rate
        }
    }
}

/// Dust in gas.
pub struct Grains<'a> {
    pub dust: &'a mut Dust,
    pub star: Star,
}

impl Immersed for Grains<'_> {
    fn position(&self, i: usize) -> Vec3 {
        self.dust.particles.x[i]
    }

    fn mass(&self, i: usize) -> f64 {
        self.dust.particles.m[i]
    }

    fn sphere(&self, i: usize) -> Sphere {
        Sphere {
            radius: self.dust.particles.grain_radius[i],
            density: self.dust.particles.grain_density[i],
        }
    }

    fn law(&self, i: usize, law: StoppingLaw) -> StoppingLaw {
        let own = self.dust.particles.stopping.get(i);
        own.map_or(law, |&own| law.with(own))
    }

    fn omega(&self, i: usize) -> f64 {
        self.star.omega(self.position(i))
    }

    fn velocity(&self, i: usize) -> Vec3 {
        self.dust.rates.v_pred[i]
    }

    fn acceleration(&self, i: usize) -> Option<Vec3> {
        Some(self.dust.rates.gravity[i])
    }

    fn excess(&self, i: usize) -> Vec3 {
        (self.dust.rates.excess.get(i).copied()).unwrap_or_default()
    }

    fn keep_excess(&mut self, i: usize, a: Vec3) {
        if let Some(excess) = self.dust.rates.excess.get_mut(i) {
            *excess = a;
        }
    }

    fn smoothing(&self, i: usize) -> f64 {
        self.dust.particles.h[i]
    }

    fn keep_smoothing(&mut self, i: usize, h: f64, crossing: f64) {
        self.dust.particles.h[i] = h;
        self.dust.derived.crossing[i] = crossing;
    }

    fn push(&mut self, i: usize, dv: Vec3, t_stop: f64, rho_gas: f64) {
        self.dust.particles.v[i] += dv;
        self.dust.rates.v_pred[i] += dv;
        let omega = self.omega(i);
        let stokes = if omega > 0.0 { t_stop * omega } else { 0.0 };
        let derived = &mut self.dust.derived;
        (derived.t_stop[i], derived.stokes[i], derived.rho_gas[i]) = (t_stop, stokes, rho_gas);
    }

    fn asks(&self) -> bool {
        !self.dust.derived.c_gas.is_empty() || !self.dust.rates.excess.is_empty()
    }

    fn hear(&mut self, i: usize, c: f64, slip: Vec3) {
        let derived = &mut self.dust.derived;
        if let (Some(c_gas), Some(u)) = (derived.c_gas.get_mut(i), derived.slip.get_mut(i)) {
            (*c_gas, *u) = (c, slip);
        }
    }
}

/// Bodies in gas. Their other accelerations belong to their own integrator.
pub struct BodiesInGas<'a> {
    pub bodies: &'a mut Bodies,
    /// Smoothing length of the gas around each body, kept from call to call; zero if unknown.
    pub h: &'a mut [f64],
    pub star: Star,
}

impl Immersed for BodiesInGas<'_> {
    fn position(&self, i: usize) -> Vec3 {
        self.bodies.x[i]
    }

    fn mass(&self, i: usize) -> f64 {
        self.bodies.m[i]
    }

    fn sphere(&self, i: usize) -> Sphere {
        let (radius, density) = (self.bodies.radius[i], self.bodies.mean_density(i));
        if radius > 0.0 && density > 0.0 {
            Sphere { radius, density }
        } else {
            // A point has no cross section.
            Sphere {
                radius: 1.0,
                density: f64::INFINITY,
            }
        }
    }

    fn law(&self, _: usize, law: StoppingLaw) -> StoppingLaw {
        law
    }

    fn omega(&self, i: usize) -> f64 {
        self.star.omega(self.position(i))
    }

    fn velocity(&self, i: usize) -> Vec3 {
        self.bodies.v[i]
    }

    fn acceleration(&self, _: usize) -> Option<Vec3> {
        None
    }

    fn smoothing(&self, i: usize) -> f64 {
        self.h[i]
    }

    fn keep_smoothing(&mut self, i: usize, h: f64, _: f64) {
        self.h[i] = h;
    }

    fn push(&mut self, i: usize, dv: Vec3, _: f64, _: f64) {
        self.bodies.v[i] += dv;
    }
}
