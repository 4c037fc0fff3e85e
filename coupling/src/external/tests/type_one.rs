//! Type-I migration against published formulas, and in the motion of a body.

use std::f64::consts::TAU;

use super::*;
use crate::external::type_one::Shape;

const CIRCLE: Shape = Shape {
    semi_major_axis: 1.0,
    eccentricity: 0.0,
    inclination: 0.0,
};

/// Gamma = -(1.364 + 0.541 p) (m/M h)^2 Sigma a^4 Omega^2, tau_a = a/|a'| = 1/(2.728 + 1.082 p) (M/m) (M/Sigma a^2) h^2/Omega,
/// tau_e = t_wave/0.780, tau_i = t_wave/0.544, t_wave = (M/m) (M/Sigma a^2) h^4/Omega; values for M = G = 1.
#[test]
fn torque_and_damping_times_of_circular_orbits_are_the_published_ones() {
    // m, Sigma, a, h, p: torque, tau_a, tau_e, tau_i
    let table = [
        (
            [3e-6, 1e-4, 1.0, 0.05, 1.0],
            [6.858e-13, 2187226.59668, 26709.4017094, 38296.5686275],
        ),
        (
            [1e-5, 2e-4, 5.0, 0.05, 1.5],
            [8.702e-11, 128480.11822, 1791.72113582, 2569.01192268],
        ),
        (
            [3e-7, 1e-4, 1.0, 0.03, 1.5],
            [2.1755e-14, 6894966.67433, 34615.3846154, 49632.3529412],
        ),
    ];
    for ([m, sigma, a, h, p], wanted) in table {
        let disk = GasDisk {
            surface_density: sigma,
            slope: -p,
            reference_radius: a,
            aspect_ratio: h,
            ..DISK
        };
        let shape = Shape {
            semi_major_axis: a,
            ..CIRCLE
        };
        let rates = TypeOne { disk }.rates(&shape, m, 1.0, 1.0);
        let torque = m * a.sqrt() * rates.angular_momentum;
        let found = [
            torque,
            0.5 / rates.angular_momentum,
            1.0 / rates.eccentricity,
            1.0 / rates.inclination,
        ];
        for (found, wanted) in found.into_iter().zip(wanted) {
            // The torque of the second row is given to four digits.
            let error = (found / wanted - 1.0).abs();
            assert!(error < 1e-4, "{m}: {found} {wanted}");
        }
    }
}

/// Cresswell & Nelson (2008), eq. 9, 11, 13, written with the pole of P: t/t(e = i = 0).
#[test]
fn eccentric_and_inclined_orbits_have_the_published_corrections() {
    let law = TypeOne { disk: DISK };
    let base = law.rates(&CIRCLE, 1e-5, 1.0, 1.0);
    for (k, j) in [
        (0.5, 0.0),
        (1.0, 1.0),
        (1.9, 0.3),
        (2.2, 0.0),
        (3.0, 2.0),
        (6.0, 3.0),
    ] {
        let shape = Shape {
            eccentricity: k * 0.05,
            inclination: j * 0.05,
            ..CIRCLE
        };
        let rates = law.rates(&shape, 1e-5, 1.0, 1.0);
        let p: f64 = (1.0 + f64::powf(k / 2.25, 1.2) + f64::powi(k / 2.84, 6))
            / (1.0 - f64::powi(k / 2.02, 4));
        let p = p + p.signum() * (0.070 * j + 0.085 * f64::powi(j, 4) - 0.080 * k * j * j);
        let e = 1.0 - 0.14 * k * k + 0.06 * k * k * k + 0.18 * k * j * j;
        let i = 1.0 - 0.30 * j * j + 0.24 * j * j * j + 0.14 * k * k * j;
        for (name, found, wanted) in [
            ("m", base.angular_momentum / rates.angular_momentum, p),
            ("e", base.eccentricity / rates.eccentricity, e),
            ("i", base.inclination / rates.inclination, i),
        ] {
            assert!(
                (found / wanted - 1.0).abs() < 1e-12,
                "{name} {k} {j}: {found} {wanted}"
            );
        }
    }
}

/// d ln a/dt = -2/t_m - 2 e^2/t_e - 2 i^2/t_i, d ln e/dt = -1/t_e, d ln i/dt = -1/t_i: averages over an orbit of small e and i.
#[test]
fn a_body_drifts_and_is_damped_at_the_rates_of_the_formula() {
    let law = TypeOne { disk: DISK };
    let (m, e, i) = (1e-6, 0.01, 0.006);
    let mut system = system(&[(m, orbit(e, i))]);
    let shape = Shape {
        semi_major_axis: 1.0,
        eccentricity: e,
        inclination: i,
    };
    let rates = law.rates(&shape, m, 1.0, 1.0);
    let start = elements(&system, 0);
    let time = 20.0 * TAU;
    advance(&mut system, Box::new(External::new(law)), 0.1, time);
    let end = elements(&system, 0);
    let grown = |f: fn(&Elements) -> f64| (f(&end) / f(&start)).ln() / time;
    let (te, ti) = (rates.eccentricity, rates.inclination);
    for (name, found, wanted) in [
        (
            "a",
            grown(|o| o.semi_major_axis),
            -2.0 * (rates.angular_momentum + e * e * te + i * i * ti),
        ),
        ("e", grown(|o| o.eccentricity), -te),
        ("i", grown(|o| o.inclination), -ti),
    ] {
        println!(
            "{name}: {found:e} for {wanted:e}, off by {:e}",
            found / wanted - 1.0
        );
        // Terms of e^2, i^2 and of the decay within the time; 6e-5 was measured.
        assert!(
            (found / wanted - 1.0).abs() < 1.2e-4,
            "{name}: {found} {wanted}"
        );
    }
}

#[test]
fn unbound_bodies_those_without_mass_and_those_beyond_the_edges_feel_nothing() {
    let law = TypeOne { disk: DISK };
    let body = target(&system(&[(1e-6, orbit(0.1, 0.1))]), 0);
    assert!(law.change(&body, 1.0).dv.norm() > 0.0);
    for idle in [
        Target { m: 0.0, ..body },
        Target {
            v: body.v * 2.0,
            ..body
        },
        Target {
            x: body.x * 20.0,
            v: body.v * 0.05f64.sqrt(),
            ..body
        },
    ] {
        assert_eq!(law.change(&idle, 1.0).dv, Vec3::zeros(), "{idle:?}");
    }
}

#[test]
fn a_prescribed_migration_moves_the_axis_exponentially_and_keeps_the_shape() {
    let mut system = system(&[(0.0, orbit(0.2, 0.1)), (0.0, orbit(0.3, 0.2))]);
    let time = 400.0 * TAU;
    let law = Migration::new([(2, 5000.0)]);
    advance(&mut system, Box::new(External::new(law)), 0.05, time);
    let (still, moved) = (elements(&system, 0), elements(&system, 1));
    assert!((still.semi_major_axis - 1.0).abs() < 1e-12);
    let growth = moved.semi_major_axis.ln() * 5000.0 / time;
    println!("growth {growth}, e {}", moved.eccentricity);
    // What is left is the change within an orbit, of order e P/tau at the end points.
    assert!((growth - 1.0).abs() < 4e-4, "{growth}");
    assert!(
        (moved.eccentricity / 0.3 - 1.0).abs() < 1e-3
            && (moved.inclination / 0.2 - 1.0).abs() < 1e-6
    );
}
