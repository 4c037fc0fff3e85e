//! Rearrangement: particles of sheared gas are moved towards order, by position and not by force; the fields stay where they are.
//!
//! m_i dx_i = sum_j f_ij,   f_ij = C mu_ij theta_ij s^2 (-grad phi),   phi = W(r, a R) - W(r, R),   theta = 1 - exp(-strength |S| dt)
//! m_i dv_i = sum_j f_ij . (grad v_i + grad v_j) / 2,   u alike
//!
//! s: mean distance of particles by h; mu: harmonic mean of masses; S: shear by linear-exact gradients, so gas that does not shear is
//! left alone. phi is repulsive near, attractive far, and its integral is zero: uniform gas is not pressed apart, a gradient of density does not
//! drive, momentum does not diffuse in the mean. All is pair by pair: mass centre and momentum are exact. The torque left is taken out by
//! rotations of a few dozen neighbouring particles, the work of the exchange out of u, pair by pair. Left alone: particles at an edge, where
//! neighbours are one-sided. First order: what is moved in a step is a small part of s, and fields of curvature k diffuse with some (k s)^2.
//! That is the repulsion; the other way to order is that of [`continuity`], which closes its books alike.
//! Sources: Monaghan (2000), J. Comput. Phys. 159, 290 (repulsion at short range); Lind et al. (2012), J. Comput. Phys. 231, 1499 (shift, with fields
//! corrected by gradients); the problem: Imaeda & Inutsuka (2002), ApJ 569, 501.

mod continuity;
mod groups;
mod pair;
mod site;

use nbody::points::sum::Parts;
use nbody::points::{Domain, Tree, Vec3};
use rayon::prelude::*;

use crate::{Gas, Hydro};
pub use continuity::{Continuity, Solves};
use pair::Law;
use site::Site;

/// Leaves a task.
const FEW: usize = 4;

/// What a particle is given.
#[derive(Clone, Copy, Debug, Default)]
struct Move {
    x: Vec3,
    v: Vec3,
    u: f64,
}

/// What particles are moved by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// Their rate by that of the shear.
    Repulsion {
        strength: f64,
    },
    Continuity(Continuity),
}

/// How gas of a scene is rearranged, and what the last shift was.
#[derive(Clone, Debug)]
pub struct Rearrangement {
    order: Order,
    sites: Vec<Site>,
    moves: Vec<Move>,
    spare: (Vec<Site>, Vec<Move>),
    /// The longest shift.
    longest: f64,
}

/// What a shift and its settlement changed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settled {
    pub kinetic: f64,
    pub internal: f64,
    /// Momentum and angular momentum that it could not keep: rounding, but for gas on a line.
    pub momentum: Vec3,
    pub angular_momentum: Vec3,
    pub heat: crate::Heat,
}

impl Rearrangement {
    pub fn new(order: Order) -> Self {
        if let Order::Repulsion { strength } = order {
            assert!(strength > 0.0, "without strength there is no rearrangement");
        }
        Self {
            order,
            sites: Vec::new(),
            moves: Vec::new(),
            spare: Default::default(),
            longest: 0.0,
        }
    }

    /// What particles do to each other; of the last shift's sites.
    fn law(&self, hydro: &Hydro) -> Law {
        match self.order {
            Order::Repulsion { .. } => Law::repulsion(hydro),
            Order::Continuity(_) => Law::potential(hydro),
        }
    }

    /// How far the nodes of `tree` are seen from, where the farther of two reaches counts; else empty.
    fn extent(&self, tree: &Tree) -> Vec<f64> {
        let mut extent = Vec::new();
        if let Order::Continuity(_) = self.order {
            let far = 2.0 * self.longest;
            tree.largest(|i| self.sites[i].reach + far, &mut extent);
        }
        extent
    }

    /// Remembers the densities that particles start with, where they are kept.
    pub fn begin(&self, gas: &mut Gas) {
        if let (Order::Continuity(_), true) = (self.order, gas.particles.target.is_empty()) {
            gas.particles.target.clone_from(&gas.derived.rho);
        }
    }

