//! Sod's shock tube on body-centred lattices with as much dust as gas, coupled so tightly that both are one fluid, gamma = 1.4, at t = 0.2.
//!
//! The mixture is gas of the pressure of the gas and the density of both. L1 = sum (m/rho) |f - exact| / sum (m/rho) |exact| over |x - 1| < 0.5 for
//! density and pressure, of the velocity by the largest; all of gas particles, rho_d/rho_g taken from the nearest slice.
//! Plateaux: means between the waves. Source: exact solution of [`crate::verify::gas::riemann`] (Toro 2009, chapter 4).

use super::{Bar, Mixture, Row, State, Trial, mixtures};
use crate::verify::gas::riemann::{self, Waves};

/// Cells a length on the left, and across.
const CELLS: f64 = 100.0;
const ACROSS: f64 = 10.0;
const GAMMA: f64 = 1.4;
const END: f64 = 0.2;
/// Of the gas alone: density and pressure.
const SIDES: [[f64; 2]; 2] = [[1.0, 1.0], [0.125, 0.1]];
const STOPPING_TIME: f64 = 1e-8;
const SLICES: usize = 40;

fn trial() -> Trial {
    let width = ACROSS / CELLS;
    let blocks: String = SIDES
        .iter()
        .enumerate()
        .map(|(side, [rho, p])| {
            // Two particles a cell.
            let spacing = 0.5f64.cbrt() / (CELLS * rho.cbrt());
            let block = format!(
                "lo = [{side}, 0, 0]\nhi = [{}, {width}, {width}]\nlattice = \"bcc\"\nspacing = {spacing}\ndensity = {rho}\n",
                side + 1
            );
            format!("[[gas.block]]\n{block}pressure = {p}\n[[dust.block]]\n{block}")
        })
        .collect();
    let text = format!(
        "[run]\nend_time = {END}\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [2, {width}, {width}]\n[gas.eos]\ngamma = {GAMMA}\n{blocks}\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {STOPPING_TIME:e}\n"
    );
    Trial::new(&text, &[], |_| {}).unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
}

fn waves() -> Waves {
    let [left, right] = SIDES.map(|[rho, p]| riemann::State {
        rho: 2.0 * rho,
        v: 0.0,
        p,
    });
    Waves::new(left, right, GAMMA)
}

/// Where a particle is, by (x - 1) / t.
fn xi(state: &State) -> f64 {
    (state.x.x - 1.0) / END
}

/// L1 of density (of the gas, by twice its exact value), pressure, and velocity of gas and dust.
fn errors(end: &Mixture, waves: &Waves) -> [f64; 4] {
    let near = |state: &&State| (state.x.x - 1.0).abs() < 0.5;
    let (mut sums, mut norms) = ([0.0; 3], [0.0; 3]);
    for s in end.gas.iter().filter(near) {
        let (exact, volume) = (waves.at(xi(s)), s.m / s.rho);
        let largest = waves.contact();
        let pairs = [
            (2.0 * s.rho, exact.rho, exact.rho),
            (s.p, exact.p, exact.p),
            (s.v.x, exact.v, largest),
        ];
        for (k, (found, exact, norm)) in pairs.into_iter().enumerate() {
            sums[k] += volume * (found - exact).abs();
            norms[k] += volume * norm;
        }
    }
    let grains = end
        .dust
        .iter()
        .filter(near)
        .map(|s| (s.v.x - waves.at(xi(s)).v).abs());
    let (sum, number) = grains.fold((0.0, 0.0), |(s, n), e| (s + e, n + 1.0));
    [
        sums[0] / norms[0],
        sums[1] / norms[1],
        sums[2] / norms[2],
        sum / number / waves.contact(),
    ]
}

/// Mass of the dust by that of the gas, largest difference from 1 of the slices.
fn separation(end: &Mixture) -> f64 {
    let mut masses = vec![[0.0; 2]; SLICES];
    for (k, states) in [&end.gas, &end.dust].into_iter().enumerate() {
        for s in states.iter() {
            let slice = ((s.x.x - 0.5) * SLICES as f64).floor();
            if slice >= 0.0 && slice < SLICES as f64 {
                masses[slice as usize][k] += s.m;
            }
        }
    }
    masses
        .iter()
        .map(|[gas, dust]| (dust / gas - 1.0).abs())
        .sum::<f64>()
        / SLICES as f64
}

pub fn rows() -> Vec<Row> {
    let end = mixtures(trial(), &[0.0, END])
        .pop()
        .expect("a run has an end");
    let waves = waves();
    let errors = errors(&end, &waves);
    let bar = Bar::Limit([0.01, 0.03]);
    let what = [
        "density of the gas",
        "pressure",
        "velocity of the gas",
        "velocity of the dust",
    ];
    let mut rows: Vec<Row> = (0..4)
        .map(|k| Row::new(format!("L1 of the {}", what[k]), errors[k], bar))
        .collect();
    let plateau = |lo: f64, hi: f64| {
        let inside = end.gas.iter().filter(|s| (lo..hi).contains(&xi(s)));
        let (m, v) = inside.fold((0.0, 0.0), |(m, v), s| (m + s.m, v + s.m / s.rho));
        2.0 * m / v
    };
    let (contact, [_, tail], [_, shock]) = (waves.contact(), waves.left_wave(), waves.right_wave());
    let plateaux = [
        (
            "density between rarefaction and contact",
            tail,
            contact,
            waves.at(0.5 * (tail + contact)).rho,
        ),
        (
            "density between contact and shock",
            contact,
            shock,
            waves.at(0.5 * (contact + shock)).rho,
        ),
    ];
    for (what, lo, hi, value) in plateaux {
        let inner = 0.2 * (hi - lo);
        rows.push(Row::new(
            what,
            plateau(lo + inner, hi - inner),
            Bar::Reference {
                value,
                good: 0.005,
                acceptable: 0.02,
            },
        ));
    }
    rows.extend([
        Row::new(
            "mean difference of dust to gas from 1 in slices",
            separation(&end),
            Bar::None,
        ),
        Row::new(
            "error of the energy",
            end.books.error_energy,
            Bar::Limit([1e-4, 3e-4]),
        ),
    ]);
    rows
}
