//! Tests of `probe`.

use nbody::points::Columns;

use super::*;
use crate::Particles;

const REACH: Reach = Reach {
    neighbours: 64.0,
    largest: 10.0,
};

/// Gas of unit density at quasi-random places in the unit box, with velocities and pressures of a linear field.
fn gas(n: u32, axes: [bool; 3], flat: bool) -> Gas {
    let f = |i: u32, k: f64| (f64::from(i) * k).fract();
    let mut particles = Particles {
        x: (0..n)
            .map(|i| Vec3::new(f(i, 0.819_172_5), f(i, 0.671_043_6), f(i, 0.549_700_5)))
            .map(|x| if flat { Vec3::new(x.x, x.y, 0.0) } else { x })
            .collect(),
        ..Particles::default()
    };
    particles.resize(n as usize);
    particles.m.fill(1.0 / f64::from(n));
    for (v, x) in particles.v.iter_mut().zip(&particles.x) {
        *v = linear(Domain::open().with_axes(axes).in_plane(*x));
    }
    let mut gas = Gas::new(particles);
    gas.derived.rho.fill(1.0);
    gas.derived.p.fill(2.25);
    gas
}

fn linear(x: Vec3) -> Vec3 {
    Vec3::new(1.0 + x.y - 2.0 * x.z, 3.0 * x.x, 0.5 * x.x + x.y + x.z)
}

#[test]
fn a_linear_field_is_seen_exactly_and_the_density_is_that_of_the_gas() {
    for (axes, flat, bar) in [
        ([true; 3], false, 0.15),
        ([true, true, false], true, 0.15),
        ([true, true, false], false, 0.15),
    ] {
        let gas = gas(4000, axes, flat);
        let domain = Domain::open().with_axes(axes);
        let mut probe = Probe::default();
        for guess in [0.0, 0.01, 0.12, 3.0] {
            let x = Vec3::new(0.47, 0.61, 0.43);
            let sample = probe.sample(&gas, &domain, x, guess, &REACH);
            let error = (sample.v - linear(domain.in_plane(x))).norm();
            assert!(error < 1e-14, "{axes:?}: {error:e}");
            assert!((sample.rho - 1.0).abs() < bar, "{axes:?}: {}", sample.rho);
            assert!((sample.c - 1.5).abs() < 1e-14);
        }
    }
}

#[test]
fn the_smoothing_length_gives_the_wanted_number() {
    let gas = gas(4000, [true; 3], false);
    let x = Vec3::new(0.47, 0.61, 0.43);
    let sample = Probe::default().sample(&gas, &Domain::open(), x, 0.0, &REACH);
    // 64 neighbours of 4000 in the unit volume.
    let radius = (64.0 / 4000.0 * 3.0 / (4.0 * std::f64::consts::PI)).cbrt();
    let error = (sample.h * 15f64.sqrt() / 2.0 / radius - 1.0).abs();
    // Two per cent in the number, and the noise of 64 neighbours.
    assert!(error < 0.04, "{error}");
}

#[test]
fn a_periodic_lattice_looks_the_same_from_every_cell() {
    let n = 6;
    let mut particles = Particles {
        x: (0..n * n * n)
            .map(|i| Vec3::new((i % n) as f64, (i / n % n) as f64, (i / n / n) as f64))
            .collect(),
        ..Particles::default()
    };
    particles.resize(n * n * n);
    particles.m.fill(1.0);
    particles.v.fill(Vec3::new(1.0, 2.0, 3.0));
    let mut gas = Gas::new(particles);
    gas.derived.rho.fill(1.0);
    gas.derived.p.fill(1.0);
    let domain = Domain::periodic(Vec3::repeat(n as f64));
    let mut probe = Probe::default();
    let middle = probe.sample(&gas, &domain, Vec3::repeat(2.5), 1.3, &REACH);
    let corner = probe.sample(&gas, &domain, Vec3::repeat(5.5), 1.3, &REACH);
    assert!((middle.rho / corner.rho - 1.0).abs() < 1e-14);
    // A lattice of 64 neighbours carries the density to 1 %.
    assert!((corner.rho - 1.0).abs() < 0.01, "{}", corner.rho);
    assert!((corner.v - Vec3::new(1.0, 2.0, 3.0)).norm() < 1e-14);
}

