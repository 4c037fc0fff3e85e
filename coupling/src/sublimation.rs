//! Sublimation and recondensation of ice as an operator: over the second half of a base step at its end, and over the first half of the next.
//!
//! It stands first in the list: it closes after all others and opens before them, with everybody at one time. Grain i shares its swarm out to
//! the gas around by max(w_ij, 0), w from [`gas::probe`]; each gas particle exchanges vapour with its shares ([`dust::sublimation`]), and the
//! grains of a swarm, whose number stays, are equal again afterwards. What a swarm loses in sum, dm_i, becomes mass of the gas:
//!     m_j += w_ij dm_i,  m_j v_j += w_ij dm_i V_i,  V_i = v_i where ice sublimates, sum_j w_ij v_j where vapour condenses,
//! so mass, momentum and angular momentum are kept to round-off, whatever drag does; vapour beyond w_ij dm_i is swapped for dry gas among the
//! neighbours. The kinetic energy that mixing takes is frictional heat. The gas keeps its temperature: what the vapour's internal energy lacks is
//! booked as radiated, below zero; latent heat and the vapour's molecular weight are left out. At an edge of the gas impulses turn it, as those
//! of drag do; grains that see too little of it for that keep what they have. Impulses found for half steps that open now stay what they are.
//! Half steps see one temperature: of second order in the step where mantles retreat evenly over a kernel, else of first.

use dust::Materials;
use dust::sublimation::{Room, Water};
use gas::Gas;
use gas::probe::isothermal;
use nbody::points::{Fault, Vec3};
use rayon::prelude::*;

use crate::System;
use crate::operator::{Meter, Operator, Phase};

mod links;
mod swarm;

use links::Links;
use swarm::Swarm;

/// What a scene's ice and gas are made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phases {
    pub water: Water,
    pub materials: Materials,
    /// Temperature by the square of the isothermal sound speed.
    pub kelvins: f64,
    /// Gas neighbours that a grain looks for.
    pub neighbours: f64,
    /// Share of the frictional heat that the gas keeps; none where it is bound to a temperature.
    pub heat_share: f64,
}

/// What a swarm gives to the gas around.
#[derive(Clone, Copy, Debug, Default)]
struct Given {
    /// Below zero: what it takes.
    mass: f64,
    /// Velocity that the mass brings along.
    v: Vec3,
    /// Heat that it makes within the swarm.
    heat: f64,
    /// Rotation of the gas around that keeps the angular momentum at an edge.
    spin: Vec3,
}

/// What a gas particle becomes.
#[derive(Clone, Copy, Debug, Default)]
struct Parcel {
    mass: f64,
    vapour: f64,
    dv: Vec3,
    heat: f64,
}

/// Exchange of ice and vapour between dust and gas.
pub struct Sublimate {
    phases: Phases,
    links: Links,
    swarms: Vec<Swarm>,
    /// By how much mantles retreat in each room, and the vapour that it gains.
    retreats: Vec<[f64; 2]>,
    given: Vec<Given>,
    parcels: Vec<Parcel>,
}

impl Sublimate {
    pub fn new(phases: Phases) -> Self {
        Self {
            phases,
            links: Links::default(),
            swarms: Vec::new(),
            retreats: Vec::new(),
            given: Vec::new(),
            parcels: Vec::new(),
        }
    }

    fn act(&mut self, system: &mut System, dt: f64) {
        (0..system.dust.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| Swarm::of(system, &self.phases, i))
            .collect_into_vec(&mut self.swarms);
        self.evaporate(&system.gas, dt);
        self.give(system);
        self.receive(&system.gas);
        self.settle_gas(system);
        self.settle_dust(system);
        system.reweighed = true;
    }

    /// What each room of gas makes of the shares in it.
    fn evaporate(&mut self, gas: &Gas, dt: f64) {
        let (links, phases) = (&self.links, &self.phases);
        let swarms = &self.swarms;
        (0..links.rooms.len())
            .into_par_iter()
            .with_min_len(64)
            .map_init(Vec::new, |shares, r| {
                let j = links.rooms[r] as usize;
                let mass = gas.particles.m[j];
                let room = Room {
                    volume: mass / gas.derived.rho[j],
                    vapour: gas.particles.vapour[j] * mass,
                    temperature: phases.kelvins * isothermal(gas, j),
                };
                shares.clear();
                shares.extend(
                    links
                        .guests(r)
                        .map(|(i, pair)| swarms[i].share(links.share[pair])),
                );
                let l = room.retreat(shares, &phases.water, dt);
                [l, shares.iter().map(|share| share.lost(l)).sum()]
            })
            .collect_into_vec(&mut self.retreats);
    }

