//! The Jacobi maps on the outer Solar System and at their limits.

use super::*;
use crate::integrators::problems::*;
use crate::orbit::Elements;

const YEAR: f64 = 365.25;

/// Largest relative error of the energy over `n` steps, looked at every `every` steps.
fn energy_error(scheme: Scheme, dt: f64, n: u64, every: u64) -> f64 {
    let (mut star, mut bodies) = barycentric();
    let start = energy(GAUSS, &star, &bodies);
    let mut map = Jacobi::of(scheme, GAUSS, &star, &bodies);
    (0..n / every).fold(0.0, |most, _| {
        map.advance(dt, every).expect("orbits");
        map.store(&mut star, &mut bodies).expect("orbits");
        let error = (energy(GAUSS, &star, &bodies) / start - 1.0).abs();
        if error > most || error.is_nan() {
            error
        } else {
            most
        }
    })
}

/// The outer Solar System seen from its centre of mass.
fn barycentric() -> (Bodies, Bodies) {
    let (mut star, mut bodies) = outer_solar_system();
    let (m, x, v) = together(&star, &bodies);
    let total: f64 = m.iter().sum();
    let mean = |of: &[Vec3]| m.iter().zip(of).map(|(m, x)| x * *m).sum::<Vec3>() / total;
    let (x, v) = (mean(&x), mean(&v));
    for set in [&mut star, &mut bodies] {
        set.x.iter_mut().for_each(|one| *one -= x);
        set.v.iter_mut().for_each(|one| *one -= v);
    }
    (star, bodies)
}

fn scheme(kernel: Kernel, corrector: Corrector) -> Scheme {
    Scheme { kernel, corrector }
}

#[test]
fn the_outer_solar_system_keeps_its_energy() {
    let dt = 0.1186 * YEAR;
    let plain = energy_error(Scheme::default(), dt, 100_000, 37);
    let corrected = energy_error(
        scheme(Kernel::Standard, Corrector::Seventeenth),
        dt,
        100_000,
        37,
    );
    let lazy = energy_error(
        scheme(Kernel::Lazy, Corrector::Seventeenth),
        dt,
        100_000,
        37,
    );
    println!("{plain:e} {corrected:e} {lazy:e}");
    assert!(plain < 2e-7, "{plain:e}");
    assert!(corrected < 2e-10, "{corrected:e}");
    assert!(lazy < 3e-13, "{lazy:e}");
}

#[test]
fn planets_alone_lose_no_energy_in_many_steps() {
    let (star, mut bodies) = (sun(1.0), barycentric().1);
    let jupiter = (bodies.x[0], bodies.v[0]);
    for i in 0..4 {
        bodies.m[i] = 0.0;
        (bodies.x[i], bodies.v[i]) = (jupiter.0 * (1.0 + 1e-6 * i as f64), jupiter.1);
    }
    let energies = |bodies: &Bodies| -> Vec<f64> {
        let each = bodies.x.iter().zip(&bodies.v);
        each.map(|(x, v)| 0.5 * v.norm_squared() - GAUSS / x.norm())
            .collect()
    };
    for dt in [0.0839, 0.1186, 0.1192] {
        let (mut star, mut after) = (star.clone(), bodies.clone());
        let mut map = Jacobi::of(Scheme::default(), GAUSS, &star, &bodies);
        map.advance(dt * YEAR, 400_000).expect("orbits");
        map.store(&mut star, &mut after).expect("orbits");
        let (before, after) = (energies(&bodies), energies(&after));
        let changes = after.iter().zip(&before).map(|(a, b)| a / b - 1.0);
        let mean = changes.sum::<f64>() / 4.0;
        println!("dt {dt}: {mean:e}");
        // Four random walks; a last step whose square is lost to rounding makes -5e-14 to -8e-14.
        assert!(mean.abs() < 5e-15, "dt {dt}: {mean:e}");
    }
}

#[test]
fn the_error_falls_with_the_order_of_the_corrector() {
    // Of first order in the masses dt^(n + 1), or what the second order leaves: dt^2 of the kernel, dt^4 of the lazy one.
    for (kernel, corrector, order, dt) in [
        (Kernel::Standard, Corrector::None, 2.0, 100.0),
        (Kernel::Standard, Corrector::Third, 4.0, 400.0),
        (Kernel::Lazy, Corrector::Fifth, 6.0, 400.0),
        (Kernel::Lazy, Corrector::Seventh, 8.0, 400.0),
    ] {
        let error = |dt: f64| {
            let n = (60_000.0 / dt) as u64;
            energy_error(scheme(kernel, corrector), dt, n, 1)
        };
        let found = (error(dt) / error(0.5 * dt)).log2();
        println!("{corrector:?}: {found} of {order}; {:e}", error(dt));
        assert!((found - order).abs() < 0.3, "{corrector:?}: order {found}");
    }
}

