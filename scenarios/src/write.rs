//! Writing a scene: TOML with every default written out, which reads back to the same scene.

mod bodies;
mod frame;
mod gas;
mod growth;
mod text;

use crate::scene::Scene;
use bodies::{write_bodies, write_planet, write_surroundings};
use frame::{forces, frame};
use gas::{write_dust, write_gas};
use text::Text;

impl Scene {
    /// The scene as TOML in code units, every default written out.
    pub fn to_toml(&self) -> String {
        let mut text = Text::default();
        text.text("name", &self.name);
        text.text("title", &self.title);
        frame(&mut text, self);
        if let Some(gas) = &self.gas {
            write_gas(&mut text, gas);
        }
        if let Some(dust) = &self.dust {
            write_dust(&mut text, dust);
        }
        if let Some(bodies) = &self.planetesimals {
            write_bodies(&mut text, bodies);
        }
        for planet in &self.planets {
            write_planet(&mut text, planet);
        }
        write_surroundings(&mut text, self);
        forces(&mut text, self);
        text.0
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn reads_back(text: &str) {
        let scene = Scene::parse(text, "trial", Path::new("."), &[]);
        let scene = scene.unwrap_or_else(|problems| panic!("{problems:?}"));
        let written = scene.to_toml();
        let again = Scene::parse(&written, "other", Path::new("/"), &[]);
        let again = again.unwrap_or_else(|problems| panic!("{problems:?} in {written}"));
        assert_eq!(again, scene, "{written}");
        assert_eq!(again.to_toml(), written);
    }

    #[test]
    fn a_full_disk_reads_back() {
        reads_back(
            r#"
            title = "a \"quoted\" title"
            [run]
            end_time = "10 yr"
            snapshots = [0.0, "1 yr"]
            checkpoint = "5 min"
            time_step = "0.1 day"
            [star]
            mass = "1 Msun"
            accretion_radius = "0.05 au"
            [gas]
            particles = 50000
            [gas.disk]
            surface_density = "1700 g/cm^2"
            inner_radius = 0.5
            outer_radius = "2 au"
            [gas.eos]
            kind = "locally-isothermal"
            aspect_ratio = 0.033
            [dust]
            particles = 20000
            size = { min = "1 um", max = "1 mm" }
            [planetesimals]
            number = 2000
            total_mass = "1 Mearth"
            inner_radius = 0.7
            outer_radius = 1.3
            [planetesimals.collisions]
            outcome = "merge"
            [[planet]]
            mass = "1 Mearth"
            semi_major_axis = "1 au"
            inclination = "30 deg"
            [[planet]]
            mass = "1 Mjup"
            position = [5.2, 0, 0]
            velocity = ["0 km/s", "13 km/s", 0]
            [gravity]
            pulls = { planetesimals = [] }
            [accuracy]
            preset = "draft"
            "#,
        );
    }

    #[test]
    fn a_shock_tube_reads_back() {
        reads_back(
            r#"
            [run]
            end_time = 0.2
            snapshots = "none"
            [units]
            system = "dimensionless"
            [domain]
            kind = "periodic"
            size = [2, 1, 1]
            dimensions = 2
            plane = "xz"
            [[gas.block]]
            lo = [0, 0, 0]
            hi = [1, 0, 1]
            spacing = 0.1
            density = 1
            pressure = 1
            [[gas.block]]
            lo = [1, 0, 0]
            hi = [2, 0, 1]
            spacing = 0.2
            density = 0.25
            internal_energy = 1.3
            velocity = [0.1, 0.2, 0.3]
            [[dust.block]]
            lo = [0, 0, 0]
            hi = [1, 0, 1]
            spacing = 0.1
            lattice = "random"
            density = 1
            [dust.drag]
            law = "constant-stopping-time"
            stopping_time = 0.1
            [gas.viscosity]
            kind = "none"
            [gas.hydro]
            background_pressure = "least"
            "#,
        );
    }

    #[test]
    fn bodies_alone_read_back() {
        reads_back(
            r#"
            [run]
            end_time = 1
            [units]
            system = "cgs"
            [[planet]]
            mass = "1 Msun"
            position = ["1 au", 0, 0]
            velocity = [0, 0, 0]
            [planetesimals]
            integrator = "gauss-radau"
            [gravity]
            method = "direct"
            opening_angle = 0.5
            "#,
        );
    }
}
