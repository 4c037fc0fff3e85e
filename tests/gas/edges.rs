//! Edges of a disk: zones leave gas in balance alone, damp what moves about it at their rate, and book what they take.

use std::f64::consts::TAU;

use nbody::points::{Columns, Vec3};
use tridisk::trial::Trial;

/// A disk of aspect ratio `aspect` between 0.5 and 1.5 that does not pull itself, with further keys.
fn disk(particles: usize, aspect: f64, keys: &str) -> String {
    format!(
        r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[star]
mass = 1.0
accretion_radius = 0.1
[gas]
particles = {particles}
[gas.disk]
mass = 1e-3
inner_radius = 0.5
outer_radius = 1.5
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = {aspect}
reference_radius = 1.0
exponent = 0.25
[gas.viscosity]
kind = "balsara"
{keys}
"#
    )
}

fn trial(text: &str) -> Trial {
    Trial::new(text, &[], |_| {}).unwrap_or_else(|refusal| panic!("{refusal}"))
}

/// R, v_R and v_phi about the star.
fn polar(x: Vec3, v: Vec3) -> [f64; 3] {
    let r = x.xy().norm();
    [r, x.xy().dot(&v.xy()) / r, (x.x * v.y - x.y * v.x) / r]
}

/// Gravity of a disk whose gas pulls those.
fn pulls(targets: &str) -> String {
    format!("[gravity]\npulls = {{ gas = [{targets}] }}\n")
}

/// By how much the gas of a zone from 1.1 outwards turns slower than Kepler, by the speed of Kepler, at both ends of a time; and by what part its
/// mean distance has grown.
fn lag_and_drift(zones: &str) -> ([f64; 2], f64) {
    let mut trial = trial(&disk(4000, 0.07, &(pulls("") + zones)));
    let mut means = Vec::new();
    let mut inside: Vec<u64> = Vec::new();
    let done = trial.run(&[0.0, TAU], |stop| {
        let (p, star) = (&stop.system.gas.particles, &stop.system.star);
        let places: Vec<(u64, [f64; 3])> = (0..p.len())
            .map(|i| (p.id[i], polar(p.x[i] - star.x[0], p.v[i] - star.v[0])))
            .collect();
        if inside.is_empty() {
            let in_zone = places.iter().filter(|(_, at)| (1.15..1.4).contains(&at[0]));
            inside = in_zone.map(|(id, _)| *id).collect();
            inside.sort_unstable();
        }
        let own = places
            .iter()
            .filter(|(id, _)| inside.binary_search(id).is_ok());
        let mut sum = [0.0; 2];
        for (_, [r, _, v]) in own {
            sum[0] += 1.0 - v * r.sqrt();
            sum[1] += r;
        }
        means.push(sum.map(|sum| sum / inside.len() as f64));
    });
    done.unwrap_or_else(|fault| panic!("{fault}"));
    let [before, after] = [means[0], means[1]];
    ([before[0], after[0]], after[1] / before[1] - 1.0)
}

#[test]
fn gas_in_balance_stays_in_a_zone() {
    let (free, free_drift) = lag_and_drift("");
    let zones = "[gas.edge]\nouter_radius = 1.1\ntime = 0.03";
    let ([before, after], drift) = lag_and_drift(zones);
    println!("free {free:?} {free_drift:e}; in a zone {before:e} {after:e} {drift:e}");
    assert!((before / free[0] - 1.0).abs() < 1e-12);
    assert!((after / before - 1.0).abs() < 0.02, "{before} {after}");
    assert!(drift.abs() < 2e-3, "{drift}");
}

/// The exponent by which the energy of epicycles falls in `orbits` orbits of the gas of the scene `text`, so cold and thin that it moves on orbits, and the
/// largest relative change of a particle's angular momentum.
fn decay(text: &str, orbits: f64) -> (f64, f64) {
    let kick = 1e-3;
    let mut trial = Trial::new(text, &[], |gas| {
        gas.resize(40);
        for i in 0..gas.len() {
            let (sin, cos) = (TAU * i as f64 / 40.0).sin_cos();
            let (out, along) = (Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0));
            gas.x[i] = 1.3 * out;
            gas.v[i] = (along + kick * out) / 1.3f64.sqrt();
        }
    })
    .unwrap_or_else(|refusal| panic!("{refusal}"));
    let (mut energies, mut change) = (Vec::new(), 0.0f64);
    let done = trial.run(&[0.0, orbits * TAU * 1.3f64.powf(1.5)], |stop| {
        let p = &stop.system.gas.particles;
        let energy = |i: usize| {
            let [r, v_r, v_phi] = polar(p.x[i], p.v[i]);
            v_r.powi(2) + 4.0 * (v_phi - r.powf(-0.5)).powi(2)
        };
        energies.push((0..p.len()).map(energy).sum::<f64>() / p.len() as f64);
        for (x, v) in p.x.iter().zip(&p.v) {
            change = change.max((x.cross(v).z / 1.3f64.sqrt() - 1.0).abs());
        }
    });
    done.unwrap_or_else(|fault| panic!("{fault}"));
    (-(energies[1] / energies[0]).ln(), change)
}

#[test]
fn epicycles_in_a_zone_decay_at_its_rate() {
    // In the middle of a zone from 1.1 to 1.5: s = 1/4.
    let zones = "[gas.edge]\nouter_radius = 1.1\ntime = 0.5";
    let (exponent, _) = decay(&disk(64, 1e-3, &(pulls("") + zones)), 0.5);
    // Half an orbit: 2 s Omega t / f.
    let expected = 2.0 * 0.25 * 0.5 * TAU / 0.5;
    println!("{exponent} beside {expected}");
    assert!((exponent / expected - 1.0).abs() < 0.015, "{exponent}");
}

