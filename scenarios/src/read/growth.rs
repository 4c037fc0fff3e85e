//! Growth of a scene's grains.

use nbody::points::Dimension;

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::{Collisional, ExactKernel, GrainMotion, Growth, Turbulence};
use crate::units::{Kind, System};

const ENERGY: Kind = Kind::of(Dimension::new(2, 1, -2, 0));

/// Names of the kernels; none is the physical one.
pub const KERNELS: [(&str, Option<ExactKernel>); 4] = [
    ("physical", None),
    ("constant", Some(ExactKernel::Constant)),
    ("sum", Some(ExactKernel::Sum)),
    ("product", Some(ExactKernel::Product)),
];

const PHYSICAL: [&str; 17] = [
    "brownian",
    "alpha",
    "reynolds",
    "motion",
    "headwind",
    "bouncing_speed",
    "fragmentation_speed",
    "transition",
    "speeds",
    "fragment_slope",
    "monomer_radius",
    "erosion_ratio",
    "erosion",
    "transfer_ratio",
    "transfer",
    "porosity",
    "rolling_energy",
];

const RATIO: Range = Range {
    test: |x| x >= 1.0,
    text: "1 or greater",
};
const SHARE: Range = Range {
    test: |x| (0.0..=1.0).contains(&x),
    text: "from 0 to 1",
};

pub fn growth(dust: &Section<'_>, facts: &Facts, stirred: Turbulence) -> Option<Growth> {
    let section = dust.section("growth");
    if !section.present {
        return None;
    }
    let kernel = section.choice("kernel", &KERNELS, &[]);
    let refused = kernel.is_none() && section.has("kernel");
    let growth = match kernel.flatten() {
        _ if refused => {
            section.pass_over(&PHYSICAL);
            section.pass_over(&["rate"]);
            None
        }
        Some(kernel) => {
            let belongs = "belongs to kernel = \"physical\"";
            section.misplaced(&PHYSICAL, belongs);
            let rate = section.number("rate", Range::POSITIVE);
            let what = "the rate of collisions in code units, such as 1.0";
            Some(Growth::Exact {
                kernel,
                rate: section.required("rate", rate, what, f64::NAN),
            })
        }
        None => {
            let belongs = "belongs to kernel = \"constant\", \"sum\" or \"product\"";
            section.misplaced(&["rate"], belongs);
            Some(Growth::Physical(collisional(&section, facts, stirred)))
        }
    };
    if !dust.has("size") && !facts.has_file {
        dust.wrong(
            "size",
            "needs size, such as \"1 um\", from which grains grow",
        );
    }
    section.close();
    growth
}

fn collisional(section: &Section<'_>, facts: &Facts, stirred: Turbulence) -> Collisional {
    if !(facts.has_gas || facts.has_formula) {
        section.wrong("", "needs [gas] or a [surroundings.disk], in which grains move; without gas allowed are the kernels \"constant\", \"sum\" and \"product\"");
    }
    if facts.dimensions == 2 {
        section.wrong(
            "",
            "needs three dimensions: in two grains have no number density",
        );
    }
    let physical = section.units().system != System::Dimensionless;
    let brownian = section.flag("brownian");
    if brownian == Some(true) && !physical {
        let sentence = "needs molecules, and so physical units";
        section.wrong("brownian", sentence);
    }
    let speed = |key| section.quantity(key, Kind::VELOCITY, Range::POSITIVE);
    let (bouncing, breaking) = (speed("bouncing_speed"), speed("fragmentation_speed"));
    if bouncing.zip(breaking).is_some_and(|(a, b)| a > b) {
        section.wrong("bouncing_speed", "must be at most fragmentation_speed");
    }
    let (alpha, reynolds) = turbulence(section, facts, (stirred, physical));
    let fragments = Fragments::new(section, breaking.is_some());
    let rolling = section.quantity("rolling_energy", ENERGY, Range::POSITIVE);
    let porous = section.flag("porosity").unwrap_or(false);
    if !porous {
        section.misplaced(&["rolling_energy"], "belongs to porosity = true");
    }
    let monomer_radius = monomer_radius(section, breaking.is_some() || porous, physical);
    let rolling_energy = porous.then(|| {
        let ice = physical.then(|| ice_rolling_energy(section, monomer_radius));
        let what = "the energy that rolls a monomer over another";
        section.required("rolling_energy", rolling.or(ice), what, f64::NAN)
    });
    let passed = bouncing.is_some() || breaking.is_some();
    let spreads = [("mean", false), ("maxwellian", true)];
    let spread = section.choice("speeds", &spreads, &[]);
    let transition = section.number("transition", SHARE);
    if !passed {
        let belongs = "belongs to bouncing_speed or fragmentation_speed";
        section.misplaced(&["speeds", "transition"], belongs);
    }
    Collisional {
        brownian: brownian.unwrap_or(physical),
        alpha,
        reynolds,
        motion: motion(section),
        bouncing_speed: bouncing.unwrap_or(f64::INFINITY),
        fragmentation_speed: breaking.unwrap_or(f64::INFINITY),
        transition: transition.unwrap_or(if passed { 0.2 } else { 0.0 }),
        spread: spread.unwrap_or(false),
        fragment_slope: fragments.slope,
        monomer_radius,
        erosion_ratio: fragments.erosion_ratio,
        erosion: fragments.erosion,
        transfer_ratio: fragments.transfer_ratio,
        transfer: fragments.transfer,
        rolling_energy,
    }
}

