//! Evrard's collapse: a cold sphere M = R = G = 1, rho = 1/(2 pi r), u = 0.05, gamma = 5/3, to t = 0.8 (Evrard 1988).
//!
//! A cubic lattice of 30 cells a diameter (14 328 particles) is cut to a sphere and drawn inwards, r -> r^(3/2); one of 58 cells (102 208) for
//! the energies, which softening and smoothing of the cusp leave too small: at t = 0.8 a one-dimensional Lagrangian run has the thermal
//! energy 0.465646, the kinetic 0.410609 and the potential -1.492918.

use gas::Particles;
use nbody::points::Columns;

use super::picture::{Profile, profiles};
use super::{Bar, End, Quantity, Row, Scheme, both, pair, solo};

/// The scene with so many cells a diameter.
pub fn scene(cells: u32) -> String {
    format!(
        r#"
title = "Evrard's collapse"
[run]
end_time = 0.8
[units]
system = "dimensionless"
[[gas.block]]
lo = [-1.0, -1.0, -1.0]
hi = [1.0, 1.0, 1.0]
lattice = "cubic"
spacing = {}
density = 1.0
internal_energy = 0.05
[gas]
softening = 0.001
[gas.eos]
kind = "ideal"
gamma = 1.6666666666666667
[gravity]
method = "tree"
force_error = 1e-3
"#,
        2.0 / f64::from(cells)
    )
}

pub fn sphere(gas: &mut Particles) {
    let inside: Vec<bool> = gas.x.iter().map(|x| x.norm() < 1.0).collect();
    gas.retain(&inside);
    let n = gas.x.len();
    gas.m.fill(1.0 / n as f64);
    gas.h.fill(0.0);
    for x in &mut gas.x {
        *x *= x.norm().sqrt();
    }
}

fn energies(end: &End) -> [f64; 3] {
    [end.books.internal, end.books.kinetic, end.books.potential]
}

/// At t = 0.8, by a one-dimensional Lagrangian run.
const REFERENCE: [f64; 3] = [0.465_646, 0.410_609, -1.492_918];
const ENERGIES: [&str; 3] = ["thermal energy", "kinetic energy", "potential energy"];

pub fn rows() -> Vec<Row> {
    let [double, single] = both(&scene(30), 0.8, sphere);
    let mut rows = pair(
        "error of the energy",
        CONSERVED,
        double.books.error_energy.abs(),
        (double.books.error_energy - single.books.error_energy).abs(),
    )
    .to_vec();
    for (k, name) in ENERGIES.into_iter().enumerate() {
        let (d, s) = (energies(&double)[k], energies(&single)[k]);
        let error = (d - REFERENCE[k]).abs();
        rows.extend(pair(
            &format!("error of the {name}"),
            Bar::None,
            error,
            (d - s).abs(),
        ));
    }
    let (fine, cost) = solo(&scene(58), 0.8, sphere);
    for (k, name) in ENERGIES.into_iter().enumerate() {
        let value = energies(&fine)[k];
        rows.push(Row::new(
            format!("{name}, 102 208 particles"),
            value,
            near(REFERENCE[k]),
        ));
    }
    rows.push(Row::new(
        "error of the energy, 102 208 particles",
        fine.books.error_energy.abs(),
        CONSERVED,
    ));
    rows.push(Row::new(
        "CPU time an update of these, us",
        1e6 * cost,
        Bar::None,
    ));
    rows
}

/// By any scheme, 14 328 particles for the error of the energy and 102 208 for the energies.
pub fn of(scheme: &Scheme) -> Vec<Row> {
    let [small, end] = [30, 58].map(|cells| scheme.end(&scene(cells), 0.8, sphere));
    profiles(scheme, "gas-evrard", "Evrard's collapse, t = 0.8", || {
        let quantities: [(&str, Quantity); 2] = [
            ("log density", |p| p.rho.log10()),
            ("radial velocity", |p| p.x.dot(&p.v) / p.x.norm()),
        ];
        let profile = |(axis, of): (&'static str, Quantity)| Profile {
            axes: ["log r", axis],
            points: end
                .gas
                .iter()
                .map(|p| (p.x.norm().log10(), of(p)))
                .collect(),
            exact: Vec::new(),
        };
        quantities.map(profile).into_iter().collect()
    });
    let mut rows = vec![Row::new(
        "error of the energy, 14 328 particles",
        small.books.error_energy.abs(),
        CONSERVED,
    )];
    for (k, name) in ENERGIES.into_iter().enumerate() {
        let what = format!("{name}, {} particles", end.gas.len());
        rows.push(Row::new(what, energies(&end)[k], near(REFERENCE[k])));
    }
    rows
}

const CONSERVED: Bar = Bar::Limit([1e-3, 3e-3]);

/// The bar of an energy that softening and smoothing change.
fn near(value: f64) -> Bar {
    Bar::Reference {
        value,
        good: 0.05,
        acceptable: 0.1,
    }
}
