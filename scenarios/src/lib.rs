//! The program: scenes, initial states, runs, files, pictures. Files, the wall clock, the terminal and units live here alone.

pub mod document;
pub mod read;
pub mod reader;
pub mod scene;
pub mod units;
pub mod validate;
pub mod write;