    /// Moves all particles, and what is predicted of them; to be called when all are at one time, `dt` after the last shift. Returns the
    /// momentum that crossing the faces of a shearing box gave, and how often places had to be solved for.
    pub fn shift(&mut self, gas: &mut Gas, hydro: &Hydro, dt: f64) -> (Vec3, Solves) {
        site::survey(&mut self.sites, gas, hydro);
        self.longest = 0.0;
        let solves = match self.order {
            Order::Repulsion { strength } => {
                site::repel(&mut self.sites, hydro, strength * dt);
                Solves::default()
            }
            Order::Continuity(law) => law.solve(&mut self.sites, gas, hydro, dt),
        };
        self.plan(gas, hydro);
        let p = &mut gas.particles;
        let free = hydro.eos.is_free();
        for (i, step) in self.moves.iter().enumerate() {
            p.x[i] += step.x;
            self.longest = self.longest.max(step.x.norm());
            // The velocity of the shear is that of the place.
            let stream = Vec3::new(0.0, -hydro.domain.shear_rate() * step.x.x, 0.0);
            p.v[i] += stream;
            gas.rates.v_pred[i] += stream + step.v;
            if free {
                let u = &mut gas.rates.u_pred[i];
                *u = (*u + step.u).max(groups::LEAST_PART * *u);
            }
        }
        if hydro.domain.size().is_none() {
            gas.tree.refit(&gas.particles.x);
            gas.bound();
            return (Vec3::zeros(), solves);
        }
        let gained = gas.wrap(&hydro.domain);
        gas.sort_with(|order| self.permute(order));
        for (site, (x, step)) in self
            .sites
            .iter_mut()
            .zip(gas.particles.x.iter().zip(&self.moves))
        {
            site.x = x - step.x;
        }
        (gained, solves)
    }

    /// What each particle is to be given.
    fn plan(&mut self, gas: &Gas, hydro: &Hydro) {
        let (law, extent) = (self.law(hydro), self.extent(&gas.tree));
        self.moves.clear();
        self.moves.resize(self.sites.len(), Move::default());
        let (sites, moves) = (&self.sites, Parts::new(&mut self.moves));
        each(
            &gas.tree,
            &hydro.domain,
            (sites, &extent, 0.0),
            |i, near| {
                let own = &sites[i];
                let mut sum = Move::default();
                for &(j, x) in near {
                    if let Some(pair) = law.pair(own, &sites[j as usize], own.x - x) {
                        sum.x += pair.shift;
                        sum.v += pair.impulse;
                        sum.u += pair.heat;
                    }
                }
                let inverse = 1.0 / own.m;
                // SAFETY: each particle is visited once.
                unsafe {
                    moves.part(i..i + 1)[0] = Move {
                        x: inverse * sum.x,
                        v: inverse * sum.v,
                        u: inverse * sum.u,
                    }
                };
            },
        );
    }

    fn permute(&mut self, order: &[u32]) {
        let (sites, moves) = &mut self.spare;
        sites.clear();
        moves.clear();
        sites.extend(order.iter().map(|&k| self.sites[k as usize]));
        moves.extend(order.iter().map(|&k| self.moves[k as usize]));
        std::mem::swap(&mut self.sites, sites);
        std::mem::swap(&mut self.moves, moves);
    }
}

/// Calls `visit(i, near)` for each particle, `near` being all that may be within reach of it, with their places; where `extent` is not empty also those
/// that have it within theirs. `moved` is how far particles may be from the places in `sites`.
fn each(
    tree: &Tree,
    domain: &Domain,
    (sites, extent, moved): (&[Site], &[f64], f64),
    visit: impl Fn(usize, &[(u32, Vec3)]) + Sync,
) {
    let leaves = tree.leaves.par_iter().with_min_len(FEW);
    leaves.for_each_init(Vec::new, |near, &leaf| {
        let node = &tree.nodes[leaf as usize];
        let wide = domain.widened(0.0);
        let (lo, hi) = (node.lo - wide, node.hi + wide);
        let widest = node
            .range()
            .fold(0.0f64, |most, i| most.max(sites[i].reach));
        let reach = widest + 2.0 * moved;
        near.clear();
        tree.near(domain, (lo, hi), reach, extent, |range, shift| {
            near.extend(range.filter_map(|j| {
                let x = sites[j].x + shift;
                let reach = match extent.is_empty() {
                    true => reach,
                    false => reach.max(sites[j].reach + 2.0 * moved),
                };
                let gap = (lo - x).sup(&(x - hi)).sup(&Vec3::zeros());
                (gap.norm_squared() <= reach * reach).then_some((j as u32, x))
            }));
        });
        for i in node.range() {
            visit(i, near);
        }
    });
}

#[cfg(test)]
mod tests;
