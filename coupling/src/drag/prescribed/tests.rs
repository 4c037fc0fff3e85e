//! Grains in a disk that is a formula: drift at any stopping time, order, and the books.

use dust::motion::Parts;
use dust::{Dust, Superparticles};
use nbody::Kind;
use nbody::points::{Columns, Domain};

use super::*;
use crate::drift::{DriftBodies, DriftDust, Kepler};
use crate::external::Rotation;
use crate::gravity::{ALL_PULL, Gravity, Mutual, Plan, Softening};
use crate::kick::{KickBodies, KickDust, Reaction, Steps};
use crate::ledger::Census;
use crate::{Splitting, Unmetered};

/// So thin that drifts are those of the linear theory to 1e-4.
const THIN: GasDisk = GasDisk {
    surface_density: 1e-4,
    slope: -1.0,
    reference_radius: 1.0,
    aspect_ratio: 0.01,
    flaring: 0.25,
    inner_radius: 0.1,
    outer_radius: 10.0,
    rotation: Rotation::Pressure,
};

const TIES: Ties = Ties {
    star_pulls: true,
    star_moves: true,
};

/// A star that moves, and grains of mass `m` about it at `places`, which begin with the drift of `stokes`.
fn system(disk: &GasDisk, places: &[Vec3], stokes: f64, m: f64) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    system.star.resize(1);
    system.star.m[0] = 1.0;
    system.star.kind[0] = Kind::Star as u32;
    (system.star.x[0], system.star.v[0]) =
        (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.02, 0.01, -0.03));
    let mut p = Superparticles::default();
    p.resize(places.len());
    for (i, &place) in places.iter().enumerate() {
        let v = disk.drift(place, 1.0, stokes).expect("gas");
        (p.id[i], p.m[i]) = (i as u64 + 1, m);
        (p.x[i], p.v[i]) = (system.star.x[0] + place, system.star.v[0] + v);
        (p.grain_radius[i], p.grain_density[i]) = (1.0, 1.0);
    }
    system.dust = Dust::new(p);
    system.look();
    system
}

fn splitting(disk: GasDisk, law: StoppingLaw, step: f64) -> Splitting {
    let plan = Plan {
        tree: None,
        pulls: ALL_PULL,
        gas: Softening::Length(0.0),
        dust: Softening::Length(0.0),
        star_in_kick: false,
        mutual: Mutual::Kick,
        held_back: false,
        field_steps: false,
    };
    let reaction = Reaction {
        pulled: true,
        on: [true, true],
        softening: Softening::Length(0.0),
    };
    let pacing = Steps {
        longest: step,
        orbit: 1.0,
    };
    let parts = Parts {
        force: 1.0,
        courant: f64::INFINITY,
    };
    Splitting::new(vec![
        Box::new(Gravity::new(plan)),
        Box::new(DustInDisk::new(disk, law, TIES)),
        Box::new(KickBodies { step, mutual: true }),
        Box::new(KickDust::new(pacing, parts, reaction)),
        Box::new(DriftDust),
        Box::new(DriftBodies::new(Kepler)),
    ])
}

/// Advances to `end` by steps of `step`; opens the books at the start.
fn advance(system: &mut System, (disk, law): (GasDisk, StoppingLaw), step: f64, end: f64) {
    let mut splitting = splitting(disk, law, step);
    let meter = &mut Unmetered;
    loop {
        let now = system.clock.time();
        system.reporting = now == 0.0 || now >= end;
        let until = if now < end { end } else { end + step };
        splitting.close(system, until, step, meter).expect("a step");
        if now >= end {
            return;
        }
        if now == 0.0 {
            let potential = system.potential;
            let census = Census::scaled(system);
            system.ledger.open(census, potential);
        }
        splitting.open(system, meter).expect("a step");
        splitting.cross(system, meter).expect("a step");
    }
}

fn from_star(system: &System, i: usize) -> Vec3 {
    system.dust.particles.x[i] - system.star.x[0]
}

#[test]
fn grains_drift_as_theory_says_at_any_stopping_time() {
    // 2 eta = -h^2 dlnP/dlnR = h^2 (1 + 7/4); with individual steps of a tenth of 1/Omega, errors are of their square.
    let headwind = 0.5 * 1e-4 * 2.75;
    for stokes in [1e-9, 1e-6, 1e-3, 0.03, 0.3, 1.0, 10.0] {
        let mut system = system(&THIN, &[Vec3::new(0.6, 0.8, 0.0)], stokes, 1e-20);
        let law = StoppingLaw::ConstantStokes(stokes);
        let period = 5.0 * std::f64::consts::TAU;
        advance(&mut system, (THIN, law), 0.1, period);
        let end = from_star(&system, 0);
        let speed = (end.norm() - 1.0) / period;
        let expected = -2.0 * headwind * stokes / (1.0 + stokes * stokes);
        let error = speed / expected - 1.0;
        // Rounding of the distance shows in drifts of 1e-13.
        let bar = 1.5e-3 + 1e-17 / expected.abs();
        println!("St {stokes}: {speed:e}, expected {expected:e}: {error:e}");
        assert!(error.abs() < bar, "{stokes}: {error}");
        let stokes_found = system.dust.derived.stokes[0] / stokes;
        assert!((stokes_found - 1.0).abs() < 1e-12, "{stokes_found}");
        assert!(system.dust.derived.rho_gas[0] > 0.0);
    }
}

