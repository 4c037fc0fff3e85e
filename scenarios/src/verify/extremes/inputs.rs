//! Numbers in scenes that no run could follow.

use super::case::Case;

const PLANET: &str = "[run]\nend_time = 1\nsnapshots = []\n[star]\nmass = 1\n[[planet]]\nmass = 1e-3\nsemi_major_axis = 1\n";

const DISK: &str = "[run]\nend_time = 0.1\nsnapshots = []\n[star]\nmass = 1\n[gas]\nparticles = 100\n[gas.disk]\nsurface_density = 1e-4\naspect_ratio = 0.05\ninner_radius = 1\nouter_radius = 2\n";

const BOX: &str = "[run]\nend_time = 0.1\nsnapshots = []\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.25\ndensity = 1\npressure = 1\n";

const TOO_MANY: &str = "bodies need steps of ~ at their closest pericentre, ~ of them to run.end_time, where a run does at most 1e12: give star.accretion_radius, planetesimals.time_step or planetesimals.integrator = \"gauss-radau\"";

/// The sentence for a number whose cube is none.
fn beyond(place: &str, value: &str) -> String {
    format!(
        "case.toml:{place} = {value}: is {value} in code units; allowed are 0 and sizes from 1e-100 to 1e100, whose cubes are numbers"
    )
}

fn times(cases: &mut Vec<Case>) {
    let end = |value: &str| PLANET.replace("end_time = 1", &format!("end_time = {value}"));
    for (value, sentence) in [
        ("0", "must be greater than 0"),
        ("-1", "must be greater than 0"),
        ("nan", "must be a finite number"),
        ("inf", "must be a finite number"),
        ("-inf", "must be a finite number"),
        ("1e309", "must be a finite number"),
        ("\"1e400 yr\"", "is not a finite number"),
        ("\"1e308 Myr\"", "must be a finite number"),
    ] {
        let sentence = format!("case.toml:2: run.end_time = {value}: {sentence}");
        cases.push(Case::refused(
            format!("end_time = {value}"),
            end(value),
            sentence,
        ));
    }
    for value in ["1e300", "1e-300"] {
        let sentence = beyond("2: run.end_time", value);
        cases.push(Case::refused(
            format!("end_time = {value}"),
            end(value),
            sentence,
        ));
    }
    cases.push(Case::new("end_time = 1e-100, shorter than any step", end("1e-100")).energy(1e-14));
    cases.push(Case::refused("end_time = 1e20", end("1e20"), TOO_MANY));
    for (value, sentence) in [
        ("0", "must be greater than 0"),
        ("1e-13", "makes more than 1e12 steps to run.end_time"),
        ("2", "is longer than run.end_time"),
        ("nan", "must be a finite number"),
    ] {
        let text = end(&format!("1\ntime_step = {value}"));
        let sentence = format!("case.toml:3: run.time_step = {value}: {sentence}");
        cases.push(Case::refused(
            format!("time_step = {value}"),
            text,
            sentence,
        ));
    }
    for (value, sentence) in [
        ("1e-8", "would write more than 1000000 snapshots"),
        ("nan", "must be a finite number"),
    ] {
        let text = PLANET.replace("snapshots = []", &format!("snapshots = {value}"));
        let sentence = format!("case.toml:3: run.snapshots = {value}: {sentence}");
        cases.push(Case::refused(
            format!("snapshots = {value}"),
            text,
            sentence,
        ));
    }
    cases.push(Case::new("snapshots = [1e-300]", PLANET.replace("[]", "[1e-300]")).energy(1e-6));
    cases.push(Case::new("checkpoint = 1e90", end("1\ncheckpoint = 1e90")).energy(1e-6));
    let fine = |value: &str| format!("{PLANET}[accuracy]\norbit_step = {value}\n");
    cases.push(Case::refused("orbit_step = 1e-90", fine("1e-90"), TOO_MANY));
    cases.push(Case::new("orbit_step = 1e90", fine("1e90")).left(1));
}

