//! Hybrid map for star, planets and planetesimals with close encounters (P3T): soft forces in the kick, hard ones in the drift.
//!
//! H = [sum(m u^2/2 - G M m/q) - sum (1 - K) G m m/r] + |sum m u|^2/(2 M) - sum K G m m/r in democratic heliocentric coordinates, K the
//! changeover at each pair's cut-off. Kick by the soft forces (half); jump; the bracket: bodies without a neighbour go along their Kepler
//! orbit, clusters of neighbours are integrated; jump; kick. Second order in dt, with an error of order m/M times the step's part of
//! the time to cross a cut-off, squared. Places too: for masses of 1e-6 that pass at 1/40 of a Hill radius, 1.2e-6, 2.7e-7, 6.7e-8 at 210,
//! 420, 840 steps an orbit; below 200 steps the order is not yet felt. Momentum is kept to rounding. Touching pairs are stopped, bound together and told.
//! Source: Duncan, Levison & Lee (1998); Chambers (1999); Oshino, Funato & Makino (2011); Ishigaki et al. (2021).

mod alone;
pub mod changeover;
mod clusters;
pub mod cutoff;
mod group;
mod hard;
mod map;
mod neighbours;
mod pairs;
mod radau;
pub mod soft;
#[cfg(test)]
mod tests;

use nalgebra::SVector;
use rayon::prelude::*;
use thiserror::Error;

use super::leapfrog;
use crate::bodies::Bodies;
use crate::encounters::{Encounter, in_order};
use crate::kepler;
use crate::points::sort::{Cube, Curve, MANY};
use crate::points::sum::{self, CHUNK};
use crate::points::{Columns, Vec3};
use alone::alone;
use clusters::Clusters;
pub use cutoff::typical;
use cutoff::{Centre, Cutoff, choose};
use group::Member;
use hard::Hard;
pub use map::Map;
use neighbours::{Neighbours, Swarm};

/// Up to so many bodies their order in memory does not matter: columns of 200 bytes a body fit into a cache of half a megabyte.
const CACHED: usize = 2048;

/// Why a body cannot be moved.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum Reason {
    #[error(transparent)]
    Orbit(#[from] kepler::Refusal),
    #[error(
        "meets another so closely that no step is short enough; bodies with radii would collide"
    )]
    Meeting,
}

/// A body that cannot be moved: its place among the bodies, and why. The other bodies may have moved already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stuck {
    pub place: usize,
    pub reason: Reason,
}

/// The map; keeps its buffers, but nothing of a step, between calls: bodies carry their cut-offs.
#[derive(Debug, Default)]
pub struct Hybrid {
    pub cutoff: Cutoff,
    /// The step that cut-offs count paths in, whatever steps are cut short.
    pub step: f64,
    /// Whether bodies touch; else they are points.
    pub touching: bool,
    /// Pairs that touched in the last drift, in the order of time, then ids. They lie at their touch; times count from the end.
    pub touches: Vec<Encounter>,
    /// Of bodies that carry none.
    cutoffs: Vec<f64>,
    /// Members of clusters in the last drift, and of the largest one.
    clustered: (usize, usize),
    neighbours: Neighbours,
    clusters: Clusters,
    hard: Hard,
}

/// Mass, mass times position, mass times velocity.
type Moments = SVector<f64, 7>;

fn moment(m: f64, x: &Vec3, v: &Vec3) -> Moments {
    Moments::from([m, m * x.x, m * x.y, m * x.z, m * v.x, m * v.y, m * v.z])
}

fn moments(m: &[f64], x: &[Vec3], v: &[Vec3]) -> Moments {
    sum::ordered(m.len(), Moments::zeros(), |range| {
        range.fold(Moments::zeros(), |sum, i| sum + moment(m[i], &x[i], &v[i]))
    })
}

/// Changes each of `x` and `v`; few are done by the caller's own thread.
fn each(x: &mut [Vec3], v: &mut [Vec3], change: impl Fn(&mut Vec3, &mut Vec3) + Sync) {
    if x.len() <= CHUNK {
        x.iter_mut().zip(v).for_each(|(x, v)| change(x, v));
    } else {
        let all = x.par_iter_mut().zip(v).with_min_len(CHUNK);
        all.for_each(|(x, v)| change(x, v));
    }
}

impl Hybrid {
    pub fn new(cutoff: Cutoff, step: f64, touching: bool) -> Self {
        Self {
            cutoff,
            step,
            touching,
            ..Self::default()
        }
    }

    /// Moves star and bodies by `dt` > 0 without their soft forces; without a star, bodies alone go straight.
    pub fn drift(
        &mut self,
        star: &mut Bodies,
        bodies: &mut Bodies,
        g: f64,
        dt: f64,
    ) -> Result<(), Stuck> {
        self.touches.clear();
        if star.m.is_empty() {
            leapfrog::drift(bodies, dt);
            return Ok(());
        }
        let (m_star, x_star, v_star) = (star.m[0], star.x[0], star.v[0]);
        let own = moments(&bodies.m, &bodies.x, &bodies.v);
        let total = moment(m_star, &x_star, &v_star) + own;
        let x_cm = total.fixed_rows::<3>(1) / total[0];
        let v_cm = total.fixed_rows::<3>(4) / total[0];
        // The bodies' momentum over the star's mass is the star's velocity turned round.
        let jump = (v_cm - v_star) * (0.5 * dt);
        let to_star = jump - x_star;
        each(&mut bodies.x, &mut bodies.v, |x, v| {
            *x += to_star;
            *v -= v_cm;
        });
        self.cross(bodies, [g * m_star, g], dt)?;
        let about = moments(&bodies.m, &bodies.x, &bodies.v);
        let recoil = about.fixed_rows::<3>(4) / m_star;
        let jump = recoil * (0.5 * dt);
        let lever = (about.fixed_rows::<3>(1) + jump * about[0]) / total[0];
        (star.x[0], star.v[0]) = (x_cm + v_cm * dt - lever, v_cm - recoil);
        let to_inertial = star.x[0] + jump;
        each(&mut bodies.x, &mut bodies.v, |x, v| {
            *x += to_inertial;
            *v += v_cm;
        });
        Ok(())
    }

