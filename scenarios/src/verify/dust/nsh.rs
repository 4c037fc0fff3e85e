//! Drift of gas and dust through each other in a shearing box of gas particles that feel the reaction, from its equilibrium on for an orbit.
//!
//! gas:  u_x' = 2 u_y + 2 + sum eps_i/St_i (w_ix - u_x),   u_y' = -u_x/2 + sum eps_i/St_i (w_iy - u_y)
//! dust: w_ix' = 2 w_iy - (w_ix - u_x)/St_i,               w_iy' = -w_ix/2 - (w_iy - u_y)/St_i
//!
//! in units of eta v_K and Omega, relative to the shear. Of one size the equilibrium has a closed form; of several it is solved for with the Stokes
//! numbers that the grains are found to have. The joint motion of all mass is an epicycle, which drag does not damp.
//! Sources: Nakagawa, Sekiya & Hayashi (1986, Icarus 67, 375); Tanaka et al. (2005, ApJ 625, 414); Benitez-Llambay et al. (2019, ApJS 241, 25).

use std::f64::consts::{PI, TAU};

use coupling::System;
use nalgebra::{DMatrix, DVector};
use nbody::points::Vec3;

use super::{Bar, Row};
use crate::trial::Trial;

/// eta v_K, by the sound speed.
const HEADWIND: f64 = 0.1;

const BOX: &str = r#"
[run]
end_time = 1000.0
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [1.0, 1.0, 1.0]
dimensions = 2
rate = 1.0
headwind = 0.1
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.1
density = 1.0
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.viscosity]
kind = "none"
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.1
density = 1.0
"#;

/// Velocities of the gas and of each kind of dust, in units of the headwind.
type Velocities = Vec<[f64; 2]>;

/// Rates of change and the push, of the velocities of gas and dust one after another.
fn equations(stokes: &[f64], load: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let n = 2 + 2 * stokes.len();
    let mut rate = DMatrix::zeros(n, n);
    for j in (0..n).step_by(2) {
        rate[(j, j + 1)] += 2.0;
        rate[(j + 1, j)] -= 0.5;
    }
    for (i, (st, eps)) in stokes.iter().zip(load).enumerate() {
        for axis in 0..2 {
            let (g, d) = (axis, 2 + 2 * i + axis);
            rate[(g, g)] -= eps / st;
            rate[(g, d)] += eps / st;
            rate[(d, d)] -= 1.0 / st;
            rate[(d, g)] += 1.0 / st;
        }
    }
    let mut push = DVector::zeros(n);
    push[0] = 2.0;
    (rate, push)
}

fn pairs(state: &DVector<f64>) -> Velocities {
    state.as_slice().chunks(2).map(|v| [v[0], v[1]]).collect()
}

fn equilibrium(stokes: &[f64], load: &[f64]) -> Velocities {
    let (rate, push) = equations(stokes, load);
    let state = rate.lu().solve(&-push).expect("drag and frame hold it");
    pairs(&state)
}

/// From rest, after `t`.
fn from_rest(stokes: f64, load: f64, t: f64) -> Velocities {
    let (rate, push) = equations(&[stokes], &[load]);
    let (steps, mut state) = (20_000, DVector::zeros(4));
    let h = t / f64::from(steps);
    for _ in 0..steps {
        let half = &state + 0.5 * h * (&rate * &state + &push);
        state += h * (&rate * half + &push);
    }
    pairs(&state)
}

/// Mean velocities of the gas and of each of `kinds` of dust, dealt out by identity.
fn means(system: &System, kinds: u64) -> Velocities {
    let domain = &system.domain;
    let mean = |x: &[Vec3], v: &[Vec3], of: &dyn Fn(usize) -> bool| {
        let members: Vec<usize> = (0..x.len()).filter(|&i| of(i)).collect();
        let sum: Vec3 = members.iter().map(|&i| domain.relative(x[i], v[i])).sum();
        let mean = sum / (members.len() as f64 * HEADWIND);
        [mean.x, mean.y]
    };
    let (gas, dust) = (&system.gas.particles, &system.dust.particles);
    let mut all = vec![mean(&gas.x, &gas.v, &|_| true)];
    all.extend((0..kinds).map(|kind| mean(&dust.x, &dust.v, &|i| dust.id[i] % kinds == kind)));
    all
}

fn largest(found: &Velocities, exact: &Velocities) -> f64 {
    let apart = found
        .iter()
        .zip(exact)
        .flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]);
    // `f64::max` would lose a NaN.
    apart.fold(
        0.0,
        |most: f64, x| if x.abs() <= most { most } else { x.abs() },
    )
}

/// Errors in units of the headwind.
const BAR: Bar = Bar::Limit([1e-3, 1e-2]);

fn vector(v: [f64; 2]) -> String {
    format!("[{:?},{:?},0.0]", HEADWIND * v[0], HEADWIND * v[1])
}

/// A box of dust of one size, and the velocities that it starts with.
fn one_size([stokes, load]: [f64; 2], start: &Velocities) -> Trial {
    let overrides = [
        "dust.drag.law=\"constant-stokes-number\"".to_owned(),
        format!("dust.drag.stokes_number={stokes}"),
        format!("dust.block.0.density={load}"),
        format!("gas.block.0.velocity={}", vector(start[0])),
        format!("dust.block.0.velocity={}", vector(start[1])),
    ];
    Trial::new(BOX, &overrides, |_| {}).expect("a scene")
}

