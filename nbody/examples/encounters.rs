//! Energy error against cost of the hybrid map, over steps and cut-offs: `cargo run --release --example encounters -- CASE [N] [YEARS]`.
//!
//! `disc`: two planets of 10 Earth masses at 1 and 1.35 au among N planetesimals of 1 Earth mass together (0.85-1.6 au), which merge on
//! contact. `annulus`: N planetesimals of 10 Earth masses together at 0.5-1.5 au. Surface density a^-1.5, Rayleigh eccentricities 0.01
//! and inclinations 0.005. CPU seconds of all threads a year, energy errors relative to the start with what mergers lost
//! counted in; RAYON_NUM_THREADS=1 for one thread. Further arguments: steps a year, cut-off in Hill radii and in crossings, wanted
//! force error; each may be a list with commas.

use std::f64::consts::TAU;
use std::time::Instant;

use cpu_time::ProcessTime;
use nbody::collisions::{Field, Law, collide};
use nbody::gravity::{Accuracy, Gravity, Method, Settings};
use nbody::integrators::hybrid::{Hybrid, Map, cutoff::Cutoff, soft::Soft};
use nbody::orbit::Elements;
use nbody::points::{Columns, Domain, Vec3};
use nbody::{Bodies, Kind};
use rand::{RngExt, SeedableRng};

const EARTH: f64 = 3.0034896e-6;
/// 3 g/cm^3 in solar masses and au.
const DENSITY: f64 = 3.0 * 1.495978707e13 * 1.495978707e13 * 1.495978707e13 / 1.98892e33;

fn add(bodies: &mut Bodies, m: f64, kind: Kind, elements: Elements) {
    let i = bodies.len();
    bodies.resize(i + 1);
    bodies.id[i] = i as u64 + 1;
    bodies.m[i] = m;
    bodies.kind[i] = kind as u32;
    bodies.radius[i] = (3.0 * m / (2.0 * TAU * DENSITY)).cbrt();
    (bodies.x[i], bodies.v[i]) = elements.state(1.0 + m);
}

fn swarm(bodies: &mut Bodies, n: usize, mass: f64, [lo, hi]: [f64; 2]) {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(3);
    let mut u = || rng.random::<f64>();
    for _ in 0..n {
        let rayleigh = |s: f64, u: f64| s * (-2.0 * (1.0 - u).ln()).sqrt();
        let root = lo.sqrt() + u() * (hi.sqrt() - lo.sqrt());
        let elements = Elements {
            semi_major_axis: root * root,
            eccentricity: rayleigh(0.01, u()),
            inclination: rayleigh(0.005, u()),
            node: TAU * u(),
            pericentre: TAU * u(),
            mean_anomaly: TAU * u(),
        };
        add(bodies, mass / n as f64, Kind::Planetesimal, elements);
    }
}

fn start(case: &str, n: usize) -> (Bodies, Bodies) {
    let (mut star, mut bodies) = (Bodies::default(), Bodies::default());
    star.resize(1);
    star.m[0] = 1.0;
    if case == "disc" {
        for (a, node, pericentre, mean_anomaly) in [(1.0, 0.3, 1.1, 0.0), (1.35, 2.0, 0.2, 2.5)] {
            let elements = Elements {
                semi_major_axis: a,
                eccentricity: 0.01,
                inclination: 0.005,
                node,
                pericentre,
                mean_anomaly,
            };
            add(&mut bodies, 10.0 * EARTH, Kind::Planet, elements);
        }
        swarm(&mut bodies, n, EARTH, [0.85, 1.6]);
    } else {
        swarm(&mut bodies, n, 10.0 * EARTH, [0.5, 1.5]);
    }
    let total = 1.0 + bodies.m.iter().sum::<f64>();
    let mean = |of: &[Vec3]| of.iter().zip(&bodies.m).map(|(x, m)| x * *m).sum::<Vec3>() / total;
    let (x, v) = (mean(&bodies.x), mean(&bodies.v));
    star.x[0] -= x;
    star.v[0] -= v;
    bodies.x.iter_mut().for_each(|y| *y -= x);
    bodies.v.iter_mut().for_each(|y| *y -= v);
    (star, bodies)
}

