//! Sublimation against equilibria and exact transients.

use super::*;

/// Water of unit density whose vapour is saturated at a density of 1/e at a temperature of one; c_v is 1.
const WATER: Water = Water {
    ice: 1.0,
    gas_constant: TAU,
    saturation: [1.837_877_066_409_345_5, -1.0, 0.0, 0.0],
};

/// n(s): grains of a radius, and of its core.
fn share(number: f64, radius: f64, core: f64) -> Share {
    let ice = 4.0 / 3.0 * PI * number * (radius.powi(3) - core.powi(3));
    Share::new(number, radius, core, ice, &WATER)
}

fn room(volume: f64, vapour: f64) -> Room {
    Room {
        volume,
        vapour,
        temperature: 1.0,
    }
}

fn gain(shares: &[Share], l: f64) -> f64 {
    shares.iter().map(|share| share.lost(l)).sum()
}

/// Three sizes; the ice of all is 6.5.
fn sizes() -> [Share; 3] {
    [
        share(1.0, 1.0, 0.5),
        share(20.0, 0.3, 0.2),
        share(500.0, 0.1, 0.01),
    ]
}

#[test]
fn saturation_is_that_of_ice() {
    let water = Water {
        gas_constant: 1.0,
        saturation: SATURATION,
        ..WATER
    };
    let pressure = |t: f64| water.saturated(t) * t;
    // At the triple point, and at 200 K as measured by Marti & Mauersberger (1993, GRL 20, 363): 10^(12.537 - 2663.5/T) Pa.
    assert!((pressure(273.16) / 611.657 - 1.0).abs() < 1e-4);
    let measured = 10f64.powf(12.537 - 2663.5 / 200.0);
    assert!((pressure(200.0) / measured - 1.0).abs() < 0.03);
    assert_eq!(water.saturated(0.0), 0.0);
}

#[test]
fn any_step_ends_between_start_and_saturation() {
    let saturated = (-1f64).exp();
    for vapour in [0.0, 0.1, 0.9, 30.0] {
        for (volume, dt) in [
            (1.0, 1e-6),
            (1.0, 1.0),
            (1.0, 1e6),
            (30.0, 1e-3),
            (30.0, 1e6),
        ] {
            let (room, shares) = (room(volume, vapour), sizes());
            let l = room.retreat(&shares, &WATER, dt);
            let end = vapour + gain(&shares, l);
            let (low, high) = (
                vapour.min(saturated * volume),
                vapour.max(saturated * volume),
            );
            let slack = 1e-13 * high;
            assert!(
                low - slack <= end && end <= high + slack,
                "{vapour} {volume} {dt}: {end}"
            );
            assert!(l == 0.0 || (l > 0.0) == (vapour < saturated * volume));
        }
    }
}

#[test]
fn long_steps_end_in_equilibrium_or_without_ice() {
    let saturated = (-1f64).exp();
    let shares = sizes();
    let all: f64 = shares.iter().map(|share| share.ice).sum();
    for (volume, vapour) in [
        (1.0, 0.0),
        (1.0, 3.0),
        (10.0, 1.0),
        (0.99 * all / saturated, 0.0),
    ] {
        for dt in [1e4, 1e6] {
            let room = room(volume, vapour);
            let end = vapour + gain(&shares, room.retreat(&shares, &WATER, dt));
            let error = end / (saturated * volume) - 1.0;
            assert!(error.abs() < 1e-13, "{volume} {vapour} {dt}: {error:e}");
        }
    }
    // A room that no ice can fill takes all of it.
    let empty = room(1.01 * all / saturated, 0.0);
    let end = gain(&shares, empty.retreat(&shares, &WATER, 1e6));
    assert!((end / all - 1.0).abs() < 1e-15);
    // Cores without ice have none to give, and take what there is too much.
    let bare = [share(1.0, 1.0, 1.0)];
    assert_eq!(room(1.0, 0.0).retreat(&bare, &WATER, 1.0), 0.0);
    let grown = gain(&bare, room(1.0, 1.0).retreat(&bare, &WATER, 1e6));
    assert!((1.0 + grown - saturated).abs() < 1e-14);
}

/// Radius and vapour after `steps` steps to `time`, from one size in a room.
fn transient(volume: f64, time: f64, steps: u32) -> [f64; 2] {
    let (mut radius, mut vapour, core) = (1.0, 0.0, 0.2);
    for _ in 0..steps {
        let shares = [share(1.0, radius, core)];
        let l = room(volume, vapour).retreat(&shares, &WATER, time / f64::from(steps));
        (radius, vapour) = (radius - l, vapour + shares[0].lost(l));
    }
    [radius, vapour]
}

#[test]
fn a_mantle_in_a_vast_room_shrinks_at_a_constant_rate() {
    let [radius, _] = transient(1e12, 1.0, 1);
    let error = radius - (1.0 - (-1f64).exp());
    assert!(error.abs() < 1e-11, "{error:e}");
}

#[test]
fn transients_converge_with_the_square_of_the_step() {
    // ds/dt = -(rho_sat - 4/3 pi (1 - s^3) / V), by the classical Runge-Kutta method in 1e4 steps (error below 1e-14).
    let (volume, time) = (8.0, 1.2);
    let rate = |s: f64| -((-1f64).exp() - 4.0 / 3.0 * PI * (1.0 - s.powi(3)) / volume);
    let (mut exact, dt) = (1.0, time / 1e4);
    for _ in 0..10_000 {
        let a = rate(exact);
        let b = rate(exact + 0.5 * dt * a);
        let c = rate(exact + 0.5 * dt * b);
        exact += dt / 6.0 * (a + 2.0 * b + 2.0 * c + rate(exact + dt * c));
    }
    let error = |steps| (transient(volume, time, steps)[0] - exact).abs();
    let (coarse, fine) = (error(16), error(32));
    let order = (coarse / fine).log2();
    assert!(
        coarse < 2e-4 && (order - 2.0).abs() < 0.1,
        "{coarse:e} {fine:e}: {order}"
    );
}

#[test]
fn a_constant_area_relaxes_exactly() {
    // Mantles so little of which is lost that their area is the same: y = 4 pi dt / V.
    let (volume, dt) = (1e-9, 1e-10);
    let shares = [share(1.0, 1.0, 0.0)];
    let end = gain(&shares, room(volume, 0.0).retreat(&shares, &WATER, dt));
    let exact = (-1f64).exp() * volume * -(-4.0 * PI * dt / volume).exp_m1();
    assert!((end / exact - 1.0).abs() < 1e-9, "{end:e} {exact:e}");
}
