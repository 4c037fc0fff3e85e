//! Snow line: ice that goes into gas of one temperature and comes back, and the radius at which a disk of grains has half of its ice.
//!
//! A box of one size of grains, at 170 K: ds/dt = -(c_v / rho_ice) (rho_sat - rho_v), c_v = sqrt(R T / 2 pi), rho_v from the water in sum (Hertz
//! and Knudsen), by the classical Runge-Kutta method; steps of 1e-6 to 1e6 of the time V / (c_v A) that the vapour needs. Errors are those of the
//! vapour's mass, by itself; volumes are those of the gas particles, m / rho. With several sizes, and from too much vapour: rho_v = rho_sat in
//! the end, or all ice is gone.

mod disk;

use std::f64::consts::{PI, TAU};

use nbody::points::{Vec3, sum};

use super::{Bar, Row};
use crate::trial::{Stop, Trial};

/// Kelvins, and c_v and the density of saturated vapour there, cgs.
const T: f64 = 170.0;
const BOLTZMANN: f64 = 1.380_649e-16;
const WATER: f64 = 18.0153 * 1.660_539_07e-24;
/// Of the gas: 2.34 hydrogen atoms.
const MOLECULE: f64 = 2.34 * 1.673_532_84e-24;

/// Murphy & Koop (2005), eq. 7, g/cm^3.
fn saturated(t: f64) -> f64 {
    let log = 9.550426 - 5723.265 / t + 3.53068 * t.ln() - 0.007_283_32 * t;
    10.0 * log.exp() * WATER / (BOLTZMANN * t)
}

fn arrival(t: f64) -> f64 {
    (BOLTZMANN * t / WATER / TAU).sqrt()
}

/// Densities of ice and of rock, g/cm^3.
const ICE: f64 = 0.92;
const ROCK: f64 = 3.3;

/// Mass fraction of the ice.
const PART: f64 = 0.5;

/// Uniform gas at 170 K and dust of density `dust` in it.
struct Case {
    dust: f64,
    /// Density of the vapour at the start.
    vapour: f64,
    /// Step by the time of the exchange, and the number of steps.
    step: f64,
    number: u32,
    /// Radii of grains, dealt out in turn.
    radii: &'static [f64],
}

const GAS: f64 = 1e-10;
const RADIUS: f64 = 0.1;

impl Case {
    /// Radius of the core, by that of the grain.
    fn core() -> f64 {
        let (ice, rock) = (PART / ICE, (1.0 - PART) / ROCK);
        (rock / (ice + rock)).cbrt()
    }

    /// Mass of a grain of this radius.
    fn grain(radius: f64) -> f64 {
        4.0 / 3.0 * PI * radius.powi(3) / (PART / ICE + (1.0 - PART) / ROCK)
    }

    /// Surface of all grains a volume.
    fn surface(&self) -> f64 {
        let all = self.radii.iter();
        let surface = all.map(|&s| 4.0 * PI * s * s / Self::grain(s));
        self.dust * surface.sum::<f64>() / self.radii.len() as f64
    }

    /// The time of the exchange.
    fn time(&self) -> f64 {
        1.0 / (arrival(T) * self.surface())
    }

    /// Density of the vapour at the end, of one size in gas that fills the part `filled` of the box.
    fn exact(&self, filled: f64) -> f64 {
        const STEPS: u32 = 20_000;
        let thickness = (1.0 - Self::core()) * RADIUS;
        let number = self.dust / filled / Self::grain(RADIUS);
        let vapour = |l: f64| {
            let l = l.min(thickness);
            let lost = l * (3.0 * RADIUS * (RADIUS - l) + l * l);
            self.vapour + number * 4.0 / 3.0 * PI * ICE * lost
        };
        // After so many times of the exchange nothing is left to happen.
        let end = (self.step * f64::from(self.number)).min(100.0) * self.time();
        let dt = end / f64::from(STEPS);
        let rate = |l: f64| arrival(T) / ICE * (saturated(T) - vapour(l));
        let mut l = 0.0;
        for _ in 0..STEPS {
            let a = rate(l);
            let b = rate(l + 0.5 * dt * a);
            let c = rate(l + 0.5 * dt * b);
            l += dt / 6.0 * (a + 2.0 * b + 2.0 * c + rate(l + dt * c));
        }
        vapour(l)
    }

