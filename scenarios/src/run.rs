//! A run: a scene is assembled, advanced and reported into its folder, and can be taken up again where it stopped.
//!
//! Whatever a run does between the ends of two base steps follows from the state at the first; checkpoints are taken at such ends, before
//! the steps are closed, so that a resumed run repeats an unbroken one bit for bit.

mod output;
mod saved;

use std::path::{Path, PathBuf};
use std::time::Instant;

use coupling::ledger::Census;
use coupling::{Meter, Phase, Splitting, System};
use nbody::points::Fault;
use thiserror::Error;

use crate::assemble::{self, Assembly};
use crate::hdf::FileError;
use crate::history::Solved;
use crate::progress::Progress;
use crate::scene::Scene;
use crate::schedule::Schedule;
use crate::signals;
use crate::stopwatch::Stopwatch;
use output::Folder;

/// How a scene is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Folder of the run; exists and holds no other run.
    pub output: PathBuf,
    /// Code units; the scene's own if none.
    pub end_time: Option<f64>,
    pub quiet: bool,
}

/// How a run ended well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Done,
    /// By this signal, after a checkpoint.
    Interrupted(i32),
}

#[derive(Debug, Error)]
pub enum RunError {
    /// The scene or the arguments are wrong: exit status 2.
    #[error("{0}")]
    Refused(String),
    /// The run failed: exit status 1.
    #[error("{0}")]
    Failed(String),
}

impl From<FileError> for RunError {
    fn from(error: FileError) -> Self {
        Self::Failed(error.to_string())
    }
}

impl From<std::io::Error> for RunError {
    fn from(error: std::io::Error) -> Self {
        Self::Failed(format!("a file of the run cannot be written: {error}"))
    }
}

impl From<Fault> for RunError {
    fn from(fault: Fault) -> Self {
        Self::Failed(format!(
            "{fault}; the snapshots and the last checkpoint stay valid"
        ))
    }
}

/// Reports a run writes at least, evenly over its time.
pub const REPORTS: f64 = 100.0;

/// Runs a scene from its start.
pub fn run(scene: Scene, options: &Options) -> Result<Outcome, RunError> {
    let started = Stopwatch::new(Default::default(), 0.0);
    let system = assemble::start(&scene).map_err(|refusal| RunError::Refused(refusal.0))?;
    let folder = Folder::new(&options.output, &scene)?;
    let mut run = Run::new(scene, system, folder, started, options)?;
    run.go()
}

/// Goes on with the run in `folder` from its checkpoint; from its start if it has none yet.
pub fn resume(folder: &Path, options: &Options) -> Result<Outcome, RunError> {
    let scene = Scene::load(&folder.join("scene.toml"), &[])
        .map_err(|refusal| RunError::Refused(refusal.to_string()))?;
    if !folder.join("checkpoint.hdf5").is_file() {
        return run(scene, options);
    }
    let saved = saved::read(&folder.join("checkpoint.hdf5"), &scene)?;
    let watch = Stopwatch::new(saved.laps, saved.wall_s);
    let folder = Folder::reopened(folder, &scene, &saved.rows)?;
    Run::new(scene, saved.system, folder, watch, options)?.go()
}

/// Writes a snapshot of a system as it stands.
pub fn snapshot(path: &Path, scene: &Scene, system: &System) -> Result<(), RunError> {
    output::snapshot(path, scene, system, system.clock.time())
}

/// A run in progress.
struct Run {
    scene: Scene,
    system: System,
    splitting: Splitting,
    schedule: Schedule,
    folder: Folder,
    watch: Stopwatch,
    progress: Progress,
    saved: Instant,
}

impl Run {
    fn new(
        scene: Scene,
        system: System,
        folder: Folder,
        watch: Stopwatch,
        options: &Options,
    ) -> Result<Self, RunError> {
        let end = options.end_time.unwrap_or(scene.run.end_time);
        let Assembly {
            system,
            splitting,
            remarks,
        } = assemble::assembly(&scene, system).map_err(|refusal| RunError::Refused(refusal.0))?;
        let schedule = Schedule::of(&scene, system.longest, end);
        let progress = Progress::new(system.clock.time(), end, scene.units, options.quiet);
        remarks.iter().for_each(|remark| progress.say(remark));
        Ok(Self {
            scene,
            system,
            splitting,
            schedule,
            folder,
            watch,
            progress,
            saved: Instant::now(),
        })
    }

    /// Advances to the end, or to a signal.
    fn go(&mut self) -> Result<Outcome, RunError> {
        loop {
            let synchronous = self.system.clock.synchronous();
            let now = self.system.clock.time();
            self.progress.tell(now, self.system.clock.step);
            if synchronous {
                if let Some(signal) = signals::caught() {
                    self.checkpoint()?;
                    self.finish()?;
                    return Ok(Outcome::Interrupted(signal));
                }
                if self.saved.elapsed().as_secs_f64() >= self.scene.run.checkpoint
                    || now >= self.schedule.end
                {
                    self.checkpoint()?;
                }
            }
            let snapshot = if synchronous {
                self.schedule.snapshot(now)
            } else {
                None
            };
            // Reports lie on the schedule's own times, which base steps end at exactly.
            self.system.reporting =
                synchronous && (snapshot.is_some() || self.schedule.reports(now));
            let (until, longest) = (self.schedule.after(now), self.system.longest);
            self.splitting
                .close(&mut self.system, until, longest, &mut self.watch)?;
            if self.system.reporting {
                self.report(now, snapshot)?;
            }
            if synchronous && now >= self.schedule.end {
                self.finish()?;
                return Ok(Outcome::Done);
            }
            self.splitting.open(&mut self.system, &mut self.watch)?;
            self.splitting.cross(&mut self.system, &mut self.watch)?;
        }
    }

    fn report(&mut self, now: f64, snapshot: Option<usize>) -> Result<(), RunError> {
        self.watch.enter(Phase::Output);
        self.watch.count(0, 0);
        output::finite(&self.system, now)?;
        let census = Census::scaled(&self.system);
        if now == self.schedule.start {
            let potential = self.system.potential;
            self.system.ledger.open(census, potential);
        }
        let row =
            self.system
                .ledger
                .report(now, census, self.system.potential, &self.system.domain);
        self.folder.events(&mut self.system.events)?;
        self.folder.report(&row, &mut self.system)?;
        output::conserved(&row, &self.system.domain)?;
        if let Some(number) = snapshot {
            let path = self.folder.path(&format!("snapshot_{number:04}.hdf5"));
            output::snapshot(&path, &self.scene, &self.system, now)?;
        }
        Ok(())
    }

    fn checkpoint(&mut self) -> Result<(), RunError> {
        self.watch.enter(Phase::Output);
        self.watch.stop();
        self.folder.events(&mut self.system.events)?;
        saved::write(
            &self.folder.path("checkpoint.hdf5"),
            (&self.scene, &self.system),
            &self.watch,
            &self.folder.rows()?,
        )?;
        self.folder.timings(&self.watch, &self.system)?;
        self.saved = Instant::now();
        Ok(())
    }

    fn finish(&mut self) -> Result<(), RunError> {
        self.watch.enter(Phase::Output);
        self.watch.stop();
        self.folder.timings(&self.watch, &self.system)?;
        if let Some(solved) = Solved::of(&self.system.solves) {
            self.progress.say(&solved.words());
        }
        Ok(())
    }
}
