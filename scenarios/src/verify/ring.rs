//! A cold ring about a star in the plane: how long a scheme lets it live (Cullen & Dehnen 2010, section 4.5).
//!
//! Sigma ~ exp(-(R - 10)^2 / 2 s^2), s = 1.25, G M = 1000: the orbital period at R = 10 is 2 pi. Isothermal with c_s = 0.01, a thousandth of
//! the orbital speed: pressure does next to nothing, and the exact solution stays as it is. Particles of equal mass stand on rings, each
//! turned by a golden section against the last. Where masses are equal and P / rho is one constant, volumes by sums of mass, pressure, number
//! or smoothed energy are the same, so that one row stands for all formulations; viscosities and gradients are what is left to choose. Survived: orbits until the masses of rings of width s / 2 within 3 s differ by 10 % of the
//! ring's mass, sum |m - m_0| / M.
//! Torques on the particles that begin outside R = 10, from the rest of the gas: by viscosity, by pressure; by the star, none.

use std::f64::consts::TAU;

use coupling::System;
use gas::Particles;
use nbody::points::{Columns, Vec3};

use super::viscous::Inviscid;
use super::{Bar, Row, sheet};
use crate::trial::Trial;

const MIDDLE: f64 = 10.0;
const WIDTH: f64 = 1.25;
const MU: f64 = 1000.0;
const RINGS: usize = 12;
const CELLS: usize = 1 << 16;

/// What became of a ring.
#[derive(Clone, Copy, Debug, Default)]
pub struct Life {
    /// Orbits until 10 % of the mass were elsewhere; as long as the run was, if that never happened.
    pub survived: f64,
    pub died: bool,
    /// sum |m - m_0| / M at the end.
    pub change: f64,
    /// Root mean square of the radial velocity by the sound speed, and of the semi-major axes' change by the ring's width, at the end.
    pub noise: f64,
    pub wander: f64,
    /// Change of the outer half's angular momentum by that of the ring, an orbit, over all of its life; and the parts that
    /// viscosity and pressure account for, from samples of both.
    pub torque: [f64; 3],
    /// The same torque over the first quarter of an orbit.
    pub first_torque: f64,
    pub error_angular_momentum: f64,
    /// CPU time, s, and a particle's update, us.
    pub cpu_s: f64,
    pub update: f64,
}

/// How pairs act: by either gradient, or with velocities followed to the middle of pairs, which viscosities between pairs allow.
const WAYS: [(&str, &str); 3] = [
    (
        "standard",
        "[gas.hydro]\nprecision = \"single\"\n[gas.viscosity]\n",
    ),
    (
        "matrix",
        "[gas.hydro]\nprecision = \"single\"\ngradient = \"matrix\"\n[gas.viscosity]\n",
    ),
    (
        LINEAR,
        "[gas.hydro]\nprecision = \"single\"\n[gas.viscosity]\nreconstruction = \"linear\"\n",
    ),
];
const LINEAR: &str = "standard, linear";
const BETWEEN_PAIRS: [&str; 4] = ["constant", "balsara", "cullen-dehnen", "planar-switch"];

pub const VISCOSITIES: [&str; 8] = [
    "none",
    "constant",
    "balsara",
    "cullen-dehnen",
    "neumann-richtmyer",
    "tensor",
    "planar",
    "planar-switch",
];

const PARTICLES: usize = 16_000;
const ORBITS: usize = 100;
/// An orbit; the shear turns a particle's neighbourhood over in a sixth of it.
const SAMPLES: usize = 32;

/// Text of a scheme.
fn scheme(keys: &str, viscosity: &str) -> String {
    format!("{keys}kind = \"{viscosity}\"\n")
}

/// All schemes: the name of the way, its keys and the viscosity.
fn schemes() -> impl Iterator<Item = (&'static str, &'static str, &'static str)> {
    WAYS.into_iter().flat_map(|(way, keys)| {
        let allowed = VISCOSITIES.into_iter();
        allowed
            .filter(move |kind| way != LINEAR || BETWEEN_PAIRS.contains(kind))
            .map(move |kind| (way, keys, kind))
    })
}

