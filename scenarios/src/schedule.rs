//! The schedule: at which times a run reports and writes snapshots.

use crate::run::REPORTS;
use crate::scene::{Scene, Snapshots};

/// Times are told apart to this part of their interval.
const SLACK: f64 = 1e-9;

/// The times of a run's output.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    pub start: f64,
    pub end: f64,
    pub snapshots: Snapshots,
    /// Interval between reports.
    pub report: f64,
}

impl Schedule {
    /// That of a scene that runs to `end` in base steps of at most `longest`.
    pub fn of(scene: &Scene, longest: f64, end: f64) -> Self {
        // Reports come after whole base steps, so that they do not cut them.
        let report = scene.run.end_time / REPORTS;
        let report = if longest.is_finite() {
            // One that is longer than the run is cut by its end.
            let longest = longest.min(scene.run.end_time);
            (report / longest - 1e-9).ceil().max(1.0) * longest
        } else {
            report
        };
        Self {
            start: 0.0,
            end,
            snapshots: scene.run.snapshots.clone(),
            report,
        }
    }

    /// The first time after `now` at which something is due; never later than the end, unless that has passed.
    pub fn after(&self, now: f64) -> f64 {
        let report = next_multiple(self.start, self.report, now);
        let snapshot = match &self.snapshots {
            Snapshots::None => f64::INFINITY,
            Snapshots::Every(interval) => next_multiple(self.start, *interval, now),
            Snapshots::At(times) => times
                .iter()
                .copied()
                .find(|&t| t > now)
                .unwrap_or(f64::INFINITY),
        };
        let next = report.min(snapshot);
        if now < self.end && next > self.end * (1.0 - SLACK) {
            self.end
        } else {
            next
        }
    }

    /// Whether a report is due at `now`.
    pub fn reports(&self, now: f64) -> bool {
        let count = (now - self.start) / self.report;
        now >= self.end || (count - count.round()).abs() < SLACK * count.abs().max(1.0)
    }

    /// The number of the snapshot that is due at `now`, counting the start as 0.
    pub fn snapshot(&self, now: f64) -> Option<usize> {
        let last = now >= self.end;
        match &self.snapshots {
            Snapshots::None => None,
            Snapshots::Every(interval) => {
                let count = (now - self.start) / interval;
                let due = (count - count.round()).abs() < SLACK * count.abs().max(1.0);
                (due || last).then_some(if due { count.round() } else { count.ceil() } as usize)
            }
            Snapshots::At(times) => {
                let past = times
                    .iter()
                    .filter(|&&t| t > self.start && t <= now)
                    .count();
                let due = now == self.start || times.contains(&now);
                (due || last).then_some(if due { past } else { past + 1 })
            }
        }
    }
}

fn next_multiple(start: f64, interval: f64, now: f64) -> f64 {
    let count = ((now - start) / interval * (1.0 + 1e-12) + SLACK).floor() + 1.0;
    start + count * interval
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_time_is_met_once_and_the_end_is_the_last() {
        let schedule = Schedule {
            start: 0.0,
            end: 1.0,
            snapshots: Snapshots::Every(0.3),
            report: 0.1,
        };
        let (mut now, mut seen) = (0.0, vec![(0.0, schedule.snapshot(0.0))]);
        while now < schedule.end {
            now = schedule.after(now);
            seen.push((now, schedule.snapshot(now)));
        }
        assert_eq!(seen.len(), 11);
        let numbers: Vec<usize> = seen.iter().filter_map(|s| s.1).collect();
        assert_eq!(numbers, [0, 1, 2, 3, 4]);
        assert_eq!(now, 1.0);
    }

    #[test]
    fn listed_times_are_numbered_in_order() {
        let schedule = Schedule {
            start: 0.0,
            end: 1.0,
            snapshots: Snapshots::At(vec![0.25, 0.5]),
            report: 10.0,
        };
        assert_eq!(schedule.after(0.0), 0.25);
        assert_eq!(schedule.after(0.25), 0.5);
        assert_eq!(schedule.after(0.5), 1.0);
        assert_eq!(
            [0.0, 0.25, 0.3, 0.5, 1.0].map(|t| schedule.snapshot(t)),
            [Some(0), Some(1), None, Some(2), Some(3)]
        );
    }
}
