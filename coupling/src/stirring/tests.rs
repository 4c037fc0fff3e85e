//! Walks in a disk: what is mixed stays mixed in all directions, edges hold, motion relative to orbits is kept, and the bits.

use dust::{Dust, Superparticles};
use nbody::points::clock::TICKS;
use nbody::points::{Columns, Domain};

use super::*;
use crate::Unmetered;
use crate::external::Rotation;

/// A hot, narrow disk, which turbulence crosses soon.
const DISK: GasDisk = GasDisk {
    surface_density: 1.0,
    slope: -1.0,
    reference_radius: 1.0,
    aspect_ratio: 0.1,
    flaring: 0.25,
    inner_radius: 0.8,
    outer_radius: 1.2,
    rotation: Rotation::Pressure,
};

const SEED: u64 = 5;

/// Normal numbers and a uniform one.
fn numbers(id: u64) -> (Vec3, f64) {
    let mut random = stream(SEED, Purpose::DustPositions, id, 0);
    let gauss = Vec3::from_fn(|_, _| random.sample(StandardNormal));
    (gauss, random.random())
}

/// Grains spread as the gas is: as many between equal steps of R, since Sigma ~ 1/R.
fn system(n: u64) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    system.star.resize(1);
    system.star.m[0] = 1.0;
    let mut p = Superparticles::default();
    p.resize(n as usize);
    for i in 0..n as usize {
        let (gauss, u) = numbers(i as u64);
        let r = 0.8 + 0.4 * u;
        let height = DISK.aspect_ratio(r) * r;
        (p.id[i], p.m[i]) = (i as u64, 1e-9);
        p.x[i] = Vec3::new(r, 0.0, gauss.z * height);
        p.v[i] = Vec3::new(0.01, r.powf(-0.5), 0.02);
        (p.grain_radius[i], p.grain_density[i]) = (1.0, 1.0);
    }
    system.dust = Dust::new(p);
    system.look();
    system
}

/// Walks of everybody in steps of `dt`, without any other motion.
fn walk(system: &mut System, alpha: f64, steps: u64, dt: f64) {
    let law = StoppingLaw::ConstantStokes(1e-9);
    let mut stir = Stir::new(Strength::Given(alpha), law, Medium::Disk(DISK), SEED);
    for _ in 0..steps {
        system.next = system.clock.next_base(f64::INFINITY, dt);
        system.next.end = system.next.start + dt;
        stir.prepare(system, &mut Unmetered).expect("a step");
        system.dust.particles.span.fill(TICKS);
        stir.open(system, &mut Unmetered).expect("a step");
        system.clock = system.next;
        system.clock.tick = TICKS;
    }
}

#[test]
fn a_mixed_disk_stays_mixed_and_keeps_its_edges() {
    let n = 6000;
    let mut system = system(n);
    walk(&mut system, 0.3, 600, 0.1);
    let p = &system.dust.particles;
    let all = n as f64;
    let radius = |x: &Vec3| x.x.hypot(x.y);
    for k in 0..5 {
        let from = 0.8 + 0.08 * f64::from(k);
        let inside = |x: &&Vec3| from <= radius(x) && radius(x) < from + 0.08;
        let share = p.x.iter().filter(inside).count() as f64 / all;
        let errors = (share - 0.2) / (0.16 / all).sqrt();
        println!("from R = {from:.2}: {share:.4}, {errors:+.2} standard errors");
        assert!(errors.abs() < 3.0, "{from}: {share}");
    }
    let height = |x: &Vec3| x.z / (DISK.aspect_ratio(radius(x)) * radius(x));
    let square = p.x.iter().map(|x| height(x).powi(2)).sum::<f64>() / all;
    // Wider by alpha Omega dt / 2.
    let errors = (square / 1.015 - 1.0) / (2.0 / all).sqrt();
    println!("z^2/H^2 = {square:.4}: {errors:+.2} standard errors");
    assert!(errors.abs() < 3.0, "{square}");
    // Hardly anybody is where they were.
    let moved = (p.id.iter().zip(&p.x)).filter(|(id, x)| {
        let u = numbers(**id).1;
        (radius(x) - 0.8 - 0.4 * u).abs() > 0.05
    });
    let moved = moved.count() as f64 / all;
    assert!(moved > 0.6, "{moved}");
}

#[test]
fn a_walk_keeps_the_motion_relative_to_the_orbits_around() {
    let mut system = system(50);
    let circular = |x: Vec3| x.xy().norm().powf(-1.5) * Vec3::new(-x.y, x.x, 0.0);
    let own = |system: &System| -> Vec<Vec3> {
        let p = &system.dust.particles;
        (p.x.iter().zip(&p.v))
            .map(|(&x, &v)| v - circular(x))
            .collect()
    };
    let (before, places) = (own(&system), system.dust.particles.x.clone());
    walk(&mut system, 0.1, 1, 0.1);
    for (a, b) in before.iter().zip(own(&system)) {
        assert!((a - b).norm() < 1e-15, "{a} {b}");
    }
    // But for those whose walk would have led out of the disk.
    let now = &system.dust.particles.x;
    let moved = places.iter().zip(now).filter(|(x, y)| x != y).count();
    assert!(moved > 40, "{moved}");
    assert_eq!(system.dust.particles.v, system.dust.rates.v_pred);
}

#[test]
fn what_a_walk_changes_is_booked() {
    let mut system = system(200);
    let potential = |system: &System| -> f64 {
        let p = &system.dust.particles;
        p.x.iter().zip(&p.m).map(|(x, m)| -m / x.norm()).sum()
    };
    for (gravity, x) in system
        .dust
        .rates
        .gravity
        .iter_mut()
        .zip(&system.dust.particles.x)
    {
        *gravity = -x / x.norm().powi(3);
    }
    let census = crate::ledger::Census::scaled(&system);
    let start = potential(&system);
    system.ledger.open(census, start);
    walk(&mut system, 0.1, 1, 0.1);
    let now = crate::ledger::Census::scaled(&system);
    let moved = (now.sum().angular_momentum - census.sum().angular_momentum).norm();
    assert!(moved > 1e-4 * census.sum().angular_scale, "{moved:e}");
    let report = (system.ledger).report(0.1, now, potential(&system), &system.domain);
    for error in [
        report.error_momentum,
        report.error_angular_momentum,
        report.error_energy,
    ] {
        assert!(error.abs() < 1e-13, "{report:?}");
    }
}

#[test]
fn walks_depend_on_grain_and_tick_alone() {
    let end = |threads: usize, order: fn(&mut System)| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("a pool").install(|| {
            let mut system = system(300);
            order(&mut system);
            walk(&mut system, 0.1, 3, 0.1);
            let p = &system.dust.particles;
            let mut places: Vec<(u64, [u64; 3])> = (p.id.iter().zip(&p.x))
                .map(|(&id, x)| (id, [x.x.to_bits(), x.y.to_bits(), x.z.to_bits()]))
                .collect();
            places.sort_unstable();
            places
        })
    };
    let one = end(1, |_| {});
    let sorted = end(1, |system| system.dust.sort());
    assert!(end(2, |_| {}) == one && end(7, |_| {}) == one && sorted == one);
}