#[test]
fn weights_and_impulses_are_adjoint_and_keep_angular_momentum_at_an_edge() {
    let gas = gas(4000, [true; 3], false);
    let (mut weights, mut candidates) = (Weights::default(), Candidates::default());
    let mut shapes = Vec::new();
    for x in [
        Vec3::new(0.5, 0.4, 0.5),
        Vec3::new(1.03, 0.5, 0.45),
        Vec3::new(1.1, 0.5, 0.45),
    ] {
        let reach = Reach {
            largest: 0.16,
            ..REACH
        };
        weights.find(&mut candidates, &gas, &Domain::open(), (x, 0.1), &reach);
        shapes.push(weights.shape);
        let spinning = |p: Vec3| Vec3::new(0.3, -1.0, 0.7).cross(&p);
        let seen = weights.vector(|j| spinning(gas.particles.x[j]));
        assert!((seen - spinning(x)).norm() < 1e-13, "{:?}", weights.shape);
        assert!((weights.weight.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
    assert_eq!(shapes[0], Shape::Linear);
    assert_eq!(shapes[2], Shape::Rigid);
}

#[test]
fn far_from_all_gas_and_without_any_there_is_none() {
    let some = gas(100, [true; 3], false);
    let mut probe = Probe::default();
    for gas in [&some, &Gas::default()] {
        let sample = probe.sample(gas, &Domain::open(), Vec3::repeat(100.0), 0.0, &REACH);
        assert_eq!((sample.rho, sample.v, sample.c), (0.0, Vec3::zeros(), 0.0));
    }
    // One lonely particle within reach.
    let one = gas(1, [true; 3], false);
    let sample = probe.sample(&one, &Domain::open(), Vec3::repeat(1.0), 0.0, &REACH);
    assert!(sample.rho > 0.0 && sample.v == one.particles.v[0]);
}

#[test]
fn gradients_of_linear_fields_are_exact_inside_and_at_an_edge() {
    let slope = Vec3::new(0.3, -0.5, 0.2);
    for axes in [[true; 3], [true, true, false], [true, false, true]] {
        let domain = Domain::open().with_axes(axes);
        let mut gas = gas(4000, axes, false);
        for i in 0..gas.len() {
            gas.derived.rho[i] = 2.0 + slope.dot(&domain.in_plane(gas.particles.x[i]));
        }
        let of = linear(Vec3::zeros());
        let column = |axis: usize| linear(Vec3::ith(axis, 1.0)) - of;
        for x in [Vec3::new(0.47, 0.61, 0.43), Vec3::new(0.01, 0.99, 0.98)] {
            let local = Probe::default().local(&gas, &domain, (x, 0.0), &REACH);
            for axis in 0..3 {
                let there = if axes[axis] { 1.0 } else { 0.0 };
                let error = local.grad_v.column(axis) - there * column(axis);
                assert!(error.norm() < 1e-11, "{axes:?} at {x}: {error}");
                assert!((local.grad_rho[axis] - there * slope[axis]).abs() < 1e-11);
            }
            if local.shape == Shape::Linear {
                let rho = 2.0 + slope.dot(&domain.in_plane(x));
                assert!((local.rho - rho).abs() < 1e-13, "{}", local.rho);
                assert!((local.v - linear(domain.in_plane(x))).norm() < 1e-13);
                assert!((local.p - 2.25).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn gas_in_a_plane_has_no_gradient_across_it() {
    let gas = gas(400, [true; 3], true);
    let local = Probe::default().local(&gas, &Domain::open(), (Vec3::repeat(0.5), 0.0), &REACH);
    assert!(local.grad_rho.x.is_nan() && local.grad_v[(0, 0)].is_nan());
}

#[test]
fn a_bundle_finds_the_weights_that_its_points_have_by_themselves() {
    let gas = gas(4000, [true; 3], false);
    let domain = Domain::open();
    let place = |k: usize| Vec3::new(0.45, 0.52, 0.4) + 0.01 * k as f64 * Vec3::new(1.0, -0.6, 0.3);
    // The last one is at an edge of the gas.
    let mut points: Vec<(Vec3, f64)> = (0..6).map(|k| (place(k), 0.08)).collect();
    points.push((Vec3::new(1.0, 0.52, 0.4), 0.08));
    let (mut candidates, mut own) = (Candidates::default(), Candidates::default());
    candidates.gather(&gas, &domain, Vec3::repeat(0.3), Vec3::repeat(1.0), 0.3);
    let (mut bundle, mut weights) = (Bundle::default(), Weights::default());
    let mut rows = Rows::default();
    bundle.enter(&candidates, 0.3);
    let served = bundle.fit(
        &candidates,
        &domain,
        (&points, 0.3),
        (&REACH, 4000),
        &mut rows,
    );
    assert_eq!(served, 0b11_1111);
    assert!(bundle.norm[6] == 0.0 && bundle.norm[7] == 0.0);
    let normed = |w: &Lanes| std::array::from_fn(|lane| w[lane] * bundle.norm[lane]);
    let weight: Vec<Lanes> = rows.weight().iter().map(normed).collect();
    for (lane, &point) in points[..6].iter().enumerate() {
        weights.find(&mut own, &gas, &domain, point, &REACH);
        // Newton's method ends where the number is right to 1e-6.
        assert!((bundle.h[lane] / weights.h - 1.0).abs() < 1e-6);
        assert!((bundle.rho[lane] / weights.rho - 1.0).abs() < 1e-6);
        let pairs = || rows.index().iter().zip(&weight);
        let sum: f64 = pairs().map(|(_, w)| w[lane]).sum();
        let field = |j: usize| linear(gas.particles.x[j]);
        let seen: Vec3 = pairs().map(|(&j, w)| w[lane] * field(j as usize)).sum();
        assert!((sum - 1.0).abs() < 1e-14, "{sum}");
        assert!((seen - linear(point.0)).norm() < 1e-14, "{seen}");
        let uneven = |j: usize| (9.0 * gas.particles.x[j].x).sin();
        let error = weights.scalar(uneven)
            - pairs()
                .map(|(&j, w)| w[lane] * uneven(j as usize))
                .sum::<f64>();
        assert!(error.abs() < 1e-6, "{error:e}");
    }
}
