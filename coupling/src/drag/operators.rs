//! Drag of dust in gas as an operator of a step, and of bodies with it.

use dust::Superparticles;
use gas::Hydro;
use gas::probe::Reach;
use nbody::points::{Columns, Fault, Vec3};

use super::bodies::{Fleet, with_bodies};
use super::course::Course;
use super::row::Row;
use super::{Booking, Exchange, Grains, Half, Mixed, Settings, Star, StoppingLaw};
use crate::System;
use crate::operator::{Meter, Operator, Phase};

/// Immersed particles look for gas within this many of the largest smoothing lengths of the gas.
const FARTHEST: f64 = 2.0;

/// By how much a base step may be longer than the last, where a tolerance sets it.
const GROWTH: f64 = 2.0;

/// Load of a grain from which on all of them hold what the gas does beyond what each makes it do; of lighter ones the correction leaves less than a
/// hundredth of it.
const HEAVY: f64 = 0.1;

/// Grains that differ by less are of one kind.
const ALIKE: f64 = 1e-3;

pub(super) fn exchange(
    law: StoppingLaw,
    hydro: &Hydro,
    feedback: bool,
    heat_share: f64,
) -> Exchange {
    let reach = Reach {
        neighbours: hydro.neighbours,
        largest: 1.0,
    };
    Exchange::new(Settings {
        feedback,
        heat_share,
        bound: !hydro.eos.is_free(),
        ..Settings::new(law, reach)
    })
}

/// Whether grains differ in what stops them.
fn are_several(dust: &Superparticles) -> bool {
    let differ = |column: &[f64]| {
        column
            .iter()
            .any(|x| (x - column[0]).abs() > ALIKE * column[0])
    };
    differ(&dust.grain_radius) || differ(&dust.grain_density) || differ(&dust.stopping)
}

/// Limits the search for gas to where gas is.
pub(super) fn limit(exchange: &mut Exchange, system: &System) {
    let largest = system.gas.particles.h.iter().copied().fold(0.0, f64::max);
    exchange.settings.reach.largest = FARTHEST * largest;
}

/// Books what an exchange did beyond moving momentum between populations.
pub(super) fn book(system: &mut System, booking: &Booking, feedback: bool) {
    system.ledger.radiated += booking.radiated + booking.work;
    system.ledger.receive(booking.frame);
    if !feedback {
        let lost = &mut system.ledger.given_away;
        lost.momentum += booking.gas.momentum;
        lost.angular_momentum += booking.gas.angular_momentum;
        lost.kinetic += booking.gas.kinetic;
    }
    system.ledger.lopsided += booking.plain as u64;
}

/// Drag between dust and gas, and of bodies in the same exchange if they are to be solved together.
pub struct DustDrag {
    exchange: Exchange,
    /// Whether particles of several stopping times are solved together.
    pub mixtures: bool,
    /// Error of the splitting of a step that base steps keep to; none: they do not depend on it.
    pub tolerance: Option<f64>,
    /// The law of bodies that take part.
    pub bodies: Option<StoppingLaw>,
    fleet: Fleet,
    /// Whether grains differ.
    differ: bool,
    /// Dust, and bodies after all dust.
    active: Vec<u32>,
    steps: Vec<f64>,
}

