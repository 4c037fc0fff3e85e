//! Tests of the equations of state.

use super::tillotson::{BASALT, GRANITE, ICE, IRON, MATERIALS};
use super::*;

fn disk() -> Eos {
    Eos::of_disk(0.05, 4.0, 10.0, 0.25, 1.4)
}

/// A table of an ideal gas, on uneven lines.
fn table_of_ideal(gamma: f64) -> Table {
    let axis = |first: f64, lines: i32| -> Vec<f64> {
        (0..lines)
            .map(|k| first * 1.7f64.powi(k) * (1.0 + 0.1 * f64::from(k % 3)))
            .collect()
    };
    let (rho, u) = (axis(1e-3, 21), axis(0.01, 13));
    let states = || rho.iter().flat_map(|&rho| u.iter().map(move |&u| (rho, u)));
    let p: Vec<f64> = states()
        .map(|(rho, u)| ideal::pressure(gamma, rho, u))
        .collect();
    let c: Vec<f64> = states()
        .map(|(_, u)| ideal::sound_speed(gamma, u))
        .collect();
    Table::new(&rho, &u, &p, &c).expect("a table")
}

const CORE: Barotropic = Barotropic {
    sound_speed: 0.2,
    critical_density: 3.0,
    gamma: 1.4,
};

const WATER: Stiffened = Stiffened {
    gamma: 4.4,
    pressure: 6e8,
};

/// dP/drho along the way that u takes with rho, by differences of sixth order.
fn slope(eos: &Eos, rho: f64, u: f64) -> f64 {
    let step = 1e-3 * rho;
    let along = |k: f64| {
        let to = rho + k * step;
        match eos.binding() {
            // du = P / rho^2 drho, in small steps of fourth order.
            Binding::Free => {
                let (mut r, mut e) = (rho, u);
                let d = k * step / 16.0;
                for _ in 0..16 {
                    let rate = |r: f64, e: f64| eos.pressure(r, e) / (r * r);
                    let first = rate(r, e);
                    let second = rate(r + 0.5 * d, e + 0.5 * d * first);
                    let third = rate(r + 0.5 * d, e + 0.5 * d * second);
                    let fourth = rate(r + d, e + d * third);
                    e += d / 6.0 * (first + 2.0 * second + 2.0 * third + fourth);
                    r += d;
                }
                eos.pressure(to, e)
            }
            _ => eos.pressure(to, eos.bound_energy(Vec3::x(), to).expect("bound")),
        }
    };
    let mean = |k: f64| (along(k) - along(-k)) / (2.0 * k * step);
    1.5 * mean(1.0) - 0.6 * mean(2.0) + 0.1 * mean(3.0)
}

#[test]
fn the_square_of_the_sound_speed_is_the_slope_of_the_pressure() {
    let gases = [
        Eos::Ideal { gamma: 1.4 },
        Eos::Isothermal {
            sound_speed: 0.3,
            gamma: 1.4,
        },
        disk(),
        Eos::Barotropic(CORE),
        Eos::Tabulated(Arc::new(table_of_ideal(1.4))),
    ];
    for eos in gases {
        for (rho, u) in [(0.02, 0.1), (0.7, 2.0), (3.0, 0.5), (30.0, 3.0)] {
            let u = eos.bound_energy(Vec3::x(), rho).unwrap_or(u);
            let error = eos.sound_speed(rho, u).powi(2) / slope(&eos, rho, u) - 1.0;
            assert!(error.abs() < 1e-10, "{eos:?} at {rho}, {u}: {error}");
        }
    }
    let water = Eos::Stiffened(WATER);
    for (rho, p) in [(0.9, 1e6), (1.0, 1e10), (1.3, -3e8)] {
        let u = water.energy(rho, p).expect("a formula");
        assert!((water.pressure(rho, u) / p - 1.0).abs() < 1e-8);
        let error = water.sound_speed(rho, u).powi(2) / slope(&water, rho, u) - 1.0;
        assert!(error.abs() < 1e-10, "{rho}, {p}: {error}");
    }
}

/// States of a material in each branch: compressed cold and hot, torn a little, half vapour, vapour.
fn states(law: &Tillotson) -> [(f64, f64); 8] {
    let (half, hot) = (0.5 * (law.incipient + law.complete), 1.7 * law.complete);
    [
        (1.0, 0.1 * law.incipient),
        (1.4, 0.8 * law.incipient),
        (1.8, 3.0 * law.complete),
        (0.95, 0.3 * law.incipient),
        (0.9, half),
        (0.4, half),
        (0.8, hot),
        (0.05, hot),
    ]
    .map(|(eta, u)| (eta * 1.01 * law.density, u))
}

