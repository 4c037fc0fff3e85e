//! What drag costs: a million superparticles at random places in a box of a hundred thousand gas particles, all with one step.
//!
//! CPU time of the search for gas and of both exchanges at a tick, a superparticle; memory of its columns and of the exchange.

use coupling::Phase;
use nbody::points::Columns;

use super::{Bar, Row, Trial};

const GAS: u32 = 46;
const DUST: u32 = 100;
const STEP: f64 = 0.002;
const STEPS: u32 = 4;

pub fn rows() -> Vec<Row> {
    let block = "lo = [0, 0, 0]\nhi = [1, 1, 1]\n";
    let text = format!(
        "[run]\nend_time = 1\ntime_step = {STEP}\n[units]\nsystem = \"dimensionless\"\n\
         [domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         [[gas.block]]\n{block}lattice = \"cubic\"\nspacing = {}\ndensity = 1\npressure = 1\n\
         [[dust.block]]\n{block}lattice = \"random\"\nspacing = {}\ndensity = 0.01\nvelocity = [0.01, 0, 0]\n\
         [dust]\nsize = 1\n[dust.drag]\nlaw = \"epstein\"\n",
        1.0 / f64::from(GAS),
        1.0 / f64::from(DUST)
    );
    let mut trial = Trial::new(&text, &[], |_| {})
        .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"));
    let stops: Vec<f64> = (0..=STEPS).map(|k| f64::from(k) * STEP).collect();
    let (mut bytes, mut laps) = (0.0, Vec::new());
    let done = trial.run(&stops, |stop| {
        let dust = &stop.system.dust;
        let columns = dust.particles.bytes() + dust.derived.bytes() + dust.rates.bytes();
        bytes = columns as f64 / dust.particles.len() as f64;
        let lap = &stop.watch.laps[Phase::Drag as usize];
        laps.push((lap.cpu_s, lap.targets as f64));
    });
    done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
    let ((before, a), (after, b)) = (laps[1], laps[laps.len() - 1]);
    vec![
        Row::new(
            "CPU time of an update of a superparticle by drag, us",
            1e6 * (after - before) / (b - a),
            Bar::Limit([0.5, 1.0]),
        ),
        Row::new(
            "columns of a superparticle, bytes",
            bytes,
            Bar::Limit([200.0, 400.0]),
        ),
    ]
}
