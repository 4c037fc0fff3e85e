//! Growth of grains: exact solutions of Smoluchowski's equation, and the size at which fragmentation stops turbulent growth.
//!
//! Constant kernel: N = 1/(1 + t/2), M2 = 1 + t; sum of masses: N = e^-t, M2 = e^2t (Golovin 1963); product: N = 1 - t/2, M2 = 1/(1 - t) until
//! gelation at t = 1 (Scott 1968); all from monomers of unit mass and number density, at unit rate.
//! Barrier: a_frag = 0.37 (2/3 pi) Sigma_g / (rho_s alpha) (u_f / c)^2 (Birnstiel, Klahr & Ercolano 2012), the size that holds most of the mass
//! when coagulation and fragmentation balance; equal grains of a_frag/0.37 meet at u_f.

mod mixed;

use dust::coagulation::{Kernel, Physics};
use dust::outcome::{Cratering, Rules};
use dust::relative_speed::{Motion, Reynolds, Sources, Turbulence};
use dust::{Molecules, StoppingLaw};

use self::mixed::{Mixed, Surroundings, mean};
use super::{Bar, Row};

/// Runs of each kernel.
const SEEDS: u64 = 10;
const SWARMS: usize = 10_000;

/// N and M2 at a time.
type Exact = fn(f64) -> [f64; 2];

struct Case {
    name: &'static str,
    kernel: Kernel,
    exact: Exact,
    times: [f64; 2],
    step: f64,
}

const CASES: [Case; 3] = [
    Case {
        name: "constant",
        kernel: Kernel::Constant(1.0),
        exact: |t| [1.0 / (1.0 + 0.5 * t), 1.0 + t],
        times: [1.0, 10.0],
        step: 0.1,
    },
    Case {
        name: "sum",
        kernel: Kernel::Sum(1.0),
        exact: |t| [(-t).exp(), (2.0 * t).exp()],
        times: [0.5, 1.0],
        step: 0.025,
    },
    Case {
        name: "product",
        kernel: Kernel::Product(1.0),
        exact: |t| [1.0 - 0.5 * t, 1.0 / (1.0 - t)],
        times: [0.25, 0.5],
        step: 0.0125,
    },
];

/// Moments of swarms of equal mass, and of masses that differ by up to 30.
pub fn smoluchowski() -> Vec<Row> {
    let mut rows = Vec::new();
    for case in &CASES {
        for (spread, swarms) in [(1.0, "equal swarms"), (30.0, "unequal swarms")] {
            let runs: Vec<Vec<[f64; 3]>> = (0..SEEDS)
                .map(|seed| {
                    let mut space = Mixed::monomers(case.kernel, SWARMS, spread, seed);
                    let at = |&time: &f64| {
                        space.advance(time, case.step);
                        [0.0, 1.0, 2.0].map(|power| space.moment(power))
                    };
                    case.times.iter().map(at).collect()
                })
                .collect();
            for (k, &time) in case.times.iter().enumerate() {
                let exact = (case.exact)(time);
                for (value, which) in [(exact[0], 0), (exact[1], 2)] {
                    let (measured, uncertainty) = mean(runs.iter().map(|run| run[k][which]));
                    let what = format!("{} kernel, {swarms}: M{which} at t = {time}", case.name);
                    let bar = Bar::Statistics(value);
                    rows.push(Row {
                        uncertainty,
                        ..Row::new(what, measured, bar)
                    });
                }
                let worst = (runs.iter()).fold(0.0, |m: f64, run| m.max((run[k][1] - 1.0).abs()));
                let what = format!("{} kernel, {swarms}: M1 - 1 at t = {time}", case.name);
                rows.push(Row::new(what, worst, Bar::Limit([1e-13, 1e-12])));
            }
        }
    }
    rows.push(gelation());
    rows
}

