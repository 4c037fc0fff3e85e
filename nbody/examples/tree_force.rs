//! Error and cost of tree gravity on a thin annulus of planetesimals and on a Plummer sphere.

use std::time::Instant;

use nbody::gravity::{Accuracy, Gravity, Method, Settings};
use nbody::points::Vec3;
use rand::{RngExt, SeedableRng};

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

fn main() {
    let n: usize = std::env::args().nth(1).map_or(100_000, |a| a.parse().unwrap());
    for (name, x) in [("annulus", annulus(n)), ("plummer", plummer(n))] {
        let m = vec![1.0 / n as f64; n];
        let s = vec![0.0; n];
        let mut exact = Gravity::new(Settings {
            accuracy: Accuracy::ForceError(1e-9),
            method: Method::Direct,
            constant: 1.0,
        });
        exact.build(&x, &m, &s);
        let test: Vec<u32> = (0..n).step_by((n / 2000).max(1)).map(|i| i as u32).collect();
        let mut r = vec![Vec3::zeros(); test.len()];
        let t = Instant::now();
        exact.field(&test, &mut r, &mut []);
        println!("direct: {:.3} ns a pair", t.elapsed().as_secs_f64() * 1e9 / n as f64 / test.len() as f64);
        let active: Vec<u32> = (0..n as u32).collect();
        let mut scale = vec![];
        let errs = |a: &Vec<Vec3>| {
            let mut e: Vec<f64> = test.iter().zip(&r).map(|(&i, r)| (a[i as usize] - r).norm() / r.norm()).collect();
            e.sort_by(f64::total_cmp);
            let rms = (e.iter().map(|e| e * e).sum::<f64>() / e.len() as f64).sqrt();
            (rms, e[e.len() * 99 / 100], e[e.len()-1])
        };
        let accs: Vec<Accuracy> = [0.3,0.5]
            .iter()
            .map(|&t| Accuracy::OpeningAngle(t))
            .chain([3e-5, 1e-4,3e-4,1e-3,3e-3].iter().map(|&e| Accuracy::ForceError(e)))
            .collect();
        for accuracy in accs {
            let mut g = Gravity::new(Settings { accuracy, method: Method::Tree, constant: 1.0 });
            if matches!(accuracy, Accuracy::ForceError(_)) && std::env::var("KNOWN").is_ok() { g.debug_scale = scale.clone(); }
            let mut a = vec![Vec3::zeros(); n];
            let mut best = [f64::INFINITY; 3];
            let mut count = Default::default();
            for _ in 0..3 {
                let t = Instant::now();
                g.build(&x, &m, &s);
                let tb = t.elapsed().as_secs_f64();
                count = g.field(&active, &mut a, &mut []);
                let tt = t.elapsed().as_secs_f64();
                best[0] = best[0].min(tb); best[1] = best[1].min(tt - tb); best[2] = best[2].min(tt);
            }
            let (rms, p99, max) = errs(&a);
            let us = 1e6 / n as f64;
            println!("{name:8} {accuracy:?} rms {rms:.2e} p99 {p99:.2e} max {max:.2e} build {:.3} field {:.3} total {:.3} us, {} int",
                best[0]*us, best[1]*us, best[2]*us, count.interactions as usize / n);
            if scale.is_empty() { scale = a.iter().map(|a| a.norm()).collect(); }
        }
    }
}
