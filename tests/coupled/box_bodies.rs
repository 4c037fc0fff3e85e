//! Bodies in a shearing box with gas: drift against a headwind, momentum, threads, restarts.
//!
//! Source of the drift: Weidenschilling (1977), MNRAS 180, 57; Nakagawa, Sekiya & Hayashi (1986), Icarus 67, 375.

use nbody::points::{Hill, Vec3};
use tridisk::trial::Trial;

use crate::bench;
use crate::gas::shearing::STRATIFIED;

const HEADWIND: f64 = 0.1;
const STOKES: f64 = 0.25;

/// A test particle in gas that turns slower than it does.
const WIND: &str = r#"
[run]
end_time = 100.0
[units]
system = "dimensionless"
[domain]
kind = "shearing-box"
size = [1.0, 1.0, 1.0]
rate = 1.0
headwind = 0.1
[[gas.block]]
lo = [0, 0, 0]
hi = [1, 1, 1]
spacing = 0.125
density = 1.0
velocity = [0.0, -0.1, 0.0]
[gas.eos]
kind = "isothermal"
sound_speed = 1.0
[gas.viscosity]
kind = "none"
[planetesimals.drag]
law = "constant-stopping-time"
stopping_time = 0.25
[[planet]]
mass = 0.0
position = [0.3, 0.4, 0.5]
velocity = [0.0, 0.0, 0.0]
"#;

const FRAME: Hill = Hill {
    rate: 1.0,
    shear: 1.5,
    middle: 0.5,
};

/// How far the velocity relative to the shear is from that of steady drift, in units of the headwind, after four stopping times in steps of
/// `step` / Omega.
fn error_of_drift(step: f64) -> f64 {
    let share = HEADWIND / (1.0 + STOKES * STOKES);
    let exact = share * Vec3::new(-2.0 * STOKES, -1.0, 0.0);
    let overrides = [
        format!("accuracy.orbit_step={step}"),
        format!("planet.0.velocity=[{:e},{:e},0.0]", exact.x, exact.y),
    ];
    let mut trial = Trial::new(WIND, &overrides, |_| {}).expect("a scene");
    let mut error = f64::NAN;
    let done = trial.run(&[0.0, 4.0 * STOKES], |stop| {
        let bodies = &stop.system.bodies;
        let w = FRAME.relative(bodies.x[0], bodies.v[0]);
        error = (w - exact).norm() / HEADWIND;
    });
    done.expect("a run");
    println!("steps of {step}: drift wrong by {error:e} of the headwind");
    error
}

#[test]
fn a_body_drifts_against_the_headwind_as_theory_says() {
    let (coarse, fine) = (error_of_drift(0.1), error_of_drift(0.05));
    // Halves of drag about a whole of the frame keep a velocity that is off by 0.355 h^2; the gas, kicked in halves by its push, begins off by
    // h^2 / 12 of its own, which the frame turns to twice that.
    let bar = |h: f64| (0.355 + 2.0 / 12.0) * h * h;
    assert!(
        coarse < bar(0.1) && fine < bar(0.05),
        "{coarse:e}, {fine:e}"
    );
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.3, "order {order}");
}

/// Heavy bodies that cross the faces of a stratified box.
const HEAVY: &str = r#"
[planetesimals.drag]
law = "quadratic"
coefficient = 2.0
[[planet]]
mass = 0.3
position = [0.95, 0.4, 1.2]
velocity = [0.6, 0.1, 0.2]
[[planet]]
mass = 0.2
position = [0.1, 0.8, 0.9]
velocity = [-0.5, 0.3, -0.1]
[[planet]]
mass = 0.0
position = [0.6, 0.1, 1.0]
velocity = [0.0, 0.0, 0.0]
"#;

#[test]
fn bodies_in_a_box_have_the_same_bits_for_1_and_2_threads_and_after_a_restart() {
    let text = STRATIFIED.replace("end_time = 0.4", "end_time = 0.8");
    let text = text.replace(
        "snapshots = 0.1",
        "snapshots = 0.2\nwrite_accelerations = true",
    ) + HEAVY;
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().expect("a pool").install(|| {
            let run = bench::run_text(&text);
            let lost = run.largest("error_momentum");
            println!("momentum: {lost:e}");
            assert!(lost < 2e-13, "{lost:e}");
            let ends = run
                .snapshots()
                .iter()
                .map(|path| run.particles(path, 1).x[0].x)
                .collect::<Vec<_>>();
            println!("the first body is at {ends:?}");
            assert!(ends.iter().any(|&x| x < 0.5), "nobody crosses");
            std::fs::read_to_string(run.path("ledger.csv")).expect("a ledger")
        })
    };
    assert!(run(1) == run(2));
    assert!(bench::resumes(bench::parsed(&text), 2.0));
}
