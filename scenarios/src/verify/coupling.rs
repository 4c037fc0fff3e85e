//! Problems of bodies among gas: what gas does to their orbits, by drag and by gravity.

mod decay;
mod friction;

use super::{Problem, own};

pub const PROBLEMS: &[Problem] = &[
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
];
