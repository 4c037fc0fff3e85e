//! The Gresho vortex in a thin periodic slab, gamma = 5/3, 24 576 particles on a body-centred lattice, at t = 1.
//!
//! v_phi = 5r, 2 - 5r, 0 with the pressure that holds it, P(0) = 5 (Gresho & Chan 1990; Liska & Wendroff 2003). L1 is the mean over
//! particles with r < 0.5 of |v_phi - exact|; the peak is the largest mean of v_phi over rings of 0.01 (exact 1).

use gas::Particles;
use nbody::points::Vec3;

use super::picture::{Profile, profiles};
use super::{Bar, End, Row, Scheme, State, both, order, pair};

/// Cells a length of the body-centred slab, which is 12 cells thick; 24 576 particles with 32.
const CELLS: [u32; 3] = [16, 24, 32];

/// SWIFT: 0.178, 0.111 and 0.121 by its density SPH, SPHENIX and pressure-energy schemes, with peaks of 0.46, 0.61 and 0.59.
const BARS: [Bar; 2] = [Bar::Limit([0.08, 0.178]), Bar::Limit([0.3, 0.54])];

fn scene(cells: u32) -> String {
    let edge = 1.0 / f64::from(cells);
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, {0}]\n\
         [[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, {0}]\nlattice = \"bcc\"\nspacing = {1}\ndensity = 1\npressure = 5\n\
         [gas.eos]\ngamma = 1.6666666666666667\n",
        12.0 * edge,
        edge * 0.5f64.cbrt()
    )
}

fn start(gas: &mut Particles) {
    for i in 0..gas.x.len() {
        let (r, around) = polar(gas.x[i]);
        gas.v[i] = around * speed(r);
        gas.u[i] = 1.5 * pressure(r);
    }
}

/// Width of a ring.
const WIDTH: f64 = 0.01;

/// In both precisions.
pub fn rows() -> Vec<Row> {
    let runs = both(&scene(CELLS[2]), 1.0, start);
    let error = l1(&runs[0]);
    let between = (error - l1(&runs[1])).abs();
    let [profile, other] = runs.each_ref().map(rings);
    let apart = profile.iter().zip(&other).map(|(a, b)| (a - b).abs());
    let profile_error =
        (profile.iter().enumerate()).map(|(k, v)| (v - speed((k as f64 + 0.5) * WIDTH)).abs());
    let binned = [profile_error.sum::<f64>(), apart.sum()].map(|sum| sum / profile.len() as f64);
    let missing = [1.0 - peak(&runs[0]), 1.0 - peak(&runs[1])];
    let mut rows = [
        pair("L1 of v_phi", BARS[0], error, between),
        pair(
            "1 - peak of v_phi",
            BARS[1],
            missing[0],
            (missing[0] - missing[1]).abs(),
        ),
    ]
    .concat();
    // Disorder grows from rounding in either precision: told for information.
    rows.push(Row::new(
        "ring means of v_phi: difference in single precision, of their error",
        binned[1] / binned[0],
        Bar::None,
    ));
    rows
}

/// By any scheme, at three resolutions.
pub fn of(scheme: &Scheme) -> Vec<Row> {
    let [coarse, middling, (start, end)] = CELLS.map(|cells| {
        let mut ends = scheme.run(&scene(cells), &[1.0], start);
        let end = ends.pop().expect("a run has an end");
        (ends.remove(0), end)
    });
    profiles(scheme, "gas-gresho", "Gresho's vortex, t = 1", || {
        let near = end.gas.iter().filter(|p| polar(p.x).0 < 0.5);
        vec![Profile {
            axes: ["r", "circular velocity"],
            points: near.map(|p| (polar(p.x).0, circular(p))).collect(),
            exact: [0.0, 0.2, 0.4, 0.5].map(|r| (r, speed(r))).to_vec(),
        }]
    });
    let errors = [&coarse.1, &middling.1, &end].map(l1);
    let kept = |of: fn(&State) -> f64| {
        let sum = |end: &End| end.gas.iter().map(|p| p.m * of(p)).sum::<f64>();
        sum(&end) / sum(&start) - 1.0
    };
    vec![
        Row::new("L1 of v_phi", errors[2], BARS[0]),
        Row::new("1 - peak of v_phi", 1.0 - peak(&end), BARS[1]),
        Row::new(
            "order of L1 of v_phi",
            order(&CELLS.map(f64::from), &errors),
            Bar::Least([1.0, 0.7]),
        ),
        Row::new(
            "angular momentum, change",
            kept(|p| polar(p.x).0 * circular(p)),
            Bar::Limit([1e-3, 1e-2]),
        ),
        Row::new(
            "kinetic energy, change",
            kept(|p| p.v.norm_squared()),
            Bar::None,
        ),
        end.energy_error(),
    ]
}

/// Distance from the axis, and the direction around it.
fn polar(x: Vec3) -> (f64, Vec3) {
    let d = Vec3::new(x.x - 0.5, x.y - 0.5, 0.0);
    let r = d.norm();
    (r, Vec3::new(-d.y, d.x, 0.0) / r)
}

fn circular(particle: &State) -> f64 {
    particle.v.dot(&polar(particle.x).1)
}

fn speed(r: f64) -> f64 {
    if r < 0.2 {
        5.0 * r
    } else {
        (2.0 - 5.0 * r).max(0.0)
    }
}

fn pressure(r: f64) -> f64 {
    let inner = |r: f64| 5.0 + 12.5 * r * r;
    if r < 0.2 {
        inner(r)
    } else if r < 0.4 {
        inner(r) + 4.0 * (1.0 - 5.0 * r + (5.0 * r).ln())
    } else {
        3.0 + 4.0 * 2f64.ln()
    }
}

/// The L1 error of the circular velocity, over particles.
fn l1(run: &End) -> f64 {
    let inside: Vec<f64> = (run.gas.iter())
        .filter(|particle| polar(particle.x).0 < 0.5)
        .map(|particle| (circular(particle) - speed(polar(particle.x).0)).abs())
        .collect();
    inside.iter().sum::<f64>() / inside.len() as f64
}

/// Means of the circular velocity over rings; an empty ring has no error.
fn rings(run: &End) -> [f64; 50] {
    let mut rings = [(0.0, 0.0); 50];
    for particle in &run.gas {
        let (r, _) = polar(particle.x);
        if let Some(ring) = rings.get_mut((r / WIDTH) as usize) {
            *ring = (ring.0 + circular(particle), ring.1 + 1.0);
        }
    }
    let mut means = [0.0; 50];
    for (k, (mean, (sum, number))) in means.iter_mut().zip(rings).enumerate() {
        *mean = if number > 0.0 {
            sum / number
        } else {
            speed((k as f64 + 0.5) * WIDTH)
        };
    }
    means
}

/// The largest ring mean.
fn peak(run: &End) -> f64 {
    rings(run).into_iter().fold(f64::NEG_INFINITY, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_holds_the_vortex() {
        // dP/dr = v^2 / r, and P is continuous.
        for r in [0.05, 0.15, 0.25, 0.35, 0.45] {
            let slope = (pressure(r + 1e-5) - pressure(r - 1e-5)) / 2e-5;
            assert!((slope - speed(r).powi(2) / r).abs() < 1e-6, "at {r}");
        }
        for r in [0.2, 0.4] {
            assert!((pressure(r + 1e-9) - pressure(r - 1e-9)).abs() < 1e-7);
        }
    }
}
