//! What is done with impulses and torques that no field should have.

use dust::Superparticles;
use nbody::points::Columns;

use super::*;

/// Grains of equal mass at `places`.
fn grains(places: &[Vec3]) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    let mut p = Superparticles::default();
    p.resize(places.len());
    p.x.copy_from_slice(places);
    p.m.fill(1e-12);
    system.dust = Dust::new(p);
    system
}

/// A torque beyond what its impulse at the origin's distance has, as rounding makes it.
const TORQUE: Vec3 = Vec3::new(1e-28, -2e-28, 1e-28);

#[test]
fn a_single_grain_is_not_turned_by_rounding() {
    let mut moved = 0.0f64;
    for k in 0..200 {
        let (sin, cos) = (0.37 * f64::from(k)).sin_cos();
        let mut system = grains(&[Vec3::new(cos, sin, 1e-3 * cos)]);
        system.stray.torque = TORQUE;
        system.recall_stray();
        moved = moved.max(system.dust.particles.v[0].norm());
    }
    assert_eq!(moved, 0.0);
}

#[test]
fn several_grains_take_up_a_torque_by_turning() {
    let places = [Vec3::x(), -Vec3::x(), Vec3::y(), Vec3::z()];
    let mut system = grains(&places);
    system.stray.torque = TORQUE;
    system.recall_stray();
    let p = &system.dust.particles;
    let taken: Vec3 = (0..4).map(|i| p.m[i] * p.x[i].cross(&p.v[i])).sum();
    assert!((taken + TORQUE).norm() < 1e-14 * TORQUE.norm(), "{taken}");
}
