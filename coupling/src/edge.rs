//! Edges of a gas disk: zones in which waves are damped and the gas is kept on the orbits of the disk that the scene began with.
//!
//! dv_R/dt = -v_R s / tau,   dv_z/dt = -v_z s / tau,   dv_phi/dt = -(v_phi - v_0) s / tau,   tau = f / Omega(R)
//!
//! v_0 is the speed in balance with star and pressure; where none is known, as in a disk that pulls itself, v_phi is left alone.
//! s rises as a parabola from 0 where a zone begins to 1 at the disk's edge and beyond. Exact over a step, at whose end it stands after all
//! kicks: of second order as the rest of the step but for a shift of half a damping. The gas keeps its mass and its internal energy; momentum
//! and energy go to a medium that nobody follows, and are booked as given away.
//! Waves of v_R ~ exp(i k R - i omega t) decay as exp(-(1 + kappa^2/omega^2)/2 s t / tau) where s t << tau, epicycles as exp(-s t / tau).
//! Source: de Val-Borro et al. (2006), MNRAS 370, 529, eq. 10; towards v_0 in place of the values at the start.

use nbody::points::sum::{self, Parts};
use nbody::points::{Clock, Fault, Vec3};

pub mod rim;

use crate::System;
use crate::ledger::{Census, Totals};
use crate::operator::{Meter, Operator, Phase};

/// Where a zone begins and where its damping is whole; it begins outside an inner edge, and inside an outer one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zone {
    pub begin: f64,
    pub whole: f64,
}

impl Zone {
    /// s at the distance `radius` from the axis.
    pub fn strength(&self, radius: f64) -> f64 {
        let depth = (radius - self.begin) / (self.whole - self.begin);
        let depth = depth.clamp(0.0, 1.0);
        depth * depth
    }
}

/// Velocity of gas in balance at a place from the star.
pub type Balance = Box<dyn Fn(Vec3) -> Vec3 + Send + Sync>;

/// Damps the gas in zones.
pub struct Edges {
    pub zones: Vec<Zone>,
    /// f
    pub time: f64,
    /// None where it is not known: the rotation is left alone.
    pub balance: Option<Balance>,
    active: Vec<u32>,
}

/// The star that the disk turns about.
#[derive(Clone, Copy)]
struct Star {
    x: Vec3,
    v: Vec3,
    gm: f64,
}

impl Edges {
    pub fn new(zones: Vec<Zone>, time: f64, balance: Option<Balance>) -> Self {
        Self {
            zones,
            time,
            balance,
            active: Vec::new(),
        }
    }

    /// How strongly gas at the distance `radius` is damped.
    fn strength(&self, radius: f64) -> f64 {
        let strengths = self.zones.iter().map(|zone| zone.strength(radius));
        strengths.fold(0.0, f64::max)
    }

    /// Where the velocity `v` at `x` goes.
    fn rest(&self, x: Vec3, v: Vec3) -> Vec3 {
        let known = self.balance.as_ref().map(|balance| balance(x));
        // Where pressure leaves no orbit there is none to go to.
        let known = known.filter(|rest| rest.iter().all(|v| v.is_finite()));
        known.unwrap_or_else(|| {
            let along = Vec3::new(-x.y, x.x, 0.0) / x.xy().norm();
            along * v.dot(&along)
        })
    }

    /// What the velocity `v` about the star becomes over `dt` at `x` from it; none outside the zones.
    fn damped(&self, x: Vec3, v: Vec3, gm: f64, dt: f64) -> Option<Vec3> {
        let radius = x.xy().norm();
        let strength = self.strength(radius);
        if strength == 0.0 || dt == 0.0 {
            return None;
        }
        let rest = self.rest(x, v);
        let depth = strength * dt * (gm / radius.powi(3)).sqrt() / self.time;
        Some(rest + (v - rest) * (-depth).exp())
    }