/// alpha, that of the turbulence that stirs unless given, and the Reynolds number, if it is given.
fn turbulence(
    section: &Section<'_>,
    facts: &Facts,
    (stirred, physical): (Turbulence, bool),
) -> (f64, Option<f64>) {
    let alpha = section.number("alpha", Range::NOT_NEGATIVE);
    let alpha = alpha.or(stirred.known()).unwrap_or_else(|| {
        let sentence = "needs a number of its own where dust.turbulence.alpha is \"measured\"";
        section.wrong("alpha", sentence);
        0.0
    });
    let reynolds = section.number("reynolds", RATIO);
    if alpha == 0.0 {
        section.misplaced(&["reynolds"], "belongs to turbulence of some alpha");
        return (0.0, None);
    }
    if !facts.has_orbits {
        section.wrong(
            "alpha",
            "needs an orbital frequency: a [star] or a shearing box",
        );
    }
    if reynolds.is_none() && !section.has("reynolds") && !physical {
        section.wrong(
            "alpha",
            "needs reynolds in a dimensionless scene, which has no molecules",
        );
    }
    (alpha, reynolds)
}

fn motion(section: &Section<'_>) -> GrainMotion {
    let kinds = [("none", 0), ("resolved", 1), ("steady", 2)];
    let kind = section.choice("motion", &kinds, &[]);
    if kind.is_none() && section.has("motion") {
        section.pass_over(&["headwind"]);
        return GrainMotion::None;
    }
    if kind != Some(2) {
        section.misplaced(&["headwind"], "belongs to motion = \"steady\"");
    }
    match kind {
        Some(0) => GrainMotion::None,
        Some(2) => {
            let speed = section.quantity("headwind", Kind::VELOCITY, Range::NOT_NEGATIVE);
            let what = "the speed of the gas past a body, such as \"30 m/s\"";
            GrainMotion::Steady {
                headwind: section.required("headwind", speed, what, f64::NAN),
            }
        }
        _ => GrainMotion::Resolved,
    }
}

/// Default: 0.1 um.
fn monomer_radius(section: &Section<'_>, needed: bool, physical: bool) -> f64 {
    let found = section.quantity("monomer_radius", Kind::LENGTH, Range::POSITIVE);
    if !needed {
        let belongs = "belongs to fragmentation_speed or porosity = true";
        section.misplaced(&["monomer_radius"], belongs);
        return 0.0;
    }
    let default = physical.then(|| 1e-5 / section.units().length);
    let what = "the radius of the smallest fragments";
    section.required("monomer_radius", found.or(default), what, f64::NAN)
}

/// Rolling energy of icy monomers: 6 pi^2 gamma r xi, with a surface energy gamma of 100 erg/cm^2 and xi = 8 Angstrom (Okuzumi et al. 2012).
fn ice_rolling_energy(section: &Section<'_>, radius: f64) -> f64 {
    let units = section.units();
    let erg = 6.0 * std::f64::consts::PI.powi(2) * 100.0 * (radius * units.length) * 8e-8;
    erg / units.cgs(ENERGY.dimension)
}

struct Fragments {
    slope: f64,
    erosion_ratio: f64,
    erosion: f64,
    transfer_ratio: f64,
    transfer: f64,
}

impl Fragments {
    fn new(section: &Section<'_>, breaking: bool) -> Self {
        let slope = section.number("fragment_slope", Range::ANY);
        let erosion_ratio = section.number("erosion_ratio", RATIO);
        let erosion = section.number("erosion", Range::NOT_NEGATIVE);
        let transfer_ratio = section.number("transfer_ratio", RATIO);
        let transfer = section.number("transfer", SHARE);
        if !breaking && !section.has("fragmentation_speed") {
            let keys = [
                "fragment_slope",
                "erosion_ratio",
                "erosion",
                "transfer_ratio",
                "transfer",
            ];
            section.misplaced(&keys, "belongs to fragmentation_speed");
        } else if section.has("transfer_ratio") != section.has("transfer") {
            let key = if section.has("transfer") {
                "transfer"
            } else {
                "transfer_ratio"
            };
            section.wrong(key, "transfer and transfer_ratio go together: how much of a projectile stays on a target so many times heavier");
        }
        Self {
            slope: slope.unwrap_or(11.0 / 6.0),
            erosion_ratio: erosion_ratio.unwrap_or(10.0),
            erosion: erosion.unwrap_or(1.0),
            transfer_ratio: transfer_ratio.unwrap_or(f64::INFINITY),
            transfer: transfer.unwrap_or(0.0),
        }
    }
}
