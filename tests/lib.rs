//! Tests of the whole program; see `physics.rs`.

#[path = "benches/workloads.rs"]
pub mod workloads;
