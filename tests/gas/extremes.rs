//! Gas at the extremes by every formulation, viscosity and gradient: numbers stay finite, momentum and energy are kept.
//!
//! Momentum is judged by the sum of the moduli of all momenta (of the speeds that the energy could give, where gas begins at rest), energy by
//! all of it, which the leapfrog keeps to the order of its steps.

use gas::{
    Eos, Formulation, Gas, Gradient, Hydro, Particles, Precision, Reconstruction, Viscosity, alone,
};
use nbody::points::{Columns, Domain, Vec3};

/// How gas begins, and for how long it is followed.
struct Case {
    domain: Domain,
    particles: Particles,
    until: f64,
}

/// Particles of mass one at rest.
fn gas(x: Vec<Vec3>, u: f64) -> Particles {
    let mut particles = Particles::default();
    particles.resize(x.len());
    particles.id = (0..x.len() as u64).collect();
    particles.m.fill(1.0);
    particles.u.fill(u);
    particles.x = x;
    particles
}

/// A lattice of unit spacing, jittered without a random number.
fn lattice(n: [usize; 3]) -> Vec<Vec3> {
    let jitter = |i: usize, a: usize| 0.1 * ((i * (3 * a + 7)) as f64 * 0.618_034).fract();
    (0..n[0] * n[1] * n[2])
        .map(|i| {
            let place = [i % n[0], i / n[0] % n[1], i / (n[0] * n[1])];
            Vec3::from_fn(|a, _| place[a] as f64 + 0.5 + jitter(i, a))
        })
        .collect()
}

fn periodic(n: [usize; 3]) -> Domain {
    Domain::periodic(Vec3::new(n[0] as f64, n[1] as f64, n[2] as f64))
}

fn cube() -> Vec<Vec3> {
    lattice([8; 3])
}

/// Viscosities by how they take the velocities of a pair.
fn viscosities() -> Vec<(Viscosity, Reconstruction)> {
    let (alpha, beta) = (1.0, 2.0);
    let as_they_are = [
        Viscosity::None,
        Viscosity::Constant { alpha, beta },
        Viscosity::Balsara { alpha, beta },
        Viscosity::CullenDehnen { alpha, beta },
        Viscosity::NeumannRichtmyer { alpha, beta },
        Viscosity::Tensor { alpha, beta },
        Viscosity::Planar { alpha, beta },
        Viscosity::PlanarSwitch { alpha, beta },
    ];
    let followed = [
        Viscosity::Constant { alpha, beta },
        Viscosity::Balsara { alpha, beta },
    ];
    let as_they_are = as_they_are.map(|kind| (kind, Reconstruction::None));
    let followed = followed.map(|kind| (kind, Reconstruction::Linear));
    [as_they_are.as_slice(), &followed].concat()
}

/// Energy, momentum and the sum of its moduli.
fn books(gas: &Gas) -> (f64, Vec3, f64) {
    let p = &gas.particles;
    let all = 0..p.len();
    let energy = |i: usize| p.m[i] * (p.u[i] + 0.5 * p.v[i].norm_squared());
    (
        all.clone().map(energy).sum(),
        all.clone().map(|i| p.m[i] * p.v[i]).sum(),
        all.map(|i| p.m[i] * (p.v[i].norm() + p.u[i].sqrt())).sum(),
    )
}

/// Errors of momentum and energy, or what went wrong.
fn outcome(case: &Case, hydro: &Hydro) -> Result<[f64; 2], String> {
    let mut gas = Gas::new(case.particles.clone());
    let (energy, momentum, moduli) = books(&gas);
    let account = alone::advance(&mut gas, hydro, 0.0, case.until, 0.25 * case.until)
        .map_err(|fault| fault.to_string())?;
    let p = &gas.particles;
    let sound = |i: usize| p.x[i].sum().is_finite() && p.u[i] >= 0.0 && p.h[i] > 0.0;
    if !(0..p.len()).all(sound) {
        return Err("numbers that are none".to_owned());
    }
    let (after, carried, _) = books(&gas);
    let after = after - account.heat.floored;
    Ok([
        (carried - momentum).norm() / moduli,
        (after / energy - 1.0).abs(),
    ])
}

