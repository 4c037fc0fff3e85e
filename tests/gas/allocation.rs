//! Allocation: a tick of gas between two sorts asks the system for no memory.

use gas::{Gas, Hydro, Particles};
use nbody::points::clock::{Centre, Pacing, TICKS};
use nbody::points::{Clock, Columns, Domain, Vec3};

use crate::allocator::{watch, watched};

const SIDE: usize = 24;

/// A unit box of a lattice with a thin hot spot in balance of pressure, whose steps are far shorter than those of the rest.
fn mixed() -> Gas {
    let mut particles = Particles::default();
    particles.resize(SIDE.pow(3));
    for i in 0..particles.len() {
        let cells = Vec3::new(
            (i % SIDE) as f64,
            (i / SIDE % SIDE) as f64,
            (i / SIDE / SIDE) as f64,
        );
        let x = (cells + Vec3::repeat(0.5)) / SIDE as f64;
        let r = (x - Vec3::repeat(0.5)).norm();
        particles.x[i] = x;
        particles.id[i] = i as u64;
        particles.u[i] = 1.0 + 300.0 * (-(r / 0.15).powi(2)).exp();
        particles.m[i] = 1.0 / (SIDE.pow(3) as f64 * particles.u[i]);
    }
    Gas::new(particles)
}

/// Steps the gas over `steps` base steps of `base`; the calls for memory that ticks with and without a sort have made in the last one.
fn calls(gas: &mut Gas, hydro: &Hydro, base: f64, steps: u64) -> [u64; 2] {
    let mut clock = Clock::standing(0.0);
    let mut calls = [0; 2];
    loop {
        let synchronous = clock.synchronous();
        if synchronous && clock.step == steps {
            return calls;
        }
        let before = watched();
        gas.refit(&hydro.domain, &clock);
        let next = if synchronous {
            clock.next_base(clock.end + base, base)
        } else {
            clock
        };
        gas.density(hydro, &clock, Vec3::zeros())
            .expect("a density");
        if clock.step == 0 {
            gas.forces(hydro, &clock, &clock);
        }
        gas.steps(hydro, &clock, &next, &Pacing::free(base))
            .expect("a step");
        gas.forces(hydro, &clock, &next);
        gas.close(hydro, &clock, &Centre::default());
        gas.open(hydro, &clock, &next, &Centre::default());
        let made = watched() - before;
        if clock.step + 1 == steps {
            calls[usize::from(!synchronous)] += made;
        }
        clock = Clock {
            tick: gas.next_tick().min(TICKS),
            ..next
        };
    }
}

#[test]
fn a_tick_between_sorts_asks_for_no_memory() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .start_handler(|_| watch())
        .build()
        .expect("a pool");
    let hydro = Hydro::new(
        Domain::periodic(Vec3::repeat(1.0)),
        gas::Eos::Ideal { gamma: 5.0 / 3.0 },
    );
    let [sorting, between] = pool.install(|| calls(&mut mixed(), &hydro, 0.004, 8));
    println!("{sorting} calls at a tick with a sort, {between} at all others");
    assert_eq!(between, 0);
    // The lists of the three sets of columns.
    assert!(sorting > 0 && sorting <= 8, "{sorting}");
}
