//! What shear makes of an ordered arrangement of gas particles (the problem of Imaeda & Inutsuka 2002, ApJ 569, 501), scheme by scheme.
//!
//! 400 particles in the plane, 2 scale heights square, in a Keplerian shearing box without any perturbation: the exact answer is that nothing
//! happens. Told are the root mean squares of the density about its mean, of the velocity relative to the shear, and of the acceleration by pairs,
//! from a lattice and from a glass, and for comparison the density of the same number of random points. A picture of the density over time is
//! left in `shearing-glass.png`.

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
size = [2.0, 2.0, 1.0]
dimensions = 2
rate = 1.0
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [2.0, 2.0, 1.0]
spacing = 0.1
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
"#;

/// Names of schemes, and what they override of the scene.
const SCHEMES: [(&str, &[&str]); 5] = [
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
];

/// Times in orbits.
const TIMES: [f64; 8] = [0.0, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0];
/// Those that are told.
const TOLD: [f64; 4] = [0.1, 1.0, 5.0, 10.0];
const PICTURE: &str = "shearing-glass.png";

/// Noise at a time: of the density by its mean, of velocity and acceleration by those of sound.
#[derive(Clone, Copy)]
struct Noise {
    orbits: f64,
    rho: f64,
    v: f64,
    a: f64,
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
            v: mean(&|i| relative(i).norm_squared()).sqrt(),
            a: mean(&|i| gas.rates.hydro[i].norm_squared()).sqrt(),
        }
    }
}

/// The noise over time of gas that starts as a lattice, a glass or at random.
fn run(start: &str, scheme: &[&str], times: &[f64]) -> Vec<Noise> {
    let mut overrides: Vec<String> = scheme.iter().map(|&o| o.to_owned()).collect();
    if start == "random" {
        overrides.push("gas.block.0.lattice=\"random\"".to_owned());
    }
    let settle = |gas: &mut gas::Particles| {
        if start != "glass" {
            return;
        }
        let block = Block {
            lo: Vec3::zeros(),
            hi: Vec3::new(2.0, 2.0, 1.0),
            axes: [true, true, false],
        };
        gas.x = block.glass(0.1, 1, Purpose::GasPositions);
        for (v, x) in gas.v.iter_mut().zip(&gas.x) {
            *v = Vec3::new(0.0, -1.5 * (x.x - 1.0), 0.0);
        }
    };
    let mut trial = Trial::new(SCENE, &overrides, settle)
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let stops: Vec<f64> = times.iter().map(|orbits| orbits * TAU).collect();
    let mut noise = Vec::new();
    let done = trial.run(&stops, |stop| noise.push(Noise::of(stop.system)));
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    noise
}

pub fn rows() -> Vec<Row> {
    let told = |what: String, measured: f64| Row {
        what,
        measured,
        uncertainty: 0.0,
        bar: Bar::None,
    };
    let random = run("random", SCHEMES[0].1, &TIMES[..1]);
    let mut rows = vec![told("random points: density".to_owned(), random[0].rho)];
    let mut panels = Vec::new();
    for start in ["lattice", "glass"] {
        let mut curves = Vec::new();
        for (name, scheme) in SCHEMES {
            let noise = run(start, scheme, &TIMES);
            for at in noise.iter().filter(|at| is_told(at.orbits)) {
                let what = |of: &str| format!("{start}, {name}, {:.1} orbits: {of}", at.orbits);
                rows.push(told(what("density"), at.rho));
                if at.orbits > 9.0 {
                    rows.push(told(what("velocity by that of sound"), at.v));
                    rows.push(told(what("acceleration by c Omega"), at.a));
                }
            }
            curves.push((name, noise));
        }
        panels.push((start, curves));
    }
    match picture(&panels) {
        Ok(()) => println!("| picture: {PICTURE} | | | | | |"),
        Err(error) => println!("| no picture: {error} | | | | | |"),
    }
    rows
}

fn is_told(orbits: f64) -> bool {
    TOLD.iter().any(|told| (orbits / told - 1.0).abs() < 1e-6)
}

type Curves = Vec<(&'static str, Vec<Noise>)>;

/// Logarithms of the density's noise over those of time, lattice and glass side by side.
fn picture(panels: &[(&str, Curves)]) -> Result<(), String> {
    const COLORS: [&str; 5] = ["#7f7f7f", "#1f77b4", "#2ca02c", "#d62728", "#9467bd"];
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
            .with_x_label(format!("log orbits, from a {start}"))
            .with_y_label("log rms of density")
            .with_box_axes()
            .with_legend_position(LegendPosition::OutsideBottomCenter);
        (plots, layout)
    };
    let title = "Noise in a shearing box";
    let panels: Vec<_> = panels.iter().map(panel).collect();
    crate::plot::save(panels, 2, title, Path::new(PICTURE)).map(|_| ())
}
