//! The cost of a scene, measured on its first steps.
//!
//! The scene is advanced for a few seconds as a run advances it. Where whole base steps fit into that, a run costs their CPU time by the
//! time that they cover. Where not even one does, a tick is taken to cost a + b n, n being the particles that are active at it, and the
//! base step costs a T + b U with its T ticks and U updates, which follow from the steps that the particles have chosen. Steps that grow or
//! shrink later in a run are not foreseen.

use std::time::{Duration, Instant};

use coupling::ledger::Census;
use coupling::{Splitting, System};
use cpu_time::ProcessTime;
use nbody::points::{Columns, clock::TICKS};

use crate::assemble::{self, Assembly};
use crate::run::{REPORTS, RunError};
use crate::scene::Scene;
use crate::schedule::Schedule;
use crate::stopwatch::Stopwatch;

/// What a scene costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// CPU time a unit of time, s.
    pub rate: f64,
    /// CPU time of placing the particles and of their first forces, s.
    pub start_s: f64,
    /// CPU time of a report, s.
    pub report_s: f64,
    /// CPU time of all snapshots, s; zero where nobody has looked.
    pub files_s: f64,
    /// Wall-clock time by CPU time, on the threads that are used now.
    pub wall: f64,
    /// Updates of gas, dust and bodies a unit of time.
    pub updates: [f64; 3],
    /// Ticks a base step.
    pub ticks: f64,
    /// The longest base step.
    pub longest: f64,
    /// Reports of the run.
    pub reports: f64,
    /// Base steps of the run.
    pub steps: u64,
    /// End of the run.
    pub end: f64,
}

impl Cost {
    /// CPU time of the whole run, s.
    pub fn cpu_s(&self) -> f64 {
        self.start_s + self.rate * self.end + self.report_s * self.reports + self.files_s
    }

    /// The longest base step that the run does.
    pub fn base_step(&self) -> f64 {
        match self.longest.is_finite() {
            true => self.longest.min(self.end),
            // Reports alone cut the run.
            false => self.end / REPORTS,
        }
    }

    pub fn wall_s(&self) -> f64 {
        self.wall * self.cpu_s()
    }

    /// Updates of gas, dust and bodies in the whole run.
    pub fn updates(&self) -> [f64; 3] {
        self.updates.map(|rate| rate * self.end)
    }
}

/// Ticks that are timed one by one: to read the clock takes as long as a tick of a few bodies.
const MANY: f64 = 1000.0;
/// Seconds between marks.
const PAUSE: f64 = 1e-3;

/// A scene that has been advanced for a moment.
pub struct Sampled {
    pub cost: Cost,
    /// As the sample left it, its bodies and particles closed at one time or not.
    pub system: System,
    pub remarks: Vec<String>,
    /// Names of the operators of a step.
    pub operators: Vec<&'static str>,
    /// Shortest and longest step that particles chose at the start; none without particles.
    pub first: Option<[f64; 2]>,
}

/// A moment at which everybody is active.
#[derive(Clone, Copy)]
struct Mark {
    time: f64,
    cpu: f64,
    wall: f64,
}

/// Ticks of a kind: how many, of how many active particles, and their CPU time.
#[derive(Clone, Copy, Default)]
struct Ticks {
    count: f64,
    active: f64,
    cpu: f64,
}

impl Ticks {
    fn add(&mut self, active: f64, cpu: f64) {
        self.count += 1.0;
        self.active += active;
        self.cpu += cpu;
    }

    fn mean(&self) -> f64 {
        self.cpu / self.count
    }
}

/// Advances the scene for about `seconds` of wall-clock time, and says what a run costs.
pub fn sample(scene: &Scene, seconds: f64) -> Result<Sampled, RunError> {
    let began = ProcessTime::now();
    let system = assemble::start(scene).map_err(|refusal| RunError::Refused(refusal.0))?;
    let Assembly {
        system,
        splitting,
        remarks,
    } = assemble::assembly(scene, system).map_err(|refusal| RunError::Refused(refusal.0))?;
    let start_s = began.elapsed().as_secs_f64();
    let operators = splitting.names();
    let schedule = Schedule::of(scene, system.longest, scene.run.end_time);
    let mut probe = Probe::new(system, splitting, schedule);
    probe.advance(Duration::from_secs_f64(seconds))?;
    let cost = probe.cost(scene, start_s);
    Ok(Sampled {
        cost,
        system: probe.system,
        remarks,
        operators,
        first: probe.first,
    })
}

