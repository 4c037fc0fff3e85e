//! The program: scenes, initial states, runs, files, pictures. Files, the wall clock, the terminal and units live here alone.

pub mod assemble;
pub mod atomic;
pub mod checkpoint;
pub mod command_line;
pub mod document;
pub mod hdf;
pub mod history;
pub mod info;
pub mod initial;
mod memory;
pub mod new;
pub mod outline;
pub mod plot;
pub mod populate;
pub mod progress;
pub mod read;
pub mod reader;
pub mod run;
pub mod scene;
pub mod schedule;
pub mod signals;
pub mod snapshot;
pub mod stopwatch;
pub mod units;
pub mod validate;
pub mod verify;
pub mod write;