/// Runs a case by every scheme that `does` lets pass; `bar` is of the energy.
fn stands(case: &Case, bar: f64, does: fn(&Hydro) -> bool) {
    let mut failures = Vec::new();
    let mut worst = [0.0f64; 2];
    for formulation in Formulation::ALL {
        for (viscosity, reconstruction) in viscosities() {
            for gradient in [Gradient::Standard, Gradient::Matrix] {
                let hydro = Hydro {
                    formulation,
                    viscosity,
                    reconstruction,
                    gradient,
                    precision: Precision::Single,
                    ..Hydro::new(case.domain, Eos::Ideal { gamma: 5.0 / 3.0 })
                };
                if hydro.clashing().is_some() || !does(&hydro) {
                    continue;
                }
                let outcome = outcome(case, &hydro);
                println!(
                    "{formulation:?}, {viscosity:?}, {reconstruction:?}, {gradient:?}: {outcome:?}"
                );
                let [momentum, energy] = outcome.clone().unwrap_or([f64::INFINITY; 2]);
                worst = [worst[0].max(momentum), worst[1].max(energy)];
                // Forces of a pair are opposite to the last bit where both have the same step.
                if !(momentum < 1e-13 && energy < bar) {
                    failures.push(format!(
                        "{formulation:?}, {viscosity:?}, {reconstruction:?}, {gradient:?}: {outcome:?}"
                    ));
                }
            }
        }
    }
    println!("momentum {:.1e}, energy {:.1e}", worst[0], worst[1]);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Smoothed energies are for comparison: cold particles beside hot ones cool below nothing.
fn plain(hydro: &Hydro) -> bool {
    hydro.formulation != Formulation::Smoothed
}

fn case(domain: Domain, particles: Particles, until: f64) -> Case {
    Case {
        domain,
        particles,
        until,
    }
}

#[test]
fn one_particle() {
    let mut alone = gas(vec![Vec3::new(0.3, 0.2, 0.1)], 1.0);
    alone.v[0] = Vec3::new(0.1, -0.2, 0.3);
    stands(&case(Domain::open(), alone, 1.0), 1e-15, |_| true);
}

#[test]
fn two_particles_at_one_place() {
    let pair = gas(vec![Vec3::repeat(0.5); 2], 1.0);
    stands(&case(Domain::open(), pair, 1.0), 1e-15, |_| true);
}

#[test]
fn particles_on_a_line() {
    let line = (0..50).map(|k| Vec3::new(f64::from(k), 0.0, 0.0)).collect();
    stands(&case(Domain::open(), gas(line, 1.0), 2.0), 1.6e-3, |_| true);
}

#[test]
fn gas_in_a_vacuum() {
    stands(&case(Domain::open(), gas(cube(), 1.0), 10.0), 1e-2, |_| {
        true
    });
}

#[test]
fn densities_of_one_to_1e8_are_followed_or_refused() {
    let mut contrast = gas(cube(), 1.0);
    for i in (0..contrast.len()).filter(|i| i % 8 < 4) {
        contrast.m[i] = 1e-8;
        contrast.u[i] = 1e8;
    }
    let case = case(periodic([8; 3]), contrast, 1e-3);
    for formulation in [
        Formulation::Density,
        Formulation::Pressure,
        Formulation::Number,
    ] {
        let hydro = Hydro {
            formulation,
            viscosity: Viscosity::CullenDehnen {
                alpha: 1.0,
                beta: 2.0,
            },
            ..Hydro::new(case.domain, Eos::Ideal { gamma: 5.0 / 3.0 })
        };
        let outcome = outcome(&case, &hydro);
        println!("{formulation:?}: {outcome:?}");
        match outcome {
            Ok([momentum, energy]) => assert!(momentum < 1e-13 && energy < 1e-2),
            Err(sentence) => assert!(sentence.contains("needs a time step of"), "{sentence}"),
        }
    }
}

#[test]
fn streams_at_mach_1000() {
    let mut streams = gas(lattice([16, 6, 6]), 0.9e-6);
    for i in 0..streams.len() {
        streams.v[i].x = (8.0 - streams.x[i].x).signum();
    }
    stands(&case(periodic([16, 6, 6]), streams, 1.5), 1e-2, plain);
}

#[test]
fn gas_without_heat() {
    let mut cold = gas(cube(), 0.0);
    for i in 0..cold.len() {
        cold.v[i] = cold.x[(i * 37 + 11) % 512] / 8.0 - Vec3::repeat(0.5);
    }
    stands(&case(periodic([8; 3]), cold, 1.0), 1e-2, plain);
}
