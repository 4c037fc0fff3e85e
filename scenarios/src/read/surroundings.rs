//! The surroundings of a scene: an analytic gas disk, relativity, the star's oblateness.

use nbody::points::Vec3;

use super::Facts;
use super::bodies::{LAWS, drag_law};
use crate::reader::{Range, Section};
use crate::scene::{GasDisk, Oblateness, Surroundings};
use crate::units::{Kind, System};

/// Speed of light, cm/s (SI).
const LIGHT: f64 = 2.997_924_58e10;

pub fn surroundings(root: &Section<'_>, facts: &Facts) -> Surroundings {
    let section = root.section("surroundings");
    if !section.present {
        return Surroundings::default();
    }
    if !facts.has_star {
        section.wrong("", "needs a [star], which they surround");
    }
    if facts.dimensions == 2 {
        section.wrong("", "needs three dimensions, since it acts on bodies");
    }
    let surroundings = Surroundings {
        speed_of_light: relativity(&section),
        oblateness: oblateness(&section),
        disk: disk(&section, facts),
    };
    section.close();
    surroundings
}

/// The speed of light if the scene asks for relativity.
fn relativity(section: &Section<'_>) -> Option<f64> {
    let on = section.flag("relativity").unwrap_or(false);
    let given = section.quantity("speed_of_light", Kind::VELOCITY, Range::POSITIVE);
    let units = section.units();
    if !on {
        section.misplaced(&["speed_of_light"], "belongs to relativity = true");
        return None;
    }
    if units.system == System::Dimensionless {
        let what = "in code units, since units.system = \"dimensionless\"";
        return Some(section.required("speed_of_light", given, what, f64::NAN));
    }
    section.misplaced(
        &["speed_of_light"],
        "may be set in dimensionless scenes only",
    );
    Some(LIGHT / units.cgs(Kind::VELOCITY.dimension))
}

fn oblateness(surroundings: &Section<'_>) -> Option<Oblateness> {
    let section = surroundings.section("oblateness");
    if !section.present {
        return None;
    }
    let j2 = section.number("j2", Range::ANY);
    let radius = section.quantity("equatorial_radius", Kind::LENGTH, Range::POSITIVE);
    let pole = section.vector("pole", Kind::NUMBER).unwrap_or_else(Vec3::z);
    if pole.norm() == 0.0 {
        section.wrong("pole", "must have a direction");
    }
    let what = "a length such as \"1 Rsun\"";
    let oblateness = Oblateness {
        j2: section.required("j2", j2, "a number such as 2e-7", f64::NAN),
        equatorial_radius: section.required("equatorial_radius", radius, what, f64::NAN),
        pole: unit(pole),
    };
    section.close();
    Some(oblateness)
}

/// A unit vector keeps its bits, so that a scene reads back to the same one.
fn unit(pole: Vec3) -> Vec3 {
    if (pole.norm_squared() - 1.0).abs() < 4.0 * f64::EPSILON {
        pole
    } else {
        pole.normalize()
    }
}

const PART: Range = Range {
    test: |x| (0.0..1.0).contains(&x),
    text: "at least 0 and less than 1",
};

fn disk(surroundings: &Section<'_>, facts: &Facts) -> Option<GasDisk> {
    let section = surroundings.section("disk");
    if !section.present {
        return None;
    }
    if facts.has_gas {
        section.wrong(
            "",
            "cannot stand beside [gas]: the gas is either particles or a formula",
        );
    }
    let length = |key| section.quantity(key, Kind::LENGTH, Range::POSITIVE);
    let sigma = section.quantity("surface_density", Kind::SURFACE_DENSITY, Range::POSITIVE);
    let slope = section.number("surface_density_slope", Range::ANY);
    let (reference, inner, outer) = (
        length("reference_radius"),
        length("inner_radius"),
        length("outer_radius"),
    );
    let aspect = section.number("aspect_ratio", Range::POSITIVE);
    let headwind = section.number("headwind", PART);
    let weight = section.number("mean_molecular_weight", Range::POSITIVE);
    let what = "a length such as \"1 au\"";
    let law = section.choice("drag", &LAWS, &[]).unwrap_or(0);
    let disk = GasDisk {
        surface_density: section.required(
            "surface_density",
            sigma,
            "at reference_radius, such as \"1700 g/cm^2\"",
            f64::NAN,
        ),
        slope: slope.unwrap_or(-1.5),
        reference_radius: reference.unwrap_or_else(|| one_au(&section)),
        aspect_ratio: section.required("aspect_ratio", aspect, "such as 0.033", f64::NAN),
        flaring: flaring(&section),
        inner_radius: section.required("inner_radius", inner, what, f64::NAN),
        outer_radius: section.required("outer_radius", outer, what, f64::NAN),
        headwind,
        mean_molecular_weight: weight.unwrap_or(2.34),
        drag: drag_law(&section, "drag", law),
        migration: section.flag("migration").unwrap_or(false),
    };
    section.close();
    Some(disk)
}

/// 1 au; 1 in dimensionless scenes.
fn one_au(section: &Section<'_>) -> f64 {
    section.units().value("1 au", Kind::LENGTH).unwrap_or(1.0)
}

/// Exponent of H/r, given or by the temperature's: H/r ~ c/v_K ~ r^((1 + q)/2).
fn flaring(section: &Section<'_>) -> f64 {
    let flaring = section.number("flaring", Range::ANY);
    let slope = section.number("temperature_slope", Range::ANY);
    section.exclusive("flaring", "temperature_slope");
    match (flaring, slope) {
        (Some(flaring), _) => flaring,
        (None, Some(slope)) => 0.5 * (1.0 + slope),
        (None, None) => 0.25,
    }
}
