//! Sod's shock tube in the plane, gamma = 5/3, with lattices turned against the shock: how much a viscosity heeds the angle at which pairs stand.
//!
//! Square lattices, 1/240 and 3/240 apart on the left and on the right, turned by 0, 18, 27 and 45 degrees ([`tilt`]). Masses are within an eighth of each
//! other, and the shock runs through one of them alone. Means over four times from 0.14 to 0.2 of
//! - the width of the shock ([`front`]) by the distance of particles ahead of it,
//! - the jump of the entropy P / rho^gamma from ahead of it to behind, by the exact one,
//! - the rms of viscous accelerations across the shock's normal by that along it, within the width on either side,
//! - the rms velocity between contact and shock, along about its mean and across, by the exact one;
//!
//! what matters of the first two is their spread over the angles. Mean velocities and entropies behind a shock follow from what is conserved, whatever the
//! viscosity. By every viscosity that the scheme allows, or by that which it names. `planar` and `planar-switch` have the same alpha: the former acts along the axis of
//! compression, the latter along the line of each pair. Questions of Makino (2013, lecture slides). Exact solution: [`super::riemann`].

use nbody::points::Vec3;

use self::front::{Front, rms};
use self::tilt::Tilt;
use self::tube::Tube;
use super::sod::TUBE;
use super::{Bar, End, Quantity, Row, Scheme};
use crate::verify::ring::VISCOSITIES;
use crate::verify::viscous::Inviscid;

mod front;
mod tilt;
mod tube;

const TILTS: [Tilt; 4] = [
    Tilt { rise: 0, run: 1 },
    Tilt { rise: 1, run: 3 },
    Tilt { rise: 1, run: 2 },
    Tilt { rise: 1, run: 1 },
];
/// Particles a length on the left.
const CELLS: f64 = 240.0;
const TIMES: [f64; 4] = [0.14, 0.16, 0.18, 0.2];

/// Up to where the right half has nothing but this shock.
const FAR: f64 = 1.58;
/// What rounding may leave of the sum of some 1e4 forces that cancel pair by pair.
const ROUNDING: [f64; 2] = [1e-14, 1e-12];

/// What is seen of a shock.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    width: f64,
    jump: f64,
    /// The error of the entropy behind.
    entropy: f64,
    /// Of viscous accelerations, by that along.
    across: f64,
    noise_along: f64,
    noise_across: f64,
    /// The sum of viscous forces by that of the sizes of all forces.
    net: f64,
}

impl Tube {
    /// The means over times by a scheme.
    fn seen(&self, scheme: &Scheme) -> Seen {
        let mut trial = scheme.trial(&self.scene(), |gas| self.lay_out(gas));
        let inviscid = Inviscid::of(&trial);
        let mut all = Vec::new();
        let stops: Vec<f64> = std::iter::once(0.0).chain(TIMES).collect();
        let done = trial.run(&stops, |stop| {
            let time = stop.system.clock.time();
            if time > 0.0 {
                let ids = &stop.system.gas.particles.id;
                let mut drags: Vec<(u64, Vec3)> =
                    (ids.iter().copied().zip(inviscid.drags(stop.system))).collect();
                drags.sort_unstable_by_key(|(id, _)| *id);
                all.push(self.look(&End::of(stop.system, stop.books), &drags, time));
            }
        });
        done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        let mean = |of: fn(&Seen) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        Seen {
            width: mean(|seen| seen.width),
            jump: mean(|seen| seen.jump),
            entropy: mean(|seen| seen.entropy),
            across: mean(|seen| seen.across),
            noise_along: mean(|seen| seen.noise_along),
            noise_across: mean(|seen| seen.noise_across),
            net: all.iter().map(|seen| seen.net).fold(0.0, f64::max),
        }
    }

