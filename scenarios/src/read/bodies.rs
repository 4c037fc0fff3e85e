//! The bodies of a scene: planetesimals and planets.

use std::f64::consts::PI;

use nbody::integrators::hybrid::cutoff::Cutoff;
use nbody::integrators::wisdom_holman::jacobi::{Corrector, Kernel, Scheme};

use super::Facts;
use super::composition::fractions;
use super::frame::time_step;
use super::gas::MOST_PARTICLES;
use crate::reader::{Range, Section};
use crate::scene::{BodyDrag, Collisions, Coordinates, Integrator, Orbit, Planet, Planetesimals};
use crate::units::{Kind, System};

pub fn planetesimals(root: &Section<'_>, facts: &Facts) -> Option<Planetesimals> {
    let section = root.section("planetesimals");
    if !section.present && !facts.has_planets {
        return None;
    }
    let given = section.whole("number", 0, MOST_PARTICLES);
    let number = given.unwrap_or(0) as usize;
    let nobody = number == 0 && !facts.has_planets && !facts.has_file;
    if nobody && section.present && (given.is_some() || !section.has("number")) {
        section.wrong(
            "number",
            "needs number, at least 1, a [[planet]] or an initial.file",
        );
    }
    let blamed = nobody || (given.is_none() && section.has("number"));
    let belt = Belt::of(&section, number, blamed);
    let softening = section.quantity("softening", Kind::LENGTH, Range::NOT_NEGATIVE);
    let bodies = Planetesimals {
        number,
        mass: belt.mass,
        inner_radius: belt.inner_radius,
        outer_radius: belt.outer_radius,
        slope: belt.slope,
        eccentricity: belt.eccentricity,
        inclination: belt.inclination,
        density: belt.density,
        radius: belt.radius,
        integrator: integrator(&section),
        coordinates: coordinates(&section),
        cutoff: cutoff(&section),
        softening: softening.unwrap_or(0.0),
        time_step: time_step(&section),
        drag: drag(&section, facts, number),
        collisions: collisions(&section),
        composition: composition(&section),
    };
    if number > 0 && !facts.has_star {
        section.wrong(
            "number",
            match facts.has_orbits {
                true => {
                    "needs a [star] to orbit; in a shearing box give [[planet]] or an initial.file"
                }
                false => "needs a [star] to orbit",
            },
        );
    }
    section.close();
    Some(bodies)
}

/// The generated belt of planetesimals.
#[derive(Default)]
struct Belt {
    mass: f64,
    inner_radius: f64,
    outer_radius: f64,
    slope: f64,
    eccentricity: f64,
    inclination: f64,
    density: f64,
    radius: f64,
}

impl Belt {
    /// `blamed`: that there is no number of planetesimals has been said.
    fn of(section: &Section<'_>, number: usize, blamed: bool) -> Self {
        let mass = body_mass(section, number);
        let inner = section.quantity("inner_radius", Kind::LENGTH, Range::POSITIVE);
        let outer = section.quantity("outer_radius", Kind::LENGTH, Range::POSITIVE);
        let slope = section.number("slope", Range::ANY).unwrap_or(-1.5);
        let eccentricity = section.number("eccentricity", Range::ECCENTRICITY);
        let inclination = section.quantity("inclination", Kind::ANGLE, INCLINATION);
        let density = section.quantity("density", Kind::DENSITY, Range::NOT_NEGATIVE);
        let radius = section.quantity("radius", Kind::LENGTH, Range::NOT_NEGATIVE);
        if number == 0 && blamed {
            return Self::default();
        }
        if number == 0 {
            section.misplaced(
                &[
                    "mass",
                    "total_mass",
                    "inner_radius",
                    "outer_radius",
                    "slope",
                    "eccentricity",
                    "inclination",
                    "density",
                    "radius",
                ],
                "describes generated planetesimals: give planetesimals.number too",
            );
            return Self::default();
        }
        if mass > 0.0 {
            section.misplaced(
                &["radius"],
                "belongs to massless planetesimals; the size of others follows from mass and density",
            );
        }
        let what = "a length such as \"1 au\"";
        let eccentricity = eccentricity.unwrap_or(0.01);
        Self {
            mass,
            inner_radius: section.required("inner_radius", inner, what, f64::NAN),
            outer_radius: section.required("outer_radius", outer, what, f64::NAN),
            slope,
            eccentricity,
            inclination: inclination.unwrap_or(0.5 * eccentricity),
            density: density.unwrap_or_else(|| rock(section, 2.0)),
            radius: radius.filter(|_| mass == 0.0).unwrap_or(0.0),
        }
    }
}