fn energy(star: &Bodies, bodies: &Bodies) -> f64 {
    let join = |a: &[Vec3], b: &[Vec3]| [a, b].concat();
    let (x, v) = (join(&star.x, &bodies.x), join(&star.v, &bodies.v));
    let m = [&star.m[..], &bodies.m[..]].concat();
    let mut direct = Gravity::new(Settings {
        accuracy: Accuracy::ForceError(1e-9),
        method: Method::Direct,
        constant: 1.0,
    });
    // The star's share is summed apart: f64 would lose what the bodies have among themselves.
    let zeros = vec![0.0; bodies.m.len()];
    let active: Vec<u32> = (0..zeros.len() as u32).collect();
    let (mut a, mut phi) = (vec![Vec3::zeros(); zeros.len()], zeros.clone());
    direct.build(&bodies.x, &bodies.m, &zeros);
    direct.field(&active, &mut a, &mut phi);
    let kinetic: f64 = m
        .iter()
        .zip(&v)
        .map(|(m, v)| 0.5 * m * v.norm_squared())
        .sum();
    let star: f64 = (1..m.len())
        .map(|i| -m[0] * m[i] / (x[i] - x[0]).norm())
        .sum();
    let mutual: f64 = phi
        .iter()
        .zip(&bodies.m)
        .map(|(phi, m)| 0.5 * m * phi)
        .sum();
    kinetic + star + mutual
}

/// CPU time of all threads.
fn cpu() -> f64 {
    ProcessTime::now().as_duration().as_secs_f64()
}

struct Row {
    steps: f64,
    hill: f64,
    crossing: f64,
    error: f64,
}

fn run(case: &str, n: usize, years: f64, row: &Row) {
    let (mut star, mut bodies) = start(case, n);
    let begin = energy(&star, &bodies);
    let dt = TAU / row.steps;
    let mut map = Map {
        hybrid: Hybrid::new(
            Cutoff {
                hill: row.hill,
                crossing: row.crossing,
            },
            dt,
            true,
        ),
        soft: Soft::new(Settings {
            accuracy: Accuracy::ForceError(row.error),
            method: Method::Tree,
            constant: 1.0,
        }),
        g: 1.0,
        dt,
    };
    let total = (years * row.steps).round() as usize;
    let samples = if n > 20_000 { 4 } else { 20 };
    let (mut lost, mut mergers, mut most, mut last) = (0.0, 0, 0f64, 0.0);
    let (mut spent, mut wall) = (0.0, 0.0);
    let (mut members, mut biggest) = (0, 0);
    let mut done = 0;
    let mut next_id = n as u64 + 3;
    for sample in 1..=samples {
        let (c, w) = (cpu(), Instant::now());
        if sample == 1 {
            map.prepare(&star, &mut bodies);
        }
        while done < total * sample / samples {
            map.step(&mut star, &mut bodies).expect("a way");
            done += 1;
            let (some, large) = map.hybrid.clustered();
            members += some;
            biggest = biggest.max(large);
            if map.hybrid.touches.is_empty() {
                continue;
            }
            let now = done as f64 * dt;
            let touches = std::mem::take(&mut map.hybrid.touches);
            let field = Field {
                domain: Domain::open(),
                g: 1.0,
                self_gravity: true,
                now,
            };
            let outcome = collide(&mut bodies, &touches, &Law::Merge, &field, &mut next_id);
            lost += outcome.events.iter().map(|e| e.energy_lost).sum::<f64>();
            mergers += outcome.events.len();
            bodies.retain(&outcome.keep);
            map.prepare(&star, &mut bodies);
        }
        spent += cpu() - c;
        wall += w.elapsed().as_secs_f64();
        last = ((energy(&star, &bodies) + lost) / begin - 1.0).abs();
        most = most.max(last);
    }
    println!(
        "| {case} {n} | {} | {} | {} | {:.0e} | {:.4} | {:.4} | {:.2} | {last:.1e} | {most:.1e} | {mergers} | {:.2} | {biggest} |",
        row.steps,
        row.hill,
        row.crossing,
        row.error,
        spent / years,
        wall / years,
        1e6 * spent / (total * n) as f64,
        100.0 * members as f64 / (total * n) as f64,
    );
}

fn list(argument: Option<&String>, default: &[f64]) -> Vec<f64> {
    let given = argument.map(|text| text.split(',').filter_map(|v| v.parse().ok()).collect());
    given.unwrap_or_else(|| default.to_vec())
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let case = arguments.first().map_or("disc", String::as_str);
    let disc = case == "disc";
    let sizes = list(
        arguments.get(1),
        if disc { &[100.0, 300.0] } else { &[1e4] },
    );
    let years = list(arguments.get(2), if disc { &[100.0] } else { &[1.1] });
    println!(
        "| case | steps/yr | Hill radii | crossings | force error | CPU s/yr | wall s/yr | us a body and step | end | max error | mergers | % in clusters | biggest |"
    );
    println!("|{}", " --- |".repeat(13));
    for &n in &sizes {
        for &years in &years {
            for &steps in &list(arguments.get(3), if disc { &[100.0] } else { &[200.0] }) {
                for &hill in &list(arguments.get(4), &[Cutoff::default().hill]) {
                    for &crossing in &list(arguments.get(5), &[Cutoff::default().crossing]) {
                        for &error in &list(arguments.get(6), &[1e-3]) {
                            let row = Row {
                                steps,
                                hill,
                                crossing,
                                error,
                            };
                            run(case, n as usize, years, &row);
                        }
                    }
                }
            }
        }
    }
}
