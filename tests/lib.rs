//! Tests of the whole program; see `physics.rs`.

#[path = "benches/counted.rs"]
pub mod counted;
#[path = "benches/subsets.rs"]
pub mod subsets;
#[path = "benches/workloads.rs"]
pub mod workloads;
