//! The Wisdom-Holman map's drift in democratic heliocentric coordinates: jump (half), Kepler, jump (half).
//!
//! With q = x - x_star and u = v - v_cm:  H = sum(m u^2/2 - G M m/q) + |sum m u|^2/(2 M) + pulls of the bodies on each other (the kick).
//! Jump: q += dt/2 sum(m u)/M. Kepler: q, u along their orbit about the star, mu = G M. Then the star goes where the centre of mass,
//! which moves uniformly, wants it. Between steps the state is inertial. Second order in dt with an error of order m/M; exact for
//! massless bodies; momentum is kept to rounding. A step needs about 1/20 of the shortest pericentre passage; see [`time_step`].
//! Source: Wisdom & Holman (1991); Duncan, Levison & Lee (1998).

mod chain;
mod corrector;
pub mod jacobi;

use std::f64::consts::TAU;

use nalgebra::SVector;
use rayon::prelude::*;

use super::{Ahead, Stuck, leapfrog};
use crate::bodies::Bodies;
use crate::kepler::Refusal;
use crate::kepler::abreast::drift_all;
use crate::points::Vec3;
use crate::points::sum;

/// Bodies a task; fewer are moved by the caller's own thread.
const TASK: usize = 256;

/// Moves star and bodies by `dt`; without a star on straight lines.
pub fn drift(star: &mut Bodies, bodies: &mut Bodies, g: f64, dt: f64) -> Result<(), Stuck> {
    if star.m.is_empty() {
        leapfrog::drift(bodies, dt);
        return Ok(());
    }
    let mut centre = (star.x[0], star.v[0]);
    map(&mut centre, star.m[0], bodies_of(bodies), g, dt)?;
    (star.x[0], star.v[0]) = centre;
    Ok(())
}

/// Positions and velocities `dt` from now by the same map, into `ahead`; star and bodies stay where they are.
pub fn predict(
    star: &Bodies,
    bodies: &Bodies,
    g: f64,
    dt: f64,
    ahead: &mut Ahead,
) -> Result<(), Stuck> {
    if star.m.is_empty() {
        leapfrog::predict(star, bodies, dt, ahead);
        return Ok(());
    }
    ahead.x.clone_from(&bodies.x);
    ahead.v.clone_from(&bodies.v);
    let mut centre = (star.x[0], star.v[0]);
    let swarm = Swarm {
        m: &bodies.m,
        x: &mut ahead.x,
        v: &mut ahead.v,
    };
    map(&mut centre, star.m[0], swarm, g, dt)?;
    (ahead.x_star, ahead.v_star) = centre;
    Ok(())
}

/// The longest step that gives every body `fraction` of the time 2 pi q^2/h that its pericentre passage takes; infinite without bodies.
pub fn time_step(star: &Bodies, bodies: &Bodies, g: f64, fraction: f64) -> f64 {
    let Some(&m) = star.m.first() else {
        return f64::INFINITY;
    };
    let mu = g * m;
    let passage = |(x, v): (&Vec3, &Vec3)| {
        let (q, u) = (x - star.x[0], v - star.v[0]);
        let h2 = q.cross(&u).norm_squared();
        let beta = 2.0 * mu / q.norm() - u.norm_squared();
        let e = (1.0 - h2 * beta / (mu * mu)).max(0.0).sqrt();
        let nearest = h2 / (mu * (1.0 + e));
        TAU * (nearest * nearest * nearest / (mu * (1.0 + e))).sqrt()
    };
    let shortest = bodies.x.iter().zip(&bodies.v).map(passage);
    fraction * shortest.fold(f64::INFINITY, f64::min)
}

struct Swarm<'a> {
    m: &'a [f64],
    x: &'a mut [Vec3],
    v: &'a mut [Vec3],
}

fn bodies_of(bodies: &mut Bodies) -> Swarm<'_> {
    Swarm {
        m: &bodies.m,
        x: &mut bodies.x,
        v: &mut bodies.v,
    }
}

/// Mass, mass times position, mass times velocity.
type Moments = SVector<f64, 7>;

fn moment(m: f64, x: &Vec3, v: &Vec3) -> Moments {
    Moments::from([m, m * x.x, m * x.y, m * x.z, m * v.x, m * v.y, m * v.z])
}

impl Swarm<'_> {
    fn moments(&self) -> Moments {
        let (m, x, v) = (self.m, &*self.x, &*self.v);
        sum::ordered(m.len(), Moments::zeros(), |range| {
            range.fold(Moments::zeros(), |sum, i| sum + moment(m[i], &x[i], &v[i]))
        })
    }

    /// Changes the bodies by `change`, task by task; the first body that fails is told.
    fn each(
        &mut self,
        change: impl Fn(&mut [Vec3], &mut [Vec3]) -> Result<(), (usize, Refusal)> + Sync,
    ) -> Result<(), Stuck> {
        let one = |(task, (x, v)): (usize, (&mut [Vec3], &mut [Vec3]))| {
            let (place, refusal) = change(x, v).err()?;
            let place = task * TASK + place;
            Some(Stuck { place, refusal })
        };
        let stuck = if self.m.len() < 2 * TASK {
            let all = self.x.chunks_mut(TASK).zip(self.v.chunks_mut(TASK));
            all.enumerate().filter_map(one).next()
        } else {
            let all = self.x.par_chunks_mut(TASK).zip(self.v.par_chunks_mut(TASK));
            let stuck = all.enumerate().filter_map(one);
            stuck.min_by_key(|stuck| stuck.place)
        };
        stuck.map_or(Ok(()), Err)
    }
}

fn map(
    star: &mut (Vec3, Vec3),
    m_star: f64,
    mut swarm: Swarm<'_>,
    g: f64,
    dt: f64,
) -> Result<(), Stuck> {
    let (x_star, v_star) = *star;
    let total = moment(m_star, &x_star, &v_star) + swarm.moments();
    let x_cm = total.fixed_rows::<3>(1) / total[0];
    let v_cm = total.fixed_rows::<3>(4) / total[0];
    // The bodies' momentum over the star's mass is the star's velocity turned round.
    let jump = (v_cm - v_star) * (0.5 * dt);
    let to_star = jump - x_star;
    swarm.each(|x, v| {
        for (x, v) in x.iter_mut().zip(v.iter_mut()) {
            *x += to_star;
            *v -= v_cm;
        }
        drift_all(g * m_star, dt, x, v)
    })?;
    let about = swarm.moments();
    let recoil = about.fixed_rows::<3>(4) / m_star;
    let jump = recoil * (0.5 * dt);
    let lever = (about.fixed_rows::<3>(1) + jump * about[0]) / total[0];
    *star = (x_cm + v_cm * dt - lever, v_cm - recoil);
    let to_inertial = star.0 + jump;
    swarm.each(|x, v| {
        x.iter_mut().for_each(|x| *x += to_inertial);
        v.iter_mut().for_each(|v| *v += v_cm);
        Ok(())
    })
}

#[cfg(test)]
mod tests;
