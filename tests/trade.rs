//! Trade and plan: what the program says of errors and costs, against what the methods and the runs themselves give.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::Command;
use tempfile::TempDir;
use tridisk::preset::{PRESETS, promised};
use tridisk::scene::Preset;
use tridisk::trade::errors::METRICS;
use tridisk::trade::presets::SCENES;

/// Two planets whose energy a map of second order keeps within the square of its step.
const PLANETS: &str = r#"# Two planets, far from each other.
title = "Two planets"  # a title

[run]
end_time = "60 yr"     # long enough
snapshots = "none"

[star]
mass = "1 Msun"

[planetesimals]        # how they move
integrator = "leapfrog"

[[planet]]
mass = "1 Mjup"
semi_major_axis = "1 au"
eccentricity = 0.1

[[planet]]
mass = "0.5 Mjup"
semi_major_axis = "2 au"
mean_anomaly = "90 deg"
"#;

struct Folder(TempDir);

impl Folder {
    fn with(scene: &str) -> Self {
        let folder = TempDir::new().expect("a folder");
        fs::write(folder.path().join("scene.toml"), scene).expect("a scene");
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("text")
    }

    fn tridisk(&self, arguments: &[&str]) -> Output {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tridisk"));
        let program = program.current_dir(self.0.path()).args(arguments);
        program.output().expect("the program runs")
    }

    fn trade(&self, arguments: &[&str]) -> Output {
        let all = ["trade", "scene.toml", "--output", "out", "--full"];
        self.tridisk(&[&all[..], arguments].concat())
    }

    /// The columns of the table by their names.
    fn table(&self) -> Vec<(String, Vec<String>)> {
        let text = self.text("out/trade.csv");
        let mut lines = text.lines().map(|line| line.split(','));
        let head = lines.next().expect("a head");
        let mut columns: Vec<_> = head.map(|name| (name.to_owned(), Vec::new())).collect();
        for line in lines {
            columns
                .iter_mut()
                .zip(line)
                .for_each(|(column, cell)| column.1.push(cell.to_owned()));
        }
        columns
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        let table = self.table();
        let column = table.iter().find(|(head, _)| head == name).expect(name);
        column
            .1
            .iter()
            .map(|cell| cell.parse().expect("a number"))
            .collect()
    }
}

impl Folder {
    /// Errors, two standard errors included, of which the presets of a table's rows promise something.
    fn promised_errors(&self) -> Vec<(&'static str, (&'static str, Preset), f64)> {
        let mut found = Vec::new();
        let is_promised = |metric: &&str| promised(metric, Preset::Draft).is_some();
        for metric in METRICS.into_iter().filter(is_promised) {
            let name = format!("error_{metric}");
            if self.table().iter().all(|(head, _)| *head != name) {
                continue;
            }
            let errors = self.numbers(&name);
            let sigmas = self.numbers(&format!("uncertainty_{metric}"));
            let both = errors.iter().zip(sigmas).zip(PRESETS);
            found.extend(both.map(|((x, sigma), preset)| (metric, preset, x + 2.0 * sigma)));
        }
        found
    }
}

fn words(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("text");
    (text(&output.stdout), text(&output.stderr))
}

const STEPS: &str = "planetesimals.time_step=0.1,0.05,0.025";