#[test]
fn the_map_is_of_second_order() {
    let place = [Vec3::new(0.6, 0.8, 0.01)];
    for stokes in [0.1, 1.0] {
        let at = |step: f64| {
            let mut system = system(&THIN, &place, stokes, 1e-9);
            system.dust.particles.v[0] += Vec3::new(0.01, 0.02, 0.01);
            system.dust.rates.v_pred[0] = system.dust.particles.v[0];
            let law = StoppingLaw::ConstantStokes(stokes);
            advance(&mut system, (THIN, law), step, 3.0);
            from_star(&system, 0)
        };
        let exact = at(3.0 / 1024.0);
        let [coarse, fine] = [64.0, 128.0].map(|n| (at(3.0 / n) - exact).norm());
        let ratio = coarse / fine;
        println!("St {stokes}: errors {coarse:e} and {fine:e}, ratio {ratio}");
        assert!((3.6..4.6).contains(&ratio), "{stokes}: {ratio}");
    }
}

#[test]
fn layers_settle_as_damped_oscillators() {
    let height = 1e-4;
    for stokes in [1e-3, 0.1, 1.0, 10.0] {
        let mut system = system(&THIN, &[Vec3::new(0.6, 0.8, height)], stokes, 1e-20);
        let law = StoppingLaw::ConstantStokes(stokes);
        let end = 5.0;
        // Leapfrog about a star runs ahead by (Omega dt)^2 / 6.
        advance(&mut system, (THIN, law), 0.025, end);
        // Released at rest: z'' + z'/St + z = 0.
        let a = 0.5 / stokes;
        let exact = if a > 1.0 {
            let q = (a * a - 1.0).sqrt();
            // Without cancelling large exponentials.
            let slow = 1.0 / (a + q);
            0.5 * ((1.0 + a / q) * (-slow * end).exp() + (1.0 - a / q) * (-(a + q) * end).exp())
        } else {
            let q = (1.0 - a * a).sqrt();
            (-a * end).exp() * ((q * end).cos() + a / q * (q * end).sin())
        };
        let found = from_star(&system, 0).z / height;
        println!("St {stokes}: {found}, exact {exact}");
        assert!((found - exact).abs() < 1e-3, "{stokes}: {found} {exact}");
    }
}

#[test]
fn what_the_disk_takes_is_booked() {
    let thick = GasDisk {
        aspect_ratio: 0.05,
        ..THIN
    };
    let places = [Vec3::new(0.6, 0.8, 0.02), Vec3::new(-1.5, 0.3, -0.05)];
    let mut system = system(&thick, &places, 0.3, 1e-9);
    for v in [&mut system.dust.particles.v, &mut system.dust.rates.v_pred] {
        v[0] += Vec3::new(0.1, 0.2, 0.1);
    }
    let law = StoppingLaw::ConstantStokes(0.3);
    advance(&mut system, (thick, law), 0.01, 1.0);
    let census = Census::scaled(&system);
    let time = system.clock.time();
    let report = (system.ledger).report(time, census, system.potential, &system.domain);
    println!("{report:?}");
    assert!(system.ledger.radiated > 1e-12, "drag heats");
    assert!(system.ledger.given_away.momentum.norm() > 1e-11);
    assert!(report.error_momentum < 1e-13, "{report:?}");
    assert!(report.error_angular_momentum < 1e-13, "{report:?}");
    // Of the order of the map.
    assert!(report.error_energy.abs() < 1e-4, "{report:?}");
}

#[test]
fn beyond_the_disk_grains_move_freely() {
    let short = GasDisk {
        outer_radius: 2.0,
        ..THIN
    };
    let mut system = system(&THIN, &[Vec3::new(3.0, 0.0, 0.0)], 0.1, 1e-9);
    let before = system.dust.particles.v[0];
    let law = StoppingLaw::ConstantStokes(0.1);
    let mut drag = DustInDisk::new(short, law, TIES);
    system.next = system.clock.next_base(1.0, 1.0);
    system.dust.rates.next_span[0] = nbody::points::clock::TICKS;
    drag.prepare(&mut system, &mut Unmetered).expect("a step");
    drag.open(&mut system, &mut Unmetered).expect("a step");
    assert_eq!(system.dust.particles.v[0], before);
    let derived = &system.dust.derived;
    assert!(derived.t_stop[0].is_infinite() && derived.rho_gas[0] == 0.0);
}