    /// What is seen at a time; viscous accelerations in the order of identities.
    fn look(&self, end: &End, drags: &[(u64, Vec3)], time: f64) -> Seen {
        let waves = TUBE.waves();
        let (d, behind) = (self.distance(), waves.inner[1]);
        let [contact, shock] =
            [waves.contact(), waves.right_wave()[0]].map(|speed| 1.0 + speed * time);
        let way = |x: f64| (x - contact) / (shock - contact);
        // Of the right half; the box's end sends a shock of its own back to 1.63.
        let first = self.tilt.places(0.0, self.side, self.tiles).len() as u64;
        let gas = || (end.gas.iter().zip(drags)).filter(|(p, _)| p.id >= first && p.x.x < FAR);
        let points: Vec<[f64; 2]> = gas()
            .filter(|(p, _)| way(p.x.x) > 0.5)
            .map(|(p, _)| [p.x.x, p.v.x / behind.v])
            .collect();
        let guess = Front {
            place: shock,
            half: 2.0 * d,
        };
        let front = Front::fit(&points, guess);
        let viscous = |axis: usize| {
            let zone = gas().filter(|(p, _)| (p.x.x - front.place).abs() < front.width());
            rms(zone.map(|(_, (_, drag))| drag[axis]))
        };
        let plateau: Vec<&super::State> = gas()
            .filter(|(p, _)| (0.25..0.75).contains(&way(p.x.x)))
            .map(|(p, _)| p)
            .collect();
        let calm: Vec<&super::State> = gas()
            .filter(|(p, _)| p.x.x > front.place + 3.0 * front.width())
            .map(|(p, _)| p)
            .collect();
        let v = mean(&plateau, |p| p.v.x);
        let exact = entropy(behind.p, behind.rho) / entropy(waves.right.p, waves.right.rho);
        // By that of the gas ahead: sums over a lattice have a density of their own.
        let [after, before] = [&plateau, &calm].map(|gas| mean(gas, |p| entropy(p.p, p.rho)));
        let rise = after / before;
        let net: Vec3 = end
            .gas
            .iter()
            .zip(drags)
            .map(|(p, drag)| p.m * drag.1)
            .sum();
        Seen {
            width: front.width() / d,
            jump: (rise - 1.0) / (exact - 1.0),
            entropy: rise / exact - 1.0,
            across: viscous(1) / viscous(0),
            noise_along: rms(plateau.iter().map(|p| p.v.x - v)) / behind.v,
            noise_across: rms(plateau.iter().map(|p| p.v.y)) / behind.v,
            net: net.norm() / end.gas.iter().map(|p| p.m * p.a.norm()).sum::<f64>(),
        }
    }
}

fn mean(gas: &[&super::State], of: Quantity) -> f64 {
    gas.iter().map(|p| of(p)).sum::<f64>() / gas.len() as f64
}

fn entropy(p: f64, rho: f64) -> f64 {
    p / rho.powf(TUBE.gamma)
}

/// A viscosity by its name, at all angles.
struct Turned {
    name: String,
    seen: [Seen; TILTS.len()],
}

impl Turned {
    fn mean(&self, of: fn(&Seen) -> f64) -> f64 {
        self.seen.iter().map(of).sum::<f64>() / TILTS.len() as f64
    }

    /// The largest less the least.
    fn spread(&self, of: fn(&Seen) -> f64) -> f64 {
        let values = || self.seen.iter().map(of);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    }

    /// The largest size; not a number if one is none.
    fn largest(&self, of: fn(&Seen) -> f64) -> f64 {
        let sizes = self.seen.iter().map(|seen| of(seen).abs());
        sizes.fold(0.0, |a, b| if a >= b { a } else { b })
    }

    fn rows(&self) -> Vec<Row> {
        let row =
            |what: &str, measured, bar| Row::new(format!("{}: {what}", self.name), measured, bar);
        vec![
            row(
                "spread of the width over angles, by its mean",
                self.spread(|seen| seen.width) / self.mean(|seen| seen.width),
                Bar::None,
            ),
            row(
                "spread of the jump of entropy, by the exact one",
                self.spread(|seen| seen.jump),
                Bar::None,
            ),
            row(
                "viscous force across by along, largest",
                self.largest(|seen| seen.across),
                Bar::None,
            ),
            row(
                "entropy behind the shock, largest error",
                self.largest(|seen| seen.entropy),
                Bar::Limit([0.02, 0.05]),
            ),
            row(
                "sum of viscous forces by that of all sizes",
                self.largest(|seen| seen.net),
                Bar::Limit(ROUNDING),
            ),
        ]
    }
}

/// The viscosities that the scheme names or allows, each with the scheme that has it.
fn viscosities(scheme: &Scheme) -> Vec<(String, Scheme)> {
    let of = |kind: &str| Some((kind.to_owned(), scheme.with_viscosity(kind)?));
    match scheme.viscosity() {
        Some(kind) => of(&kind).into_iter().collect(),
        None => VISCOSITIES[1..]
            .iter()
            .filter_map(|kind| of(kind))
            .collect(),
    }
}

/// Prints the table of viscosities and angles.
pub fn of(scheme: &Scheme) -> Vec<Row> {
    println!(
        "| viscosity | degrees | width of the shock | entropy jump by the exact one | viscous force across by along | noise along | across |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    let turned = viscosities(scheme).into_iter().map(|(name, scheme)| {
        let seen = TILTS.map(|tilt| {
            let seen = Tube::new(tilt, CELLS).seen(&scheme);
            println!(
                "| {name} | {:.1} | {:.2} | {:.3} | {:.4} | {:.4} | {:.4} |",
                tilt.degrees(),
                seen.width,
                seen.jump,
                seen.across,
                seen.noise_along,
                seen.noise_across
            );
            seen
        });
        Turned { name, seen }
    });
    turned.flat_map(|turned| turned.rows()).collect()
}

#[cfg(test)]
mod tests;
