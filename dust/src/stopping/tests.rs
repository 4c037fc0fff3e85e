//! Tests of `stopping`.

use super::*;

/// Radius, material density, gas density, sound speed, speed, mean free path, stopping time: cgs; direct evaluation of the printed
/// formulas by other hands.
const TABLE: [[f64; 7]; 8] = [
    [1e-4, 3.0, 1e-9, 1e5, 1e1, 1.0, 1.8799712039],
    [1e-4, 3.0, 1e-9, 1e5, 1e5, 1.0, 1.70142321488],
    [1e-4, 3.0, 1e-9, 1e5, 5e5, 1.0, 0.736121979922],
    [1e-1, 3.0, 1e-9, 1e5, 1e3, 1.0, 1879.95044267],
    [1e1, 3.0, 1.4e-9, 1e5, 5e3, 1.4, 426297.325618],
    [1e3, 3.0, 1.4e-9, 1e5, 5e3, 1.4, 706219730.777],
    [1e5, 3.0, 1.4e-9, 1e5, 5e3, 1.4, 259740259740.0],
    [1.0, 1.5, 1e-10, 6e4, 3e3, 20.0, 156621.027477],
];

fn case(row: &[f64; 7]) -> (Sphere, Ambient, Molecules) {
    let [radius, density, rho, c, _, path, _] = *row;
    let molecules = Molecules {
        mass: 1.0,
        cross_section: 1.0 / (rho * path),
    };
    let gas = Ambient { rho, c, omega: 0.0 };
    (Sphere { radius, density }, gas, molecules)
}

/// e-foldings by many small steps of the classical Runge-Kutta method in ln u.
fn stepped(law: &StoppingLaw, sphere: &Sphere, gas: &Ambient, speed: f64, dt: f64) -> f64 {
    let n = 20_000;
    let k = dt / f64::from(n);
    let slope = |x: f64| 1.0 / law.stopping_time(sphere, gas, speed * (-x).exp());
    (0..n).fold(0.0, |x, _| {
        let a = slope(x);
        let b = slope(x + 0.5 * k * a);
        let c = slope(x + 0.5 * k * b);
        let d = slope(x + k * c);
        x + k / 6.0 * (a + 2.0 * b + 2.0 * c + d)
    })
}

#[test]
fn grains_stop_as_tabulated() {
    for row in &TABLE {
        let (sphere, gas, molecules) = case(row);
        let path = molecules.mean_free_path(gas.rho);
        let law = if sphere.radius < 2.25 * path {
            StoppingLaw::Epstein
        } else {
            StoppingLaw::Stokes(molecules)
        };
        let error = |law: StoppingLaw| {
            let t = law.stopping_time(&sphere, &gas, row[4]);
            (t / row[6] - 1.0).abs()
        };
        // The table has twelve digits.
        assert!(error(law) < 1e-11, "{row:?}: error {:e}", error(law));
        // (4 s / 9 l)^4 / 4 or its inverse is at most 1e-6 except at 10 cm, which is 7 l and has Re = 0.895.
        let bar = if row[0] == 10.0 { 5e-3 } else { 1e-6 };
        let auto = error(StoppingLaw::Auto(molecules));
        assert!(auto < bar, "{row:?}: joined {auto:e}");
    }
}

#[test]
fn the_smooth_law_has_epsteins_and_stokes_and_newtons_limits() {
    let t = |law: StoppingLaw, row: &[f64; 7], u: f64| {
        let (sphere, gas, _) = case(row);
        law.stopping_time(&sphere, &gas, u)
    };
    let ratio = |row: &[f64; 7], u: f64, law: StoppingLaw| {
        let (.., molecules) = case(row);
        t(StoppingLaw::Adachi(molecules), row, u) / t(law, row, u)
    };
    let (.., molecules) = case(&TABLE[4]);
    // Free molecular flow: what remains is of the order of s / l = 1e-4.
    assert!((ratio(&TABLE[0], 1e-3, StoppingLaw::Epstein) - 1.0).abs() < 1e-4);
    // Creeping flow around 1 km: 1 / (24/Re + 4) is 1/6 Re off.
    let km = [1e5, 3.0, 1.4e-9, 1e5, 1e-5, 1.4, 0.0];
    let reynolds = molecules.reynolds(&case(&km).0, &case(&km).1) * 1e-5;
    let error = ratio(&km, 1e-5, StoppingLaw::Stokes(molecules)) - 1.0;
    assert!(
        error.abs() < reynolds / 5.0 + 1e-4,
        "{error:e} at Re {reynolds:e}"
    );
    // Fast and large: C_D = 2 in the hypersonic limit.
    let (sphere, gas, _) = case(&km);
    let fast = t(StoppingLaw::Adachi(molecules), &km, 1e10);
    let two = 8.0 * sphere.density * sphere.radius / (6.0 * gas.rho * 1e10);
    assert!((fast / two - 1.0).abs() < 1e-4, "{}", fast / two);
    // Slow but turbulent: w, before and behind the drag crisis; the other terms are below 64/Re and 2 M.
    for (radius, w) in [(1e6, 0.4), (1e8, 0.2)] {
        let (sphere, u) = (Sphere { radius, ..sphere }, 1e3);
        let t = StoppingLaw::Adachi(molecules).stopping_time(&sphere, &gas, u);
        let drag = 8.0 * sphere.density * radius / (3.0 * gas.rho * u * t);
        let rest = 64.0 / (molecules.reynolds(&sphere, &gas) * u) + 2.0 * u / gas.thermal_speed();
        assert!(drag > w && drag < w + rest, "C_D = {drag}");
    }
}

