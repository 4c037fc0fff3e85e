//! What populations do to each other.

pub mod drag;