    /// What each swarm gives to the gas.
    fn give(&mut self, system: &System) {
        let (links, swarms, retreats) = (&self.links, &self.swarms, &self.retreats);
        let (p, v_gas) = (&system.dust.particles, &system.gas.particles.v);
        (0..p.m.len())
            .into_par_iter()
            .with_min_len(256)
            .map(|i| {
                let lost = |(pair, room): (usize, usize)| {
                    swarms[i].share(links.share[pair]).lost(retreats[room][0])
                };
                let mass: f64 = links.hosts(i).map(lost).sum();
                let (m, v) = (p.m[i], p.v[i]);
                let spin = |v: Vec3| links.spin(i, mass * v);
                if mass >= 0.0 {
                    let (heat, spin) = (0.0, spin(v));
                    return Given {
                        mass,
                        v,
                        heat,
                        spin,
                    };
                }
                let around = links.seen(i, |room| v_gas[links.rooms[room] as usize]);
                let reduced = m * -mass / (m - mass);
                Given {
                    mass,
                    v: around,
                    heat: 0.5 * reduced * (v - around).norm_squared(),
                    spin: spin(around),
                }
            })
            .collect_into_vec(&mut self.given);
    }

    /// What each gas particle becomes of it.
    fn receive(&mut self, gas: &Gas) {
        let (links, given, retreats) = (&self.links, &self.given, &self.retreats);
        let p = &gas.particles;
        (0..links.rooms.len())
            .into_par_iter()
            .with_min_len(64)
            .map(|r| {
                let j = links.rooms[r] as usize;
                let (mut gained, mut impulse, mut heat) = (0.0, Vec3::zeros(), 0.0);
                for (i, pair) in links.guests(r) {
                    let (w, given) = (links.weight[pair], &given[i]);
                    let (dm, u) = (w * given.mass, given.v - p.v[j]);
                    let turned = w * links.turned(given.spin, i, pair);
                    gained += dm;
                    impulse += dm * u - turned;
                    // The turns around a grain are no net impulse: they work on velocities relative to any one.
                    heat += 0.5 * dm * u.norm_squared() - u.dot(&turned) + w * given.heat;
                }
                let mass = p.m[j] + gained;
                // The vapour's own rounding may leave less than none of it.
                let vapour = (p.vapour[j] * p.m[j] + retreats[r][1]).max(0.0);
                Parcel {
                    mass,
                    vapour: vapour / mass,
                    dv: impulse / mass,
                    heat: heat - 0.5 * impulse.norm_squared() / mass,
                }
            })
            .collect_into_vec(&mut self.parcels);
    }

    fn settle_gas(&self, system: &mut System) {
        let share = self.phases.heat_share;
        let (p, rates) = (&mut system.gas.particles, &mut system.gas.rates);
        let derived = &mut system.gas.derived;
        for (&j, parcel) in self.links.rooms.iter().zip(&self.parcels) {
            let j = j as usize;
            let part = p.m[j] / parcel.mass;
            let brought = (parcel.mass - p.m[j]) * p.u[j];
            system.ledger.radiated += (1.0 - share) * parcel.heat - brought;
            (p.m[j], p.vapour[j]) = (parcel.mass, parcel.vapour);
            p.v[j] += parcel.dv;
            rates.v_pred[j] += parcel.dv;
            let warmed = share * parcel.heat / parcel.mass;
            p.u[j] += warmed;
            rates.u_pred[j] += warmed;
            // Pairs exchange the impulses that they were found to.
            rates.dv_open[j] *= part;
            rates.du_open[j] *= part;
            derived.rho[j] /= part;
            derived.p[j] /= part;
        }
    }

    fn settle_dust(&self, system: &mut System) {
        let materials = &self.phases.materials;
        let (p, v_pred) = (&mut system.dust.particles, &mut system.dust.rates.v_pred);
        for (i, given) in self.given.iter().enumerate().filter(|(_, g)| g.mass != 0.0) {
            let (before, after) = (p.m[i], p.m[i] - given.mass);
            let old = p.composition[i];
            // Less than the rounding of what there was is none.
            let ice = old.x * before - given.mass;
            let ice = if ice > ROUNDING * before {
                ice / after
            } else {
                0.0
            };
            let core = (1.0 - ice) / (old.y + old.z);
            let new = Vec3::new(ice, core * old.y, core * old.z);
            let volume = after / before * materials.density(old) / materials.density(new);
            (p.m[i], p.composition[i]) = (after, new);
            p.grain_radius[i] *= volume.cbrt();
            p.grain_density[i] = materials.density(new);
            if given.mass < 0.0 {
                let change = given.mass / after * (p.v[i] - given.v);
                p.v[i] += change;
                v_pred[i] += change;
            }
        }
    }
}

/// Ice below this part of a grain is what rounding has left of none.
const ROUNDING: f64 = 1e-15;

impl Operator for Sublimate {
    fn name(&self) -> &'static str {
        "sublimation"
    }

    fn counted(&self, system: &System) -> bool {
        system.clock.synchronous()
    }

    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        if !system.clock.synchronous() {
            return Ok(false);
        }
        meter.enter(Phase::Dust);
        self.links.find(system, self.phases.neighbours);
        let dt = system.clock.end - system.clock.start;
        if dt > 0.0 {
            self.act(system, 0.5 * dt);
        }
        meter.count(system.dust.len(), 0);
        Ok(dt > 0.0)
    }

    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        if !system.clock.synchronous() {
            return Ok(false);
        }
        meter.enter(Phase::Dust);
        self.act(system, 0.5 * (system.next.end - system.next.start));
        Ok(true)
    }
}

#[cfg(test)]
mod tests;
