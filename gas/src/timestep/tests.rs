//! Tests of `timestep`.

use std::f64::consts::PI;

use nbody::points::{Domain, Vec3};

use super::*;
use crate::alone::advance;
use crate::samples::{GAMMA, hydro, lattice, noise, noisy, still};
use crate::{Eos, Precision, Viscosity};

/// Largest |L| that the parts could have: sum of |x| |p|.
fn lever(gas: &Gas) -> f64 {
    let p = &gas.particles;
    (0..gas.len())
        .map(|i| p.m[i] * p.x[i].norm() * p.v[i].norm())
        .sum()
}

/// Gas with a hot spot, whose steps are far shorter than those of the rest.
fn mixed(domain: &Domain, n: usize) -> Gas {
    let mut gas = noisy(domain, n, 0.5);
    for i in 0..gas.len() {
        let r = (gas.particles.x[i] - Vec3::repeat(0.5)).norm();
        gas.particles.u[i] *= 1.0 + 300.0 * (-(r / 0.15).powi(2)).exp();
    }
    gas.rates.u_pred.clone_from(&gas.particles.u);
    gas
}

#[test]
fn mixed_steps_conserve_momentum_and_angular_momentum() {
    for (domain, precision) in [
        (Domain::open(), Precision::Double),
        (Domain::open(), Precision::Single),
        (Domain::periodic(Vec3::repeat(1.0)), Precision::Double),
        (Domain::periodic(Vec3::repeat(1.0)), Precision::Single),
    ] {
        let mut hydro = hydro(domain);
        hydro.precision = precision;
        let mut gas = mixed(&domain, 10);
        let before = gas.totals();
        let size: f64 = (0..gas.len())
            .map(|i| gas.particles.m[i] * gas.particles.v[i].norm())
            .sum();
        let account = advance(&mut gas, &hydro, 0.0, 0.08, 0.08).expect("a run");
        let after = gas.totals();
        // Several bins at work: far fewer updates than ticks times particles.
        assert!(
            account.ticks > 20 && 2 * account.updates < account.ticks * gas.len(),
            "{account:?}"
        );
        let momentum = (after.momentum - before.momentum).norm() / size;
        assert!(momentum < 1e-14, "momentum {momentum:e}");
        if domain.volume().is_infinite() {
            let turn = (after.angular_momentum - before.angular_momentum).norm() / lever(&gas);
            let bar = match precision {
                Precision::Double => 1e-14,
                Precision::Single => 2e-10,
            };
            assert!(turn < bar, "angular momentum {turn:e}");
        }
        let energy = |t: &crate::Totals| t.kinetic + t.internal;
        let error = (energy(&after) / energy(&before) - 1.0).abs();
        assert!(error < 2e-3, "energy {error:e}");
        assert_eq!(account.heat.floors, 0);
    }
}

#[test]
fn a_hot_spot_wakes_its_cold_surroundings() {
    let hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let mut gas = Gas::new(still(lattice([12; 3], 1.0 / 12.0), 1.0 / 1728.0, 1e-6));
    let spot = |x: Vec3| (x - Vec3::repeat(0.5)).norm() < 0.1;
    for i in 0..gas.len() {
        if spot(gas.particles.x[i]) {
            gas.particles.u[i] = 1e3;
        }
    }
    gas.rates.u_pred.clone_from(&gas.particles.u);
    let before = gas.totals();
    let account = advance(&mut gas, &hydro, 0.0, 0.02, 0.02).expect("a run");
    let after = gas.totals();
    let error = (after.kinetic + after.internal) / (before.kinetic + before.internal) - 1.0;
    assert!(error.abs() < 0.02, "energy {error:e}, {account:?}");
    // The blast has reached gas that would have slept through it, and no particle outran its neighbours.
    let fastest = |i: usize| gas.particles.v[i].norm();
    let most = (0..gas.len()).map(fastest).fold(0.0, f64::max);
    assert!(most < 60.0, "{most}");
}

