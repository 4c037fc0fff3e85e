//! placeholder
use std::path::{Path, PathBuf};
pub fn draw(_path: &Path, _output: Option<&Path>) -> Result<Vec<PathBuf>, String> {
    Ok(vec![])
}
