//! The walk against the equation of diffusion: spreading, what stays mixed, layers in balance with settling.

use nbody::points::random::{Purpose, stream};
use rand::RngExt;
use rand_distr::StandardNormal;

use super::*;

/// H = c = Omega = 1, midplane density 1.
const GAS: Ambient = Ambient {
    rho: 1.0,
    c: 1.0,
    omega: 1.0,
};

const GRAIN: Sphere = Sphere {
    radius: 1.0,
    density: 1.0,
};

/// Gas of density exp(-z^2/2), and how ln c changes with z.
fn air(z: f64, log_c: f64) -> Air {
    Air {
        ambient: Ambient {
            rho: (-0.5 * z * z).exp(),
            c: (log_c * z).exp(),
            ..GAS
        },
        log_rho: -z * Vec3::z(),
        log_c: log_c * Vec3::z(),
        log_omega: Vec3::zeros(),
    }
}

/// Walks `n` grains from `start(k)`, each to the end of `steps` steps of `dt`, with the speed `settling(z)` beside the walk.
fn walked(
    (n, steps, dt): (u64, u64, f64),
    law: &StoppingLaw,
    air: impl Fn(Vec3) -> Air,
    start: impl Fn(u64) -> Vec3,
    settling: impl Fn(f64) -> f64,
) -> Vec<Vec3> {
    let turbulence = Turbulence::uniform(0.1);
    (0..n)
        .map(|id| {
            (0..steps).fold(start(id), |x, step| {
                let mut random = stream(3, Purpose::Turbulence, id, step);
                let gauss = Vec3::from_fn(|_, _| random.sample(StandardNormal));
                x + turbulence.walk(law, &GRAIN, &air(x), dt, gauss)
                    + settling(x.z) * dt * Vec3::z()
            })
        })
        .collect()
}

/// Normal numbers.
fn normal(id: u64) -> Vec3 {
    let mut random = stream(3, Purpose::DustPositions, id, 0);
    Vec3::from_fn(|_, _| random.sample(StandardNormal))
}

fn mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x * x));
    sum / n
}

const TRACER: StoppingLaw = StoppingLaw::ConstantStokes(1e-9);

#[test]
fn a_cloud_in_uniform_gas_spreads_as_two_d_t() {
    let uniform = |_: Vec3| Air {
        log_rho: Vec3::zeros(),
        ..air(0.0, 0.0)
    };
    for (stokes, slower) in [(1e-9, 1.0), (2.0, 5.0)] {
        let law = StoppingLaw::ConstantStokes(stokes);
        let end = walked((20_000, 10, 0.3), &law, uniform, |_| Vec3::zeros(), |_| 0.0);
        let expected = 2.0 * 0.1 / slower * 3.0;
        for axis in 0..3 {
            let found = mean_square(end.iter().map(|x| x[axis]));
            let errors = (found / expected - 1.0) / (2.0 / 20_000.0f64).sqrt();
            println!("St {stokes}, axis {axis}: {errors:+.2} standard errors");
            assert!(errors.abs() < 3.0, "{found} {expected}");
        }
    }
}

#[test]
fn a_well_mixed_layer_stays_well_mixed() {
    // z^2 of the Euler walk is 1/(1 - alpha dt/2) times that of the gas.
    let (n, dt) = (10_000, 0.1);
    let end = walked((n, 400, dt), &TRACER, |x| air(x.z, 0.0), normal, |_| 0.0);
    let error = (2.0 / n as f64).sqrt();
    let found = mean_square(end.iter().map(|x| x.z));
    let errors = (found - 1.0 / (1.0 - 0.05 * dt)) / error;
    println!("z^2 = {found:.4}: {errors:+.2} standard errors");
    assert!(errors.abs() < 3.0, "{found}");
    // Bands of height that hold a tenth of the gas each.
    let tenths = [
        0.0, 0.125661, 0.253347, 0.385320, 0.524401, 0.674490, 0.841621, 1.036433, 1.281552,
        1.644854, 1e9,
    ];
    for band in tenths.windows(2) {
        let inside = |x: &&Vec3| band[0] <= x.z.abs() && x.z.abs() < band[1];
        let share = end.iter().filter(inside).count() as f64 / n as f64;
        let errors = (share - 0.1) / (0.09 / n as f64).sqrt();
        println!("{band:?}: {share:.4}, {errors:+.2} standard errors");
        assert!(errors.abs() < 3.0, "{band:?}: {share}");
    }
}

#[test]
fn warm_places_and_heavy_grains_stay_well_mixed_too() {
    // D grows with z through c, or falls with the density through the Stokes number: rho itself stays the balance of both.
    let n = 10_000;
    let epstein = StoppingLaw::Epstein;
    for (law, log_c, what) in [(TRACER, 0.5, "c"), (epstein, 0.0, "St")] {
        let end = walked((n, 400, 0.05), &law, |x| air(x.z, log_c), normal, |_| 0.0);
        let mean = end.iter().map(|x| x.z).sum::<f64>() / n as f64;
        let square = mean_square(end.iter().map(|x| x.z));
        let errors = [
            mean / (1.0 / n as f64).sqrt(),
            (square - 1.0) / (2.0 / n as f64).sqrt(),
        ];
        println!("D by {what}: mean {mean:.4}, square {square:.4}: {errors:+.2?}");
        assert!(errors.iter().all(|e| e.abs() < 3.0), "{what}: {errors:?}");
    }
}

#[test]
fn settling_and_stirring_balance() {
    // Terminal speed -St z beside the walk: 1/H_d^2 = 1 + St (1 + St^2) / alpha, widened by the Euler step.
    let (stokes, alpha, dt, n) = (0.3, 0.1, 0.05, 10_000);
    let law = StoppingLaw::ConstantStokes(stokes);
    let settling = |z: f64| -stokes * z;
    let end = walked((n, 600, dt), &law, |x| air(x.z, 0.0), normal, settling);
    let d = alpha / (1.0 + stokes * stokes);
    let pull = d + stokes;
    let expected = d / pull / (1.0 - 0.5 * pull * dt);
    let found = mean_square(end.iter().map(|x| x.z));
    let errors = (found / expected - 1.0) / (2.0 / n as f64).sqrt();
    println!("H_d^2 = {found:.4}, expected {expected:.4}: {errors:+.2} standard errors");
    assert!(errors.abs() < 3.0, "{found} {expected}");
}

#[test]
fn the_gradient_of_d_is_that_of_its_formula() {
    let turbulence = Turbulence::uniform(1e-3);
    let sphere = Sphere {
        radius: 0.7,
        density: 1.3,
    };
    let law = StoppingLaw::Epstein;
    let (z, log_c, d) = (0.8, 0.3, 1e-5);
    let (_, found) = turbulence.diffusion_around(&law, &sphere, &air(z, log_c));
    let at = |z: f64| turbulence.diffusion(&law, &sphere, &air(z, log_c).ambient);
    let exact = (at(z + d) - at(z - d)) / (2.0 * d);
    assert!((found.z / exact - 1.0).abs() < 1e-6, "{} {exact}", found.z);
    assert!(found.x == 0.0 && found.y == 0.0);
}

#[test]
fn gas_that_is_next_to_nothing_carries_nobody() {
    let turbulence = Turbulence::uniform(0.1);
    for z in [30.0, 37.0, 38.5, 40.0] {
        let walk = turbulence.walk(&StoppingLaw::Epstein, &GRAIN, &air(z, 0.0), 0.1, Vec3::z());
        assert!(walk.norm() < 1e-100, "{z}: {walk}");
    }
}
