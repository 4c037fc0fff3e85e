//! Instructions counted by valgrind, on one thread.

use std::process::Command;

/// Those of a run of so many steps, in all.
fn run(program: &str, name: &str, steps: usize) -> f64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(program)
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

/// Those of the second step that the `program` does of what it knows by `name`.
pub fn a_step(program: &str, name: &str) -> f64 {
    run(program, name, 2) - run(program, name, 1)
}
