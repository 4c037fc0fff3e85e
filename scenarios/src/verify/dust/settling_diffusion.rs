//! Layers in balance of settling and stirring, in a thin disk that is a formula: their height by that of the gas.
//!
//! H_d/H = sqrt(alpha / (alpha + St)) (Dubrulle, Morfill & Sterzik 1995, but for their factor of the eddies' spectrum; Youdin & Lithwick 2007 have
//! St (1 + 2 St)/(1 + St), 0.5 % to 18 % less). Layers of 2000 grains start a quarter too thick; heights are means over ten times, 1/Omega/(alpha + St)
//! apart, after the difference has died away. Tracers that are well mixed must stay so.

use super::{Bar, Row};
use crate::trial::Trial;

const LAYER: &str = r#"
[run]
end_time = 1e6
[units]
system = "dimensionless"
[star]
mass = 1.0
[surroundings.disk]
surface_density = 1.0
surface_density_slope = -1.0
reference_radius = 1.0
aspect_ratio = 0.01
flaring = 0.0
inner_radius = 0.5
outer_radius = 2.0
[dust]
particles = 2000
mass = 1e-12
inner_radius = 0.98
outer_radius = 1.02
[dust.drag]
law = "constant-stokes-number"
"#;

/// St and alpha.
const CASES: [[f64; 2]; 5] = [
    [1e-6, 0.01],
    [0.01, 0.01],
    [0.1, 0.01],
    [0.1, 0.001],
    [1.0, 0.001],
];

/// Times at which a layer is seen.
const SEEN: usize = 10;

fn layer(&[stokes, alpha]: &[f64; 2]) -> Row {
    let exact = (alpha / (alpha + stokes)).sqrt();
    let thick = if stokes < alpha { 1.0 } else { 1.25 };
    let overrides = [
        format!("dust.scale_height={}", thick * exact),
        format!("dust.drag.stokes_number={stokes}"),
        format!("dust.turbulence.alpha={alpha}"),
    ];
    let mut trial = Trial::new(LAYER, &overrides, |_| {}).expect("a scene");
    // Of the height's square, at the rate of settling: that of a free fall where grains are heavy.
    let time = (1.0 + stokes * stokes) / (2.0 * (alpha + stokes));
    let stops: Vec<f64> = std::iter::once(0.0)
        .chain((0..SEEN).map(|k| (4.0 + 2.0 * k as f64) * time))
        .collect();
    let mut squares = Vec::new();
    let done = trial.run(&stops, |stop| {
        let p = &stop.system.dust.particles;
        let height = |x: &nbody::points::Vec3| x.z / (0.01 * x.xy().norm());
        let sum: f64 = p.x.iter().map(|x| height(x).powi(2)).sum();
        squares.push(sum / p.x.len() as f64);
    });
    done.expect("a run");
    let mean = squares[1..].iter().sum::<f64>() / SEEN as f64;
    let bar = Bar::Reference {
        value: exact,
        good: 0.02,
        acceptable: 0.03,
    };
    let what = format!("St = {stokes}, alpha = {alpha}: H_d/H");
    Row::new(what, mean.sqrt(), bar)
}

pub fn rows() -> Vec<Row> {
    CASES.iter().map(layer).collect()
}