#[test]
fn sound_speeds_of_rock_ice_and_iron_are_the_slopes_of_their_pressures_in_every_branch() {
    for (name, law) in MATERIALS {
        let eos = Eos::Tillotson(law);
        for (rho, u) in states(&law) {
            let square = law.square(rho, u);
            let error = square / slope(&eos, rho, u) - 1.0;
            assert!(error.abs() < 1e-8, "{name} at {rho}, {u}: {error}");
            let least = 0.01 * law.bulk / law.density;
            let taken = eos.sound_speed(rho, u).powi(2);
            assert!((taken / square.max(least) - 1.0).abs() < 1e-14);
        }
    }
}

#[test]
fn pressures_of_rock_ice_and_iron_are_continuous_across_branches() {
    for (name, law) in MATERIALS {
        let near = |x: f64| [x * (1.0 - 1e-12), x * (1.0 + 1e-12)];
        for eta in [0.3, 0.7, 0.97] {
            for edge in [law.incipient, law.complete] {
                let [below, above] = near(edge).map(|u| law.pressure(eta * law.density, u));
                assert!((above - below).abs() < 1e-9 * law.bulk, "{name} {eta}");
            }
        }
        for u in [0.0, 0.5, 1.5, 5.0, 20.0].map(|part| part * law.incipient) {
            let [below, above] = near(law.density).map(|rho| law.pressure(rho, u));
            assert!((above - below).abs() < 1e-9 * law.bulk, "{name} {u}");
        }
    }
}

