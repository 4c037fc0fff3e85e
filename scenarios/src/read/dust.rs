//! The dust of a scene: its disk or blocks, its grains and their drag.

use super::Facts;
use super::composition::{materials, of_grains};
use super::gas::{block, disk_particles, softening};
use super::growth::growth;
use super::turbulence::turbulence;
use crate::reader::{Range, Section};
use crate::scene::{
    Composition, Dust, DustAmount, DustBlock, DustDrag, Gas, Sizes, Softening, Surroundings,
};
use crate::units::{Kind, System};

pub fn dust(
    root: &Section<'_>,
    facts: &Facts,
    (gas, surroundings): (Option<&Gas>, &Surroundings),
) -> Option<Dust> {
    let section = root.section("dust");
    if !section.present {
        return None;
    }
    let drag = drag(&section, facts);
    let blocks: Vec<DustBlock> = section
        .sections("block")
        .into_iter()
        .map(|entry| dust_block(entry, facts, drag))
        .collect();
    let from_disk = section.has("particles") && (facts.has_disk || facts.has_formula);
    if !section.has("particles") && blocks.is_empty() && !facts.has_file {
        section.wrong("", "needs particles, [[dust.block]] or an initial.file");
    }
    let particles = disk_particles(&section, "gas.disk", from_disk);
    let default = if facts.has_gas {
        Softening::SmoothingLength
    } else {
        Softening::Fixed(0.0)
    };
    let disk = gas_radii(gas, surroundings).filter(|_| from_disk);
    let (inner_radius, outer_radius) = radii(&section, disk);
    let stirred = turbulence(&section, drag, facts);
    let composition = of_grains(&section, facts);
    let dust = Dust {
        particles,
        softening: softening(&section, default),
        amount: amount(&section, from_disk),
        sizes: sizes(&section),
        material_density: material_density(&section, composition),
        composition,
        scale_height: scale_height(&section, from_disk),
        inner_radius,
        outer_radius,
        blocks,
        turbulence: stirred,
        drag,
        growth: growth(&section, facts, stirred),
    };
    let asks = from_disk || dust.blocks.iter().any(|block| block.size.is_none());
    let asks = asks && dust.growth.is_none() && !facts.has_file;
    if dust.drag.is_physical() && asks && !section.has("size") {
        let sentence = format!(
            "needs size, such as \"1 mm\", since the law of drag is \"{}\"",
            name(dust.drag)
        );
        section.wrong("size", &sentence);
    }
    section.close();
    Some(dust)
}

const ONLY_DISK: &str =
    "belongs to a dust disk: give dust.particles beside a [gas.disk] or [surroundings.disk]";

fn amount(section: &Section<'_>, from_disk: bool) -> Option<DustAmount> {
    let ratio = section.number("dust_to_gas", Range::POSITIVE);
    let mass = section.quantity("mass", Kind::MASS, Range::POSITIVE);
    if !from_disk {
        section.misplaced(&["dust_to_gas", "mass"], ONLY_DISK);
        return None;
    }
    section.exclusive("dust_to_gas", "mass");
    Some(match mass {
        Some(mass) => DustAmount::Mass(mass),
        None => DustAmount::DustToGas(ratio.unwrap_or(0.01)),
    })
}

fn scale_height(section: &Section<'_>, from_disk: bool) -> f64 {
    let factor = section.number("scale_height", Range::NOT_NEGATIVE);
    if !from_disk {
        section.misplaced(&["scale_height"], ONLY_DISK);
    }
    factor.unwrap_or(1.0)
}

/// Inner and outer radius of the gas disk, of particles or a formula.
fn gas_radii(gas: Option<&Gas>, surroundings: &Surroundings) -> Option<(f64, f64)> {
    let particles = gas.and_then(|gas| gas.disk);
    let particles = particles.map(|disk| (disk.inner_radius, disk.outer_radius));
    let formula = surroundings
        .disk
        .map(|disk| (disk.inner_radius, disk.outer_radius));
    particles.or(formula)
}

fn radii(section: &Section<'_>, disk: Option<(f64, f64)>) -> (f64, f64) {
    let inner = section.quantity("inner_radius", Kind::LENGTH, Range::POSITIVE);
    let outer = section.quantity("outer_radius", Kind::LENGTH, Range::POSITIVE);
    let Some((first, last)) = disk else {
        section.misplaced(&["inner_radius", "outer_radius"], ONLY_DISK);
        return (0.0, 0.0);
    };
    (inner.unwrap_or(first), outer.unwrap_or(last))
}

fn sizes(section: &Section<'_>) -> Option<Sizes> {
    if !section.is_table("size") {
        let radius = section.quantity("size", Kind::LENGTH, Range::POSITIVE);
        return radius.map(Sizes::One);
    }
    let table = section.section("size");
    let min = table.quantity("min", Kind::LENGTH, Range::POSITIVE);
    let max = table.quantity("max", Kind::LENGTH, Range::POSITIVE);
    let what = "a length such as \"1 um\"";
    let sizes = Sizes::Range {
        min: table.required("min", min, what, f64::NAN),
        max: table.required("max", max, what, f64::NAN),
        slope: table.number("slope", Range::ANY).unwrap_or(-3.5),
    };
    table.close();
    Some(sizes)
}