/// A zone of gas that no generator has made leaves the rotation alone: x'' + g x' + Omega^2 x = 0 with g = s Omega / f, in the plane too.
#[test]
fn zones_without_a_disk_damp_radial_motion_alone() {
    let text = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[domain]
dimensions = 2
[star]
mass = 1.0
accretion_radius = 0.1
[gas.eos]
kind = "isothermal"
sound_speed = 1e-3
[gas.edge]
outer_radius = 1.1
outer_end = 1.5
time = 2.0
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 0]
spacing = 0.1
density = 1e-3
"#;
    let g: f64 = 0.25 / 2.0;
    let period = 1.0 / (1.0 - 0.25 * g * g).sqrt();
    let (exponent, change) = decay(text, period);
    let expected = g * TAU * period;
    println!("{exponent} beside {expected}, angular momentum {change:e}");
    assert!((exponent / expected - 1.0).abs() < 0.015, "{exponent}");
    assert!(change < 1e-12, "{change:e}");
}

/// Largest relative errors of momentum, angular momentum and energy in a quarter of an orbit of a disk that begins shaken, and the part of its
/// kinetic energy that was given away.
fn books(targets: &str, zones: &str) -> ([f64; 3], f64) {
    let text = disk(2000, 0.07, &(pulls(targets) + zones));
    let mut trial = Trial::new(&text, &[], |gas| {
        for (x, v) in gas.x.iter().zip(&mut gas.v) {
            *v *= 1.0 + 0.05 * (7.0 * x.x).sin();
        }
    })
    .unwrap_or_else(|refusal| panic!("{refusal}"));
    let mut found = ([0.0; 3], 0.0);
    let done = trial.run(&[0.0, 0.25 * TAU], |stop| {
        let (books, ledger) = (stop.books, &stop.system.ledger);
        found.0 = [
            books.error_momentum,
            books.error_angular_momentum,
            books.error_energy.abs(),
        ];
        found.1 = ledger.given_away.kinetic / books.kinetic;
    });
    done.unwrap_or_else(|fault| panic!("{fault}"));
    found
}

#[test]
fn what_zones_take_stands_in_the_ledger() {
    let zones = "[gas.edge]\ninner_radius = 0.7\nouter_radius = 1.1\ntime = 0.3";
    // A star that is not pulled conserves the angular momentum exactly, one that is the momentum.
    let (without, nothing) = books("", "");
    assert_eq!(nothing, 0.0);
    let (errors, taken) = books("", zones);
    println!("errors {errors:?} beside {without:?}, taken {taken:e}");
    assert!(taken.abs() > 2e-3, "{taken}");
    assert!(errors[1] < 1e-12, "{errors:?}");
    // Steps that energy is not exact in: zones add no more than they make of it.
    assert!(errors[2] < 2.0 * without[2], "{errors:?} {without:?}");
    let (errors, _) = books("\"star\"", zones);
    assert!(errors[0] < 1e-12, "{errors:?}");
}

/// The mean outward acceleration by pressure that gas next to the accretion radius, there the disk's inner radius, has soon after the start, and
/// what would balance its rotation, by c^2 / H; and the errors of momentum and angular momentum there.
fn at_the_rim(targets: &str, keys: &str) -> ([f64; 2], [f64; 2]) {
    let text = disk(6000, 0.07, &(pulls(targets) + keys));
    let text = text.replace("accretion_radius = 0.1", "accretion_radius = 0.5");
    let mut trial = trial(&text);
    let (mut pushes, mut errors) = ([0.0; 3], [0.0; 2]);
    // At the start itself the gas inside is still there.
    let done = trial.run(&[0.0, 0.01 * TAU], |stop| {
        errors = [stop.books.error_momentum, stop.books.error_angular_momentum];
        pushes = [0.0; 3];
        let (gas, star) = (&stop.system.gas, stop.system.star.x[0]);
        for i in 0..gas.len() {
            let x = gas.particles.x[i] - star;
            let (r, height) = (x.xy().norm(), 0.07 * x.xy().norm().powf(1.25));
            if x.norm() - 0.5 < 0.5 * height && x.z.abs() < 0.5 * height {
                let unit = gas.derived.p[i] / gas.derived.rho[i] / height;
                let turn = x.cross(&gas.particles.v[i]).z.powi(2) / r.powi(3);
                pushes[0] += gas.rates.hydro[i].dot(&x) / x.norm() / unit;
                pushes[1] += (1.0 / (r * r) - turn) / unit;
                pushes[2] += 1.0;
            }
        }
    });
    done.unwrap_or_else(|fault| panic!("{fault}"));
    ([0, 1].map(|k| pushes[k] / pushes[2]), errors)
}

#[test]
fn a_supported_rim_feels_the_pressure_of_what_was_accreted() {
    let key = "[gas.edge]\ninner = \"supported\"";
    let (open, free) = at_the_rim("\"star\"", "");
    let (held, errors) = at_the_rim("\"star\"", key);
    println!("open {open:?}, held {held:?}, errors {free:?} {errors:?}");
    let off = |pushes: [f64; 2]| (pushes[0] - pushes[1]).abs();
    assert!(off(held) < 0.5 * off(open), "{open:?} {held:?}");
    assert!(errors[0] < 1e-12, "{errors:?}");
    // Accretion keeps the angular momentum no better than this.
    assert!(errors[1] < 2.0 * free[1], "{free:?} {errors:?}");
}
