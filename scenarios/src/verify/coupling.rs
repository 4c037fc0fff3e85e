//! Problems of bodies among gas: what gas does to their orbits, by drag and by gravity.

mod decay;
mod friction;
mod three;
mod torque;

use super::{Problem, own};

pub const PROBLEMS: &[Problem] = &[
    own(
        "coupling-box",
        "gas, dust and bodies that exchange momentum, stopping times from 1e-12 to 1e12 (Benitez-Llambay et al. 2019)",
        three::rows,
    ),
    own(
        "coupling-decay",
        "orbits of planetesimals among gas particles, against the same disk as a formula (Adachi et al. 1976); about 1 minute",
        decay::rows,
    ),
    own(
        "coupling-friction",
        "dynamical friction of a planet in uniform gas, at four Mach numbers (Ostriker 1999); about 7 minutes",
        friction::rows,
    ),
    own(
        "coupling-torque",
        "type-I torque on a planet of low mass in a disk in the plane (Tanaka et al. 2002; Paardekooper et al. 2010); about 5 minutes",
        torque::rows,
    ),
];
