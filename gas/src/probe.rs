//! Gas at any point: density, velocity, sound speed; the window through which grains and bodies see the gas.
//!
//! rho(x) = sum_j m_j W(|x_j - x|, h), with h such that (4 pi/3) H^3 sum_j W = neighbours (pi H^2 in two dimensions), H the radius of the
//! kernel (Wendland C2). A field f is f(x) = sum_j w_j f_j with the weights of [`Weights`], exact for fields that are linear in space.
//! Points further than 1.5 of the largest h (sqrt(2) in two dimensions) from all gas see none: density 0. Gradients are least squares over the
//! neighbours, f_j against r_j with weights |w_j|: exact for linear fields too, also at an edge.

mod bundle;
mod candidates;
mod near;
mod weights;

use nalgebra::Matrix3;
use nbody::points::{Domain, Vec3};

pub use bundle::{Bundle, Lanes, Rows};
pub use candidates::Candidates;
pub use weights::{Leverage, Shape, Weights, radius};

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

/// Gas at a point with its gradients, by its particles' own densities and pressures instead of a sum at the point: exact for linear fields
/// wherever the weights are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// How the weights came about: `Linear` inside the gas, `Empty` without any.
    pub shape: Shape,
    pub rho: f64,
    pub v: Vec3,
    pub p: f64,
    /// Gradient of the density, and dv_i/dx_j in row i and column j; not numbers where the gas near the point fills no volume.
    pub grad_rho: Vec3,
    pub grad_v: Matrix3<f64>,
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

    /// Gas at `x` with gradients; `guess` as in [`Probe::sample`].
    pub fn local(
        &mut self,
        gas: &Gas,
        domain: &Domain,
        (x, guess): (Vec3, f64),
        reach: &Reach,
    ) -> Local {
        let weights = &mut self.weights;
        weights.find(&mut self.candidates, gas, domain, (x, guess), reach);
        let (rho, v) = (&gas.derived.rho, &gas.rates.v_pred);
        let lost = (Vec3::repeat(f64::NAN), Matrix3::repeat(f64::NAN));
        let (grad_rho, grad_v) = weights.leverage(domain).map_or(lost, |leverage| {
            let rows =
                [0, 1, 2].map(|i| weights.gradient(domain, &leverage, |j| v[j][i]).transpose());
            let grad_rho = weights.gradient(domain, &leverage, |j| rho[j]);
            (grad_rho, Matrix3::from_rows(&rows))
        });
        Local {
            shape: weights.shape,
            rho: weights.scalar(|j| rho[j]),
            v: weights.vector(|j| v[j]),
            p: weights.scalar(|j| gas.derived.p[j]),
            grad_rho,
            grad_v,
            h: weights.h,
        }
    }

    /// A scalar field of the gas at the point that was sampled last.
    pub fn scalar(&self, field: impl Fn(usize) -> f64) -> f64 {
        self.weights.scalar(field)
    }
}

/// Square of the isothermal sound speed of gas particle j, by its own temperature whatever sum its pressure is.
pub fn isothermal(gas: &Gas, j: usize) -> f64 {
    let solved = !gas.derived.content.is_empty();
    let ratio = gas.derived.p_ratio.get(j).filter(|_| !solved);
    let ratio = ratio.copied().unwrap_or(1.0);
    gas.derived.p[j] / (gas.derived.rho[j] * ratio)
}

#[cfg(test)]
mod tests;
