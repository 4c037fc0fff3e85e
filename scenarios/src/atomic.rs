//! Files that appear whole or not at all: written under another name, brought to the disk, then renamed.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// The name under which a file is written until it is whole.
pub fn draft(path: &Path) -> PathBuf {
    let mut name = OsString::from(path.as_os_str());
    name.push(".tmp");
    PathBuf::from(name)
}

/// Writes a file by `write`, which gets the draft's path; leaves neither draft nor half a file when it fails.
pub fn publish<E: From<io::Error>>(
    path: &Path,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    let draft = draft(path);
    let outcome = write(&draft).and_then(|()| settle(&draft, path).map_err(E::from));
    if outcome.is_err() {
        // The first error is the one to report.
        let _ = fs::remove_file(&draft);
    }
    outcome
}

/// A file of the given bytes.
pub fn publish_bytes(path: &Path, bytes: &[u8]) -> io::Result<()> {
    publish(path, |draft| fs::write(draft, bytes))
}

fn settle(draft: &Path, path: &Path) -> io::Result<()> {
    File::open(draft)?.sync_all()?;
    fs::rename(draft, path)?;
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    File::open(folder.unwrap_or(Path::new(".")))?.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = std::env::temp_dir().join(format!("tridisk-atomic-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let path = folder.join("file");
        publish_bytes(&path, b"old").unwrap();
        let failed = publish(&path, |draft| {
            fs::write(draft, b"ne")?;
            Err(io::Error::other("full"))
        });
        assert!(failed.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        publish_bytes(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        fs::remove_dir_all(&folder).unwrap();
    }
}
