//! Turbulent stirring: a random walk of grains through gas whose turbulence nobody follows.
//!
//! d rho_d/dt = div[ D rho grad(rho_d/rho) ],   D = alpha c^2 / Omega / (1 + St^2),   St = t_stop Omega
//! as the walk   dx = [ D grad ln rho + grad D ] dt + sqrt(2 D) dW   (Ito), by Euler's method:
//!
//! without the two gradients grains would gather where gas is thin or turbulence weak; with them what is well mixed stays so, but for a part
//! of order alpha Omega dt. The stopping time in D is that of slow grains. Grains keep their motion relative to the orbits around them, so
//! that the walk feeds no epicycles; in a layer that settles, H_d = H sqrt(alpha / (alpha + St)) then holds at every St to order alpha St.
//! Sources: Dubrulle, Morfill & Sterzik (1995, Icarus 114, 237), eq. 35; Ciesla (2010, ApJ 723, 514), eqs 4 to 7; Charnoz et al. (2011, ApJ
//! 737, 33), eqs 16 and 17; the Schmidt number 1 + St^2: Youdin & Lithwick (2007, Icarus 192, 588).

use nbody::points::Vec3;

use crate::stopping::{Ambient, Sphere, StoppingLaw};

/// The gas around a grain and how it changes from place to place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    pub ambient: Ambient,
    /// Gradients of ln rho, ln c and ln Omega.
    pub log_rho: Vec3,
    pub log_c: Vec3,
    pub log_omega: Vec3,
}

/// Turbulence of the gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turbulence {
    /// Diffusion coefficient of the gas by c^2/Omega.
    pub alpha: f64,
    /// Gradient of alpha.
    pub slope: Vec3,
}

/// Change of the logarithms by which slopes of the stopping time are taken: their errors are of its square.
const APART: f64 = 1e-4;

impl Turbulence {
    /// Of the same alpha everywhere.
    pub fn uniform(alpha: f64) -> Self {
        Self {
            alpha,
            slope: Vec3::zeros(),
        }
    }

    /// D of a grain.
    pub fn diffusion(&self, law: &StoppingLaw, sphere: &Sphere, gas: &Ambient) -> f64 {
        let stokes = law.stopping_time(sphere, gas, 0.0) * gas.omega;
        self.alpha * gas.c * gas.c / gas.omega / (1.0 + stokes * stokes)
    }

    /// D and its gradient.
    fn diffusion_around(&self, law: &StoppingLaw, sphere: &Sphere, air: &Air) -> (f64, Vec3) {
        let along = |sign: f64, [rho, c, omega]: [f64; 3]| {
            let by = |part: f64| (sign * APART * part).exp();
            let gas = Ambient {
                rho: air.ambient.rho * by(rho),
                c: air.ambient.c * by(c),
                omega: air.ambient.omega * by(omega),
            };
            self.diffusion(law, sphere, &gas)
        };
        let slope = |axis| (along(1.0, axis) / along(-1.0, axis)).ln() / (2.0 * APART);
        let log = slope([1.0, 0.0, 0.0]) * air.log_rho
            + slope([0.0, 1.0, 0.0]) * air.log_c
            + slope([0.0, 0.0, 1.0]) * air.log_omega;
        let d = self.diffusion(law, sphere, &air.ambient);
        (d, d * log + d / self.alpha * self.slope)
    }

    /// How far a grain walks in `dt`; `gauss` are three independent normal numbers.
    pub fn walk(
        &self,
        law: &StoppingLaw,
        sphere: &Sphere,
        air: &Air,
        dt: f64,
        gauss: Vec3,
    ) -> Vec3 {
        if self.diffusion(law, sphere, &air.ambient) == 0.0 {
            // Gas too thin to carry it: D has no logarithm.
            return Vec3::zeros();
        }
        let (d, grad_d) = self.diffusion_around(law, sphere, air);
        (d * air.log_rho + grad_d) * dt + (2.0 * d * dt).sqrt() * gauss
    }
}

#[cfg(test)]
mod tests;
