//! Crashes: a run that is killed again and again leaves only whole files, and ends as if it had never been.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use nbody::points::random::{Purpose, stream};
use rand::RngExt;
use tempfile::TempDir;
use tridisk::{checkpoint::Checkpoint, snapshot};

const SCENE: &str = "coupled/embryo-in-disk.toml";

fn start(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tridisk"));
    command
        .args(arguments)
        .args(["--quiet", "--threads", "2"])
        .stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

fn scene() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(SCENE)
}

fn run(folder: &Path) -> Child {
    let (scene, folder) = (scene(), folder.to_string_lossy().into_owned());
    start(&[
        "run",
        &scene.to_string_lossy(),
        "--output",
        &folder,
        "--set",
        "run.end_time=\"0.4 yr\"",
        "--set",
        "run.snapshots=\"0.02 yr\"",
        "--set",
        "run.checkpoint=\"0.05 s\"",
        // A switch that remembers, a pressure that does between steps, in the precision that rounds most.
        "--set",
        "gas.viscosity.kind=\"cullen-dehnen\"",
        "--set",
        "gas.hydro.precision=\"single\"",
        "--set",
        "gas.hydro.formulation=\"pressure\"",
        "--set",
        "gas.particles=3000",
        "--set",
        "dust.particles=1000",
    ])
}

/// Opens every file that stands under its final name.
fn open_all(folder: &Path) {
    for entry in fs::read_dir(folder).expect("the folder of the run") {
        let path = entry.expect("an entry").path();
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        if name.starts_with("snapshot_") && name.ends_with(".hdf5") {
            snapshot::read(&path, None).unwrap_or_else(|error| panic!("{error}"));
        }
        if name == "checkpoint.hdf5" {
            Checkpoint::open(&path).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

fn ended_well(child: Child) {
    let output = child.wait_with_output().expect("the program ends");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn twenty_kills_leave_whole_files_and_the_same_end() {
    let folder = TempDir::new().expect("a folder");
    let (calm, rough) = (folder.path().join("calm"), folder.path().join("rough"));
    let began = std::time::Instant::now();
    ended_well(run(&calm));
    let whole = began.elapsed().as_secs_f64();
    let mut random = stream(1, Purpose::Orbits, 0, 0);
    let mut child = run(&rough);
    for _ in 0..20 {
        std::thread::sleep(Duration::from_secs_f64(
            whole * random.random_range(0.02..0.25),
        ));
        child.kill().expect("a signal");
        child.wait().expect("the end of the child");
        open_all(&rough);
        child = if rough.join("scene.toml").is_file() {
            start(&["resume", &rough.to_string_lossy()])
        } else {
            run(&rough)
        };
    }
    ended_well(child);
    let ledger = |folder: &Path| fs::read_to_string(folder.join("ledger.csv")).expect("a ledger");
    let (calm_ledger, rough_ledger) = (ledger(&calm), ledger(&rough));
    let parting = calm_ledger
        .lines()
        .zip(rough_ledger.lines())
        .position(|(a, b)| a != b);
    assert!(
        calm_ledger == rough_ledger,
        "the ledgers part in line {parting:?}"
    );
    for k in 0.. {
        let name = format!("snapshot_{k:04}.hdf5");
        if !calm.join(&name).is_file() {
            assert!(k > 20 && !rough.join(&name).is_file());
            break;
        }
        let of = |folder: &Path| {
            snapshot::read(&folder.join(&name), None).unwrap_or_else(|error| panic!("{error}"))
        };
        assert!(of(&calm).groups == of(&rough).groups, "{name} differs");
    }
}

#[test]
fn an_interrupted_run_leaves_a_checkpoint_and_says_so_by_its_status() {
    for (signal, status) in [(libc::SIGINT, 130), (libc::SIGTERM, 143)] {
        let folder = TempDir::new().expect("a folder");
        let mut child = run(folder.path());
        while !folder.path().join("snapshot_0001.hdf5").is_file() {
            assert!(
                child.try_wait().expect("a child").is_none(),
                "the run goes on for longer than this"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
        // SAFETY: a signal to a child of ours.
        unsafe { libc::kill(child.id() as i32, signal) };
        assert_eq!(
            child.wait().expect("the end of the child").code(),
            Some(status)
        );
        open_all(folder.path());
        assert!(folder.path().join("checkpoint.hdf5").is_file());
    }
}
