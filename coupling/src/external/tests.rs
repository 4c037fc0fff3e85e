//! Tests of the surroundings: formulas, order, what is conserved and what is booked.

mod central;
mod disk;
mod order;
mod type_one;

use dust::StoppingLaw;
use nbody::orbit::Elements;
use nbody::points::{Columns, Domain};

use super::*;
use crate::drift::{DriftBodies, Kepler};
use crate::gravity::{ALL_PULL, Gravity, Mutual, Plan, Softening};
use crate::kick::KickBodies;
use crate::{Splitting, Unmetered};

/// Sigma ~ r^-1, H/r = 0.05 (r)^0.25 from 0.1 to 10.
const DISK: GasDisk = GasDisk {
    surface_density: 1e-4,
    slope: -1.0,
    reference_radius: 1.0,
    aspect_ratio: 0.05,
    flaring: 0.25,
    inner_radius: 0.1,
    outer_radius: 10.0,
    rotation: Rotation::Pressure,
};

/// An orbit of a = 1 with node, pericentre and mean anomaly of no account.
fn orbit(eccentricity: f64, inclination: f64) -> Elements {
    Elements {
        semi_major_axis: 1.0,
        eccentricity,
        inclination,
        node: 0.4,
        pericentre: 1.1,
        mean_anomaly: 0.3,
    }
}

/// A star of mass 1, not at rest in the origin, and bodies on orbits about it; G = 1.
fn system(bodies: &[(f64, Elements)]) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    system.star.resize(1);
    system.star.m[0] = 1.0;
    (system.star.x[0], system.star.v[0]) =
        (Vec3::new(0.3, -0.2, 0.1), Vec3::new(0.02, 0.01, -0.03));
    system.bodies.resize(bodies.len());
    for (i, (m, elements)) in bodies.iter().enumerate() {
        let (x, v) = elements.state(1.0 + m);
        let bodies = &mut system.bodies;
        (bodies.id[i], bodies.m[i]) = (i as u64 + 1, *m);
        (bodies.x[i], bodies.v[i]) = (system.star.x[0] + x, system.star.v[0] + v);
        bodies.kind[i] = Kind::Planetesimal as u32;
    }
    system.look();
    system
}

/// Elements of body `i` now.
fn elements(system: &System, i: usize) -> Elements {
    let (x, v) = (
        system.bodies.x[i] - system.star.x[0],
        system.bodies.v[i] - system.star.v[0],
    );
    Elements::of(1.0 + system.bodies.m[i], x, v).expect("an orbit")
}

/// Advances by the Wisdom-Holman map with `operator` beside it to `end`, in steps of at most `step`.
fn advance(system: &mut System, operator: Box<dyn Operator>, step: f64, end: f64) {
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
    let mut splitting = Splitting::new(vec![
        Box::new(Gravity::new(plan)),
        operator,
        Box::new(KickBodies { step, mutual: true }),
        Box::new(DriftBodies::new(Kepler)),
    ]);
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
            system
                .ledger
                .open(crate::ledger::Census::scaled(system), potential);
        }
        splitting.open(system, meter).expect("a step");
        splitting.cross(system, meter).expect("a step");
    }
}

/// The books of now.
fn report(system: &System) -> crate::ledger::Report {
    let census = crate::ledger::Census::scaled(system);
    let time = system.clock.time();
    system
        .ledger
        .report(time, census, system.potential, &system.domain)
}

fn quadratic(coefficient: f64) -> DiskDrag {
    DiskDrag {
        disk: DISK,
        law: StoppingLaw::Quadratic(coefficient),
    }
}
