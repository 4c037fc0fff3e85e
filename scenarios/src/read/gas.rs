//! The gas of a scene: disk, blocks, equation of state, hydrodynamics, viscosity, conduction.

use gas::rearrangement::{Continuity, Order};
use nbody::points::Vec3;

use gas::{BackgroundPressure, KernelKind, Reconstruction};

use super::Facts;
use super::cooling::cooling;
use super::edge::edge;
use super::eos::{eos, reference_radius};
use crate::reader::{Range, Section};
use crate::scene::{
    Block, Disk, DiskAmount, Eos, Formulation, Gas, GasBlock, Gradient, Hydro, Lattice, Physical,
    Precision, Softening, Thermal, Viscosity,
};
use crate::units::Kind;

/// Particles that a population may have.
pub const MOST_PARTICLES: u64 = 1 << 31;

pub fn gas(root: &Section<'_>, facts: &Facts) -> Option<Gas> {
    let section = root.section("gas");
    if !section.present {
        return None;
    }
    let (eos, mean_molecular_weight) = eos(&section, facts);
    let disk = disk(&section, facts, &eos);
    let blocks: Vec<GasBlock> = section
        .sections("block")
        .into_iter()
        .map(|entry| gas_block(entry, facts, &eos))
        .collect();
    if disk.is_none() && blocks.is_empty() && !facts.has_file && !section.has("disk") {
        section.wrong("", "needs [gas.disk], [[gas.block]] or an initial.file");
    }
    let conduction = conduction(&section, &eos);
    let (viscosity, reconstruction, physical) = viscosity(&section, facts);
    let cooling = cooling(&section, facts, &eos);
    let gas = Gas {
        particles: disk_particles(&section, "gas.disk", disk.is_some() || section.has("disk")),
        softening: softening(&section, Softening::SmoothingLength),
        disk,
        blocks,
        eos,
        mean_molecular_weight,
        cooling,
        edge: edge(&section, facts, disk.as_ref()),
        hydro: hydro(&section, facts),
        viscosity,
        reconstruction,
        physical,
        conduction,
        rearrange: rearrangement(&section),
    };
    section.close();
    Some(gas)
}

/// `particles` of a disk generator.
pub fn disk_particles(section: &Section<'_>, disk: &str, has_disk: bool) -> usize {
    let particles = section.whole("particles", 1, MOST_PARTICLES);
    if has_disk {
        let what = format!("the particle number of [{disk}]");
        section.required("particles", particles, &what, 1) as usize
    } else {
        if particles.is_some() {
            section.wrong(
                "particles",
                &format!("is the particle number of [{disk}], which the scene does not have"),
            );
        }
        0
    }
}

pub fn softening(section: &Section<'_>, default: Softening) -> Softening {
    if section.is_text("softening", "smoothing-length") {
        section.text("softening");
        return Softening::SmoothingLength;
    }
    section
        .quantity("softening", Kind::LENGTH, Range::NOT_NEGATIVE)
        .map_or(default, Softening::Fixed)
}

fn disk(gas: &Section<'_>, facts: &Facts, eos: &Eos) -> Option<Disk> {
    let section = gas.section("disk");
    if !section.present {
        return None;
    }
    if !facts.has_star {
        section.wrong("", "needs a [star] to orbit");
    }
    let amount = disk_amount(&section);
    let reference_radius = reference_radius(&section);
    let (aspect_ratio, exponent) = disk_temperature(&section, facts, eos, reference_radius);
    let inner = section.quantity("inner_radius", Kind::LENGTH, Range::POSITIVE);
    let outer = section.quantity("outer_radius", Kind::LENGTH, Range::POSITIVE);
    let what = "a length such as \"5.2 au\"";
    let disk = Disk {
        amount,
        slope: section.number("slope", Range::ANY).unwrap_or(-1.0),
        reference_radius,
        aspect_ratio,
        exponent,
        inner_radius: section.required("inner_radius", inner, what, f64::NAN),
        outer_radius: section.required("outer_radius", outer, what, f64::NAN),
        taper: section.number("taper", Range::POSITIVE).unwrap_or(2.0),
    };
    section.close();
    Some(disk)
}

fn disk_amount(section: &Section<'_>) -> DiskAmount {
    let sigma = section.quantity("surface_density", Kind::SURFACE_DENSITY, Range::POSITIVE);
    let mass = section.quantity("mass", Kind::MASS, Range::POSITIVE);
    section.exclusive("surface_density", "mass");
    if !section.has("surface_density") && !section.has("mass") {
        section.wrong(
            "",
            "needs surface_density, such as \"1700 g/cm^2\", or mass",
        );
    }
    match mass {
        Some(mass) => DiskAmount::Mass(mass),
        None => DiskAmount::SurfaceDensity(sigma.unwrap_or(f64::NAN)),
    }
}

