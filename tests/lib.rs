//! Tests of the whole program; see `physics.rs`.
