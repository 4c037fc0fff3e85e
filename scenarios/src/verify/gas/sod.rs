//! Sod's shock tube in three dimensions, gamma = 5/3, on body-centred lattices of cells 1/n and 2/n, at t = 0.2; n = 100: 57 600 particles.
//!
//! L1 = sum (m/rho) |f - exact| / sum (m/rho) over |x - 1| < 0.5. Exact solution: [`super::riemann`].

use super::riemann::State;
use super::tube::{Side, Tube};
use super::{Bar, End, Row, Scheme, both, order, pair};

/// Cells a length on the left whose errors give the order.
const CELLS: [u32; 3] = [26, 50, 100];

/// What SWIFT's density SPH reaches at 57 600 particles is acceptable: 0.0084 and 0.0198.
const BARS: [Bar; 2] = [Bar::Limit([0.0055, 0.0084]), Bar::Limit([0.018, 0.0198])];

pub const TUBE: Tube = Tube {
    title: "Sod's shock tube",
    left: Side {
        state: State {
            rho: 1.0,
            v: 0.0,
            p: 1.0,
        },
        coarser: 1.0,
    },
    right: Side {
        state: State {
            rho: 0.125,
            v: 0.0,
            p: 0.1,
        },
        coarser: 2.0,
    },
    gamma: 5.0 / 3.0,
    end: 0.2,
    dimensions: 3,
    across: 16,
};

/// In both precisions, with the viscosity that suits shocks.
pub fn rows() -> Vec<Row> {
    let scene = TUBE.scene(100) + "[gas.viscosity]\nkind = \"constant\"\n";
    let runs = both(&scene, TUBE.end, |_| {});
    let errors = errors(&runs[0]);
    let between = differences(&runs);
    let what = ["L1 of density", "L1 of velocity"];
    (0..2)
        .flat_map(|k| pair(what[k], BARS[k], errors[k], between[k]))
        .collect()
}

/// By any scheme, at three resolutions.
pub fn of(scheme: &Scheme) -> Vec<Row> {
    let ends = CELLS.map(|n| scheme.end(&TUBE.scene(n), TUBE.end, |_| {}));
    let finest = &ends[2];
    TUBE.picture(scheme, "gas-sod", finest);
    let errors = ends.each_ref().map(errors);
    let resolutions = CELLS.map(f64::from);
    let orders = [0, 1].map(|k| order(&resolutions, &errors.map(|error| error[k])));
    vec![
        Row::new("L1 of density", errors[2][0], BARS[0]),
        Row::new("L1 of velocity", errors[2][1], BARS[1]),
        Row::new("order of L1 of density", orders[0], Bar::None),
        Row::new("order of L1 of velocity", orders[1], Bar::None),
        Row::new(
            "largest step of the pressure at the contact, mean over slices",
            TUBE.blip(finest, 100),
            Bar::Limit([0.02, 0.1]),
        ),
        finest.energy_error(),
    ]
}

/// The L1 errors of density and velocity.
fn errors(run: &End) -> [f64; 2] {
    let waves = TUBE.waves();
    mean(run, |i| {
        let particle = &run.gas[i];
        let exact = waves.at(TUBE.xi(particle));
        [particle.rho - exact.rho, particle.v.x - exact.v]
    })
}

/// The L1 differences between two runs, particle by particle.
fn differences([a, b]: &[End; 2]) -> [f64; 2] {
    mean(a, |i| {
        let (a, b) = (&a.gas[i], &b.gas[i]);
        [a.rho - b.rho, a.v.x - b.v.x]
    })
}

/// Means of moduli over the middle of the tube, weighted by volume.
fn mean(run: &End, value: impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
    let (mut sum, mut volume) = ([0.0; 2], 0.0);
    for (i, particle) in run.gas.iter().enumerate() {
        if (particle.x.x - 1.0).abs() < 0.5 {
            volume += particle.volume();
            for (sum, value) in sum.iter_mut().zip(value(i)) {
                *sum += particle.volume() * value.abs();
            }
        }
    }
    sum.map(|sum| sum / volume)
}
