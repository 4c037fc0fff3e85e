//! Progress of a run on standard error: a bar on a terminal, a line now and then elsewhere, nothing when quiet.

use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use nbody::points::Dimension;

use crate::units::Units;

/// Parts into which the bar cuts the run.
const PARTS: u64 = 10_000;
/// Time between lines where there is no terminal.
const PAUSE: Duration = Duration::from_secs(30);

pub struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    start: f64,
    end: f64,
    units: Units,
    last: Instant,
}

impl Progress {
    /// For a run from `start` to `end`, code units.
    pub fn new(start: f64, end: f64, units: Units, quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new(PARTS).with_style(style);
            bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(5));
            bar
        });
        Self {
            bar,
            quiet,
            start,
            end,
            units,
            last: Instant::now(),
        }
    }

    /// Tells where the run stands.
    pub fn tell(&mut self, time: f64, step: u64) {
        if self.quiet {
            return;
        }
        let done = ((time - self.start) / (self.end - self.start)).clamp(0.0, 1.0);
        match &self.bar {
            Some(bar) => {
                bar.set_position((done * PARTS as f64) as u64);
                bar.set_message(format!("t = {}, step {step}", self.shown(time)));
            }
            None if self.last.elapsed() >= PAUSE => {
                self.last = Instant::now();
                let percent = 100.0 * done;
                self.say(&format!(
                    "{percent:.1} %: t = {}, step {step}",
                    self.shown(time)
                ));
            }
            None => {}
        }
    }

    /// A line of the log.
    pub fn say(&self, line: &str) {
        if self.quiet {
            return;
        }
        match &self.bar {
            Some(bar) => bar.println(line),
            // A log that nobody reads any more must not end the run.
            None => drop(writeln!(std::io::stderr(), "{line}")),
        }
    }

    fn shown(&self, time: f64) -> String {
        match self.units.symbol(Dimension::TIME) {
            "yr/2pi" => format!("{:.4} yr", time / std::f64::consts::TAU),
            unit => format!("{time:.6} {unit}").trim_end().to_owned(),
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Progress over a number of things that end one by one.
pub struct Count {
    bar: Option<ProgressBar>,
    number: usize,
    quiet: bool,
}

impl Count {
    pub fn new(number: usize, quiet: bool) -> Self {
        let bar = (!quiet && std::io::stderr().is_terminal()).then(|| {
            let style =
                ProgressStyle::with_template("{bar:30} {pos} of {len}  {elapsed}  {eta} left")
                    .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::new(number as u64).with_style(style);
            bar.set_draw_target(ProgressDrawTarget::stderr_with_hz(5));
            bar.enable_steady_tick(Duration::from_secs(1));
            bar
        });
        Self { bar, number, quiet }
    }

    /// Tells what has ended as the `done`th.
    pub fn tell(&self, done: usize, what: &str) {
        match &self.bar {
            _ if self.quiet => {}
            Some(bar) => {
                bar.println(what);
                bar.set_position(done as u64);
            }
            None => drop(writeln!(
                std::io::stderr(),
                "{done} of {}: {what}",
                self.number
            )),
        }
    }
}

impl Drop for Count {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