    /// The bracket of the Hamiltonian, bodies heliocentric.
    fn cross(&mut self, bodies: &mut Bodies, [mu, g]: [f64; 2], dt: f64) -> Result<(), Stuck> {
        // Those of the kick: both parts of a pair's force must add up to the whole.
        let cutoffs = if bodies.cutoff.len() == bodies.m.len() {
            &bodies.cutoff
        } else {
            self.cutoffs.clear();
            self.cutoffs.resize(bodies.m.len(), 0.0);
            let centre = self.centre(mu, g);
            let about = (Vec3::zeros(), Vec3::zeros());
            choose(&self.cutoff, &centre, bodies, about, &mut self.cutoffs);
            &self.cutoffs
        };
        self.neighbours.find(&Swarm {
            m: &bodies.m,
            x: &bodies.x,
            v: &bodies.v,
            cutoff: cutoffs,
            mu,
            dt,
        });
        self.neighbours.uproot();
        self.clusters.join(&self.neighbours.pairs);
        let (clusters, touching) = (&self.clusters, self.touching);
        let member = |k: usize| {
            let i = clusters.members[k] as usize;
            Member {
                m: bodies.m[i],
                radius: if touching { bodies.radius[i] } else { 0.0 },
                eps2: bodies.softening[i] * bodies.softening[i],
                cutoff: cutoffs[i],
                x: bodies.x[i],
                v: bodies.v[i],
            }
        };
        let done = self.hard.advance(clusters, member, [mu, g], dt);
        done.map_err(|stalled| Stuck {
            place: clusters.members[stalled.0] as usize,
            reason: Reason::Meeting,
        })?;
        alone(mu, dt, bodies, &self.clusters.members)?;
        for (k, &i) in self.clusters.members.iter().enumerate() {
            (bodies.x[i as usize], bodies.v[i as usize]) = (self.hard.x[k], self.hard.v[k]);
        }
        self.tell(bodies, dt);
        self.clustered = self.clusters.sizes();
        if bodies.x.len() > MANY {
            self.release();
        }
        Ok(())
    }

    /// Gives back the memory of what the drift of many bodies is done with, before a kick needs it for its tree.
    fn release(&mut self) {
        self.neighbours.pairs = Vec::new();
        self.clusters = Clusters::default();
        (self.hard.x, self.hard.v) = (Vec::new(), Vec::new());
    }

    /// Lists the touches in their order.
    fn tell(&mut self, bodies: &Bodies, dt: f64) {
        let place = |k: usize| self.clusters.members[k] as usize;
        self.touches
            .extend(self.hard.touches.iter().map(|touch| Encounter {
                pair: touch.pair.map(place),
                time: touch.time - dt,
                held: dt - touch.time,
            }));
        in_order(&mut self.touches, &bodies.id);
    }

    fn centre(&self, mu: f64, g: f64) -> Centre {
        Centre {
            mu,
            g,
            dt: self.step,
        }
    }

    /// Chooses the cut-offs of bodies in inertial coordinates, for this tick's kick and the drift after it.
    pub fn choose(&mut self, star: &Bodies, bodies: &mut Bodies, g: f64) {
        let mut cutoffs = std::mem::take(&mut bodies.cutoff);
        cutoffs.resize(bodies.m.len(), 0.0);
        if let (Some(&m_star), Some(&x_star), Some(&v_star)) =
            (star.m.first(), star.x.first(), star.v.first())
        {
            let total = moment(m_star, &x_star, &v_star) + moments(&bodies.m, &bodies.x, &bodies.v);
            let about = (x_star, total.fixed_rows::<3>(4) / total[0]);
            let centre = self.centre(g * m_star, g);
            choose(&self.cutoff, &centre, bodies, about, &mut cutoffs);
        } else {
            cutoffs.fill(0.0);
        }
        bodies.cutoff = cutoffs;
    }

    /// Puts bodies that are too many for a fast cache into the order of the Morton curve, where those near in space are near in memory; few
    /// stay. Answers which body has come to each place, none if they stay.
    pub fn arrange(&mut self, bodies: &mut Bodies) -> Vec<u32> {
        if bodies.x.len() <= CACHED {
            return Vec::new();
        }
        let order = {
            let mut curve = Curve::default();
            curve.thread(&bodies.x, Cube::around(&bodies.x));
            curve.order
        };
        bodies.permute_sparingly(&order);
        self.neighbours.uproot();
        order
    }

    /// How many bodies were in clusters in the last drift, and in the largest one.
    pub fn clustered(&self) -> (usize, usize) {
        self.clustered
    }
}