#[test]
fn cold_solids_have_their_bulk_sound_speed_and_vapour_is_an_ideal_gas() {
    // sqrt(A / rho_0), km/s.
    for (law, speed) in [
        (BASALT, 3.1447),
        (GRANITE, 2.5820),
        (ICE, 3.2136),
        (IRON, 4.0339),
    ] {
        let eos = Eos::Tillotson(law);
        let c = eos.sound_speed(law.density, 0.0) / 1e5;
        assert!((c / speed - 1.0).abs() < 1e-4, "{c}");
        assert_eq!(eos.pressure(law.density, 0.0), 0.0);
        let (rho, u) = (1e-3 * law.density, 10.0 * law.complete);
        let ideal = Eos::Ideal { gamma: law.a + 1.0 };
        assert!((eos.pressure(rho, u) / ideal.pressure(rho, u) - 1.0).abs() < 1e-12);
        assert!((eos.sound_speed(rho, u) / ideal.sound_speed(rho, u) - 1.0).abs() < 1e-12);
        let (density, energy) = (3e-7, 8.87e12);
        let scaled = law.in_units(density, energy);
        let p = scaled.pressure(1.1 * law.density / density, law.incipient / energy);
        let expected = law.pressure(1.1 * law.density, law.incipient) / (density * energy);
        assert!((p / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_core_is_isothermal_while_thin_and_adiabatic_when_dense() {
    let eos = Eos::Barotropic(CORE);
    let square = CORE.sound_speed * CORE.sound_speed;
    let thin = 1e-12 * CORE.critical_density;
    assert!((eos.pressure(thin, 0.0) / (square * thin) - 1.0).abs() < 1e-4);
    assert!((eos.sound_speed(thin, 0.0) / CORE.sound_speed - 1.0).abs() < 1e-4);
    let dense = 1e12 * CORE.critical_density;
    let growth = eos.pressure(2.0 * dense, 0.0) / eos.pressure(dense, 0.0);
    assert!((growth.log2() - CORE.gamma).abs() < 1e-4);
    let u = eos.bound_energy(Vec3::zeros(), dense).expect("bound");
    let ideal = Eos::Ideal { gamma: CORE.gamma };
    assert!((eos.pressure(dense, u) / ideal.pressure(dense, u) - 1.0).abs() < 1e-14);
    assert!((eos.sound_speed(dense, u) / ideal.sound_speed(dense, u) - 1.0).abs() < 1e-4);
}

#[test]
fn a_table_gives_back_the_gas_that_it_was_made_from_and_nothing_outside() {
    let gamma = 1.4;
    let table = table_of_ideal(gamma);
    let [[thin, dense], [cold, hot]] = table.range();
    let eos = Eos::Tabulated(Arc::new(table));
    let mut worst: f64 = 0.0;
    for i in 0..50 {
        for j in 0..50 {
            let between = |a: f64, b: f64, k: i32| a * (b / a).powf((f64::from(k) + 0.5) / 50.0);
            let (rho, u) = (between(thin, dense, i), between(cold, hot, j));
            let p = eos.pressure(rho, u) / ideal::pressure(gamma, rho, u) - 1.0;
            let c = eos.sound_speed(rho, u) / ideal::sound_speed(gamma, u) - 1.0;
            assert!(p.is_finite() && c.is_finite());
            worst = worst.max(p.abs()).max(c.abs());
        }
    }
    assert!(worst < 2e-14, "{worst}");
    for (rho, u) in [
        (0.9 * thin, 1.0),
        (1.1 * dense, 1.0),
        (1.0, 0.9 * cold),
        (1.0, 1.1 * hot),
    ] {
        assert!(eos.pressure(rho, u).is_nan() && eos.sound_speed(rho, u).is_nan());
    }
}

#[test]
fn a_table_of_an_uneven_law_is_of_second_order() {
    // ln P bends along both axes.
    let law = |rho: f64, u: f64| rho * u * (1.0 + rho) / (1.0 + u);
    let worst = |lines: usize| {
        let axis: Vec<f64> = (0..=lines)
            .map(|k| 10f64.powf(2.0 * k as f64 / lines as f64 - 1.0))
            .collect();
        let p: Vec<f64> = axis
            .iter()
            .flat_map(|&rho| axis.iter().map(move |&u| law(rho, u)))
            .collect();
        let table = Table::new(&axis, &axis, &p, &p).expect("a table");
        (1..2000).fold(0.0f64, |worst, k| {
            let x = 10f64.powf(f64::from(k) / 1000.0 - 1.0);
            let u = x.powf(-0.9);
            worst.max((table.pressure(x, u) / law(x, u) - 1.0).abs())
        })
    };
    let order = (worst(16) / worst(64)).log2() / 2.0;
    println!("{order}");
    assert!((order - 2.0).abs() < 0.2, "{order}");
}

#[test]
fn tables_with_faults_are_refused_in_words() {
    let (two, three) = ([1.0, 2.0], [1.0, 2.0, 3.0]);
    let four = [1.0; 4];
    let fault = |rho: &[f64], u: &[f64], p: &[f64], c: &[f64]| {
        Table::new(rho, u, p, c).expect_err("a refusal")
    };
    assert!(fault(&[1.0], &two, &two, &two).contains("1 densities; needed are two"));
    assert!(fault(&two, &[2.0, 1.0], &four, &four).contains("do not ascend"));
    assert!(fault(&three, &two, &four, &four).contains("4 pressures for 3 densities"));
    assert!(fault(&two, &two, &four, &[1.0, -2.0, 1.0, 1.0]).contains("-2 among its sound"));
    assert!(fault(&two, &two, &[1.0, f64::NAN, 1.0, 1.0], &four).contains("NaN among"));
}

#[test]
fn pressure_and_energy_follow_from_the_square_of_the_sound_speed() {
    for eos in [Eos::Ideal { gamma: 1.4 }, disk()] {
        assert!(eos.follows_sound_speed());
        let square = eos.sound_speed(2.0, 0.3).powi(2);
        let p = eos.pressure(2.0, 0.3) / 2.0;
        assert!((eos.pressure_by_square() * square / p - 1.0).abs() < 1e-14);
        assert!((eos.energy_by_square() * square / 0.3 - 1.0).abs() < 1e-14);
    }
    assert!(Eos::Stiffened(WATER).pressure_by_square().is_nan());
}

#[test]
fn disk_gas_has_the_wanted_aspect_ratio_anywhere() {
    let disk = disk();
    for radius in [1.0, 10.0, 100.0] {
        let u = disk
            .bound_energy(Vec3::new(0.0, radius, 3.0), 1.0)
            .expect("bound");
        let kepler = (4.0f64 / radius).sqrt();
        let c = disk.sound_speed(2.0, u);
        let expected = 0.05 * (radius / 10.0f64).powf(0.25);
        assert!((c / kepler / expected - 1.0).abs() < 1e-14);
        assert!((disk.pressure(2.0, u) / (2.0 * c * c) - 1.0).abs() < 1e-14);
    }
}
