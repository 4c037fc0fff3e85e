//! Rearranged gas: what it keeps, and what becomes of its noise.

use nbody::points::{Clock, Domain, Vec3};

use super::{Order, Rearrangement};
use crate::samples::{hydro, lattice, noise, still};
use crate::{Eos, Gas, Hydro};

const PLANE: [bool; 3] = [true, true, false];

/// A cubic lattice of unit density in a shearing box of side one, `jitter` of a spacing away from its places, at rest relative to the shear.
pub(super) fn sheared(n: usize, jitter: f64, domain: &Domain) -> Gas {
    let third = if domain.dimensions() == 3 { n } else { 1 };
    let spacing = 1.0 / n as f64;
    let count = (n * n * third) as f64;
    let mut particles = still(lattice([n, n, third], spacing), 1.0 / count, 1.0);
    for (i, x) in particles.x.iter_mut().enumerate() {
        *x += jitter * spacing * domain.in_plane(noise(i as u64, 1));
    }
    let hill = *domain.hill().expect("a shearing box");
    particles.v = (particles.x.iter().map(|&x| hill.stream(x) * Vec3::y())).collect();
    Gas::new(particles)
}

pub(super) fn shearing(dimensions: usize) -> Domain {
    let domain = Domain::shearing(Vec3::repeat(1.0), 1.0, 1.5);
    if dimensions == 2 {
        domain.with_axes(PLANE)
    } else {
        domain
    }
}

fn repulsion() -> Rearrangement {
    Rearrangement::new(Order::Repulsion { strength: 1.0 })
}

/// Finds densities, and with them smoothing lengths; returns the root mean square of the density about its mean.
pub(super) fn noise_of(gas: &mut Gas, hydro: &Hydro) -> f64 {
    let clock = Clock::standing(0.0);
    gas.density(hydro, &clock, Vec3::zeros())
        .expect("a density");
    let n = gas.len() as f64;
    let mean = gas.derived.rho.iter().sum::<f64>() / n;
    let square = |rho: &f64| (rho / mean - 1.0).powi(2);
    (gas.derived.rho.iter().map(square).sum::<f64>() / n).sqrt()
}

#[test]
fn a_lattice_stays_where_it_is() {
    for dimensions in [2, 3] {
        let domain = shearing(dimensions);
        let mut hydro = hydro(domain);
        hydro.tolerance = 1e-12;
        let mut gas = sheared(10, 0.0, &domain);
        noise_of(&mut gas, &hydro);
        let mut law = repulsion();
        law.shift(&mut gas, &hydro, 1.0);
        // As far as smoothing lengths differ by rounding and tolerance.
        eprintln!("lattice {:e}", law.longest);
        assert!(law.longest < 1e-12, "{:e}", law.longest);
        let v = gas.particles.v.clone();
        let u = gas.particles.u.clone();
        law.settle(&mut gas, &hydro);
        let given =
            (gas.particles.v.iter().zip(&v)).fold(0.0, |m: f64, (a, b)| m.max((a - b).norm()));
        assert!(given < 1e-14 && gas.particles.u == u, "{given:e}");
    }
}

#[test]
fn disorder_falls_and_only_where_gas_shears() {
    for (dimensions, n, bar) in [(2, 24, 0.65), (3, 12, 0.6)] {
        let domain = shearing(dimensions);
        let hydro = hydro(domain);
        let mut gas = sheared(n, 0.25, &domain);
        let mut law = repulsion();
        let before = noise_of(&mut gas, &hydro);
        for _ in 0..40 {
            law.shift(&mut gas, &hydro, 0.2);
            law.settle(&mut gas, &hydro);
            noise_of(&mut gas, &hydro);
        }
        let after = noise_of(&mut gas, &hydro);
        eprintln!(
            "{dimensions}: {before:e} to {after:e}, longest {:e}",
            law.longest * n as f64
        );
        assert!(after < bar * before, "{before:e} to {after:e}");

        // The same arrangement in solid rotation.
        let still_box = Domain::periodic(Vec3::repeat(1.0)).with_axes(domain.axes);
        let mut gas = sheared(n, 0.25, &domain);
        gas.rates.v_pred.fill(Vec3::new(0.3, 0.2, 0.1));
        let hydro = Hydro {
            domain: still_box,
            ..hydro
        };
        noise_of(&mut gas, &hydro);
        law.shift(&mut gas, &hydro, 0.2);
        assert!(law.longest < 1e-14, "{:e}", law.longest);
    }
}

/// A jittered ball or disk in open space with the velocities and energies of fields of its places, and masses of two kinds.
pub(super) fn cloud(
    n: usize,
    axes: [bool; 3],
    v: impl Fn(Vec3) -> Vec3,
    u: impl Fn(Vec3) -> f64,
) -> (Gas, Hydro) {
    let domain = Domain::open().with_axes(axes);
    let third = if axes[2] { n } else { 1 };
    let spacing = 1.0 / n as f64;
    let mut x = lattice([n, n, third], spacing);
    for (i, x) in x.iter_mut().enumerate() {
        *x += 0.25 * spacing * domain.in_plane(noise(i as u64, 1));
    }
    let middle = Vec3::new(0.5, 0.5, if axes[2] { 0.5 } else { x[0].z });
    x.retain(|x| (x - middle).norm() < 0.5);
    let mut particles = still(x, 1.0, 1.0);
    for i in 0..particles.x.len() {
        particles.v[i] = v(particles.x[i]);
        particles.u[i] = u(particles.x[i]);
        particles.m[i] = if i % 3 == 0 { 2e-3 } else { 1e-3 };
    }
    (Gas::new(particles), hydro(domain))
}

