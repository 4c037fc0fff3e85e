//! The program: scenes, initial states, runs, files, pictures. Files, the wall clock, the terminal and units live here alone.

pub mod scene;
pub mod units;
