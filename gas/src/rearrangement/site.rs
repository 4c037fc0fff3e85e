//! Sites: what a particle is before a shift, and the gradients around it.
//!
//! grad v = [sum w (v_j - v_i) r^T] [sum w r r^T]^-1: exact for linear fields

use nalgebra::Matrix3;
use nbody::points::Vec3;
use nbody::points::sum::Parts;

use super::each;
use super::pair::REACH;
use crate::kernel::unit_sphere;
use crate::{Gas, Hydro};

/// One-sidedness, the distance of the neighbours' centre by their reach, from which on a particle is at an edge; that of a half space is 0.21.
const EDGE: f64 = 0.15;

/// The least determinant of the neighbours' spread by s^2: on a plane in space it is zero, inside gas about 0.08 (0.18 in the plane).
const THIN: f64 = 1e-3;

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Site {
    pub x: Vec3,
    /// Velocity relative to the shear of the frame.
    pub w: Vec3,
    /// The velocity that the particle has drifted with, not yet closed.
    pub v: Vec3,
    pub u: f64,
    pub m: f64,
    /// Mean distance of particles, and how far a site sees others.
    pub s: f64,
    pub reach: f64,
    /// From 1 inside of gas to 0 at its edges; of repelling sites times the root of 1 - exp(-strength |S| dt).
    pub share: f64,
    /// Potential by density, and the factor of the kernel's slope; zero of repelling sites.
    pub push: f64,
    pub grad_w: Matrix3<f64>,
    pub grad_u: Vec3,
}

/// What is around a site.
struct Surroundings {
    grad_w: Matrix3<f64>,
    grad_u: Vec3,
    /// From 1 inside of gas to 0 at its edges.
    inside: f64,
}

/// Finds the sites of all gas.
pub(super) fn survey(sites: &mut Vec<Site>, gas: &Gas, hydro: &Hydro) {
    let (domain, p, r) = (&hydro.domain, &gas.particles, &gas.rates);
    let d = hydro.dimensions();
    let spacing = hydro.support() * (unit_sphere(d) / hydro.neighbours).powf(1.0 / d as f64);
    sites.clear();
    sites.extend((0..gas.len()).map(|i| Site {
        x: p.x[i],
        w: domain.relative(p.x[i], r.v_pred[i]),
        v: p.v[i],
        u: r.u_pred[i],
        m: p.m[i],
        s: spacing * p.h[i],
        reach: REACH * spacing * p.h[i],
        ..Site::default()
    }));
    let mut found = vec![(Matrix3::zeros(), Vec3::zeros(), 0.0); sites.len()];
    let parts = Parts::new(&mut found);
    each(&gas.tree, domain, (sites, &[], 0.0), |i, near| {
        let around = surroundings(sites, i, near, hydro);
        // SAFETY: each particle is visited once.
        unsafe { parts.part(i..i + 1)[0] = (around.grad_w, around.grad_u, around.inside) };
    });
    for (site, (grad_w, grad_u, inside)) in sites.iter_mut().zip(found) {
        (site.grad_w, site.grad_u, site.share) = (grad_w, grad_u, inside);
    }
}

/// Makes sites repel each other, by `strain` times the shear.
pub(super) fn repel(sites: &mut [Site], hydro: &Hydro, strain: f64) {
    let (rate, d) = (hydro.domain.shear_rate(), hydro.dimensions());
    let stream = Matrix3::new(0.0, 0.0, 0.0, -rate, 0.0, 0.0, 0.0, 0.0, 0.0);
    for site in sites {
        let rate = strain * shear(site.grad_w + stream, d);
        site.share *= (1.0 - (-rate).exp()).sqrt();
    }
}

/// |S| = sqrt(2 S:S) of the trace-free symmetric part: the gradient of v in a plain shear.
fn shear(gradient: Matrix3<f64>, dimensions: usize) -> f64 {
    let part = 0.5 * (gradient + gradient.transpose());
    let trace = part.trace();
    (2.0 * (part.norm_squared() - trace * trace / dimensions as f64).max(0.0)).sqrt()
}

fn surroundings(sites: &[Site], i: usize, near: &[(u32, Vec3)], hydro: &Hydro) -> Surroundings {
    let (own, domain) = (&sites[i], &hydro.domain);
    let (mut total, mut first) = (0.0, Vec3::zeros());
    let (mut spread, mut w, mut u) = (Matrix3::zeros(), Matrix3::zeros(), Vec3::zeros());
    for &(j, x) in near {
        let r = domain.in_plane(x - own.x);
        let square = r.norm_squared();
        if square < own.reach * own.reach {
            let q = square.sqrt() / own.reach;
            let other = &sites[j as usize];
            let weight = (1.0 - q).powi(4) * (1.0 + 4.0 * q);
            let arm = weight * r;
            total += weight;
            first += arm;
            spread += arm * r.transpose();
            w += (other.w - own.w) * arm.transpose();
            u += (other.u - own.u) * arm;
        }
    }
    for axis in (0..3).filter(|&axis| !domain.axes[axis]) {
        spread[(axis, axis)] = total * own.s * own.s;
    }
    let scale = total * own.s * own.s;
    let sided = first.norm() / (EDGE * total * own.reach);
    let enough = spread.determinant() > THIN * scale.powi(3) && sided < 1.0;
    match spread.try_inverse().filter(|_| enough) {
        Some(inverse) => Surroundings {
            grad_w: w * inverse,
            grad_u: inverse * u,
            inside: 1.0 - sided * sided,
        },
        None => Surroundings {
            grad_w: Matrix3::zeros(),
            grad_u: Vec3::zeros(),
            inside: 0.0,
        },
    }
}
