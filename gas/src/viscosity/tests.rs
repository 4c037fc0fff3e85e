//! Viscosities at work on particles.

use std::f64::consts::TAU;

use nbody::points::{Clock, Columns, Domain, Vec3};

use super::*;
use crate::samples::{hydro, lattice, noise, still};
use crate::{Gas, Hydro, Physical, alone};

const NOW: Clock = Clock::standing(0.0);

/// A jittered square of side one, moving as `flow` says.
fn square(n: usize, flow: impl Fn(Vec3) -> Vec3) -> Gas {
    let spacing = 1.0 / n as f64;
    let mut particles = still(lattice([n, n, 1], spacing), spacing * spacing, 1.0);
    for i in 0..particles.len() {
        let mut jitter = 0.2 * spacing * noise(i as u64, 1);
        jitter.z = 0.0;
        particles.x[i] += jitter;
        particles.v[i] = flow(particles.x[i]);
    }
    Gas::new(particles)
}

fn plane(boundary: Domain) -> Hydro {
    hydro(boundary.with_axes([true, true, false]))
}

/// The largest alpha in gas that moves as `flow` says.
fn largest(viscosity: Viscosity, flow: impl Fn(Vec3) -> Vec3) -> (f64, Gas) {
    let hydro = Hydro {
        viscosity,
        ..plane(Domain::open())
    };
    let mut gas = square(24, flow);
    gas.density(&hydro, &NOW, Vec3::zeros())
        .expect("a solution");
    let most = gas.particles.alpha.iter().copied().fold(0.0, f64::max);
    (most, gas)
}

#[test]
fn shear_of_any_strength_has_no_planar_viscosity_and_a_shock_in_it_has_all() {
    let (alpha, beta) = (1.0, 2.0);
    for planar in [
        Viscosity::Planar { alpha, beta },
        Viscosity::PlanarSwitch { alpha, beta },
    ] {
        for rate in [1e-3, 1.0, 1e6] {
            // Kepler in a frame that turns: v_y = -3/2 Omega x; and about a star, which turns as well.
            let shear = |x: Vec3| Vec3::new(0.0, -1.5 * rate * x.x, 0.0);
            let turn = |x: Vec3| shear(x) + rate * Vec3::new(-x.y, x.x, 0.0);
            for (most, gas) in [largest(planar, shear), largest(planar, turn)] {
                assert_eq!(most, 0.0);
                assert!(gas.derived.stress.iter().all(|q| *q == Vec3::zeros()));
            }
            let shock = |x: Vec3| {
                let jump = 6.0 * rate.max(5.0) * 0.05;
                shear(x) - Vec3::new(jump * ((x.x - 0.5) / 0.05).tanh(), 0.0, 0.0)
            };
            let (most, gas) = largest(planar, shock);
            assert!(most > 0.9, "{planar:?} {rate}: {most}");
            // Where it is, and there alone.
            for i in 0..gas.len() {
                let far = (gas.particles.x[i].x - 0.5).abs() > 0.3;
                assert!(!far || gas.particles.alpha[i] < 0.05);
            }
        }
    }
    let twisted = |x: Vec3| Vec3::new(0.0, -1.5 * x.x, 0.0);
    let tensor = Viscosity::Tensor { alpha, beta };
    let (_, gas) = largest(tensor, twisted);
    assert!(gas.derived.stress.iter().all(|q| q.x > 0.0 && q.y > 0.0));
}

#[test]
fn a_thousand_steps_of_forces_that_are_not_central_keep_angular_momentum() {
    let (alpha, beta) = (1.0, 2.0);
    for viscosity in [
        Viscosity::Planar { alpha, beta },
        Viscosity::Tensor { alpha, beta },
    ] {
        let hydro = Hydro {
            viscosity,
            physical: Physical::Constant { nu: 1e-3 },
            ..plane(Domain::open())
        };
        // Two halves that meet askew, at three times their sound speed.
        let mut gas = square(12, |x| {
            Vec3::new(-3.0 * (x.x - 0.5).signum(), 6.0 * x.x - 3.0, 0.0)
        });
        let spin = |gas: &Gas| -> (f64, f64) {
            let p = &gas.particles;
            let one = |i: usize| p.m[i] * p.x[i].cross(&p.v[i]).z;
            (
                (0..gas.len()).map(one).sum(),
                (0..gas.len()).map(|i| one(i).abs()).sum(),
            )
        };
        let (before, size) = spin(&gas);
        let mut busy: f64 = 0.0;
        for k in 0..1000 {
            // A base step that is shorter than anyone wants: all keep the same pace.
            let t = 1e-4 * f64::from(k);
            alone::advance(&mut gas, &hydro, t, t + 1e-4, 1e-4).expect("a step");
            busy = busy.max(
                gas.derived
                    .stress
                    .iter()
                    .map(|q| q.amax())
                    .fold(0.0, f64::max),
            );
        }
        let error = (spin(&gas).0 - before).abs() / size;
        println!("{viscosity:?}: {error:e}, stress up to {busy}");
        assert!(busy > 1.0, "{busy}");
        assert!(error < 1e-13, "{viscosity:?}: {error:e}");
    }
}

