//! Files of a run: how many bytes they will have, and what writing them costs.

use coupling::System;
use coupling::ledger::{Census, Ledger, Totals};
use cpu_time::ProcessTime;
use nbody::points::{ColumnRef, Columns, Keep};

use super::sets;
use crate::run::{self, REPORTS};
use crate::scene::{Scene, Snapshots};

/// CPU time of a snapshot, s: the second of two is measured, since the first starts the library. None where no temporary file can be written.
pub fn seconds(scene: &Scene, system: &System) -> f64 {
    let folder = std::env::temp_dir().join(format!("tridisk-plan-{}", std::process::id()));
    if std::fs::create_dir_all(&folder).is_err() {
        return 0.0;
    }
    let path = folder.join("snapshot.hdf5");
    let mut last = 0.0;
    for _ in 0..2 {
        let began = ProcessTime::now();
        if run::snapshot(&path, scene, system).is_ok() {
            last = began.elapsed().as_secs_f64();
        }
    }
    // What is left there is the system's to clear.
    let _ = std::fs::remove_dir_all(&folder);
    last
}

/// Bytes of a snapshot.
pub fn snapshot_bytes(scene: &Scene, system: &System) -> f64 {
    let shown = |set: &&dyn Columns| -> usize {
        let list = set.list();
        let columns = list
            .iter()
            .filter(|(label, _)| matches!(label.keep, Keep::Snapshot));
        columns.map(|(_, column)| bytes(column)).sum()
    };
    let columns: usize = sets(system).iter().flatten().map(shown).sum();
    // Beside the columns: temperatures, numbers of a swarm, densities; accelerations and potentials if wanted.
    let number = system.gas.len() + system.dust.len() + system.bodies.len();
    let more = if scene.run.write_accelerations { 64 } else { 8 };
    (columns + number * more) as f64
}

fn bytes(column: &ColumnRef) -> usize {
    match column {
        ColumnRef::Real(v) => size_of_val(*v),
        ColumnRef::Vector(v) => size_of_val(*v),
        ColumnRef::Integer(v) => size_of_val(*v),
        ColumnRef::Short(v) => size_of_val(*v),
    }
}

/// Snapshots that the run writes.
pub fn snapshots(scene: &Scene) -> f64 {
    match &scene.run.snapshots {
        Snapshots::None => 0.0,
        Snapshots::Every(interval) => (scene.run.end_time / interval - 1e-9).ceil() + 1.0,
        Snapshots::At(times) => {
            let inside = |t: &&f64| **t > 0.0 && **t < scene.run.end_time;
            times.iter().filter(inside).count() as f64 + 2.0
        }
    }
}

/// Bytes that a run writes: snapshots of `each`, a checkpoint of `state`, and the layout and tables around them, with the lines that the books of the sample
/// would have had.
pub fn disk(scene: &Scene, each: f64, state: f64, ledger: &Ledger) -> f64 {
    const LAYOUT: f64 = 3.2e4;
    const LINE: f64 = 200.0;
    let filled = |census: &Census| census.0.iter().filter(|t| **t != Totals::default()).count();
    let changes = ledger.entries.iter().map(|entry| filled(&entry.change));
    let lines = 1 + filled(&ledger.initial) + changes.sum::<usize>();
    snapshots(scene) * (each + LAYOUT) + state + 2.0 * LAYOUT + REPORTS * LINE * lines as f64
}
