//! Tests of `vicinity`.

use nbody::points::clock::{Pacing, TICKS};
use nbody::points::{Domain, Vec3};

use super::*;
use crate::samples::{hydro, noisy};

/// Gas with a hot corner, after some ticks of individual steps, and its clock, in the midst of a base step.
fn running(hydro: &Hydro, ticks: usize) -> (Gas, Clock) {
    let mut gas = noisy(&hydro.domain, 16, 0.2);
    for i in 0..gas.len() {
        let r = gas.particles.x[i].norm();
        gas.particles.u[i] *= 1.0 + 300.0 * (-(r / 0.2).powi(2)).exp();
    }
    gas.rates.u_pred.clone_from(&gas.particles.u);
    let mut clock = Clock::standing(0.0);
    for _ in 0..ticks {
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
        gas.close(hydro, &clock);
        gas.open(hydro, &clock, &next);
        clock = Clock {
            tick: gas.next_tick().min(TICKS),
            ..next
        };
        gas.refit(&hydro.domain, &clock);
    }
    assert!(!clock.synchronous());
    (gas, clock)
}

#[test]
fn leaves_hold_their_particles_until_they_are_seen_again() {
    let hydro = hydro(Domain::open());
    let (mut gas, clock) = running(&hydro, 7);
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
