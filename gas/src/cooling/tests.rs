//! Tests of `cooling`.

use nbody::points::clock::TICKS;

use super::*;
use crate::samples::still;

/// Omega = 2 at a distance of 1 from the axis.
const STAR: Centre = Centre {
    x: Vec3::new(0.0, 0.0, 0.0),
    gm: 4.0,
};

fn beta(beta: f64) -> Cooling {
    Cooling {
        duration: Duration::Orbital(beta),
        profile: None,
        warms: false,
        gamma: 1.4,
    }
}

/// u_0 = 0.1 at a distance of 1, falling outward.
const PROFILE: Profile = Profile {
    sound_speed: 0.2,
    radius: 1.0,
    exponent: 0.5,
};

/// Gas alone at `x`, moving by `v`.
fn parcel(x: Vec3, v: Vec3, u: f64) -> Gas {
    let mut particles = still(vec![x], 3.0, u);
    particles.v[0] = v;
    let mut gas = Gas::new(particles);
    gas.vicinity.active = vec![0];
    gas
}

/// Carries gas over `steps` steps to `time`, heated by `heating(t, u)` in kicks at the ends of steps; returns u and what was radiated.
fn carried(
    gas: &mut Gas,
    cooling: &Cooling,
    (time, steps): (f64, u32),
    heating: impl Fn(f64, f64) -> f64,
) -> f64 {
    let dt = time / f64::from(steps);
    let mut radiated = 0.0;
    gas.rates.du[0] = heating(0.0, gas.particles.u[0]);
    for k in 0..steps {
        let start = f64::from(k) * dt;
        let mut clock = Clock {
            start,
            end: start + dt,
            tick: 0,
            step: 0,
        };
        gas.rates.next_span[0] = TICKS;
        let kick = 0.5 * dt * gas.rates.du[0];
        gas.foresee(cooling, &clock, &STAR, Vec3::zeros());
        let (u, du) = (gas.particles.u[0], gas.rates.du[0]);
        let seen = match du < 0.0 {
            true => u * (du * dt / u).exp(),
            false => u + du * dt,
        };
        gas.particles.begin[0] = 0;
        let v = gas.particles.v[0];
        gas.particles.x[0] += dt * v;
        clock.tick = TICKS;
        gas.rates.du[0] = heating(start + dt, seen);
        gas.particles.u[0] += kick + 0.5 * dt * gas.rates.du[0];
        radiated += gas.cool(cooling, &clock, &STAR, Vec3::zeros()).radiated;
    }
    radiated
}

#[test]
fn gas_cools_exponentially_at_any_rate_in_any_steps() {
    let (u, time) = (0.7, 1.3);
    for exponent in -6..=6 {
        let beta = beta(10f64.powi(exponent));
        let Duration::Orbital(number) = beta.duration else {
            unreachable!()
        };
        for steps in [1, 7, 64] {
            let mut gas = parcel(Vec3::x(), Vec3::zeros(), u);
            let radiated = carried(&mut gas, &beta, (time, steps), |_, _| 0.0);
            let (found, expected) = (gas.particles.u[0], u * (-2.0 * time / number).exp());
            assert!((found - expected).abs() < 1e-13 * u, "{number}: {found}");
            if expected > 1e-300 {
                assert!((found / expected - 1.0).abs() < 1e-9, "{number}: {found}");
            }
            assert!((radiated - 3.0 * (u - found)).abs() < 1e-13, "{radiated}");
            assert_eq!(gas.rates.u_pred[0], found);
        }
    }
}

#[test]
fn heated_gas_cools_to_second_order_and_to_balance_when_fast() {
    // du/dt = k(t) u + s - 2 u / beta.
    let heating = |t: f64, u: f64| (0.8 + 0.5 * (3.0 * t).sin()) * u + 0.3;
    let (time, u) = (1.0, 0.5);
    let exact = |cooling: f64| {
        let rate = |t: f64, u: f64| heating(t, u) - cooling * u;
        let n = 20_000;
        let dt = time / f64::from(n);
        (0..n).fold(u, |u, k| {
            let t = f64::from(k) * dt;
            let middle = u + 0.5 * dt * rate(t, u);
            let again = u + 0.5 * dt * rate(t + 0.5 * dt, middle);
            let last = u + dt * rate(t + 0.5 * dt, again);
            let inner = rate(t + 0.5 * dt, middle) + rate(t + 0.5 * dt, again);
            u + dt / 6.0 * (rate(t, u) + 2.0 * inner + rate(t + dt, last))
        })
    };
    for number in [0.5, 2.0, 10.0] {
        let error = |steps: u32| {
            let mut gas = parcel(Vec3::x(), Vec3::zeros(), u);
            carried(&mut gas, &beta(number), (time, steps), heating);
            (gas.particles.u[0] / exact(2.0 / number) - 1.0).abs()
        };
        let (coarse, fine) = (error(32), error(128));
        let order = 0.5 * (coarse / fine).log2();
        println!("beta {number}: {coarse:e} {fine:e}, order {order}");
        assert!(order > 1.8, "beta {number}: order {order}");
    }
    // Where gas cools at once, it holds what heat brings in a cooling time.
    let mut gas = parcel(Vec3::x(), Vec3::zeros(), u);
    carried(&mut gas, &beta(1e-4), (time, 16), |_, _| 0.3);
    let balance = 0.3 * 1e-4 / 2.0;
    assert!((gas.particles.u[0] / balance - 1.0).abs() < 1e-12);
}