/// What a run depends on, in one number of bits.
fn bits(gas: &Gas) -> u64 {
    let p = &gas.particles;
    (0..gas.len()).fold(0, |bits: u64, i| {
        [p.x[i].x, p.x[i].y, p.v[i].z, p.u[i], p.h[i]]
            .into_iter()
            .fold(bits, |bits, value| bits.rotate_left(5) ^ value.to_bits())
    })
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let mut hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let run = |hydro: &Hydro, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| {
            let mut gas = mixed(&hydro.domain, 8);
            advance(&mut gas, hydro, 0.0, 0.02, 0.02).expect("a run");
            bits(&gas)
        })
    };
    for precision in [Precision::Double, Precision::Single] {
        hydro.precision = precision;
        let one = run(&hydro, 1);
        assert!(
            [2, 7]
                .into_iter()
                .all(|threads| run(&hydro, threads) == one)
        );
    }
}

#[test]
fn a_boosted_run_is_the_same_run() {
    let hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let boost = Vec3::new(3.0, -2.0, 1.0);
    let run = |boost: Vec3| {
        let mut gas = mixed(&hydro.domain, 8);
        for v in &mut gas.particles.v {
            *v += boost;
        }
        gas.rates.v_pred.clone_from(&gas.particles.v);
        advance(&mut gas, &hydro, 0.0, 0.02, 0.02).expect("a run");
        let mut by_id: Vec<usize> = (0..gas.len()).collect();
        by_id.sort_by_key(|&i| gas.particles.id[i]);
        (by_id.into_iter())
            .map(|i| (gas.particles.x[i], gas.particles.v[i], gas.particles.u[i]))
            .collect::<Vec<_>>()
    };
    for (a, b) in run(Vec3::zeros()).into_iter().zip(run(boost)) {
        let x = hydro.domain.nearest(b.0 - a.0 - 0.02 * boost);
        assert!(
            x.norm() < 1e-12
                && (b.1 - boost - a.1).norm() < 1e-10
                && (b.2 / a.2 - 1.0).abs() < 1e-10
        );
    }
}

/// A standing sound wave of one wave length along x, velocity amplitude 1e-4 c; c = 1, rho = 1.
fn sound_wave(n: usize) -> (Gas, Hydro) {
    let spacing = 1.0 / n as f64;
    let thin = 6.0 * spacing;
    let mut hydro = hydro(Domain::periodic(Vec3::new(1.0, thin, thin)));
    hydro.viscosity = Viscosity::None;
    hydro.tolerance = 1e-10;
    let mut particles = still(
        lattice([n, 6, 6], spacing),
        spacing.powi(3),
        1.0 / (GAMMA * (GAMMA - 1.0)),
    );
    for i in 0..particles.m.len() {
        particles.v[i].x = 1e-4 * (2.0 * PI * particles.x[i].x).sin();
    }
    (Gas::new(particles), hydro)
}

/// Amplitude of the wave's velocity.
fn amplitude(gas: &Gas) -> f64 {
    let p = &gas.particles;
    let part = |i: usize| p.v[i].x * (2.0 * PI * p.x[i].x).sin();
    2.0 * (0..gas.len()).map(part).sum::<f64>() / gas.len() as f64
}

#[test]
fn a_sound_wave_has_its_frequency() {
    let (mut gas, hydro) = sound_wave(24);
    // A quarter period: v = 0 and falling as -2 pi c 1e-4 t.
    advance(&mut gas, &hydro, 0.0, 0.25, 0.25).expect("a run");
    let late = amplitude(&gas) / (2.0 * PI * 1e-4);
    // 1.5 %: what 58 neighbours on a cubic lattice make of 24 particles a wave length.
    assert!(late.abs() < 0.25 * 0.03, "late by {late}");
}

#[test]
fn halving_the_steps_quarters_the_error() {
    let run = |steps: u32| {
        let (mut gas, mut hydro) = sound_wave(16);
        hydro.courant = 1e3;
        hydro.force_factor = 1e3;
        hydro.viscosity = Viscosity::Constant {
            alpha: 1.0,
            beta: 2.0,
        };
        advance(&mut gas, &hydro, 0.0, 0.2, 0.2 / f64::from(steps)).expect("a run");
        amplitude(&gas)
    };
    let (coarse, middle, fine) = (run(8), run(16), run(32));
    let order = ((coarse - middle) / (middle - fine)).abs().log2();
    assert!((order - 2.0).abs() < 0.1, "order {order}");
}

