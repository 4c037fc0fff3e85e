//! Sod's shock tube in three dimensions, gamma = 5/3, 57 600 particles, against the exact solution (Toro 2009, chapter 4).

use crate::bench;

const GAMMA: f64 = 5.0 / 3.0;

/// Density and velocity of the exact solution at xi = x / t: rarefaction to the left, contact, shock to the right.
fn exact(xi: f64) -> (f64, f64) {
    let (rl, pl, rr, pr) = (1.0f64, 1.0f64, 0.125f64, 0.1f64);
    let g = GAMMA;
    let (cl, cr) = ((g * pl / rl).sqrt(), (g * pr / rr).sqrt());
    let rarefied = |p: f64| 2.0 * cl / (g - 1.0) * (1.0 - (p / pl).powf((g - 1.0) / (2.0 * g)));
    let shocked = |p: f64| (p - pr) * (2.0 / (rr * ((g + 1.0) * p + (g - 1.0) * pr))).sqrt();
    let (mut lo, mut hi) = (pr, pl);
    for _ in 0..100 {
        let p = 0.5 * (lo + hi);
        if shocked(p) < rarefied(p) {
            lo = p
        } else {
            hi = p
        }
    }
    let p = 0.5 * (lo + hi);
    let v = shocked(p);
    let (left, tail) = (
        rl * (p / pl).powf(1.0 / g),
        v - cl * (p / pl).powf((g - 1.0) / (2.0 * g)),
    );
    let (q, mach) = (
        p / pr,
        ((g + 1.0) / (2.0 * g) * p / pr + (g - 1.0) / (2.0 * g)).sqrt(),
    );
    let right = rr * ((g + 1.0) * q + g - 1.0) / ((g - 1.0) * q + g + 1.0);
    if xi < -cl {
        (rl, 0.0)
    } else if xi < tail {
        let k = 2.0 / (g + 1.0) - (g - 1.0) / (g + 1.0) / cl * xi;
        (rl * k.powf(2.0 / (g - 1.0)), 2.0 / (g + 1.0) * (cl + xi))
    } else if xi < v {
        (left, v)
    } else if xi < cr * mach {
        (right, v)
    } else {
        (rr, 0.0)
    }
}

#[test]
fn the_exact_solution_is_that_of_the_reference_table() {
    // Star states of the gamma = 5/3 tube: u* = 0.841194852169, rho*_L = 0.479689058721, rho*_R = 0.229805749312, shock at 1.84447336705.
    let (left, right) = (exact(0.84), exact(0.85));
    assert!((left.1 - 0.841_194_852_169).abs() < 1e-10);
    assert!((left.0 - 0.479_689_058_721).abs() < 1e-10);
    assert!((right.0 - 0.229_805_749_312).abs() < 1e-10);
    assert_eq!(exact(1.844_48).1, 0.0);
    assert!(exact(1.844_46).1 > 0.8);
}

#[test]
fn a_tube_of_57_600_particles_is_as_sharp_as_the_best_plain_sph() {
    let run = bench::run("gas/sod.toml", &[]);
    let last = run.snapshots().pop().expect("a snapshot");
    let gas = run.particles(&last, 0);
    assert_eq!(gas.len(), 57_600);
    let (mut volume, mut error_rho, mut error_v) = (0.0, 0.0, 0.0);
    for i in 0..gas.len() {
        let x = gas.x[i].x - 1.0;
        if x.abs() < 0.5 {
            let rho = gas.more["Densities"][i];
            let part = gas.m[i] / rho;
            let (exact_rho, exact_v) = exact(x / 0.2);
            volume += part;
            error_rho += part * (rho - exact_rho).abs();
            error_v += part * (gas.v[i].x - exact_v).abs();
        }
    }
    let (rho, v) = (error_rho / volume, error_v / volume);
    println!("shock tube: L1 of density {rho:.5}, of velocity {v:.5}");
    // SWIFT's density SPH at this number of particles: 0.0084 and 0.0198.
    assert!(rho < 0.0084, "L1 of density {rho}");
    assert!(v < 0.0198, "L1 of velocity {v}");
    let energy = run.largest("error_energy");
    assert!(energy < 1e-4, "energy {energy:e}");
}
