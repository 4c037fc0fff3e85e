//! An analytic gas disk about the star: power laws of the distance R from the axis, z being the height.
//!
//! Sigma = Sigma_0 (R/R_0)^p, H/R = h = h_0 (R/R_0)^f between two radii; c = h v_K, so T ~ R^q with q = 2 f - 1;
//! rho = Sigma/(sqrt(2 pi) H) exp(-z^2/2H^2); v^2 = v_K^2 [1 + (p + f - 2) h^2 + q (1 - R/sqrt(R^2 + z^2))], v_K^2 = G M/R.
//! The mass of the disk does not pull. The Gaussian holds for z << R.
//! Source: Takeuchi & Lin (2002, ApJ 581, 1344), eq. 2-7; Nelson, Gressel & Umurhan (2013, MNRAS 435, 2610), eq. 13.

use std::f64::consts::TAU;

use dust::{Air, Ambient};
use nbody::points::Vec3;

/// How the gas turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation {
    /// In balance with the pressure of the profile.
    Pressure,
    /// At (1 - eta) v_K everywhere.
    Headwind(f64),
}

/// A disk of gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GasDisk {
    /// At the reference radius.
    pub surface_density: f64,
    pub slope: f64,
    pub reference_radius: f64,
    /// H/R at the reference radius.
    pub aspect_ratio: f64,
    pub flaring: f64,
    pub inner_radius: f64,
    pub outer_radius: f64,
    pub rotation: Rotation,
}

/// The gas at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    pub rho: f64,
    /// Isothermal sound speed.
    pub c: f64,
    /// Orbital frequency of circular motion.
    pub omega: f64,
    /// Velocity about the star.
    pub v: Vec3,
}

impl GasDisk {
    /// Sigma at a distance from the star; zero beyond the edges.
    pub fn surface_density(&self, r: f64) -> f64 {
        if self.inner_radius <= r && r <= self.outer_radius {
            self.surface_density * (r / self.reference_radius).powf(self.slope)
        } else {
            0.0
        }
    }

    /// H/R.
    pub fn aspect_ratio(&self, r: f64) -> f64 {
        self.aspect_ratio * (r / self.reference_radius).powf(self.flaring)
    }

    /// Square of the gas's speed in units of the circular one, at height z = `tilt` R.
    pub fn rotation(&self, r: f64, tilt: f64) -> f64 {
        match self.rotation {
            Rotation::Headwind(eta) => (1.0 - eta) * (1.0 - eta),
            Rotation::Pressure => {
                let h = self.aspect_ratio(r);
                let q = 2.0 * self.flaring - 1.0;
                1.0 + (self.slope + self.flaring - 2.0) * h * h + q * (1.0 - 1.0 / 1f64.hypot(tilt))
            }
        }
    }

    /// The gas at `x` from a star of G M = `gm`; none beyond the edges, and so far above the midplane that pressure leaves no orbit.
    pub fn at(&self, x: Vec3, gm: f64) -> Option<Gas> {
        let r = x.x.hypot(x.y);
        let sigma = self.surface_density(r);
        if sigma == 0.0 {
            return None;
        }
        let square = self.rotation(r, x.z / r);
        if square < 0.0 {
            return None;
        }
        let circular = (gm / r).sqrt();
        let h = self.aspect_ratio(r);
        let height = x.z / (h * r);
        Some(Gas {
            rho: sigma / (TAU.sqrt() * h * r) * (-0.5 * height * height).exp(),
            c: h * circular,
            omega: circular / r,
            v: Vec3::new(-x.y, x.x, 0.0) * (circular * square.sqrt() / r),
        })
    }

    /// The gas at `x` as grains in it see it, with its gradients; none where [`GasDisk::at`] has none.
    pub fn air(&self, x: Vec3, gm: f64) -> Option<Air> {
        let gas = self.at(x, gm)?;
        let r = x.x.hypot(x.y);
        let out = Vec3::new(x.x, x.y, 0.0) / (r * r);
        let h = self.aspect_ratio(r) * r;
        let (height, widening) = (x.z / h, 1.0 + self.flaring);
        let along = self.slope + widening * (height * height - 1.0);
        Some(Air {
            ambient: Ambient {
                rho: gas.rho,
                c: gas.c,
                omega: gas.omega,
            },
            log_rho: along * out - height / h * Vec3::z(),
            log_c: (self.flaring - 0.5) * out,
            log_omega: -1.5 * out,
        })
    }

    /// Velocity about the star of a grain that drifts with `stokes` where gas turns as [`GasDisk::at`] has it, but for settling
    /// (Nakagawa, Sekiya & Hayashi 1986, without the reaction of the dust).
    pub fn drift(&self, x: Vec3, gm: f64, stokes: f64) -> Option<Vec3> {
        let gas = self.at(x, gm)?;
        let r = x.x.hypot(x.y);
        let along = Vec3::new(-x.y, x.x, 0.0) / r;
        let circular = (gm / x.norm().powi(3)).sqrt() * r;
        // Of the gas, against grains.
        let lag = (circular - gas.v.dot(&along)) / (1.0 + stokes * stokes);
        let out = Vec3::new(x.x, x.y, 0.0) / r;
        Some((circular - lag) * along - 2.0 * stokes * lag * out)
    }
}
