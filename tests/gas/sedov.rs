//! Sedov's blast in a cold medium, three dimensions, gamma = 5/3, with individual steps: what keeps gas from sleeping through the shock.

use gas::alone::{Account, advance};
use gas::{Gas, Hydro, Particles, UNLIMITED, Viscosity};
use nbody::points::{Columns, Domain, Vec3};

const GAMMA: f64 = 5.0 / 3.0;
/// Energy integral of the similarity solution (Sedov 1959), for R = (E t^2 / (alpha rho))^(1/5).
const ALPHA: f64 = 0.493_590_149_582;
const TIME: f64 = 0.05;
const SIDE: usize = 32;
/// Particles that the energy is given to: those of a kernel.
const HOT: usize = 32;

/// A unit box of a lattice, cold but for its middle, which has an energy of one.
fn blast() -> Gas {
    let spacing = 1.0 / SIDE as f64;
    let place = |i: usize| (i as f64 + 0.5) * spacing;
    let mut particles = Particles::default();
    particles.resize(SIDE.pow(3));
    particles.id = (0..SIDE.pow(3) as u64).collect();
    for (i, x) in particles.x.iter_mut().enumerate() {
        *x = Vec3::new(
            place(i % SIDE),
            place(i / SIDE % SIDE),
            place(i / SIDE / SIDE),
        );
    }
    let m = spacing.powi(3);
    particles.m.fill(m);
    particles.u.fill(1e-6);
    let mut by_distance: Vec<usize> = (0..particles.len()).collect();
    by_distance.sort_by(|&a, &b| {
        let r = |i: usize| (particles.x[i] - Vec3::repeat(0.5)).norm();
        r(a).total_cmp(&r(b))
    });
    for &i in &by_distance[..HOT] {
        particles.u[i] = 1.0 / (m * HOT as f64);
    }
    Gas::new(particles)
}

fn settings(limiter: u32) -> Hydro {
    Hydro {
        viscosity: Viscosity::Constant {
            alpha: 1.0,
            beta: 2.0,
        },
        limiter,
        ..Hydro::new(
            Domain::periodic(Vec3::repeat(1.0)),
            gas::Eos::Ideal { gamma: GAMMA },
        )
    }
}

/// Energy error and the run's account. In one base step: cold gas by itself would take it whole.
fn exploded(limiter: u32) -> (Gas, f64, Account) {
    let mut gas = blast();
    let energy = |gas: &Gas| {
        let totals = gas.totals();
        totals.kinetic + totals.internal
    };
    let before = energy(&gas);
    let account = advance(&mut gas, &settings(limiter), 0.0, TIME, TIME).expect("a run");
    let error = (energy(&gas) / before - 1.0).abs();
    (gas, error, account)
}

/// Where the spherically averaged density falls to half of its maximum, outside of that.
fn shock_radius(gas: &Gas) -> f64 {
    let (bins, width) = (50, 0.01);
    let mut shells = vec![[0.0; 2]; bins];
    for i in 0..gas.len() {
        let bin = ((gas.particles.x[i] - Vec3::repeat(0.5)).norm() / width) as usize;
        if bin < bins {
            shells[bin][0] += gas.derived.rho[i];
            shells[bin][1] += 1.0;
        }
    }
    let rho: Vec<f64> = shells
        .iter()
        .map(|[sum, n]| sum / f64::max(*n, 1.0))
        .collect();
    let peak = (0..bins).fold(0, |best, k| if rho[k] > rho[best] { k } else { best });
    let half = 1.0 + 0.5 * (rho[peak] - 1.0);
    let k = (peak..bins - 1)
        .find(|&k| rho[k + 1] < half)
        .expect("an outer edge");
    (k as f64 + 0.5 + (rho[k] - half) / (rho[k] - rho[k + 1])) * width
}

#[test]
fn a_blast_in_cold_gas_keeps_its_energy_and_its_shock_is_on_time() {
    let (gas, error, account) = exploded(4);
    let exact = (TIME * TIME / ALPHA).powf(0.2);
    let late = shock_radius(&gas) / exact - 1.0;
    println!("energy {error:.2e}, shock {late:+.3}, {account:?}");
    // 1.8e-3.
    assert!(error < 3.5e-3, "energy {error:e}");
    // 4.7 %: what 32 particles a side make of a shock.
    assert!(late.abs() < 0.07, "shock {late}");
    // Individual steps are at work.
    assert!(
        2 * account.updates < account.ticks * gas.len(),
        "{account:?}"
    );
}

#[test]
fn without_the_limiter_cold_gas_sleeps_through_the_blast() {
    let (_, error, account) = exploded(UNLIMITED);
    println!("energy {error:.2e}, {account:?}");
    // 117 %.
    assert!(error > 0.6, "energy {error:e}, {account:?}");
}
