//! Conservation over every shipped scene, shortened: mass to round-off, momentum and angular momentum to their bars, all of it finite.

use std::fs;

use crate::bench::{self, shipped};

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
    }
}
