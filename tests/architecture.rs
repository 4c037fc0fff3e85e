//! Rules of the house: imports run one way, files begin with a sentence, scenes carry titles.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn sources(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            sources(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

fn of(part: &str) -> Vec<(PathBuf, String)> {
    let mut files = Vec::new();
    sources(&root().join(part), &mut files);
    files.sort();
    files
        .into_iter()
        .map(|path| (path.clone(), fs::read_to_string(&path).expect("text")))
        .collect()
}

#[test]
fn imports_run_one_way() {
    let barred = [
        (
            "nbody/src",
            vec!["gas::", "dust::", "coupling::", "tridisk::"],
        ),
        ("gas/src", vec!["dust::", "coupling::", "tridisk::"]),
        ("dust/src", vec!["gas::", "coupling::", "tridisk::"]),
        ("coupling/src", vec!["tridisk::"]),
    ];
    for (part, names) in barred {
        for (path, text) in of(part) {
            for line in text
                .lines()
                .filter(|line| !line.trim_start().starts_with("//"))
            {
                for name in &names {
                    let used = line.trim_start().starts_with(&format!("use {name}"))
                        || line.contains(&format!(" {name}"));
                    assert!(!used, "{}: {line}", path.display());
                }
            }
        }
    }
}

#[test]
fn files_clocks_and_terminals_belong_to_the_program() {
    let barred = ["std::fs", "std::io", "std::time", "println!", "std::env"];
    for part in ["nbody/src", "gas/src", "dust/src", "coupling/src"] {
        for (path, text) in of(part) {
            // Tests may say what they measured.
            let code = text.split("#[cfg(test)]").next().unwrap_or_default();
            if path.to_string_lossy().contains("test") {
                continue;
            }
            for name in barred {
                assert!(!code.contains(name), "{} uses {name}", path.display());
            }
        }
    }
}

#[test]
fn every_file_begins_by_saying_what_it_is() {
    for part in ["nbody", "gas", "dust", "coupling", "scenarios", "tests"] {
        for (path, text) in of(part) {
            assert!(
                text.starts_with("//! "),
                "{} has no first sentence",
                path.display()
            );
        }
    }
}
