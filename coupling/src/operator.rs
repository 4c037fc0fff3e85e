//! An operator: one process that changes the system over a step, and the meter that its work is timed with.

use nbody::points::Fault;

use crate::System;
use crate::ledger::Scope;

/// The parts of the work that timings tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    Tree,
    Gravity,
    Density,
    Hydro,
    Drag,
    Dust,
    Bodies,
    Output,
}

impl Phase {
    pub const ALL: [Self; 8] = [
        Self::Tree,
        Self::Gravity,
        Self::Density,
        Self::Hydro,
        Self::Drag,
        Self::Dust,
        Self::Bodies,
        Self::Output,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Tree => "tree",
            Self::Gravity => "gravity",
            Self::Density => "density",
            Self::Hydro => "hydro",
            Self::Drag => "drag",
            Self::Dust => "dust",
            Self::Bodies => "bodies",
            Self::Output => "output",
        }
    }
}

/// Told which phase begins; the phase before ends there. The clock that it reads is its own affair.
pub trait Meter {
    fn enter(&mut self, phase: Phase);

    /// Adds one call with so many targets and interactions to the present phase.
    fn count(&mut self, targets: usize, interactions: u64);
}

/// A meter that measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unmetered;

impl Meter for Unmetered {
    fn enter(&mut self, _: Phase) {}

    fn count(&mut self, _: usize, _: u64) {}
}

/// One process. At a tick the particles whose steps end are active: operators are prepared in the order of the list, then close the
/// steps backwards, then open the next ones forwards; between ticks they carry everybody across.
pub trait Operator: Send {
    /// A word that ledger and log know the operator by.
    fn name(&self) -> &'static str;

    /// Whether the ledger is to count everybody before and after the operator at this tick. Not of those that change nothing of what it
    /// counts, or that book themselves.
    fn counted(&self, _: &System) -> bool {
        true
    }

    /// Whether it acts between ticks, and not at them.
    fn between_ticks(&self) -> bool {
        false
    }

    /// Whom it counts then: all whom the operator may change.
    fn scope(&self, _: &System) -> Scope {
        Scope::Everybody
    }

    /// What is needed at the present positions, for closing and opening alike.
    fn prepare(&mut self, _: &mut System, _: &mut dyn Meter) -> Result<(), Fault> {
        Ok(())
    }

    /// The second half of the steps that end now. Answers whether it changed what the ledger counts; so do the next two.
    fn close(&mut self, _: &mut System, _: &mut dyn Meter) -> Result<bool, Fault> {
        Ok(false)
    }

    /// The first half of the steps that begin now.
    fn open(&mut self, _: &mut System, _: &mut dyn Meter) -> Result<bool, Fault> {
        Ok(false)
    }

    /// Carries everybody over `dt` to the next tick, at which the clock stands already.
    fn cross(&mut self, _: &mut System, _dt: f64, _: &mut dyn Meter) -> Result<bool, Fault> {
        Ok(false)
    }
}
