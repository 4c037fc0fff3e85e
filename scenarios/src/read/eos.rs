//! The equation of state of a scene's gas.

use std::sync::Arc;

use gas::eos::tillotson::MATERIALS;
use gas::{Barotropic, Stiffened, Table};

use super::{Facts, absolute};
use crate::reader::{Range, Section};
use crate::scene::Eos;
use crate::table;
use crate::units::{Kind, System};

/// The kinds, by their places in this list.
const KINDS: [(&str, usize); 7] = [
    ("ideal", IDEAL),
    ("isothermal", ISOTHERMAL),
    ("locally-isothermal", LOCALLY_ISOTHERMAL),
    ("barotropic", BAROTROPIC),
    ("stiffened", STIFFENED),
    ("tillotson", TILLOTSON),
    ("tabulated", TABULATED),
];
const IDEAL: usize = 0;
const ISOTHERMAL: usize = 1;
const LOCALLY_ISOTHERMAL: usize = 2;
const BAROTROPIC: usize = 3;
const STIFFENED: usize = 4;
const TILLOTSON: usize = 5;
const TABULATED: usize = 6;

/// Keys, the kinds that have them, and what is said of them beside others.
const KEYS: [(&str, &[usize], &str); 9] = [
    (
        "gamma",
        &[IDEAL, BAROTROPIC, STIFFENED],
        "belongs to kind = \"ideal\", \"barotropic\" or \"stiffened\"",
    ),
    (
        "sound_speed",
        &[ISOTHERMAL, BAROTROPIC],
        "belongs to kind = \"isothermal\" or \"barotropic\"",
    ),
    ("aspect_ratio", &[LOCALLY_ISOTHERMAL], LAID_OUT),
    ("exponent", &[LOCALLY_ISOTHERMAL], LAID_OUT),
    ("reference_radius", &[LOCALLY_ISOTHERMAL], LAID_OUT),
    (
        "critical_density",
        &[BAROTROPIC],
        "belongs to kind = \"barotropic\"",
    ),
    (
        "stiffening_pressure",
        &[STIFFENED],
        "belongs to kind = \"stiffened\"",
    ),
    ("material", &[TILLOTSON], "belongs to kind = \"tillotson\""),
    ("file", &[TABULATED], "belongs to kind = \"tabulated\""),
];
const LAID_OUT: &str = "belongs to kind = \"locally-isothermal\"";

/// The equation, and the mean molecular weight of what is a gas.
pub fn eos(gas: &Section<'_>, facts: &Facts) -> (Eos, Option<f64>) {
    let section = gas.section("eos");
    let kind = section.choice("kind", &KINDS, &[]);
    let refused = section.has("kind") && kind.is_none();
    let kind = kind.unwrap_or(IDEAL);
    if refused {
        // What these mean hangs on the kind.
        section.pass_over(&KEYS.map(|(key, ..)| key));
    } else {
        for (key, owners, sentence) in KEYS {
            if !owners.contains(&kind) {
                section.misplaced(&[key], sentence);
            }
        }
    }
    let weight = section.number("mean_molecular_weight", Range::POSITIVE);
    let liquid = [STIFFENED, TILLOTSON].contains(&kind);
    if liquid {
        let sentence = "belongs to gases; this kind has no molecules";
        section.misplaced(&["mean_molecular_weight"], sentence);
    }
    let eos = match kind {
        _ if refused => Eos::Ideal { gamma: f64::NAN },
        ISOTHERMAL => Eos::Isothermal {
            sound_speed: sound_speed(&section),
        },
        LOCALLY_ISOTHERMAL => locally_isothermal(&section, facts),
        BAROTROPIC => barotropic(&section, facts),
        STIFFENED => stiffened(&section, facts),
        TILLOTSON => tillotson(&section, facts),
        TABULATED => tabulated(&section, facts),
        _ => Eos::Ideal {
            gamma: gamma(&section, 5.0 / 3.0),
        },
    };
    section.close();
    (eos, (!liquid).then_some(weight.unwrap_or(2.34)))
}

