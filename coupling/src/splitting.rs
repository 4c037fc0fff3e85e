//! The splitting: a step as a symmetric composition of operators (Strang 1968).
//!
//! With the list `kick drag drift`, a particle's step reads: kick drag | drift | drag kick. At a tick the active particles close
//! their step (the list backwards) and open the next (the list forwards); the drift carries everybody to the next tick.

use nbody::points::{Fault, clock::TICKS};

use crate::ledger::Census;
use crate::operator::{Meter, Operator, Phase};
use crate::{Pace, System};

/// The operators of a scene, in the order of the first half of a step.
pub struct Splitting {
    operators: Vec<Box<dyn Operator>>,
    /// Whether each operator's changes are booked one by one.
    pub bookkeeping: bool,
}

impl Splitting {
    pub fn new(operators: Vec<Box<dyn Operator>>) -> Self {
        Self {
            operators,
            bookkeeping: true,
        }
    }

    /// Names of the operators, in order.
    pub fn names(&self) -> Vec<&'static str> {
        self.operators.iter().map(|o| o.name()).collect()
    }

    /// Ends the steps that end at this tick. Where everybody is active, the next base step runs to at most `until` and is at
    /// most `longest` long.
    pub fn close(
        &mut self,
        system: &mut System,
        until: f64,
        longest: f64,
        meter: &mut dyn Meter,
    ) -> Result<(), Fault> {
        system.next = if system.clock.synchronous() {
            system.clock.next_base(until, longest)
        } else {
            system.clock
        };
        meter.enter(Phase::Tree);
        system.domain = system.domain.at(system.clock.time());
        let (domain, clock) = (system.domain, system.clock);
        let crossed = system.gas.refit(&domain, &clock) + system.dust.refit(&domain, &clock);
        system.ledger.receive(crossed);
        meter.count(0, 0);
        system.reweighed = false;
        for operator in &mut self.operators {
            operator.prepare(system, meter)?;
        }
        system.ledger.forget();
        let books = self.bookkeeping;
        for operator in self.operators.iter_mut().rev() {
            let here = books && !operator.between_ticks();
            booked(here, operator.as_mut(), system, |o, s| o.close(s, meter))?;
        }
        Ok(())
    }

    /// Begins the steps that begin at this tick.
    pub fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        let books = self.bookkeeping;
        for operator in &mut self.operators {
            let here = books && !operator.between_ticks();
            booked(here, operator.as_mut(), system, |o, s| o.open(s, meter))?;
        }
        if system.bodies_active() {
            let (begin, span) = (system.next.tick, system.pace.next_span);
            system.pace = Pace {
                begin,
                span,
                end: begin + span,
                next_span: span,
            };
        }
        system.clock = system.next;
        Ok(())
    }

    /// Carries everybody to the next tick at which anybody is active.
    pub fn cross(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        let tick = system.next_tick().min(TICKS);
        let dt = f64::from(tick - system.clock.tick) * system.clock.unit();
        system.clock.tick = tick;
        let books = self.bookkeeping;
        for operator in &mut self.operators {
            let here = books && operator.between_ticks();
            booked(here, operator.as_mut(), system, |o, s| {
                o.cross(s, dt, meter)
            })?;
        }
        Ok(())
    }
}

/// Lets an operator act; `here`, where it has something to do, books what it changed: by a census before, if the last one is not of now, and another
/// after.
fn booked(
    here: bool,
    operator: &mut dyn Operator,
    system: &mut System,
    act: impl FnOnce(&mut dyn Operator, &mut System) -> Result<bool, Fault>,
) -> Result<(), Fault> {
    let counted = here && operator.counted(system);
    let scope = operator.scope(system);
    if counted && !system.ledger.remembers(scope) {
        let census = Census::within(scope, system);
        system.ledger.turn(scope, census);
    }
    if act(operator, system)? {
        if counted {
            let census = Census::within(scope, system);
            system.ledger.book(operator.name(), scope, census);
        } else {
            system.ledger.forget();
        }
    }
    Ok(())
}
