//! Tests of the direct sum of the Gauss-Radau drift.

use nbody::points::{Columns, Domain};

use super::*;

fn system(masses: &[f64]) -> System {
    let mut system = System::new(Domain::open(), 1.0, 0.0);
    system.star.resize(1);
    system.star.m[0] = 1.0;
    system.bodies.resize(masses.len());
    for (i, &m) in masses.iter().enumerate() {
        let angle = 0.7 * i as f64;
        system.bodies.m[i] = m;
        system.bodies.x[i] =
            Vec3::new(angle.cos(), angle.sin(), 0.1 * angle) * (1.0 + 0.3 * i as f64);
        system.bodies.softening[i] = 0.01 * i as f64;
    }
    system
}

/// a_i = sum_j m_j (x_j - x_i) / (r^2 + eps_i^2 + eps_j^2)^(3/2), written anew.
#[test]
fn the_direct_sum_is_newtons_for_masses_and_test_particles_in_any_order() {
    let system = system(&[0.0, 1e-3, 0.0, 2e-4, 0.0, 5e-4]);
    let x: Vec<Vec3> = [&system.star.x[..], &system.bodies.x[..]].concat();
    let m: Vec<f64> = [&system.star.m[..], &system.bodies.m[..]].concat();
    let eps: Vec<f64> = [&system.star.softening[..], &system.bodies.softening[..]].concat();
    let mut a = vec![Vec3::zeros(); x.len()];
    Pairs::of(&system).add(&x, &mut a);
    for i in 0..x.len() {
        let others = (0..x.len()).filter(|&j| j != i);
        let wanted: Vec3 = others
            .map(|j| {
                let d = x[j] - x[i];
                let r2 = d.norm_squared() + eps[i].powi(2) + eps[j].powi(2);
                m[j] * d / r2.powf(1.5)
            })
            .sum();
        let error = (a[i] - wanted).norm() / wanted.norm();
        assert!(error < 1e-13, "{i}: {error:e}");
    }
}

#[test]
fn test_particles_cost_their_number_times_that_of_the_masses() {
    let mut masses = vec![0.0; 1000];
    masses[10] = 1e-3;
    masses[500] = 1e-4;
    let pairs = Pairs::of(&system(&masses));
    // Star and two planets: three pairs among them, three pulls on each of 998 others.
    assert_eq!(pairs.interactions(), 3 + 3 * 998);
    assert_eq!((pairs.massive.len(), pairs.massless.len()), (3, 998));
}
