//! The program: scenes, initial states, runs, files, pictures. Files, the wall clock, the terminal and units live here alone.

pub mod assemble;
pub mod document;
pub mod initial;
pub mod populate;
pub mod read;
pub mod reader;
pub mod run;
pub mod scene;
pub mod schedule;
pub mod stopwatch;
pub mod units;
pub mod validate;
pub mod write;
