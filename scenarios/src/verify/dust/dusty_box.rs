//! Dusty box: uniform gas at rest and dust that moves through it in a periodic box.
//!
//! One kind of dust, relative velocity u, q = K (1/rho_g + 1/rho_d): linear u = u0 e^(-q t); quadratic u = u0 / (1 + q u0 t); Kwok's
//! u' = -q u sqrt(1 + a u^2): asinh(1 / (sqrt(a) u)) grows as q t. Several kinds: rho_i v_i' = sum K_ij (v_j - v_i), by the classical Runge-Kutta
//! method. Both are on lattices of one spacing, so that all particles of a kind do the same; errors are the largest of any particle's velocity, by that of the
//! dust at the start. Sources: Laibe & Price 2011 (MNRAS 418, 1491); Benitez-Llambay et al. 2019 (ApJS 241, 25).

use nbody::points::Vec3;

use super::{Bar, Mixture, Row, Trial, mixtures};

const STOPS: [f64; 4] = [0.0, 0.05, 0.2, 1.0];

/// Of the lattice of grains from that of the gas.
const SHIFT: Vec3 = Vec3::new(0.017, 0.041, 0.029);

/// 9 pi / 128, Kwok's a at c = 1.
const KWOK: f64 = 0.220_893_233_456;

/// A kind of dust: its density, velocity at the start, and its stopping time where the law is one of constant times, else its size.
type Kind = [f64; 3];

/// Kinds of dust and their law of drag; the gas has density 1.
struct Case {
    what: String,
    kinds: Vec<Kind>,
    drag: String,
    eos: &'static str,
    /// Good and acceptable errors of velocities.
    bars: [f64; 2],
    /// Velocities of gas and kinds at a time.
    exact: Box<dyn Fn(f64) -> Vec<f64>>,
}

const FREE: &str = "gamma = 1.6666666666666667";
const BOUND: &str = "kind = \"isothermal\"\nsound_speed = 1";

/// Velocities of both where their relative one is `u`.
fn shared(rho: f64, start: f64, u: f64) -> Vec<f64> {
    let mean = rho / (1.0 + rho) * start;
    vec![mean - rho / (1.0 + rho) * u, mean + u / (1.0 + rho)]
}

fn linear([k, rho]: [f64; 2]) -> Case {
    Case {
        what: format!("K {k:e}, dust to gas {rho}"),
        kinds: vec![[rho, 1.0, rho / k]],
        drag: "law = \"constant-stopping-time\"\nstopping_time = 1\n".into(),
        eos: FREE,
        bars: [1e-6, 1e-2],
        exact: Box::new(move |t| shared(rho, 1.0, (-k * (1.0 + 1.0 / rho) * t).exp())),
    }
}

fn quadratic() -> Case {
    Case {
        what: "quadratic drag".into(),
        kinds: vec![[1.0, 1.0, 1.0]],
        drag: "law = \"quadratic\"\ncoefficient = 1\n".into(),
        eos: FREE,
        bars: [1e-6, 1e-2],
        exact: Box::new(|t| shared(1.0, 1.0, 1.0 / (1.0 + 2.0 * t))),
    }
}

/// K = 1 and half as much dust as gas, at three times the speed of sound.
fn kwok() -> Case {
    let size = 0.5 * (8.0 / std::f64::consts::PI).sqrt();
    Case {
        what: "Epstein's law with Kwok's correction".into(),
        kinds: vec![[0.5, 3.0, size]],
        drag: "law = \"epstein\"\n".into(),
        eos: BOUND,
        bars: [1e-6, 1e-2],
        exact: Box::new(|t| {
            let root = (1.0 + KWOK * 9.0f64).sqrt();
            let c = (root - 1.0) / (root + 1.0) * (-6.0 * t).exp();
            shared(0.5, 3.0, 2.0 * c.sqrt() / (KWOK.sqrt() * (1.0 - c)))
        }),
    }
}

