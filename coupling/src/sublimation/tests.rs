//! Sublimation among scattered grains and gas: what is kept, what gets hot, and drag that comes after it.

use std::f64::consts::TAU;

use dust::{Dust, Superparticles};
use gas::Particles;
use nbody::points::{Columns, Domain};

use super::*;
use crate::Unmetered;
use crate::drag::{DustDrag, StoppingLaw};
use crate::ledger::{Census, Totals};

/// Water that is saturated at 0.01 where the isothermal sound speed is one.
fn phases(heat_share: f64) -> Phases {
    Phases {
        water: Water {
            ice: 1.0,
            gas_constant: TAU,
            saturation: [(0.01 * TAU).ln(), 0.0, 0.0, 0.0],
        },
        materials: Materials([1.0, 3.0, 8.0]),
        kelvins: 1.0,
        neighbours: 40.0,
        heat_share,
    }
}

/// Quasi-random points in the cube [offset, offset + side).
fn scattered(n: usize, side: f64, offset: f64) -> Vec<Vec3> {
    let f = |i: usize, k: f64| (i as f64 * k).fract() * side + offset;
    (0..n)
        .map(|i| Vec3::new(f(i, 0.819_172_5), f(i, 0.671_043_6), f(i, 0.549_700_5)))
        .collect()
}

/// 4096 gas particles in a cube of unit density, half of them dry and half of them steamy, and grains of three sizes in and around it.
fn system() -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    let x = scattered(4096, 1.0, 0.0);
    let mut gas = Particles {
        id: (0..4096).collect(),
        v: x.iter().map(|x| Vec3::new(x.y, -x.x, x.z.sin())).collect(),
        vapour: x
            .iter()
            .map(|x| if x.x < 0.5 { 0.0 } else { 0.05 })
            .collect(),
        h: vec![0.1; 4096],
        x,
        ..Particles::default()
    };
    gas.resize(4096);
    gas.m.fill(1.0 / 4096.0);
    gas.u.fill(1.5);
    system.gas = Gas::new(gas);
    system.gas.derived.rho.fill(1.0);
    system.gas.derived.p.fill(1.0);
    system.gas.rates.dv_open.fill(Vec3::new(1.0, 2.0, 3.0));
    let x = scattered(700, 1.2, -0.1);
    let mut dust = Superparticles {
        v: x.iter().map(|x| 2.0 * x + Vec3::x()).collect(),
        grain_radius: (0..700).map(|i| [1e-3, 2e-3, 5e-3][i % 3]).collect(),
        composition: (0..700)
            .map(|i| [Vec3::new(0.5, 0.3, 0.2), Vec3::y()][i % 2])
            .collect(),
        id: (0..700).collect(),
        x,
        ..Superparticles::default()
    };
    dust.resize(700);
    dust.m.fill(0.05 / 700.0);
    let materials = phases(1.0).materials;
    dust.grain_density = dust
        .composition
        .iter()
        .map(|&c| materials.density(c))
        .collect();
    system.dust = Dust::new(dust);
    system.next = system.clock.next_base(0.2, 0.2);
    system
}

fn vapour(system: &System) -> f64 {
    let p = &system.gas.particles;
    p.m.iter().zip(&p.vapour).map(|(m, f)| m * f).sum()
}

fn ice(system: &System) -> f64 {
    let p = &system.dust.particles;
    p.m.iter().zip(&p.composition).map(|(m, f)| m * f.x).sum()
}

fn totals(system: &System) -> [Totals; 2] {
    let census = Census::of(system);
    [census.0[0], census.0[1]]
}

/// The same system after the first half of a step, with what the sums were before.
fn opened(heat_share: f64) -> (System, [Totals; 2]) {
    let mut system = system();
    let before = totals(&system);
    let mut sublimate = Sublimate::new(phases(heat_share));
    // At rest on the clock there is no step to close, only gas to be found.
    sublimate
        .close(&mut system, &mut Unmetered)
        .expect("a step");
    sublimate.open(&mut system, &mut Unmetered).expect("a step");
    (system, before)
}

