//! The same bits for any number of threads, and after a restart.

use crate::bench;

/// The ledger of a run of a scene with some keys and so many threads.
fn ledger(threads: usize, scene: &str, keys: &[&str]) -> String {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .expect("a pool");
    pool.install(|| {
        let run = bench::run(scene, keys);
        std::fs::read_to_string(run.path("ledger.csv")).expect("a ledger")
    })
}

#[test]
fn a_coupled_run_has_the_same_bits_for_1_2_and_7_threads() {
    let keys = [
        "run.end_time=\"0.1 yr\"",
        "gas.particles=3000",
        "dust.particles=1000",
        "run.snapshots=\"none\"",
    ];
    let run = |threads| ledger(threads, "coupled/embryo-in-disk.toml", &keys);
    let one = run(1);
    assert!(one.lines().count() > 5);
    for threads in [2, 7] {
        assert!(one == run(threads), "{threads} threads differ from one");
    }
}

/// Pebbles whose ice goes into the gas.
const THAWING: [&str; 4] = [
    "run.end_time=\"0.5 yr\"",
    "run.snapshots=\"0.1 yr\"",
    "gas.particles=3000",
    "dust.particles=2000",
];

#[test]
fn a_snow_line_has_the_same_bits_for_any_threads_and_when_its_run_is_resumed() {
    let run = |threads| ledger(threads, "coupled/snow-line.toml", &THAWING);
    assert!(run(1) == run(7), "7 threads differ from one");
    let scene = bench::scene("coupled/snow-line.toml", &THAWING);
    assert!(bench::resumes(scene, 2.0));
}

/// A thin, coarse shock tube of 7200 particles, in which all that can be wanted has a memory: sums of pressure, a switch, conducted heat, a background.
const REMEMBERING: &str = r#"
[run]
end_time = 0.08
snapshots = 0.02
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [2.0, 0.16, 0.16]
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [1.0, 0.16, 0.16]
lattice = "bcc"
spacing = 0.015874010519682
density = 1.0
pressure = 1.0
[[gas.block]]
lo = [1.0, 0.0, 0.0]
hi = [2.0, 0.16, 0.16]
lattice = "bcc"
spacing = 0.031748021039364
density = 0.125
pressure = 0.1
[gas.eos]
kind = "ideal"
gamma = 1.6666666666666667
[gas.hydro]
formulation = "pressure"
precision = "single"
background_pressure = "least"
[gas.viscosity]
kind = "cullen-dehnen"
[gas.conduction]
alpha = 1
"#;

#[test]
fn gas_that_sums_pressure_ends_bit_for_bit_the_same_when_its_run_is_resumed() {
    let scene = bench::parsed(REMEMBERING);
    assert!(bench::resumes(scene, 2.0));
}

/// A disk that pulls itself, by a field whose steps are its own.
const FALLING: [&str; 4] = [
    "run.end_time=\"0.4 yr\"",
    "run.snapshots=\"0.1 yr\"",
    "gas.particles=3000",
    "gravity.separate_steps=true",
];

#[test]
fn a_disk_that_pulls_itself_ends_bit_for_bit_the_same_when_its_run_is_resumed() {
    let scene = bench::scene("gas/disk.toml", &FALLING);
    assert!(bench::resumes(scene, 2.0));
}
