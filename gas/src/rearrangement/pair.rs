//! What a pair of particles does to each other in a rearrangement.
//!
//! f = C mu theta K(r/s) r,   K(q) = 20 sigma [ (1 - q/aR)^3 / (aR)^(d+2) - (1 - q/R)^3 / R^(d+2) ],   brackets zero where negative
//!
//! between sites that repel each other; between those that have potentials the law of [`super::continuity`].
//!
//! K is -s^(d+2) phi' / r of the kernel C2 of Wendland, s the smaller one of the pair's. Exchange: the mean gradient along r; of u no more
//! than the pair differs, and no more than the pair's smaller: it stays positive.

use nbody::points::{Domain, Vec3};

use super::site::Site;
use crate::kernel::{Kernel, WendlandC2};
use crate::{Hydro, KernelKind};

/// R: how far the kernel reaches, in mean distances of particles.
pub(super) const REACH: f64 = 2.5;
/// a: the reach of the repulsive part by R.
const INNER: f64 = 0.7;
/// C: with it the shortest waves of the disorder of a hexagonal lattice fall by 1.1 theta, those of six times its spacing by 0.06 theta.
const PACE: f64 = 0.25;

/// What the first of a pair receives, times its mass; the second receives the opposite.
pub(super) struct Pair {
    pub shift: Vec3,
    pub impulse: Vec3,
    pub heat: f64,
}

/// What a pair's shift by its separation is.
enum Bell {
    /// Strengths of the two parts of K.
    Repulsion([f64; 2]),
    Potential(KernelKind),
}

/// The law of pairs of a scene.
pub(super) struct Law {
    domain: Domain,
    bell: Bell,
    free: bool,
}

impl Law {
    /// Of sites that repel each other.
    pub fn repulsion(hydro: &Hydro) -> Self {
        let d = hydro.dimensions();
        let part = |reach: f64| PACE * 20.0 * WendlandC2::norm(d) / reach.powi(d as i32 + 2);
        let bell = Bell::Repulsion([part(INNER * REACH), part(REACH)]);
        Self::new(hydro, bell)
    }

    /// Of sites that have potentials.
    pub fn potential(hydro: &Hydro) -> Self {
        Self::new(hydro, Bell::Potential(hydro.kernel))
    }

    fn new(hydro: &Hydro, bell: Bell) -> Self {
        Self {
            domain: hydro.domain,
            bell,
            free: hydro.eos.is_free(),
        }
    }

    /// A pair's shift by its separation, at the square of the distance; none beyond its reach.
    #[inline]
    fn strength(&self, a: &Site, b: &Site, square: f64) -> Option<f64> {
        match self.bell {
            Bell::Repulsion(strength) => {
                let reach = a.reach.min(b.reach);
                if square >= reach * reach {
                    return None;
                }
                let q = REACH * square.sqrt() / reach;
                let part =
                    |strength: f64, reach: f64| strength * (1.0 - q / reach).max(0.0).powi(3);
                let bell = part(strength[0], INNER * REACH) - part(strength[1], REACH);
                let mass = 2.0 * a.m * b.m / (a.m + b.m);
                Some(mass * a.share * b.share * bell)
            }
            Bell::Potential(kernel) => {
                let reach = a.reach.max(b.reach);
                let part = |of: &Site, r: f64| of.push * kernel.slope((r / of.reach).min(1.0));
                let strength = |r: f64| -a.m * b.m * (part(a, r) + part(b, r));
                let moves = square < reach * reach && a.share > 0.0 && b.share > 0.0;
                moves.then(|| strength(square.sqrt()))
            }
        }
    }

    /// The pair of two sites, `r` from the second to the first; none beyond its reach.
    #[inline]
    pub fn pair(&self, a: &Site, b: &Site, r: Vec3) -> Option<Pair> {
        let r = self.domain.in_plane(r);
        let k = self.strength(a, b, r.norm_squared())?;
        let slope = 0.5 * (a.grad_w + b.grad_w) * r;
        let heat = if self.free {
            let slope = 0.5 * (a.grad_u + b.grad_u).dot(&r);
            let most = a.u.min(b.u).max(0.0);
            supported(slope * slope, slope * (a.u - b.u)) * slope.clamp(-most, most)
        } else {
            0.0
        };
        Some(Pair {
            shift: k * r,
            impulse: k * slope,
            heat: k * heat,
        })
    }
}

/// The part of a slope that a difference supports, from their product and the slope's square.
fn supported(square: f64, product: f64) -> f64 {
    if square > 0.0 {
        (product / square).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
