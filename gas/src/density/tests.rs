//! Tests of `density`.

use nbody::points::Domain;

use super::*;
use crate::Viscosity;
use crate::kernel::unit_sphere;
use crate::samples::{hydro, lattice, noisy, still};
use crate::{CubicSpline, Kernel, KernelKind, WendlandC2};

const NOW: Clock = Clock::standing(0.0);

fn settled(mut gas: Gas, hydro: &Hydro) -> Gas {
    gas.density(hydro, &NOW, Vec3::zeros()).expect("a solution");
    gas
}

/// Separations r_j - r_i with |r| < H of all particles from particle i, by trying all pairs.
fn near(gas: &Gas, domain: &Domain, i: usize, reach: f64) -> Vec<(usize, Vec3)> {
    let x = &gas.particles.x;
    (0..gas.len())
        .map(|j| (j, domain.nearest(x[j] - x[i])))
        .filter(|(_, d)| d.norm() < reach)
        .collect()
}

fn check_against_direct_sums<K: Kernel>(hydro: &Hydro) {
    let gas = settled(noisy(&hydro.domain, 12, 0.5), hydro);
    let (p, derived, v) = (&gas.particles, &gas.derived, &gas.rates.v_pred);
    let d = hydro.dimensions();
    for i in (0..gas.len()).step_by(if d == 3 { 53 } else { 5 }) {
        let reach = p.h[i] * hydro.support();
        let near = near(&gas, &hydro.domain, i, reach);
        let sum = |reach: f64, f: &dyn Fn(usize, f64) -> f64| -> f64 {
            near.iter()
                .map(|&(j, r)| f(j, K::w(r.norm(), reach, d)))
                .sum()
        };
        let number = unit_sphere(d) * reach.powi(d as i32) * sum(reach, &|_, w| w);
        assert!((number / hydro.neighbours - 1.0).abs() < d as f64 * hydro.tolerance);
        let own = K::self_excess(hydro.neighbours, d);
        let counted = |j: usize, w: f64| {
            if j == i {
                p.m[j] * w * (1.0 - own)
            } else {
                p.m[j] * w
            }
        };
        let rho = sum(reach, &counted);
        let by_number = sum(reach, &|j, w| counted(j, w) / p.m[j]) * p.m[i];
        let expected = match hydro.formulation {
            Formulation::Number => by_number,
            _ => rho,
        };
        assert!((derived.rho[i] / expected - 1.0).abs() < 1e-13);
        // g from differences in H: (h/(d n) drho/dh) / (1 + h/(d n) dn/dh).
        let e = 1e-6;
        let slope = |f: &dyn Fn(usize, f64) -> f64| {
            (sum(reach * (1.0 + e), f) - sum(reach * (1.0 - e), f)) / (2.0 * e)
        };
        let n = sum(reach, &|_, w| w) * d as f64;
        let g = slope(&counted) / n / (1.0 + slope(&|_, w| w) / n);
        // What is summed, and g of y by the particle's own content likewise.
        let specific = |j: usize| hydro.eos.pressure(1.0, gas.rates.u_pred[j]);
        let (summand, content): (&dyn Fn(usize) -> f64, &dyn Fn(usize) -> f64) =
            match hydro.formulation {
                Formulation::Density => (&|j| p.m[j], &|j| p.m[j]),
                Formulation::Pressure => (&|j| p.m[j] * specific(j), &|j| p.m[j] * specific(j)),
                Formulation::Number => (&|_| 1.0, &|_| 1.0),
                Formulation::Smoothed => (&|j| p.m[j] * specific(j), &|j| p.m[j]),
            };
        let summed = match hydro.formulation {
            Formulation::Density => derived.rho[i],
            Formulation::Pressure | Formulation::Smoothed => derived.p[i],
            Formulation::Number => derived.rho[i] / p.m[i],
        };
        let all = sum(reach, &|j, w| counted(j, w) / p.m[j] * summand(j));
        assert!((summed / all - 1.0).abs() < 1e-13);
        let brought = |j: usize, w: f64| counted(j, w) / p.m[j] * content(j);
        let y = sum(reach, &brought);
        let g_y = slope(&brought) / n / (1.0 + slope(&|_, w| w) / n);
        assert!((derived.grad_h[i] * content(i) - g_y).abs() < 1e-8 * y / rho * p.m[i]);
        let gradient = |j: usize, r: Vec3| {
            let r_norm = r.norm().max(1e-300);
            (p.m[j] - g) * K::dw(r_norm, reach, d) / r_norm * r / rho
        };
        let (mut div, mut curl) = (0.0, Vec3::zeros());
        for &(j, r) in &near {
            div -= gradient(j, r).dot(&(v[j] - v[i]));
            curl -= gradient(j, r).cross(&(v[j] - v[i]));
        }
        assert!((derived.div_v[i] - div).abs() < 1e-7 * (1.0 + div.abs()));
        assert!((derived.curl_v[i] - curl.norm()).abs() < 1e-7 * (1.0 + curl.norm()));
        let speed = |&(j, r): &(usize, Vec3)| {
            let w = (v[j] - v[i]).dot(&r) / r.norm().max(1e-300);
            derived.cs[i] + derived.cs[j] - 3.0 * w.min(0.0)
        };
        let v_sig = near.iter().map(speed).fold(0.0, f64::max);
        assert!((derived.v_sig[i] / v_sig - 1.0).abs() < 1e-12);
    }
}