/// A scene under way, with what was seen of its cost.
struct Probe {
    system: System,
    splitting: Splitting,
    schedule: Schedule,
    watch: Stopwatch,
    marks: Vec<Mark>,
    /// Ticks at which everybody is active, with and without a report, and the others.
    reported: Ticks,
    whole: Ticks,
    partial: Ticks,
    /// Updates of gas, dust and bodies, and ticks, in the base step that opened last.
    updates: [f64; 3],
    ticks: f64,
    /// Its length.
    base: f64,
    /// Updates in all base steps that have opened, and their length.
    all: ([f64; 3], f64),
    first: Option<[f64; 2]>,
}

impl Probe {
    fn new(system: System, splitting: Splitting, schedule: Schedule) -> Self {
        Self {
            system,
            splitting,
            schedule,
            watch: Stopwatch::new(Default::default(), 0.0),
            marks: Vec::new(),
            reported: Ticks::default(),
            whole: Ticks::default(),
            partial: Ticks::default(),
            updates: [0.0; 3],
            ticks: 1.0,
            base: 1.0,
            all: ([0.0; 3], 0.0),
            first: None,
        }
    }

    /// Goes on as a run does until the time is over or the run done.
    fn advance(&mut self, time: Duration) -> Result<(), RunError> {
        let began = Instant::now();
        loop {
            let now = self.system.clock.time();
            let synchronous = self.system.clock.synchronous();
            let over = began.elapsed() >= time || now >= self.schedule.end;
            let due = synchronous && self.schedule.reports(now);
            // The last tick reports if none has but the start.
            let report = due || synchronous && over && self.reported.count < 2.0;
            self.system.reporting = report;
            let at = (report || self.seen() < MANY).then(ProcessTime::now);
            let active = self.active();
            self.close(now, report)?;
            // What follows the end of the run is never done.
            if synchronous && (!over || self.marks.is_empty()) {
                self.chosen();
            }
            if over && (synchronous || !self.marks.is_empty() && self.partial.count >= 2.0) {
                self.count(at, active, [synchronous, report]);
                self.mark(synchronous && now > 0.0, now, began);
                return Ok(());
            }
            self.mark(synchronous && self.ripe(began), now, began);
            self.splitting.open(&mut self.system, &mut self.watch)?;
            self.splitting.cross(&mut self.system, &mut self.watch)?;
            self.count(at, active, [synchronous, report]);
        }
    }

    fn close(&mut self, now: f64, report: bool) -> Result<(), RunError> {
        let system = &mut self.system;
        // A run that is over closes its last steps as if another base step followed.
        let (until, longest) = (self.schedule.after(now), system.longest);
        self.splitting
            .close(system, until, longest, &mut self.watch)?;
        if report {
            let census = Census::scaled(system);
            if now == self.schedule.start {
                let potential = system.potential;
                system.ledger.open(census, potential);
            }
            let potential = system.potential;
            system.ledger.report(now, census, potential, &system.domain);
        }
        Ok(())
    }

    /// Particles that are active now.
    fn active(&self) -> f64 {
        let system = &self.system;
        let at = |ends: &[u32]| ends.iter().filter(|&&end| end == system.clock.tick).count();
        let bodies = if system.bodies_active() {
            system.bodies.len()
        } else {
            0
        };
        let fluids = if system.clock.synchronous() {
            system.gas.len() + system.dust.len()
        } else {
            at(&system.gas.particles.end) + at(&system.dust.particles.end)
        };
        (fluids + bodies) as f64
    }

    /// What the base step that opens now will take.
    fn chosen(&mut self) {
        let system = &self.system;
        let bodies = std::iter::repeat_n(system.pace.next_span, system.bodies.len());
        let (gas, dust) = (&system.gas.rates.next_span, &system.dust.rates.next_span);
        let (mut shortest, mut longest) = (TICKS, 0);
        let mut sum = |spans: &mut dyn Iterator<Item = u32>| {
            spans.filter(|&span| span > 0).fold(0.0, |updates, span| {
                (shortest, longest) = (shortest.min(span), longest.max(span));
                updates + f64::from(TICKS / span)
            })
        };
        self.updates = [
            sum(&mut gas.iter().copied()),
            sum(&mut dust.iter().copied()),
            sum(&mut bodies.into_iter()),
        ];
        self.ticks = f64::from(TICKS / shortest);
        let base = system.next.end - system.next.start;
        self.base = base;
        self.all.1 += base;
        for (all, updates) in self.all.0.iter_mut().zip(self.updates) {
            *all += updates;
        }
        if self.first.is_none() && longest > 0 {
            let part = |span: u32| base * f64::from(span) / f64::from(TICKS);
            self.first = Some([part(shortest), part(longest)]);
        }
    }

