//! Collisions in a narrow, dense ring: books that close, fragments with names of their own, and the same run after a break.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use tempfile::TempDir;
use tridisk::run::{self, Options};
use tridisk::scene::{Scene, TimeStep};

use crate::bench::{self, shipped};

const SCENE: &str = "nbody/colliding-belt.toml";

fn options(folder: &Path, end_time: Option<f64>) -> Options {
    Options {
        output: folder.to_path_buf(),
        end_time,
        quiet: true,
    }
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).expect("a file of the run")
}

#[test]
fn a_colliding_belt_keeps_its_books() {
    let run = bench::run(SCENE, &[]);
    let mut kinds = BTreeMap::new();
    let (mut gone, mut new) = (0, 0);
    let events = fs::read_to_string(run.path("events.csv")).expect("the events");
    for line in events.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        *kinds.entry(cells[1].to_owned()).or_insert(0) += 1;
        gone += usize::from(!cells[1].contains("run"));
        new += cells[12].parse::<usize>().expect("a number of fragments");
    }
    let (mass, momentum, angular) = (
        run.largest("error_mass"),
        run.largest("error_momentum"),
        run.largest("error_angular_momentum"),
    );
    println!(
        "{kinds:?}, {new} fragments, mass {mass:.1e}, momentum {momentum:.1e}, angular momentum {angular:.1e}, energy {:.1e}",
        run.largest("error_energy")
    );
    assert!(
        kinds.len() >= 5 && kinds.values().sum::<i32>() >= 30,
        "{kinds:?}"
    );
    assert!(mass < 1e-13 && momentum < 1e-13 && angular < 1e-12);
    let snapshots = run.snapshots();
    let last = run.particles(&snapshots[snapshots.len() - 1], 1);
    let first = run.particles(&snapshots[0], 1).len();
    assert_eq!(last.len(), first + new - gone);
    assert!(last.id.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(last.composition.len(), last.len());
    assert!(last.spin.iter().filter(|spin| spin.norm() > 0.0).count() > 30);
    for mixture in &last.composition {
        assert!((mixture.sum() - 1.0).abs() < 1e-14);
    }
}

/// A time near the middle that the unbroken run reports at too, so that its steps are not cut there.
fn middle(scene: &Scene) -> f64 {
    let TimeStep::Fixed(step) = scene.run.time_step else {
        panic!("the scene's step is fixed");
    };
    50.0 * ((scene.run.end_time / 100.0 / step).ceil() * step)
}

#[test]
fn a_colliding_belt_goes_on_after_a_break_bit_for_bit() {
    for law in [
        &["planetesimals.collisions={outcome=\"bounce\",restitution=0.5}"][..],
        &[],
    ] {
        let overrides: Vec<String> = law
            .iter()
            .chain(&["run.end_time=\"0.1 yr\"", "run.snapshots=\"none\""])
            .map(|&o| o.to_owned())
            .collect();
        let scene = Scene::load(&shipped(SCENE), &overrides).unwrap_or_else(|e| panic!("{e}"));
        let [whole, broken] = [(); 2].map(|()| TempDir::new().expect("a folder"));
        let end = scene.run.end_time;
        let done = run::run(scene.clone(), &options(whole.path(), None));
        done.unwrap_or_else(|error| panic!("{error}"));
        let half = run::run(scene.clone(), &options(broken.path(), Some(middle(&scene))));
        half.unwrap_or_else(|error| panic!("{error}"));
        let events = read(broken.path(), "events.csv").lines().count();
        assert!(events > 1, "{events} before the break");
        let rest = run::resume(broken.path(), &options(broken.path(), Some(end)));
        rest.unwrap_or_else(|error| panic!("{error}"));
        for name in ["events.csv", "ledger.csv"] {
            assert!(
                read(whole.path(), name) == read(broken.path(), name),
                "{name}"
            );
        }
        assert!(read(whole.path(), "events.csv").lines().count() > events);
    }
}