const INCLINATION: Range = Range {
    test: |i| (0.0..=PI).contains(&i),
    text: "from 0 to 180 deg",
};

/// Mass of each body, given or as a share of the total.
fn body_mass(section: &Section<'_>, number: usize) -> f64 {
    let mass = section.quantity("mass", Kind::MASS, Range::NOT_NEGATIVE);
    let total = section.quantity("total_mass", Kind::MASS, Range::NOT_NEGATIVE);
    section.exclusive("mass", "total_mass");
    if number > 0 && !section.has("mass") && !section.has("total_mass") {
        section.wrong(
            "mass",
            "needs mass, of each, or total_mass, such as \"1 Mearth\"",
        );
    }
    match (mass, total) {
        (Some(mass), _) => mass,
        (None, Some(total)) => total / number as f64,
        (None, None) => f64::NAN,
    }
}

/// Material of `cgs` g/cm^3; without a size in dimensionless scenes.
fn rock(section: &Section<'_>, cgs: f64) -> f64 {
    let units = section.units();
    match units.system {
        System::Dimensionless => 0.0,
        _ => cgs / units.cgs(Kind::DENSITY.dimension),
    }
}

fn integrator(section: &Section<'_>) -> Integrator {
    let options = [
        ("auto", Integrator::Auto),
        ("leapfrog", Integrator::Leapfrog),
        ("wisdom-holman", Integrator::WisdomHolman),
        ("hermite", Integrator::Hermite),
        ("hybrid", Integrator::Hybrid),
        ("gauss-radau", Integrator::GaussRadau),
        ("epicycles", Integrator::Epicycles),
    ];
    section
        .choice("integrator", &options, &[])
        .unwrap_or(Integrator::Auto)
}

const RESTITUTION: Range = Range {
    test: |e| (0.0..=1.0).contains(&e),
    text: "from 0 to 1",
};

const TANGENTIAL_RESTITUTION: Range = Range {
    test: |e| (-1.0..=1.0).contains(&e),
    text: "from -1 (the spheres' surfaces turn round) to 1 (smooth spheres)",
};

const COUPLING: Range = Range {
    test: |mu| (1.0 / 3.0..=2.0 / 3.0).contains(&mu),
    text: "from 1/3 to 2/3",
};

/// Fragments of one impact, beside the largest remnant, unless the scene says otherwise.
const MOST_FRAGMENTS: usize = 30;

/// The cut-off radius of the hybrid map, in Hill radii.
fn cutoff(section: &Section<'_>) -> f64 {
    let follows = ["auto", "hybrid"].iter();
    let meeting = follows.fold(!section.has("integrator"), |any, name| {
        any || section.is_text("integrator", name)
    });
    if !meeting {
        section.misplaced(
            &["cutoff"],
            "belongs to integrator = \"hybrid\" or \"auto\"",
        );
    }
    let given = section.number("cutoff", Range::POSITIVE);
    given.unwrap_or(Cutoff::default().hill)
}

fn coordinates(section: &Section<'_>) -> Coordinates {
    let options = [("democratic-heliocentric", false), ("jacobi", true)];
    let jacobi = section.choice("coordinates", &options, &[]);
    let kernels = [("standard", Kernel::Standard), ("lazy", Kernel::Lazy)];
    let kernel = section.choice("kernel", &kernels, &[]).unwrap_or_default();
    let order = section.whole("corrector", 0, 17).unwrap_or(0);
    let corrector = Corrector::ALL
        .into_iter()
        .find(|corrector| u64::from(corrector.order()) == order);
    if corrector.is_none() {
        section.wrong("corrector", "must be one of 0, 3, 5, 7, 11 and 17");
    }
    if jacobi == Some(true) {
        let corrector = corrector.unwrap_or_default();
        return Coordinates::Jacobi(Scheme { kernel, corrector });
    }
    section.misplaced(
        &["corrector", "kernel"],
        "belongs to coordinates = \"jacobi\"",
    );
    Coordinates::DemocraticHeliocentric
}

