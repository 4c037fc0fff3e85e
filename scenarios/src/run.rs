//! The run loop (placeholder).

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::scene::Scene;

/// How a scene is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Folder of the run; exists and holds no other run.
    pub output: PathBuf,
    /// Code units; the scene's own if none.
    pub end_time: Option<f64>,
    pub quiet: bool,
}

/// How a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Done,
    /// By this signal, after a checkpoint.
    Interrupted(i32),
}

#[derive(Debug, Error)]
pub enum RunError {
    /// The scene or the arguments are wrong: exit status 2.
    #[error("{0}")]
    Refused(String),
    /// The run failed: exit status 1.
    #[error("{0}")]
    Failed(String),
}

pub fn run(_scene: Scene, _options: &Options) -> Result<Outcome, RunError> {
    Err(RunError::Failed(
        "runs are not available in this version".into(),
    ))
}

pub fn resume(_folder: &Path, _options: &Options) -> Result<Outcome, RunError> {
    Err(RunError::Failed(
        "runs are not available in this version".into(),
    ))
}
