//! What shear makes of an ordered arrangement of gas particles (the problem of Imaeda & Inutsuka 2002, ApJ 569, 501), scheme by scheme, and what
//! rearrangement by position makes of that.
//!
//! 2500 particles in the plane, 5 scale heights square, in a Keplerian shearing box: the exact answer is that nothing happens. Told are the root
//! mean squares of the density about its mean and of the velocity relative to the shear, from a glass, without and with `gas.rearrange`; for comparison
//! a lattice that shear carries along, and random points. Judged: what rearrangement leaves of the noise between orbits 3 and 5.
//! Told for one scheme: the same where particles are placed by the continuity equation, and how often that can be solved.
//! Diffusion: a wave of v_z across the shear, on which no force acts, decays by exp(-nu k^2 t), nu by what mixes particles or exchanges velocity.
//! A picture of the noise over time is left in `shearing-glass.png`.

use std::f64::consts::TAU;
use std::path::Path;

use coupling::System;
use kuva::prelude::{Layout, LegendPosition, LinePlot, Plot};
use nbody::points::Vec3;
use nbody::points::random::Purpose;

use super::{Bar, Row};
use crate::initial::lattice::Block;
use crate::trial::Trial;

const SCENE: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [5.0, 5.0, 1.0]
dimensions = 2
rate = 1.0
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [5.0, 5.0, 1.0]
spacing = 0.1
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
"#;

const SIDE: f64 = 5.0;
const SPACING: f64 = 0.1;

