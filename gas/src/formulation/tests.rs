//! Runs with each formulation: what is conserved, and what nothing may break.

use nbody::points::{Clock, Columns, Domain, Vec3};

use crate::probe::isothermal;
use crate::samples::{GAMMA, hydro, lattice, noise, noisy, still};
use crate::{Conduction, Eos, Formulation, Gas, Hydro, Precision, Viscosity, alone};

/// Settings in which everything is at work.
fn all(domain: Domain, precision: Precision) -> Hydro {
    Hydro {
        precision,
        formulation: Formulation::Pressure,
        viscosity: Viscosity::CullenDehnen {
            alpha: 1.0,
            beta: 2.0,
        },
        conduction: Conduction { alpha: 1.0 },
        ..hydro(domain)
    }
}

fn energy(gas: &Gas) -> f64 {
    let totals = gas.totals();
    totals.kinetic + totals.internal
}

/// Advances gas, and checks that it stays whole; the relative error of its energy.
fn run(gas: &mut Gas, hydro: &Hydro, until: f64) -> f64 {
    let before = (energy(gas), gas.totals().momentum);
    let p = &gas.particles;
    let size: f64 = (0..gas.len())
        .map(|i| p.m[i] * (p.v[i].norm() + (2.0 * p.u[i]).sqrt()))
        .sum();
    alone::advance(gas, hydro, 0.0, until, until).expect("a run");
    assert_eq!(gas.particles.non_finite(), None);
    assert_eq!(gas.derived.non_finite(), None);
    assert_eq!(gas.rates.non_finite(), None);
    let momentum = (gas.totals().momentum - before.1).norm() / size;
    assert!(momentum < 1e-14, "momentum {momentum:e}");
    energy(gas) / before.0 - 1.0
}

#[test]
fn mixed_steps_conserve_momentum_and_nearly_energy() {
    for precision in [Precision::Double, Precision::Single] {
        let hydro = all(Domain::periodic(Vec3::repeat(1.0)), precision);
        let mut gas = noisy(&hydro.domain, 10, 0.5);
        for i in 0..gas.len() {
            let r = (gas.particles.x[i] - Vec3::repeat(0.5)).norm();
            gas.particles.u[i] *= 1.0 + 300.0 * (-(r / 0.15).powi(2)).exp();
        }
        gas.rates.u_pred.clone_from(&gas.particles.u);
        let error = run(&mut gas, &hydro, 0.08);
        println!("energy {error:e}");
        assert!(error.abs() < 2e-3, "energy {error:e}");
    }
}

/// Two streams of cold gas that meet at a thousand times their sound speed.
#[test]
fn streams_meet_at_mach_1000() {
    for precision in [Precision::Double, Precision::Single] {
        let hydro = all(Domain::periodic(Vec3::new(2.0, 0.5, 0.5)), precision);
        let mut particles = still(lattice([32, 8, 8], 1.0 / 16.0), 1.0, 0.9e-6);
        for i in 0..particles.len() {
            particles.v[i].x = (1.0 - particles.x[i].x).signum();
            particles.x[i] += 0.01 * noise(i as u64, 1);
        }
        let error = run(&mut Gas::new(particles), &hydro, 0.2);
        println!("energy {error:e}");
        assert!(error.abs() < 3e-3, "energy {error:e}");
    }
}

#[test]
fn a_drop_flies_apart_into_the_vacuum() {
    for precision in [Precision::Double, Precision::Single] {
        let hydro = all(Domain::open(), precision);
        let mut gas = Gas::new(still(lattice([8; 3], 1.0), 1.0, 1.0));
        let error = run(&mut gas, &hydro, 30.0);
        println!("energy {error:e}");
        assert!(error.abs() < 7.5e-3, "energy {error:e}");
        let internal = gas.totals().internal / energy(&gas);
        assert!(internal < 0.1, "{internal}");
    }
}

