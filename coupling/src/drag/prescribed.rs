//! Drag of dust in a gas disk that is a formula: what [`super`] does with gas particles, without reaction on the gas.
//!
//! A grain relaxes towards the gas at its place with the relative acceleration a = g - v_gas'; along its circle about the star the gas has
//! v_gas' = -Omega_g^2 R 2/(1 + sqrt(1 - (Omega_g dt)^2)) e_R + that of the star: so strong that half a kick makes of v_gas the chord of a whole
//! step, on which a tied grain drifts from one point of its circle to another. So any stopping time is stable, tied grains drift and settle at
//! their terminal velocity, and all is of second order in dt.
//! The gas gains the momentum at its own velocity and is booked as given away; the rest of the energy is heat, and radiated.

use nbody::points::clock::Centre;
use nbody::points::{Fault, Vec3, sum};
use rayon::prelude::*;

use super::operators::book;
use super::row::{ABREAST, Drive, Row, relax};
use super::{Booking, Grains, Half, Immersed, Star, StoppingLaw};
use crate::System;
use crate::external::GasDisk;
use crate::operator::{Meter, Operator, Phase};

/// Who moves whom beside the drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ties {
    /// Whether the star pulls the dust.
    pub star_pulls: bool,
    /// Whether bodies pull the star, and so move the disk about it.
    pub star_moves: bool,
}

/// Drag of a disk on dust.
pub struct DustInDisk {
    disk: GasDisk,
    law: StoppingLaw,
    ties: Ties,
    active: Vec<u32>,
    /// Weight in time of the half steps, and the lengths of the whole steps.
    steps: Vec<[f64; 2]>,
    rows: Vec<Row>,
}

/// The star that the disk moves with.
#[derive(Clone, Copy)]
struct Frame {
    x: Vec3,
    v: Vec3,
    a: Vec3,
    gm: f64,
    /// What the grains' kicks have beside their own accelerations.
    centre: Centre,
}

impl Frame {
    fn of(system: &System, ties: Ties) -> Self {
        let (x, gm) = (system.seen.star_x[0], system.g * system.star.m[0]);
        let kept = |on: bool, what: f64| if on { what } else { 0.0 };
        Self {
            x,
            v: system.seen.star_v[0],
            a: kept(ties.star_moves, system.g) * by_bodies(system, x),
            gm,
            centre: Centre {
                x,
                gm: kept(ties.star_pulls, gm),
            },
        }
    }
}

/// Acceleration at `x` by the bodies, for G = 1.
fn by_bodies(system: &System, x: Vec3) -> Vec3 {
    let bodies = &system.bodies;
    let places = system.seen.places(&bodies.x);
    let pull = |i: usize| {
        let r = places[i] - x;
        let square = r.norm_squared() + bodies.softening[i].powi(2);
        r * (bodies.m[i] / (square * square.sqrt()))
    };
    sum::ordered(places.len(), Vec3::zeros(), |range| {
        range
            .filter(|&i| bodies.m[i] > 0.0)
            .fold(Vec3::zeros(), |sum, i| sum + pull(i))
    })
}

/// By how much more than v^2/R half a kick of a step `dt` must bend a circle of frequency `omega`; steps longer than 1/omega count as that.
fn bend(omega: f64, dt: f64) -> f64 {
    2.0 / (1.0 + (1.0 - (omega * dt).powi(2).min(1.0)).sqrt())
}

impl DustInDisk {
    pub fn new(disk: GasDisk, law: StoppingLaw, ties: Ties) -> Self {
        Self {
            disk,
            law,
            ties,
            active: Vec::new(),
            steps: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// Drag over half steps; `step` gives their weight in time and the length of the whole.
    fn act(&mut self, system: &mut System, half: Half, step: impl Fn(&System, usize) -> [f64; 2]) {
        let frame = Frame::of(system, self.ties);
        self.steps.clear();
        self.steps
            .extend(self.active.iter().map(|&i| step(system, i as usize)));
        self.rows.resize(self.active.len(), Row::default());
        let star = Star::of(system);
        let mut grains = Grains {
            dust: &mut system.dust,
            star,
        };
        let (disk, law, seen) = (&self.disk, &self.law, &grains);
        self.rows
            .par_iter_mut()
            .zip(self.active.par_iter().zip(&self.steps))
            .with_min_len(sum::CHUNK)
            .for_each(|(row, (&i, &step))| {
                *row = relaxed((disk, law), (seen, i as usize), (step, half), &frame);
            });
        let mut booking = Booking::default();
        for (row, &i) in self.rows.iter().zip(&self.active) {
            let v = grains.velocity(i as usize);
            row.book(v, &mut booking);
            row.give_away(v, &mut booking);
            row.outcome().push(&mut grains, i as usize);
            row.wind().tell(&mut grains, i as usize);
        }
        book(system, &booking, false);
    }
}

/// What grain `i` does in the half step of weight `step` of a step `whole`.
fn relaxed(
    (disk, law): (&GasDisk, &StoppingLaw),
    (grains, i): (&Grains, usize),
    ([step, whole], half): ([f64; 2], Half),
    frame: &Frame,
) -> Row {
    let x = grains.position(i);
    let mut row = Row {
        i: i as u32,
        m: grains.mass(i),
        x,
        t_stop: f64::INFINITY,
        ..Row::default()
    };
    let place = x - frame.x;
    let Some(gas) = disk.at(place, frame.gm) else {
        return row;
    };
    (row.rho, row.c) = (gas.rho, gas.c);
    row.u_tick = grains.velocity(i) - (frame.v + gas.v);
    let out = Vec3::new(place.x, place.y, 0.0);
    let square = gas.v.norm_squared() / out.norm_squared();
    let circling = -square * bend(square.sqrt(), whole) * out;
    let own = grains.dust.rates.gravity[i] + frame.centre.lacking(x, whole);
    let drive = Drive {
        step: [step; ABREAST],
        a: [own - circling - frame.a; ABREAST],
        sphere: [grains.sphere(i); ABREAST],
    };
    relax(
        (std::slice::from_mut(&mut row), &mut [[0.0; 4]]),
        law,
        grains,
        &drive,
        half,
    );
    row
}

impl Operator for DustInDisk {
    fn name(&self) -> &'static str {
        "disk drag on dust"
    }

    fn prepare(&mut self, system: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        system.list_active_dust(&mut self.active);
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        self.act(system, Half::Closing, |s, i| {
            let p = &s.dust.particles;
            let whole = f64::from(p.span[i]) * s.clock.unit();
            [s.closing(p.begin[i], p.span[i]), whole]
        });
        meter.count(self.active.len(), 0);
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        self.act(system, Half::Opening, |s, i| {
            let span = s.dust.rates.next_span[i];
            [s.opening(span), f64::from(span) * s.next.unit()]
        });
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
