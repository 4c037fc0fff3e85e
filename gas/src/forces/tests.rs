//! Tests of `forces`.

use nbody::points::{Columns, Domain};

use super::*;
use crate::Viscosity;
use crate::samples::{GAMMA, hydro, noisy};

const NOW: Clock = Clock::standing(0.0);

fn pushed(mut gas: Gas, hydro: &Hydro) -> Gas {
    gas.density(hydro, &NOW, Vec3::zeros()).expect("a solution");
    gas.forces(hydro, &NOW, &NOW);
    gas
}

fn domains() -> [Domain; 4] {
    let box_ = Domain::periodic(Vec3::repeat(1.0));
    let plane = [true, true, false];
    [
        Domain::open(),
        box_,
        Domain::open().with_axes(plane),
        box_.with_axes(plane),
    ]
}

#[test]
fn one_evaluation_conserves_momentum_angular_momentum_and_energy() {
    for domain in domains() {
        let mut hydro = hydro(domain);
        for kernel in [KernelKind::CubicSpline, KernelKind::WendlandC2] {
            hydro.kernel = kernel;
            let gas = pushed(noisy(&domain, 10, 1.0), &hydro);
            let (p, r) = (&gas.particles, &gas.rates);
            let (mut force, mut torque, mut power, mut size) =
                (Vec3::zeros(), Vec3::zeros(), 0.0, [0.0; 2]);
            for i in 0..gas.len() {
                let f = p.m[i] * r.hydro[i];
                force += f;
                torque += p.x[i].cross(&f);
                power += f.dot(&p.v[i]) + p.m[i] * r.du[i];
                size[0] += f.norm();
                size[1] += f.dot(&p.v[i]).abs();
            }
            assert!(force.norm() < 1e-15 * size[0], "{}", force.norm() / size[0]);
            assert!(power.abs() < 1e-14 * size[1], "{}", power / size[1]);
            if domain.volume().is_infinite() {
                assert!(
                    torque.norm() < 1e-15 * size[0],
                    "{}",
                    torque.norm() / size[0]
                );
            }
        }
    }
}

/// Internal energy of all gas when each particle keeps its entropy A = P / rho^gamma.
fn energy(gas: &Gas, entropy: &[f64]) -> f64 {
    (0..gas.len())
        .map(|i| {
            gas.particles.m[i] * entropy[i] * gas.derived.rho[i].powf(GAMMA - 1.0) / (GAMMA - 1.0)
        })
        .sum()
}

#[test]
fn the_force_is_the_gradient_of_the_energy() {
    for domain in domains() {
        let mut hydro = hydro(domain);
        hydro.viscosity = Viscosity::None;
        hydro.tolerance = 1e-13;
        let gas = pushed(noisy(&domain, 8, 1.0), &hydro);
        let entropy: Vec<f64> = (0..gas.len())
            .map(|i| gas.derived.p[i] / gas.derived.rho[i].powf(GAMMA))
            .collect();
        for i in [0, gas.len() / 2, gas.len() - 7] {
            for axis in (0..3).filter(|&axis| domain.axes[axis]) {
                let moved = |e: f64| {
                    let mut gas = gas.clone();
                    gas.particles.x[i][axis] += e;
                    gas.tree.refit(&gas.particles.x);
                    gas.density(&hydro, &NOW, Vec3::zeros())
                        .expect("a solution");
                    energy(&gas, &entropy)
                };
                let e = 1e-5;
                let expected = (moved(-e) - moved(e)) / (2.0 * e);
                let force = gas.particles.m[i] * gas.rates.hydro[i][axis];
                let scale =
                    gas.particles.m[i] * gas.derived.p[i] / gas.derived.rho[i] / gas.particles.h[i];
                assert!(
                    (force - expected).abs() < 1e-5 * scale,
                    "{force} {expected} {scale}"
                );
            }
        }
    }
}

#[test]
fn the_heat_is_what_the_density_says() {
    // Without viscosity du/dt = P / rho^2 drho/dt, and drho/dt = -rho div v.
    let mut hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    hydro.viscosity = Viscosity::None;
    let gas = pushed(noisy(&hydro.domain, 10, 1.0), &hydro);
    let d = &gas.derived;
    for i in 0..gas.len() {
        let expected = -d.p[i] / d.rho[i] * d.div_v[i];
        assert!((gas.rates.du[i] - expected).abs() < 1e-11 * (1.0 + expected.abs()));
    }
}

#[test]
fn viscosity_heats_and_only_when_gas_approaches() {
    let mut hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let heating = |hydro: &Hydro, stretch: f64| -> f64 {
        let mut gas = noisy(&hydro.domain, 8, 0.1);
        for i in 0..gas.len() {
            gas.rates.v_pred[i] = stretch * gas.particles.x[i];
        }
        let gas = pushed(gas, hydro);
        let inner = |i: &usize| (gas.particles.x[*i] - Vec3::repeat(0.5)).amax() < 0.15;
        (0..gas.len())
            .filter(inner)
            .map(|i| gas.particles.m[i] * gas.rates.du[i])
            .sum()
    };
    let with = [heating(&hydro, -1.0), heating(&hydro, 1.0)];
    hydro.viscosity = Viscosity::None;
    let without = [heating(&hydro, -1.0), heating(&hydro, 1.0)];
    assert!(with[0] > 1.05 * without[0]);
    assert!((with[1] / without[1] - 1.0).abs() < 1e-14);
}

#[test]
fn half_of_the_gas_alone_gets_the_forces_that_all_get_together() {
    let hydro = hydro(Domain::periodic(Vec3::repeat(1.0)));
    let mut gas = pushed(noisy(&hydro.domain, 10, 1.0), &hydro);
    let all = gas.clone();
    let clock = Clock {
        start: 0.0,
        end: 1.0,
        tick: 64,
        step: 1,
    };
    for i in 0..gas.len() {
        let active = gas.particles.x[i].x < 0.3;
        gas.particles.span[i] = if active { 64 } else { 128 };
        gas.particles.end[i] = gas.particles.span[i];
    }
    gas.rates.next_span.clone_from(&gas.particles.span);
    gas.rates.hydro.fill(Vec3::zeros());
    // It stands where it is.
    gas.now = clock.tick;
    gas.bound();
    gas.look(&hydro, &clock);
    let targets = gas.forces(&hydro, &clock, &clock);
    let (mut impulse, mut size, mut touched) = (Vec3::zeros(), 0.0, 0);
    for i in 0..gas.len() {
        let active = gas.active(&clock, i);
        let (now, then) = (gas.rates.hydro[i], all.rates.hydro[i]);
        if active {
            // The same pairs in the same order; impulses of 32 ticks.
            assert_eq!(now, then);
            let expected = now * 32.0 * clock.unit();
            assert!((gas.rates.dv_close[i] - expected).norm() < 1e-14 * expected.norm());
            assert!((gas.rates.dv_open[i] - expected).norm() < 1e-14 * expected.norm());
        } else {
            assert_eq!(now, Vec3::zeros());
        }
        impulse += gas.particles.m[i] * gas.rates.dv_close[i];
        size += (gas.particles.m[i] * gas.rates.dv_close[i]).norm();
        touched += usize::from(active || gas.rates.dv_close[i] != Vec3::zeros());
    }
    assert_eq!(touched, targets);
    assert!(targets < gas.len());
    assert!(impulse.norm() < 1e-15 * size, "{}", impulse.norm() / size);
    assert_eq!(gas.rates.non_finite(), None);
}
