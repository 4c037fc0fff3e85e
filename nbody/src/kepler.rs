//! The Kepler drift: a body on its exact two-body orbit about a fixed centre, any conic, any time step.
//!
//! x' = x + (f - 1) x + g v,  f - 1 = -mu G2/r0,  g = r0 G1 + eta G2, where s solves Kepler's equation in universal variables,
//! dt = r0 G1 + eta G2 + mu G3 with G_k(s) = s^k c_k(beta s^2), beta = 2 mu/r0 - v^2, eta = x.v.
//! The root is bracketed, so the search ends for any input; whole revolutions are taken off first.
//! Relative error: a few 1e-16 times the orbit's own condition number; coming in on a hyperbola with pericentre q, 1e-16 (r0/q)^2.
//! Source: Stumpff (1962); Danby (1988); Mikkola & Innanen (1999); Wisdom & Hernandez (2015) for g without G3.

pub mod abreast;
mod landing;
mod universal;

use std::f64::consts::PI;

use thiserror::Error;

use crate::points::Vec3;
use landing::{Constants, NEAR};
use universal::{shifted, universal};

/// Why a body has no Kepler orbit to drift along; the body is left as it was.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Refusal {
    #[error("stands or would stand at the very centre of the attracting mass")]
    Centre,
    #[error(
        "has a position, velocity or time step that is not a finite number, or too large to square"
    )]
    NonFinite,
}

/// Moves a body by `dt` along its orbit about a mass at the origin with G times mass `mu` >= 0.
///
/// A radial orbit bounces off the centre. With `mu` = 0 the motion is straight.
#[inline]
pub fn drift(mu: f64, dt: f64, x: &mut Vec3, v: &mut Vec3) -> Result<(), Refusal> {
    assert!(mu >= 0.0, "a centre attracts");
    if mu == 0.0 || dt == 0.0 {
        return straight(dt, x, v);
    }
    let r0 = x.norm();
    if r0 == 0.0 {
        return Err(Refusal::Centre);
    }
    let inverse = 1.0 / r0;
    let eta = x.dot(v);
    let beta = 2.0 * mu * inverse - v.norm_squared();
    if !(beta + eta + dt).is_finite() {
        return Err(Refusal::NonFinite);
    }
    let conic = Conic {
        mu,
        r0,
        inverse,
        eta,
        beta,
    };
    let [g0, g1, g2] = conic.anomaly(dt);
    let mut r = r0 * g0 + eta * g1 + mu * g2;
    let (f1, g) = (-mu * g2 * inverse, r0 * g1 + eta * g2);
    let there = *x + (*x * f1 + *v * g);
    if r.is_nan() || r <= 0.0 {
        // Next to the centre the terms of r cancel to rounding.
        r = there.norm();
    }
    let per_r = mu / r;
    let swift = *v - (*x * (per_r * inverse * g1) + *v * (per_r * g2));
    if (there.norm_squared() + swift.norm_squared()).is_finite() {
        (*x, *v) = if r < NEAR * r0 {
            let h = x.cross(v);
            Constants { mu, beta, h }.state(there, swift)
        } else {
            (there, swift)
        };
        Ok(())
    } else {
        Err(Refusal::Centre)
    }
}

/// Where an orbit with pericentre distance `q` and eccentricity `e` leads a time `t` after the pericentre: (x, y) and (vx, vy) in its
/// plane, x towards the pericentre.
pub(crate) fn from_pericentre(mu: f64, q: f64, e: f64, t: f64) -> ([f64; 2], [f64; 2]) {
    assert!(mu > 0.0 && q > 0.0 && e >= 0.0, "an orbit about a mass");
    let conic = Conic {
        mu,
        r0: q,
        inverse: 1.0 / q,
        eta: 0.0,
        beta: mu * (1.0 - e) / q,
    };
    let [_, g1, g2] = conic.anomaly(t);
    let h = (mu * q * (1.0 + e)).sqrt();
    let r = q + e * mu * g2;
    (
        [q - mu * g2, h * g1],
        [-mu * g1 / r, h * (1.0 - mu * g2 / r) / q],
    )
}

fn straight(dt: f64, x: &mut Vec3, v: &Vec3) -> Result<(), Refusal> {
    let there = *x + *v * dt;
    if !there.norm_squared().is_finite() {
        return Err(Refusal::NonFinite);
    }
    *x = there;
    Ok(())
}

/// What Kepler's equation needs to know of an orbit.
struct Conic {
    mu: f64,
    r0: f64,
    /// 1/r0
    inverse: f64,
    /// x.v
    eta: f64,
    /// mu/a: positive on ellipses.
    beta: f64,
}

/// More tries than halving a bracket to the last bit can need.
const TRIES: usize = 250;

impl Conic {
    /// G0, G1, G2 of the universal anomaly reached after `dt`.
    #[inline]
    fn anomaly(&self, dt: f64) -> [f64; 3] {
        let dt = self.within_half_period(dt);
        // Backwards in time is forwards along the mirrored orbit: s > 0 always.
        let sign = 1f64.copysign(dt);
        let mirrored = Self {
            eta: sign * self.eta,
            ..*self
        };
        let [g0, g1, g2] = mirrored.forward_anomaly(dt.abs());
        [g0, sign * g1, g2]
    }

