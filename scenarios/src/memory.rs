//! Memory: large buffers go back to the system as soon as they are freed.
//!
//! The allocator of the GNU library learns from the first large buffer that is freed to keep all of that size in its heap, where what lives
//! longer keeps the gaps between from being returned: a sixth of what a million bodies need.

/// Bytes from which on a buffer is a mapping of its own.
#[cfg(target_env = "gnu")]
const LARGE: libc::c_int = 4 << 20;

/// Keeps large buffers out of the heap; to be called before the first is made.
pub fn keep_apart() {
    #[cfg(target_env = "gnu")]
    // SAFETY: sets a parameter of the allocator, which may be done at any time.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
    }
}
