//! The leapfrog's drift: straight lines, x' = x + v dt. All forces, the star's too, belong to the kick.

use rayon::prelude::*;

use super::Ahead;
use crate::bodies::Bodies;
use crate::points::Vec3;
use crate::points::sum::CHUNK;

/// Moves `bodies` (star or others) by `dt`.
pub fn drift(bodies: &mut Bodies, dt: f64) {
    advance(&mut bodies.x, &bodies.v, dt);
}

/// Positions and velocities `dt` from now, into `ahead`; the bodies stay where they are.
pub fn predict(star: &Bodies, bodies: &Bodies, dt: f64, ahead: &mut Ahead) {
    ahead.v_star = star.v.first().copied().unwrap_or_default();
    ahead.x_star = star.x.first().copied().unwrap_or_default() + ahead.v_star * dt;
    ahead.x.clone_from(&bodies.x);
    ahead.v.clone_from(&bodies.v);
    advance(&mut ahead.x, &bodies.v, dt);
}

fn advance(x: &mut [Vec3], v: &[Vec3], dt: f64) {
    x.par_iter_mut()
        .zip(v)
        .with_min_len(CHUNK)
        .for_each(|(x, v)| *x += v * dt);
}

#[cfg(test)]
mod tests {
    use super::super::problems::{energy, planet, sun};
    use super::super::{central, kick};
    use super::*;

    /// Kick, drift, kick of a star and bodies that pull the star but not each other.
    fn step(star: &mut Bodies, bodies: &mut Bodies, dt: f64) {
        let kicks = |star: &mut Bodies, bodies: &mut Bodies| {
            bodies.a.fill(Vec3::zeros());
            central::pull(1.0, star, &bodies.x, &mut bodies.a);
            star.a[0] = central::reaction(1.0, star, &bodies.m, &bodies.x);
            kick(&mut bodies.v, &bodies.a, 0.5 * dt);
            kick(&mut star.v, &star.a, 0.5 * dt);
        };
        kicks(star, bodies);
        drift(star, dt);
        drift(bodies, dt);
        kicks(star, bodies);
    }

    #[test]
    fn two_bodies_converge_at_second_order_and_keep_their_momentum() {
        let error = |steps: usize| {
            let (mut star, mut bodies) = (sun(1.0), planet(0.3, 1.0, 0.2));
            let start = energy(1.0, &star, &bodies);
            let momentum = bodies.v[0] * bodies.m[0];
            for _ in 0..steps {
                step(&mut star, &mut bodies, 2.0 / steps as f64);
            }
            let now = bodies.v[0] * bodies.m[0] + star.v[0] * star.m[0];
            assert!((now - momentum).norm() < 1e-14);
            (energy(1.0, &star, &bodies) / start - 1.0).abs()
        };
        let order = (error(100) / error(200)).log2();
        assert!((order - 2.0).abs() < 0.05, "order {order}");
    }

    #[test]
    fn prediction_is_the_drift_without_the_change() {
        let (star, mut bodies) = (Bodies::default(), planet(0.3, 1.0, 0.2));
        let mut ahead = Ahead::default();
        predict(&star, &bodies, 0.3, &mut ahead);
        drift(&mut bodies, 0.3);
        assert_eq!((ahead.x, ahead.v), (bodies.x, bodies.v));
    }
}