    /// Ticks that have been timed.
    fn seen(&self) -> f64 {
        self.reported.count + self.whole.count + self.partial.count
    }

    /// Whether the last mark is so old that another costs next to nothing.
    fn ripe(&self, began: Instant) -> bool {
        let last = self.marks.last().map_or(0.0, |mark| mark.wall);
        self.marks.len() < 3 || began.elapsed().as_secs_f64() > last + PAUSE
    }

    fn count(&mut self, at: Option<ProcessTime>, active: f64, [synchronous, report]: [bool; 2]) {
        let Some(at) = at else { return };
        let cpu = at.elapsed().as_secs_f64();
        match (synchronous, report) {
            (true, true) => self.reported.add(active, cpu),
            (true, false) => self.whole.add(active, cpu),
            _ => self.partial.add(active, cpu),
        }
    }

    fn mark(&mut self, synchronous: bool, time: f64, began: Instant) {
        if synchronous {
            self.watch.stop();
            self.marks.push(Mark {
                time,
                cpu: self.watch.cpu_s(),
                wall: began.elapsed().as_secs_f64(),
            });
        }
    }

    fn cost(&self, scene: &Scene, start_s: f64) -> Cost {
        let report_s = if self.whole.count > 0.0 && self.reported.count > 1.0 {
            (self.reported.mean() - self.whole.mean()).max(0.0)
        } else {
            0.0
        };
        let base = self.base;
        let rate = match self.marks[..] {
            // The first base step warms caches and finds smoothing lengths.
            [_, from, .., to] => (to.cpu - from.cpu) / (to.time - from.time),
            [from, to] => (to.cpu - from.cpu) / (to.time - from.time),
            _ => self.base_step() / base,
        };
        let reports_within = match self.marks[..] {
            [_, from, .., to] => self.reports(from.time, to.time) / (to.time - from.time),
            _ => 0.0,
        };
        let (first, last) = (self.marks.first(), self.marks.last());
        let wall = match (first, last) {
            (Some(first), Some(last)) if last.cpu > 2.0 * first.cpu => {
                (last.wall - first.wall) / (last.cpu - first.cpu)
            }
            _ => 1.0 / rayon::current_num_threads() as f64,
        };
        let end = scene.run.end_time;
        let start_s = start_s + first.map_or(0.0, |first| first.cpu);
        Cost {
            rate: (rate - report_s * reports_within).max(0.0),
            start_s,
            report_s,
            files_s: 0.0,
            wall,
            updates: self.all.0.map(|updates| updates / self.all.1),
            ticks: self.ticks,
            longest: self.system.longest,
            reports: (end / self.schedule.report).ceil(),
            steps: self.steps(),
            end,
        }
    }

    /// Reports after `from` up to `to`.
    fn reports(&self, from: f64, to: f64) -> f64 {
        let count = |time: f64| (time / self.schedule.report + 1e-9).floor();
        count(to) - count(from)
    }

    /// CPU time of a base step of which less than a whole was seen.
    fn base_step(&self) -> f64 {
        let all = if self.whole.count > 0.0 {
            self.whole
        } else {
            self.reported
        };
        let updates: f64 = self.updates.iter().sum();
        let (particles, full) = (all.active / all.count, all.mean());
        if self.partial.count == 0.0 {
            return full * updates / particles;
        }
        let (few, some) = (
            self.partial.active / self.partial.count,
            self.partial.mean(),
        );
        if few > 0.5 * particles {
            return some * updates / few;
        }
        let slope = ((full - some) / (particles - few)).max(0.0);
        let floor = (some - slope * few).max(0.0);
        floor * self.ticks + slope * updates
    }

    /// Base steps of the whole run.
    fn steps(&self) -> u64 {
        let longest = self.system.longest.min(self.system.drag_step);
        let schedule = &self.schedule;
        let (mut now, mut steps) = (schedule.start, 0.0);
        while now < schedule.end {
            let next = schedule.after(now);
            steps += ((next - now) / longest * (1.0 - 1e-12)).ceil().max(1.0);
            now = next;
        }
        steps as u64
    }
}
