//! Pairs at a kick: the hard parts of the pulls of bodies within their cut-off, which a field of all pulls has too many of.
//!
//! The hard part of the pull of j on i over m_j is G (1 - K(r/c)) d_ij/(r^2 + eps_i^2 + eps_j^2)^(3/2), c the larger cut-off of the two. The
//! pairs come from the same search as the clusters of the drift, with no step to go. Source: as the map's.

use super::Hybrid;
use super::changeover::soft_part;
use super::neighbours::Swarm;
use crate::bodies::{Bodies, Kind};
use crate::points::Vec3;

impl Hybrid {
    /// Takes the hard parts of all pairs but planets' off the accelerations `a` of bodies where they are now, with the cut-offs of
    /// [`Hybrid::choose`].
    pub fn soften(&mut self, bodies: &mut Bodies, g: f64) {
        self.take_off(bodies, g, false);
    }

    /// The same for all pairs, planets' too.
    pub fn soften_all(&mut self, bodies: &mut Bodies, g: f64) {
        self.take_off(bodies, g, true);
    }

    fn take_off(&mut self, bodies: &mut Bodies, g: f64, planets: bool) {
        let mut a = std::mem::take(&mut bodies.a);
        self.hard_parts(bodies, g, planets, |[i, j], pull| {
            a[i] -= pull * bodies.m[j];
            a[j] += pull * bodies.m[i];
        });
        bodies.a = a;
    }

    /// Adds the hard parts of all pairs to `pulls`, for bodies where they are now, with the cut-offs of [`Hybrid::choose`].
    pub fn add_hard(&mut self, bodies: &Bodies, g: f64, pulls: &mut [Vec3]) {
        self.hard_parts(bodies, g, true, |[i, j], pull| {
            pulls[i] += pull * bodies.m[j];
            pulls[j] -= pull * bodies.m[i];
        });
    }

    /// Gives the hard part of the pull of each pair that has one over the mass: on the first of the pair, towards the second.
    fn hard_parts(
        &mut self,
        bodies: &Bodies,
        g: f64,
        planets: bool,
        mut give: impl FnMut([usize; 2], Vec3),
    ) {
        self.neighbours.find(&Swarm {
            m: &bodies.m,
            x: &bodies.x,
            v: &bodies.v,
            cutoff: &bodies.cutoff,
            mu: 0.0,
            dt: 0.0,
        });
        for &[i, j] in &self.neighbours.pairs {
            let (i, j) = (i as usize, j as usize);
            let planet = |i: usize| !planets && bodies.kind[i] == Kind::Planet as u32;
            let d = bodies.x[j] - bodies.x[i];
            let c = bodies.cutoff[i].max(bodies.cutoff[j]);
            let (r2, eps) = (d.norm_squared(), [i, j].map(|i| bodies.softening[i]));
            if planet(i) || planet(j) || r2 >= c * c || r2 == 0.0 {
                continue;
            }
            let q2 = r2 + (eps[0] * eps[0] + eps[1] * eps[1]);
            let hard = 1.0 - soft_part((r2 / (c * c)).sqrt());
            give([i, j], d * (g * hard / (q2 * q2.sqrt())));
        }
    }
}
