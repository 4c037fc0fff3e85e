//! Gas at rest, dust and bodies that move through it in a periodic box: three components that exchange momentum through the gas.
//!
//! rho_i v_i' = sum_j K_ij (v_j - v_i) with densities 1, 0.3 and 0.05, K of gas and dust s, of gas and bodies 0.3 s, and none of dust and bodies, s
//! from 1e-12 to 1e12. With w_i = sqrt(rho_i) v_i the rates are a symmetric matrix; the exact velocities are its exponential. All stand on lattices
//! of one spacing, so that all particles of a component do the same. Bodies of a constant stopping time do not ask how large they are.
//! Source: Benitez-Llambay, Krapp & Pessah (2019), ApJS 241, 25.

use coupling::ledger::Report;
use nalgebra::{Matrix3, SymmetricEigen};
use nbody::points::Vec3;

use super::super::{Bar, Row};
use crate::trial::Trial;

const DENSITY: [f64; 3] = [1.0, 0.3, 0.05];
const START: [f64; 3] = [0.0, 1.0, -2.0];
/// K of the gas with dust and with bodies, by s.
const DRAG: [f64; 2] = [1.0, 0.3];
const SCALES: [f64; 5] = [1e-12, 1e-3, 1.0, 1e3, 1e12];

/// Steps in a unit of time, at the ends of which velocities are compared.
const STEPS: usize = 20;
/// Of the cubic lattices.
const EDGE: usize = 6;
/// Of the lattices of dust and bodies from that of the gas.
const SHIFT: [f64; 3] = [0.017, 0.041, 0.029];

/// Velocities after a time.
fn exact(s: f64, t: f64) -> [f64; 3] {
    let root = DENSITY.map(f64::sqrt);
    let mut rates = Matrix3::zeros();
    for (n, k) in [(1, DRAG[0]), (2, DRAG[1])] {
        rates[(0, 0)] += k / DENSITY[0];
        rates[(n, n)] += k / DENSITY[n];
        rates[(0, n)] -= k / (root[0] * root[n]);
        rates[(n, 0)] = rates[(0, n)];
    }
    let own = SymmetricEigen::new(rates);
    let slowest = own.eigenvalues.imin();
    let start = Vec3::from(std::array::from_fn(|n| root[n] * START[n]));
    let mut w = Vec3::zeros();
    for (k, mode) in own.eigenvectors.column_iter().enumerate() {
        // The common motion lasts.
        let rate = if k == slowest {
            0.0
        } else {
            own.eigenvalues[k]
        };
        w += (-rate * s * t).exp() * mode.dot(&start) * mode;
    }
    std::array::from_fn(|n| w[n] / root[n])
}

fn scene(s: f64, mixtures: bool) -> String {
    let n = EDGE.pow(3) as f64;
    let lattice = format!(
        "lo = [0, 0, 0]\nhi = [1, 1, 1]\nlattice = \"cubic\"\nspacing = {}\n",
        1.0 / EDGE as f64
    );
    let times = [DENSITY[1] / (DRAG[0] * s), DENSITY[2] / (DRAG[1] * s)];
    let place = |k: usize, axis: usize| (k as f64 + 0.5) / EDGE as f64 + SHIFT[axis];
    let bodies: String = (0..EDGE.pow(3))
        .map(|i| {
            let [x, y, z] = [i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE];
            format!(
                "[[planet]]\nmass = {}\nposition = [{}, {}, {}]\nvelocity = [{}, 0, 0]\n",
                DENSITY[2] / n,
                place(x, 0),
                place(y, 1),
                place(z, 2),
                START[2]
            )
        })
        .collect();
    format!(
        "[run]\nend_time = 1\ntime_step = {:?}\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         [[gas.block]]\n{lattice}density = {}\npressure = 1\n[gas.eos]\ngamma = 1.6666666666666667\n\
         [[dust.block]]\n{lattice}density = {}\nvelocity = [{}, 0, 0]\n\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {:e}\n\
         [planetesimals.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {:e}\n\
         [gravity]\nmethod = \"none\"\n[coupling]\nmixtures = {mixtures}\n{bodies}",
        1.0 / STEPS as f64,
        DENSITY[0],
        DENSITY[1],
        START[1],
        times[0],
        times[1],
    )
}

/// Largest error of a velocity, base steps, and the books at the end, where dust and bodies exchange at once or one after the other.
fn run(s: f64, at_once: bool) -> (f64, u64, Report) {
    let mut trial = Trial::new(&scene(s, at_once), &[], |_| {})
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let stops: Vec<f64> = (0..=STEPS).map(|k| k as f64 / STEPS as f64).collect();
    let (mut worst, mut steps, mut books) = (0.0f64, 0, None);
    let done = trial.run(&stops, |stop| {
        let system = stop.system;
        let want = exact(s, system.clock.time());
        let all: [&[Vec3]; 3] = [
            &system.gas.particles.v,
            &system.dust.particles.v,
            &system.bodies.v,
        ];
        for (v, want) in all.into_iter().zip(want) {
            for v in v {
                let error = (v - Vec3::new(want, 0.0, 0.0)).norm();
                worst = if error > worst || error.is_nan() {
                    error
                } else {
                    worst
                };
            }
        }
        steps = system.clock.step;
        books = Some(*stop.books);
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    (worst, steps, books.expect("a stop"))
}

fn of(s: f64) -> Vec<Row> {
    let (worst, steps, books) = run(s, true);
    let row = |what: &str, value, bar| Row::new(format!("K {s:e}: {what}"), value, bar);
    vec![
        row("velocities", worst, Bar::Limit([1e-10, 1e-3])),
        row("momentum", books.error_momentum, Bar::Limit([1e-14, 1e-10])),
        row("energy", books.error_energy, Bar::Limit([1e-12, 1e-3])),
        row("base steps", steps as f64, Bar::None),
    ]
}

pub fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = SCALES.into_iter().flat_map(of).collect();
    rows.extend([1.0, 1e3].map(|s| {
        let what = format!("K {s:e}, dust and bodies one after the other: velocities");
        Row::new(what, run(s, false).0, Bar::None)
    }));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_components_end_together_and_keep_their_momentum() {
        let momentum = |v: [f64; 3]| (0..3).map(|n| DENSITY[n] * v[n]).sum::<f64>();
        for t in [0.0, 1e-3, 0.3, 1e3] {
            assert!((momentum(exact(1.0, t)) - 0.2).abs() < 1e-14, "{t}");
        }
        // A short time moves each by its own rate.
        let [gas, dust, bodies] = exact(1.0, 1e-6);
        assert!((dust - (1.0 - 1e-6 / 0.3)).abs() < 1e-10);
        assert!((bodies - (-2.0 + 6.0 * 2e-6)).abs() < 1e-10);
        assert!((gas - (1.0 - 0.6) * 1e-6).abs() < 1e-10);
        let last = exact(1e12, 1.0);
        assert!(
            last.iter().all(|v| (v - 0.2 / 1.35).abs() < 1e-14),
            "{last:?}"
        );
    }

    #[test]
    fn an_exchange_of_three_components_is_exact() {
        for s in [1.0, 1e3, 1e12] {
            let (worst, steps, books) = run(s, true);
            // Rounding of some twenty steps; 2e-2 if dust and bodies exchange one after the other.
            assert!(worst < 1e-13, "{s:e}: {worst:e}");
            assert_eq!(steps, STEPS as u64);
            assert!(books.error_energy < 1e-13, "{:e}", books.error_energy);
        }
    }
}
