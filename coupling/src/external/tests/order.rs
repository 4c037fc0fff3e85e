//! Order in the step, and the books.

use super::*;

/// Where a body is after half an orbit in steps of `step`.
fn state(operator: Box<dyn Operator>, step: f64) -> Vec3 {
    let mut system = system(&[(1e-9, orbit(0.1, 0.05))]);
    advance(&mut system, operator, step, 3.0);
    system.bodies.x[0] - system.star.x[0]
}

/// Errors of a method of second order fall by four when the step is halved; against a step of an eighth of the shorter one the ratio is
/// (1 - 1/256)/(1/4 - 1/256) = 4.05.
fn second_order(name: &str, operator: impl Fn() -> Box<dyn Operator>) {
    let exact = state(operator(), 3.0 / 512.0);
    let errors = [32.0, 64.0].map(|n| (state(operator(), 3.0 / n) - exact).norm());
    let ratio = errors[0] / errors[1];
    println!("{name}: errors {errors:?}, ratio {ratio}");
    assert!(errors[1] > 1e-10, "{name}: {errors:?} is too small to tell");
    assert!((3.7..4.5).contains(&ratio), "{name}: ratio {ratio}");
}

#[test]
fn drag_is_of_second_order() {
    second_order("quadratic", || Box::new(External::new(quadratic(1.0))));
    let law = StoppingLaw::ConstantStoppingTime(3.0);
    second_order("constant", || {
        Box::new(External::new(DiskDrag { disk: DISK, law }))
    });
}

#[test]
fn type_one_migration_is_of_second_order() {
    // The body's mass is 1e-9: the disk is heavy to make the torques strong.
    let disk = GasDisk {
        surface_density: 3e3,
        ..DISK
    };
    second_order("type one", || Box::new(External::new(TypeOne { disk })));
}

#[test]
fn prescribed_migration_is_of_second_order() {
    second_order("migration", || {
        Box::new(External::new(Migration::new([(1, 30.0)])))
    });
}

#[test]
fn relativity_and_oblateness_are_of_second_order() {
    let speed_of_light = 20.0;
    second_order("relativity", || {
        Box::new(Central::new(Relativity { speed_of_light }))
    });
    second_order("oblateness", || Box::new(Central::new(OBLATE)));
}

pub const OBLATE: Oblateness = Oblateness {
    j2: 0.01,
    equatorial_radius: 0.3,
    pole: Vec3::new(0.6, 0.0, 0.8),
};

/// What a law takes from the bodies in one half step stands in the books to the last digits, each quantity by itself.
#[test]
fn what_the_gas_takes_is_booked() {
    let bodies = [
        (1e-3, orbit(0.3, 0.2)),
        (2e-3, orbit(0.1, 0.4)),
        (0.0, orbit(0.2, 0.0)),
    ];
    let close = |name: &str, mut operator: Box<dyn Operator>| {
        let mut system = system(&bodies);
        let potential = 0.0;
        let census = crate::ledger::Census::scaled(&system);
        system.ledger.open(census, potential);
        system.next = system.clock.next_base(0.5, 0.5);
        system.pace.next_span = nbody::points::clock::TICKS;
        operator.open(&mut system, &mut Unmetered).expect("a kick");
        let report = report(&system);
        let moved = (report.momentum - census.sum().momentum).norm() / census.sum().momentum_scale;
        assert!(moved > 1e-4, "{name} did nothing");
        for error in [
            report.error_momentum,
            report.error_angular_momentum,
            report.error_energy,
        ] {
            assert!(error.abs() < 1e-15, "{name}: {report:?}");
        }
        system.ledger.radiated
    };
    let heat = close("drag", Box::new(External::new(quadratic(1.0))));
    assert!(heat > 1e-6, "drag heats: {heat}");
    let disk = GasDisk {
        surface_density: 1e-1,
        ..DISK
    };
    assert_eq!(
        close("torques", Box::new(External::new(TypeOne { disk }))),
        0.0
    );
    let migration = Migration::new([(2, -5.0), (1, 3.0)]);
    assert_eq!(close("migration", Box::new(External::new(migration))), 0.0);
}

/// The star's recoil keeps momentum, its spin the torque, and the potential the energy to the order of the map.
#[test]
fn static_pulls_conserve_all_with_the_star() {
    let bodies = [(1e-3, orbit(0.3, 0.2)), (0.0, orbit(0.2, 0.1))];
    let energy = |operator: Box<dyn Operator>, step: f64| {
        let mut system = system(&bodies);
        let star = system.star.v[0];
        advance(&mut system, operator, step, 20.0);
        assert!((system.star.v[0] - star).norm() > 1e-5, "the star recoils");
        let report = report(&system);
        assert!(report.error_momentum < 2e-12, "{report:?}");
        assert!(report.error_angular_momentum < 4.6e-12, "{report:?}");
        report.error_energy.abs()
    };
    let relativity = || -> Box<dyn Operator> {
        Box::new(Central::new(Relativity {
            speed_of_light: 20.0,
        }))
    };
    let oblateness = || -> Box<dyn Operator> { Box::new(Central::new(OBLATE)) };
    for (name, make) in [
        ("relativity", &relativity as &dyn Fn() -> Box<dyn Operator>),
        ("oblateness", &oblateness),
    ] {
        let errors = [0.04, 0.01, 0.0025].map(|step| energy(make(), step));
        println!("{name}: energy errors {errors:?}");
        // Two quarterings of the step are worth 256; at a single time the error may happen to lie near zero.
        assert!(errors[2] < 0.05 * errors[0], "{name}: {errors:?}");
    }
}
