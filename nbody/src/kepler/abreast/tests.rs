//! The drift abreast against the scalar one, and its own long runs.

use fearless_simd::SimdBase;

use super::*;

/// Bodies of many orbits about mu = 1: circles, ellipses up to e = 0.95, flybys, falls.
fn swarm(n: u32) -> (Vec<Vec3>, Vec<Vec3>) {
    let f = |i: u32, k: f64| (f64::from(i) * k).fract() - 0.5;
    let body = |i| {
        let x = Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051));
        let v = Vec3::new(f(i, 0.236_068), f(i, 0.645_751), f(i, 0.316_625));
        // Speeds from a tenth to three times that of a circle.
        let speed = 10f64.powf(1.5 * f(i, 0.162_278) - 0.25) / x.norm().sqrt();
        (x, v * (speed / v.norm()))
    };
    (1..=n).map(body).unzip()
}

/// The largest difference to the scalar drift in units of its own reaction to a rounding of the start.
fn difference(dt: f64) -> f64 {
    let (x0, v0) = swarm(5000);
    let (mut x, mut v) = (x0.clone(), v0.clone());
    drift_all(1.0, dt, &mut x, &mut v).expect("orbits");
    let mut most = 0.0;
    for i in 0..x.len() {
        let scalar = |stretch: f64| {
            let (mut x, mut v) = (x0[i] * stretch, v0[i]);
            drift(1.0, dt, &mut x, &mut v).expect("an orbit");
            (x, v)
        };
        let ((y, w), (y1, w1)) = (scalar(1.0), scalar(1.0 + 1e-9));
        let condition = (y1 - y).norm() / y.norm() + (w1 - w).norm() / w.norm();
        let miss = (x[i] - y).norm() / y.norm() + (v[i] - w).norm() / w.norm();
        let error = miss / (1.0 + 1e9 * condition);
        if error > most || error.is_nan() {
            most = error;
        }
    }
    most
}

#[test]
fn lanes_agree_with_the_scalar_drift() {
    for dt in [1e-3, 0.03, -0.03, 0.1, 0.3, 1.0, -4.0, 100.0] {
        let error = difference(dt);
        println!("dt {dt}: {error:e}");
        assert!(error < 1e-15, "dt {dt}: {error:e}");
    }
}

#[test]
fn most_lanes_are_usual_at_the_steps_of_a_map() {
    let (x, v) = swarm(8000);
    let usual = |dt: f64| {
        let (mut usual, mut all) = (0, 0);
        for (x, v) in x.iter().zip(&v) {
            // An eighth of the time 1/Omega at the body's distance.
            let dt = dt * x.norm().powf(1.5);
            let simd = fearless_simd::Level::baseline();
            crate::widest!(simd, simd => {
                let lanes = |s: &Vec3| [0, 1, 2].map(|k| f64x4::splat(simd, s[k]));
                let change = change(simd, f64x4::splat(simd, 1.0), dt, lanes(x), lanes(v));
                usual += u32::from(change.usual.all_true());
            });
            all += 1;
        }
        f64::from(usual) / f64::from(all)
    };
    assert_eq!(usual(0.125), 1.0);
    let half = usual(0.5);
    println!("usual at half 1/Omega: {half}");
    assert!(half > 0.5 && half < 1.0);
}

#[test]
fn a_lane_does_not_feel_its_neighbours() {
    let (x0, v0) = swarm(1000);
    let (mut x, mut v) = (x0.clone(), v0.clone());
    drift_all(1.0, 0.1, &mut x, &mut v).expect("orbits");
    let (mut y, mut w) = (x0.clone(), v0.clone());
    for (y, w) in y.chunks_mut(3).zip(w.chunks_mut(3)) {
        drift_all(1.0, 0.1, y, w).expect("orbits");
    }
    assert_eq!((x, v), (y, w));
}

#[test]
fn the_first_that_cannot_be_moved_is_told_and_the_others_move() {
    let (x0, v0) = swarm(20);
    let (mut x, mut v) = (x0.clone(), v0.clone());
    x[11] = Vec3::zeros();
    x[13] = Vec3::new(f64::NAN, 0.0, 0.0);
    x[17] = x[13];
    let stuck = drift_all(1.0, 0.1, &mut x, &mut v);
    assert_eq!(stuck, Err((11, Refusal::Centre)));
    assert_eq!(x[11], Vec3::zeros());
    let stays = (0..20).filter(|&i| !matches!(i, 11 | 13 | 17) && x[i] == x0[i]);
    assert_eq!(stays.count(), 0);
}

#[test]
fn many_drifts_abreast_keep_the_energy_without_a_bias() {
    let energy = |x: &Vec3, v: &Vec3| 0.5 * v.norm_squared() - 1.0 / x.norm();
    let mut x: Vec<Vec3> = (0..8).map(|_| Vec3::new(0.6, 0.8, 0.1)).collect();
    let mut v: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new(-0.8, 0.6, 0.2) * (1.0 + 0.03 * f64::from(i)))
        .collect();
    let start: Vec<f64> = x.iter().zip(&v).map(|(x, v)| energy(x, v)).collect();
    for _ in 0..1_000_000 {
        drift_all(1.0, 0.31, &mut x, &mut v).expect("orbits");
    }
    let errors = (0..8).map(|i| energy(&x[i], &v[i]) / start[i] - 1.0);
    let errors: Vec<f64> = errors.collect();
    let mean = errors.iter().sum::<f64>() / 8.0;
    println!("mean {mean:e} of {errors:?}");
    // Random walks of 1e6 steps of 1e-16; their mean has a third of their size.
    assert!(mean.abs() < 1e-13, "{mean:e}");
}