/// St and eps.
const SINGLE: [[f64; 2]; 5] = [
    [0.1, 0.01],
    [0.1, 1.0],
    [1.0, 0.01],
    [0.01, 3.0],
    [10.0, 0.1],
];

fn single(case: [f64; 2]) -> Row {
    let [stokes, load] = case;
    let exact = equilibrium(&[stokes], &[load]);
    let mut error = f64::NAN;
    let done = one_size(case, &exact).run(&[0.0, TAU], |stop| {
        error = largest(&means(stop.system, 1), &exact);
    });
    done.expect("a run");
    Row::new(
        format!("St = {stokes}, eps = {load}: error after an orbit"),
        error,
        BAR,
    )
}

fn from_rest_rows() -> Vec<Row> {
    let (stokes, load) = (0.1, 1.0);
    let mut rows = Vec::new();
    let start = vec![[0.0; 2]; 2];
    let done = one_size([stokes, load], &start).run(&[0.0, 0.1, 0.5, 2.0, 10.0], |stop| {
        let t = stop.books.time;
        if t > 0.0 {
            let error = largest(&means(stop.system, 1), &from_rest(stokes, load, t));
            let what = format!("St = {stokes}, eps = {load}, from rest: error at Omega t = {t}");
            rows.push(Row::new(what, error, BAR));
        }
    });
    done.expect("a run");
    rows
}

/// What is left after ten orbits of an epicycle of all mass.
fn epicycle() -> Row {
    let (stokes, load) = (0.1, 1.0);
    let still = equilibrium(&[stokes], &[load]);
    let start: Velocities = still.iter().map(|v| [v[0] + 0.5, v[1]]).collect();
    let mut offsets = Vec::new();
    let done = one_size([stokes, load], &start).run(&[0.0, 10.0 * TAU], |stop| {
        let now = means(stop.system, 1);
        let joint = |k: usize| (now[0][k] - still[0][k]) + load * (now[1][k] - still[1][k]);
        offsets.push([joint(0), joint(1)]);
    });
    done.expect("a run");
    let [a, b] = [offsets[0], offsets[1]];
    let apart = (a[0] - b[0]).hypot(a[1] - b[1]) / a[0].hypot(a[1]);
    Row::new(
        "epicycle of all mass: change in ten orbits, by its size",
        apart,
        BAR,
    )
}

/// Stokes numbers and loads.
const SEVERAL: [(&[f64], &[f64]); 2] = [
    (&[1.0, 0.1], &[0.2, 1.0]),
    (&[0.01, 0.1, 1.0, 10.0], &[0.02, 0.02, 0.02, 0.02]),
];

fn several((stokes, load): (&[f64], &[f64])) -> Row {
    let kinds = stokes.len() as u64;
    let overrides = ["dust.drag.law=\"epstein\"", "dust.size=1.0"].map(str::to_owned);
    let mut trial = Trial::new(BOX, &overrides, |_| {}).expect("a scene");
    let start = equilibrium(stokes, load);
    let (domain, share) = (trial.system.domain, stokes.len() as f64);
    let push = |x: Vec3, v: [f64; 2]| {
        let stream = domain.hill().map_or(0.0, |hill| hill.stream(x));
        Vec3::new(HEADWIND * v[0], HEADWIND * v[1] + stream, 0.0)
    };
    let (dust, gas) = (&mut trial.system.dust, &mut trial.system.gas);
    for i in 0..dust.particles.x.len() {
        let p = &mut dust.particles;
        let kind = (p.id[i] % kinds) as usize;
        // In gas of density 1: s rho_s = St rho v_th / Omega.
        p.grain_radius[i] = stokes[kind] * (8.0 / PI).sqrt();
        p.m[i] *= load[kind] * share;
        p.v[i] = push(p.x[i], start[1 + kind]);
    }
    dust.rates.v_pred.clone_from(&dust.particles.v);
    for (v, &x) in gas.particles.v.iter_mut().zip(&gas.particles.x) {
        *v = push(x, start[0]);
    }
    gas.rates.v_pred.clone_from(&gas.particles.v);
    let mut error = f64::NAN;
    let done = trial.run(&[0.0, TAU], |stop| {
        let (p, derived) = (&stop.system.dust.particles, &stop.system.dust.derived);
        let mut sums = vec![[0.0; 2]; stokes.len()];
        for (id, st) in p.id.iter().zip(&derived.stokes) {
            let sum = &mut sums[(id % kinds) as usize];
            *sum = [sum[0] + st, sum[1] + 1.0];
        }
        let found: Vec<f64> = sums.iter().map(|[sum, n]| sum / n).collect();
        error = largest(&means(stop.system, kinds), &equilibrium(&found, load));
    });
    done.expect("a run");
    let what = format!("St = {stokes:?}, eps = {load:?}: error after an orbit");
    Row::new(what, error, BAR)
}

pub fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> = SINGLE.into_iter().map(single).collect();
    rows.extend(from_rest_rows());
    rows.push(epicycle());
    rows.extend(SEVERAL.into_iter().map(several));
    rows
}
