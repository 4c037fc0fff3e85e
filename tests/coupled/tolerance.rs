//! Tolerance of the splitting: what a run errs by falls with it, stiff grains that follow the gas do not feel it, and the bits.
//!
//! The error that base steps h keep to is one of velocity and goes as h^2; so does what a run with such steps ends with: both in proportion. Where that
//! tolerance allows steps above Courant's, the gas's own errors are left.

use nbody::points::Vec3;
use tridisk::trial::Trial;

use super::splitting::{Start, WAVE, apart};
use crate::bench;

const END: f64 = 0.192;

/// What a run ends with, and what it took.
struct End {
    /// Positions and velocities of gas and of dust.
    states: [Vec<Vec3>; 2],
    base_steps: u64,
    /// Updates of dust.
    updates: u64,
}

impl End {
    fn of(start: Start, keys: &[String]) -> Self {
        let mut trial = Trial::new(WAVE, keys, |gas| start.prepare(gas)).expect("a scene");
        let mut states = [Vec::new(), Vec::new()];
        let done = trial.run(&[0.0, END], |stop| {
            let (gas, dust) = (&stop.system.gas.particles, &stop.system.dust.particles);
            states = [(&gas.id, &gas.x, &gas.v), (&dust.id, &dust.x, &dust.v)].map(|(id, x, v)| {
                let mut order: Vec<usize> = (0..id.len()).collect();
                order.sort_by_key(|&i| id[i]);
                order.iter().flat_map(|&i| [x[i], v[i]]).collect()
            });
        });
        done.expect("a run");
        Self {
            states,
            base_steps: trial.system.clock.step,
            updates: trial.watch.laps[coupling::Phase::Drag as usize].targets,
        }
    }

    /// Root mean square distances of gas and of dust from `other`.
    fn apart(&self, other: &Self) -> [f64; 2] {
        [0, 1].map(|k| apart(&self.states[k], &other.states[k]))
    }
}

fn keys(stopping_time: f64, more: &str) -> Vec<String> {
    vec![
        format!("dust.drag.stopping_time={stopping_time:e}"),
        more.to_owned(),
    ]
}

#[test]
fn errors_fall_in_proportion_to_the_tolerance() {
    let exact = End::of(Start::Moving, &keys(0.03, "run.time_step=2e-5"));
    let errors = [1e-5, 1e-6, 1e-7, 1e-8].map(|tolerance| {
        let more = format!("coupling.tolerance={tolerance:e}");
        let end = End::of(Start::Moving, &keys(0.03, &more));
        let [gas, dust] = end.apart(&exact);
        println!(
            "tolerance {tolerance:e}: errors of gas {gas:.2e}, of dust {dust:.2e}; {} base steps, {} updates of dust",
            end.base_steps, end.updates
        );
        [gas, dust]
    });
    for (k, what) in ["gas", "dust"].into_iter().enumerate() {
        let slope = (errors[0][k] / errors[3][k]).log10() / 3.0;
        println!("{what}: slope {slope:.3}");
        assert!(slope > 0.85 && slope < 1.15, "{what}: slope {slope}");
    }
}

#[test]
fn stiff_grains_that_follow_the_gas_take_the_steps_of_loose_ones() {
    const REST: &str = "dust.block.0.velocity=[0.0,0.0,0.0]";
    let steps = |stopping_time: f64, more: &str| {
        let mut keys = keys(stopping_time, more);
        keys.push(REST.to_owned());
        let end = End::of(Start::Resting, &keys);
        println!(
            "t_stop {stopping_time:e}, {more}: {} updates of dust",
            end.updates
        );
        end.updates
    };
    for stopping_time in [1e-5, 1e-9, 1e-12] {
        let free = steps(stopping_time, "coupling.feedback=true");
        let held = steps(stopping_time, "coupling.tolerance=1e-3");
        // The steps that double from the first, a thirtieth of a crossing time, to Courant's, and what of Courant's the base steps then cut off.
        assert!(held <= 2 * free + 10 * 144, "{held} in place of {free}");
    }
}

#[test]
fn a_run_with_a_tolerance_ends_bit_for_bit_the_same_when_it_is_resumed() {
    let text = WAVE
        .replace("end_time = 10.0", "end_time = 0.1\nsnapshots = 0.025")
        .replace("stopping_time = 0.3", "stopping_time = 0.03");
    let scene = bench::parsed(&format!("{text}[coupling]\ntolerance = 1e-6\n"));
    assert!(bench::resumes(scene, 2.0));
}
