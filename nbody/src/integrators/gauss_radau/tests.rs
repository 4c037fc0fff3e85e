//! The Gauss-Radau integrator on problems with known ends.

use super::super::problems::*;
use super::*;
use crate::orbit::Elements;

/// Relative energy error at `end`, and the integrator there.
fn run(g: f64, m: &[f64], mut radau: GaussRadau, ends: &[f64]) -> (f64, GaussRadau) {
    let start = energy_of(g, m, &radau.x, &radau.v);
    let mut most = 0.0;
    for &end in ends {
        radau
            .advance_to(end, |x, a| direct(g, m, x, a))
            .expect("a way to the end");
        most = larger(
            most,
            (energy_of(g, m, &radau.x, &radau.v) / start - 1.0).abs(),
        );
    }
    (most, radau)
}

fn figure_eight() -> GaussRadau {
    let (x, v) = (
        [0.97000436, -0.24308753, 0.0],
        [0.466203685, 0.43236573, 0.0],
    );
    let (x, v) = (Vec3::from(x), Vec3::from(v));
    GaussRadau::new(
        0.0,
        &[x, -x, Vec3::zeros()],
        &[v, v, Vec3::new(-0.93240737, -0.86473146, 0.0)],
    )
}

fn distance(x: &[Vec3], reference: &[[f64; 2]]) -> f64 {
    let misses = x.iter().zip(reference);
    misses
        .map(|(x, r)| (x.x - r[0]).hypot(x.y - r[1]))
        .fold(0.0, larger)
}

#[test]
fn the_figure_eight_is_followed_for_ten_periods() {
    let m = [1.0; 3];
    let (energy, radau) = run(1.0, &m, figure_eight(), &[1.0, 3.0, 20.0, 63.2591398]);
    let reference = [
        [0.970004213756463, -0.243087665316061],
        [-0.970004506016274, 0.243087396317728],
        [2.92259811073099e-07, 2.6899833301738e-07],
    ];
    let error = distance(&radau.x, &reference);
    assert!(error < 2.7e-14 && energy < 1.2e-15, "{error:e} {energy:e}");
}

#[test]
fn burraus_problem_ends_in_the_known_binary() {
    let x = [[1.0, 3.0, 0.0], [-2.0, -1.0, 0.0], [1.0, -1.0, 0.0]].map(Vec3::from);
    let m = [3.0, 4.0, 5.0];
    let radau = GaussRadau::new(0.0, &x, &[Vec3::zeros(); 3]);
    let (energy, radau) = run(1.0, &m, radau, &[5.0, 10.0, 15.0, 20.0, 40.0]);
    let reference = [
        [-0.622003691801097, 1.85831815789977],
        [0.17354455681644, -2.36841044328316],
        [0.234366569627506, 0.779737459886668],
    ];
    let error = distance(&radau.x, &reference);
    // Of forty systems that differ by 1e-10 the root mean square of the energy's error is 5e-11.
    assert!(error < 1.5e-7 && energy < 1.6e-10, "{error:e} {energy:e}");
    let (_, radau) = run(1.0, &m, radau, &[70.0]);
    // Chaos makes 1e4 times the error at t = 40 by t = 70.
    let binary = Elements::of(9.0, radau.x[2] - radau.x[1], radau.v[2] - radau.v[1]);
    let binary = binary.expect("a binary");
    let misses = [
        binary.semi_major_axis / 0.552496439163683 - 1.0,
        binary.eccentricity - 0.988699076000575,
        radau.v[0].norm() / 1.76472863043444 - 1.0,
    ];
    println!("{misses:?}");
    assert!(misses[0].abs() < 1.4e-3 && misses[1].abs() < 3.6e-5 && misses[2].abs() < 1.9e-3);
}

#[test]
fn the_outer_solar_system_keeps_its_energy_to_rounding() {
    let (star, bodies) = outer_solar_system();
    let (m, ..) = together(&star, &bodies);
    let ends: Vec<f64> = (1..=10).map(|k| f64::from(k) * 36525.0).collect();
    let (energy, _) = run(GAUSS, &m, GaussRadau::of(0.0, &star, &bodies), &ends);
    assert!(energy < 2e-15, "{energy:e}");
}

#[test]
fn a_long_ellipse_comes_back_after_ten_revolutions() {
    let orbit = Elements {
        semi_major_axis: 1.0,
        eccentricity: 0.9,
        inclination: 0.3,
        node: 1.0,
        pericentre: 2.0,
        mean_anomaly: 2.5,
    };
    let m = [1.0, 1e-3];
    let (x, v) = orbit.state(1.001);
    let start = GaussRadau::new(0.0, &[Vec3::zeros(), x], &[Vec3::zeros(), v]);
    let period = std::f64::consts::TAU / orbit.mean_motion(1.001);
    let (energy, radau) = run(1.0, &m, start, &[10.0 * period]);
    let error = (radau.x[1] - radau.x[0] - x).norm();
    assert!(error < 4e-14 && energy < 1.2e-15, "{error:e} {energy:e}");
}