fn sizes(cases: &mut Vec<Case>) {
    for value in ["1e-320", "1e-200", "1e200", "1e308"] {
        for (line, key, from) in [
            ("5: star.mass", "mass", "mass = 1\n"),
            ("7: planet.0.mass", "mass", "mass = 1e-3\n"),
            (
                "8: planet.0.semi_major_axis",
                "semi_major_axis",
                "semi_major_axis = 1\n",
            ),
        ] {
            let text = PLANET.replace(from, &format!("{key} = {value}\n"));
            let path = line.split(' ').next_back().unwrap_or_default();
            cases.push(Case::refused(
                format!("{path} = {value}"),
                text,
                beyond(line, value),
            ));
        }
        for (line, key) in [
            ("9: gas.disk.surface_density", "surface_density = 1e-4"),
            ("12: gas.disk.outer_radius", "outer_radius = 2"),
        ] {
            let path = line.split(' ').next_back().unwrap_or_default();
            let name = path.rsplit('.').next().unwrap_or_default();
            let text = DISK.replace(key, &format!("{name} = {value}"));
            cases.push(Case::refused(
                format!("{path} = {value}"),
                text,
                beyond(line, value),
            ));
        }
        let text = format!("{PLANET}radius = {value}\n");
        cases.push(Case::refused(
            format!("planet.0.radius = {value}"),
            text,
            beyond("9: planet.0.radius", value),
        ));
    }
    for value in ["1e-90", "1e90"] {
        let text = format!("{PLANET}radius = {value}\n");
        cases.push(Case::new(format!("planet.0.radius = {value}"), text).energy(1e-6));
        let text = PLANET.replace("mass = 1e-3", &format!("mass = {value}"));
        let what = format!("planet.0.mass = {value}");
        cases.push(if value == "1e90" {
            Case::refused(what, text, TOO_MANY)
        } else {
            Case::new(what, text).left(1)
        });
        let text = PLANET.replace("semi_major_axis = 1", &format!("semi_major_axis = {value}"));
        let what = format!("planet.0.semi_major_axis = {value}");
        cases.push(if value == "1e-90" {
            Case::refused(what, text, TOO_MANY)
        } else {
            Case::new(what, text).energy(1e-9)
        });
    }
}

fn numbers(cases: &mut Vec<Case>) {
    let disk = |number: &str| DISK.replace("particles = 100", &format!("particles = {number}"));
    let belt = |number: &str| {
        format!(
            "{PLANET}[planetesimals]\nnumber = {number}\nmass = 1e-9\ninner_radius = 2\nouter_radius = 3\n"
        )
    };
    let dust = |number: &str| format!("{DISK}[dust]\nparticles = {number}\nsize = 1e-9\n");
    for number in ["-1", "1.5", "1e13", "10000000000000", "nan"] {
        for (path, text, least) in [
            ("7: gas.particles", disk(number), 1),
            ("10: planetesimals.number", belt(number), 0),
            ("14: dust.particles", dust(number), 1),
        ] {
            let name = path.split(' ').next_back().unwrap_or_default();
            let sentence = format!(
                "case.toml:{path} = {number}: must be a whole number from {least} to 2147483648"
            );
            cases.push(Case::refused(format!("{name} = {number}"), text, sentence));
        }
    }
    let outgrown = "~ need at least ~ GB of memory, but this machine has ~ GB";
    for (name, text) in [
        ("gas.particles", disk("2147483648")),
        ("planetesimals.number", belt("2147483648")),
        ("dust.particles", dust("2147483648")),
    ] {
        cases.push(Case::refused(
            format!("{name} = 2147483648"),
            text,
            outgrown,
        ));
    }
    cases.push(Case::refused(
        "1e9 particles in a block",
        BOX.replace("0.25", "0.001")
            .replace("density", "lattice = \"random\"\ndensity"),
        outgrown,
    ));
    for (spacing, sentence) in [
        (
            "1e-5",
            "case.toml:7: gas.block = [{..}]: makes 1.000e15 particles; the most is 2147483648 a population",
        ),
        (
            "1.1",
            "case.toml:10: gas.block.0.spacing = 1.1: is wider than the box from lo to hi",
        ),
    ] {
        let text = BOX.replace("0.25", spacing);
        cases.push(Case::refused(
            format!("a block of spacing {spacing}"),
            text,
            sentence,
        ));
    }
    for number in ["1", "2"] {
        cases.push(
            Case::new(format!("planetesimals.number = {number}"), belt(number)).momentum(1e-11),
        );
        cases.push(Case::new(format!("dust.particles = {number}"), dust(number)).momentum(1e-9));
    }
}