#[test]
fn one_law_is_smooth_from_a_micrometre_to_a_hundred_kilometres() {
    let (_, gas, molecules) = case(&TABLE[0]);
    let path = molecules.mean_free_path(gas.rho);
    let by_hand = |sphere: &Sphere, u: f64| {
        let law = if sphere.radius < 2.25 * path {
            StoppingLaw::Epstein
        } else {
            StoppingLaw::Stokes(molecules)
        };
        law.stopping_time(sphere, &gas, u)
    };
    let step = 0.01;
    for u in [1.0, 1e3] {
        let mut last: Option<[f64; 2]> = None;
        let (mut worst, mut between, mut curve) = (0.0f64, 0.0f64, 0.0f64);
        for k in 0..2534 {
            let radius = 1e-4 * (f64::from(k) * step).exp();
            let sphere = Sphere {
                radius,
                density: 3.0,
            };
            let t = StoppingLaw::Auto(molecules).stopping_time(&sphere, &gas, u);
            let error = (t / by_hand(&sphere, u) - 1.0).abs();
            if (1.1 * path..4.2 * path).contains(&radius) {
                between = between.max(error);
            } else {
                worst = worst.max(error);
            }
            if let Some([before, slope]) = last {
                let next = (t.ln() - before) / step;
                if slope.is_finite() {
                    curve = curve.max((next - slope).abs() / step);
                }
                last = Some([t.ln(), next]);
            } else {
                last = Some([t.ln(), f64::NAN]);
            }
        }
        println!("u {u:e}: {worst:.4} outside, {between:.4} inside, curvature {curve:.2}");
        assert!(
            worst < 0.03 && between < 0.19,
            "u = {u:e}: {worst} {between}"
        );
        // d^2 ln t / d ln s^2: a kink would have 1/step = 100 times its change of slope.
        assert!(curve < 4.0, "u = {u:e}: {curve}");
    }
}

#[test]
fn decay_solves_the_equation_of_motion_of_every_law() {
    let km = [1e5, 3.0, 1.4e-9, 1e5, 5e3, 1.4, 0.0];
    for (row, speed, bar) in [
        (&TABLE[2], 5e5, 1e-9),
        (&TABLE[4], 5e4, 1e-6),
        (&TABLE[5], 5e5, 1e-6),
        (&km, 5e5, 1e-6),
    ] {
        let (sphere, gas, molecules) = case(row);
        let laws = [
            StoppingLaw::Epstein,
            StoppingLaw::Stokes(molecules),
            StoppingLaw::Adachi(molecules),
            StoppingLaw::Auto(molecules),
            StoppingLaw::Quadratic(1e-9),
            StoppingLaw::ConstantStoppingTime(3.0),
        ];
        for law in laws {
            for depth in [1e-3, 0.3, 5.0] {
                let dt = depth * law.stopping_time(&sphere, &gas, speed);
                let exact = stepped(&law, &sphere, &gas, speed, dt);
                let x = law.e_foldings(&sphere, &gas, speed, dt);
                let error = (x / exact - 1.0).abs();
                assert!(
                    error < bar,
                    "{law:?} {row:?} {depth}: {x} {exact} {error:e}"
                );
            }
        }
    }
}

#[test]
fn kwoks_correction_decays_as_the_mixed_dustybox() {
    // K = 1, rho_g = 1, rho_d = 1/2, so the rate is 3; a = 9 pi/128 at c = 1; start at 3.
    let sphere = Sphere {
        radius: 1.0,
        density: (8.0 / PI).sqrt() / 3.0,
    };
    let gas = Ambient {
        rho: 1.0,
        c: 1.0,
        omega: 0.0,
    };
    for (t, u) in [
        (0.05, 2.35935544003),
        (0.2, 1.31234679238),
        (1.0, 0.109550999594),
        (5.0, 6.7265908977e-7),
    ] {
        let error = (3.0 * StoppingLaw::Epstein.decay(&sphere, &gas, 3.0, t) / u - 1.0).abs();
        assert!(error < 1e-11, "t = {t}: {error:e}");
    }
}

#[test]
fn nothing_slows_without_gas_and_stiff_decays_are_finite() {
    let (sphere, gas, molecules) = case(&TABLE[5]);
    let none = Ambient { rho: 0.0, ..gas };
    for law in [
        StoppingLaw::None,
        StoppingLaw::Epstein,
        StoppingLaw::Stokes(molecules),
        StoppingLaw::Auto(molecules),
        StoppingLaw::Adachi(molecules),
    ] {
        assert_eq!(law.decay(&sphere, &none, 1.0, 1e30), 1.0);
        assert_eq!(law.stopping_time(&sphere, &none, 1.0), f64::INFINITY);
        for speed in [0.0, 1e-300, 1.0, 1e8] {
            let x = law.e_foldings(&sphere, &gas, speed, 1e30);
            assert!(x.is_finite() && x >= 0.0, "{law:?} {speed}: {x}");
        }
    }
}