fn collisions(bodies: &Section<'_>) -> Collisions {
    let section = bodies.section("collisions");
    let options = [("none", 0), ("merge", 1), ("bounce", 2), ("fragment", 3)];
    let outcome = section.choice("outcome", &options, &[]);
    let refused = outcome.is_none() && section.has("outcome");
    let outcome = outcome.unwrap_or(0);
    let belongs = |only: i32, keys: &[&'static str], sentence: &str| {
        if refused {
            section.pass_over(keys);
        } else if outcome != only {
            section.misplaced(keys, sentence);
        }
    };
    belongs(
        2,
        &["restitution", "tangential_restitution"],
        "belongs to outcome = \"bounce\"",
    );
    belongs(
        3,
        &[
            "fragment_mass",
            "most_fragments",
            "c_star",
            "mu",
            "reference_density",
        ],
        "belongs to outcome = \"fragment\"",
    );
    let collisions = match outcome {
        0 => Collisions::None,
        1 => Collisions::Merge,
        2 => Collisions::Bounce {
            restitution: section.number("restitution", RESTITUTION).unwrap_or(1.0),
            tangential_restitution: section
                .number("tangential_restitution", TANGENTIAL_RESTITUTION)
                .unwrap_or(1.0),
        },
        _ => fragmentation(&section),
    };
    section.close();
    collisions
}

fn fragmentation(section: &Section<'_>) -> Collisions {
    let mass = section.quantity("fragment_mass", Kind::MASS, Range::POSITIVE);
    let what = "the mass of the smallest fragment, such as \"1e-4 Mearth\"";
    let density = section.quantity("reference_density", Kind::DENSITY, Range::POSITIVE);
    let density = density.or_else(|| match rock(section, 1.0) {
        0.0 => None,
        density => Some(density),
    });
    let referred = "the density that the scaling laws refer to, 1 g/cm^3, in the scene's own units";
    Collisions::Fragment {
        fragment_mass: section.required("fragment_mass", mass, what, f64::NAN),
        most_fragments: section
            .whole("most_fragments", 1, 10_000)
            .map_or(MOST_FRAGMENTS, |most| most as usize),
        c_star: section.number("c_star", Range::POSITIVE).unwrap_or(1.9),
        mu: section.number("mu", COUPLING).unwrap_or(0.36),
        reference_density: section.required("reference_density", density, referred, f64::NAN),
    }
}

/// Mass fractions of ice, rock and iron; what is left out is not there.
fn composition(bodies: &Section<'_>) -> Option<[f64; 3]> {
    let section = bodies.section("composition");
    let parts = fractions(&section, ["ice", "rock", "iron"]);
    let present = section.present;
    section.close();
    present.then_some(parts)
}

pub const LAWS: [(&str, usize); 4] = [
    ("none", 0),
    ("adachi", 1),
    ("constant-stopping-time", 2),
    ("quadratic", 3),
];

fn drag(bodies: &Section<'_>, facts: &Facts, number: usize) -> BodyDrag {
    let section = bodies.section("drag");
    let given = section.choice("law", &LAWS, &[]);
    let by_default = facts.has_gas && number > 0 && facts.dimensions == 3;
    let law = given.unwrap_or(usize::from(by_default));
    if law != 0 && !facts.has_gas {
        section.wrong(
            "law",
            "needs [gas] to rub against; without gas allowed is \"none\"",
        );
    }
    let drag = drag_law(&section, "law", law);
    section.close();
    drag
}

/// A law of drag by its place among none, adachi, constant stopping time and quadratic, named by `key`, with the number it needs.
pub fn drag_law(section: &Section<'_>, key: &str, law: usize) -> BodyDrag {
    let time = section.quantity("stopping_time", Kind::TIME, Range::POSITIVE);
    let coefficient = section.quantity("coefficient", Kind::PER_LENGTH, Range::POSITIVE);
    if law != 2 {
        section.misplaced(
            &["stopping_time"],
            &format!("belongs to {key} = \"constant-stopping-time\""),
        );
    }
    if law != 3 {
        section.misplaced(
            &["coefficient"],
            &format!("belongs to {key} = \"quadratic\""),
        );
    }
    match law {
        0 => BodyDrag::None,
        1 => BodyDrag::Adachi,
        2 => BodyDrag::ConstantStoppingTime(section.required(
            "stopping_time",
            time,
            "a time such as \"1 yr\"",
            f64::NAN,
        )),
        _ => BodyDrag::Quadratic(section.required(
            "coefficient",
            coefficient,
            "an inverse length such as \"1e-9 1/au\"",
            f64::NAN,
        )),
    }
}