#[test]
fn gas_that_moves_outward_cools_by_the_time_of_each_place() {
    // Omega = 2 R^-1.5, R = 1 + 0.5 t: the integral of Omega dt is 8 (1 - R^-0.5).
    let error = |steps: u32| {
        let mut gas = parcel(Vec3::new(0.6, 0.8, 5.0), Vec3::new(0.3, 0.4, 1.0), 1.0);
        carried(&mut gas, &beta(3.0), (2.0, steps), |_, _| 0.0);
        let expected = (-8.0 * (1.0 - 0.5f64.sqrt()) / 3.0).exp();
        (gas.particles.u[0] / expected - 1.0).abs()
    };
    let (coarse, fine) = (error(8), error(32));
    println!("{coarse:e} {fine:e}");
    assert!((0.5 * (coarse / fine).log2() - 2.0).abs() < 0.1);
}

#[test]
fn gas_never_cools_below_its_floor_and_only_relaxation_warms() {
    let floor = |warms: bool| Cooling {
        profile: Some(PROFILE),
        warms,
        ..beta(0.5)
    };
    let rest = 0.1;
    for (u, warms) in [(0.4, false), (0.4, true), (0.03, true)] {
        let mut gas = parcel(Vec3::x(), Vec3::zeros(), u);
        let radiated = carried(&mut gas, &floor(warms), (0.3, 5), |_, _| 0.0);
        let expected = rest + (u - rest) * (-1.2f64).exp();
        assert!((gas.particles.u[0] / expected - 1.0).abs() < 1e-13);
        assert!((radiated - 3.0 * (u - expected)).abs() < 1e-14);
        carried(&mut gas, &floor(warms), (1e4, 3), |_, _| 0.0);
        assert!((gas.particles.u[0] / rest - 1.0).abs() < 1e-13);
    }
    let mut gas = parcel(Vec3::x(), Vec3::zeros(), 0.03);
    assert_eq!(carried(&mut gas, &floor(false), (1.0, 5), |_, _| 0.0), 0.0);
    assert_eq!(gas.particles.u[0], 0.03);
    // Whatever heat is taken to have come, cooling ends between u and the floor.
    let law = floor(false);
    assert_eq!(law.cooled(0.11, -0.5, rest, 1.0).u, rest);
    assert_eq!(law.cooled(0.11, 0.5, rest, 1.0).u, 0.11);
    // Further out it is colder: c ~ R^-0.5.
    let mut gas = parcel(4.0 * Vec3::y(), Vec3::zeros(), 0.7);
    carried(&mut gas, &floor(false), (1e4, 2), |_, _| 0.0);
    assert!((gas.particles.u[0] / (0.25 * rest) - 1.0).abs() < 1e-12);
    let given = Cooling {
        duration: Duration::Time(0.25),
        ..floor(true)
    };
    let mut gas = parcel(Vec3::x(), Vec3::zeros(), 0.4);
    carried(&mut gas, &given, (0.5, 3), |_, _| 0.0);
    let expected = rest + (0.4 - rest) * (-2.0f64).exp();
    assert!((gas.particles.u[0] / expected - 1.0).abs() < 1e-13);
}

#[test]
fn gas_that_expands_faster_than_its_step_stays_warm_and_says_so() {
    let law = beta(1.0);
    let Cooled { u, cut } = law.cooled(0.1, -5.0, 0.0, 1.0);
    assert!(
        cut && (u / (0.01 * (-1.0f64).exp()) - 1.0).abs() < 1e-13,
        "{u}"
    );
    assert!(!law.cooled(0.1, -0.05, 0.0, 1.0).cut);
}

#[test]
fn gas_that_relaxes_on_its_way_outward_follows_the_profile() {
    // u_0 = 0.1 / R, R = 1 + 0.5 t, in a time of 0.3: against fine steps of the law itself.
    let law = Cooling {
        duration: Duration::Time(0.3),
        profile: Some(PROFILE),
        warms: true,
        gamma: 1.4,
    };
    let end = |time: f64, steps: u32| {
        let law = Cooling {
            duration: Duration::Time(time),
            ..law
        };
        let mut gas = parcel(Vec3::x(), 0.5 * Vec3::x(), 0.3);
        carried(&mut gas, &law, (2.0, steps), |_, _| 0.0);
        gas.particles.u[0]
    };
    let rate = |t: f64, u: f64| (0.1 / (1.0 + 0.5 * t) - u) / 0.3;
    let dt = 1e-4;
    let exact = (0..20_000).fold(0.3, |u, k| {
        let t = f64::from(k) * dt;
        u + dt * rate(t + 0.5 * dt, u + 0.5 * dt * rate(t, u))
    });
    let error = |steps: u32| (end(0.3, steps) / exact - 1.0).abs();
    println!("{:e} {:e}", error(8), error(32));
    assert!((0.5 * (error(8) / error(32)).log2() - 2.0).abs() < 0.2);
    assert!((end(1e-9, 16) / 0.05 - 1.0).abs() < 1e-6);
}
