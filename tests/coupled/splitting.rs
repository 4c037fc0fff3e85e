//! Order of the splitting: with steps that are halved, what a run ends with converges with the square of the step, for each pair of processes.
//!
//! No exact answer is needed: the ends y of runs with steps dt, dt/2, dt/4 have |y(dt) - y(dt/2)| / |y(dt/2) - y(dt/4)| = 2^order. In the stiff
//! regime the stopping time is a thousandth of the longest step. There what relaxes within the first step is a layer that no such step resolves: with
//! feedback its heat, which the forces at the start have not seen, leaves an error of first order. So the start is one at rest, or after the layer.

use std::f64::consts::TAU;

use coupling::System;
use nbody::points::Vec3;
use tridisk::trial::Trial;

/// A wave of gas through which grains move, all with one step.
pub const WAVE: &str = r#"
[run]
end_time = 10.0
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [1.0, 1.0, 1.0]
dimensions = 2
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.0625
density = 1.0
pressure = 0.6
[gas.eos]
kind = "ideal"
gamma = 1.6666666666666667
[gas.hydro]
tolerance = 1e-11
[gas.viscosity]
kind = "none"
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.08333333333333333
density = 0.5
velocity = [0.1, 0.3, 0.0]
[dust.drag]
law = "constant-stopping-time"
stopping_time = 0.3
"#;

/// As much of a second kind of grains, a hundred times as loose as stiff ones are.
const SECOND: &str = r#"
[[dust.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.08333333333333333
density = 0.5
velocity = [0.1, 0.3, 0.0]
stopping_time = 4e-4
"#;

const STEP: f64 = 0.004;
const END: f64 = 0.192;

/// How the gas starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// With a wave of its velocity, through grains of another.
    Moving,
    /// At rest like the grains, with a wave of its pressure.
    Resting,
    /// As it moves after a step.
    Settled,
}

impl Start {
    pub fn prepare(self, gas: &mut gas::Particles) {
        for i in 0..gas.x.len() {
            let (x, y) = (TAU * gas.x[i].x, TAU * gas.x[i].y);
            match self {
                Self::Moving | Self::Settled => {
                    gas.v[i] += Vec3::new(0.1 * x.sin(), 0.05 * (x + y).cos(), 0.0);
                }
                Self::Resting => gas.u[i] *= 1.0 + 0.2 * x.sin() + 0.1 * (x + y).cos(),
            }
        }
    }
}

/// Positions and velocities of all gas and dust, then heat of the gas as vectors, by id.
#[derive(Clone, Default)]
struct State(Vec<Vec3>);

impl State {
    fn of(system: &System) -> Self {
        let (gas, dust) = (&system.gas.particles, &system.dust.particles);
        let mut found = Vec::new();
        for (id, x, v) in [(&gas.id, &gas.x, &gas.v), (&dust.id, &dust.x, &dust.v)] {
            found.extend(places(id).into_iter().flat_map(|i| [x[i], v[i]]));
        }
        let heat = places(&gas.id).into_iter().map(|i| gas.u[i] * Vec3::x());
        found.extend(heat);
        Self(found)
    }

    /// Places gas and dust so.
    fn prepare(&self, gas: &mut gas::Particles, dust: &mut dust::Superparticles) {
        let mut next = self.0.iter();
        let mut pair = || [(); 2].map(|()| *next.next().expect("a vector"));
        places(&gas.id)
            .into_iter()
            .for_each(|i| [gas.x[i], gas.v[i]] = pair());
        places(&dust.id)
            .into_iter()
            .for_each(|i| [dust.x[i], dust.v[i]] = pair());
        for (i, u) in places(&gas.id).into_iter().zip(next) {
            gas.u[i] = u.x;
        }
    }
}

/// Places in the order of ids.
fn places(id: &[u64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..id.len()).collect();
    order.sort_by_key(|&i| id[i]);
    order
}

/// The end, after `end`, of a run with steps of `step`.
fn run(
    second: &str,
    more: &[&str],
    (end, step): (f64, f64),
    start: impl FnOnce(&mut gas::Particles, &mut dust::Superparticles),
) -> State {
    let mut overrides: Vec<String> = more.iter().map(|&o| o.to_owned()).collect();
    overrides.push(format!("run.time_step={step}"));
    let mut trial = Trial::prepared(&[WAVE, second].concat(), &overrides, start).expect("a scene");
    let mut found = State::default();
    let done = trial.run(&[0.0, end], |stop| {
        found = State::of(stop.system);
        let steps = stop.system.clock.step as f64;
        assert!(
            steps == 0.0 || (steps * step / end - 1.0).abs() < 1e-9,
            "{steps} steps"
        );
    });
    done.expect("a run");
    found
}

/// Root mean square distance of `a` and `b`.
pub fn apart(a: &[Vec3], b: &[Vec3]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()).sum();
    (sum / a.len() as f64).sqrt()
}

