//! Sedov's blast in space: an energy of one in a point of cold gas of density 1, gamma = 5/3, at t = 0.05.
//!
//! R = (E t^2 / (a rho))^(1/5), a = 0.4936; rho = 4 at the front. 265 302 particles on a body-centred lattice; the energy is given to the 32
//! nearest to a particle-free centre of symmetry and those as near as the last of them. The front is where means over shells fall to the
//! middle between their highest and 1, over the whole sphere and within 18 degrees of the axes and of the diagonals of the box.
//! The profile inside solves the similarity equations. Sources: Sedov (1959); Landau & Lifshitz, Fluid Mechanics, section 106.

use std::f64::consts::PI;

use gas::Particles;
use nbody::points::Vec3;

use super::picture::{Profile, profiles};
use super::tube::front;
use super::{Bar, End, Row, Scheme};

const TIME: f64 = 0.05;
const GAMMA: f64 = 5.0 / 3.0;
/// Cells a side; odd, so that the middle of the box is the middle of a cell.
const CELLS: u32 = 51;
/// Particles that the energy is given to, and those as near as the last.
const HOT: usize = 32;
/// Shells of radii below a half.
const SHELLS: usize = 50;

fn scene(cells: u32) -> String {
    format!(
        "[run]\nend_time = {TIME}\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         [[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nlattice = \"bcc\"\nspacing = {}\ndensity = 1\ninternal_energy = 1e-6\n\
         [gas.eos]\ngamma = {GAMMA}\n",
        0.5f64.cbrt() / f64::from(cells)
    )
}

fn from_middle(x: Vec3) -> Vec3 {
    x - Vec3::repeat(0.5)
}

fn start(gas: &mut Particles) {
    let mut distances: Vec<f64> = gas.x.iter().map(|x| from_middle(*x).norm()).collect();
    distances.sort_unstable_by(f64::total_cmp);
    let last = distances[HOT - 1] * (1.0 + 1e-9);
    let number = distances.iter().filter(|d| **d <= last).count() as f64;
    for i in 0..gas.x.len() {
        if from_middle(gas.x[i]).norm() <= last {
            gas.u[i] = 1.0 / (number * gas.m[i]);
        }
    }
}

/// Highest mean density of a shell and radius of the front, over the directions that `is_seen` says.
fn shock(end: &End, is_seen: impl Fn(Vec3) -> bool) -> (f64, f64) {
    let place = |d: Vec3| if is_seen(d) { 2.0 * d.norm() } else { -1.0 };
    let shells = end.binned(SHELLS, |p| place(from_middle(p.x)), |p| p.rho);
    let middle = |k: usize| 0.5 * (k as f64 + 0.5) / SHELLS as f64;
    let shells: Vec<_> = (shells.into_iter().enumerate())
        .map(|(k, rho)| (middle(k), rho))
        .filter(|(_, rho)| rho.is_finite())
        .collect();
    front(&shells, 1.0)
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let end = scheme.end(&scene(CELLS), TIME, start);
    let blast = Blast::new(GAMMA);
    let radius = blast.radius(TIME);
    profiles(scheme, "gas-sedov", "Sedov's blast", || {
        let points = end.gas.iter().map(|p| (from_middle(p.x).norm(), p.rho));
        let mut exact: Vec<_> = (blast.profile.iter())
            .map(|&(lambda, rho)| (lambda * radius, rho))
            .collect();
        exact.reverse();
        exact.extend([(radius, 1.0), (0.5, 1.0)]);
        vec![Profile {
            axes: ["r", "density"],
            points: points.filter(|(r, _)| *r < 0.5).collect(),
            exact,
        }]
    });
    let near = |d: Vec3, cosine: f64| cosine > 18f64.to_radians().cos() * d.norm();
    let (peak, all) = shock(&end, |_| true);
    let (_, axes) = shock(&end, |d| near(d, d.amax()));
    let (_, diagonals) = shock(&end, |d| near(d, d.abs().sum() / 3f64.sqrt()));
    vec![
        Row::new(
            "radius of the front, error",
            all / radius - 1.0,
            Bar::Limit([0.01, 0.03]),
        ),
        Row::new(
            "highest density by the exact one",
            peak / 4.0,
            Bar::Least([0.75, 0.5]),
        ),
        Row::new(
            "error of the energy",
            end.books.error_energy.abs(),
            Bar::Limit([1e-3, 1e-2]),
        ),
        Row::new(
            "front along the axes by that along the diagonals, less one",
            axes / diagonals - 1.0,
            Bar::Limit([0.01, 0.03]),
        ),
    ]
}

