//! Instructions a step of each workload, counted by valgrind and compared with those on record; `UPDATE_INSTRUCTIONS=1` writes the record.
//!
//! Valgrind offers programs no AVX-512, so the count is of the AVX2 code, on one thread; it repeats to a part in 1e5, whatever else the
//! machine does. Set-up drops out: a run of two steps is compared with a run of one.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use rayon::prelude::*;
use tridisk_tests::workloads;

/// How much more instructions than on record a workload may take; much fewer want a new record.
const BAR: f64 = 0.05;

fn record() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/instructions.toml")
}

/// Instructions of a run, in all.
fn counted(name: &str, steps: usize) -> f64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(env!("CARGO_BIN_EXE_workload"))
        .args([name, &steps.to_string()])
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("valgrind, which setup.sh installs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name}: {said}");
    let line = said.lines().find(|line| line.contains("Collected :"));
    let word = line.and_then(|line| line.split_whitespace().last());
    word.and_then(|word| word.parse().ok())
        .unwrap_or_else(|| panic!("no count in {said}"))
}

#[test]
#[cfg_attr(debug_assertions, ignore = "counts are of release builds")]
fn no_workload_takes_more_instructions_than_on_record() {
    let counts: BTreeMap<String, f64> = workloads::ALL
        .par_iter()
        .map(|workload| {
            let name = workload.name;
            let step = counted(name, 2) - counted(name, 1);
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