/// Prints the table of gradients and viscosities, and that of the Reynolds numbers; judged is the best entry that has a viscosity.
pub fn rows() -> Vec<Row> {
    let row = |what: String, measured, bar| Row {
        what,
        measured,
        uncertainty: 0.0,
        bar,
    };
    let mut best: f64 = 0.0;
    println!(
        "| gradients | viscosity | orbits | change of mass | v_R / c_s | da / s | torque | viscous | by pressure | us an update |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (gradient, keys, viscosity) in schemes() {
        match life(PARTICLES, ORBITS, &scheme(keys, viscosity), &[], |_| {}) {
            Ok(life) => {
                if viscosity != "none" && life.survived > best {
                    best = life.survived;
                }
                let [all, viscous, pressure] = life.torque;
                println!(
                    "| {gradient} | {viscosity} | {}{} | {:.3} | {:.2} | {:.4} | {all:.1e} | {viscous:.1e} | {pressure:.1e} | {:.2} |",
                    if life.died { "" } else { "> " },
                    life.survived,
                    life.change,
                    life.noise,
                    life.wander,
                    life.update
                );
            }
            Err(fault) => println!("| {gradient} | {viscosity} | {fault} | | | | | | | |"),
        }
    }
    let mut rows = vec![row(
        "orbits that the best scheme with viscosity survived".to_owned(),
        best,
        Bar::Least([100.0, 10.0]),
    )];
    for viscosity in ["constant", "balsara"] {
        let reynolds = [4_000, 16_000, 64_000].map(|n| {
            let life = life(n, 1, &scheme(WAYS[0].1, viscosity), &[], |_| {});
            let torque = life.map_or(f64::NAN, |life| life.first_torque);
            reynolds(torque)
        });
        for (n, re) in ["4 000", "16 000", "64 000"].iter().zip(reynolds) {
            rows.push(row(
                format!("Re of {n} particles, {viscosity}"),
                re,
                Bar::None,
            ));
        }
        rows.push(row(
            format!("slope of ln Re in ln N, {viscosity} (1/2 where nu goes with h, 1 where with h^2; 1/3 and 2/3 in space)"),
            (reynolds[2] / reynolds[0]).ln() / 16f64.ln(),
            Bar::None,
        ));
    }
    rows
}

/// R^2 Omega / nu of the viscosity whose torque 3 pi nu Sigma R^2 Omega at the middle of the ring is `torque` an orbit, by the ring's
/// angular momentum.
fn reynolds(torque: f64) -> f64 {
    let nu = torque / TAU * MIDDLE * WIDTH * TAU.sqrt() / 1.5;
    MIDDLE * MIDDLE / nu
}

/// The scene of `n` particles or about as many; `scheme` is further text of it.
fn scene(n: usize, scheme: &str) -> String {
    let keys = format!("[gas.eos]\nkind = \"isothermal\"\nsound_speed = 0.01\n{scheme}");
    sheet::scene(n, (MU, 0.5), &keys)
}

