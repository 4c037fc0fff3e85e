//! Gas alone on the clock: the order of a step without any other population or gravity.

use nbody::points::clock::{Centre, Pacing};
use nbody::points::{Clock, Fault, Vec3, clock};

use crate::{Gas, Heat, Hydro};

/// What a run of gas alone did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Account {
    pub heat: Heat,
    /// Particles that were active, added up over all ticks.
    pub updates: usize,
    /// Particles that had a force, added up over all ticks.
    pub targets: usize,
    pub ticks: usize,
}

/// Advances gas from rest on the clock at `time` to `until`, in base steps of at most `base`, and leaves it at rest there.
pub fn advance(
    gas: &mut Gas,
    hydro: &Hydro,
    time: f64,
    until: f64,
    base: f64,
) -> Result<Account, Fault> {
    let mut account = Account::default();
    let mut clock = Clock::standing(time);
    let hydro = &mut hydro.clone().at(time);
    gas.density(hydro, &clock, Vec3::zeros())?;
    gas.rates.next_span.fill(0);
    gas.forces(hydro, &clock, &clock);
    loop {
        let last = clock.synchronous() && clock.end >= until;
        let next = match clock.synchronous() {
            true if last => clock.next_base(until + base, base),
            true => clock.next_base(until, base),
            false => clock,
        };
        hydro.domain = hydro.domain.at(clock.time());
        let updates = gas.density(hydro, &clock, Vec3::zeros())?;
        gas.steps(hydro, &clock, &next, &Pacing::free(f64::INFINITY))?;
        let targets = gas.forces(hydro, &clock, &next);
        account.heat = account
            .heat
            .and(gas.close(hydro, &clock, &Centre::default()));
        if last {
            gas.rest();
            return Ok(account);
        }
        account.updates += updates;
        account.targets += targets;
        account.ticks += 1;
        account.heat = account
            .heat
            .and(gas.open(hydro, &clock, &next, &Centre::default()));
        clock = next;
        let tick = gas.next_tick().min(clock::TICKS);
        clock.tick = tick;
        account.heat.frame += gas.refit(&hydro.domain.at(clock.time()), &clock);
    }
}
