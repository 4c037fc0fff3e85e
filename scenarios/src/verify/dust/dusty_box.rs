//! Dusty box: uniform gas at rest and dust that moves through it in a periodic box.
//!
//! One kind of dust, relative velocity u, q = K (1/rho_g + 1/rho_d): linear u = u0 e^(-q t); quadratic u = u0 / (1 + q u0 t); Kwok's
//! u' = -q u sqrt(1 + a u^2): asinh(1 / (sqrt(a) u)) grows as q t. Several kinds: rho_i v_i' = sum K_ij (v_j - v_i), by the classical Runge-Kutta
//! method; kinds with K > 1e9 are one with the gas. Both are on lattices of one spacing, so that all particles of a kind do the same; errors are the largest of any particle's velocity, by that of the
//! dust at the start. Epstein's law goes by the density at a grain, a sum over a kernel that differs from the lattice's by 1e-3 here and there; so Kwok's
//! law is compared at the integral of that density over time (by trapezia over steps, as the exchange takes it), too. Sources: Laibe & Price 2011 (MNRAS 418, 1491); Benitez-Llambay et al. 2019 (ApJS 241, 25).

use nbody::points::Vec3;

use super::{Bar, Mixture, Row, Trial, mixtures};

/// Steps in a unit of time, at the ends of which velocities are compared: of linear laws, and of Kwok's, so short that grains have no steps of their own.
const STEPS: usize = 20;
const SHORT: usize = 160;

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
    steps: usize,
    /// Whether kinds are solved together.
    mixtures: bool,
    /// Whether the rate of drag goes by the density of the gas.
    by_density: bool,
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
        steps: STEPS,
        mixtures: true,
        by_density: false,
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
        steps: STEPS,
        mixtures: true,
        by_density: false,
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
        steps: SHORT,
        mixtures: true,
        by_density: true,
        exact: Box::new(|t| {
            let root = (1.0 + KWOK * 9.0f64).sqrt();
            let c = (root - 1.0) / (root + 1.0) * (-6.0 * t).exp();
            shared(0.5, 3.0, 2.0 * c.sqrt() / (KWOK.sqrt() * (1.0 - c)))
        }),
    }
}

/// Three kinds of dust: their density and K.
fn several(rho: f64, k: [f64; 3]) -> Case {
    let kinds = k.map(|k| [rho, 1.0, rho / k]);
    let [first, second, third] = k;
    Case {
        what: format!(
            "three kinds, K {first:e}, {second:e} and {third:e}, dust to gas {:.1e}",
            3.0 * rho
        ),
        kinds: kinds.to_vec(),
        drag: "law = \"constant-stopping-time\"\nstopping_time = 1\n".into(),
        eos: BOUND,
        bars: [1e-6, 1e-2],
        steps: STEPS,
        mixtures: true,
        by_density: false,
        exact: Box::new(move |t| mixed(&kinds, t)),
    }
}

/// Velocities of gas at rest and of several kinds in it after a time.
fn mixed(kinds: &[Kind; 3], t: f64) -> Vec<f64> {
    const RK_STEP: f64 = 1e-5;
    let bound = |[rho, _, time]: &Kind| t > 0.0 && rho / time > 1e9;
    let joint: f64 = kinds.iter().filter(|k| bound(k)).map(|k| k[0]).sum();
    let rates = |v: &[f64; 4]| {
        let mut rates = [0.0; 4];
        for (n, kind) in kinds.iter().enumerate().filter(|(_, kind)| !bound(kind)) {
            let pull = (v[0] - v[n + 1]) / kind[2];
            rates[n + 1] = pull;
            rates[0] -= kind[0] / (1.0 + joint) * pull;
        }
        rates
    };
    let along = |v: &[f64; 4], r: &[f64; 4], dt: f64| -> [f64; 4] {
        std::array::from_fn(|n| v[n] + dt * r[n])
    };
    let mut v = [joint / (1.0 + joint), 1.0, 1.0, 1.0];
    for _ in 0..(t / RK_STEP).round() as usize {
        let a = rates(&v);
        let b = rates(&along(&v, &a, 0.5 * RK_STEP));
        let c = rates(&along(&v, &b, 0.5 * RK_STEP));
        let d = rates(&along(&v, &c, RK_STEP));
        v = std::array::from_fn(|n| v[n] + RK_STEP / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]));
    }
    for (n, _) in kinds.iter().enumerate().filter(|(_, kind)| bound(kind)) {
        v[n + 1] = v[0];
    }
    v.to_vec()
}

