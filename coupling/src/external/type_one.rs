//! Type-I migration: torque, and damping of eccentricity and inclination, by the density waves that a low-mass body raises in a disk.
//!
//! dv/dt = -v/t_m - 2 (v.r) r/(r^2 t_e) - 2 v_z/t_i, at the body's osculating a, e, i; Sigma ~ r^-p, h = H/r, k = e/h, j = i/h:
//!   1/t_wave = (m/M) (Sigma a^2/M) h^-4 Omega;  L/t_m is the torque (1.364 + 0.541 p) (m/M h)^2 Sigma a^4 Omega^2 / P
//!   P = [1 + (k/2.25)^1.2 + (k/2.84)^6] / [1 - (k/2.02)^4] + sign (0.070 j + 0.085 j^4 - 0.080 k j^2)
//!   t_e = t_wave/0.780 (1 - 0.14 k^2 + 0.06 k^3 + 0.18 k j^2);  t_i = t_wave/0.544 (1 - 0.30 j^2 + 0.24 j^3 + 0.14 k^2 j)
//! Three-dimensional, locally linear, globally isothermal; no gap, no saturation. Bodies that are not bound, without mass, or whose a
//! lies beyond the disk's edges feel nothing. The factor 2 of the vertical term makes i decay at 1/t_i.
//! Source: Tanaka, Takeuchi & Ward (2002, ApJ 565, 1257), eq. 70; Tanaka & Ward (2004, ApJ 602, 388), eq. 45, 49; Cresswell & Nelson
//! (2008, A&A 482, 677), eq. 9-13.

use nbody::points::Vec3;

use super::disk::GasDisk;
use super::{Change, Law, Target};

/// Torques of a disk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TypeOne {
    pub disk: GasDisk,
}

/// Inverse times in which angular momentum, eccentricity and inclination fall by e.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    pub angular_momentum: f64,
    pub eccentricity: f64,
    pub inclination: f64,
}

/// Shape of an orbit against the disk's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    pub semi_major_axis: f64,
    pub eccentricity: f64,
    pub inclination: f64,
}

impl Shape {
    /// The osculating orbit; none if it is not bound.
    fn of(x: Vec3, v: Vec3, mu: f64) -> Option<Self> {
        let r = x.norm();
        let binding = 2.0 / r - v.norm_squared() / mu;
        let momentum = x.cross(&v);
        (binding > 0.0).then(|| Self {
            semi_major_axis: 1.0 / binding,
            eccentricity: (v.cross(&momentum) / mu - x / r).norm(),
            inclination: momentum.x.hypot(momentum.y).atan2(momentum.z),
        })
    }
}

impl TypeOne {
    /// The rates for a body of mass `m` about a star of mass `star`, on an orbit of this shape.
    pub fn rates(&self, shape: &Shape, m: f64, star: f64, g: f64) -> Rates {
        let a = shape.semi_major_axis;
        let (sigma, h) = (self.disk.surface_density(a), self.disk.aspect_ratio(a));
        let omega = (g * star / (a * a * a)).sqrt();
        let wave = m / star * (sigma * a * a / star) * omega / h.powi(4);
        let (k, j) = (shape.eccentricity / h, shape.inclination / h);
        // 1/P has no pole where P has one.
        let inverse =
            (1.0 - (k / 2.02).powi(4)) / (1.0 + (k / 2.25).powf(1.2) + (k / 2.84).powi(6));
        let tilt = 0.070 * j + 0.085 * j.powi(4) - 0.080 * k * j * j;
        Rates {
            angular_momentum: (1.364 - 0.541 * self.disk.slope) * h * h * wave * inverse
                / (1.0 + tilt * inverse.abs()),
            eccentricity: 0.780 * wave / (1.0 - 0.14 * k * k + 0.06 * k.powi(3) + 0.18 * k * j * j),
            inclination: 0.544 * wave / (1.0 - 0.30 * j * j + 0.24 * j.powi(3) + 0.14 * k * k * j),
        }
    }

    fn rates_at(&self, target: &Target, v: Vec3) -> Option<Rates> {
        let shape = Shape::of(target.x, v, target.g * (target.star_mass + target.m))?;
        Some(self.rates(&shape, target.m, target.star_mass, target.g))
    }
}

impl Rates {
    /// The velocity `v` at `x` after `span` at these rates: a symmetric product of three exact decays.
    fn decayed(&self, x: Vec3, v: Vec3, span: f64) -> Vec3 {
        let r = x.normalize();
        let radial = |v: Vec3| v + r * (v.dot(&r) * (-self.eccentricity * span).exp_m1());
        let mut v = radial(v);
        v.z *= (-2.0 * self.inclination * span).exp();
        radial(v) * (-self.angular_momentum * span).exp()
    }
}

impl Law for TypeOne {
    const NAME: &'static str = "type-one migration";

    fn change(&self, target: &Target, span: f64) -> Change {
        if target.m == 0.0 {
            return Change::default();
        }
        // Midpoint rule: the rates hang on the velocity.
        let (x, v) = (target.x, target.v);
        let middle = self
            .rates_at(target, v)
            .and_then(|rates| self.rates_at(target, rates.decayed(x, v, 0.5 * span)));
        Change {
            dv: middle.map_or_else(Vec3::zeros, |rates| rates.decayed(x, v, span) - v),
            heat: 0.0,
        }
    }
}
