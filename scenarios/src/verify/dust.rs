//! Problems of drag between dust and gas, against exact solutions of two fluids.

mod cost;
mod dusty_box;
mod growth;
mod nsh;
mod radial_drift;
mod settling;
mod settling_diffusion;
mod shock;
mod snow_line;
mod sod;
mod streaming;
mod wave;

use coupling::ledger::Report;
use nbody::points::Vec3;

use super::{Bar, Problem, Row, own};
use crate::trial::{Stop, Trial};

pub const PROBLEMS: &[Problem] = &[
    own(
        "dust-box",
        "uniform gas and dust that move through each other, stopping times of 1e-12 to 1e12 (Laibe & Price 2011); about 10 seconds",
        dusty_box::rows,
    ),
    own(
        "dust-wave",
        "wave in gas and as much dust, 64 particles a wavelength, from loose to rigid coupling (Laibe & Price 2011); about 1 minute",
        wave::rows,
    ),
    own(
        "dust-shock-j",
        "shock of Mach number 2 in gas and as much dust (Lehmann & Wardle 2018)",
        shock::jump,
    ),
    own(
        "dust-shock-c",
        "smooth shock of Mach number 0.9 in gas and as much dust (Lehmann & Wardle 2018)",
        shock::continuous,
    ),
    own(
        "dust-sod",
        "Sod's shock tube in gas and as much dust, rigidly coupled",
        sod::rows,
    ),
    own(
        "dust-streaming-a",
        "growth of the streaming instability's mode linA, up to 32 particles a wavelength (Youdin & Johansen 2007); about 3 minutes",
        streaming::lin_a,
    ),
    own(
        "dust-streaming-b",
        "the same of linB, up to 24 particles a wavelength; about 2 minutes",
        streaming::lin_b,
    ),
    own(
        "dust-settling",
        "grains and a layer that settle, in gas that is a formula and among 60 000 gas particles; about 1 minute",
        settling::rows,
    ),
    own(
        "dust-radial-drift",
        "radial drift in gas that is a formula and among 20 000 gas particles; about 1 minute",
        radial_drift::rows,
    ),
    own(
        "dust-settling-diffusion",
        "layers in balance of settling and turbulent stirring; about 2 minutes",
        settling_diffusion::rows,
    ),
    own(
        "dust-nsh",
        "drift of gas and grains of one and of several sizes through each other in a shearing box; about 2 seconds",
        nsh::rows,
    ),
    own(
        "dust-smoluchowski",
        "coagulation with a constant rate, the sum and the product of the masses, 10 runs of 10 000 swarms of equal and of unequal mass; about 2 minutes",
        growth::smoluchowski,
    ),
    own(
        "dust-growth-barriers",
        "grains that grow in turbulence until they break, against Birnstiel, Klahr & Ercolano (2012); about 1 minute",
        growth::barriers,
    ),
    own(
        "dust-snow-line",
        "ice that sublimates and recondenses, in boxes by steps of 1e-6 to 1e6 exchange times, and the snow line of a disk; about 1 minute",
        snow_line::rows,
    ),
    own(
        "dust-cost",
        "cost of drag for 1e6 superparticles in 1e5 gas particles; about 20 seconds",
        cost::rows,
    ),
];

/// A particle of either population.
#[derive(Clone, Copy)]
struct State {
    id: u64,
    x: Vec3,
    v: Vec3,
    m: f64,
    /// Density of the gas, and its pressure; zero for dust.
    rho: f64,
    p: f64,
}

/// Both populations, each in the order of identities, and the books.
struct Mixture {
    gas: Vec<State>,
    dust: Vec<State>,
    books: Report,
}

impl Mixture {
    fn of(stop: &Stop) -> Self {
        let (gas, dust) = (&stop.system.gas.particles, &stop.system.dust.particles);
        let grain = |i: usize| State {
            id: dust.id[i],
            x: dust.x[i],
            v: dust.v[i],
            m: dust.m[i],
            rho: stop.system.dust.derived.rho_gas[i],
            p: 0.0,
        };
        let parcel = |i: usize| State {
            id: gas.id[i],
            x: gas.x[i],
            v: gas.v[i],
            m: gas.m[i],
            rho: stop.system.gas.derived.rho[i],
            p: stop.system.gas.derived.p[i],
        };
        let sorted = |mut states: Vec<State>| {
            states.sort_unstable_by_key(|state| state.id);
            states
        };
        Self {
            gas: sorted((0..gas.x.len()).map(parcel).collect()),
            dust: sorted((0..dust.x.len()).map(grain).collect()),
            books: *stop.books,
        }
    }
}

/// The mixture at each of the stops of a trial.
fn mixtures(mut trial: Trial, stops: &[f64]) -> Vec<Mixture> {
    let mut seen = Vec::new();
    let done = trial.run(stops, |stop| seen.push(Mixture::of(stop)));
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    seen
}