/// Aspect ratio at `radius` and exponent of the sound speed: the scene's, unless the equation of state has them.
fn disk_temperature(section: &Section<'_>, facts: &Facts, eos: &Eos, radius: f64) -> (f64, f64) {
    let circular = (facts.gravity * facts.star_mass / radius).sqrt();
    match *eos {
        Eos::Ideal { .. } => {
            let ratio = section.number("aspect_ratio", Range::POSITIVE);
            let exponent = section.number("exponent", Range::ANY);
            (
                section.required("aspect_ratio", ratio, "such as 0.05", f64::NAN),
                exponent.unwrap_or(0.25),
            )
        }
        Eos::Isothermal { sound_speed, .. } => {
            section.misplaced(
                &["aspect_ratio", "exponent"],
                "follows from gas.eos.sound_speed",
            );
            (sound_speed / circular, 0.0)
        }
        Eos::LocallyIsothermal {
            sound_speed,
            exponent,
            reference_radius,
            ..
        } => {
            section.misplaced(
                &["aspect_ratio", "exponent"],
                "stands in gas.eos, which is locally isothermal",
            );
            let local = sound_speed * (radius / reference_radius).powf(-exponent);
            (local / circular, exponent)
        }
        _ => {
            section.pass_over(&["aspect_ratio", "exponent"]);
            section.wrong(
                "",
                "needs gas.eos.kind = \"ideal\", \"isothermal\" or \"locally-isothermal\", of which its layers are made",
            );
            (f64::NAN, f64::NAN)
        }
    }
}

fn gas_block(section: Section<'_>, facts: &Facts, eos: &Eos) -> GasBlock {
    let pressure = section.quantity("pressure", facts.pressure(), Range::POSITIVE);
    let energy = section.quantity("internal_energy", Kind::SPECIFIC_ENERGY, least(eos));
    section.exclusive("pressure", "internal_energy");
    let thermal = if !eos.is_free() {
        let sentence = match eos {
            Eos::Barotropic(_) => "follows from gas.eos, which is barotropic",
            _ => "follows from gas.eos, which is isothermal",
        };
        section.misplaced(&["pressure", "internal_energy"], sentence);
        Thermal::Eos
    } else if let Some(energy) = energy {
        Thermal::InternalEnergy(energy)
    } else if matches!(eos, Eos::Tillotson { .. } | Eos::Tabulated { .. }) {
        section.misplaced(
            &["pressure"],
            "has no formula for its energy in this gas.eos; give internal_energy",
        );
        if !section.has("pressure") && !section.has("internal_energy") {
            section.wrong("", "needs internal_energy");
        }
        Thermal::InternalEnergy(f64::NAN)
    } else {
        if !section.has("pressure") && !section.has("internal_energy") {
            section.wrong("", "needs pressure or internal_energy");
        }
        Thermal::Pressure(pressure.unwrap_or(f64::NAN))
    };
    let block = block(&section, facts);
    section.close();
    GasBlock { block, thermal }
}

/// The internal energies that gas may begin with: none is in cold solids alone.
fn least(eos: &Eos) -> Range {
    match eos {
        Eos::Tillotson { .. } => Range::NOT_NEGATIVE,
        _ => Range::POSITIVE,
    }
}

/// The keys that blocks of gas and of dust share.
pub fn block(section: &Section<'_>, facts: &Facts) -> Block {
    let corner = "a corner of the box, [x, y, z]";
    let nowhere = Vec3::repeat(f64::NAN);
    let lo = section.vector("lo", Kind::LENGTH);
    let hi = section.vector("hi", Kind::LENGTH);
    let spacing = section.quantity("spacing", Kind::LENGTH, Range::POSITIVE);
    let density = section.quantity("density", facts.density(), Range::POSITIVE);
    let lattices = [
        ("cubic", Lattice::Cubic),
        ("bcc", Lattice::Bcc),
        ("random", Lattice::Random),
        ("glass", Lattice::Glass),
    ];
    let lattice = section.choice("lattice", &lattices, &[]);
    if facts.dimensions == 2 && lattice == Some(Lattice::Bcc) {
        section.wrong(
            "lattice",
            "is a lattice of three dimensions; allowed in two are \"cubic\", \"random\", \"glass\"",
        );
    }
    let velocity = section.vector("velocity", Kind::VELOCITY);
    Block {
        lo: section.required("lo", lo, corner, nowhere),
        hi: section.required("hi", hi, corner, nowhere),
        spacing: section.required(
            "spacing",
            spacing,
            "the distance between neighbours",
            f64::NAN,
        ),
        lattice: lattice.unwrap_or(Lattice::Cubic),
        density: section.required("density", density, facts.density().example(), f64::NAN),
        velocity: velocity.unwrap_or_else(Vec3::zeros),
    }
}

