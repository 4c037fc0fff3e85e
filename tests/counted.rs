//! What a run of the program takes, as the operating system counts it.

use std::process::Command;

/// CPU time, s, and the most memory held at one time, bytes.
pub struct Usage {
    pub cpu_s: f64,
    pub bytes: f64,
}

/// Runs the program to a good end.
///
/// Linux counts a child as at least as large as the process that started it.
#[expect(clippy::zombie_processes, reason = "wait4 waits for it")]
pub fn usage(arguments: &[&str]) -> Usage {
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
    // Linux counts pages in units of 1024 bytes, macOS in bytes.
    let unit = if cfg!(target_os = "macos") {
        1.0
    } else {
        1024.0
    };
    Usage {
        cpu_s: seconds(usage.ru_utime) + seconds(usage.ru_stime),
        bytes: unit * usage.ru_maxrss as f64,
    }
}