#[test]
fn gas_without_pressure_beside_gas_that_has_some_is_no_fault() {
    for precision in [Precision::Double, Precision::Single] {
        let hydro = all(Domain::periodic(Vec3::repeat(1.0)), precision);
        let clock = Clock::standing(0.0);
        let mut gas = Gas::new(still(lattice([16, 16, 16], 1.0 / 16.0), 1.0, 0.0));
        for i in 0..gas.len() {
            let warm = gas.particles.x[i].x > 0.5;
            gas.rates.u_pred[i] = f64::from(u8::from(warm));
        }
        gas.density(&hydro, &clock, Vec3::zeros())
            .expect("a density");
        gas.forces(&hydro, &clock, &clock);
        assert_eq!(gas.rates.non_finite(), None);
        let cold = |i: &usize| gas.rates.u_pred[*i] == 0.0;
        let near = |i: &usize| (gas.particles.x[*i].x - 0.5).abs() < 1.0 / 16.0;
        assert!((0..gas.len()).filter(cold).all(|i| gas.rates.du[i] >= 0.0));
        // The warm gas leaves, and conducts heat to the cold.
        for i in (0..gas.len()).filter(near) {
            assert!(cold(&i) == (gas.rates.du[i] > 0.0));
        }
        let far = |i: &usize| (gas.particles.x[*i].x - 0.25).abs() < 0.05;
        assert!(
            (0..gas.len())
                .filter(far)
                .all(|i| gas.rates.hydro[i] == Vec3::zeros())
        );
    }
}

#[test]
fn between_its_ticks_gas_keeps_the_pressure_of_its_sum() {
    let hydro = all(Domain::periodic(Vec3::repeat(1.0)), Precision::Double);
    let mut gas = noisy(&hydro.domain, 8, 1.0);
    gas.density(&hydro, &Clock::standing(0.0), Vec3::zeros())
        .expect("a density");
    let p = gas.derived.p.clone();
    // Nobody's step ends at this tick.
    let clock = Clock {
        start: 0.0,
        end: 1.0,
        tick: 64,
        step: 1,
    };
    gas.particles.end.fill(128);
    let active = gas.density(&hydro, &clock, Vec3::zeros());
    assert_eq!(active, Ok(0));
    let apart = |i: usize| {
        gas.derived.p[i] / hydro.eos.pressure(gas.derived.rho[i], gas.rates.u_pred[i]) - 1.0
    };
    assert!((0..gas.len()).any(|i| apart(i).abs() > 0.1));
    for (i, p) in p.iter().enumerate() {
        assert!((gas.derived.p[i] / p - 1.0).abs() < 1e-14);
        // Grains see the gas's own temperature.
        let square = hydro.eos.pressure(1.0, gas.rates.u_pred[i]);
        assert!((isothermal(&gas, i) / square - 1.0).abs() < 1e-14);
    }
}

#[test]
fn isothermal_gas_of_equal_masses_has_one_formulation() {
    let domain = Domain::periodic(Vec3::repeat(1.0));
    let eos = Eos::Isothermal {
        sound_speed: 0.5,
        gamma: GAMMA,
    };
    let accelerations = |formulation, exponent| {
        let hydro = Hydro {
            formulation,
            exponent,
            tolerance: 1e-12,
            ..Hydro::new(domain, eos.clone())
        };
        let mut gas = noisy(&domain, 8, 0.0);
        gas.particles.m.fill(1.0);
        let clock = Clock::standing(0.0);
        gas.density(&hydro, &clock, Vec3::zeros())
            .expect("a density");
        gas.forces(&hydro, &clock, &clock);
        gas.rates.hydro
    };
    let density = accelerations(Formulation::Density, 1.0);
    let most = density.iter().map(|a| a.norm()).fold(0.0, f64::max);
    let apart = |other: &[Vec3]| {
        let differences = density.iter().zip(other).map(|(a, b)| (a - b).norm());
        differences.fold(0.0, f64::max) / most
    };
    for formulation in Formulation::ALL {
        let difference = apart(&accelerations(formulation, 1.0));
        println!("{formulation:?} {difference:e}");
        assert!(difference < 1e-12, "{formulation:?} {difference:e}");
    }
    // Powers of the pressure are no such sums.
    assert!(apart(&accelerations(Formulation::Pressure, 0.5)) > 1e-3);
}

#[test]
fn one_particle_is_at_rest() {
    for domain in [Domain::open(), Domain::periodic(Vec3::repeat(1.0))] {
        for precision in [Precision::Double, Precision::Single] {
            let hydro = all(domain, precision);
            let mut gas = Gas::new(still(vec![Vec3::repeat(0.3)], 1.0, 1.0));
            assert_eq!(run(&mut gas, &hydro, 1.0), 0.0);
            assert!((gas.particles.x[0] - Vec3::repeat(0.3)).norm() < 1e-14);
        }
    }
}