/// The ring's particles: as many on each of its circles as keep them as far apart along it as the circles are.
fn lay_out(gas: &mut Particles) {
    let wanted = gas.len();
    let quantiles = quantiles();
    let radius =
        |done: f64| quantiles[((done / wanted as f64 * CELLS as f64) as usize).min(CELLS - 1)];
    // A particle's cell has sides of the root of M / (N Sigma), with M = 2 pi R_0 s sqrt(2 pi) where Sigma is one.
    let mass = TAU * MIDDLE * WIDTH * TAU.sqrt();
    let mut x = Vec::with_capacity(wanted);
    let (mut turn, mut done) = (0.0, 0.0);
    while done < wanted as f64 {
        let r = radius(done + 0.5);
        let spacing = (mass / (wanted as f64 * bell(r))).sqrt();
        let around = (TAU * r / spacing).round().clamp(1.0, wanted as f64 - done);
        let r = radius(done + 0.5 * around);
        x.extend((0..around as usize).map(|k| (r, TAU * k as f64 / around + turn)));
        turn += TAU * 0.618_033_988_75 / around;
        done += around;
    }
    x.truncate(wanted);
    gas.resize(x.len());
    for (i, &(r, phase)) in x.iter().enumerate() {
        gas.id[i] = i as u64;
        let (sin, cos) = phase.sin_cos();
        gas.x[i] = r * Vec3::new(cos, sin, 0.0);
        gas.v[i] = (MU / r).sqrt() * Vec3::new(-sin, cos, 0.0);
        gas.m[i] = 1e-6 / wanted as f64;
        gas.h[i] = 0.0;
    }
}

fn bell(r: f64) -> f64 {
    (-0.5 * ((r - MIDDLE) / WIDTH).powi(2)).exp()
}

/// Radii that hold equal parts of the mass, CELLS of them, from six widths inside to six outside.
fn quantiles() -> Vec<f64> {
    let cell = 12.0 * WIDTH / CELLS as f64;
    let edge = |k: usize| MIDDLE + WIDTH * (12.0 * k as f64 / CELLS as f64 - 6.0);
    let mut sums = vec![0.0];
    for k in 0..CELLS {
        let r = edge(k) + 0.5 * cell;
        sums.push(sums[k] + r * bell(r) * cell);
    }
    let mut k = 0;
    let of = |part: usize| {
        let wanted = (part as f64 + 0.5) / CELLS as f64 * sums[CELLS];
        while sums[k + 1] < wanted {
            k += 1;
        }
        edge(k) + cell * (wanted - sums[k]) / (sums[k + 1] - sums[k])
    };
    (0..CELLS).map(of).collect()
}

/// Masses of the rings within three widths, by that of all.
fn masses(gas: &Particles) -> [f64; RINGS] {
    let mut masses = [0.0; RINGS];
    let all: f64 = gas.m.iter().sum();
    for (x, m) in gas.x.iter().zip(&gas.m) {
        // Shared between the two nearest rings: particles stand on circles, which no edge is to cut off at once.
        let place = ((x.xy().norm() - MIDDLE) / (6.0 * WIDTH) + 0.5) * RINGS as f64 - 0.5;
        let part = place - place.floor();
        for (ring, part) in [(place.floor(), 1.0 - part), (place.floor() + 1.0, part)] {
            if (0.0..RINGS as f64).contains(&ring) {
                masses[ring as usize] += part * m / all;
            }
        }
    }
    masses
}

/// The angular momentum of those of the `n` identities that begin outside, and that of all.
fn outer(system: &System, n: usize) -> [f64; 2] {
    let gas = &system.gas.particles;
    let mut sums = [0.0; 2];
    for i in 0..gas.len() {
        let l = gas.m[i] * gas.x[i].cross(&gas.v[i]).z;
        sums[0] += if gas.id[i] >= n as u64 / 2 { l } else { 0.0 };
        sums[1] += l;
    }
    sums
}

/// The torques on that half by viscosity and by pressure.
fn torques(system: &System, n: usize, inviscid: &Inviscid) -> [f64; 2] {
    let p = &system.gas.particles;
    let torque = |a: &[Vec3]| -> f64 {
        let outside = (0..p.len()).filter(|&i| p.id[i] >= n as u64 / 2);
        outside.map(|i| p.m[i] * p.x[i].cross(&a[i]).z).sum()
    };
    let pressure = torque(&inviscid.pushes(system));
    [torque(&system.gas.rates.hydro) - pressure, pressure]
}

