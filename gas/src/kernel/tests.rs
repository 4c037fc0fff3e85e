//! Tests of `kernel`.

use super::*;

/// Integrals of r^power W over space, by the midpoint rule in 40 000 shells (error below 1e-9).
fn moment<K: Kernel>(dimensions: usize, power: i32) -> f64 {
    let reach = 1.7;
    let shells = 40_000;
    let dr = reach / f64::from(shells);
    (0..shells)
        .map(|i| {
            let r = (f64::from(i) + 0.5) * dr;
            let shell = unit_sphere(dimensions) * dimensions as f64 * r.powi(dimensions as i32 - 1);
            shell * r.powi(power) * K::w(r, reach, dimensions) * dr
        })
        .sum()
}

fn check<K: Kernel>() {
    for dimensions in [2, 3] {
        let mass = moment::<K>(dimensions, 0);
        assert!((mass - 1.0).abs() < 2e-9, "{dimensions}D: {mass}");
        let deviation = (moment::<K>(dimensions, 2) / dimensions as f64).sqrt();
        let support = 1.7 / (2.0 * deviation);
        assert!(
            (support / K::support(dimensions) - 1.0).abs() < 4e-7,
            "{dimensions}D: {support}"
        );
        for i in 1..100 {
            let (r, e) = (0.017 * f64::from(i), 1e-5);
            let by_difference =
                (K::w(r + e, 1.7, dimensions) - K::w(r - e, 1.7, dimensions)) / (2.0 * e);
            assert!(
                (K::dw(r, 1.7, dimensions) - by_difference).abs() < 2e-9,
                "{dimensions}D at {r}"
            );
        }
        assert_eq!(K::w(1.7, 1.7, dimensions), 0.0);
        assert_eq!(K::dw(2.0, 1.7, dimensions), 0.0);
    }
}

#[test]
fn kernels_hold_unit_mass_their_width_and_their_slope() {
    check::<CubicSpline>();
    check::<QuinticSpline>();
    check::<WendlandC2>();
    check::<WendlandC4>();
    check::<WendlandC6>();
}
