//! Gas at any point: density, velocity, sound speed; the window through which grains and bodies see the gas.
//!
//! rho(x) = sum_j m_j W(|x_j - x|, h), with h such that (4 pi/3) H^3 sum_j W = neighbours (pi H^2 in two dimensions), H the radius of the
//! kernel (Wendland C2). A field f is f(x) = sum_j w_j f_j with the weights of [`Weights`], exact for fields that are linear in space.
//! Points further than the largest H from all gas see none: density 0.

mod candidates;
mod near;
mod weights;

use nbody::points::{Domain, Vec3};

pub use candidates::Candidates;
pub use weights::{Shape, Weights, radius};

use crate::Gas;

/// How far points look for gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// wanted smooth number of gas neighbours
    pub neighbours: f64,
    /// largest smoothing length
    pub largest: f64,
}

/// Gas at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// density
    pub rho: f64,
    /// velocity predicted to now
    pub v: Vec3,
    /// acceleration by everything but drag and the frame
    pub a: Vec3,
    /// isothermal sound speed
    pub c: f64,
    /// smoothing length used
    pub h: f64,
}

/// Samples gas point by point; a set of neighbouring points is served faster by [`Candidates`] and [`Weights`] themselves.
#[derive(Clone, Debug, Default)]
pub struct Probe {
    candidates: Candidates,
    weights: Weights,
}

impl Probe {
    /// Gas at `x`; `guess` is the smoothing length to start from, zero if unknown.
    pub fn sample(
        &mut self,
        gas: &Gas,
        domain: &Domain,
        x: Vec3,
        guess: f64,
        reach: &Reach,
    ) -> Sample {
        let weights = &mut self.weights;
        weights.find(&mut self.candidates, gas, domain, (x, guess), reach);
        // Neighbours may be images: relative to the shear these have the same velocity.
        let relative = |j: usize| domain.relative(gas.particles.x[j], gas.rates.v_pred[j]);
        let v = weights.vector(relative);
        let stream = domain.hill().map_or(0.0, |hill| hill.stream(x));
        Sample {
            rho: weights.rho,
            v: Vec3::new(v.x, v.y + stream, v.z),
            a: weights.vector(|j| gas.acceleration(j)),
            c: weights.positive(|j| isothermal(gas, j)).sqrt(),
            h: weights.h,
        }
    }
}

/// Square of the isothermal sound speed of gas particle j, by its own temperature whatever sum its pressure is.
pub fn isothermal(gas: &Gas, j: usize) -> f64 {
    let ratio = gas.derived.p_ratio.get(j).copied().unwrap_or(1.0);
    gas.derived.p[j] / (gas.derived.rho[j] * ratio)
}

#[cfg(test)]
mod tests;
