//! Refused inputs: what is wrong with a scene is said in sentences, all at once, and the program ends with status 2.

use std::fs;
use std::path::{Path, PathBuf};

use assert_cmd::Command;

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_tridisk"))
}

fn scenes(kind: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../tests/inputs")
        .join(kind);
    let entries = fs::read_dir(folder).expect("the folder of inputs");
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|kind| kind == "toml"))
        .collect();
    paths.sort();
    paths
}

/// Exit status and standard error of `tridisk check`.
fn check(path: &Path, more: &[&str]) -> (Option<i32>, String) {
    let output = program()
        .arg("check")
        .arg(path)
        .args(more)
        .output()
        .expect("the program runs");
    let text = String::from_utf8(output.stderr).expect("text");
    assert!(!text.contains("panicked"), "{}: {text}", path.display());
    (output.status.code(), text)
}

#[test]
fn every_bad_scene_is_refused_in_the_expected_sentence() {
    let paths = scenes("bad");
    assert!(paths.len() >= 40);
    let mut wrong = String::new();
    for path in paths {
        let scene = fs::read_to_string(&path).expect("a scene");
        let expected: Vec<&str> = scene
            .lines()
            .filter_map(|line| line.strip_prefix("# expect: "))
            .collect();
        assert!(!expected.is_empty(), "{} expects nothing", path.display());
        let (status, text) = check(&path, &[]);
        let missing: Vec<_> = expected
            .iter()
            .filter(|part| !text.contains(**part))
            .collect();
        if status != Some(2) || !missing.is_empty() {
            wrong += &format!(
                "{}: status {status:?}, without {missing:?}:\n{text}\n",
                path.display()
            );
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn no_bad_scene_gets_more_sentences_than_it_has_faults() {
    // A value that was refused must not draw further complaints after it.
    let mut wrong = String::new();
    for path in scenes("bad") {
        let scene = fs::read_to_string(&path).expect("a scene");
        let expected = scene
            .lines()
            .filter(|line| line.starts_with("# expect: "))
            .count();
        let (_, text) = check(&path, &[]);
        if text.lines().count() > expected {
            wrong += &format!("{expected} faults, but:\n{text}");
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn good_scenes_pass_and_survive_being_written_out() {
    for path in scenes("good") {
        let (status, text) = check(&path, &[]);
        assert_eq!(status, Some(0), "{}: {text}", path.display());
        let scene = tridisk::scene::Scene::load(&path, &[]).expect("a good scene");
        let name = scene.name.clone();
        let again = tridisk::scene::Scene::parse(&scene.to_toml(), &name, Path::new("."), &[]);
        assert_eq!(again.as_ref(), Ok(&scene), "{}", path.display());
    }
}

#[test]
fn overrides_are_checked_like_the_file() {
    let good = &scenes("good")[0];
    let (status, text) = check(good, &["--set", "run.seed=many"]);
    assert_eq!(status, Some(2));
    assert!(
        text.contains("--set run.seed=many: run.seed = \"many\": must be a whole number"),
        "{text}"
    );
    let (status, text) = check(good, &["--set", "run.sed=1"]);
    assert_eq!(status, Some(2));
    assert!(
        text.contains("--set run.sed=1: run.sed = 1: unknown key; the nearest is \"seed\""),
        "{text}"
    );
    let (status, text) = check(good, &["--set", "run.seed"]);
    assert_eq!(status, Some(2));
    assert!(text.contains("wanted is key.path=value"), "{text}");
    assert_eq!(check(good, &["--set", "run.end_time=2 yr"]).0, Some(0));
}

#[test]
fn what_is_no_scene_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let (status, text) = check(&folder.path().join("none.toml"), &[]);
    assert_eq!(status, Some(2));
    assert!(text.contains("none.toml: cannot be read"), "{text}");
    let bytes = folder.path().join("bytes.toml");
    fs::write(&bytes, [b'#', b'\n', 0xff, 0xfe]).expect("written");
    let (status, text) = check(&bytes, &[]);
    assert_eq!(status, Some(2));
    assert!(text.contains("bytes.toml:2: is not UTF-8 text"), "{text}");
    assert_eq!(check(folder.path(), &[]).0, Some(2));
}