/// How far the ends of runs with steps of STEP and half of it, and of that and a quarter, are apart.
fn differences(start: Start, second: &str, more: &[&str]) -> [f64; 2] {
    // What moves through stiff grains starts after they have come to move with it.
    let settled = (start == Start::Settled).then(|| {
        let layer = (STEP, STEP / 64.0);
        run(second, more, layer, |gas, _| Start::Moving.prepare(gas))
    });
    let ends = [1.0, 2.0, 4.0].map(|part| {
        run(
            second,
            more,
            (END, STEP / part),
            |gas, dust| match &settled {
                Some(state) => state.prepare(gas, dust),
                None => start.prepare(gas),
            },
        )
    });
    let found = [0, 1].map(|k| apart(&ends[k].0, &ends[k + 1].0));
    let order = (found[0] / found[1]).log2();
    println!(
        "{start:?}, {} kinds, {more:?}: differences {:.2e}, {:.2e}, order {order:.3}",
        if second.is_empty() { 1 } else { 2 },
        found[0],
        found[1]
    );
    found
}

const REST: &str = "dust.block.0.velocity=[0.0,0.0,0.0]";
const HEAVY: &str = "dust.block.0.density=10.0";
const LIGHT: &str = "dust.block.0.density=0.08";

#[test]
fn steps_that_are_halved_leave_a_quarter_of_the_error() {
    const STIFF: &str = "dust.drag.stopping_time=4e-6";
    const LOOSE: &str = "dust.drag.stopping_time=1e6";
    const ONE_WAY: &str = "coupling.feedback=false";
    for (start, more) in [
        (Start::Moving, &[][..]),
        (Start::Moving, &[HEAVY]),
        (Start::Moving, &[LOOSE]),
        (Start::Moving, &[ONE_WAY]),
        (Start::Moving, &[ONE_WAY, STIFF]),
        (Start::Resting, &[STIFF, REST]),
        (Start::Resting, &[STIFF, REST, HEAVY]),
        (Start::Resting, &[STIFF, REST, LIGHT]),
        (Start::Settled, &[STIFF]),
        (Start::Settled, &[STIFF, HEAVY]),
    ] {
        let [coarse, fine] = differences(start, "", more);
        let order = (coarse / fine).log2();
        assert!(
            order > 1.9 && order < 2.1,
            "{start:?}, {more:?}: order {order}"
        );
    }
}

#[test]
fn kinds_of_grains_that_differ_keep_the_order() {
    const LOOSE: &str = "dust.block.1.stopping_time=0.4";
    // The least order: between loose and stiff grains errors fall a little less fast.
    for (first, more, least) in [
        ("dust.drag.stopping_time=4e-6", &[][..], 1.9),
        ("dust.drag.stopping_time=0.04", &[LOOSE], 1.9),
        ("dust.drag.stopping_time=0.04", &[], 1.85),
    ] {
        let rest = [first, REST, "dust.block.1.velocity=[0.0,0.0,0.0]"];
        let [coarse, fine] = differences(Start::Resting, SECOND, &[&rest, more].concat());
        let order = (coarse / fine).log2();
        assert!(
            order > least && order < 2.1,
            "{first}, {more:?}: order {order}"
        );
    }
}

#[test]
fn between_loose_and_stiff_the_error_falls_as_fast_and_is_no_larger() {
    const RATIOS: [f64; 9] = [1e-6, 0.1, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 1e3];
    for light_or_heavy in [&[REST][..], &[REST, HEAVY]] {
        let found = RATIOS.map(|step_by_stopping_time| {
            let t = &format!("dust.drag.stopping_time={}", STEP / step_by_stopping_time);
            differences(
                Start::Resting,
                "",
                &[&[t.as_str()], light_or_heavy].concat(),
            )
        });
        let largest = found[0][1].max(found[8][1]);
        for ([coarse, fine], ratio) in found.into_iter().zip(RATIOS) {
            let order = (coarse / fine).log2();
            assert!(
                order > 1.85 && fine <= largest,
                "{ratio}: {fine:e}, order {order}"
            );
        }
    }
}

#[test]
fn light_grains_do_not_hold_what_the_gas_does_beyond_their_own_push() {
    for (density, held) in [(HEAVY, 24 * 144), (LIGHT, 0)] {
        let mut trial = Trial::prepared(WAVE, &[density.to_owned()], |_, _| ()).expect("a scene");
        trial.run(&[0.0, 0.1], |_| ()).expect("a run");
        let excess = &trial.system.dust.rates.excess;
        assert_eq!(std::mem::size_of_val(excess.as_slice()), held, "{density}");
    }
}