#[test]
fn a_shear_wave_decays_as_navier_and_stokes_say() {
    let nu = 0.01;
    let hydro = Hydro {
        viscosity: Viscosity::None,
        physical: Physical::Constant { nu },
        ..plane(Domain::periodic(Vec3::repeat(1.0)))
    };
    let mut particles = still(lattice([32, 32, 1], 1.0 / 32.0), 1.0 / 1024.0, 0.9);
    for i in 0..particles.len() {
        particles.v[i].y = 0.1 * (TAU * particles.x[i].x).sin();
    }
    let mut gas = Gas::new(particles);
    let amplitude = |gas: &Gas| {
        let p = &gas.particles;
        let sum: f64 =
            p.x.iter()
                .zip(&p.v)
                .map(|(x, v)| v.y * (TAU * x.x).sin())
                .sum();
        2.0 * sum / gas.len() as f64
    };
    let heat = |gas: &Gas| gas.totals().internal + gas.totals().kinetic;
    let before = (amplitude(&gas), heat(&gas));
    alone::advance(&mut gas, &hydro, 0.0, 1.0, 0.1).expect("a run");
    let rate = -(amplitude(&gas) / before.0).ln() / (TAU * TAU);
    println!("nu {rate}, energy {:e}", heat(&gas) / before.1 - 1.0);
    assert!((rate / nu - 1.0).abs() < 0.03, "{rate}");
    assert!((heat(&gas) / before.1 - 1.0).abs() < 1e-5);
}

#[test]
fn the_switch_is_one_in_compression_and_zero_in_rotation() {
    let switch = Viscosity::Balsara {
        alpha: 1.0,
        beta: 2.0,
    };
    let alpha =
        |viscosity: Viscosity, flow| viscosity.alpha(flow, 0.0, || unreachable!("no gradient"));
    let flow = Flow {
        div_v: -3.0,
        curl_v: 0.0,
        cs: 1.0,
        h: 0.1,
    };
    // 3 / (3 + 1e-3) and 0.
    assert!((alpha(switch, flow) - 3.0 / 3.001).abs() < 1e-15);
    let turning = Flow {
        div_v: 0.0,
        curl_v: 3.0,
        ..flow
    };
    assert_eq!(alpha(switch, turning), 0.0);
    assert_eq!(switch.ratio(), 2.0);
    assert_eq!(alpha(Viscosity::None, flow), 0.0);
}

#[test]
fn heavy_neighbours_in_a_row_make_no_gradient_of_any_size() {
    let (alpha, beta) = (1.0, 2.0);
    // Three of a thousand masses, a hundredth of their distance out of a straight line, and moving across it with the speed 1.
    let bend = |way: f64| {
        0.3 * way * Vec3::new(0.8, 0.6, 0.0) + way.abs() * 0.003 * Vec3::new(-0.6, 0.8, 0.0)
    };
    let across = Vec3::new(0.6, -0.8, 0.0);
    let mut particles = still(lattice([8, 8, 1], 1.0), 1.0, 1e-6);
    for way in [-1.0, 0.0, 1.0] {
        let i = particles.len();
        particles.resize(i + 1);
        particles.id[i] = i as u64;
        particles.x[i] = Vec3::new(4.0, 4.0, 0.0) + bend(way);
        particles.v[i] = way.abs() * across;
        (particles.m[i], particles.u[i]) = (1000.0, 1e-6);
    }
    let viscosity = Viscosity::NeumannRichtmyer { alpha, beta };
    let hydro = Hydro {
        viscosity,
        ..plane(Domain::open())
    };
    let mut gas = Gas::new(particles);
    gas.density(&hydro, &NOW, Vec3::zeros())
        .expect("a solution");
    let middle = (0..gas.len()).filter(|&i| gas.particles.m[i] > 1.0);
    for i in middle {
        let q = gas.derived.stress[i].x;
        // The plain sums have less than the velocity by h; the straight line would give it by a hundredth of 0.3.
        let bar = 0.5 * beta * gas.derived.rho[i];
        println!("{q:e} {bar:e}");
        assert!(q < bar, "{q:e} beyond {bar:e}");
    }
}