/// Every number of a scene that names most keys, spoiled one by one.
fn every_key(cases: &mut Vec<Case>) {
    for text in [PLANET, DISK, BOX, EVERY] {
        for (line, words) in text.lines().enumerate() {
            let Some((key, value)) = words.split_once(" = ") else {
                continue;
            };
            if value.parse::<f64>().is_err() || value.parse::<u64>().is_ok() && WHOLE.contains(&key)
            {
                continue;
            }
            for bad in ["nan", "inf", "-inf"] {
                let spoiled = |(k, l): (usize, &str)| {
                    if k == line {
                        format!("{key} = {bad}\n")
                    } else {
                        format!("{l}\n")
                    }
                };
                let text: String = text.lines().enumerate().map(spoiled).collect();
                let sentence = format!(
                    "case.toml:{}: ~.{key} = {bad}: must be a finite number",
                    line + 1
                );
                cases.push(Case::refused(format!("{key} = {bad}"), text, sentence));
            }
        }
    }
}

/// Keys of whole numbers.
const WHOLE: [&str; 4] = ["particles", "number", "seed", "most_fragments"];

/// A scene of many keys.
const EVERY: &str = "[run]\nend_time = 1\ntime_step = 0.1\n[star]\nmass = 1\naccretion_radius = 0.1\n[gas]\nparticles = 100\nsoftening = 0.1\n[gas.disk]\nmass = 1e-3\nslope = -1\nreference_radius = 1\naspect_ratio = 0.05\nexponent = 0.25\ninner_radius = 1\nouter_radius = 2\ntaper = 2\n[gas.eos]\ngamma = 1.4\nmean_molecular_weight = 2.3\n[gas.cooling]\nkind = \"beta\"\nbeta = 10\n[gas.hydro]\nneighbours = 64\ncourant = 0.25\ntolerance = 1e-4\n[gas.viscosity]\nalpha = 1\nbeta = 2\nshakura_sunyaev = 0.01\n[gas.conduction]\nalpha = 0.1\n[gas.rearrange]\nstrength = 1\n[dust]\nparticles = 100\ndust_to_gas = 0.01\nsize = 1e-9\nmaterial_density = 1\nscale_height = 1\nsoftening = 0.1\n[dust.turbulence]\nalpha = 1e-3\n[planetesimals]\nnumber = 10\nmass = 1e-9\ninner_radius = 2\nouter_radius = 3\nslope = -1\neccentricity = 0.1\ninclination = 0.1\ndensity = 1\nsoftening = 0.1\ntime_step = 0.1\ncutoff = 3\n[[planet]]\nmass = 1e-3\nradius = 1e-4\nsemi_major_axis = 5\neccentricity = 0.1\ninclination = 0.1\nlongitude_of_node = 0.1\nargument_of_pericentre = 0.1\nmean_anomaly = 0.1\nmigration_time = 1e6\n[gravity]\nforce_error = 1e-3\n[accuracy]\nacceleration_step = 0.25\norbit_step = 0.1\n";

pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    times(&mut cases);
    sizes(&mut cases);
    numbers(&mut cases);
    every_key(&mut cases);
    cases
}