#[test]
fn errors_fall_with_the_order_of_the_map_and_costs_rise() {
    let folder = Folder::with(PLANETS);
    let more = [
        "--knob",
        STEPS,
        "--knob",
        "planetesimals.integrator=wisdom-holman",
    ];
    let output = folder.trade(&more);
    let (said, trouble) = words(&output);
    assert!(output.status.success(), "{trouble}");
    assert!(
        said.contains(
            "reference: planetesimals.time_step = 0.0125, planetesimals.integrator = gauss-radau"
        ),
        "{said}"
    );
    let head: Vec<String> = folder.table().into_iter().map(|column| column.0).collect();
    assert_eq!(
        head[..3],
        [
            "planetesimals.time_step",
            "planetesimals.integrator",
            "cpu_s"
        ]
    );
    assert!(head.contains(&"uncertainty_position".to_owned()));
    // Reports meet the extremes of the energy only now and then.
    for (metric, bar) in [("error_energy", 0.2), ("error_position", 0.05)] {
        let errors = folder.numbers(metric);
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            println!("{metric}: {pair:?}, order {order:.3}");
            assert!((order - 2.0).abs() < bar, "{metric}: {errors:?}");
        }
    }
    let targets = folder.numbers("targets");
    assert!(
        targets.windows(2).all(|pair| pair[1] > 1.9 * pair[0]),
        "{targets:?}"
    );
    assert!(folder.numbers("cpu_s").iter().all(|&cost| cost > 0.0));
    assert!(folder.path("out/trade.png").is_file());
    assert!(folder.path("out/reference.toml").is_file());
}

/// When the files of settings were written.
fn stamps(folder: &Path) -> Vec<std::time::SystemTime> {
    let mut runs: Vec<PathBuf> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path().join("timings.json"))
        .collect();
    runs.sort();
    runs.iter()
        .map(|path| {
            path.metadata()
                .expect("timings")
                .modified()
                .expect("a time")
        })
        .collect()
}

#[test]
fn what_is_done_is_found_again() {
    let folder = Folder::with(PLANETS);
    assert!(folder.trade(&["--knob", STEPS]).status.success());
    let (table, before) = (
        folder.text("out/trade.csv"),
        stamps(&folder.path("out/settings")),
    );
    fs::remove_file(folder.path("out/trade.csv")).expect("removed");
    let output = folder.trade(&["--knob", STEPS]);
    assert!(output.status.success());
    let (_, log) = words(&output);
    assert_eq!(log.matches("done before").count(), 4, "{log}");
    assert_eq!(stamps(&folder.path("out/settings")), before);
    assert_eq!(folder.text("out/trade.csv"), table);
    // One more value is one more run and another reference.
    let output = folder.trade(&["--knob", &format!("{STEPS},0.2")]);
    let (_, log) = words(&output);
    assert_eq!(log.matches("done before").count(), 4, "{log}");
    assert_eq!(folder.numbers("error_energy").len(), 4);
}

#[test]
fn the_cheapest_good_setting_goes_into_the_file_and_remarks_stay() {
    let folder = Folder::with(PLANETS);
    let knobs = [
        "--knob",
        STEPS,
        "--knob",
        "planetesimals.integrator=leapfrog,wisdom-holman",
    ];
    assert!(folder.trade(&knobs).status.success());
    // Between the errors of the map's two longer steps, and far below those of leapfrog.
    let mut errors = folder.numbers("error_energy");
    errors.sort_by(f64::total_cmp);
    let bar = format!("energy={}", 0.5 * (errors[1] + errors[2]));
    let output = folder.trade(&[&knobs[..], &["--error", &bar, "--apply"]].concat());
    let (said, trouble) = words(&output);
    assert!(output.status.success(), "{trouble}");
    assert!(said.contains("cheapest within energy"), "{said}");
    let wanted = PLANETS.replace(
        "integrator = \"leapfrog\"",
        "integrator = \"wisdom-holman\"\ntime_step = 0.05",
    );
    assert_eq!(folder.text("scene.toml"), wanted);
    let none = ["--error", "energy=1e-30", "--apply"];
    let output = folder.trade(&[&knobs[..], &none].concat());
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(folder.text("scene.toml"), wanted);
}

/// At most twice the errors of the energy that presets have in the first two scenes that they are derived from: draft, standard, precise.
const ENERGIES: [[f64; 3]; 2] = [[6e-10, 1.2e-10, 3e-11], [1e-4, 2.2e-5, 3.5e-6]];