/// The similarity solution in space: with lambda = r/R, v = (2/5)(r/t) V, rho = G, c^2 = ((2/5) r/t)^2 Z.
struct Blast {
    /// E t^2 / (rho R^5)
    a: f64,
    /// (lambda, rho), inwards.
    profile: Vec<(f64, f64)>,
}

impl Blast {
    /// Integrated inwards from the front in s = ln(gamma V - 1), by the fourth-order Runge-Kutta scheme.
    fn new(gamma: f64) -> Self {
        let g = gamma;
        // Slopes in s of ln lambda, ln G and the integral of the energy.
        let slope = |s: f64, [ln_lambda, ln_g, _]: [f64; 3]| {
            let e = s.exp();
            let v = (1.0 + e) / g;
            let ahead = ((g - 1.0) * 3.0 * v - (5.0 - 2.0 * v)) / (1.0 - v);
            let pull = -1.0 / (1.0 - v) + 2.0 / v - g / e - (g - 1.0) / (1.0 - v);
            let dv = e / g;
            let d_lambda = dv * pull / ahead;
            let d_g = (dv + 3.0 * v * d_lambda) / (1.0 - v);
            let z = g * (g - 1.0) * (1.0 - v) * v * v / (2.0 * e);
            let energy = (ln_g + 5.0 * ln_lambda).exp() * (0.5 * v * v + z / (g * (g - 1.0)));
            [d_lambda, d_g, -energy * d_lambda]
        };
        let plus = |w: [f64; 3], k: [f64; 3], h: f64| [0, 1, 2].map(|i| w[i] + h * k[i]);
        let (steps, first) = (9000, (2.0 * g / (g + 1.0) - 1.0).ln());
        let h = -60.0 / f64::from(steps);
        let mut w = [0.0, ((g + 1.0) / (g - 1.0)).ln(), 0.0];
        let mut profile = vec![(1.0, w[1].exp())];
        for n in 0..steps {
            let s = first + h * f64::from(n);
            let k1 = slope(s, w);
            let k2 = slope(s + 0.5 * h, plus(w, k1, 0.5 * h));
            let k3 = slope(s + 0.5 * h, plus(w, k2, 0.5 * h));
            let k4 = slope(s + h, plus(w, k3, h));
            w = [0, 1, 2].map(|i| w[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
            profile.push((w[0].exp(), w[1].exp()));
        }
        Self {
            a: 0.16 * 4.0 * PI * w[2],
            profile,
        }
    }

    /// R of an energy of one in gas of density one.
    fn radius(&self, t: f64) -> f64 {
        (t * t / self.a).powf(0.2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_similarity_solution_is_that_of_published_tables() {
        // Kamm & Timmes (2007): 0.851072 for gamma = 1.4.
        for (gamma, a) in [(5.0 / 3.0, 0.493_590_149_582), (1.4, 0.851_071_851_809)] {
            let blast = Blast::new(gamma);
            assert!((blast.a / a - 1.0).abs() < 1e-8, "{gamma}: {}", blast.a);
            // All of the mass of the sphere is in the shell: 3 int rho lambda^2 d lambda = 1.
            let pairs = blast.profile.windows(2);
            let mass: f64 = pairs
                .map(|w| {
                    let [(b, rho), (a, other)] = [w[0], w[1]];
                    0.5 * (rho + other) * (b.powi(3) - a.powi(3))
                })
                .sum();
            assert!((mass - 1.0).abs() < 1e-4, "{gamma}: mass {mass}");
        }
        assert!((Blast::new(5.0 / 3.0).radius(0.05) - 0.347_467_912_334).abs() < 1e-9);
    }
}
