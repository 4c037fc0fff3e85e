//! The turbulence that stirs dust.

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::{DustDrag, Turbulence};

const ALPHA: Range = Range {
    test: |x| (0.0..=1.0).contains(&x),
    text: "from 0 to 1",
};

/// What stirs the dust.
pub fn turbulence(dust: &Section<'_>, law: DustDrag, facts: &Facts) -> Turbulence {
    let section = dust.section("turbulence");
    if !section.present {
        return Turbulence::None;
    }
    let turbulence = if section.is_text("alpha", "measured") {
        section.text("alpha");
        measured(&section, facts)
    } else {
        given(&section)
    };
    if law == DustDrag::None {
        section.wrong(
            "",
            "needs dust.drag.law other than \"none\": gas carries dust by its drag",
        );
    } else if !facts.has_orbits {
        section.wrong(
            "",
            "needs a [star] or a shearing box, which set the orbital frequency",
        );
    }
    section.close();
    turbulence
}

fn given(section: &Section<'_>) -> Turbulence {
    let alpha = section.number("alpha", ALPHA);
    section.misplaced(&["floor"], "belongs to alpha = \"measured\"");
    let alpha = section.required("alpha", alpha, "such as 1e-3", 0.0);
    if alpha > 0.0 {
        Turbulence::Given(alpha)
    } else {
        Turbulence::None
    }
}

fn measured(section: &Section<'_>, facts: &Facts) -> Turbulence {
    if !facts.has_gas {
        section.wrong("alpha", "needs [gas] of particles: a formula has no stress");
    } else if facts.has_orbits && !facts.has_star {
        section.wrong(
            "alpha",
            "needs a [star], about which the gas is seen in rings",
        );
    }
    Turbulence::Measured {
        floor: section.number("floor", ALPHA).unwrap_or(0.0),
    }
}
