//! The stopwatch: CPU time of the program by phase of the work.

use coupling::{Meter, Phase};
use cpu_time::ProcessTime;
use std::time::Instant;

/// What one phase has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lap {
    pub cpu_s: f64,
    pub calls: u64,
    pub targets: u64,
    pub interactions: u64,
}

/// CPU time and counts of each phase, in the order of [`Phase::ALL`]. Whatever is between two phases belongs to the earlier one.
#[derive(Clone, Debug)]
pub struct Stopwatch {
    pub laps: [Lap; 8],
    /// Of the runs before this one, when resumed.
    pub earlier_wall_s: f64,
    phase: Phase,
    since: ProcessTime,
    began: Instant,
}

impl Stopwatch {
    /// A stopwatch that runs on from `laps`, in the output phase.
    pub fn new(laps: [Lap; 8], earlier_wall_s: f64) -> Self {
        Self {
            laps,
            earlier_wall_s,
            phase: Phase::Output,
            since: ProcessTime::now(),
            began: Instant::now(),
        }
    }

    /// Adds the time since the last phase began to that phase.
    pub fn stop(&mut self) {
        let now = ProcessTime::now();
        self.laps[self.phase as usize].cpu_s += now.duration_since(self.since).as_secs_f64();
        self.since = now;
    }

    pub fn wall_s(&self) -> f64 {
        self.earlier_wall_s + self.began.elapsed().as_secs_f64()
    }

    /// CPU time of all phases together.
    pub fn cpu_s(&self) -> f64 {
        self.laps.iter().map(|lap| lap.cpu_s).sum()
    }
}

impl Meter for Stopwatch {
    fn enter(&mut self, phase: Phase) {
        if phase != self.phase {
            self.stop();
            self.phase = phase;
        }
    }

    fn count(&mut self, targets: usize, interactions: u64) {
        let lap = &mut self.laps[self.phase as usize];
        lap.calls += 1;
        lap.targets += targets as u64;
        lap.interactions += interactions;
    }
}