/// Relative changes of momentum, angular momentum and energy by a shift and its settlement, and what the books say of them.
pub(super) fn change(gas: &mut Gas, hydro: &Hydro, mut law: Rearrangement) -> [f64; 4] {
    noise_of(gas, hydro);
    let before = gas.totals();
    law.shift(gas, hydro, 0.3);
    assert!(law.longest > 1e-3, "something moves");
    // A kick that closes the step: it has neither momentum nor torque where the particles are now.
    let p = &mut gas.particles;
    let mass: f64 = p.m.iter().sum();
    let centre = p.m.iter().zip(&p.x).map(|(m, x)| *m * x).sum::<Vec3>() / mass;
    for (v, x) in p.v.iter_mut().zip(&p.x) {
        *v += 5.0 * (x - centre);
    }
    let closed = gas.totals();
    let settled = law.settle(gas, hydro);
    let after = gas.totals();
    let p = &gas.particles;
    let sum = |part: &dyn Fn(usize) -> f64| (0..gas.len()).map(part).sum::<f64>();
    let speeds = sum(&|i| p.m[i] * p.v[i].norm());
    let levers = sum(&|i| p.m[i] * p.v[i].norm() * p.x[i].norm());
    let energy = closed.kinetic + closed.internal;
    let gained = after.kinetic - closed.kinetic + after.internal - closed.internal;
    [
        (after.momentum - before.momentum).norm() / speeds,
        (after.angular_momentum - before.angular_momentum).norm() / levers,
        (gained + settled.heat.radiated - settled.heat.floored) / energy,
        (settled.kinetic + closed.kinetic - after.kinetic) / energy,
    ]
}

#[test]
fn momentum_angular_momentum_and_energy_are_kept() {
    for (n, axes) in [(24, PLANE), (12, [true; 3])] {
        // Differential rotation, with motion along the axis and a jump of the energy.
        let v = |x: Vec3| {
            let r = x - Vec3::new(0.5, 0.5, 0.0);
            let turn = 1.0 / (0.1 + r.norm_squared());
            Vec3::new(3.0 - turn * r.y, turn * r.x - 1.0, 0.0)
        };
        let u = |x: Vec3| if x.x > 0.6 { 50.0 } else { 1.0 + x.y };
        let (mut gas, hydro) = cloud(n, axes, v, u);
        let ideal = change(&mut gas, &hydro, repulsion());
        let (mut gas, mut hydro) = cloud(n, axes, v, |_| 2.5);
        hydro.eos = Eos::Isothermal {
            sound_speed: 1.0,
            gamma: 1.4,
        };
        let bound = change(&mut gas, &hydro, repulsion());
        for changes in [ideal, bound] {
            eprintln!("{changes:?}");
            assert!(
                changes.iter().all(|change| change.abs() < 2.5e-14),
                "{changes:?}"
            );
        }
    }
}

#[test]
fn linear_fields_stay_in_their_places() {
    for (n, axes) in [(24, PLANE), (12, [true; 3])] {
        let v = |x: Vec3| Vec3::new(1.0 + 2.0 * x.y, x.x - 3.0 * x.y, 0.3 * x.x);
        let u = |x: Vec3| 3.0 + x.x - x.y;
        let (mut gas, hydro) = cloud(n, axes, v, u);
        noise_of(&mut gas, &hydro);
        let mut law = repulsion();
        law.shift(&mut gas, &hydro, 0.3);
        let (p, r) = (&gas.particles, &gas.rates);
        let error = |i: usize| (r.v_pred[i] - v(p.x[i])).norm() + (r.u_pred[i] - u(p.x[i])).abs();
        let most = (0..gas.len()).map(error).fold(0.0, f64::max);
        assert!(most < 1e-13 && law.longest > 0.01 / n as f64, "{most:e}");
        // The rotations that keep the angular momentum, and the work, are what the settlement adds.
        law.settle(&mut gas, &hydro);
        let p = &gas.particles;
        let wrong = |i: usize| (p.v[i] - v(p.x[i])).norm_squared();
        let moved = |i: usize| (p.v[i] - v(p.x[i] - law.moves[i].x)).norm_squared();
        let root = |of: &dyn Fn(usize) -> f64| (0..gas.len()).map(of).sum::<f64>().sqrt();
        let part = root(&wrong) / root(&moved);
        eprintln!("rotations: {part:e} of the correction");
        assert!(part < 0.1, "{part:e}");
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let domain = shearing(3);
    let hydro = hydro(domain);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| {
            let mut gas = sheared(12, 0.25, &domain);
            let mut law = repulsion();
            for _ in 0..3 {
                noise_of(&mut gas, &hydro);
                law.shift(&mut gas, &hydro, 0.2);
                law.settle(&mut gas, &hydro);
            }
            let p = &gas.particles;
            let bits = |x: &Vec3| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            (
                p.x.iter().chain(&p.v).map(bits).collect::<Vec<_>>(),
                p.u.clone(),
            )
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(7));
}
