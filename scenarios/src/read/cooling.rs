//! The cooling of a scene's gas.

use super::Facts;
use super::eos::reference_radius;
use crate::reader::{Range, Section};
use crate::scene::{Cooling, CoolingTime, Eos, Temperature};
use crate::units::Kind;

const NONE: usize = 0;
const BETA: usize = 1;
const RELAXATION: usize = 2;

pub fn cooling(gas: &Section<'_>, facts: &Facts, eos: &Eos) -> Cooling {
    let section = gas.section("cooling");
    let kinds = [("none", NONE), ("beta", BETA), ("relaxation", RELAXATION)];
    let kind = section.choice("kind", &kinds, &[]);
    let keys = [
        "beta",
        "time",
        "aspect_ratio",
        "exponent",
        "reference_radius",
    ];
    let cooling = match kind {
        None if section.has("kind") => {
            section.pass_over(&keys);
            Cooling::None
        }
        Some(BETA) => {
            section.misplaced(&["time"], "belongs to kind = \"relaxation\"");
            beta(&section, facts)
        }
        Some(RELAXATION) => relaxation(&section, facts),
        _ => {
            section.misplaced(&keys, "belongs to kind = \"beta\" or \"relaxation\"");
            Cooling::None
        }
    };
    if cooling != Cooling::None {
        if !facts.has_star {
            section.wrong("kind", "needs a [star], about which times and places are");
        }
        match eos {
            Eos::Ideal { .. } => {}
            _ if eos.is_free() => section.wrong("kind", "needs gas.eos.kind = \"ideal\""),
            _ => section.wrong(
                "kind",
                "has no effect on gas whose temperature gas.eos sets; give gas.eos.kind = \"ideal\"",
            ),
        }
    }
    section.close();
    cooling
}

fn beta(section: &Section<'_>, facts: &Facts) -> Cooling {
    let beta = section.number("beta", Range::POSITIVE);
    let beta = section.required(
        "beta",
        beta,
        "the cooling time in 1/Omega, such as 10",
        f64::NAN,
    );
    let floor = section
        .has("aspect_ratio")
        .then(|| temperature(section, facts));
    if floor.is_none() {
        section.misplaced(
            &["exponent", "reference_radius"],
            "belongs to a floor, which aspect_ratio sets",
        );
    }
    Cooling::Beta { beta, floor }
}

fn relaxation(section: &Section<'_>, facts: &Facts) -> Cooling {
    let beta = section.number("beta", Range::POSITIVE);
    let time = section.quantity("time", Kind::TIME, Range::POSITIVE);
    section.exclusive("beta", "time");
    if !section.has("beta") && !section.has("time") {
        section.wrong("", "needs beta, in 1/Omega, or time");
    }
    Cooling::Relaxation {
        time: match time {
            Some(time) => CoolingTime::Time(time),
            None => CoolingTime::Orbital(beta.unwrap_or(f64::NAN)),
        },
        towards: temperature(section, facts),
    }
}

fn temperature(section: &Section<'_>, facts: &Facts) -> Temperature {
    let ratio = section.number("aspect_ratio", Range::POSITIVE);
    let aspect_ratio = section.required("aspect_ratio", ratio, "such as 0.05", f64::NAN);
    let reference_radius = reference_radius(section);
    Temperature {
        aspect_ratio,
        sound_speed: aspect_ratio * (facts.gravity * facts.star_mass / reference_radius).sqrt(),
        exponent: section.number("exponent", Range::ANY).unwrap_or(0.25),
        reference_radius,
    }
}