#[test]
fn bound_gas_keeps_its_temperature_and_gives_off_its_heat() {
    let domain = Domain::open();
    let mut hydro = hydro(domain);
    hydro.eos = Eos::Isothermal {
        sound_speed: 1.0,
        gamma: 1.4,
    };
    hydro.courant = 0.1;
    let mut gas = noisy(&domain, 8, 0.0);
    gas.particles.u.fill(2.5);
    let before = gas.totals();
    let account = advance(&mut gas, &hydro, 0.0, 0.05, 0.05).expect("a run");
    let after = gas.totals();
    assert!((gas.particles.u.iter()).all(|&u| (u / 2.5 - 1.0).abs() < 1e-15));
    let change = after.kinetic - before.kinetic + account.heat.radiated;
    assert!((after.kinetic / before.kinetic - 1.0).abs() > 0.05);
    assert!(
        change.abs() < 2e-3 * before.kinetic,
        "{change:e} of {}",
        before.kinetic
    );
}

#[test]
fn gas_that_cannot_be_stepped_is_a_fault() {
    let hydro = hydro(Domain::open());
    let mut particles = still(lattice([6; 3], 1.0), 1.0, 1.0);
    particles.u[17] = f64::NAN;
    let fault = advance(&mut Gas::new(particles), &hydro, 0.0, 1.0, 1.0);
    assert!(matches!(fault, Err(Fault::NonFinite { .. })), "{fault:?}");
}

#[test]
fn two_dimensional_gas_stays_in_its_plane_and_keeps_its_momentum() {
    let domain = Domain::open().with_axes([true, true, false]);
    let hydro = hydro(domain);
    let mut gas = mixed(&domain, 16);
    let before = gas.totals();
    advance(&mut gas, &hydro, 0.0, 0.03, 0.03).expect("a run");
    let z = gas.particles.x[0].z;
    assert!(gas.particles.x.iter().all(|x| x.z == z));
    let after = gas.totals();
    assert!((after.momentum - before.momentum).norm() < 1e-14);
    assert!((after.angular_momentum.z - before.angular_momentum.z).abs() < 1e-14);
    let vertical = |gas: &Gas| noise(gas.particles.id[5], 3).z - gas.particles.v[5].z;
    assert!(vertical(&gas).abs() < 1e-14);
}

#[test]
fn a_small_shock_tube_reaches_its_middle_state() {
    // Sod's tube (gamma = 5/3) on body-centred lattices, cells of 1/24 and 1/12, at t = 0.2.
    let (cell, side) = (1.0 / 24.0, 1.0 / 3.0);
    let mut hydro = hydro(Domain::periodic(Vec3::new(2.0, side, side)));
    hydro.viscosity = Viscosity::Constant {
        alpha: 1.0,
        beta: 2.0,
    };
    let centred = |n: [usize; 3], cell: f64| {
        let corners = lattice(n, cell);
        let centres = corners
            .clone()
            .into_iter()
            .map(move |x| x - Vec3::repeat(0.5 * cell));
        corners.into_iter().chain(centres).collect::<Vec<_>>()
    };
    let left = centred([24, 8, 8], cell);
    let dense = left.len();
    let right = centred([12, 4, 4], 2.0 * cell).into_iter();
    let x = (left.into_iter()).chain(right.map(|x| x + Vec3::new(1.0, 0.0, 0.0)));
    let mut particles = still(x.collect(), 0.5 * cell.powi(3), 0.0);
    for i in 0..particles.m.len() {
        particles.u[i] = if i < dense { 1.0 } else { 0.8 } / (GAMMA - 1.0);
    }
    let mut gas = Gas::new(particles);
    advance(&mut gas, &hydro, 0.0, 0.2, 0.2).expect("a run");
    // Between the fan's foot at 1 - 0.034 and the contact at 1 + 0.168.
    let (mut p, mut v, mut count) = (0.0, 0.0, 0.0);
    for i in 0..gas.len() {
        if (1.02..1.12).contains(&gas.particles.x[i].x) {
            p += gas.derived.p[i];
            v += gas.particles.v[i].x;
            count += 1.0;
        }
    }
    let errors = [p / count / 0.293_945 - 1.0, v / count / 0.841_195 - 1.0];
    assert!(
        errors[0].abs() < 0.1 && errors[1].abs() < 0.05,
        "{errors:?}"
    );
}
