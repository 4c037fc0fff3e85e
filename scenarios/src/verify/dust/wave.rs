//! A wave in a mixture of isothermal gas (c = 1) and as much dust, in a periodic box of the plane one wavelength long.
//!
//! Both begin with v = A sin kx and densities 1 + A sin kx, A = 1e-4; drag K (v_d - v_g), the stopping time of a grain 1/K. The linear
//! equations have four modes; their sum is known to 50 digits. For K to infinity the mixture carries a wave of speed 1/sqrt(2) without
//! loss. Error: root mean square over space of the differences of velocity of both, by A. Where 1/K is much shorter than the crossing time of
//! the distance of particles, schemes that smooth velocity differences damp the wave. Among 30 neighbours of a
//! triangular lattice sound has its speed to 0.2 %: what is left is drag's. Source: Laibe & Price 2011 (MNRAS 418, 1491), 2012 (MNRAS 420, 2345).

use std::f64::consts::TAU;

use nbody::points::Vec3;

use super::{Bar, Mixture, Row, State, Trial, mixtures};
use crate::verify::gas::stretched;

const AMPLITUDE: f64 = 1e-4;
/// Gas particles a wavelength and across.
const ALONG: u32 = 64;
const ACROSS: u32 = 12;
/// Of the lattice of grains from that of the gas, by the distance of particles.
const SHIFT: f64 = 0.4;
/// 2 / sqrt(3): what makes a triangular lattice of a square one.
const STRETCH: f64 = 1.154_700_538_379_251_5;
const STOPS: [f64; 3] = [0.0, 1.0, 2.0];

/// Parts by sin kx and cos kx, by A, of the velocities of gas and dust.
type Parts = [f64; 4];

/// K, and the parts at t = 1 and 2.
const CASES: [(f64, [Parts; 2]); 9] = [
    (
        1e-4,
        [
            [0.999950001, 0.000000001, 0.999900005, 0.000000001],
            [0.999900005, 0.000000002, 0.999800020, 0.000000002],
        ],
    ),
    (
        1e-2,
        [
            [0.995012496, 0.000009898, 0.990049793, 0.000007898],
            [0.990049868, 0.000019696, 0.980198592, 0.000015679],
        ],
    ),
    (
        1.0,
        [
            [0.613345440, 0.060724709, 0.348711357, 0.042117822],
            [0.370731228, 0.074545549, 0.116484426, 0.040464635],
        ],
    ),
    (
        1e1,
        [
            [-0.055517178, 0.468189076, -0.310341848, 0.405566058],
            [-0.380602681, -0.045743585, -0.283451133, -0.154621491],
        ],
    ),
    (
        1e2,
        [
            [-0.242618863, 0.653240604, -0.283143997, 0.644977548],
            [-0.783855412, -0.315890305, -0.762480523, -0.340191920],
        ],
    ),
    (
        1e3,
        [
            [-0.263872731, 0.678648298, -0.268131554, 0.677812623],
            [-0.850364646, -0.358042414, -0.848098236, -0.360710366],
        ],
    ),
    (
        1e4,
        [
            [-0.266016907, 0.681287609, -0.266444920, 0.681203970],
            [-0.857426660, -0.362456911, -0.857198753, -0.362726244],
        ],
    ),
    (
        1e6,
        [
            [-0.266252957, 0.681579072, -0.266257240, 0.681578236],
            [-0.858208286, -0.362944776, -0.858206005, -0.362947472],
        ],
    ),
    (
        1e8,
        [
            [-0.266255318, 0.681581988, -0.266255361, 0.681581980],
            [-0.858216107, -0.362949657, -0.858216084, -0.362949684],
        ],
    ),
];

fn trial(k: f64, along: u32) -> Trial {
    let spacing = 1.0 / f64::from(along);
    let width = f64::from(ACROSS) * spacing;
    let block = format!(
        "lo = [0, 0, 0]\nhi = [1, {width}, 0]\nlattice = \"cubic\"\nspacing = {spacing}\ndensity = {STRETCH}\n"
    );
    let text = format!(
        "[run]\nend_time = 2\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, {}, 1]\ndimensions = 2\n\
         [gas.eos]\nkind = \"isothermal\"\nsound_speed = 1\n[gas.hydro]\nneighbours = 30\n[[gas.block]]\n{block}[[dust.block]]\n{block}\
         [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = {:e}\n",
        STRETCH * width,
        1.0 / k
    );
    let (place, _) = stretched(|x| 1.0 + AMPLITUDE * (TAU * x).sin());
    let shaped = |x: &mut Vec3, v: &mut Vec3, shift: f64| {
        let column = (x.x / spacing).floor();
        let y = x.y + (0.5 * column.rem_euclid(2.0) + shift) * spacing;
        x.y = (STRETCH * y).rem_euclid(STRETCH * width);
        x.x = place((x.x + shift * spacing).rem_euclid(1.0));
        v.x = AMPLITUDE * (TAU * x.x).sin();
    };
    Trial::prepared(&text, &[], |gas, dust| {
        for (x, v) in gas.x.iter_mut().zip(&mut gas.v) {
            shaped(x, v, 0.0);
        }
        for (x, v) in dust.x.iter_mut().zip(&mut dust.v) {
            shaped(x, v, SHIFT);
        }
    })
    .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
}

/// The parts that a mixture has.
fn parts(mixture: &Mixture) -> Parts {
    let part = |states: &[State], f: fn(f64) -> f64| {
        let sum: f64 = states.iter().map(|s| s.v.x * f(TAU * s.x.x)).sum();
        2.0 * sum / states.len() as f64 / AMPLITUDE
    };
    [
        part(&mixture.gas, f64::sin),
        part(&mixture.gas, f64::cos),
        part(&mixture.dust, f64::sin),
        part(&mixture.dust, f64::cos),
    ]
}

pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (k, exact) in CASES {
        let seen = mixtures(trial(k, ALONG), &STOPS);
        for (n, t) in [1, 2].into_iter().enumerate() {
            let found = parts(&seen[n + 1]);
            let square: f64 = (found.iter().zip(&exact[n]))
                .map(|(a, b)| (a - b).powi(2))
                .sum();
            rows.push(Row::new(
                format!("K {k:e}, t = {t}: velocities"),
                (0.25 * square).sqrt(),
                Bar::Limit([0.02, 0.15]),
            ));
        }
    }
    rows
}
