//! Instructions a step of each workload, counted by valgrind and compared with those on record (`UPDATE_INSTRUCTIONS=1` writes the record); those of
//! scenes of one population are compared with those of its crate alone.
//!
//! Valgrind offers programs no AVX-512, so the count is of the AVX2 code, on one thread; it repeats to a part in 1e5, whatever else the
//! machine does. Set-up drops out: a run of two steps is compared with a run of one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use tridisk_tests::{counted, workloads};

/// The program that counts are of.
const WORKLOAD: &str = env!("CARGO_BIN_EXE_workload");

/// How much more instructions than on record a workload may take; much fewer want a new record.
const BAR: f64 = 0.05;

fn record() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/instructions.toml")
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts are of release builds")]
fn no_workload_takes_more_instructions_than_on_record() {
    let counts: BTreeMap<String, f64> = workloads::ALL
        .par_iter()
        .map(|workload| {
            let name = workload.name;
            let step = counted::a_step(WORKLOAD, name);
            (name.to_owned(), (step / 1e3).round() / 1e3)
        })
        .collect();
    if std::env::var_os("UPDATE_INSTRUCTIONS").is_some() {
        let text = toml::to_string(&counts).expect("a table");
        let head = "# Instructions a step, in millions: `UPDATE_INSTRUCTIONS=1 cargo test --release -p tridisk-tests --test instructions`.\n";
        std::fs::write(record(), format!("{head}{text}")).expect("the record is written");
    }
    let text = std::fs::read_to_string(record()).expect("the record");
    let known: BTreeMap<String, f64> = toml::from_str(&text).expect("a table of counts");
    println!("| workload | 1e6 instructions a step | on record |");
    println!("| --- | --- | --- |");
    for (name, count) in &counts {
        println!("| {name} | {count:.3} | {:.3} |", known[name]);
    }
    for (name, count) in &counts {
        let ratio = count / known[name];
        assert!(
            (ratio - 1.0).abs() < BAR,
            "{name}: {ratio:.3} of the instructions on record; a gain wants a new record"
        );
    }
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts are of release builds")]
fn a_scene_of_one_population_costs_what_its_crate_costs() {
    for population in ["gas", "dust", "bodies"] {
        let scene = counted::a_step(WORKLOAD, population);
        let alone = counted::a_step(WORKLOAD, &format!("{population} alone"));
        let ratio = scene / alone;
        println!("{population}: {scene:.3e} instructions a step, {ratio:.4} of its crate's");
        // Both do the same steps: much less would be work left out.
        assert!(ratio < 1.02 && ratio > 0.99, "{population}: {ratio:.4}");
    }
}