impl DustDrag {
    pub fn new(law: StoppingLaw, hydro: &Hydro, feedback: bool, heat_share: f64) -> Self {
        Self {
            exchange: exchange(law, hydro, feedback, heat_share),
            mixtures: true,
            tolerance: None,
            bodies: None,
            fleet: Fleet::default(),
            differ: false,
            active: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// Rows of dust.
    fn grains(&self, system: &System) -> impl Iterator<Item = &Row> {
        let dust = system.dust.len();
        self.exchange
            .rows()
            .filter(move |row| (row.i as usize) < dust)
    }

    /// Notes how drag accelerates in the halves that open.
    fn note(&self, system: &mut System) {
        let mut drag = std::mem::take(&mut system.dust.rates.opening_drag);
        drag.resize(system.dust.len(), Vec3::zeros());
        for row in self.grains(system) {
            drag[row.i as usize] = row.dv / self.steps[row.place as usize];
        }
        system.dust.rates.opening_drag = drag;
    }

    /// Chooses the longest that the base step after the next may be, by how drag went over the step that ends now.
    fn learn(&self, system: &mut System, tolerance: f64) {
        let (unit, rates) = (system.next.unit(), &system.dust.rates);
        let mut longest = GROWTH * (system.next.end - system.next.start);
        for row in self.grains(system) {
            let i = row.i as usize;
            let opening = rates.opening_drag.get(i).copied().unwrap_or_default();
            let half = self.steps[row.place as usize];
            if let Some(course) = Course::of(row, opening, half) {
                let own = f64::from(rates.next_span[i]) * unit;
                longest = course.allowed(longest, own, tolerance);
            }
        }
        system.drag_step = longest;
    }

    /// Shortens the base step that begins now to what the tolerance of the splitting leaves it; the first, of which nothing is known, to a part of the
    /// time in which sound and a grain cross a smoothing length.
    fn pace(&self, system: &mut System, tolerance: f64) {
        if system.clock.step == 0 {
            let crossings = self.grains(system).map(|row| row.crossing);
            system.drag_step = tolerance.sqrt() * crossings.fold(f64::INFINITY, f64::min);
        }
        system.next = system.clock.next_base(system.next.end, system.drag_step);
    }

    /// The half step of a grain is `step`, that of bodies `bodies_step`.
    fn act(
        &mut self,
        system: &mut System,
        half: Half,
        step: impl Fn(&System, usize) -> f64,
        bodies_step: f64,
    ) {
        let dust = system.dust.len();
        let both = |&i: &u32| match i as usize {
            i if i < dust => step(system, i),
            _ => bodies_step,
        };
        self.steps.clear();
        self.steps.extend(self.active.iter().map(both));
        let (exchange, steps, clock) = (&mut self.exchange, &self.steps, system.clock);
        let reweighed = half == Half::Opening && system.reweighed;
        let booking = if let Some(law) = self.bodies.filter(|_| system.bodies_active()) {
            self.fleet.remember(system);
            let booking = with_bodies(system, |bodies, gas, dust| {
                let mut mixed = Mixed::new(dust, bodies, law);
                exchange.act(gas, &mut mixed, steps, (half, &clock), reweighed)
            });
            self.fleet.settle(system);
            booking
        } else {
            let star = Star::of(system);
            let dust = &mut system.dust;
            let mut grains = Grains { dust, star };
            exchange.act(
                &mut system.gas,
                &mut grains,
                steps,
                (half, &clock),
                reweighed,
            )
        };
        book(system, &booking, self.exchange.settings.feedback);
    }
}

impl Operator for DustDrag {
    fn name(&self) -> &'static str {
        match self.bodies {
            None => "drag dust",
            Some(_) => "drag",
        }
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Drag);
        system.list_active_dust(&mut self.active);
        limit(&mut self.exchange, system);
        if system.clock.synchronous() {
            self.differ = are_several(&system.dust.particles);
        }
        let bodies = self.bodies.filter(|_| system.bodies_active());
        let beside = bodies.is_some() && !system.bodies.is_empty();
        self.exchange.settings.several = self.mixtures && (self.differ || beside);
        self.exchange.settings.alike = !self.differ;
        let (exchange, domain) = (&mut self.exchange, system.domain);
        if let Some(law) = bodies {
            self.fleet.list(system);
            let first = system.dust.len() as u32;
            let places = self.fleet.places.iter().map(|i| first + i);
            self.active.extend(places);
            let active = &self.active;
            with_bodies(system, |bodies, gas, dust| {
                let mut mixed = Mixed::new(dust, bodies, law);
                exchange.prepare(gas, &mut mixed, active, &domain);
            });
        } else {
            let star = Star::of(system);
            let dust = &mut system.dust;
            let mut grains = Grains { dust, star };
            exchange.prepare(&system.gas, &mut grains, &self.active, &domain);
        }
        meter.count(self.active.len(), 0);
        if let Some(tolerance) = self.tolerance.filter(|_| system.clock.synchronous()) {
            self.pace(system, tolerance);
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        let bodies = system.closing(system.pace.begin, system.pace.span);
        let own =
            |s: &System, i: usize| s.closing(s.dust.particles.begin[i], s.dust.particles.span[i]);
        self.act(system, Half::Closing, own, bodies);
        let heavy = || self.exchange.heaviest() > HEAVY;
        if system.dust.rates.excess.is_empty() && heavy() {
            let n = system.dust.len();
            system.dust.rates.excess.resize(n, Vec3::zeros());
        }
        if let Some(tolerance) = self.tolerance.filter(|_| system.clock.synchronous()) {
            self.learn(system, tolerance);
        }
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        let bodies = system.opening(system.pace.next_span);
        let own = |s: &System, i: usize| s.opening(s.dust.rates.next_span[i]);
        self.act(system, Half::Opening, own, bodies);
        if self.tolerance.is_some() {
            self.note(system);
        }
        Ok(true)
    }
}
