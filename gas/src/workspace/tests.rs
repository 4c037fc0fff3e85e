//! Tests of the precisions and instruction sets of the sweeps.

use fearless_simd::Level;
use nbody::points::{Clock, Domain, Vec3};

use super::*;
use crate::samples::{hydro, lattice, noisy, still};
use crate::{Conduction, Formulation, Gas, Hydro, KernelKind};

const NOW: Clock = Clock::standing(0.0);

fn pushed(mut gas: Gas, hydro: &Hydro) -> Gas {
    gas.density(hydro, &NOW, Vec3::zeros()).expect("a solution");
    gas.forces(hydro, &NOW, &NOW);
    gas
}

/// Kernels of low and of high order: these have more neighbours, and more terms.
const LOW: [KernelKind; 2] = [KernelKind::CubicSpline, KernelKind::WendlandC2];
const HIGH: [KernelKind; 3] = [
    KernelKind::QuinticSpline,
    KernelKind::WendlandC4,
    KernelKind::WendlandC6,
];

fn settings(kernels: &[KernelKind]) -> Vec<Hydro> {
    let box_ = Domain::periodic(Vec3::new(1.0, 1.0, 1.0));
    let plane = [true, true, false];
    let mut all = Vec::new();
    for domain in [
        Domain::open(),
        box_,
        Domain::open().with_axes(plane),
        box_.with_axes(plane),
    ] {
        for &kernel in kernels {
            // Both precisions are to stop at the same H.
            let tolerance = 1e-6;
            for formulation in [Formulation::Density, Formulation::Pressure] {
                all.push(Hydro {
                    kernel,
                    tolerance,
                    formulation,
                    // Half of the settings conduct.
                    conduction: Conduction {
                        alpha: f64::from(u8::from(formulation == Formulation::Pressure)),
                    },
                    ..hydro(domain)
                });
            }
        }
    }
    all
}

/// Largest differences of what the sweeps yield, relative to what it is made of: rho, H, div v, acceleration, heating.
fn differences(a: &Gas, b: &Gas) -> [f64; 5] {
    let mut most = [0.0; 5];
    for i in 0..a.len() {
        let (h, cs) = (a.particles.h[i], a.derived.cs[i] + a.derived.v_sig[i]);
        let acceleration = cs * cs / h;
        let differences = [
            b.derived.rho[i] / a.derived.rho[i] - 1.0,
            b.particles.h[i] / h - 1.0,
            (b.derived.div_v[i] - a.derived.div_v[i]) / (cs / h),
            (b.rates.hydro[i] - a.rates.hydro[i]).norm() / acceleration,
            (b.rates.du[i] - a.rates.du[i]) / (acceleration * cs),
        ];
        for (most, x) in most.iter_mut().zip(differences) {
            *most = if x.abs() <= *most { *most } else { x.abs() };
        }
    }
    most
}

/// Instructions that machines with better ones have too.
fn lesser() -> Vec<Level> {
    let mut levels = vec![Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(Level::Avx2));
    levels
}

fn with(hydro: &Hydro, precision: Precision) -> Hydro {
    Hydro {
        precision,
        ..hydro.clone()
    }
}

#[test]
fn single_precision_differs_from_double_by_its_rounding() {
    // A few roundings of 6e-8 each; H is found to its tolerance of 1e-6 by either.
    for (kernels, bars) in [
        (&LOW[..], [1.1e-6, 2e-6, 6e-7, 3.5e-7, 5e-8]),
        (&HIGH[..], [2.2e-6, 2e-6, 9e-7, 4.5e-7, 5.5e-8]),
    ] {
        let mut most = [0.0f64; 5];
        for hydro in settings(kernels) {
            let gas = noisy(&hydro.domain, 12, 1.0);
            let single = pushed(gas.clone(), &with(&hydro, Precision::Single));
            let double = pushed(gas, &with(&hydro, Precision::Double));
            most = larger(most, differences(&double, &single));
        }
        assert!(most.iter().zip(bars).all(|(x, bar)| *x < bar), "{most:?}");
    }
}

fn larger(a: [f64; 5], b: [f64; 5]) -> [f64; 5] {
    std::array::from_fn(|k| if b[k] <= a[k] { a[k] } else { b[k] })
}

