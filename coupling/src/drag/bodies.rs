//! Drag of bodies in gas as an operator of a step, and what an exchange of bodies takes.

use dust::Dust;
use gas::{Gas, Hydro};
use nbody::points::{Columns, Fault, Vec3};

use super::operators::{book, exchange, limit};
use super::{BodiesInGas, Exchange, Half, Star, StoppingLaw};
use crate::System;
use crate::operator::{Meter, Operator, Phase};

const PLANET: u32 = nbody::Kind::Planet as u32;

/// The bodies that take part in an exchange.
#[derive(Default)]
pub(super) struct Fleet {
    /// places, so that neighbours in the list are neighbours in space
    pub places: Vec<u32>,
    /// Places of the planets, and their velocities before an exchange.
    planets: Vec<(usize, Vec3)>,
}

impl Fleet {
    pub fn list(&mut self, system: &mut System) {
        let x: &[Vec3] = &system.bodies.x;
        self.places.clear();
        self.places.extend(0..x.len() as u32);
        let cube = nbody::points::sort::Cube::around(x);
        self.places.sort_by_cached_key(|&i| cube.key(x[i as usize]));
        system.bodies.h.resize(self.places.len(), 0.0);
    }

    pub fn remember(&mut self, system: &System) {
        self.planets.clear();
        let planets = (0..system.bodies.len()).filter(|&i| system.bodies.kind[i] == PLANET);
        self.planets
            .extend(planets.map(|i| (i, system.bodies.v[i])));
    }

    /// Books how planets were braked, and shows the bodies as they are now.
    pub fn settle(&self, system: &mut System) {
        for &(i, before) in &self.planets {
            let impulse = system.bodies.m[i] * (system.bodies.v[i] - before);
            system.braked.add(system.bodies.id[i], impulse);
        }
        system.look();
    }
}

/// Does something with the bodies of a system as particles in gas, and gas and dust beside them.
pub(super) fn with_bodies<T>(
    system: &mut System,
    act: impl FnOnce(BodiesInGas, &mut Gas, &mut Dust) -> T,
) -> T {
    let star = Star::of(system);
    let mut h = std::mem::take(&mut system.bodies.h);
    let bodies = BodiesInGas {
        bodies: &mut system.bodies,
        h: &mut h,
        star,
    };
    let answer = act(bodies, &mut system.gas, &mut system.dust);
    system.bodies.h = h;
    answer
}

/// Drag between bodies and gas, at the bodies' ticks.
pub struct BodyDrag {
    exchange: Exchange,
    fleet: Fleet,
    steps: Vec<f64>,
}

impl BodyDrag {
    pub fn new(law: StoppingLaw, hydro: &Hydro, feedback: bool, heat_share: f64) -> Self {
        Self {
            exchange: exchange(law, hydro, feedback, heat_share),
            fleet: Fleet::default(),
            steps: Vec::new(),
        }
    }

    fn act(&mut self, system: &mut System, half: Half, step: f64) {
        self.steps.clear();
        self.steps.resize(self.fleet.places.len(), step);
        self.fleet.remember(system);
        let (exchange, steps, clock) = (&mut self.exchange, &self.steps, system.clock);
        let reweighed = half == Half::Opening && system.reweighed;
        let booking = with_bodies(system, |mut bodies, gas, _| {
            exchange.act(gas, &mut bodies, steps, (half, &clock), reweighed)
        });
        book(system, &booking, self.exchange.settings.feedback);
        self.fleet.settle(system);
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
        limit(&mut self.exchange, system);
        self.fleet.list(system);
        let (exchange, places, domain) = (&mut self.exchange, &self.fleet.places, system.domain);
        with_bodies(system, |mut bodies, gas, _| {
            exchange.prepare(gas, &mut bodies, places, &domain);
        });
        meter.count(self.fleet.places.len(), 0);
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
