//! Runs of settings: each in a process of its own on one thread, several at a time, in folders that a later call finds again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::atomic::publish_bytes;
use crate::scene::Scene;
use crate::signals;

/// How often a waiting worker looks at its process.
const PAUSE: Duration = Duration::from_millis(10);

/// How a setting's run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// In this folder.
    Well(PathBuf),
    Failed(String),
    Interrupted,
}

/// Told how the runs get on.
pub type Teller<'a> = &'a (dyn Fn(usize, &Ended, bool) + Sync);

/// Runs all scenes, some at a time; `tell` hears of each that has ended whether it had been done before.
pub fn all(
    scenes: &[Result<Scene, String>],
    folder: &Path,
    threads: usize,
    tell: Teller,
) -> Vec<Ended> {
    let next = AtomicUsize::new(0);
    let ended: Mutex<Vec<Ended>> = Mutex::new(vec![Ended::Interrupted; scenes.len()]);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(scenes.len()) {
            scope.spawn(|| {
                while signals::caught().is_none() {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    let Some(scene) = scenes.get(i) else { break };
                    let (end, before) = match scene {
                        Ok(scene) => one(scene, folder),
                        Err(sentence) => (Ended::Failed(sentence.clone()), false),
                    };
                    tell(i, &end, before);
                    lock(&ended)[i] = end;
                }
            });
        }
    });
    lock(&ended).clone()
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// FNV-1a of a scene's text: the name of its folder.
fn number(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// Runs a scene to its end, goes on with it where it was interrupted, or finds it done.
fn one(scene: &Scene, folder: &Path) -> (Ended, bool) {
    let text = scene.to_toml();
    let home = folder.join(format!("{:016x}", number(&text)));
    let file = home.with_extension("toml");
    let same = fs::read_to_string(home.join("scene.toml")).is_ok_and(|found| found == text);
    let has = |name: &str| home.join(name).is_file();
    if same && has("snapshot_0001.hdf5") && has("timings.json") && !has("checkpoint.hdf5") {
        return (Ended::Well(home), true);
    }
    let mut command = match std::env::current_exe() {
        Ok(program) => Command::new(program),
        Err(error) => {
            return (
                Ended::Failed(format!("the program is not found: {error}")),
                false,
            );
        }
    };
    if same && has("checkpoint.hdf5") {
        command.arg("resume").arg(&home);
    } else {
        let written =
            fs::create_dir_all(folder).and_then(|()| publish_bytes(&file, text.as_bytes()));
        if let Err(error) = written {
            return (Ended::Failed(format!("{}: {error}", file.display())), false);
        }
        command
            .arg("run")
            .arg(&file)
            .arg("--force")
            .arg("--output")
            .arg(&home);
    }
    command.args(["--quiet", "--threads", "1"]);
    command.stdin(Stdio::null()).stdout(Stdio::null());
    let end = match follow(&mut command, &home) {
        Ok(end) => end,
        Err(error) => Ended::Failed(format!("the run cannot be started: {error}")),
    };
    if end == Ended::Well(home.clone()) {
        // What only a run that goes on needs.
        let _ = fs::remove_file(home.join("checkpoint.hdf5"));
        let _ = fs::remove_file(&file);
    }
    (end, false)
}

/// Starts a process and waits for its end, or ends it when a signal has come.
fn follow(command: &mut Command, home: &Path) -> std::io::Result<Ended> {
    fs::create_dir_all(home)?;
    let log = home.join("errors.txt");
    let mut child = command.stderr(fs::File::create(&log)?).spawn()?;
    let mut asked = false;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if signals::caught().is_some() && !asked {
            end(&child);
            asked = true;
        }
        std::thread::sleep(PAUSE);
    };
    if status.success() {
        let _ = fs::remove_file(&log);
        return Ok(Ended::Well(home.to_path_buf()));
    }
    let of_signal = matches!(status.code(), Some(130 | 143));
    if signals::caught().is_some() || of_signal {
        return Ok(Ended::Interrupted);
    }
    let text = fs::read_to_string(&log)?;
    let sentence = text
        .lines()
        .rev()
        .find_map(|line| line.strip_prefix("error: "));
    let sentence = sentence.map_or_else(|| format!("the run ended with {status}"), str::to_owned);
    Ok(Ended::Failed(sentence.replace(
        &home.with_extension("toml").display().to_string(),
        "scene",
    )))
}

/// Asks a process of ours to write a checkpoint and end.
fn end(child: &Child) {
    if let Ok(id) = libc::pid_t::try_from(child.id()) {
        // SAFETY: the process is ours and has not been waited for.
        unsafe { libc::kill(id, libc::SIGTERM) };
    }
}
