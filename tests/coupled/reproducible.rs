//! The same bits for any number of threads.

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
