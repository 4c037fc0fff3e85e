//! A square of dense gas in balance of pressure with thin gas around it, in the plane: nothing moves. Density 4 : 1, P = 2.5, gamma = 5/3, t = 8.
//!
//! Equal masses on square lattices, 64 a side of the thin gas, 128 of the dense one. Side: four times the mean distance of dense particles
//! from the middle line, in strips of a tenth of the side along both axes; area: that of the dense particles. Rounding: how far
//! the outermost dense particles of the four quarters along their diagonals have come in from the corners, in distances of the thin gas.
//! Source: Saitoh & Makino (2013), ApJ 768, 44, section 5.2.

use nbody::points::Vec3;

use super::picture::{Window, maps};
use super::{Bar, End, Row, Scheme};

const P: f64 = 2.5;
const TIME: f64 = 8.0;
/// Particles a side of the thin gas.
const SIDE: u32 = 64;

fn scene(n: u32) -> String {
    let spacing = 1.0 / f64::from(n);
    let block = |lo: [f64; 2], hi: [f64; 2], rho: f64, spacing: f64| {
        format!(
            "[[gas.block]]\nlo = [{}, {}, 0]\nhi = [{}, {}, 0]\nlattice = \"cubic\"\nspacing = {spacing}\ndensity = {rho}\n\
             pressure = {P}\n",
            lo[0], lo[1], hi[0], hi[1]
        )
    };
    let blocks = [
        block([0.0, 0.0], [1.0, 0.25], 1.0, spacing),
        block([0.0, 0.75], [1.0, 1.0], 1.0, spacing),
        block([0.0, 0.25], [0.25, 0.75], 1.0, spacing),
        block([0.75, 0.25], [1.0, 0.75], 1.0, spacing),
        block([0.25, 0.25], [0.75, 0.75], 4.0, 0.5 * spacing),
    ];
    format!(
        "[run]\nend_time = {TIME}\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         dimensions = 2\n{}[gas.eos]\ngamma = 1.6666666666666667\n",
        blocks.concat()
    )
}

/// The dense particles: the last block's.
fn dense(n: u32) -> u64 {
    u64::from(n * n) * 3 / 4
}

/// The form of the square.
struct Form {
    side: f64,
    area: f64,
    /// Distance of the corners from the middle.
    corner: f64,
}

impl Form {
    fn of(end: &End, n: u32) -> Self {
        let (mut strip, mut number, mut corners) = (0.0, 0.0, [0.0f64; 4]);
        let mut area = 0.0;
        let first = end.gas.iter().map(|p| p.id).min().unwrap_or(0) + dense(n);
        for particle in end.gas.iter().filter(|p| p.id >= first) {
            let d = particle.x - Vec3::new(0.5, 0.5, particle.x.z);
            for (along, across) in [(d.x, d.y), (d.y, d.x)] {
                if across.abs() < 0.05 {
                    strip += along.abs();
                    number += 1.0;
                }
            }
            let quarter = usize::from(d.x > 0.0) + 2 * usize::from(d.y > 0.0);
            corners[quarter] = corners[quarter].max((d.x.abs() + d.y.abs()) / 2f64.sqrt());
            area += particle.volume();
        }
        Self {
            side: 4.0 * strip / number,
            area,
            corner: corners.iter().sum::<f64>() / 4.0,
        }
    }
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let ends = scheme.run(&scene(SIDE), &[0.5 * TIME, TIME], |_| {});
    let [start, half, end] = [0, 1, 2].map(|k| &ends[k]);
    let titles = ["start", "t = 4", "t = 8"].map(|t| format!("density, {t}"));
    let shown: Vec<_> = [start, half, end].into_iter().zip(titles).collect();
    maps(scheme, "gas-square", &shown, &Window::UNIT, |p| p.rho);
    let [before, after] = [start, end].map(|end| Form::of(end, SIDE));
    let speed = (2.0 * end.books.kinetic / 1.75).sqrt() / (5.0 / 3.0 * P).sqrt();
    let number = end.gas.len() as f64;
    let noise = end.gas.iter().map(|p| (p.p / P - 1.0).powi(2)).sum::<f64>() / number;
    vec![
        Row::new(
            "side, change",
            after.side / before.side - 1.0,
            Bar::Limit([0.01, 0.02]),
        ),
        Row::new(
            "area, change",
            after.area / before.area - 1.0,
            Bar::Limit([0.01, 0.02]),
        ),
        Row::new(
            "rounding of the corners, in distances of the thin gas",
            (before.corner - after.corner) * f64::from(SIDE),
            Bar::Limit([1.5, 4.0]),
        ),
        Row::new(
            "rms velocity by the sound speed of the thin gas",
            speed,
            Bar::Limit([0.005, 0.03]),
        ),
        Row::new(
            "kinetic by thermal energy",
            end.books.kinetic / end.books.internal,
            Bar::Limit([1e-5, 1e-3]),
        ),
        Row::new("rms of P / 2.5 - 1", noise.sqrt(), Bar::Limit([0.02, 0.08])),
        end.energy_error(),
    ]
}
