//! The analytic disk and its drag.

use super::*;

/// v^2/R = G M R/r^3 - (1/rho) dP/dR, the derivative taken numerically: exact in the midplane, to fourth order in H/R off it.
#[test]
fn the_gas_turns_in_balance_with_its_pressure() {
    for (flaring, slope) in [(0.25, -1.0), (0.0, 1.0), (0.5, -1.5)] {
        let disk = GasDisk {
            flaring,
            slope,
            ..DISK
        };
        for (r, lift) in [(1.0, 0.0), (3.0, 0.0), (1.0, 1.0), (2.0, 0.5)] {
            let h = disk.aspect_ratio(r);
            let z = lift * h * r;
            let field = |r: f64| {
                let gas = disk.at(Vec3::new(0.6 * r, -0.8 * r, z), 2.0).expect("gas");
                (gas.rho * gas.c * gas.c, gas)
            };
            let (d, (_, gas)) = (1e-5 * r, field(r));
            let slope = (field(r + d).0 - field(r - d).0) / (2.0 * d);
            let pull = 2.0 * r / (r * r + z * z).powf(1.5);
            let wanted = (pull + slope / gas.rho) * r * r / 2.0;
            let found = gas.v.norm_squared() * r / 2.0;
            // (z/r)^4 with a factor of order one, beside pressure terms of h^2 = 2.5e-3 and more.
            let bar = if lift == 0.0 { 1e-9 } else { 2.0 * h.powi(4) };
            assert!(
                (found - wanted).abs() < bar,
                "{flaring} {slope} {r} {lift}: {found} {wanted}"
            );
            assert!(gas.v.dot(&Vec3::new(0.6, -0.8, 0.0)).abs() < 1e-15 && gas.v.y > 0.0);
        }
    }
}

#[test]
fn the_column_through_the_disk_is_its_surface_density() {
    let r = 2.0;
    let height = DISK.aspect_ratio(r) * r;
    let step = 0.01 * height;
    let column: f64 = (-1000..=1000)
        .map(|k| {
            DISK.at(Vec3::new(r, 0.0, f64::from(k) * step), 1.0)
                .expect("gas")
                .rho
                * step
        })
        .sum();
    assert!((column / 5e-5 - 1.0).abs() < 1e-12, "{column}");
    for r in [0.09, 10.1] {
        assert_eq!(DISK.at(Vec3::new(r, 0.0, 0.0), 1.0), None);
    }
}

#[test]
fn the_quadratic_law_is_solved_exactly_for_any_stopping_time() {
    let bodies = [(0.0, orbit(0.2, 0.1))];
    for coefficient in [1e-3, 1.0, 1e12] {
        let mut target = target(&system(&bodies), 0);
        target.planet = true;
        let gas = DISK.at(target.x, 1.0).expect("gas").v;
        let u = target.v - gas;
        let change = quadratic(coefficient).change(&target, 0.7);
        let wanted = u / (1.0 + coefficient * u.norm() * 0.7);
        let error = (target.v + change.dv - gas - wanted).norm() / u.norm();
        assert!(error < 1e-15, "{coefficient}: {error:e}");
        let heat = 0.5 * (u.norm_squared() - wanted.norm_squared());
        assert!((change.heat / heat - 1.0).abs() < 1e-12);
    }
}

#[test]
fn planets_with_mass_and_points_under_a_law_of_size_feel_no_drag() {
    let adachi = DiskDrag {
        disk: DISK,
        law: StoppingLaw::Epstein,
    };
    let mut body = target(&system(&[(1e-12, orbit(0.2, 0.1))]), 0);
    assert_eq!(adachi.change(&body, 1.0), Change::default());
    (body.radius, body.density) = (1e-9, 1e6);
    let felt = adachi.change(&body, 1.0).dv.norm();
    assert!(felt > 1e-12, "{felt}");
    body.planet = true;
    assert_eq!(adachi.change(&body, 1.0), Change::default());
    assert_eq!(quadratic(1.0).change(&body, 1.0), Change::default());
    body.m = 0.0;
    assert_eq!(adachi.change(&body, 1.0).dv.norm(), felt);
}