/// Three kinds of dust.
fn several() -> Case {
    let kinds = [300.0, 30.0, 3.0].map(|k| [0.3, 1.0, 0.3 / k]);
    Case {
        what: "three kinds, K 300, 30 and 3".into(),
        kinds: kinds.to_vec(),
        drag: "law = \"constant-stopping-time\"\nstopping_time = 1\n".into(),
        eos: FREE,
        bars: [1e-6, 1e-2],
        exact: Box::new(move |t| {
            const STEP: f64 = 1e-5;
            let rates = |v: &[f64; 4]| {
                let mut rates = [0.0; 4];
                for (n, [rho, _, time]) in kinds.iter().enumerate() {
                    let pull = (v[0] - v[n + 1]) / time;
                    rates[n + 1] = pull;
                    rates[0] -= rho * pull;
                }
                rates
            };
            let along = |v: &[f64; 4], r: &[f64; 4], dt: f64| -> [f64; 4] {
                std::array::from_fn(|n| v[n] + dt * r[n])
            };
            let mut v = [0.0, 1.0, 1.0, 1.0];
            for _ in 0..(t / STEP).round() as usize {
                let a = rates(&v);
                let b = rates(&along(&v, &a, 0.5 * STEP));
                let c = rates(&along(&v, &b, 0.5 * STEP));
                let d = rates(&along(&v, &c, STEP));
                v = std::array::from_fn(|n| {
                    v[n] + STEP / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n])
                });
            }
            v.to_vec()
        }),
    }
}

fn trial(case: &Case) -> Trial {
    let lattice = "lo = [0, 0, 0]\nhi = [1, 1, 1]\nlattice = \"bcc\"\nspacing = 0.125\n";
    let kinds: String = (case.kinds.iter())
        .map(|[rho, v, own]| {
            let key = if case.drag.contains("stopping_time") {
                "stopping_time"
            } else {
                "size"
            };
            format!(
                "[[dust.block]]\n{lattice}density = {rho}\nvelocity = [{v}, 0, 0]\n{key} = {own:e}\n"
            )
        })
        .collect();
    let text = format!(
        "[run]\nend_time = 1\ntime_step = 0.05\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[gas.eos]\n{}\n\
         [[gas.block]]\n{lattice}density = 1\n{}{kinds}[dust.drag]\n{}",
        case.eos,
        if case.eos == FREE {
            "pressure = 1\n"
        } else {
            ""
        },
        case.drag
    );
    Trial::prepared(&text, &[], |_, dust| {
        dust.x.iter_mut().for_each(|x| *x += SHIFT)
    })
    .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
}

/// Largest error of any velocity where gas and the kinds of dust have `exact`.
fn error(mixture: &Mixture, exact: &[f64]) -> f64 {
    let number = mixture.dust.len() / (exact.len() - 1);
    let dust = mixture.dust.iter().enumerate();
    let all = (mixture.gas.iter().map(|s| (s, exact[0])))
        .chain(dust.map(|(i, s)| (s, exact[1 + i / number])));
    let errors = all.map(|(s, v)| (s.v - Vec3::new(v, 0.0, 0.0)).norm());
    errors.fold(
        0.0,
        |worst: f64, e| if e > worst || e.is_nan() { e } else { worst },
    )
}

fn of(case: &Case) -> [Row; 3] {
    let seen = mixtures(trial(case), &STOPS);
    let errors = STOPS.iter().zip(&seen);
    let worst = errors.fold(0.0, |worst: f64, (t, mixture)| {
        let error = error(mixture, &(case.exact)(*t)) / case.kinds[0][1];
        if error > worst || error.is_nan() {
            error
        } else {
            worst
        }
    });
    let books = &seen[seen.len() - 1].books;
    let row = |what: &str, measured, bars| {
        Row::new(format!("{}: {what}", case.what), measured, Bar::Limit(bars))
    };
    [
        row("velocities", worst, case.bars),
        row("momentum", books.error_momentum, [1e-13, 1e-10]),
        row("energy", books.error_energy, [1e-12, 1e-4]),
    ]
}

pub fn rows() -> Vec<Row> {
    let times = [
        [1.0, 1.0],
        [10.0, 0.01],
        [0.1, 100.0],
        [1e12, 1.0],
        [1e-12, 1.0],
    ];
    let mut cases: Vec<Case> = times.map(linear).into();
    cases.extend([quadratic(), kwok(), several()]);
    cases.iter().flat_map(of).collect()
}
