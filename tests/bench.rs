//! The bench of the tests: runs a scene into a folder of its own and reads what the run left there.

use std::path::{Path, PathBuf};

use tempfile::TempDir;
use tridisk::history;
use tridisk::run::{self, Options, Outcome};
use tridisk::scene::{Scene, Snapshots};
use tridisk::snapshot::{self, Particles};

/// A shipped scene.
pub fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios")
        .join(name)
}

/// A run that has ended.
pub struct Done {
    folder: TempDir,
}

/// A shipped scene with overrides.
pub fn scene(name: &str, overrides: &[&str]) -> Scene {
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    Scene::load(&shipped(name), &overrides).unwrap_or_else(|refusal| panic!("{refusal}"))
}

/// A scene given as text.
pub fn parsed(text: &str) -> Scene {
    let scene = Scene::parse(text, "trial", Path::new("."), &[]);
    scene.unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// Runs a shipped scene with overrides.
pub fn run(name: &str, overrides: &[&str]) -> Done {
    run_scene(scene(name, overrides))
}

/// Whether a scene ends bit for bit the same when its run stops after so many of its snapshots' intervals and is resumed there.
pub fn resumes(scene: Scene, intervals: f64) -> bool {
    let whole = run_scene(scene.clone());
    let folder = TempDir::new().expect("a folder");
    let options = |end_time: Option<f64>| Options {
        output: folder.path().to_path_buf(),
        end_time,
        quiet: true,
    };
    let Snapshots::Every(interval) = scene.run.snapshots else {
        panic!("snapshots at equal intervals");
    };
    let stop = options(Some(intervals * interval));
    let last = whole.snapshots().pop().expect("a snapshot");
    let again = folder.path().join(last.file_name().expect("a name"));
    run::run(scene, &stop).unwrap_or_else(|error| panic!("{error}"));
    assert!(!again.exists(), "the run has not stopped before its end");
    run::resume(folder.path(), &options(None)).unwrap_or_else(|error| panic!("{error}"));
    let of = |path: &Path| snapshot::read(path, None).unwrap_or_else(|error| panic!("{error}"));
    let ledger = |path: &Path| std::fs::read_to_string(path).expect("a ledger");
    let books = [whole.path("ledger.csv"), folder.path().join("ledger.csv")];
    let [straight, resumed] = books.each_ref().map(|path| ledger(path));
    of(&again).groups == of(&last).groups && straight == resumed
}

/// Runs a scene given as text.
pub fn run_text(text: &str) -> Done {
    run_scene(parsed(text))
}

/// Runs a scene.
pub fn run_scene(scene: Scene) -> Done {
    let folder = TempDir::new().expect("a folder");
    let options = Options {
        output: folder.path().to_path_buf(),
        end_time: None,
        quiet: true,
    };
    let outcome = run::run(scene, &options).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(outcome, Outcome::Done);
    Done { folder }
}

/// Runs a scene given as text, or says why it cannot.
pub fn attempt(text: &str) -> Result<Done, String> {
    let scene = Scene::parse(text, "trial", Path::new("."), &[]);
    let scene = scene.map_err(|problems| format!("{problems:?}"))?;
    let folder = TempDir::new().expect("a folder");
    let options = Options {
        output: folder.path().to_path_buf(),
        end_time: None,
        quiet: true,
    };
    match run::run(scene, &options) {
        Ok(Outcome::Done) => Ok(Done { folder }),
        Ok(other) => Err(format!("{other:?}")),
        Err(error) => Err(error.to_string()),
    }
}

impl Done {
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A column of the ledger.
    pub fn ledger(&self, column: &str) -> Vec<f64> {
        let columns = history::read_numbers(&self.path("ledger.csv")).expect("a ledger");
        columns
            .into_iter()
            .find(|(name, _)| name == column)
            .unwrap_or_else(|| panic!("no column {column}"))
            .1
    }

    /// The largest absolute value in a column of the ledger; not a number if there is one that is none.
    pub fn largest(&self, column: &str) -> f64 {
        self.ledger(column)
            .into_iter()
            .map(f64::abs)
            .fold(0.0, |a, b| if a >= b { a } else { b })
    }

    pub fn snapshots(&self) -> Vec<PathBuf> {
        (0..)
            .map(|k| self.path(&format!("snapshot_{k:04}.hdf5")))
            .take_while(|path| path.is_file())
            .collect()
    }

    /// A population of a snapshot, ordered by id.
    pub fn particles(&self, snapshot: &Path, part_type: usize) -> Particles {
        let contents = snapshot::read(snapshot, None).unwrap_or_else(|error| panic!("{error}"));
        let rows = contents.group(part_type).expect("the population").clone();
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|&i| rows.id[i]);
        let more = rows
            .more
            .iter()
            .map(|(&name, v)| (name, order.iter().map(|&i| v[i]).collect()))
            .collect();
        Particles {
            part_type,
            id: order.iter().map(|&i| rows.id[i]).collect(),
            x: order.iter().map(|&i| rows.x[i]).collect(),
            v: order.iter().map(|&i| rows.v[i]).collect(),
            m: order.iter().map(|&i| rows.m[i]).collect(),
            spin: order
                .iter()
                .filter_map(|&i| rows.spin.get(i).copied())
                .collect(),
            composition: order
                .iter()
                .filter_map(|&i| rows.composition.get(i).copied())
                .collect(),
            more,
        }
    }

    pub fn time(&self, snapshot: &Path) -> f64 {
        snapshot::read(snapshot, None)
            .unwrap_or_else(|error| panic!("{error}"))
            .time
    }
}