pub fn planets(root: &Section<'_>, facts: &Facts) -> Vec<Planet> {
    root.sections("planet")
        .into_iter()
        .map(|section| planet(section, facts))
        .collect()
}

fn planet(section: Section<'_>, facts: &Facts) -> Planet {
    let mass = section.quantity("mass", Kind::MASS, Range::NOT_NEGATIVE);
    let mass = section.required("mass", mass, "such as \"1 Mearth\"", f64::NAN);
    let (radius, density) = planet_size(&section, mass);
    const NOT_ZERO: Range = Range {
        test: |x| x != 0.0,
        text: "a time other than 0: positive outward, negative inward",
    };
    let migration_time = section.quantity("migration_time", Kind::TIME, NOT_ZERO);
    if migration_time.is_some() && !facts.has_star {
        section.wrong("migration_time", "needs a [star] to migrate from or to");
    }
    let orbit = if section.has("position") || section.has("velocity") {
        state(&section)
    } else {
        elements(&section, facts)
    };
    section.close();
    Planet {
        mass,
        radius,
        density,
        migration_time,
        orbit,
    }
}

/// Radius, and for a planet without mass its density.
fn planet_size(section: &Section<'_>, mass: f64) -> (f64, f64) {
    let radius = section.quantity("radius", Kind::LENGTH, Range::NOT_NEGATIVE);
    let density = section.quantity("density", Kind::DENSITY, Range::POSITIVE);
    if mass == 0.0 {
        if section.has("density") && !section.has("radius") {
            section.wrong(
                "density",
                "needs radius beside it: a planet without mass has no size by itself",
            );
        }
        let radius = radius.unwrap_or(0.0);
        let density = density.unwrap_or_else(|| rock(section, 1.0));
        return (radius, if radius > 0.0 { density } else { 0.0 });
    }
    section.exclusive("density", "radius");
    let radius = radius.unwrap_or_else(|| {
        let density = density.unwrap_or_else(|| rock(section, 1.0));
        if density > 0.0 {
            (3.0 * mass / (4.0 * PI * density)).cbrt()
        } else {
            0.0
        }
    });
    (radius, 0.0)
}

const ELEMENTS: [&str; 6] = [
    "semi_major_axis",
    "eccentricity",
    "inclination",
    "longitude_of_node",
    "argument_of_pericentre",
    "mean_anomaly",
];

fn state(section: &Section<'_>) -> Orbit {
    let position = section.vector("position", Kind::LENGTH);
    let velocity = section.vector("velocity", Kind::VELOCITY);
    section.misplaced(
        &ELEMENTS,
        "cannot stand beside position and velocity: give the one or the other",
    );
    let nowhere = nbody::points::Vec3::repeat(f64::NAN);
    let what = "[x, y, z]; position and velocity go together";
    Orbit::State {
        position: section.required("position", position, what, nowhere),
        velocity: section.required("velocity", velocity, what, nowhere),
    }
}

fn elements(section: &Section<'_>, facts: &Facts) -> Orbit {
    let axis = section.quantity("semi_major_axis", Kind::LENGTH, Range::POSITIVE);
    let what = "such as \"1 au\", or position and velocity";
    let angle = |key| {
        section
            .quantity(key, Kind::ANGLE, Range::ANY)
            .unwrap_or(0.0)
    };
    let inclination = section.quantity("inclination", Kind::ANGLE, INCLINATION);
    let orbit = Orbit::Elements {
        semi_major_axis: section.required("semi_major_axis", axis, what, f64::NAN),
        eccentricity: section
            .number("eccentricity", Range::ECCENTRICITY)
            .unwrap_or(0.0),
        inclination: inclination.unwrap_or(0.0),
        longitude_of_node: angle("longitude_of_node"),
        argument_of_pericentre: angle("argument_of_pericentre"),
        mean_anomaly: angle("mean_anomaly"),
    };
    if !facts.has_star {
        section.wrong(
            "semi_major_axis",
            "needs a [star] to orbit; without one give position and velocity",
        );
    }
    orbit
}
