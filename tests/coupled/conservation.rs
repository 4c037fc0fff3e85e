//! Conservation over every shipped scene, shortened: mass to round-off, momentum and angular momentum to their bars, all of it finite.

use std::collections::BTreeMap;
use std::fs;

use tridisk::history::operators;

use crate::bench::{self, Done, shipped};

#[test]
fn every_scene_keeps_what_it_must() {
    let mut scenes = Vec::new();
    for folder in ["gas", "dust", "nbody", "coupled"] {
        for entry in fs::read_dir(shipped(folder)).expect("the folder of scenes") {
            let name = entry
                .expect("an entry")
                .file_name()
                .into_string()
                .expect("a name");
            if name.ends_with(".toml") {
                scenes.push(format!("{folder}/{name}"));
            }
        }
    }
    scenes.sort();
    assert!(scenes.len() >= 8);
    for scene in scenes {
        let mut overrides = vec!["run.snapshots=\"none\""];
        match scene.as_str() {
            "gas/sod.toml" => overrides.push("run.end_time=0.02"),
            "gas/shearing-box.toml" => overrides.push("run.end_time=0.5"),
            "coupled/minimum-mass-disk.toml" => overrides.extend([
                "run.end_time=\"0.1 yr\"",
                "gas.particles=8000",
                "dust.particles=2000",
            ]),
            "nbody/million-planetesimals.toml" => {
                overrides.extend(["run.end_time=\"0.1 yr\"", "planetesimals.number=5000"]);
            }
            "coupled/snow-line.toml" => overrides.extend([
                "run.end_time=\"0.5 yr\"",
                "gas.particles=5000",
                "dust.particles=3000",
            ]),
            "nbody/outer-solar-system.toml" => overrides.push("run.end_time=\"100 yr\""),
            "dust/dusty-box.toml" | "nbody/eccentric-orbit.toml" => {}
            _ => overrides.push("run.end_time=\"0.2 yr\""),
        }
        let run = bench::run(&scene, &overrides);
        let error = |column: &str| run.largest(column);
        let (mass, momentum, angular) = (
            error("error_mass"),
            error("error_momentum"),
            error("error_angular_momentum"),
        );
        println!(
            "{scene}: mass {mass:.1e}, momentum {momentum:.1e}, angular momentum {angular:.1e}, energy {:.1e}",
            error("error_energy")
        );
        assert!(mass < 1e-13, "{scene}: mass {mass:e}");
        assert!(momentum < 1e-12, "{scene}: momentum {momentum:e}");
        // Periodic boxes have no angular momentum to keep.
        if !scene.contains("sod") && !scene.contains("box") && scene != "dust/growth.toml" {
            assert!(angular < 1e-6, "{scene}: angular momentum {angular:e}");
        }
        books_close(&scene, &run);
    }
}

/// Whether every operator but the kicks gives to some what it takes from others; the kicks do so together, since one population's
/// pull is booked in another's kick.
fn books_close(scene: &str, run: &Done) {
    let (_, lines) = operators::last(&run.path("operators.csv")).unwrap_or_else(|e| panic!("{e}"));
    let mut residuals: BTreeMap<&str, [f64; 9]> = BTreeMap::new();
    // A disk has no net momentum: sqrt(2 M K) is about the sum of all |m v|.
    let (mut scale, mut momentum) = ([0.0; 9], 0.0);
    for (operator, _, sums) in &lines {
        if operator == operators::START {
            let add = |k: usize| scale[k] + sums[k].abs();
            scale = std::array::from_fn(add);
            momentum += (2.0 * sums[0] * sums[7]).sqrt();
            continue;
        }
        let name = if operator.starts_with("kick") {
            "kicks"
        } else {
            operator
        };
        let residual = residuals.entry(name).or_default();
        for (residual, x) in residual.iter_mut().zip(sums) {
            *residual += x;
        }
    }
    let turning = scale[4].max(scale[5]).max(scale[6]);
    // What the surroundings or the frame take is in no population.
    let open = |name: &str| {
        scene.contains("shearing")
            || ["disk", "migration", "stir"]
                .iter()
                .any(|w| name.contains(w))
    };
    for (name, sums) in residuals {
        if open(name) || scene.starts_with("gas/") {
            continue;
        }
        let mass = sums[0].abs() / scale[0];
        assert!(mass < 1e-13, "{scene}, {name}: mass {mass:e}");
        let p = sums[1].hypot(sums[2]).hypot(sums[3]) / momentum;
        assert!(p < 1e-12, "{scene}, {name}: momentum {p:e}");
        println!("{scene}, {name}: momentum {p:.1e}");
        // Impulses that wait for a body's next tick turn about the origin while it drifts.
        let turns = !["kicks", "drift bodies"].contains(&name);
        if !scene.contains("box") && turns {
            let l = sums[4].hypot(sums[5]).hypot(sums[6]) / turning;
            println!("    angular {l:.1e}");
            assert!(l < 1e-12, "{scene}, {name}: angular momentum {l:e}");
        }
    }
}
