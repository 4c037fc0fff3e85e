//! Timings: the phases of a run add up to what the operating system says it has cost.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

/// Runs the program; returns its CPU time as the system counts it, s.
#[expect(clippy::zombie_processes, reason = "wait4 waits for it")]
fn cpu_seconds(arguments: &[&str]) -> f64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tridisk"));
    let child = command.args(arguments).spawn().expect("the program starts");
    let pid = child.id() as libc::pid_t;
    // SAFETY: all zeros is a value of this plain struct.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    let mut status = 0;
    // SAFETY: both references outlive the call, and nobody else waits for this child.
    let ended = unsafe { libc::wait4(pid, &raw mut status, 0, &raw mut usage) };
    assert_eq!((ended, status), (pid, 0), "the run ends well");
    let seconds = |time: libc::timeval| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64;
    seconds(usage.ru_utime) + seconds(usage.ru_stime)
}

#[test]
fn the_phases_of_a_run_add_up_to_its_cpu_time() {
    let folder = TempDir::new().expect("a folder");
    let output = folder.path().to_string_lossy().into_owned();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("coupled/embryo-in-disk.toml");
    let spent = cpu_seconds(&[
        "run",
        &scene.to_string_lossy(),
        "--output",
        &output,
        "--quiet",
        "--threads",
        "2",
        "--set",
        "run.end_time=\"0.2 yr\"",
        "--set",
        "gas.particles=4000",
        "--set",
        "dust.particles=1000",
    ]);
    let text = std::fs::read_to_string(folder.path().join("timings.json")).expect("timings");
    let timings: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let phases = timings["phases"].as_object().expect("phases");
    let sum: f64 = phases.values().filter_map(|p| p["cpu_s"].as_f64()).sum();
    let said = timings["cpu_s"].as_f64().expect("a number");
    println!("phases {sum:.2} s, in all {said:.2} s, by the system {spent:.2} s");
    assert!((sum / said - 1.0).abs() < 1e-6, "{sum} of {said}");
    // What the program does before its stopwatch starts is left out.
    assert!((sum / spent - 1.0).abs() < 0.05, "{sum} s of {spent} s");
}
