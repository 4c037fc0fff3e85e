//! Places by the continuity equation: what they leave alone, what they bring back, and what they keep.

use std::f64::consts::TAU;

use nbody::points::{Clock, Domain, Vec3};

use super::super::tests::{cloud, noise_of, sheared, shearing};
use super::super::{Order, Rearrangement};
use super::*;
use crate::samples::hydro;

const LAW: Continuity = Continuity {
    tolerance: 1e-5,
    iterations: 60,
};

/// A rearrangement by continuity, the targets of `gas` being its densities times `part`.
fn begun(gas: &mut Gas, part: impl Fn(Vec3) -> f64) -> Rearrangement {
    let law = Rearrangement::new(Order::Continuity(LAW));
    law.begin(gas);
    let p = &mut gas.particles;
    for (q, &x) in p.target.iter_mut().zip(&p.x) {
        *q *= part(x);
    }
    law
}

#[test]
fn a_lattice_is_left_alone_at_rest_and_in_shear() {
    for dimensions in [2, 3] {
        let domain = shearing(dimensions);
        let mut hydro = hydro(domain);
        hydro.tolerance = 1e-12;
        // At rest relative to the shear, which carries each row across the box in the time 2/3.
        let mut gas = sheared(10, 0.0, &domain);
        noise_of(&mut gas, &hydro);
        let mut law = begun(&mut gas, |_| 1.0);
        let (mut failed, steps) = (0, 10);
        let mut worst = 0.0f64;
        for step in 0..=steps {
            let dt = if step == 0 {
                0.0
            } else {
                1.0 / (1.5 * steps as f64)
            };
            let domain = domain.at(step as f64 / (1.5 * steps as f64));
            let hydro = Hydro {
                domain,
                ..hydro.clone()
            };
            for (x, v) in gas.particles.x.iter_mut().zip(&gas.particles.v) {
                *x += dt * v;
            }
            gas.wrap(&domain);
            gas.sort();
            let clock = Clock::standing(0.0);
            gas.density(&hydro, &clock, Vec3::zeros())
                .expect("a density");
            let (_, solves) = law.shift(&mut gas, &hydro, dt);
            failed += solves.failed;
            worst = worst.max(solves.after / solves.count as f64);
            assert!(law.longest == 0.0, "{step}: {:e}", law.longest);
            assert!(solves.after <= solves.before);
        }
        println!(
            "{dimensions}: {failed} of {} without a solution, residual {worst:e}",
            steps + 1
        );
    }
}

/// A lattice in a periodic box with a wave of displacements along x, and its places without.
fn displaced(n: usize, jitter: f64, wave: f64) -> (Gas, Hydro, Vec<Vec3>) {
    let domain = Domain::periodic(Vec3::repeat(1.0)).with_axes([true, true, false]);
    let hydro = hydro(domain);
    let mut gas = sheared(n, 0.0, &shearing(2));
    gas.particles.v.fill(Vec3::zeros());
    gas.rates.v_pred.fill(Vec3::zeros());
    let lattice = gas.particles.x.clone();
    let moved = sheared(n, jitter, &shearing(2)).particles;
    let by_id = |id: u64| moved.id.iter().position(|&other| other == id);
    let spacing = 1.0 / n as f64;
    noise_of(&mut gas, &hydro);
    for (i, from) in lattice.iter().enumerate() {
        let at = by_id(gas.particles.id[i]).expect("the same particle");
        gas.particles.x[i] = moved.x[at];
        gas.particles.x[i].x += wave * spacing * (TAU * from.x).sin();
    }
    (gas, hydro, lattice)
}

/// Root mean square of the way from `places`.
fn away(gas: &Gas, ids: &[u64], places: &[Vec3]) -> f64 {
    let square = |(id, place): (&u64, &Vec3)| {
        let i = gas.particles.id.iter().position(|other| other == id);
        let x = gas.particles.x[i.expect("the same particle")];
        let d = Domain::periodic(Vec3::repeat(1.0)).nearest(x - place);
        d.norm_squared()
    };
    (ids.iter().zip(places).map(square).sum::<f64>() / ids.len() as f64).sqrt()
}

#[test]
fn a_displaced_lattice_comes_back() {
    // A long wave nearly as a whole, short disorder in part: W does not see its shortest waves, nor what has no divergence.
    for (jitter, wave, bar, residual) in [(0.0, 0.5, 0.02, 1e-3), (0.1, 0.0, 0.95, 0.05)] {
        let (mut gas, hydro, lattice) = displaced(24, jitter, wave);
        let ids = gas.particles.id.clone();
        let mut law = begun(&mut gas, |_| 1.0);
        gas.sort();
        let order: Vec<f64> = gas.particles.target.clone();
        assert_eq!(order.len(), gas.len());
        let before = away(&gas, &ids, &lattice);
        let (mut first, mut last) = (0.0, 0.0);
        for step in 0..4 {
            let (_, solves) = law.shift(&mut gas, &hydro, 0.0);
            first = if step == 0 { solves.before } else { first };
            last = solves.after;
            println!("{solves:?}");
            noise_of(&mut gas, &hydro);
        }
        let after = away(&gas, &ids, &lattice);
        println!("away {before:e} to {after:e}, residual {first:e} to {last:e}");
        assert!(after < bar * before, "{before:e} to {after:e}");
        assert!(last < residual * first, "{first:e} to {last:e}");
    }
}

#[test]
fn the_books_close() {
    for (n, axes) in [(24, [true, true, false]), (12, [true; 3])] {
        let v = |x: Vec3| {
            let r = x - Vec3::new(0.5, 0.5, 0.0);
            let turn = 1.0 / (0.1 + r.norm_squared());
            Vec3::new(3.0 - turn * r.y, turn * r.x - 1.0, 0.0)
        };
        let u = |x: Vec3| if x.x > 0.6 { 50.0 } else { 1.0 + x.y };
        let (mut gas, hydro) = cloud(n, axes, v, u);
        noise_of(&mut gas, &hydro);
        let law = begun(&mut gas, |x| 1.0 + 0.1 * (20.0 * x.x).sin());
        let changes = super::super::tests::change(&mut gas, &hydro, law);
        println!("{changes:?}");
        assert!(
            changes.iter().all(|change| change.abs() < 2.5e-14),
            "{changes:?}"
        );
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let (mut gas, hydro, _) = displaced(24, 0.1, 0.0);
            let mut law = begun(&mut gas, |_| 1.0);
            gas.sort();
            law.shift(&mut gas, &hydro, 0.1);
            let bits = |x: &Vec3| x.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            (
                gas.particles.x.iter().map(bits).collect::<Vec<_>>(),
                gas.particles.target.clone(),
            )
        })
    };
    let one = run(1);
    assert!(one == run(2) && one == run(7));
}
