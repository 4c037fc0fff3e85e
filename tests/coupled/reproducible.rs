//! The same bits for any number of threads, and after a restart.

use std::path::Path;

use tempfile::TempDir;
use tridisk::run::{self, Options};
use tridisk::scene::Scene;
use tridisk::snapshot;

use crate::bench;

#[test]
fn a_coupled_run_has_the_same_bits_for_1_2_and_7_threads() {
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a pool");
        pool.install(|| {
            let run = bench::run(
                "coupled/embryo-in-disk.toml",
                &[
                    "run.end_time=\"0.1 yr\"",
                    "gas.particles=3000",
                    "dust.particles=1000",
                    "run.snapshots=\"none\"",
                ],
            );
            std::fs::read_to_string(run.path("ledger.csv")).expect("a ledger")
        })
    };
    let one = run(1);
    assert!(one.lines().count() > 5);
    for threads in [2, 7] {
        assert!(one == run(threads), "{threads} threads differ from one");
    }
}

/// Gas in which all that can be wanted has a memory: sums of pressure, a switch, conducted heat.
const REMEMBERING: [&str; 6] = [
    "run.end_time=0.04",
    "run.snapshots=0.01",
    "gas.hydro.formulation=\"pressure\"",
    "gas.hydro.precision=\"single\"",
    "gas.viscosity.kind=\"cullen-dehnen\"",
    "gas.conduction.alpha=1",
];

#[test]
fn gas_that_sums_pressure_ends_bit_for_bit_the_same_when_its_run_is_resumed() {
    let whole = bench::run("gas/sod.toml", &REMEMBERING);
    let scene = Scene::load(
        &bench::shipped("gas/sod.toml"),
        &REMEMBERING.map(str::to_owned),
    )
    .unwrap_or_else(|refusal| panic!("{refusal}"));
    let folder = TempDir::new().expect("a folder");
    let options = |end_time: Option<f64>| Options {
        output: folder.path().to_path_buf(),
        end_time,
        quiet: true,
    };
    run::run(scene, &options(Some(0.02))).unwrap_or_else(|error| panic!("{error}"));
    assert!(!folder.path().join("snapshot_0004.hdf5").exists());
    run::resume(folder.path(), &options(None)).unwrap_or_else(|error| panic!("{error}"));
    let of = |path: &Path| snapshot::read(path, None).unwrap_or_else(|error| panic!("{error}"));
    let last = whole.snapshots().pop().expect("a snapshot");
    let name = last.file_name().expect("a name");
    assert!(of(&folder.path().join(name)).groups == of(&last).groups);
}