/// Steps in which kinds are not solved together, for comparison.
const ALONE: [usize; 2] = [20, 80];

/// Density of each of three kinds, and their K.
const MIXTURES: [(f64, [f64; 3]); 5] = [
    (0.3, [300.0, 30.0, 3.0]),
    (0.3, [3e14, 3e13, 3e12]),
    (0.3, [1e12, 1.0, 1e-12]),
    (100.0, [1e4, 1e3, 1e2]),
    (1e-4, [1e-1, 1e-3, 1e-5]),
];

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
        "[run]\nend_time = 1\ntime_step = {:?}\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[gas.eos]\n{}\n\
         [[gas.block]]\n{lattice}density = 1\n{}{kinds}[dust.drag]\n{}\
         [coupling]\nmixtures = {}\n",
        1.0 / case.steps as f64,
        case.eos,
        if case.eos == FREE {
            "pressure = 1\n"
        } else {
            ""
        },
        case.drag,
        case.mixtures
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

/// Mean density that the grains see.
fn around(mixture: &Mixture) -> f64 {
    mixture.dust.iter().map(|s| s.rho).sum::<f64>() / mixture.dust.len() as f64
}

/// Ends of the steps.
fn stops(case: &Case) -> Vec<f64> {
    let step = 1.0 / case.steps as f64;
    (0..=case.steps).map(|k| k as f64 * step).collect()
}

fn run(case: &Case) -> Vec<Mixture> {
    mixtures(trial(case), &stops(case))
}

/// Largest error of any velocity at the ends of steps, where the exact ones are those at `times`.
fn worst(case: &Case, seen: &[Mixture], times: &[f64]) -> f64 {
    let errors = times.iter().zip(seen);
    let errors = errors.map(|(t, mixture)| error(mixture, &(case.exact)(*t)));
    let largest = |worst: f64, e: f64| if e > worst || e.is_nan() { e } else { worst };
    errors.fold(0.0, largest) / case.kinds[0][1]
}

fn of(case: &Case) -> Vec<Row> {
    let seen = run(case);
    let step = 1.0 / case.steps as f64;
    let books = &seen[seen.len() - 1].books;
    let row = |what: &str, measured, bars| {
        Row::new(format!("{}: {what}", case.what), measured, Bar::Limit(bars))
    };
    let mut rows = vec![
        row("velocities", worst(case, &seen, &stops(case)), case.bars),
        row("momentum", books.error_momentum, [1e-13, 1e-10]),
        row("energy", books.error_energy, [1e-12, 1e-4]),
    ];
    if case.by_density {
        let mut times = vec![0.0];
        times.extend(seen.windows(2).scan(0.0, |time, pair| {
            *time += 0.5 * step * (around(&pair[0]) + around(&pair[1]));
            Some(*time)
        }));
        let what = "velocities, by the density that grains see";
        rows.insert(1, row(what, worst(case, &seen, &times), case.bars));
    }
    rows
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
    cases.extend([quadratic(), kwok()]);
    cases.extend(MIXTURES.map(|(rho, k)| several(rho, k)));
    let mut rows: Vec<Row> = cases.iter().flat_map(of).collect();
    rows.extend(ALONE.map(|steps| {
        let case = Case {
            steps,
            mixtures: false,
            ..several(MIXTURES[0].0, MIXTURES[0].1)
        };
        let what = format!("the first three kinds, each alone, {steps} steps: velocities");
        Row::new(what, worst(&case, &run(&case), &stops(&case)), Bar::None)
    }));
    rows
}