fn hydro(gas: &Section<'_>, facts: &Facts) -> Hydro {
    const NEIGHBOURS: Range = Range {
        test: |n| (6.0..=1000.0).contains(&n),
        text: "from 6 to 1000",
    };
    const EXPONENT: Range = Range {
        test: |zeta| (0.05..=1.0).contains(&zeta),
        text: "from 0.05 to 1",
    };
    const TOLERANCE: Range = Range {
        test: |x| (1e-12..=0.1).contains(&x),
        text: "from 1e-12 to 0.1",
    };
    let section = gas.section("hydro");
    let formulation = section.choice("formulation", &FORMULATIONS, &[]);
    let formulation = formulation.unwrap_or(Formulation::Density);
    let exponent = section.number("pressure_exponent", EXPONENT);
    if formulation != Formulation::Pressure {
        section.misplaced(
            &["pressure_exponent"],
            "belongs to formulation = \"pressure\"",
        );
    }
    let grad_h = section.flag("grad_h");
    let gradient = section.choice("gradient", &GRADIENTS, &[]);
    let kernel = section.choice("kernel", &KERNELS, &[]);
    let kernel = kernel.unwrap_or(KernelKind::WendlandC2);
    let neighbours = section.number("neighbours", NEIGHBOURS);
    let courant = section.number("courant", Range::FRACTION);
    let tolerance = section.number("tolerance", TOLERANCE);
    let background = background(&section, facts);
    let precisions = [("single", Precision::Single), ("double", Precision::Double)];
    let precision = section.choice("precision", &precisions, &[]);
    section.close();
    Hydro {
        formulation,
        exponent: exponent.unwrap_or(1.0),
        grad_h: grad_h.unwrap_or(true),
        gradient: gradient.unwrap_or_default(),
        kernel,
        neighbours: neighbours.unwrap_or_else(|| facts.preset.neighbours(kernel, facts.dimensions)),
        courant: courant.unwrap_or(facts.preset.values().courant),
        tolerance: tolerance.unwrap_or(facts.preset.values().tolerance),
        precision: precision.unwrap_or(Precision::Double),
        background_pressure: background,
    }
}

/// `background_pressure`: a pressure, or "least".
fn background(section: &Section<'_>, facts: &Facts) -> BackgroundPressure {
    const KEY: &str = "background_pressure";
    if section.is_text(KEY, "least") {
        section.text(KEY);
        return BackgroundPressure::Least;
    }
    section
        .quantity(KEY, facts.pressure(), Range::NOT_NEGATIVE)
        .map_or(BackgroundPressure::NONE, BackgroundPressure::Fixed)
}

/// Formulations by name.
pub const FORMULATIONS: [(&str, Formulation); 4] = [
    ("density", Formulation::Density),
    ("pressure", Formulation::Pressure),
    ("number-density", Formulation::Number),
    ("smoothed-energy", Formulation::Smoothed),
];

/// Gradients by name.
pub const GRADIENTS: [(&str, Gradient); 2] = [
    ("standard", Gradient::Standard),
    ("matrix", Gradient::Matrix),
];

/// Reconstructions by name.
pub const RECONSTRUCTIONS: [(&str, Reconstruction); 2] = [
    ("none", Reconstruction::None),
    ("linear", Reconstruction::Linear),
];