#[test]
fn presets_keep_the_errors_that_they_promise() {
    for ((scene, set), energies) in SCENES.iter().zip(ENERGIES) {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(scene);
        let folder = Folder::with(&fs::read_to_string(file).expect("a shipped scene"));
        let mut arguments = vec!["--knob", "accuracy.preset=draft,standard,precise"];
        arguments.extend(["--reference", "accuracy.preset=reference"]);
        arguments.extend(set.iter().flat_map(|key| ["--set", key]));
        let output = folder.trade(&arguments);
        assert!(output.status.success(), "{}", words(&output).1);
        let energy = folder.numbers("error_energy");
        println!("{scene}: energy {energy:?}");
        assert!(
            energy
                .iter()
                .zip(energies)
                .all(|(found, bar)| *found <= bar)
        );
        for (metric, (name, preset), error) in folder.promised_errors() {
            let bar = promised(metric, preset).expect("a promise");
            println!("{scene}: {metric} of {name}: {error:.1e} of {bar:.1e}");
            assert!(error <= bar, "{scene}: {metric} of {name}: {error:e}");
        }
    }
}

/// A ring of light bodies, whose places follow from the seed.
const RING: &str = r#"
[run]
end_time = "5 yr"
snapshots = "none"
[star]
mass = "1 Msun"
[planetesimals]
number = 20
total_mass = "0.1 Mearth"
inner_radius = "0.9 au"
outer_radius = "1.1 au"
eccentricity = 0.1
density = "2 g/cm^3"
integrator = "leapfrog"
"#;

#[test]
fn a_setting_is_confirmed_with_other_seeds_or_not() {
    let folder = Folder::with(RING);
    let knobs = ["--knob", "planetesimals.time_step=0.1,0.05"];
    assert!(folder.trade(&knobs).status.success());
    let error = folder.numbers("error_position")[0];
    let error = error + 2.0 * folder.numbers("uncertainty_position")[0];
    let confirm = |bar: f64, seed: u64| {
        let (bar, seed) = (format!("position={bar:e}"), seed.to_string());
        folder.trade(&[&knobs[..], &["--error", &bar, "--confirm", &seed]].concat())
    };
    // Twenty orbits of the same kind are as wrong as twenty others, within a factor.
    let output = confirm(10.0 * error, 2);
    let (said, trouble) = words(&output);
    assert!(said.contains("with seed 2: position "), "{said} {trouble}");
    assert!(output.status.success(), "{trouble}");
    // What the first seed just keeps to, some of the others do not.
    let ends = [2, 3, 4, 5, 6].map(|seed| confirm(error * (1.0 + 1e-9), seed));
    let broken = ends.iter().find(|end| !end.status.success());
    let (_, trouble) = words(broken.expect("a seed with larger errors"));
    assert!(trouble.contains("with the other seed"), "{trouble}");
    let (_, trouble) = words(&folder.trade(&[&knobs[..], &["--confirm", "2"]].concat()));
    assert!(
        trouble.contains("--confirm: needs --error METRIC=VALUE"),
        "{trouble}"
    );
}

