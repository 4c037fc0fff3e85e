//! The settlement of a shift: velocities and energies are given what keeps the fields in place, and the sums are brought back.
//!
//! Work of the exchange: sum p_ij . (v_i - v_j), v in the middle of the change; each of a pair pays one half out of its u.
//! Torque: T_i = sum_j [ f_ij x (v_i - v_j) + r'_ij x p_ij ] / 2, v before the kicks that close the step, which turn nothing at the new places.
//! Groups that follow each other along the curve turn as rigid bodies about their centres, so that they take up the T of their own; not in closed
//! domains, which have no angular momentum to keep.

use std::ops::Range;

use nalgebra::Matrix3;
use nbody::points::sum::Parts;
use nbody::points::{Domain, Vec3};
use rayon::prelude::*;

use super::site::Site;
use super::{Move, Rearrangement, Settled, each};
use crate::{Gas, Heat, Hydro};

/// Particles of a group; the last has what is left over.
const GROUP: usize = 64;

/// The least part of its internal energy that the exchange leaves to a particle.
pub(super) const LEAST_PART: f64 = 0.1;

/// The least determinant of a group's inertia by the cube of its trace with which it turns.
const THIN: f64 = 1e-6;

/// What a particle has left over: half of its pairs' work and torque.
#[derive(Clone, Copy, Default)]
struct Due {
    work: f64,
    torque: Vec3,
}

impl Rearrangement {
    /// Gives the velocities and energies what goes with the last shift; to be called when the same particles' step is closed.
    pub fn settle(&self, gas: &mut Gas, hydro: &Hydro) -> Settled {
        assert_eq!(
            self.moves.len(),
            gas.len(),
            "a settlement follows its shift"
        );
        let dues = self.dues(gas, hydro);
        let whole = gas.len() / GROUP;
        let range = |g: usize| {
            g * GROUP..if g + 1 >= whole {
                gas.len()
            } else {
                (g + 1) * GROUP
            }
        };
        let groups: Vec<Range<usize>> = (0..whole.max(1)).map(range).collect();
        let p = &mut gas.particles;
        let (v, u) = (Parts::new(&mut p.v), Parts::new(&mut p.u));
        let (v_pred, u_pred) = (
            Parts::new(&mut gas.rates.v_pred),
            Parts::new(&mut gas.rates.u_pred),
        );
        let (x, m, moves) = (&p.x, &p.m, &self.moves);
        let of_group = |own: &Range<usize>| {
            // SAFETY: groups have no particles in common.
            let (v, u, v_pred, u_pred) = unsafe {
                (
                    v.part(own.clone()),
                    u.part(own.clone()),
                    v_pred.part(own.clone()),
                    u_pred.part(own.clone()),
                )
            };
            let group = Group {
                x: &x[own.clone()],
                m: &m[own.clone()],
                sites: &self.sites[own.clone()],
                moves: &moves[own.clone()],
                dues: &dues[own.clone()],
            };
            let settled = group.settle(hydro, v, u);
            v_pred.copy_from_slice(v);
            if hydro.eos.is_free() {
                u_pred.copy_from_slice(u);
            }
            settled
        };
        let settled: Vec<Settled> = groups.par_iter().with_min_len(16).map(of_group).collect();
        settled.into_iter().fold(Settled::default(), Settled::and)
    }

    /// What each particle has left over, seen at the velocities that the closed step has.
    fn dues(&self, gas: &Gas, hydro: &Hydro) -> Vec<Due> {
        let law = self.law(hydro);
        let extent = self.extent(&gas.tree);
        let (sites, moves, domain) = (&self.sites, &self.moves, &hydro.domain);
        let (x, v) = (&gas.particles.x, &gas.particles.v);
        let mut dues = vec![Due::default(); gas.len()];
        let parts = Parts::new(&mut dues);
        each(
            &gas.tree,
            domain,
            (sites, &extent, self.longest),
            |i, near| {
                let own = domain.relative(x[i], v[i]);
                let mut due = Due::default();
                for &(j, place) in near {
                    let r = sites[i].x - place;
                    let j = j as usize;
                    let Some(pair) = law.pair(&sites[i], &sites[j], r) else {
                        continue;
                    };
                    let apart = own - domain.relative(x[j], v[j]);
                    let middle = apart + 0.5 * (moves[i].v - moves[j].v);
                    due.work += 0.5 * pair.impulse.dot(&middle);
                    let after = r + moves[i].x - moves[j].x;
                    let drifted = sites[i].v - sites[j].v;
                    due.torque += 0.5 * (pair.shift.cross(&drifted) + after.cross(&pair.impulse));
                }
                // SAFETY: each particle is visited once.
                unsafe { parts.part(i..i + 1)[0] = due };
            },
        );
        dues
    }
}