#[test]
fn mass_momentum_and_energy_are_kept() {
    for heat_share in [0.0, 1.0] {
        let (start, (system, before)) = (system(), opened(heat_share));
        let (after, sum) = (totals(&system), before[0] + before[1]);
        let change = after[0] + after[1] - sum;
        // Half of the gas takes, and half of it gives.
        let lost = before[1].mass - after[1].mass;
        assert!(
            lost < -5e-3
                && system
                    .gas
                    .particles
                    .vapour
                    .iter()
                    .any(|&f| (1e-3..0.01).contains(&f))
        );
        // Nine units of the last place of the sum, which is one of 1700 masses.
        assert!(change.mass.abs() < 2e-15, "{:e}", change.mass);
        assert!(change.momentum.norm() < 1e-14, "{}", change.momentum);
        let turned = change.angular_momentum.norm();
        assert!(turned < 1e-14, "{turned:e}");
        let energy = change.kinetic + change.internal + system.ledger.radiated;
        assert!(energy.abs() < 1e-14, "{energy:e}");
        assert!(change.kinetic < -1e-4);
        // Water is in either, and no other kind has changed.
        let water = vapour(&system) + ice(&system) - vapour(&start) - ice(&start);
        assert!(water.abs() < 1e-15, "{water:e}");
        let moved = ice(&start) - ice(&system) - lost;
        assert!(moved.abs() < 1e-15, "{moved:e}");
    }
}

#[test]
fn swarms_keep_their_number_and_their_cores() {
    let (start, (system, _)) = (system(), opened(1.0));
    let materials = phases(1.0).materials;
    let place = |system: &System, id: u64| {
        let ids = &system.dust.particles.id;
        ids.iter().position(|&other| other == id).expect("a grain")
    };
    let (old, new) = (&start.dust.particles, &system.dust.particles);
    for id in 0..700 {
        let (i, k) = (place(&start, id), place(&system, id));
        let (f, g) = (old.composition[i], new.composition[k]);
        let number = |p: &Superparticles, i: usize| {
            p.m[i] / (p.grain_density[i] * p.grain_radius[i].powi(3))
        };
        let error = number(new, k) / number(old, i) - 1.0;
        assert!(error.abs() < 1e-13, "{id}: {error:e}");
        assert!((g.sum() - 1.0).abs() < 1e-15 && g.min() >= 0.0);
        for kind in [1, 2] {
            let error = new.m[k] * g[kind] - old.m[i] * f[kind];
            assert!(error.abs() < 1e-18, "{id}: {error:e}");
        }
        let error =
            new.grain_radius[k] * materials.core(g) - old.grain_radius[i] * materials.core(f);
        assert!(error.abs() < 1e-17, "{id}: {error:e}");
    }
    assert!(system.gas.particles.vapour.iter().all(|&f| f >= 0.0));
}

#[test]
fn impulses_that_open_steps_stay_what_they_are() {
    let (start, (system, _)) = (system(), opened(1.0));
    let impulse = |system: &System| -> Vec3 {
        let (p, rates) = (&system.gas.particles, &system.gas.rates);
        p.m.iter().zip(&rates.dv_open).map(|(m, dv)| *m * dv).sum()
    };
    let error = (impulse(&system) - impulse(&start)).norm();
    assert!(error < 1e-14, "{error:e}");
}

#[test]
fn drag_after_it_knows_the_new_masses() {
    let mut system = system();
    let law = StoppingLaw::ConstantStoppingTime(0.03);
    let hydro = gas::Hydro {
        neighbours: 40.0,
        ..gas::Hydro::new(Domain::open(), gas::Eos::Ideal { gamma: 5.0 / 3.0 })
    };
    let mut drag = DustDrag::new(law, &hydro, true, 1.0);
    let mut sublimate = Sublimate::new(phases(1.0));
    drag.prepare(&mut system, &mut Unmetered).expect("a step");
    sublimate
        .close(&mut system, &mut Unmetered)
        .expect("a step");
    let before = totals(&system);
    sublimate.open(&mut system, &mut Unmetered).expect("a step");
    system
        .dust
        .rates
        .next_span
        .fill(nbody::points::clock::TICKS);
    drag.open(&mut system, &mut Unmetered).expect("a step");
    let after = totals(&system);
    let change = after[0] + after[1] - before[0] - before[1];
    let moved = (after[1].momentum - before[1].momentum).norm();
    assert!(moved > 1e-2, "{moved:e}");
    assert!(change.momentum.norm() < 1e-14, "{}", change.momentum);
}

#[test]
fn rooms_between_saturated_gas_and_ice_stay_as_they_are() {
    let mut system = system();
    system.gas.particles.vapour.fill(0.01);
    let old = system.dust.particles.m.clone();
    let mut sublimate = Sublimate::new(phases(1.0));
    sublimate
        .close(&mut system, &mut Unmetered)
        .expect("a step");
    sublimate.open(&mut system, &mut Unmetered).expect("a step");
    let change = (old.iter().zip(&system.dust.particles.m)).map(|(a, b)| (a - b).abs());
    assert!(change.fold(0.0, f64::max) < 1e-18);
}