    /// Damps the gas whose steps end now; returns what it has lost.
    fn act(&mut self, system: &mut System, star: Star) -> Totals {
        let clock: Clock = system.clock;
        let gas = &mut system.gas;
        self.active.clear();
        self.active.extend_from_slice(gas.active_ones());
        let active = &self.active;
        let p = &mut gas.particles;
        let (x, m, begin) = (&p.x, &p.m, &p.begin);
        let (v, v_pred) = (Parts::new(&mut p.v), Parts::new(&mut gas.rates.v_pred));
        sum::ordered(active.len(), Totals::default(), |range| {
            active[range].iter().fold(Totals::default(), |lost, &i| {
                let i = i as usize;
                // SAFETY: each active particle is listed once.
                let (v, v_pred) = unsafe { (v.part(i..i + 1), v_pred.part(i..i + 1)) };
                let dt = f64::from(clock.tick - begin[i]) * clock.unit();
                let about = (x[i] - star.x, v[0] - star.v);
                let Some(damped) = self.damped(about.0, about.1, star.gm, dt) else {
                    return lost;
                };
                let dv = damped - about.1;
                let momentum = -m[i] * dv;
                let loss = Totals {
                    momentum,
                    angular_momentum: x[i].cross(&momentum),
                    kinetic: momentum.dot(&(v[0] + 0.5 * dv)),
                    ..Totals::default()
                };
                v[0] += dv;
                v_pred[0] = v[0];
                lost + loss
            })
        })
    }
}

impl Operator for Edges {
    fn name(&self) -> &'static str {
        "edges"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let (Some(&x), Some(&v)) = (system.seen.star_x.first(), system.seen.star_v.first()) else {
            return Ok(false);
        };
        let gm = system.g * system.star.m[0];
        let lost = self.act(system, Star { x, v, gm });
        let mut change = Census::default();
        change.0[0] = Totals::default() - lost;
        system.ledger.add(self.name(), &change);
        system.ledger.given_away += lost;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Damps from 2 inwards, wholly at 1 and within; the gas turns by Kepler's law about a mass of 4.
    fn edges(time: f64) -> Edges {
        let inner = Zone {
            begin: 2.0,
            whole: 1.0,
        };
        let kepler = |x: Vec3| Vec3::new(-x.y, x.x, 0.0) * (2.0 / x.xy().norm().powf(1.5));
        Edges::new(vec![inner], time, Some(Box::new(kepler)))
    }

    #[test]
    fn zones_rise_from_where_they_begin_to_their_edge() {
        let outer = Zone {
            begin: 8.0,
            whole: 10.0,
        };
        let found = [7.0, 8.0, 9.0, 10.0, 12.0].map(|radius| outer.strength(radius));
        assert_eq!(found, [0.0, 0.0, 0.25, 1.0, 1.0]);
        let inner = edges(1.0).zones[0];
        let found = [0.5, 1.0, 1.5, 2.0, 3.0].map(|radius| inner.strength(radius));
        assert_eq!(found, [1.0, 1.0, 0.25, 0.0, 0.0]);
    }

    #[test]
    fn what_differs_from_balance_decays_in_the_time_of_the_zone_in_any_steps() {
        let edges = edges(0.7);
        let x = Vec3::new(0.0, 1.5, 0.2);
        let rest = edges.rest(x, Vec3::zeros());
        let extra = Vec3::new(0.3, -0.2, 0.1);
        let omega = 2.0 / 1.5f64.powf(1.5);
        let expected = rest + extra * (-0.25 * omega / 0.7 * 3.0f64).exp();
        for steps in [1, 10, 300] {
            let dt = 3.0 / f64::from(steps);
            let v = (0..steps).fold(rest + extra, |v, _| {
                edges.damped(x, v, 4.0, dt).expect("a zone")
            });
            assert!((v - expected).norm() < 1e-13, "{steps}: {v}");
        }
        assert_eq!(edges.damped(1.4 * x, rest, 4.0, 1.0), None);
        assert_eq!(edges.damped(x, rest, 4.0, 0.0), None);
    }

    #[test]
    fn without_a_balance_the_rotation_is_left_alone() {
        let edges = Edges {
            balance: None,
            ..edges(0.7)
        };
        let x = Vec3::new(0.0, 1.5, 0.2);
        let v = Vec3::new(-1.1, 0.3, 0.1);
        let after = edges.damped(x, v, 4.0, 1.0).expect("a zone");
        let part = (-0.25 * 2.0 / 1.5f64.powf(1.5) / 0.7).exp();
        let expected = Vec3::new(-1.1, 0.3 * part, 0.1 * part);
        assert!((after - expected).norm() < 1e-15, "{after}");
    }
}