/// That of the composition; without one, by default 1 g/cm^3, or 1 in a dimensionless scene.
fn material_density(section: &Section<'_>, composition: Option<Composition>) -> f64 {
    let found = section.quantity("material_density", Kind::DENSITY, Range::POSITIVE);
    let units = section.units();
    if let Some(composition) = composition {
        return materials(&units).density(composition.fractions.into());
    }
    found.unwrap_or_else(|| match units.system {
        System::Dimensionless => 1.0,
        _ => 1.0 / units.cgs(Kind::DENSITY.dimension),
    })
}

/// A block, and what its grains have of their own.
fn dust_block(section: Section<'_>, facts: &Facts, drag: DustDrag) -> DustBlock {
    let block = block(&section, facts);
    let size = section.quantity("size", Kind::LENGTH, Range::POSITIVE);
    let material_density = section.quantity("material_density", Kind::DENSITY, Range::POSITIVE);
    let time = section.quantity("stopping_time", Kind::TIME, Range::POSITIVE);
    let stokes = section.number("stokes_number", Range::POSITIVE);
    let is_time = matches!(drag, DustDrag::ConstantStoppingTime(_));
    let is_stokes = matches!(drag, DustDrag::ConstantStokesNumber(_));
    for (key, law, fits) in [
        ("stopping_time", "constant-stopping-time", is_time),
        ("stokes_number", "constant-stokes-number", is_stokes),
    ] {
        if !fits {
            section.misplaced(&[key], &format!("belongs to dust.drag.law = \"{law}\""));
        }
    }
    section.close();
    DustBlock {
        block,
        size,
        material_density,
        stopping: if is_time { time } else { stokes },
    }
}

/// The laws of drag, by the words that scenes know them by.
const LAWS: [&str; 8] = [
    "none",
    "epstein",
    "stokes",
    "auto",
    "adachi",
    "constant-stopping-time",
    "constant-stokes-number",
    "quadratic",
];

/// The word that scenes know a law by.
pub fn name(law: DustDrag) -> &'static str {
    LAWS[match law {
        DustDrag::None => 0,
        DustDrag::Epstein => 1,
        DustDrag::Stokes => 2,
        DustDrag::Auto => 3,
        DustDrag::Adachi => 4,
        DustDrag::ConstantStoppingTime(_) => 5,
        DustDrag::ConstantStokesNumber(_) => 6,
        DustDrag::Quadratic(_) => 7,
    }]
}

fn drag(dust: &Section<'_>, facts: &Facts) -> DustDrag {
    let section = dust.section("drag");
    let laws: Vec<(&str, usize)> = LAWS.into_iter().zip(0..).collect();
    let law = section.choice("law", &laws, &[]);
    let in_gas = facts.has_gas || facts.has_formula;
    let law = law.unwrap_or(usize::from(in_gas));
    if law != 0 && !in_gas {
        section.wrong(
            "law",
            "needs [gas] to rub against, or a [surroundings.disk]; without gas allowed is \"none\"",
        );
    }
    let drag = numbered(&section, law);
    if law == 6 && !facts.has_orbits {
        section.wrong("law", "needs a [star], which sets the orbital frequency");
    }
    section.close();
    drag
}

/// A law by its place in the list, with the number that it needs.
fn numbered(section: &Section<'_>, law: usize) -> DustDrag {
    let time = section.quantity("stopping_time", Kind::TIME, Range::POSITIVE);
    let stokes = section.number("stokes_number", Range::POSITIVE);
    let coefficient = section.quantity("coefficient", Kind::PER_LENGTH, Range::POSITIVE);
    let owners = [
        (5, "stopping_time"),
        (6, "stokes_number"),
        (7, "coefficient"),
    ];
    for (owner, key) in owners.into_iter().filter(|(owner, _)| *owner != law) {
        section.misplaced(&[key], &format!("belongs to law = \"{}\"", LAWS[owner]));
    }
    let needed = |key, value, example| section.required(key, value, example, f64::NAN);
    match law {
        0 => DustDrag::None,
        1 => DustDrag::Epstein,
        2 => DustDrag::Stokes,
        3 => DustDrag::Auto,
        4 => DustDrag::Adachi,
        5 => {
            DustDrag::ConstantStoppingTime(needed("stopping_time", time, "a time such as \"1 yr\""))
        }
        6 => DustDrag::ConstantStokesNumber(needed("stokes_number", stokes, "such as 0.1")),
        _ => DustDrag::Quadratic(needed(
            "coefficient",
            coefficient,
            "an inverse length such as \"1e-9 1/au\"",
        )),
    }
}