    #[inline]
    fn within_half_period(&self, dt: f64) -> f64 {
        let half = PI * self.mu;
        if self.beta <= 0.0 || dt * dt * (self.beta * self.beta * self.beta) < half * half {
            return dt;
        }
        let period = 2.0 * half / (self.beta * self.beta.sqrt());
        dt - period * (dt / period).round()
    }

    #[inline]
    fn forward_anomaly(&self, dt: f64) -> [f64; 3] {
        let zeta = self.mu - self.beta * self.r0;
        let (mut lo, mut hi) = (0.0, f64::INFINITY);
        let mut s = match self.early_guess(dt) {
            Some(s) => s,
            None => {
                hi = self.bound(dt);
                self.late_guess(dt, hi)
            }
        };
        let mut found = universal(self.beta, s);
        for tries in 0..TRIES {
            let g = found.g;
            let terms = [self.r0 * g[1], self.eta * g[2], self.mu * g[3]];
            let miss = terms[0] + terms[1] + terms[2] - dt;
            let rounding = 2.0 * f64::EPSILON * (terms[0] + terms[1].abs() + terms[2]);
            if miss.abs() <= rounding && miss.is_finite() {
                break;
            }
            if miss < 0.0 {
                lo = s;
            } else {
                hi = s;
            }
            let slopes = [
                self.r0 * g[0] + self.eta * g[1] + self.mu * g[2],
                self.eta * g[0] + zeta * g[1],
                zeta * g[0] - self.beta * self.eta * g[1],
            ];
            let (newton, step) = steps(miss, slopes);
            if is_small(newton, slopes, self.beta) {
                return shifted(self.beta, &found, step);
            }
            if hi == f64::INFINITY {
                hi = self.bound(dt);
            }
            let next = s + step;
            let inside = next > lo && next < hi && (tries < 8 || tries % 2 == 0);
            let next = if inside { next } else { 0.5 * (lo + hi) };
            if next == s || next <= lo || next >= hi {
                break;
            }
            s = next;
            found = universal(self.beta, s);
        }
        let [g0, g1, g2, _] = found.g;
        [g0, g1, g2]
    }

    /// The series of s in dt, where it converges fast.
    #[inline]
    fn early_guess(&self, dt: f64) -> Option<f64> {
        let q = dt * self.inverse;
        let pull = self.mu * self.inverse;
        let speed = self.eta * self.inverse;
        // v^2 + mu/r0 in units of (r0/dt)^2: the angle of the step squared, about.
        let angle = (3.0 * pull - self.beta) * q * q;
        (angle < 1.2).then(|| {
            q * (1.0 - q * (0.5 * speed - q / 6.0 * (3.0 * speed * speed - pull + self.beta)))
        })
    }

    /// A value that s cannot exceed.
    fn bound(&self, dt: f64) -> f64 {
        let hi = if self.beta > 0.0 {
            2.0 * PI / self.beta.sqrt()
        } else {
            self.open_bound(dt)
        };
        hi.min(f64::MAX) * (1.0 + 1e-9)
    }

    /// What s cannot exceed on open orbits, since r'' = mu - beta r >= mu there and r >= 0.
    fn open_bound(&self, dt: f64) -> f64 {
        (2.0 * self.r0 / self.mu).sqrt() + (6.0 * dt / self.mu).cbrt()
    }

    /// A guess for long steps: Danby's (1988) for ellipses, the growing exponential alone for hyperbolas, half the bound near a parabola.
    fn late_guess(&self, dt: f64, hi: f64) -> f64 {
        let k = self.beta.abs().sqrt();
        let per_mu = 1.0 / self.mu;
        let e_cos = 1.0 - self.r0 * self.beta * per_mu;
        let e_sin = self.eta * k * per_mu;
        let mean = dt * k * self.beta.abs() * per_mu;
        let most = if self.beta > 0.0 { 0.02 } else { 1.0 };
        let guess = if (1.0 - e_cos).abs() < most && mean < most {
            0.5 * self.open_bound(dt)
        } else if self.beta > 0.0 {
            let anomaly = mean - e_sin;
            let (sin, cos) = anomaly.sin_cos();
            let side = (e_sin * cos + e_cos * sin).signum();
            (anomaly + side * 0.85 * (e_cos * e_cos + e_sin * e_sin).sqrt()) / k
        } else {
            (2.0 * mean / (e_cos + e_sin)).ln_1p() / k
        };
        if guess > 0.0 && guess < hi {
            guess
        } else {
            0.5 * hi
        }
    }
}

/// Newton's step towards the root in units of d1, and the step of fourth-order convergence (Danby 1988).
#[inline]
fn steps(miss: f64, [d1, d2, d3]: [f64; 3]) -> ([f64; 2], f64) {
    let inverse = 1.0 / d1;
    let newton = -miss * inverse;
    let halley = newton / (1.0 + 0.5 * newton * d2 * inverse);
    let step = newton / (1.0 + halley * inverse * (0.5 * d2 + halley * d3 / 6.0));
    ([newton, newton * inverse], step)
}

/// Whether a step is below 1e-4 of the lengths over which Kepler's equation bends, so that its own error is 1e-16.
#[inline]
fn is_small([step, bend]: [f64; 2], [_, d2, d3]: [f64; 3], beta: f64) -> bool {
    // Written so that a NaN is not small.
    (bend * d2).abs() < 1e-4 && (bend * step * d3).abs() < 1e-8 && beta.abs() * step * step < 1e-8
}

#[cfg(test)]
mod tests;
