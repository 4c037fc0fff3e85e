//! Numbers in scenes that no run could follow.

use super::case::Case;

const DISK: &str = "[run]\nend_time = 1\n[star]\nmass = 1\n[gas]\nparticles = 100\n[gas.disk]\nsurface_density = 1e-4\naspect_ratio = 0.05\ninner_radius = 1\nouter_radius = 2\n";
const PLANET: &str =
    "[run]\nend_time = 1\n[star]\nmass = 1\n[[planet]]\nmass = 1e-3\nsemi_major_axis = 1\n";

fn with(scene: &str, from: &str, to: &str) -> String {
    assert!(scene.contains(from), "{scene} has {from}");
    scene.replace(from, to)
}

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for value in [
        "0",
        "-1",
        "1e-320",
        "1e-300",
        "1e300",
        "1e308",
        "1e309",
        "nan",
        "inf",
        "-inf",
        "\"1 yr\"",
        "\"1e400 yr\"",
        "\"1e308 Myr\"",
    ] {
        cases.push(Case::new(
            format!("end_time = {value}"),
            with(PLANET, "end_time = 1", &format!("end_time = {value}")),
        ));
    }
    for value in ["0", "1e-13", "1e-11", "1e-320", "2", "nan"] {
        cases.push(Case::new(
            format!("time_step = {value}"),
            with(
                PLANET,
                "end_time = 1",
                &format!("end_time = 1\ntime_step = {value}"),
            ),
        ));
    }
    for value in ["1e-8", "1e-300", "[0.5]", "[1e-300, 1]"] {
        cases.push(Case::new(
            format!("snapshots = {value}"),
            with(
                PLANET,
                "end_time = 1",
                &format!("end_time = 1\nsnapshots = {value}"),
            ),
        ));
    }
    for value in ["1e-320", "1e-200", "1e-30", "1e30", "1e200", "1e308"] {
        for key in ["mass = 1e-3", "semi_major_axis = 1"] {
            let name = key.split(' ').next().unwrap_or_default();
            cases.push(Case::new(
                format!("planet {name} = {value}"),
                with(PLANET, key, &format!("{name} = {value}")),
            ));
        }
        cases.push(Case::new(
            format!("star mass = {value}"),
            with(
                PLANET,
                "[star]\nmass = 1",
                &format!("[star]\nmass = {value}"),
            ),
        ));
        cases.push(Case::new(
            format!("star accretion_radius = {value}"),
            with(
                PLANET,
                "[star]\nmass = 1",
                &format!("[star]\nmass = 1\naccretion_radius = {value}"),
            ),
        ));
        for key in [
            "surface_density = 1e-4",
            "aspect_ratio = 0.05",
            "inner_radius = 1",
            "outer_radius = 2",
        ] {
            let name = key.split(' ').next().unwrap_or_default();
            cases.push(Case::new(
                format!("disk {name} = {value}"),
                with(DISK, key, &format!("{name} = {value}")),
            ));
        }
    }
    for value in [
        "slope = 1e300",
        "slope = -1e300",
        "exponent = 1e300",
        "taper = 1e300",
        "taper = 0",
        "reference_radius = 1e-200",
        "reference_radius = 1e200",
    ] {
        cases.push(Case::new(
            format!("disk {value}"),
            with(DISK, "aspect_ratio", &format!("{value}\naspect_ratio")),
        ));
    }
    for number in [
        "0",
        "-1",
        "1",
        "2",
        "1e13",
        "10000000000000",
        "2147483648",
        "2000000000",
        "1.5",
    ] {
        let text = with(DISK, "particles = 100", &format!("particles = {number}"));
        cases.push(Case::new(format!("gas.particles = {number}"), text));
        let text = format!(
            "{PLANET}[planetesimals]\nnumber = {number}\nmass = 1e-9\ninner_radius = 2\nouter_radius = 3\n"
        );
        cases.push(Case::new(format!("planetesimals.number = {number}"), text));
        let text = format!("{DISK}[dust]\nparticles = {number}\nsize = 1e-9\n");
        cases.push(Case::new(format!("dust.particles = {number}"), text));
    }
    for e in [
        "0.999999999",
        "0.99999999999999994",
        "0.9999999999999999",
        "1",
        "2",
    ] {
        let text = format!("{PLANET}eccentricity = {e}\n");
        cases.push(Case::new(format!("eccentricity = {e}"), text));
        let text = format!(
            "{PLANET}[planetesimals]\nnumber = 10\nmass = 1e-9\ninner_radius = 2\nouter_radius = 3\neccentricity = {e}\n"
        );
        cases.push(Case::new(format!("planetesimals.eccentricity = {e}"), text));
    }
    for spacing in ["1e-5", "1e-300", "0.9", "1.1"] {
        let text = format!(
            "[run]\nend_time = 1\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = {spacing}\ndensity = 1\npressure = 1\n"
        );
        cases.push(Case::new(format!("spacing = {spacing}"), text.clone()));
        let text = text.replace("density", "lattice = \"random\"\ndensity");
        cases.push(Case::new(format!("spacing = {spacing}, random"), text));
    }
    for (key, values) in [
        ("gas.hydro.neighbours", ["6", "1000"]),
        ("gas.hydro.courant", ["1e-300", "1"]),
        ("accuracy.orbit_step", ["1e-300", "1e300"]),
        ("accuracy.acceleration_step", ["1e-300", "1e300"]),
    ] {
        for value in values {
            cases.push(Case::new(
                format!("{key} = {value}"),
                format!("{key} = {value}\n{DISK}"),
            ));
        }
    }
    for value in ["1e-300", "1e300"] {
        cases.push(Case::new(
            format!("accuracy.orbit_step = {value} of a planet"),
            format!("accuracy.orbit_step = {value}\n{PLANET}"),
        ));
        cases.push(Case::new(
            format!("planetesimals.softening = {value}"),
            format!("planetesimals.softening = {value}\n{PLANET}"),
        ));
        cases.push(Case::new(
            format!("gravity.opening_angle = {value}"),
            format!("gravity.opening_angle = {value}\n{PLANET}"),
        ));
        cases.push(Case::new(
            format!("gravity.force_error = {value}"),
            format!("gravity.force_error = {value}\n{PLANET}"),
        ));
        cases.push(Case::new(
            format!("planet.migration_time = {value}"),
            format!("{PLANET}migration_time = {value}\n"),
        ));
        cases.push(Case::new(
            format!("planet.radius = {value}"),
            format!("{PLANET}radius = {value}\n"),
        ));
    }
    cases
}
