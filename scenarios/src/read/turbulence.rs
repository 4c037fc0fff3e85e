//! The turbulence that stirs dust.

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::DustDrag;

const ALPHA: Range = Range {
    test: |x| (0.0..=1.0).contains(&x),
    text: "from 0 to 1",
};

/// alpha of the stirring; zero without.
pub fn turbulence(dust: &Section<'_>, law: DustDrag, facts: &Facts) -> f64 {
    let section = dust.section("turbulence");
    if !section.present {
        return 0.0;
    }
    let alpha = section.number("alpha", ALPHA);
    let alpha = section.required("alpha", alpha, "such as 1e-3", f64::NAN);
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
    alpha
}