#[test]
fn wrong_knobs_are_refused_in_words() {
    let folder = Folder::with(PLANETS);
    for (arguments, wanted) in [
        (
            &["--knob", "planetesimals.time_stap=1"][..],
            "unknown key; the nearest is \"time_step\"",
        ),
        (
            &["--knob", "planetesimals.integrator=leapfrog,hermit"],
            "the nearest is \"hermite\"",
        ),
        (&["--knob", "planetesimals"], "wanted is key=value,value"),
        (&["--error", "enrgy=1"], "the nearest is energy"),
        (&["--error", "energy=-1"], "a number greater than 0"),
        (
            &["--apply"],
            "--apply: needs --error METRIC=VALUE or --within VALUE",
        ),
        (
            &["--knob", STEPS, "--reference", "run.sed=1"],
            "--reference: run.sed = 1: unknown key",
        ),
        (&["--knob", STEPS, "--set", "run.sed=1"], "--set run.sed=1"),
    ] {
        let output = folder.trade(arguments);
        let (_, text) = words(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(text.contains(wanted), "{arguments:?}: {text}");
        assert!(!folder.path("out").exists(), "{arguments:?}");
    }
}

#[test]
fn a_setting_that_fails_has_its_sentence_in_its_row() {
    // Jacobi coordinates are those of one integrator alone: the other combination is no scene.
    let folder = Folder::with(PLANETS);
    let output = folder.trade(&[
        "--knob",
        "planetesimals.coordinates=democratic-heliocentric,jacobi",
        "--knob",
        "planetesimals.integrator=leapfrog,wisdom-holman",
    ]);
    let (said, text) = words(&output);
    assert!(output.status.success(), "{text}");
    assert!(
        said.contains(
            "failed: planetesimals.coordinates = jacobi, planetesimals.integrator = leapfrog: "
        ),
        "{said}"
    );
    let table = folder.table();
    let failures = &table
        .iter()
        .find(|(head, _)| head == "failure")
        .expect("a column")
        .1;
    assert_eq!(
        failures.iter().filter(|cell| cell.is_empty()).count(),
        3,
        "{failures:?}"
    );
    let failed = folder.text("out/trade.csv");
    let line = failed
        .lines()
        .find(|line| line.starts_with("jacobi,leapfrog"))
        .expect("a row");
    assert!(line.contains("integrator"), "{line}");
}

#[test]
fn a_shortened_scene_stays_as_short_when_it_is_traded_again() {
    let folder = Folder::with(&PLANETS.replace("60 yr", "1e7 yr"));
    let arguments = [
        "trade",
        "scene.toml",
        "--output",
        "out",
        "--budget",
        "1 s",
        "--knob",
        STEPS,
    ];
    let (said, _) = words(&folder.tridisk(&arguments));
    assert!(said.starts_with("shortened to"), "{said}");
    let table = folder.text("out/trade.csv");
    // Twice what was asked for, and the noise of times.
    let spent: f64 = folder.numbers("cpu_s").iter().sum();
    assert!(spent > 0.1 && spent < 3.0, "{spent} s");
    let (_, log) = words(&folder.tridisk(&arguments));
    assert_eq!(log.matches("done before").count(), 4, "{log}");
    assert_eq!(folder.text("out/trade.csv"), table);
}

const LONG: [&str; 8] = [
    "trade",
    "scene.toml",
    "--output",
    "out",
    "--full",
    "--knob",
    "planetesimals.time_step=0.1,0.05",
    "--threads=2",
];

#[test]
fn an_interrupted_trade_goes_on_where_it_stopped() {
    let scene = PLANETS.replace("60 yr", "1000 yr");
    let folder = Folder::with(&scene);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_tridisk"))
        .current_dir(folder.0.path())
        .args(LONG)
        .stdout(std::process::Stdio::null())
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("the program starts");
    let settings = folder.path("out/settings");
    let holds = |name: &str| {
        let has = |run: fs::DirEntry| run.path().join(name).is_file();
        fs::read_dir(&settings).is_ok_and(|mut runs| runs.any(|run| run.is_ok_and(has)))
    };
    while !holds("ledger.csv") {
        std::thread::sleep(std::time::Duration::from_millis(10));
        assert_eq!(child.try_wait().expect("a child"), None);
    }
    // SAFETY: the child is ours and has not been waited for.
    unsafe { libc::kill(child.id() as libc::pid_t, libc::SIGINT) };
    assert_eq!(child.wait().expect("an end").code(), Some(130));
    assert!(holds("checkpoint.hdf5"), "no run left a checkpoint");
    assert!(folder.tridisk(&LONG).status.success());
    let whole = Folder::with(&scene);
    assert!(whole.tridisk(&LONG).status.success());
    for metric in ["error_energy", "error_position", "targets"] {
        assert_eq!(folder.numbers(metric), whole.numbers(metric), "{metric}");
    }
}
