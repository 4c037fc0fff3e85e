//! A stiffened gas by sums of densities and of pressures: a shock tube, and a contact at rest.
//!
//! gamma = 4.4, p_0 = 1, in the plane, on square lattices of cells 1/n, particles as heavy as their side is dense, constant viscosity, and the quintic
//! spline: a density that is wrong by a part of a lattice's makes a pressure wrong by that part of rho c^2. Tube: rho = 1 and P = 5
//! on the left, 0.5 and 0.01 on the right, at t = 0.05. Contact: rho = 1 and 0.25 at P = 0.01, over ten sound crossings of a cell of the denser side.
//! Exact solution: with P + p_0 for p a stiffened gas has the waves of an ideal one: [`super::riemann`]. L1 over |x - 1| < 0.5, of the
//! pressure by that on the left.

use super::riemann::{State as Sides, Waves};
use super::scheme::Scheme;
use super::{Bar, End, Row};

const GAMMA: f64 = 4.4;
const STIFFENING: f64 = 1.0;
/// Cells a length, and across.
const CELLS: u32 = 200;
const ACROSS: u32 = 24;
const END: f64 = 0.05;

/// Densities and pressures on both sides.
type Sides2 = [(f64, f64); 2];
const TUBE: Sides2 = [(1.0, 5.0), (0.5, 0.01)];
const CONTACT: Sides2 = [(1.0, 0.01), (0.25, 0.01)];

fn scene(sides: Sides2, end: f64) -> String {
    let (width, spacing) = (f64::from(ACROSS) / f64::from(CELLS), 1.0 / f64::from(CELLS));
    let block = |lo: f64, (rho, p): (f64, f64)| {
        format!(
            "[[gas.block]]\nlo = [{lo:?}, 0, 0]\nhi = [{:?}, {width}, 0.0]\nlattice = \"cubic\"\nspacing = {spacing}\n\
             density = {rho}\npressure = {p:?}\n",
            lo + 1.0
        )
    };
    format!(
        "[run]\nend_time = {end}\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\n\
         size = [2, {width}, {width}]\ndimensions = 2\n{}{}[gas.eos]\nkind = \"stiffened\"\ngamma = {GAMMA}\n\
         stiffening_pressure = {STIFFENING:?}\n",
        block(0.0, sides[0]),
        block(1.0, sides[1])
    )
}

fn run(sides: Sides2, formulation: &str, end: f64) -> End {
    let keys = [
        format!("gas.hydro.formulation=\"{formulation}\""),
        "gas.viscosity.kind=\"constant\"".to_owned(),
        "gas.hydro.kernel=\"quintic-spline\"".to_owned(),
        "gas.hydro.neighbours=82".to_owned(),
    ];
    let scheme =
        Scheme::new(false, &keys, None).unwrap_or_else(|wrong| panic!("a scheme: {wrong}"));
    scheme.end(&scene(sides, end), end, |_| {})
}

/// L1 of density, velocity and pressure, and the largest pressure less the exact one within five cells of the contact, by that on the left.
fn tube(end: &End) -> [f64; 4] {
    let side = |(rho, p): (f64, f64)| Sides {
        rho,
        v: 0.0,
        p: p + STIFFENING,
    };
    let waves = Waves::new(side(TUBE[0]), side(TUBE[1]), GAMMA);
    let contact = waves.contact() * END;
    let mean = |of: &dyn Fn(&super::State, Sides) -> f64| {
        end.mean(|particle| {
            let x = particle.x.x - 1.0;
            (x.abs() < 0.5).then(|| of(particle, waves.at(x / END)).abs())
        })
    };
    let pressure =
        |particle: &super::State, exact: Sides| (particle.p + STIFFENING - exact.p) / TUBE[0].1;
    let near =
        |particle: &&super::State| (particle.x.x - 1.0 - contact).abs() < 5.0 / f64::from(CELLS);
    let off =
        |particle: &super::State| pressure(particle, waves.at((particle.x.x - 1.0) / END)).abs();
    [
        mean(&|particle, exact| particle.rho - exact.rho),
        mean(&|particle, exact| particle.v.x - exact.v),
        mean(&pressure),
        end.gas.iter().filter(near).map(off).fold(0.0, f64::max),
    ]
}

/// The largest speed by that of sound, and how far pressures are apart by rho c^2.
fn contact(formulation: &str) -> [f64; 2] {
    let (rho, p) = CONTACT[0];
    let stiffness = GAMMA * (p + STIFFENING);
    let sound = (stiffness / rho).sqrt();
    let end = run(CONTACT, formulation, 10.0 / (f64::from(CELLS) * sound));
    let most = |of: &dyn Fn(&super::State) -> f64| {
        end.gas.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
    };
    let apart = most(&|particle| particle.p) + most(&|particle| -particle.p);
    [
        most(&|particle| particle.v.norm()) / sound,
        apart / stiffness,
    ]
}

/// What sums of pressures may be wrong by: about 1.3 and at most twice what they are.
const BARS: [Bar; 4] = [
    Bar::Limit([0.0035, 0.0054]),
    Bar::Limit([0.014, 0.022]),
    Bar::Limit([0.009, 0.014]),
    Bar::None,
];

pub fn rows() -> Vec<Row> {
    const WHAT: [&str; 4] = [
        "L1 of density",
        "L1 of velocity",
        "L1 of pressure",
        "largest error of the pressure at the contact",
    ];
    let mut rows = Vec::new();
    for formulation in ["density", "pressure"] {
        let end = run(TUBE, formulation, END);
        let summed = formulation == "pressure";
        for ((what, measured), bar) in WHAT.into_iter().zip(tube(&end)).zip(BARS) {
            let what = format!("tube, {formulation}: {what}");
            rows.push(Row::new(
                what,
                measured,
                if summed { bar } else { Bar::None },
            ));
        }
        let quiet = if summed {
            Bar::Limit([2e-6, 3.2e-6])
        } else {
            Bar::None
        };
        let [speed, step] = contact(formulation);
        rows.push(Row::new(
            format!("contact at rest, {formulation}: largest speed by that of sound"),
            speed,
            quiet,
        ));
        rows.push(Row::new(
            format!("contact at rest, {formulation}: spread of the pressure by rho c^2"),
            step,
            quiet,
        ));
        rows.push(end.energy_error());
    }
    rows
}
