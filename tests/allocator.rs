//! The system's allocator, which counts what threads ask of it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

/// Calls of all threads that are watched.
static WATCHED: AtomicU64 = AtomicU64::new(0);

thread_local! {
    static WATCH: Cell<bool> = const { Cell::new(false) };
    static CALLS: Cell<u64> = const { Cell::new(0) };
    static HELD: Cell<i64> = const { Cell::new(0) };
}

/// Calls of this thread for memory so far, and bytes that it has asked for and not given back.
pub fn asked() -> (u64, i64) {
    (CALLS.get(), HELD.get())
}

/// Watches this thread from now on.
pub fn watch() {
    WATCH.set(true);
}

/// Calls for memory of the watched threads so far.
pub fn watched() -> u64 {
    WATCHED.load(Ordering::Relaxed)
}

fn count(calls: u64, bytes: i64) {
    // A thread that ends has no counts any more.
    let _ = CALLS.try_with(|all| all.set(all.get() + calls));
    if WATCH.try_with(Cell::get).unwrap_or(false) {
        WATCHED.fetch_add(calls, Ordering::Relaxed);
    }
    let _ = HELD.try_with(|all| all.set(all.get() + bytes));
}

// SAFETY: everything is left to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(1, layout.size() as i64);
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        count(0, -(layout.size() as i64));
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(1, size as i64 - layout.size() as i64);
        // SAFETY: the caller's promise.
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;