    /// A box so large that sound crosses the distance of its particles in ten steps.
    fn trial(&self) -> Trial {
        let c = (BOLTZMANN * T / MOLECULE).sqrt();
        let dt = self.step * self.time();
        let (spacing, end) = (10.0 * c * dt, dt * f64::from(self.number));
        let side = 8.0 * spacing;
        let block = format!(
            "lo = [0, 0, 0]\nhi = [{side}, {side}, {side}]\nlattice = \"bcc\"\nspacing = {spacing}\n"
        );
        let text = format!(
            "[run]\nend_time = {end}\ntime_step = {dt}\n[units]\nsystem = \"cgs\"\n\
             [domain]\nkind = \"periodic\"\nsize = [{side}, {side}, {side}]\n\
             [gas.eos]\nkind = \"isothermal\"\nsound_speed = {c}\nmean_molecular_weight = 2.34\n\
             [[gas.block]]\n{block}density = {GAS}\n\
             [dust]\nsize = {RADIUS}\n[[dust.block]]\n{block}density = {}\n\
             [dust.composition]\nice = {PART}\nsilicate = {}\n[gravity]\nmethod = \"none\"\n",
            self.dust,
            1.0 - PART
        );
        let shift = 0.1 * spacing * Vec3::new(0.3, 0.8, 0.5);
        let trial = Trial::prepared(&text, &[], |gas, dust| {
            gas.vapour.fill(self.vapour / GAS);
            dust.x.iter_mut().for_each(|x| *x += shift);
            let radii = self.radii.iter().cycle();
            (dust.grain_radius.iter_mut().zip(radii)).for_each(|(s, own)| *s = *own);
        });
        trial.unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
    }

    fn run(&self) -> Ends {
        let mut trial = self.trial();
        let end = trial.scene.run.end_time;
        let side = trial.scene.domain.size().map_or(1.0, |size| size.x);
        let mut seen = Vec::new();
        let done = trial.run(&[0.0, end], |stop| {
            let gas = &stop.system.gas;
            let volumes = gas.particles.m.iter().zip(&gas.derived.rho);
            let volume: f64 = volumes.map(|(m, rho)| m / rho).sum();
            seen.push((water(stop), volume, stop.books.error_mass));
        });
        done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        Ends {
            start: seen[0].0,
            end: seen[1].0,
            volume: seen[1].1,
            filled: seen[1].1 / side.powi(3),
            mass: seen[1].2,
        }
    }
}

/// Masses of vapour and ice at the start and at the end of a run.
struct Ends {
    start: [f64; 2],
    end: [f64; 2],
    /// Volume of the gas, and by that of the box.
    volume: f64,
    filled: f64,
    /// Error of the mass in sum.
    mass: f64,
}

/// Masses of vapour and ice.
fn water(stop: &Stop) -> [f64; 2] {
    let (gas, dust) = (&stop.system.gas.particles, &stop.system.dust.particles);
    let vapour = sum::ordered(gas.m.len(), 0.0, |range| {
        range.map(|j| gas.m[j] * gas.vapour[j]).sum()
    });
    let ice = sum::ordered(dust.m.len(), 0.0, |range| {
        range.map(|i| dust.m[i] * dust.composition[i].x).sum()
    });
    [vapour, ice]
}

/// One size, from dry gas, by steps of many lengths. Where the area shrinks, errors are of second order: some 0.01 of the square of the step.
fn transients(rows: &mut Vec<Row>) {
    for (step, bars) in [
        (1e-6, [1e-12, 1e-8]),
        (1e-3, [1.5e-8, 1e-6]),
        (0.1, [1e-4, 1e-3]),
        (1.0, [2e-4, 1e-2]),
        (10.0, [1e-12, 1e-8]),
        (1e3, [1e-12, 1e-8]),
        (1e6, [1e-12, 1e-8]),
    ] {
        let case = Case {
            dust: 3.0 * saturated(T),
            vapour: 0.0,
            step,
            number: 6,
            radii: &[RADIUS],
        };
        let ends = case.run();
        let error = ends.end[0] / ends.volume / case.exact(ends.filled) - 1.0;
        let what = |of: &str| format!("steps of {step:e} exchange times: {of}");
        rows.push(Row::new(what("vapour"), error, Bar::Limit(bars)));
        rows.push(Row::new(
            what("mass"),
            ends.mass,
            Bar::Limit([1e-14, 1e-12]),
        ));
    }
}

/// Several sizes: in balance, or without ice.
fn balances(rows: &mut Vec<Row>) {
    const SIZES: &[f64] = &[0.01, 0.1, 0.03, 1.0];
    let rho = saturated(T);
    for (dust, vapour, what) in [
        (30.0 * rho, 0.0, "four sizes in dry gas"),
        (0.3 * rho, 5.0 * rho, "four sizes in steam"),
        (0.3 * rho, 0.0, "four sizes, less ice than the gas takes"),
    ] {
        let case = Case {
            dust,
            vapour,
            step: 1e6,
            number: 3,
            radii: SIZES,
        };
        let Ends {
            start, end, volume, ..
        } = case.run();
        let all = start[0] + start[1];
        let error = end[0] / all.min(rho * volume) - 1.0;
        let lost = (end[0] + end[1]) / all - 1.0;
        let row = |of: &str, error| {
            let what = format!("{what}: {of}");
            Row::new(what, error, Bar::Limit([1e-12, 1e-8]))
        };
        rows.push(row("vapour", error));
        rows.push(row("water", lost));
    }
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    transients(&mut rows);
    balances(&mut rows);
    disk::add(&mut rows);
    rows
}
