//! Tests of `vicinity`.

use nbody::points::clock::{Centre, Pacing, TICKS};
use nbody::points::{Domain, Vec3};

use super::*;
use crate::samples::{hydro, noisy};

/// Gas with a hot corner in the midst of a base step, at a tick at which less than half of it is looked at, and its clock.
fn running(hydro: &Hydro) -> (Gas, Clock) {
    let mut gas = noisy(&hydro.domain, 20, 0.2);
    for i in 0..gas.len() {
        let r = gas.particles.x[i].norm();
        gas.particles.u[i] *= 1.0 + 300.0 * (-(r / 0.1).powi(2)).exp();
    }
    gas.rates.u_pred.clone_from(&gas.particles.u);
    let mut clock = Clock::standing(0.0);
    for _ in 0..60 {
        let next = if clock.synchronous() {
            clock.next_base(clock.end + 0.05, 0.05)
        } else {
            clock
        };
        gas.density(hydro, &clock, Vec3::zeros())
            .expect("a density");
        let pacing = Pacing::free(f64::INFINITY);
        gas.forces(hydro, &clock, &next);
        gas.steps(hydro, &clock, &next, &pacing).expect("a step");
        gas.forces(hydro, &clock, &next);
        gas.close(hydro, &clock, &Centre::default());
        gas.open(hydro, &clock, &next, &Centre::default());
        clock = Clock {
            tick: gas.next_tick().min(TICKS),
            ..next
        };
        gas.refit(&hydro.domain, &clock);
        let mut trial = gas.clone();
        trial.look(hydro, &clock);
        if 2 * trial.vicinity.near.len() < gas.tree.leaves.len() {
            return (gas, clock);
        }
    }
    panic!("all gas is near at every tick");
}

#[test]
fn what_is_near_gets_what_it_gets_where_all_gas_is_looked_at() {
    for domain in [Domain::open(), Domain::periodic(Vec3::repeat(1.0))] {
        let hydro = hydro(domain);
        let (mut gas, clock) = running(&hydro);
        let mut whole = gas.clone();
        gas.density(&hydro, &clock, Vec3::zeros())
            .expect("a density");
        gas.forces(&hydro, &clock, &clock);
        whole.look(&hydro, &clock);
        whole.look_far(&hydro, &clock);
        whole
            .density_near(&hydro, &clock, Vec3::zeros())
            .expect("a density");
        whole.forces(&hydro, &clock, &clock);
        let vicinity = &gas.vicinity;
        assert!(!vicinity.active.is_empty());
        let mut seen = vec![false; gas.len()];
        for &leaf in &vicinity.near {
            gas.tree.nodes[leaf as usize]
                .range()
                .for_each(|i| seen[i] = true);
        }
        let largest = (whole.rates.dv_close.iter()).fold(0.0f64, |m, dv| m.max(dv.norm()));
        for (i, seen) in seen.into_iter().enumerate() {
            let expected = whole.rates.dv_close[i];
            if !seen {
                assert_eq!(expected, Vec3::zeros(), "a particle that should be near");
                continue;
            }
            let error = (gas.rates.dv_close[i] - expected).norm() / largest;
            assert!(error < 1e-8, "{error:e}");
            assert!((gas.particles.x[i] - whole.particles.x[i]).norm() < 1e-15);
            let density = gas.derived.rho[i] / whole.derived.rho[i] - 1.0;
            assert!(density.abs() < 1e-12, "{density:e}");
        }
    }
}

#[test]
fn leaves_hold_their_particles_until_they_are_seen_again() {
    let hydro = hydro(Domain::open());
    let (mut gas, clock) = running(&hydro);
    let boxes = gas.tree.clone();
    let reach: Vec<f64> = (gas.leaves.iter())
        .map(|leaf| leaf.largest_h(&clock, 3))
        .collect();
    gas.arrive(&hydro.domain, &clock);
    for &leaf in &boxes.leaves {
        let node = &boxes.nodes[leaf as usize];
        for i in node.range() {
            let x = gas.particles.x[i];
            assert!(x.inf(&node.lo) == node.lo && x.sup(&node.hi) == node.hi);
            assert!(gas.particles.h[i] <= reach[leaf as usize]);
        }
    }
}

#[test]
fn a_support_that_outgrows_the_vicinity_is_sought_among_all_gas() {
    let hydro = hydro(Domain::open());
    let (mut gas, clock) = running(&hydro);
    gas.arrive(&hydro.domain, &clock);
    let mut whole = gas.clone();
    for h in &mut gas.particles.h {
        *h *= 0.3;
    }
    gas.bound();
    let mut first = gas.clone();
    first.look(&hydro, &clock);
    first
        .density_near(&hydro, &clock, Vec3::zeros())
        .expect("a density");
    let left = first.beyond.len();
    assert!(left > 0, "the vicinity holds every support");
    let found = gas.density(&hydro, &clock, Vec3::zeros());
    let found = found.expect("a density");
    assert_eq!(found, gas.active_ones().len());
    whole
        .density(&hydro, &clock, Vec3::zeros())
        .expect("a density");
    for &i in gas.active_ones() {
        let i = i as usize;
        // Both are solutions to the tolerance of h.
        let density = gas.derived.rho[i] / whole.derived.rho[i] - 1.0;
        assert!(density.abs() < 6.0 * hydro.tolerance, "{density:e}");
    }
}
