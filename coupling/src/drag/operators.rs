//! Drag as operators of a step: of dust in gas, and of bodies in gas.

use dust::Superparticles;
use gas::Hydro;
use gas::probe::Reach;
use nbody::points::{Columns, Fault, Vec3};

use super::course::Course;
use super::{BodiesInGas, Booking, Exchange, Grains, Half, Settings, Star, StoppingLaw};
use crate::System;
use crate::operator::{Meter, Operator, Phase};

const PLANET: u32 = nbody::Kind::Planet as u32;

/// Immersed particles look for gas within this many of the largest smoothing lengths of the gas.
const FARTHEST: f64 = 2.0;

/// By how much a base step may be longer than the last, where a tolerance sets it.
const GROWTH: f64 = 2.0;

/// Load of a grain from which on all of them hold what the gas does beyond what each makes it do; of lighter ones the correction leaves less than a
/// hundredth of it.
const HEAVY: f64 = 0.1;

/// Grains that differ by less are of one kind.
const ALIKE: f64 = 1e-3;

fn exchange(law: StoppingLaw, hydro: &Hydro, feedback: bool, heat_share: f64) -> Exchange {
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
fn limit(exchange: &mut Exchange, system: &System) {
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

/// Drag between dust and gas.
pub struct DustDrag {
    exchange: Exchange,
    /// Whether grains of several stopping times are solved together.
    pub mixtures: bool,
    /// Error of the splitting of a step that base steps keep to; none: they do not depend on it.
    pub tolerance: Option<f64>,
    active: Vec<u32>,
    steps: Vec<f64>,
}

impl DustDrag {
    pub fn new(law: StoppingLaw, hydro: &Hydro, feedback: bool, heat_share: f64) -> Self {
        Self {
            exchange: exchange(law, hydro, feedback, heat_share),
            mixtures: true,
            tolerance: None,
            active: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// Notes how drag accelerates in the halves that open.
    fn note(&self, system: &mut System) {
        let rates = &mut system.dust.rates;
        rates.opening_drag.resize(rates.v_pred.len(), Vec3::zeros());
        for row in self.exchange.rows() {
            rates.opening_drag[row.i as usize] = row.dv / self.steps[row.place as usize];
        }
    }

    /// Chooses the longest that the base step after the next may be, by how drag went over the step that ends now.
    fn learn(&self, system: &mut System, tolerance: f64) {
        let (unit, rates) = (system.next.unit(), &system.dust.rates);
        let mut longest = GROWTH * (system.next.end - system.next.start);
        for row in self.exchange.rows() {
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
            let crossings = self.exchange.rows().map(|row| row.crossing);
            system.drag_step = tolerance.sqrt() * crossings.fold(f64::INFINITY, f64::min);
        }
        system.next = system.clock.next_base(system.next.end, system.drag_step);
    }

    fn act(&mut self, system: &mut System, half: Half, step: impl Fn(&System, usize) -> f64) {
        self.steps.clear();
        self.steps
            .extend(self.active.iter().map(|&i| step(system, i as usize)));
        let star = Star::of(system);
        let mut grains = Grains {
            dust: &mut system.dust,
            star,
        };
        if half == Half::Opening && system.reweighed {
            self.exchange.reweigh(&system.gas, &grains);
        }
        let booking = self.exchange.exchange(
            &mut system.gas,
            &mut grains,
            &self.steps,
            (half, &system.clock),
        );
        book(system, &booking, self.exchange.settings.feedback);
    }
}

impl Operator for DustDrag {
    fn name(&self) -> &'static str {
        "drag dust"
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Drag);
        system.list_active_dust(&mut self.active);
        limit(&mut self.exchange, system);
        if system.clock.synchronous() {
            let several = self.mixtures && are_several(&system.dust.particles);
            self.exchange.settings.several = several;
        }
        let star = Star::of(system);
        let mut grains = Grains {
            dust: &mut system.dust,
            star,
        };
        self.exchange
            .prepare(&system.gas, &mut grains, &self.active, &system.domain);
        meter.count(self.active.len(), 0);
        if let Some(tolerance) = self.tolerance.filter(|_| system.clock.synchronous()) {
            self.pace(system, tolerance);
        }
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        self.act(system, Half::Closing, |s, i| {
            s.closing(s.dust.particles.begin[i], s.dust.particles.span[i])
        });
        let rates = &mut system.dust.rates;
        if rates.excess.is_empty() && self.exchange.rows().any(|row| row.eps > HEAVY) {
            rates.excess.resize(rates.v_pred.len(), Vec3::zeros());
        }
        if let Some(tolerance) = self.tolerance.filter(|_| system.clock.synchronous()) {
            self.learn(system, tolerance);
        }
        Ok(true)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        self.act(system, Half::Opening, |s, i| {
            s.opening(s.dust.rates.next_span[i])
        });
        if self.tolerance.is_some() {
            self.note(system);
        }
        Ok(true)
    }
}

/// Drag between bodies and gas, at the bodies' ticks.
pub struct BodyDrag {
    exchange: Exchange,
    active: Vec<u32>,
    steps: Vec<f64>,
    /// Places of the planets, and their velocities before an exchange.
    planets: Vec<(usize, Vec3)>,
}

impl BodyDrag {
    pub fn new(law: StoppingLaw, hydro: &Hydro, feedback: bool, heat_share: f64) -> Self {
        Self {
            exchange: exchange(law, hydro, feedback, heat_share),
            active: Vec::new(),
            steps: Vec::new(),
            planets: Vec::new(),
        }
    }

    fn act(&mut self, system: &mut System, half: Half, step: f64) {
        self.steps.clear();
        self.steps.resize(self.active.len(), step);
        let star = Star::of(system);
        self.planets.clear();
        let planets = (0..system.bodies.len()).filter(|&i| system.bodies.kind[i] == PLANET);
        self.planets
            .extend(planets.map(|i| (i, system.bodies.v[i])));
        let mut h = std::mem::take(&mut system.bodies.h);
        let mut bodies = BodiesInGas {
            bodies: &mut system.bodies,
            h: &mut h,
            star,
        };
        if half == Half::Opening && system.reweighed {
            self.exchange.reweigh(&system.gas, &bodies);
        }
        let booking = self.exchange.exchange(
            &mut system.gas,
            &mut bodies,
            &self.steps,
            (half, &system.clock),
        );
        system.bodies.h = h;
        for &(i, before) in &self.planets {
            let impulse = system.bodies.m[i] * (system.bodies.v[i] - before);
            system.braked.add(system.bodies.id[i], impulse);
        }
        book(system, &booking, self.exchange.settings.feedback);
        system.look();
    }
}

impl Operator for BodyDrag {
    fn name(&self) -> &'static str {
        "drag bodies"
    }

    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        if !system.bodies_active() {
            return Ok(());
        }
        meter.enter(Phase::Drag);
        self.active.clear();
        self.active.extend(0..system.bodies.x.len() as u32);
        limit(&mut self.exchange, system);
        // Neighbours in the list are to be neighbours in space.
        let x: &[Vec3] = &system.bodies.x;
        let cube = nbody::points::sort::Cube::around(x);
        self.active.sort_by_cached_key(|&i| cube.key(x[i as usize]));
        let star = Star::of(system);
        let mut h = std::mem::take(&mut system.bodies.h);
        h.resize(self.active.len(), 0.0);
        let mut bodies = BodiesInGas {
            bodies: &mut system.bodies,
            h: &mut h,
            star,
        };
        self.exchange
            .prepare(&system.gas, &mut bodies, &self.active, &system.domain);
        system.bodies.h = h;
        meter.count(self.active.len(), 0);
        Ok(())
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        let active = system.bodies_active();
        if active {
            self.act(
                system,
                Half::Closing,
                system.closing(system.pace.begin, system.pace.span),
            );
        }
        Ok(active)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Drag);
        let active = system.bodies_active();
        if active {
            self.act(system, Half::Opening, system.opening(system.pace.next_span));
        }
        Ok(active)
    }
}