#[test]
fn one_planet_stays_on_its_exact_orbit() {
    let (mut star, mut bodies) = (sun(1.0), planet(0.01, 1.0, 0.2));
    let before = bodies.clone();
    let mut map = Jacobi::of(Scheme::default(), 1.0, &star, &bodies);
    map.advance(0.25, 1000).expect("an orbit");
    map.store(&mut star, &mut bodies).expect("an orbit");
    let (mut x, mut v) = (before.x[0], before.v[0]);
    kepler::drift(1.01, 250.0, &mut x, &mut v).expect("an orbit");
    let (dx, dv) = (bodies.x[0] - star.x[0] - x, bodies.v[0] - star.v[0] - v);
    let error = dx.norm() + dv.norm();
    println!("{error:e}");
    assert!(error < 1.2e-12, "{error:e}");
    // The centre of mass moves uniformly.
    let centre = (star.x[0] + bodies.x[0] * 0.01) / 1.01;
    let expected = (before.x[0] + before.v[0] * 250.0) * (0.01 / 1.01);
    assert!((centre - expected).norm() < 1e-14);
}

#[test]
fn the_accelerations_are_the_jacobi_form_of_the_direct_sum() {
    let (star, mut bodies) = barycentric();
    bodies.softening = vec![0.5, 0.0, 1.0, 2.0];
    let mut map = Jacobi::of(Scheme::default(), GAUSS, &star, &bodies);
    crate::widest!(*LEVEL, simd => {
        map.chain.accelerations::<_, f64x4<_>>(simd, &map.state.x, &mut map.forces);
    });
    // Direct accelerations of everybody, in Jacobi coordinates, less the Kepler part.
    let softened = |i: usize, j: usize| {
        let d = bodies.x[j] - bodies.x[i];
        let (a, b) = (bodies.softening[i], bodies.softening[j]);
        let r2 = d.norm_squared() + a * a + b * b;
        d * (GAUSS / (r2 * r2.sqrt()))
    };
    let star_on = |i: usize| {
        let d = star.x[0] - bodies.x[i];
        d * (GAUSS / d.norm().powi(3))
    };
    let mut a: Vec<Vec3> = (0..4).map(|i| star_on(i) * star.m[0]).collect();
    let mut a_star = Vec3::zeros();
    for (i, a) in a.iter_mut().enumerate() {
        a_star -= star_on(i) * bodies.m[i];
        for j in (0..4).filter(|&j| j != i) {
            *a += softened(i, j) * bodies.m[j];
        }
    }
    let jacobi = map.chain.coordinates(a_star, &a);
    for k in 0..4 {
        let of = |columns: &Columns| Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
        let x = of(&map.state.x);
        let kepler = x * (-map.chain.mu[k] / x.norm().powi(3));
        let expected = of(&jacobi) - kepler;
        let error = (of(&map.forces.a) - expected).norm() / of(&jacobi).norm();
        println!("{k}: {error:e}");
        assert!(error < 1e-15, "{k}: {error:e}");
        assert!(expected.norm() > 1e-5 * kepler.norm());
    }
}