#[test]
fn a_needle_loses_what_a_rounding_of_the_force_at_its_pericentre_weighs() {
    let e: f64 = 0.999_999;
    let axis = |x: Vec3, v: Vec3| 1.0 / (2.0 / x.norm() - v.norm_squared());
    let square = |k: u32| {
        let (sin, cos) = (0.7 * f64::from(k)).sin_cos();
        let x = Vec3::new(cos, sin, 0.0) * (1.0 + e);
        let v = Vec3::new(-sin, cos, 0.0) * ((1.0 - e) / (1.0 + e)).sqrt();
        let mut radau = GaussRadau::new(0.0, &[x], &[v]);
        for orbit in 1..=10 {
            let pull = |x: &[Vec3], a: &mut [Vec3]| a[0] -= x[0] / x[0].norm().powi(3);
            let end = std::f64::consts::TAU * f64::from(orbit);
            radau.advance_to(end, pull).expect("a way");
        }
        (axis(radau.x[0], radau.v[0]) / axis(x, v) - 1.0).powi(2)
    };
    let error = ((0..8).map(square).sum::<f64>() / 8.0).sqrt();
    println!("{error:e}");
    // One rounding is 2 u/(1 - e) = 2.2e-10; those of a passage leave 3.5e-11, of ten 1.1e-10.
    assert!(error < 2.2e-10, "{error:e}");
}

#[test]
fn backwards_leads_back() {
    let m = [1.0; 3];
    let (_, there) = run(1.0, &m, figure_eight(), &[7.0]);
    let (_, back) = run(1.0, &m, there, &[0.0]);
    let start = figure_eight();
    let misses = back.x.iter().zip(&start.x).map(|(a, b)| (a - b).norm());
    let error = misses.fold(0.0, larger);
    assert!(error < 2e-15, "{error:e}");
}

#[test]
fn a_restored_state_goes_on_bit_for_bit() {
    let m = [1.0; 3];
    let (_, whole) = run(1.0, &m, figure_eight(), &[1.3, 5.0]);
    let (_, half) = run(1.0, &m, figure_eight(), &[1.3]);
    let restored = GaussRadau::restored(&half.state()).expect("a state");
    let (_, restored) = run(1.0, &m, restored, &[5.0]);
    assert_eq!(whole.state(), restored.state());
    assert!(GaussRadau::restored(&half.state()[1..]).is_none());
}

#[test]
fn free_bodies_go_straight_and_star_and_bodies_are_handed_back() {
    let (mut star, mut bodies) = outer_solar_system();
    let mut radau = GaussRadau::of(2.0, &star, &bodies);
    radau
        .advance_to(12.0, |_, _| ())
        .expect("no force, no trouble");
    let expected = bodies.x[2] + bodies.v[2] * 10.0;
    radau.store(&mut star, &mut bodies);
    assert!((bodies.x[2] - expected).norm() < 1e-14);
    assert_eq!(radau.time(), 12.0);
}

#[test]
fn a_head_on_collision_of_points_stalls_instead_of_hanging() {
    let mut radau = GaussRadau::new(0.0, &[Vec3::x(), -Vec3::x()], &[Vec3::zeros(); 2]);
    let stall = radau.advance_to(10.0, |x, a| direct(1.0, &[1.0; 2], x, a));
    // They meet after pi/sqrt(2) for a separation of 2 and a total mass of 2.
    let time = stall.expect_err("a singularity").time;
    assert!(
        (time - std::f64::consts::PI / 2f64.sqrt()).abs() < 1e-6,
        "{time}"
    );
}

#[test]
fn a_force_that_ends_somewhere_stalls_there() {
    let mut radau = GaussRadau::new(0.0, &[Vec3::zeros()], &[Vec3::x()]);
    let stall = radau.advance_to(3.0, |x, a| {
        a[0].y = if x[0].x < 1.0 { 0.1 } else { f64::NAN };
    });
    // A step may end past the wall by the little that lies beyond its last spacing.
    let time = stall.expect_err("no force beyond 1").time;
    assert!((time - 1.0).abs() < 0.03, "{time}");
    assert!((radau.x()[0] - Vec3::new(time, 0.05 * time * time, 0.0)).norm() < 1e-14);
}