/// The name of a value among `names`.
pub fn name_of<T: PartialEq>(names: &[(&'static str, T)], value: T) -> &'static str {
    let named = names.iter().find(|(_, named)| *named == value);
    named.expect("a name for each value").0
}

/// An artificial viscosity of some alpha and beta.
type Making = fn(f64, f64) -> Viscosity;

/// That of gas whose scene names none.
const DEFAULT_VISCOSITY: &str = "cullen-dehnen";

/// Artificial viscosities by name.
const VISCOSITIES: [(&str, Making); 8] = [
    ("none", |_, _| Viscosity::None),
    ("constant", |alpha, beta| Viscosity::Constant {
        alpha,
        beta,
    }),
    ("balsara", |alpha, beta| Viscosity::Balsara { alpha, beta }),
    ("cullen-dehnen", |alpha, beta| Viscosity::CullenDehnen {
        alpha,
        beta,
    }),
    ("neumann-richtmyer", |alpha, beta| {
        Viscosity::NeumannRichtmyer { alpha, beta }
    }),
    ("tensor", |alpha, beta| Viscosity::Tensor { alpha, beta }),
    ("planar-switch", |alpha, beta| Viscosity::PlanarSwitch {
        alpha,
        beta,
    }),
    ("planar", |alpha, beta| Viscosity::Planar { alpha, beta }),
];

/// The name of an artificial viscosity.
pub fn viscosity_name(viscosity: &Viscosity) -> &'static str {
    let [alpha, beta] = viscosity.parameters().unwrap_or_default();
    let named = VISCOSITIES
        .iter()
        .find(|(_, make)| make(alpha, beta) == *viscosity);
    named.expect("a name for each viscosity").0
}

/// Kernels by name.
pub const KERNELS: [(&str, KernelKind); 5] = [
    ("wendland-c2", KernelKind::WendlandC2),
    ("wendland-c4", KernelKind::WendlandC4),
    ("wendland-c6", KernelKind::WendlandC6),
    ("cubic-spline", KernelKind::CubicSpline),
    ("quintic-spline", KernelKind::QuinticSpline),
];

fn viscosity(gas: &Section<'_>, facts: &Facts) -> (Viscosity, Reconstruction, Physical) {
    let section = gas.section("viscosity");
    let names: [(&str, usize); VISCOSITIES.len()] = std::array::from_fn(|k| (VISCOSITIES[k].0, k));
    let default = names
        .iter()
        .position(|(name, _)| *name == DEFAULT_VISCOSITY);
    let chosen = section.choice("kind", &names, &[]).or(default);
    let kind = chosen.expect("the default is among them");
    if kind == 0 {
        section.misplaced(
            &["alpha", "beta", "reconstruction"],
            "has no place in kind = \"none\"",
        );
    }
    let alpha = section.number("alpha", Range::NOT_NEGATIVE).unwrap_or(1.0);
    let beta = section
        .number("beta", Range::NOT_NEGATIVE)
        .unwrap_or(2.0 * alpha);
    let reconstruction = section.choice("reconstruction", &RECONSTRUCTIONS, &[]);
    let disk = section.number("shakura_sunyaev", Range::NOT_NEGATIVE);
    let nu = section.quantity("kinematic", Kind::KINEMATIC, Range::NOT_NEGATIVE);
    section.exclusive("shakura_sunyaev", "kinematic");
    if disk.is_some() && !facts.has_star {
        section.wrong(
            "shakura_sunyaev",
            "needs a [star], whose orbits the viscosity is measured by",
        );
    }
    section.close();
    let physical = match (disk, nu) {
        (Some(alpha), _) if alpha > 0.0 => Physical::ShakuraSunyaev {
            alpha,
            mu: facts.gravity * facts.star_mass,
        },
        (_, Some(nu)) if nu > 0.0 => Physical::Constant { nu },
        _ => Physical::None,
    };
    let viscosity = VISCOSITIES[kind].1(alpha, beta);
    (viscosity, reconstruction.unwrap_or_default(), physical)
}

fn conduction(gas: &Section<'_>, eos: &Eos) -> f64 {
    const ALPHA: Range = Range {
        test: |alpha| (0.0..=2.0).contains(&alpha),
        text: "from 0 to 2; more would carry heat past the colder particle in one step",
    };
    let section = gas.section("conduction");
    let alpha = section.number("alpha", ALPHA).unwrap_or(0.0);
    if alpha > 0.0 && !eos.is_free() {
        section.wrong(
            "alpha",
            "has no effect on gas whose temperature gas.eos sets; allowed there is 0",
        );
    }
    section.close();
    alpha
}

/// How particles are rearranged, if they are.
fn rearrangement(gas: &Section<'_>) -> Option<Order> {
    const STRENGTH: Range = Range {
        test: |strength| (0.0..=100.0).contains(&strength),
        text: "from 0 to 100, the rate of the rearrangement by that of the shear",
    };
    const TOLERANCE: Range = Range {
        test: |tolerance| tolerance > 0.0 && tolerance <= 0.1,
        text: "above 0, at most 0.1, the root mean square error of the density",
    };
    let section = gas.section("rearrange");
    let kinds = [("repulsion", false), ("continuity", true)];
    let order = if section.choice("kind", &kinds, &[]) == Some(true) {
        section.misplaced(&["strength"], "has no place in kind = \"continuity\"");
        Some(Order::Continuity(Continuity {
            tolerance: section.number("tolerance", TOLERANCE).unwrap_or(1e-3),
            iterations: section.whole("iterations", 1, 1000).unwrap_or(20),
        }))
    } else {
        let only = "has no place without kind = \"continuity\"";
        section.misplaced(&["tolerance", "iterations"], only);
        let strength = section.number("strength", STRENGTH).unwrap_or(0.0);
        (strength > 0.0).then_some(Order::Repulsion { strength })
    };
    section.close();
    order
}