fn gamma(section: &Section<'_>, default: f64) -> f64 {
    const GAMMA: Range = Range {
        test: |gamma| gamma > 1.0,
        text: "greater than 1; for gamma = 1 take kind = \"isothermal\"",
    };
    section.number("gamma", GAMMA).unwrap_or(default)
}

fn sound_speed(section: &Section<'_>) -> f64 {
    let speed = section.quantity("sound_speed", Kind::VELOCITY, Range::POSITIVE);
    let what = "a velocity such as \"1 km/s\"";
    section.required("sound_speed", speed, what, f64::NAN)
}

fn locally_isothermal(section: &Section<'_>, facts: &Facts) -> Eos {
    let ratio = section.number("aspect_ratio", Range::POSITIVE);
    let aspect_ratio = section.required("aspect_ratio", ratio, "such as 0.05", f64::NAN);
    let exponent = section.number("exponent", Range::ANY).unwrap_or(0.25);
    let reference_radius = reference_radius(section);
    if !facts.has_star {
        section.wrong(
            "kind",
            "needs a [star], about which the sound speed is laid out",
        );
    }
    Eos::LocallyIsothermal {
        aspect_ratio,
        sound_speed: aspect_ratio * (facts.gravity * facts.star_mass / reference_radius).sqrt(),
        exponent,
        reference_radius,
    }
}

/// Default: 1 au, or 1 in a dimensionless scene.
pub fn reference_radius(section: &Section<'_>) -> f64 {
    let found = section.quantity("reference_radius", Kind::LENGTH, Range::POSITIVE);
    let units = section.units();
    found.unwrap_or_else(|| units.value("1 au", Kind::LENGTH).unwrap_or(1.0))
}

fn barotropic(section: &Section<'_>, facts: &Facts) -> Eos {
    let kind = facts.density();
    let density = section.quantity("critical_density", kind, Range::POSITIVE);
    let what = "at which the gas becomes opaque, such as \"1e-13 g/cm^3\"";
    Eos::Barotropic(Barotropic {
        sound_speed: sound_speed(section),
        critical_density: section.required("critical_density", density, what, f64::NAN),
        gamma: gamma(section, 1.4),
    })
}

fn stiffened(section: &Section<'_>, facts: &Facts) -> Eos {
    let pressure = section.quantity("stiffening_pressure", facts.pressure(), Range::NOT_NEGATIVE);
    let what = "the tension at which the matter breaks, such as \"6e9 g/cm/s^2\"";
    Eos::Stiffened(Stiffened {
        gamma: gamma(section, 4.4),
        pressure: section.required("stiffening_pressure", pressure, what, f64::NAN),
    })
}

fn tillotson(section: &Section<'_>, facts: &Facts) -> Eos {
    let names = MATERIALS.map(|(name, _)| (name, name));
    let material = section.choice("material", &names, &[]);
    let material = section.required("material", material, "such as \"basalt\"", names[0].0);
    if section.units().system == System::Dimensionless {
        section.wrong(
            "kind",
            "needs physical units, in which materials are known; give units.system",
        );
    }
    if facts.dimensions == 2 {
        section.wrong("kind", "needs three dimensions, as materials have");
    }
    Eos::Tillotson { material }
}

fn tabulated(section: &Section<'_>, facts: &Facts) -> Eos {
    let name = section.text("file");
    let name = section.required("file", name, "the name of a table", "");
    let file = absolute(&facts.folder, name);
    let kinds = [
        facts.density(),
        Kind::SPECIFIC_ENERGY,
        facts.pressure(),
        Kind::VELOCITY,
    ];
    let scales = kinds.map(|kind| section.units().cgs(kind.dimension));
    let table = match name {
        // Missing, which has been said.
        "" => Ok(Table::default()),
        _ => table::read(&file).and_then(|grid| grid.table(scales)),
    };
    let table = table.unwrap_or_else(|sentence| {
        section.wrong("file", &sentence);
        Table::default()
    });
    Eos::Tabulated {
        file,
        table: Arc::new(table),
    }
}
