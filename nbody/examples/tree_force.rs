//! Error and cost of tree gravity on a thin annulus of planetesimals and on a Plummer sphere, as a table.
//!
//! `cargo run --release --example tree_force [N]... [ERROR]... [annulus|Plummer]`; CPU time of all threads, the least
//! of several runs, tree construction included. Errors are |a - a_exact| / |a_exact| of about 2000 particles against the direct sum in f64.

use cpu_time::ProcessTime;
use nbody::gravity::{Accuracy, Count, Gravity, Method, Settings};
use nbody::points::Vec3;
use rand::{RngExt, SeedableRng};

/// Surface density a^-1.5 between 0.5 and 1.5, Rayleigh eccentricities 0.01 and inclinations 0.005.
fn annulus(n: usize) -> Vec<Vec3> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
    let mut u = || rng.random::<f64>();
    let rayleigh = |s: f64, u: f64| s * (-2.0 * (1.0 - u).ln()).sqrt();
    (0..n)
        .map(|_| {
            let (lo, hi) = (0.5f64.sqrt(), 1.5f64.sqrt());
            let a = (lo + u() * (hi - lo)).powi(2);
            let e = rayleigh(0.01, u()).min(0.9);
            let i = rayleigh(0.005, u());
            let tau = std::f64::consts::TAU;
            let (node, peri, mean) = (tau * u(), tau * u(), tau * u());
            let mut ecc = mean;
            for _ in 0..20 {
                ecc -= (ecc - e * ecc.sin() - mean) / (1.0 - e * ecc.cos());
            }
            let (px, py) = (a * (ecc.cos() - e), a * (1.0 - e * e).sqrt() * ecc.sin());
            let r = nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), node)
                * nalgebra::Rotation3::from_axis_angle(&Vec3::x_axis(), i)
                * nalgebra::Rotation3::from_axis_angle(&Vec3::z_axis(), peri);
            r * Vec3::new(px, py, 0.0)
        })
        .collect()
}

/// Plummer sphere of scale 1, cut at 10.
fn plummer(n: usize) -> Vec<Vec3> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(1);
    let mut u = || rng.random::<f64>();
    let c = 1000.0 / 101f64.powf(1.5);
    (0..n)
        .map(|_| {
            let r = 1.0 / ((u() * c).powf(-2.0 / 3.0) - 1.0).sqrt();
            let mu = 2.0 * u() - 1.0;
            let s = (1.0 - mu * mu).sqrt();
            let p = std::f64::consts::TAU * u();
            Vec3::new(r * s * p.cos(), r * s * p.sin(), r * mu)
        })
        .collect()
}

/// Error of `a` on the tested particles: rms and 99th percentile.
fn errors(test: &[u32], exact: &[Vec3], a: &[Vec3]) -> (f64, f64) {
    let mut errors: Vec<f64> = test
        .iter()
        .zip(exact)
        .map(|(&i, exact)| (a[i as usize] - exact).norm() / exact.norm())
        .collect();
    errors.sort_by(f64::total_cmp);
    let n = errors.len();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / n as f64).sqrt();
    (rms, errors[n * 99 / 100])
}

fn solver(accuracy: Accuracy, method: Method) -> Gravity {
    Gravity::new(Settings {
        accuracy,
        method,
        constant: 1.0,
    })
}

/// Prints the rows of one distribution.
fn report(name: &str, x: &[Vec3], accuracies: &[Accuracy], runs: usize) {
    let n = x.len();
    let (m, softening) = (vec![1.0 / n as f64; n], vec![0.0; n]);
    let test: Vec<u32> = (0..n as u32).step_by((n / 2000).max(1)).collect();
    let mut exact = vec![Vec3::zeros(); test.len()];
    let mut direct = solver(Accuracy::ForceError(1e-3), Method::Direct);
    direct.build(x, &m, &softening);
    direct.field(&test, &mut exact, &mut []);
    let active: Vec<u32> = (0..n as u32).collect();
    let mut a = vec![Vec3::zeros(); n];
    for &accuracy in accuracies {
        let mut gravity = solver(accuracy, Method::Tree);
        let (mut building, mut least) = (f64::INFINITY, f64::INFINITY);
        let mut count = Count::default();
        for _ in 0..runs {
            let start = ProcessTime::now();
            gravity.build(x, &m, &softening);
            building = building.min(start.elapsed().as_secs_f64());
            count = gravity.field(&active, &mut a, &mut []);
            least = least.min(start.elapsed().as_secs_f64());
        }
        let (rms, percentile) = errors(&test, &exact, &a);
        let setting = match accuracy {
            Accuracy::ForceError(e) => format!("force_error {e:.0e}"),
            Accuracy::OpeningAngle(t) => format!("opening_angle {t}"),
        };
        let unit = 1e6 / n as f64;
        println!(
            "| {n} | {name} | {setting} | {rms:.1e} | {percentile:.1e} | {:.2} | {:.2} | {} |",
            least * unit,
            building * unit,
            count.interactions / n as u64
        );
    }
}

fn main() {
    let sizes: Vec<usize> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let sizes = if sizes.is_empty() {
        vec![10_000, 100_000]
    } else {
        sizes
    };
    let wanted: Vec<f64> = std::env::args()
        .skip(1)
        .filter(|a| a.parse::<usize>().is_err())
        .filter_map(|a| a.parse().ok())
        .collect();
    let accuracies = if wanted.is_empty() {
        let angles = [0.3, 0.5, 0.7].map(Accuracy::OpeningAngle);
        let errors = [1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 4e-3].map(Accuracy::ForceError);
        angles.into_iter().chain(errors).collect()
    } else {
        wanted
            .into_iter()
            .map(Accuracy::ForceError)
            .collect::<Vec<_>>()
    };
    println!(
        "| N | distribution | setting | rms | 99 % | CPU us a particle | of that build | interactions a particle |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for n in sizes {
        let runs = (1_000_000 / n).clamp(2, 20);
        for (name, place) in [
            ("annulus", annulus as fn(usize) -> Vec<Vec3>),
            ("Plummer", plummer),
        ] {
            let other = std::env::args().any(|a| a != name && (a == "annulus" || a == "Plummer"));
            if !other {
                report(name, &place(n), &accuracies, runs);
            }
        }
    }
}