#[test]
fn machines_with_and_without_wide_instructions_agree_to_rounding() {
    let (single, double) = (Precision::Single, Precision::Double);
    for (kernels, precision, bars) in [
        (&LOW[..], single, [1.4e-6, 2e-6, 6e-7, 2e-7, 3e-8]),
        (
            &LOW[..],
            double,
            [2.2e-15, 1.3e-15, 5.2e-16, 3.2e-16, 3.5e-17],
        ),
        (&HIGH[..], single, [3e-6, 2e-6, 8e-7, 2.7e-7, 6e-8]),
        (&HIGH[..], double, [2.2e-15, 1.3e-15, 1e-15, 6e-16, 5.5e-17]),
    ] {
        let mut most = [0.0f64; 5];
        for hydro in settings(kernels) {
            let hydro = with(&hydro, precision);
            let gas = noisy(&hydro.domain, 10, 1.0);
            let wide = pushed(gas.clone(), &hydro);
            for level in lesser() {
                let mut gas = gas.clone();
                gas.level = Some(level);
                most = larger(most, differences(&wide, &pushed(gas, &hydro)));
            }
        }
        assert!(
            most.iter().zip(bars).all(|(x, bar)| *x < bar),
            "{precision:?}: {most:?}"
        );
    }
}

/// Sum of all forces, and of their moduli.
fn balance(gas: &Gas) -> (Vec3, f64) {
    let mut sums = (Vec3::zeros(), 0.0);
    for i in 0..gas.len() {
        let force = gas.particles.m[i] * gas.rates.hydro[i];
        sums.0 += force;
        sums.1 += force.norm();
    }
    sums
}

#[test]
fn forces_in_single_precision_cancel_as_if_in_double() {
    for mut hydro in settings(&KernelKind::ALL) {
        hydro.precision = Precision::Single;
        for period in [Vec3::repeat(1.0), Vec3::new(1.0, 1.07, 1.31)] {
            if hydro.domain.volume().is_finite() {
                hydro.domain = Domain::periodic(period).with_axes(hydro.domain.axes);
            }
            for level in lesser().into_iter().chain([Level::new()]) {
                let mut gas = noisy(&hydro.domain, 12, 1.0);
                gas.level = Some(level);
                let (force, size) = balance(&pushed(gas, &hydro));
                assert!(force.norm() < 1e-15 * size, "{:e}", force.norm() / size);
            }
        }
    }
}

#[test]
fn sizes_far_from_one_do_not_matter() {
    // Units are powers of two, and so are the factors: the same bits come out.
    let hydro = with(&hydro(Domain::open()), Precision::Single);
    let [length, velocity, mass] = [2f64.powi(90), 2f64.powi(-80), 2f64.powi(100)];
    // h comes from a first solution: without, it depends on a guess that is a power of the density.
    let gas = pushed(noisy(&hydro.domain, 10, 1.0), &hydro);
    let mut far = gas.clone();
    far.particles.h.iter_mut().for_each(|h| *h *= length);
    for x in &mut far.particles.x {
        *x *= length;
    }
    far.particles.m.iter_mut().for_each(|m| *m *= mass);
    far.rates.v_pred.iter_mut().for_each(|v| *v *= velocity);
    far.rates
        .u_pred
        .iter_mut()
        .for_each(|u| *u *= velocity * velocity);
    far.sort();
    let (near, far) = (pushed(gas, &hydro), pushed(far, &hydro));
    for i in 0..near.len() {
        assert_eq!(near.particles.h[i] * length, far.particles.h[i]);
        assert_eq!(
            near.derived.rho[i] * (mass / length.powi(3)),
            far.derived.rho[i]
        );
        assert_eq!(
            near.rates.hydro[i] * (velocity * velocity / length),
            far.rates.hydro[i]
        );
        assert_eq!(
            near.rates.du[i] * (velocity.powi(3) / length),
            far.rates.du[i]
        );
    }
}

#[test]
fn a_dense_clump_in_thin_gas_has_its_forces() {
    // H varies by a factor 1000: the grid of the clump is too fine for the gas around it.
    let hydro = hydro(Domain::open());
    let mut x = lattice([10; 3], 1.0);
    x.extend(lattice([10; 3], 1e-3).iter().map(|x| x + Vec3::repeat(5.0)));
    let mut gas = Gas::new(still(x, 1.0, 1.0));
    for i in 0..gas.len() {
        gas.rates.v_pred[i] = 0.1 * crate::samples::noise(gas.particles.id[i], 1);
    }
    let single = pushed(gas.clone(), &with(&hydro, Precision::Single));
    let double = pushed(gas, &hydro);
    let differences = differences(&double, &single);
    let bars = [1.8e-6, 4e-7, 5e-8, 2.4e-6, 5e-8];
    assert!(
        differences.iter().zip(bars).all(|(x, bar)| *x < bar),
        "{differences:?}"
    );
    // Members of a pair see each other on different grids where the clump meets the gas.
    let (force, size) = balance(&single);
    assert!(force.norm() < 1.1e-6 * size, "{:e}", force.norm() / size);
}