/// A scheme's name, and what it overrides of the scene.
type Scheme = (&'static str, &'static [&'static str]);

const SCHEMES: [Scheme; 6] = [
    ("no viscosity", &["gas.viscosity.kind=\"none\""]),
    ("constant", &["gas.viscosity.kind=\"constant\""]),
    ("Balsara", &["gas.viscosity.kind=\"balsara\""]),
    ("Cullen & Dehnen", &["gas.viscosity.kind=\"cullen-dehnen\""]),
    (
        "pressure-energy, Cullen & Dehnen",
        &[
            "gas.viscosity.kind=\"cullen-dehnen\"",
            "gas.hydro.formulation=\"pressure\"",
        ],
    ),
    (
        "matrix gradients, Cullen & Dehnen",
        &[
            "gas.viscosity.kind=\"cullen-dehnen\"",
            "gas.hydro.gradient=\"matrix\"",
        ],
    ),
];

/// Rearranged as far as one shift a base step goes.
const REARRANGED: &str = "gas.rearrange.strength=20.0";

/// Placed by the continuity equation, and the schemes for which that is tried.
const PLACED: &str = "gas.rearrange.kind=\"continuity\"";
/// The scheme that places are solved for with.
const TRIED: usize = 3;
/// With base steps that resolve what sound does between particles.
const SHORT: &str = "run.time_step=0.02";
/// How many of the times are waited for then: places take more and more iterations.
const FEW: usize = 4;

/// Times in orbits; the last three are late.
const TIMES: [f64; 8] = [0.0, 0.1, 0.3, 1.0, 2.0, 3.0, 4.0, 5.0];
const LATE: usize = 3;
/// Those that are told.
const TOLD: [f64; 3] = [0.1, 1.0, 5.0];
const PICTURE: &str = "shearing-glass.png";

/// Amplitude of the wave of v_z by the sound speed, and its wave number.
const WAVE: f64 = 0.01;
const WAVE_NUMBER: f64 = 2.0 * TAU / SIDE;

/// Noise at a time: of the density by its mean, of the velocity by that of sound; and the wave's amplitude by its first.
#[derive(Clone, Copy)]
struct Noise {
    orbits: f64,
    rho: f64,
    v: f64,
    wave: f64,
}

impl Noise {
    fn of(system: &System) -> Self {
        let gas = &system.gas;
        let (p, n) = (&gas.particles, gas.len() as f64);
        let mean = |of: &dyn Fn(usize) -> f64| (0..gas.len()).map(of).sum::<f64>() / n;
        let rho = mean(&|i| gas.derived.rho[i]);
        let relative = |i: usize| system.domain.relative(p.x[i], p.v[i]);
        Self {
            orbits: system.clock.time() / TAU,
            rho: mean(&|i| (gas.derived.rho[i] / rho - 1.0).powi(2)).sqrt(),
            v: mean(&|i| relative(i).xy().norm_squared()).sqrt(),
            wave: 2.0 / WAVE * mean(&|i| p.v[i].z * (WAVE_NUMBER * p.x[i].x).sin()),
        }
    }
}

/// Starts a scheme's gas as a lattice, a glass or at random.
fn trial(start: &str, scheme: &[&str], more: &[&str]) -> Trial {
    let overrides = scheme.iter().chain(more);
    let mut overrides: Vec<String> = overrides.map(|&o| o.to_owned()).collect();
    if start == "random" {
        overrides.push("gas.block.0.lattice=\"random\"".to_owned());
    }
    let settle = |gas: &mut gas::Particles| {
        let block = Block {
            lo: Vec3::zeros(),
            hi: Vec3::new(SIDE, SIDE, 1.0),
            axes: [true, true, false],
        };
        if start == "glass" {
            gas.x = block.glass(SPACING, 1, Purpose::GasPositions);
        }
        for (v, x) in gas.v.iter_mut().zip(&gas.x) {
            let wave = WAVE * (WAVE_NUMBER * x.x).sin();
            *v = Vec3::new(0.0, -1.5 * (x.x - 0.5 * SIDE), wave);
        }
    };
    Trial::new(SCENE, &overrides, settle)
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
}

/// The noise over time.
fn run(mut trial: Trial, times: &[f64]) -> Vec<Noise> {
    follow(&mut trial, times)
}

/// The noise over time, of a trial that tells more.
fn follow(trial: &mut Trial, times: &[f64]) -> Vec<Noise> {
    let stops: Vec<f64> = times.iter().map(|orbits| orbits * TAU).collect();
    let mut noise = Vec::new();
    let done = trial.run(&stops, |stop| noise.push(Noise::of(stop.system)));
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    noise
}

/// Mean over the late times.
fn late(noise: &[Noise], of: impl Fn(&Noise) -> f64) -> f64 {
    noise[noise.len() - LATE..].iter().map(of).sum::<f64>() / LATE as f64
}

/// nu / c H of the wave, from its start to the first late time.
fn diffusion(noise: &[Noise]) -> f64 {
    let (first, last) = (noise[0], noise[noise.len() - LATE]);
    let time = (last.orbits - first.orbits) * TAU;
    (first.wave / last.wave).ln() / (WAVE_NUMBER * WAVE_NUMBER * time)
}

/// What placing particles by the continuity equation makes of a scheme's noise, how its solves went, and what it costs.
fn placed((name, scheme): Scheme) -> Vec<Row> {
    let mut trials = [&[SHORT][..], &[SHORT, PLACED][..]].map(|more| trial("glass", scheme, more));
    let noise = trials.each_mut().map(|trial| follow(trial, &TIMES[..FEW]));
    let cost = trials.each_ref().map(Trial::cpu_s);
    let solves = trials[1].system.solves;
    let count = solves.count as f64;
    let both = |of: fn(&Noise) -> f64| noise.each_ref().map(|noise| late(noise, of));
    let ratio = |[without, with]: [f64; 2]| with / without;
    let converged = 1.0 - solves.failed as f64 / count;
    [
        ("late density", late(&noise[1], |at| at.rho)),
        ("late velocity by that of sound", late(&noise[1], |at| at.v)),
        (
            "late noise of density, placed by not",
            ratio(both(|at| at.rho)),
        ),
        (
            "late noise of velocity, placed by not",
            ratio(both(|at| at.v)),
        ),
        ("part of the solves that converge", converged),
        ("iterations a solve", solves.iterations as f64 / count),
        ("residual before a solve", solves.before / count),
        ("residual after a solve", solves.after / count),
        ("CPU time, placed by not", cost[1] / cost[0]),
    ]
    .map(|(what, measured)| {
        Row::new(
            format!("glass placed by continuity, {name}: {what}"),
            measured,
            Bar::None,
        )
    })
    .into()
}

pub fn rows() -> Vec<Row> {
    let told = |what: String, measured: f64| Row::new(what, measured, Bar::None);
    let random = run(trial("random", SCHEMES[0].1, &[]), &TIMES[..1]);
    let mut rows = vec![told("random points: density".to_owned(), random[0].rho)];
    let lattice = run(trial("lattice", SCHEMES[3].1, &[]), &TIMES);
    rows.push(Row::new(
        "lattice, Cullen & Dehnen, 5.0 orbits: density",
        lattice[TIMES.len() - 1].rho,
        Bar::Limit(LATTICE),
    ));
    let mut panels = [("glass", Vec::new()), ("glass, rearranged", Vec::new())];
    for ((name, scheme), ratio) in SCHEMES.into_iter().zip(RATIOS) {
        let both =
            [&[][..], &[REARRANGED][..]].map(|more| run(trial("glass", scheme, more), &TIMES));
        for (noise, (start, curves)) in both.iter().zip(&mut panels) {
            for at in noise.iter().filter(|at| is_told(at.orbits)) {
                let what = format!("{start}, {name}, {:.1} orbits: density", at.orbits);
                rows.push(told(what, at.rho));
            }
            let what = |of: &str| format!("{start}, {name}: {of}");
            rows.push(told(
                what("late velocity by that of sound"),
                late(noise, |at| at.v),
            ));
            rows.push(told(what("diffusion by c H"), diffusion(noise)));
            curves.push((name, noise.clone()));
        }
        for (what, of, bar) in [
            ("density", (|at| at.rho) as fn(&Noise) -> f64, ratio),
            ("velocity", |at| at.v, Bar::Limit(QUIETER)),
        ] {
            let [without, with] = [0, 1].map(|k| late(&both[k], of));
            let what = format!("{name}: late noise of {what}, rearranged by not");
            rows.push(Row::new(what, with / without, bar));
        }
    }
    rows.extend(placed(SCHEMES[TRIED]));
    match picture(&panels) {
        Ok(()) => println!("| picture: {PICTURE} | | | | | |"),
        Err(error) => println!("| no picture: {error} | | | | | |"),
    }
    rows
}

/// A lattice of inversion symmetry has no forces however it is sheared: rounding, and the tolerance of h.
const LATTICE: [f64; 2] = [1e-3, 1e-2];

/// What rearrangement may leave of the noise of the density, by scheme. Without viscosity it leaves 0.083; with one between 0.9 and 1.1, which is what the
/// late times of one run scatter by.
const RATIOS: [Bar; 6] = [
    Bar::Limit([0.12, 0.16]),
    Bar::None,
    Bar::None,
    Bar::None,
    Bar::None,
    Bar::None,
];

/// And of that of the velocity: 0.76 to 0.86 with a viscosity, 0.03 without.
const QUIETER: [f64; 2] = [0.9, 0.97];

fn is_told(orbits: f64) -> bool {
    TOLD.iter().any(|told| (orbits / told - 1.0).abs() < 1e-6)
}

type Curves = Vec<(&'static str, Vec<Noise>)>;

/// Logarithms of the density's noise over those of time, without and with rearrangement side by side.
fn picture(panels: &[(&str, Curves)]) -> Result<(), String> {
    const COLORS: [&str; 6] = [
        "#7f7f7f", "#1f77b4", "#2ca02c", "#d62728", "#9467bd", "#8c564b",
    ];
    let panel = |(start, curves): &(&str, Curves)| {
        let line = |((name, noise), color): (&(&'static str, Vec<Noise>), &'static str)| {
            let seen = noise.iter().filter(|at| at.orbits > 0.0 && at.rho > 0.0);
            let points: Vec<(f64, f64)> =
                seen.map(|at| (at.orbits.log10(), at.rho.log10())).collect();
            let line = LinePlot::new().with_data(points).with_color(color);
            Plot::Line(line.with_stroke_width(2.0).with_legend(*name))
        };
        let plots: Vec<Plot> = curves.iter().zip(COLORS).map(line).collect();
        let layout = Layout::auto_from_plots(&plots)
            .with_x_label(format!("log orbits, {start}"))
            .with_y_label("log rms of density")
            .with_box_axes()
            .with_legend_position(LegendPosition::OutsideBottomCenter);
        (plots, layout)
    };
    let title = "Noise in a shearing box";
    let panels: Vec<_> = panels.iter().map(panel).collect();
    crate::plot::save(panels, 2, title, Path::new(PICTURE)).map(|_| ())
}
