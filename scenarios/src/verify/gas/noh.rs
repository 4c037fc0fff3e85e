//! Noh's implosion: cold gas of density 1 that flows to a point at speed 1, gamma = 5/3, at t = 2, in the plane and in space.
//!
//! A shock at r = t/3 leaves behind it gas at rest of density 4^d and u = 1/2; ahead of it rho = (1 + t/r)^(d-1). The post-shock density is
//! the median over 0.3 to 0.8 of the shock's radius; the shock is where the mass of shells by their volume crosses the middle between both sides.
//! (A mean over the particles of a shell leans to its dense part.) Ahead of the shock particles stand (1 + t/r) times closer across than along the
//! radius, so that the face is as wide as a few distances at the start: the radius converges slowly, and is told at three of them.
//! Gas at the centre is too hot in any scheme that spreads a shock: the radius within which shells' means stay below 0.9 of the density.
//! Source: Noh (1987), JCP 72, 78.

use std::f64::consts::PI;

use gas::Particles;

use super::picture::{Profile, profiles};
use super::{Bar, End, Row, Scheme, median, order};

const TIME: f64 = 2.0;
/// Of the gas at the start: what reaches the shock by then, and so much more that kernels at the shock do not see the edge.
const RADIUS: f64 = 3.0;
const SHOCK: f64 = TIME / 3.0;
/// Shells of radii below one.
const SHELLS: usize = 100;

fn scene(dimensions: i32, spacing: f64) -> String {
    let (lattice, z) = if dimensions == 3 {
        ("bcc", RADIUS)
    } else {
        ("cubic", 0.0)
    };
    format!(
        "[run]\nend_time = {TIME}\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"open\"\ndimensions = {dimensions}\n\
         [[gas.block]]\nlo = [-{RADIUS}, -{RADIUS}, -{z:?}]\nhi = [{RADIUS}, {RADIUS}, {z:?}]\nlattice = \"{lattice}\"\n\
         spacing = {spacing}\ndensity = 1\ninternal_energy = 1e-6\n[gas.eos]\ngamma = 1.6666666666666667\n\
         [gravity]\nmethod = \"none\"\n"
    )
}

fn start(gas: &mut Particles) {
    use nbody::points::Columns;
    let inside: Vec<bool> = gas.x.iter().map(|x| x.norm() < RADIUS).collect();
    gas.retain(&inside);
    for i in 0..gas.x.len() {
        // One may stand in the centre.
        gas.v[i] = -gas.x[i].try_normalize(0.0).unwrap_or_default();
    }
}

fn exact(r: f64, dimensions: i32) -> f64 {
    if r < SHOCK {
        4f64.powi(dimensions)
    } else {
        (1.0 + TIME / r).powi(dimensions - 1)
    }
}

pub fn plane(scheme: &Scheme) -> Vec<Row> {
    rows(scheme, "gas-noh-2d", 2, [0.08, 0.056, 0.04])
}

pub fn space(scheme: &Scheme) -> Vec<Row> {
    rows(scheme, "gas-noh-3d", 3, [0.1, 0.07, 0.05])
}