/// Where the straight line through 1/M2 of the product kernel falls to zero.
fn gelation() -> Row {
    let times = [0.2, 0.6];
    let found: Vec<f64> = (0..SEEDS)
        .map(|seed| {
            let mut space = Mixed::monomers(Kernel::Product(1.0), SWARMS, 1.0, 100 + seed);
            let [a, b] = times.map(|time| {
                space.advance(time, 0.0125);
                1.0 / space.moment(2.0)
            });
            times[0] + (times[1] - times[0]) * a / (a - b)
        })
        .collect();
    let (measured, uncertainty) = mean(found.iter().copied());
    Row {
        uncertainty,
        ..Row::new(
            "product kernel: time of gelation",
            measured,
            Bar::Reference {
                value: 1.0,
                good: 0.03,
                acceptable: 0.15,
            },
        )
    }
}

/// A disk's midplane: surface density, material density, alpha, fragmentation speed, sound speed, Keplerian speed in cgs, and the barrier by other hands.
const MIDPLANES: [[f64; 7]; 2] = [
    [100.0, 1.2, 1e-3, 1000.0, 5e4, 2e6, 2.61721461973],
    [1700.0, 3.0, 1e-4, 100.0, 1e5, 3e6, 0.444926485355],
];

const DUST_TO_GAS: f64 = 0.01;

/// The part of the largest size at which most of the mass is.
const PEAK: f64 = 0.37;

pub fn barriers() -> Vec<Row> {
    let mut rows = Vec::new();
    for [sigma, density, alpha, speed, c, kepler, tabulated] in MIDPLANES {
        let barrier = PEAK * 2.0 / (3.0 * std::f64::consts::PI) * sigma / (density * alpha)
            * (speed / c).powi(2);
        let case = format!("alpha = {alpha:e}, u_f = {speed} cm/s");
        let bar = |value: f64, good: f64, acceptable: f64| Bar::Reference {
            value,
            good,
            acceptable,
        };
        rows.push(Row::new(
            format!("{case}: a_frag by the formula, cm"),
            barrier,
            bar(tabulated, 1e-3, 0.02),
        ));
        // At 1 au.
        let omega = kepler / 1.496e13;
        let surroundings = Surroundings {
            rho: sigma * omega / ((2.0 * std::f64::consts::PI).sqrt() * c),
            c,
            omega,
        };
        let kernel = Kernel::Physical(turbulent(alpha, speed, density));
        // Growth takes some of these times from a tenth of the barrier.
        let (start, unit) = (0.1 * barrier, 1.0 / (DUST_TO_GAS * omega));
        let grain = (start, density);
        let mut space = Mixed::grains(kernel, 2000, grain, surroundings, DUST_TO_GAS);
        let sizes: Vec<[f64; 3]> = (0..10)
            .map(|k| {
                space.advance((30.0 + f64::from(k)) * unit, 0.02 * unit);
                let [half, most] = [0.5, 0.99].map(|part| space.quantile(part));
                [space.mean_radius(), half, most]
            })
            .collect();
        let row = |what: &str, which: usize, value: f64, bars: [f64; 2]| {
            let (measured, uncertainty) = mean(sizes.iter().map(|s| s[which]));
            Row {
                uncertainty,
                ..Row::new(
                    format!("{case}: {what}, cm"),
                    measured,
                    bar(value, bars[0], bars[1]),
                )
            }
        };
        rows.push(row("mean size by mass", 0, barrier, [0.2, 0.4]));
        rows.push(row("size that halves the mass", 1, barrier, [0.2, 0.4]));
        rows.push(row(
            "size above which is 1 % of the mass",
            2,
            barrier / PEAK,
            [0.2, 0.4],
        ));
    }
    rows
}

/// Growth by turbulence and Brownian motion; grains break down to monomers of 1 um.
fn turbulent(alpha: f64, speed: f64, density: f64) -> Physics {
    let molecules = Molecules {
        mass: 2.34 * 1.6735e-24,
        cross_section: 2e-15,
    };
    Physics {
        sources: Sources {
            molecule: molecules.mass,
            turbulence: Some(Turbulence {
                alpha,
                reynolds: Reynolds::Of(molecules),
            }),
            motion: Motion::Still,
        },
        rules: Rules {
            fragmentation_speed: speed,
            transition: 0.2,
            monomer: 4.0 / 3.0 * std::f64::consts::PI * 1e-12 * density,
            erosion: Cratering {
                ratio: 10.0,
                amount: 1.0,
            },
            ..Rules::STICKING
        },
        porosity: None,
        law: StoppingLaw::Epstein,
        spread: false,
    }
}
