//! Signals that end a run: Ctrl-C and SIGTERM are noted, so that the run can write a checkpoint first; a second one ends it at once.

use std::sync::atomic::{AtomicI32, Ordering};

static CAUGHT: AtomicI32 = AtomicI32::new(0);

extern "C" fn note(signal: libc::c_int) {
    CAUGHT.store(signal, Ordering::Relaxed);
    // SAFETY: signal(2) is async-signal-safe, and SIG_DFL needs no state of ours.
    unsafe { libc::signal(signal, libc::SIG_DFL) };
}

/// Notes SIGINT and SIGTERM from now on.
pub fn listen() {
    for signal in [libc::SIGINT, libc::SIGTERM] {
        let handler = note as extern "C" fn(libc::c_int);
        // SAFETY: the handler does nothing but store to an atomic and call signal(2).
        unsafe { libc::signal(signal, handler as libc::sighandler_t) };
    }
}

/// Ends the program without a word when the reader of its output goes away, as Unix tools do.
pub fn end_on_broken_pipe() {
    // SAFETY: SIG_DFL needs no state of ours.
    unsafe { libc::signal(libc::SIGPIPE, libc::SIG_DFL) };
}

/// The signal that asked the run to end.
pub fn caught() -> Option<i32> {
    match CAUGHT.load(Ordering::Relaxed) {
        0 => None,
        signal => Some(signal),
    }
}

/// A shell's exit status for a program that a signal ended.
pub fn status(signal: i32) -> u8 {
    (128 + signal).clamp(0, 255) as u8
}