/// The angular momenta of the outer half and of the ring at the first sample, that of the half at the last, and its torques summed by trapezoids.
#[derive(Default)]
struct Budget {
    start: Option<(f64, [f64; 2])>,
    last: (f64, f64),
    torques: [f64; 2],
    sums: [f64; 2],
}

impl Budget {
    fn add(&mut self, orbits: f64, momenta: [f64; 2], torques: [f64; 2]) {
        if self.start.is_some() {
            for (sum, (a, b)) in self.sums.iter_mut().zip(self.torques.iter().zip(torques)) {
                *sum += 0.5 * (a + b) * (orbits - self.last.0) * TAU;
            }
        }
        self.start.get_or_insert((orbits, momenta));
        (self.last, self.torques) = ((orbits, momenta[0]), torques);
    }

    /// Change and parts, an orbit, by the angular momentum of the ring at the start; what the star swallows is in the change alone.
    fn mean(&self) -> [f64; 3] {
        let (began, [from, ring]) = self.start.unwrap_or_default();
        let scale = 1.0 / (ring * (self.last.0 - began));
        [self.last.1 - from, self.sums[0], self.sums[1]].map(|part| part * scale)
    }
}

/// Runs a ring of `n` particles for up to `orbits`, or says why not; `watch` sees what has become of it SAMPLES times an orbit.
pub fn life(
    n: usize,
    orbits: usize,
    scheme: &str,
    overrides: &[String],
    mut watch: impl FnMut(&Life),
) -> Result<Life, String> {
    let mut trial = Trial::new(&scene(n, scheme), overrides, lay_out)?;
    let n = trial.system.gas.len();
    let inviscid = Inviscid::of(&trial);
    let mut life = Life::default();
    let (mut first, mut axes) = (None, Vec::new());
    let stops: Vec<f64> = (0..=orbits * SAMPLES)
        .map(|k| TAU * k as f64 / SAMPLES as f64)
        .collect();
    let mut budget = Budget::default();
    let mut alive = true;
    trial
        .run_while(&stops, |stop| {
            let gas = &stop.system.gas.particles;
            let now = masses(gas);
            let time = stop.system.clock.time() / TAU;
            budget.add(
                time,
                outer(stop.system, n),
                torques(stop.system, n, &inviscid),
            );
            if let Some(first) = first {
                let first: [f64; RINGS] = first;
                life.change = (first.iter().zip(&now)).map(|(a, b)| (a - b).abs()).sum();
                life.torque = budget.mean();
                if time < 0.26 {
                    life.first_torque = life.torque[0];
                }
            } else {
                first = Some(now);
                axes = semi_major_axes(gas, gas.len());
            }
            alive = life.change.is_finite() && life.change < 0.1;
            life.survived = time;
            let radial = |(x, v): (&Vec3, &Vec3)| (x.dot(v) / x.norm() / 0.01).powi(2);
            life.noise =
                (gas.x.iter().zip(&gas.v).map(radial).sum::<f64>() / gas.len() as f64).sqrt();
            let apart = axes
                .iter()
                .zip(&semi_major_axes(gas, axes.len()))
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>();
            life.wander = (apart / gas.len() as f64).sqrt() / WIDTH;
            life.error_angular_momentum = stop.books.error_angular_momentum;
            life.cpu_s = stop.watch.cpu_s();
            watch(&life);
            alive
        })
        .map_err(|fault| fault.to_string())?;
    life.died = !alive;
    life.cpu_s = trial.cpu_s();
    life.update = trial.cpu_s() / trial.updates() as f64 * 1e6;
    Ok(life)
}

/// Semi-major axes in the order of the identities of `n` particles; zero of those that the star has.
fn semi_major_axes(gas: &Particles, n: usize) -> Vec<f64> {
    let mut axes = vec![0.0; n];
    for i in 0..gas.len() {
        axes[gas.id[i] as usize] = 1.0 / (2.0 / gas.x[i].norm() - gas.v[i].norm_squared() / MU);
    }
    axes
}