#[test]
fn massless_bodies_follow_and_do_not_pull() {
    let (mut star, mut bodies) = barycentric();
    let (mut alone, mut others) = (star.clone(), bodies.clone());
    let orbit = Elements {
        semi_major_axis: 3.0,
        eccentricity: 0.1,
        inclination: 0.05,
        node: 1.0,
        pericentre: 2.0,
        mean_anomaly: 0.5,
    };
    let (x, v) = orbit.state(GAUSS * star.m[0]);
    crate::points::Columns::resize(&mut bodies, 5);
    bodies.id[4] = 5;
    (bodies.x[4], bodies.v[4]) = (x + star.x[0], v + star.v[0]);
    let scheme = scheme(Kernel::Lazy, Corrector::Seventh);
    let mut radau = crate::integrators::gauss_radau::GaussRadau::of(0.0, &star, &bodies);
    let m = [&star.m[..], &bodies.m[..]].concat();
    let mut map = Jacobi::of(scheme, GAUSS, &star, &bodies);
    let mut without = Jacobi::of(scheme, GAUSS, &alone, &others);
    map.advance(10.0, 400).expect("orbits");
    without.advance(10.0, 400).expect("orbits");
    map.store(&mut star, &mut bodies).expect("orbits");
    without.store(&mut alone, &mut others).expect("orbits");
    for i in 0..4 {
        assert!((bodies.x[i] - others.x[i]).norm() < 1e-12);
    }
    radau
        .advance_to(4000.0, |x, a| direct(GAUSS, &m, x, a))
        .expect("a way");
    let error = (bodies.x[4] - radau.x()[5]).norm();
    println!("{error:e}");
    assert!(error < 1e-9, "{error:e}");
}

#[test]
fn looking_changes_nothing_and_a_restored_state_goes_on_bit_for_bit() {
    let (mut star, mut bodies) = barycentric();
    let scheme = scheme(Kernel::Lazy, Corrector::Eleventh);
    let mut map = Jacobi::of(scheme, GAUSS, &star, &bodies);
    map.advance(40.0, 50).expect("orbits");
    let half = map.state();
    map.store(&mut star, &mut bodies).expect("orbits");
    assert_eq!(half, map.state());
    let restored = Jacobi::restored(scheme, GAUSS, &star, &bodies, &half);
    let mut restored = restored.expect("a state");
    map.advance(40.0, 50).expect("orbits");
    restored.advance(40.0, 50).expect("orbits");
    assert_eq!(map.state(), restored.state());
    assert!(Jacobi::restored(scheme, GAUSS, &star, &bodies, &half[1..]).is_none());
    let mut doubled = half.clone();
    doubled[9] = half[9 + 13];
    assert!(Jacobi::restored(scheme, GAUSS, &star, &bodies, &doubled).is_none());
}

#[test]
fn the_corrected_map_run_backwards_returns() {
    let (mut star, mut bodies) = barycentric();
    let before = (star.x[0], bodies.x.clone());
    let scheme = scheme(Kernel::Lazy, Corrector::Seventeenth);
    let mut map = Jacobi::of(scheme, GAUSS, &star, &bodies);
    map.advance(40.0, 1000).expect("orbits");
    map.advance(-40.0, 1000).expect("orbits");
    map.store(&mut star, &mut bodies).expect("orbits");
    let misses = bodies.x.iter().zip(&before.1);
    let error = misses.map(|(a, b)| (a - b).norm() / b.norm()).sum::<f64>();
    println!("{error:e}");
    assert!(error < 1e-13, "{error:e}");
    assert!((star.x[0] - before.0).norm() < 1e-15);
}

#[test]
fn a_body_that_cannot_be_moved_is_told_by_its_place() {
    let (star, mut bodies) = barycentric();
    bodies.v[1].x = f64::NAN;
    let mut map = Jacobi::of(Scheme::default(), GAUSS, &star, &bodies);
    let stuck = map.advance(40.0, 1).expect_err("no orbit");
    assert_eq!(
        (stuck.place, stuck.refusal),
        (1, kepler::Refusal::NonFinite)
    );
}

#[test]
fn many_bodies_take_wide_lanes_to_the_same_place() {
    // Nine bodies, of which five are massless copies, cannot differ from the four.
    let (star, bodies) = barycentric();
    let mut nine = bodies.clone();
    crate::points::Columns::resize(&mut nine, 9);
    for k in 4..9 {
        let far = 40.0 + k as f64;
        nine.id[k] = k as u64 + 1;
        nine.x[k] = star.x[0] + Vec3::x() * far;
        nine.v[k] = star.v[0] + Vec3::y() * (GAUSS * star.m[0] / far).sqrt();
    }
    let run = |bodies: &Bodies| {
        let (mut star, mut bodies) = (star.clone(), bodies.clone());
        let mut map = Jacobi::of(
            scheme(Kernel::Lazy, Corrector::Third),
            GAUSS,
            &star,
            &bodies,
        );
        map.advance(40.0, 100).expect("orbits");
        map.store(&mut star, &mut bodies).expect("orbits");
        bodies.x[..4].to_vec()
    };
    assert_eq!(run(&bodies), run(&nine));
}
