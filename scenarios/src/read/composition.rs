//! Compositions of bodies and grains: mass fractions of three materials.

use dust::Materials;
use dust::composition::DENSITIES;

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::Composition;
use crate::units::{Kind, System, Units};

/// The mass fractions of the table `composition`, under these keys; what is left out is not there.
pub fn fractions(section: &Section<'_>, keys: [&'static str; 3]) -> [f64; 3] {
    let part = Range {
        test: |part| (0.0..=1.0).contains(&part),
        text: "from 0 to 1",
    };
    let parts = keys.map(|key| section.number(key, part));
    let refused = keys
        .iter()
        .zip(parts)
        .any(|(key, part)| section.has(key) && part.is_none());
    let parts = parts.map(|part| part.unwrap_or(0.0));
    let sum: f64 = parts.iter().sum();
    if section.present && !refused && (sum - 1.0).abs() > 1e-9 {
        let [first, second, third] = keys;
        let sentence =
            format!("makes {sum} in sum; the mass fractions {first}, {second} and {third} make 1");
        let given = keys.into_iter().find(|key| section.has(key));
        section.wrong(given.unwrap_or(first), &sentence);
    }
    parts
}

/// Densities of ice, silicate and iron in code units.
pub fn materials(units: &Units) -> Materials {
    let unit = units.cgs(Kind::DENSITY.dimension);
    Materials(DENSITIES.map(|rho| rho / unit))
}

/// Composition of the dust's grains; `None` without one.
pub fn of_grains(dust: &Section<'_>, facts: &Facts) -> Option<Composition> {
    let section = dust.section("composition");
    if !section.present {
        return None;
    }
    let fractions = fractions(&section, ["ice", "silicate", "iron"]);
    let sublimation = section.flag("sublimation").unwrap_or(fractions[0] > 0.0);
    if dust.units().system == System::Dimensionless {
        section.wrong(
            "",
            "needs physical units, in which materials have their densities",
        );
    } else if sublimation {
        sublimates(&section, fractions, facts);
    }
    dust.misplaced(
        &["material_density"],
        "follows from dust.composition: give one of them",
    );
    section.close();
    Some(Composition {
        fractions,
        sublimation,
    })
}

/// What sublimation needs of the rest of a scene.
fn sublimates(section: &Section<'_>, [_, silicate, iron]: [f64; 3], facts: &Facts) {
    let instead = "; allowed without is sublimation = false";
    let needs = [
        (
            !facts.has_gas,
            "needs [gas] of particles, which carries the vapour",
        ),
        (
            facts.dimensions == 2,
            "needs three dimensions: in two vapour has no pressure",
        ),
        (
            silicate + iron == 0.0,
            "needs silicate or iron: grains of nothing but ice leave no core when it sublimates",
        ),
    ];
    if let Some((_, sentence)) = needs.iter().find(|(lacks, _)| *lacks) {
        section.wrong("", &format!("{sentence}{instead}"));
    }
}