impl Settled {
    fn and(self, other: Self) -> Self {
        Self {
            kinetic: self.kinetic + other.kinetic,
            internal: self.internal + other.internal,
            momentum: self.momentum + other.momentum,
            angular_momentum: self.angular_momentum + other.angular_momentum,
            heat: self.heat.and(other.heat),
        }
    }
}

/// Particles that take up together what they have left over.
struct Group<'a> {
    x: &'a [Vec3],
    m: &'a [f64],
    sites: &'a [Site],
    moves: &'a [Move],
    dues: &'a [Due],
}

impl Group<'_> {
    fn settle(&self, hydro: &Hydro, v: &mut [Vec3], u: &mut [f64]) -> Settled {
        let mass: f64 = self.m.iter().sum();
        let centre = self.places().map(|(m, x)| m * x).sum::<Vec3>() / mass;
        let turn = self.turn(&hydro.domain, centre);
        let mut settled = Settled::default();
        let mut spent = 0.0;
        for (k, v) in v.iter_mut().enumerate() {
            let (m, before) = (self.m[k], *v);
            *v += self.moves[k].v;
            let kept = *v;
            let rotation = turn.cross(&(self.x[k] - centre));
            *v += rotation;
            spent += m * rotation.dot(&(0.5 * (kept + *v)));
            let change = *v - before;
            settled.kinetic += m * change.dot(&(0.5 * (*v + before)));
            settled.momentum += m * change;
            settled.angular_momentum +=
                self.x[k].cross(&(m * change)) + self.moves[k].x.cross(&(m * self.sites[k].v));
        }
        for (k, u) in u.iter_mut().enumerate() {
            let (m, before) = (self.m[k], *u);
            let work = self.dues[k].work / m + spent / mass;
            if !hydro.eos.is_free() {
                // Energy of gas bound to a temperature comes from what it gives off.
                settled.heat.radiated -= m * work;
                continue;
            }
            *u = warmed(*u, (m, self.moves[k].u - work), hydro, &mut settled.heat);
            settled.internal += m * (*u - before);
        }
        settled
    }

    /// The rotation that takes up the torque left over.
    fn turn(&self, domain: &Domain, centre: Vec3) -> Vec3 {
        if domain.size().is_some() {
            return Vec3::zeros();
        }
        let torque: Vec3 = self.dues.iter().map(|due| due.torque).sum();
        let spread = self.places().fold(Matrix3::zeros(), |sum, (m, x)| {
            let arm = x - centre;
            sum + m * arm * arm.transpose()
        });
        let mut inertia = Matrix3::identity() * spread.trace() - spread;
        let mut wanted = torque;
        if domain.dimensions() == 2 {
            // What lies in a plane turns about its normal alone.
            let normal = domain.axes.iter().position(|&has| !has).unwrap_or(2);
            let own = inertia[(normal, normal)];
            inertia = Matrix3::identity() * own;
            wanted = Vec3::zeros();
            wanted[normal] = torque[normal];
        }
        let enough = inertia.determinant() > THIN * inertia.trace().powi(3);
        let inverse = inertia.try_inverse().filter(|_| enough);
        inverse.map_or_else(Vec3::zeros, |inverse| -(inverse * wanted))
    }

    fn places(&self) -> impl Iterator<Item = (f64, Vec3)> + '_ {
        self.m.iter().copied().zip(self.x.iter().copied())
    }
}

/// `u` after it was given `du`, of a particle of mass m; it stays positive.
fn warmed(u: f64, (m, du): (f64, f64), hydro: &Hydro, heat: &mut Heat) -> f64 {
    let (least, wanted) = (hydro.least_u.max(LEAST_PART * u), u + du);
    if wanted < least {
        heat.floored += m * (least - wanted);
        heat.floors += 1;
        return least;
    }
    wanted
}