#[test]
fn sums_equal_those_over_all_pairs() {
    for axes in [[true; 3], [true, true, false]] {
        let domain = Domain::periodic(Vec3::repeat(1.0)).with_axes(axes);
        let mut hydro = hydro(domain);
        hydro.viscosity = Viscosity::Balsara {
            alpha: 1.0,
            beta: 2.0,
        };
        check_against_direct_sums::<WendlandC2>(&hydro);
        for formulation in Formulation::ALL {
            check_against_direct_sums::<WendlandC2>(&Hydro {
                formulation,
                ..hydro.clone()
            });
        }
        hydro.kernel = KernelKind::CubicSpline;
        hydro.neighbours *= 0.8;
        check_against_direct_sums::<CubicSpline>(&hydro);
        hydro.formulation = Formulation::Pressure;
        check_against_direct_sums::<CubicSpline>(&hydro);
        let disk = crate::Eos::of_disk(0.1, 1.0, 1.0, 0.25, 1.4);
        hydro.eos = disk;
        check_against_direct_sums::<CubicSpline>(&hydro);
    }
}

#[test]
fn a_lattice_has_its_density() {
    for (axes, n, expected, bar) in [
        ([true; 3], [8, 8, 8], 1.0, 0.02),
        ([true, true, false], [8, 8, 1], 1.0, 0.02),
    ] {
        let domain = Domain::periodic(Vec3::repeat(8.0)).with_axes(axes);
        let hydro = hydro(domain);
        let gas = settled(Gas::new(still(lattice(n, 1.0), 1.0, 1.0)), &hydro);
        for i in 0..gas.len() {
            let error = (gas.derived.rho[i] / expected - 1.0).abs();
            assert!(error < bar, "{axes:?}: {error}");
            assert!(gas.derived.div_v[i] == 0.0);
        }
    }
}

#[test]
fn a_lattice_has_its_density_under_each_kernel() {
    // Without the correction for what a particle counts too much of itself, C2, C4 and C6 would be out by 1.5e-2, 1.4e-3 and 3.8e-4.
    let expected = [
        (KernelKind::CubicSpline, 42.0, 6e-3),
        (KernelKind::QuinticSpline, 82.0, 1.2e-4),
        (KernelKind::WendlandC2, 64.0, 7e-3),
        (KernelKind::WendlandC4, 140.0, 4e-4),
        (KernelKind::WendlandC6, 220.0, 2e-4),
    ];
    for (kernel, neighbours, bar) in expected {
        let hydro = Hydro {
            kernel,
            neighbours,
            ..hydro(Domain::periodic(Vec3::repeat(10.0)))
        };
        let gas = settled(Gas::new(still(lattice([10; 3], 1.0), 1.0, 1.0)), &hydro);
        let error = gas.derived.rho[0] - 1.0;
        assert!(error.abs() < bar, "{kernel:?}: {error}");
    }
}