/// Of the gas with the last of the distances at the start; of the others the radius alone.
fn rows(scheme: &Scheme, name: &str, dimensions: i32, spacings: [f64; 3]) -> Vec<Row> {
    let run = |spacing| scheme.end(&scene(dimensions, spacing), TIME, start);
    let error = |end: &End| front(&end.densities(dimensions), dimensions) / SHOCK - 1.0;
    let [wide, medium] = [0, 1].map(|k| error(&run(spacings[k])));
    let end = run(spacings[2]);
    let errors = [wide, medium, error(&end)];
    profiles(scheme, name, "Noh's implosion", || {
        let points = end.gas.iter().map(|p| (p.x.norm(), p.rho));
        let line = (1..=200).map(|k| 0.005 * f64::from(k));
        vec![Profile {
            axes: ["r", "density"],
            points: points.filter(|(r, _)| *r < 1.0).collect(),
            exact: line.map(|r| (r, exact(r, dimensions))).collect(),
        }]
    });
    let behind = exact(0.0, dimensions);
    let flat = |r: f64| (0.3 * SHOCK..0.8 * SHOCK).contains(&r);
    let densities = end.gas.iter().filter(|p| flat(p.x.norm())).map(|p| p.rho);
    let shells = end.binned(SHELLS, |p| p.x.norm(), |p| p.rho);
    let mut rows = vec![
        Row::new(
            "density behind the shock, error",
            median(densities.collect()) / behind - 1.0,
            Bar::Limit([0.03, 0.1]),
        ),
        Row::new(
            "radius of the shock, error",
            errors[2],
            Bar::Limit([0.02, 0.05]),
        ),
        Row::new(
            "radius of the hot centre, by that of the shock",
            hot(&shells, behind) / SHOCK,
            Bar::Limit([0.15, 0.3]),
        ),
        Row::new("particles behind the shock", count(&end), Bar::None),
        end.energy_error(),
    ];
    for (spacing, error) in spacings.iter().zip(errors).take(2) {
        let what = format!("radius of the shock, error, from a distance of {spacing}");
        rows.push(Row::new(what, error, Bar::None));
    }
    let finer = spacings.map(|spacing| 1.0 / spacing);
    rows.push(Row::new(
        "order of the error of the radius",
        order(&finer, &errors),
        Bar::None,
    ));
    rows
}

impl End {
    /// The mass in each shell by its volume.
    fn densities(&self, dimensions: i32) -> Vec<f64> {
        let mut masses = vec![0.0; SHELLS];
        for p in &self.gas {
            if let Some(mass) = masses.get_mut((p.x.norm() * SHELLS as f64) as usize) {
                *mass += p.m;
            }
        }
        let ball = if dimensions == 3 { 4.0 / 3.0 } else { 1.0 } * PI;
        let within = |k: usize| ball * (k as f64 / SHELLS as f64).powi(dimensions);
        let volumes = (0..SHELLS).map(|k| within(k + 1) - within(k));
        masses.iter().zip(volumes).map(|(m, v)| m / v).collect()
    }
}

fn count(end: &End) -> f64 {
    end.gas.iter().filter(|p| p.x.norm() < SHOCK).count() as f64
}

/// Middle of a shell.
fn middle(k: usize) -> f64 {
    (k as f64 + 0.5) / SHELLS as f64
}

/// Where the density falls to the middle between both sides, from outside.
fn front(shells: &[f64], dimensions: i32) -> f64 {
    let bar = 0.5 * (exact(0.0, dimensions) + exact(SHOCK, dimensions));
    let inner = shells.iter().rposition(|&rho| rho > bar);
    match inner {
        Some(k) if k + 1 < shells.len() => {
            middle(k) + (shells[k] - bar) / (shells[k] - shells[k + 1]) / SHELLS as f64
        }
        _ => f64::NAN,
    }
}

/// The radius inside half of the shock's within which shells stay below 0.9 of the density; empty shells are no shells.
fn hot(shells: &[f64], behind: f64) -> f64 {
    let inner = (0.5 * SHOCK * SHELLS as f64) as usize;
    let dense = shells[..inner].iter().position(|&rho| rho >= 0.9 * behind);
    dense.map_or(SHOCK, |k| k as f64 / SHELLS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mass_flows_through_the_shock_of_the_exact_solution() {
        for dimensions in [2, 3] {
            // Seen from the shock, which moves outwards with 1/3, gas ahead comes with 4/3 and leaves with 1/3.
            let (ahead, behind) = (exact(SHOCK, dimensions), exact(0.0, dimensions));
            assert!((ahead * 4.0 - behind).abs() < 1e-9 * behind, "{dimensions}");
        }
        let shells: Vec<f64> = (0..SHELLS).map(|k| exact(middle(k), 3)).collect();
        assert!((front(&shells, 3) - SHOCK).abs() < 0.01);
        assert_eq!(hot(&shells, 64.0), 0.0);
    }
}
