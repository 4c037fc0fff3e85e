//! The dust of a scene: its disk or blocks, its grains and their drag.

use super::Facts;
use super::gas::{block, disk_particles, softening};
use crate::reader::{Range, Section};
use crate::scene::{Block, Dust, DustAmount, DustDrag, Gas, Sizes, Softening};
use crate::units::{Kind, System};

pub fn dust(root: &Section<'_>, facts: &Facts, gas: Option<&Gas>) -> Option<Dust> {
    let section = root.section("dust");
    if !section.present {
        return None;
    }
    let blocks: Vec<Block> = section
        .sections("block")
        .into_iter()
        .map(|entry| block(entry, facts))
        .collect();
    let from_disk = section.has("particles") && facts.has_disk;
    if !section.has("particles") && blocks.is_empty() && !facts.has_file {
        section.wrong("", "needs particles, [[dust.block]] or an initial.file");
    }
    let particles = disk_particles(&section, "gas.disk", from_disk);
    let default = if facts.has_gas {
        Softening::SmoothingLength
    } else {
        Softening::Fixed(0.0)
    };
    let (inner_radius, outer_radius) = radii(&section, gas.filter(|_| from_disk));
    let dust = Dust {
        particles,
        softening: softening(&section, default),
        amount: amount(&section, from_disk),
        sizes: sizes(&section),
        material_density: material_density(&section),
        scale_height: scale_height(&section, from_disk),
        inner_radius,
        outer_radius,
        blocks,
        drag: drag(&section, facts),
        growth: super::growth::growth(&section, facts),
    };
    if matches!(dust.drag, DustDrag::Epstein)
        && dust.growth.is_none()
        && !section.has("size")
        && !facts.has_file
    {
        section.wrong(
            "size",
            "needs size, such as \"1 mm\", since the law of drag is \"epstein\"",
        );
    }
    section.later(&["turbulence"]);
    section.close();
    Some(dust)
}

const ONLY_DISK: &str = "belongs to a dust disk: give dust.particles beside a [gas.disk]";

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

fn radii(section: &Section<'_>, gas: Option<&Gas>) -> (f64, f64) {
    let inner = section.quantity("inner_radius", Kind::LENGTH, Range::POSITIVE);
    let outer = section.quantity("outer_radius", Kind::LENGTH, Range::POSITIVE);
    let Some(disk) = gas.and_then(|gas| gas.disk) else {
        section.misplaced(&["inner_radius", "outer_radius"], ONLY_DISK);
        return (0.0, 0.0);
    };
    (
        inner.unwrap_or(disk.inner_radius),
        outer.unwrap_or(disk.outer_radius),
    )
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

/// Default: 1 g/cm^3, or 1 in a dimensionless scene.
fn material_density(section: &Section<'_>) -> f64 {
    let found = section.quantity("material_density", Kind::DENSITY, Range::POSITIVE);
    let units = section.units();
    found.unwrap_or_else(|| match units.system {
        System::Dimensionless => 1.0,
        _ => 1.0 / units.cgs(Kind::DENSITY.dimension),
    })
}

fn drag(dust: &Section<'_>, facts: &Facts) -> DustDrag {
    let section = dust.section("drag");
    let laws = [
        ("none", 0),
        ("epstein", 1),
        ("constant-stopping-time", 2),
        ("constant-stokes-number", 3),
    ];
    let law = section.choice("law", &laws, &["stokes", "auto"]);
    let law = law.unwrap_or(if facts.has_gas { 1 } else { 0 });
    if law != 0 && !facts.has_gas {
        section.wrong(
            "law",
            "needs [gas] to rub against; without gas allowed is \"none\"",
        );
    }
    let time = section.quantity("stopping_time", Kind::TIME, Range::POSITIVE);
    let stokes = section.number("stokes_number", Range::POSITIVE);
    if law != 2 {
        section.misplaced(
            &["stopping_time"],
            "belongs to law = \"constant-stopping-time\"",
        );
    }
    if law != 3 {
        section.misplaced(
            &["stokes_number"],
            "belongs to law = \"constant-stokes-number\"",
        );
    } else if !facts.has_orbits {
        section.wrong("law", "needs a [star], which sets the orbital frequency");
    }
    let drag = match law {
        0 => DustDrag::None,
        1 => DustDrag::Epstein,
        2 => DustDrag::ConstantStoppingTime(section.required(
            "stopping_time",
            time,
            "a time such as \"1 yr\"",
            f64::NAN,
        )),
        _ => DustDrag::ConstantStokesNumber(section.required(
            "stokes_number",
            stokes,
            "such as 0.1",
            f64::NAN,
        )),
    };
    section.close();
    drag
}
