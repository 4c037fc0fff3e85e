//! Precession by relativity and by the star's oblateness.

use std::f64::consts::TAU;

use super::*;
use crate::external::central::Pull;

/// How far an angle has turned, between half a turn back and half a turn on.
fn turn(from: f64, to: f64) -> f64 {
    (to - from + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU
}

/// Elements at the start and after `orbits` orbits of mean elements a = 1.
fn ends(operator: Box<dyn Operator>, start: Elements, orbits: f64, step: f64) -> [Elements; 2] {
    let mut system = system(&[(0.0, start)]);
    let before = elements(&system, 0);
    advance(&mut system, operator, step, orbits * TAU);
    [before, elements(&system, 0)]
}

/// 6 pi G M/(c^2 a (1 - e^2)) an orbit.
#[test]
fn the_pericentre_advances_by_the_first_post_newtonian_order() {
    let speed_of_light: f64 = 1e4;
    for e in [0.2, 0.6] {
        let operator = Box::new(Central::new(Relativity { speed_of_light }));
        let orbits = 200.0;
        let [before, after] = ends(operator, orbit(e, 0.3), orbits, 0.02);
        let found = turn(before.pericentre, after.pericentre) / orbits;
        let wanted = 3.0 * TAU / (speed_of_light * speed_of_light * (1.0 - e * e));
        println!(
            "e {e}: {found:e} for {wanted:e}, off by {:e}",
            found / wanted - 1.0
        );
        assert!((found / wanted - 1.0).abs() < 5e-6, "{e}: {found} {wanted}");
        assert!(turn(before.node, after.node).abs() < 1e-12);
    }
}

/// A companion of a tenth of the star's mass: M is the total mass.
#[test]
fn a_heavy_companions_pericentre_advances_by_the_total_mass() {
    let speed_of_light: f64 = 1e3;
    let mut system = system(&[(0.1, orbit(0.3, 0.3))]);
    let before = elements(&system, 0);
    // The map's own error makes the pericentre turn by dt^2 m: without the pull it is taken away.
    let mut bare = system.clone();
    let (step, time) = (0.005, 20.0 * TAU / 1.1f64.sqrt());
    advance(
        &mut system,
        Box::new(Central::new(Relativity { speed_of_light })),
        step,
        time,
    );
    advance(
        &mut bare,
        Box::new(External::new(Migration::new([]))),
        step,
        time,
    );
    let [with, without] =
        [&system, &bare].map(|s| turn(before.pericentre, elements(s, 0).pericentre));
    let found = (with - without) / 20.0;
    let wanted = 3.0 * TAU * 1.1 / (speed_of_light * speed_of_light * (1.0 - 0.09));
    println!(
        "{found:e} for {wanted:e}, off by {:e}",
        found / wanted - 1.0
    );
    assert!((found / wanted - 1.0).abs() < 5e-4, "{found} {wanted}");
}

/// Node: -3/2 n J2 (R/p)^2 cos i; pericentre: 3/4 n J2 (R/p)^2 (5 cos^2 i - 1); p = a (1 - e^2).
#[test]
fn node_and_pericentre_turn_about_an_oblate_star_at_the_secular_rates() {
    for (e, i) in [(0.2, 0.3), (0.4, 1.2), (0.1, 2.5)] {
        let star = Oblateness {
            j2: 1e-6,
            equatorial_radius: 0.5,
            pole: Vec3::z(),
        };
        let orbits = 200.0;
        let [before, after] = ends(Box::new(Central::new(star)), orbit(e, i), orbits, 0.05);
        let unit = star.j2 * (0.5 / (1.0 - e * e)).powi(2) * orbits * TAU;
        let cos = f64::cos(i);
        for (name, found, wanted) in [
            ("node", turn(before.node, after.node), -1.5 * unit * cos),
            (
                "pericentre",
                turn(before.pericentre, after.pericentre),
                0.75 * unit * (5.0 * cos * cos - 1.0),
            ),
        ] {
            println!(
                "{name} at e {e}, i {i}: {found:e} for {wanted:e}, off by {:e}",
                found / wanted - 1.0
            );
            assert!(
                (found / wanted - 1.0).abs() < 1.2e-4,
                "{name} {e} {i}: {found} {wanted}"
            );
        }
    }
}

/// Turning pole and orbit together turns everything.
#[test]
fn the_pole_may_point_anywhere() {
    let turned = nalgebra::Rotation3::from_euler_angles(0.4, -0.7, 1.9);
    let upright = Oblateness {
        pole: Vec3::z(),
        ..order::OBLATE
    };
    let tilted = Oblateness {
        pole: turned * Vec3::z(),
        ..upright
    };
    for r in [Vec3::new(1.0, 0.2, 0.5), Vec3::new(-0.3, 0.8, -0.1)] {
        let (a, phi) = upright.field(r, 0.0, 2.0, 3.0);
        let (b, psi) = tilted.field(turned * r, 0.0, 2.0, 3.0);
        assert!(
            (turned * a - b).norm() < 1e-14 * a.norm() && (phi - psi).abs() < 1e-14 * phi.abs()
        );
        // The force is the potential's slope.
        let d = 1e-5;
        for axis in 0..3 {
            let mut step = Vec3::zeros();
            step[axis] = d;
            let slope = (tilted.field(r + step, 0.0, 2.0, 3.0).1
                - tilted.field(r - step, 0.0, 2.0, 3.0).1)
                / (2.0 * d);
            let pull = tilted.field(r, 0.0, 2.0, 3.0).0[axis];
            assert!(
                (slope + pull).abs() < 1e-8 * b.norm(),
                "{axis}: {slope} {pull}"
            );
        }
    }
}