#[test]
fn stretched_gas_diverges_and_turning_gas_curls() {
    let (alpha, beta) = (1.0, 2.0);
    for viscosity in [
        Viscosity::Balsara { alpha, beta },
        Viscosity::CullenDehnen { alpha, beta },
    ] {
        check_linear_flow(&Hydro {
            viscosity,
            ..hydro(Domain::open())
        });
    }
}

fn check_linear_flow(hydro: &Hydro) {
    let mut particles = still(lattice([11; 3], 1.0), 1.0, 1.0);
    for (v, x) in particles.v.iter_mut().zip(&particles.x) {
        *v = 0.3 * x + Vec3::new(0.1, -0.2, 0.4).cross(x);
    }
    let gas = settled(Gas::new(particles), hydro);
    let middle = (0..gas.len())
        .find(|&i| gas.particles.x[i] == Vec3::repeat(5.5))
        .expect("a particle in the middle");
    // Exact for div v, where grad-h terms make d ln rho / dt exact on a lattice that stretches as a whole.
    assert!((gas.derived.div_v[middle] - 0.9).abs() < 1e-10);
    let curl = 2.0 * Vec3::new(0.1, -0.2, 0.4).norm();
    assert!((gas.derived.curl_v[middle] - curl).abs() < 1e-10);
    if let Some(trace) = gas.particles.trace_v.get(middle) {
        assert!((trace - 0.9).abs() < 1e-10);
    }
}

#[test]
fn the_velocity_gradient_changes_no_other_sum() {
    for axes in [[true; 3], [true, true, false]] {
        let domain = Domain::periodic(Vec3::repeat(1.0)).with_axes(axes);
        let without = hydro(domain);
        let with = Hydro {
            viscosity: Viscosity::CullenDehnen {
                alpha: 1.0,
                beta: 2.0,
            },
            ..without.clone()
        };
        let gas = noisy(&domain, 12, 0.5);
        let (without, with) = (settled(gas.clone(), &without), settled(gas, &with));
        assert_eq!(with.particles.h, without.particles.h);
        assert_eq!(with.derived.rho, without.derived.rho);
        assert_eq!(with.derived.grad_h, without.derived.grad_h);
        for i in 0..with.len() {
            let [a, b] = [&with, &without].map(|gas| gas.derived.div_v[i]);
            assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{a} {b}");
        }
    }
}

#[test]
fn few_and_lonely_particles_take_the_largest_smoothing_length() {
    let mut hydro = hydro(Domain::open());
    hydro.largest_h = 3.0;
    let gas = settled(Gas::new(still(vec![Vec3::zeros()], 1.0, 1.0)), &hydro);
    assert!(gas.particles.h[0] <= 3.0 && gas.derived.rho[0] > 0.0);
    assert_eq!(gas.derived.grad_h[0], 0.0);
    let pair = vec![Vec3::zeros(), Vec3::repeat(1.0)];
    let gas = settled(Gas::new(still(pair, 1.0, 1.0)), &hydro);
    assert_eq!(gas.particles.h, [3.0, 3.0]);
    hydro.largest_h = f64::INFINITY;
    let gas = settled(Gas::new(still(vec![Vec3::zeros()], 1.0, 1.0)), &hydro);
    assert!(gas.derived.rho[0] > 0.0);
    // One particle and its images are a lattice.
    hydro.domain = Domain::periodic(Vec3::repeat(1.0));
    let gas = settled(Gas::new(still(vec![Vec3::zeros()], 1.0, 1.0)), &hydro);
    assert!((gas.derived.rho[0] - 1.0).abs() < 0.02);
}

#[test]
fn heaps_in_one_place_and_lost_positions_are_faults() {
    let hydro = hydro(Domain::open());
    let mut heap = lattice([8; 3], 1.0);
    heap[3..40].fill(Vec3::zeros());
    let mut gas = Gas::new(still(heap, 1.0, 1.0));
    let fault = gas.density(&hydro, &NOW, Vec3::zeros());
    assert!(matches!(fault, Err(Fault::DensityNotConverged { .. })));
    let mut lost = lattice([8; 3], 1.0);
    lost[17].y = f64::NAN;
    let mut gas = Gas::new(still(lost, 1.0, 1.0));
    match gas.density(&hydro, &NOW, Vec3::zeros()) {
        Err(Fault::DensityNotConverged { id, .. }) => assert_eq!(id, 17),
        other => panic!("{other:?}"),
    }
}
