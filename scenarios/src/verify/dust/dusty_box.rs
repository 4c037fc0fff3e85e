//! Dusty box: uniform gas at rest and dust that moves through it in a periodic box.
//!
//! Linear drag: u(t) = u(0) exp(-K (1/rho_g + 1/rho_d) t), the same for every particle, as both are on lattices of one spacing.
//! Errors are the largest of any particle's velocity, by the first relative velocity. Source: Laibe & Price 2011 (MNRAS 418, 1491).

use nbody::points::Vec3;

use super::{Bar, Mixture, Row, Trial, mixtures};

const STOPS: [f64; 5] = [0.0, 0.05, 0.2, 1.0, 5.0];

/// K, density of the dust.
const CASES: [[f64; 2]; 5] = [
    [1.0, 1.0],
    [10.0, 0.01],
    [0.1, 100.0],
    [1e12, 1.0],
    [1e-12, 1.0],
];

/// Of the lattice of grains from that of the gas.
const SHIFT: Vec3 = Vec3::new(0.017, 0.041, 0.029);

fn trial([k, rho]: [f64; 2]) -> Trial {
    let text = format!(
        "[run]\nend_time = 5\ntime_step = 0.05\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[gas.eos]\ngamma = 1.6666666666666667\n\
         [[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nlattice = \"cubic\"\nspacing = 0.125\ndensity = 1\npressure = 1\n\
         [[dust.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nlattice = \"cubic\"\nspacing = 0.125\ndensity = {rho}\nvelocity = [1, 0, 0]\n\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {:e}\n",
        rho / k
    );
    Trial::prepared(&text, &[], |_, dust| {
        dust.x.iter_mut().for_each(|x| *x += SHIFT)
    })
    .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
}

/// Largest error of any velocity where gas and dust have these.
fn error(mixture: &Mixture, gas: f64, dust: f64) -> f64 {
    let worst = |states: &[super::State], v: f64| {
        let errors = states.iter().map(|s| (s.v - Vec3::new(v, 0.0, 0.0)).norm());
        errors.fold(
            0.0,
            |worst: f64, e| if e > worst || e.is_nan() { e } else { worst },
        )
    };
    worst(&mixture.gas, gas).max(worst(&mixture.dust, dust))
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for case in CASES {
        let [k, rho] = case;
        let seen = mixtures(trial(case), &STOPS);
        let mean = rho / (1.0 + rho);
        let worst = STOPS
            .iter()
            .zip(&seen)
            .fold(0.0, |worst: f64, (t, mixture)| {
                let u = (-k * (1.0 + 1.0 / rho) * t).exp();
                worst.max(error(mixture, mean - mean * u, mean + (1.0 - mean) * u))
            });
        let books = &seen[seen.len() - 1].books;
        let what = format!("K {k:e}, dust to gas {rho}");
        rows.extend([
            Row::new(
                format!("{what}: velocities"),
                worst,
                Bar::Limit([1e-6, 1e-3]),
            ),
            Row::new(
                format!("{what}: momentum"),
                books.error_momentum,
                Bar::Limit([1e-13, 1e-10]),
            ),
            Row::new(
                format!("{what}: energy"),
                books.error_energy,
                Bar::Limit([1e-12, 1e-3]),
            ),
        ]);
    }
    rows
}
