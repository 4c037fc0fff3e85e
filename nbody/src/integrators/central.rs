//! The star's pull on a set of points, and theirs on the star: a = -G M d/(d^2 + eps^2)^(3/2), eps the star's softening.

use rayon::prelude::*;

use crate::bodies::Bodies;
use crate::points::Vec3;
use crate::points::sum::{self, CHUNK};

/// Adds the star's pull at positions `x` to accelerations `a`. Without a star nothing is added.
pub fn pull(g: f64, star: &Bodies, x: &[Vec3], a: &mut [Vec3]) {
    assert_eq!(x.len(), a.len(), "an acceleration a point");
    for ((&centre, &m), &softening) in star.x.iter().zip(&star.m).zip(&star.softening) {
        a.par_iter_mut()
            .zip(x)
            .with_min_len(CHUNK)
            .for_each(|(a, x)| *a -= towards(x - centre, softening) * (g * m));
    }
}

/// Acceleration of the star by masses `m` at `x`, the exact opposite of [`pull`] in momentum. Zero without a star.
pub fn reaction(g: f64, star: &Bodies, m: &[f64], x: &[Vec3]) -> Vec3 {
    assert_eq!(x.len(), m.len(), "a mass a point");
    let (Some(&centre), Some(&softening)) = (star.x.first(), star.softening.first()) else {
        return Vec3::zeros();
    };
    g * sum::ordered(x.len(), Vec3::zeros(), |range| {
        range.fold(Vec3::zeros(), |sum, i| {
            sum + towards(x[i] - centre, softening) * m[i]
        })
    })
}

/// The star's potential at `x`. Zero without a star.
pub fn potential(g: f64, star: &Bodies, x: Vec3) -> f64 {
    star.x
        .iter()
        .zip(&star.m)
        .zip(&star.softening)
        .map(|((centre, m), eps)| -g * m / ((x - centre).norm_squared() + eps * eps).sqrt())
        .sum()
}

/// d/(d^2 + eps^2)^(3/2); no direction, no pull at the very centre.
fn towards(d: Vec3, softening: f64) -> Vec3 {
    let q2 = d.norm_squared() + softening * softening;
    if q2 > 0.0 {
        d / (q2 * q2.sqrt())
    } else {
        Vec3::zeros()
    }
}

#[cfg(test)]
mod tests {
    use super::super::problems::sun;
    use super::*;

    #[test]
    fn the_pull_is_the_slope_of_the_potential() {
        let mut star = sun(2.0);
        star.softening[0] = 0.3;
        let x = Vec3::new(0.4, -0.5, 0.2);
        let mut a = [Vec3::zeros()];
        pull(1.5, &star, &[x], &mut a);
        for axis in 0..3 {
            let mut step = Vec3::zeros();
            step[axis] = 1e-5;
            let slope = (potential(1.5, &star, x + step) - potential(1.5, &star, x - step)) / 2e-5;
            assert!((a[0][axis] + slope).abs() < 1e-9);
        }
    }

    #[test]
    fn pull_and_reaction_balance_for_any_number_of_threads() {
        let star = sun(1.0);
        let f = |i: u32, k: f64| (f64::from(i) * k).fract() - 0.5;
        let x: Vec<Vec3> = (1..5000)
            .map(|i| Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051)))
            .collect();
        let m: Vec<f64> = (1..5000).map(|i| 1e-4 * (1.0 + f(i, 0.236_068))).collect();
        let mut a = vec![Vec3::zeros(); x.len()];
        pull(1.0, &star, &x, &mut a);
        let pulled: Vec3 = a.iter().zip(&m).map(|(a, m)| a * *m).sum();
        let size: f64 = a.iter().zip(&m).map(|(a, m)| a.norm() * m).sum();
        let reaction = reaction(1.0, &star, &m, &x);
        assert!((pulled + reaction).norm() < 1e-14 * size);
    }

    #[test]
    fn at_the_very_centre_nothing_pulls() {
        let mut a = [Vec3::x()];
        pull(1.0, &sun(1.0), &[Vec3::zeros()], &mut a);
        assert_eq!(a[0], Vec3::x());
    }
}
