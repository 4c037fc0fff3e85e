//! Who acts on whom: gravity and the coupling by drag.

use super::Facts;
use crate::reader::{Range, Section};
use crate::scene::{
    BodyDrag, Coupling, DustDrag, Gravity, GravityMethod, Mass, Opening, Pulls, Scene,
};

pub const MASSES: [(&str, Mass); 5] = [
    ("gas", Mass::Gas),
    ("dust", Mass::Dust),
    ("planetesimals", Mass::Planetesimals),
    ("planets", Mass::Planets),
    ("star", Mass::Star),
];

/// G in code units.
pub fn constant(root: &Section<'_>) -> f64 {
    let section = root.section("gravity");
    let units = root.units();
    let given = section.number("constant", Range::POSITIVE);
    if given.is_some_and(|g| g != units.gravitational_constant())
        && units.system != crate::units::System::Dimensionless
    {
        section.wrong("constant", "may be set in dimensionless scenes only");
    }
    given.unwrap_or_else(|| units.gravitational_constant())
}

pub fn none(constant: f64) -> Gravity {
    Gravity {
        method: GravityMethod::None,
        opening: Opening::ForceError(1e-3),
        constant,
        pulls: Pulls::default(),
        separate_steps: false,
    }
}

pub fn no_coupling() -> Coupling {
    Coupling {
        gas_dust: false,
        gas_planetesimals: false,
        feedback: true,
        heat_share: 1.0,
        mixtures: true,
        tolerance: None,
    }
}

impl Scene {
    /// Whether the scene has particles of this kind.
    pub fn has(&self, mass: Mass) -> bool {
        match mass {
            Mass::Gas => self.gas.is_some(),
            Mass::Dust => self.dust.is_some(),
            Mass::Planetesimals => self
                .planetesimals
                .is_some_and(|bodies| bodies.number > 0 || self.initial_file.is_some()),
            Mass::Planets => !self.planets.is_empty(),
            Mass::Star => self.star.is_some(),
        }
    }
}

pub fn with_gravity(mut scene: Scene, root: &Section<'_>, facts: &Facts) -> Scene {
    let section = root.section("gravity");
    section.number("constant", Range::ANY);
    let closed = scene.domain.size().is_some();
    let methods = [
        ("tree", GravityMethod::Tree),
        ("direct", GravityMethod::Direct),
        ("none", GravityMethod::None),
    ];
    let method = section.choice("method", &methods, &[]);
    if closed && method.is_some_and(|method| method != GravityMethod::None) {
        section.wrong(
            "method",
            match scene.domain.hill() {
                Some(_) => "is not available in a shearing box; allowed is \"none\"",
                None => "is not available in a periodic domain; allowed is \"none\"",
            },
        );
    }
    let method = method.unwrap_or(if closed {
        GravityMethod::None
    } else {
        GravityMethod::Tree
    });
    let pulls = pulls(&section, &scene, method);
    scene.gravity = Gravity {
        method,
        opening: opening(&section, facts),
        constant: facts.gravity,
        separate_steps: separate_steps(&section, &scene, &pulls),
        pulls,
    };
    section.close();
    scene
}

/// Whether the field of fluids and planetesimals kicks the gas at steps of its own. Drag compares velocities in the middle of such steps.
fn separate_steps(section: &Section<'_>, scene: &Scene, pulls: &Pulls) -> bool {
    let wanted = section.flag("separate_steps");
    let sources = [Mass::Gas, Mass::Dust, Mass::Planetesimals];
    let felt = sources.iter().any(|&mass| pulls.has(mass, Mass::Gas));
    let drag = scene.coupling.gas_dust || scene.coupling.gas_planetesimals;
    if wanted == Some(true) && drag {
        section.wrong(
            "separate_steps",
            "has no place beside drag on the gas, which needs velocities at the steps of its forces",
        );
    } else if wanted == Some(true) && !felt {
        section.wrong(
            "separate_steps",
            "has no effect without gas that gas, dust or planetesimals pull",
        );
    }
    felt && !drag && wanted.unwrap_or(true)
}

fn opening(section: &Section<'_>, facts: &Facts) -> Opening {
    const ERROR: Range = Range {
        test: |x| (1e-9..=0.5).contains(&x),
        text: "from 1e-9 to 0.5",
    };
    let error = section.number("force_error", ERROR);
    let angle = section.number("opening_angle", Range::FRACTION);
    section.exclusive("force_error", "opening_angle");
    match angle {
        Some(angle) => Opening::Angle(angle),
        None => Opening::ForceError(error.unwrap_or(facts.preset.values().force_error)),
    }
}

/// A source without a list pulls all that the scene has; in two dimensions star and planets alone, and gas by a list: a razor-thin sheet in space.
fn pulls(section: &Section<'_>, scene: &Scene, method: GravityMethod) -> Pulls {
    let table = section.section("pulls");
    let planar = scene.domain.dimensions() == 2;
    let mut pulls = Pulls::default();
    for (name, source) in MASSES {
        let listed = table.choices(name, &MASSES);
        let sheet = source == Mass::Gas && listed.is_some();
        let point = matches!(source, Mass::Star | Mass::Planets);
        let may = scene.has(source) && (!planar || sheet || point);
        if listed.as_ref().is_some_and(|targets| !targets.is_empty()) {
            if method == GravityMethod::None {
                table.wrong(name, "has no place beside gravity.method = \"none\"");
            } else if !scene.has(source) {
                table.wrong(name, "is not in the scene, so it cannot pull");
            } else if !may {
                table.wrong(
                    name,
                    "cannot pull in two dimensions, where star, planets and gas alone may",
                );
            }
        }
        for (target_name, target) in MASSES {
            let wanted = listed.as_ref().map(|targets| targets.contains(&target));
            if wanted == Some(true) && !scene.has(target) {
                let sentence = format!("names \"{target_name}\", which is not in the scene");
                table.wrong(name, &sentence);
            }
            let itself = source == Mass::Star && target == Mass::Star;
            // Dust in gas that does not pull would clump by a gravity that is a small part of the disk's.
            let tracers =
                scene.has_dust_in_formula() && (source, target) == (Mass::Dust, Mass::Dust);
            let acts = may && scene.has(target) && !itself && method != GravityMethod::None;
            pulls.0[source as usize][target as usize] = acts && wanted.unwrap_or(!tracers);
        }
    }
    table.close();
    pulls
}

/// Errors of the splitting that can be kept: relaxation makes none above 0.117.
const TOLERANCE: Range = Range {
    test: |x| (1e-8..=0.1).contains(&x),
    text: "from 1e-8 to 0.1",
};

pub fn with_coupling(mut scene: Scene, root: &Section<'_>) -> Scene {
    let section = root.section("coupling");
    let dust_law = scene.dust.as_ref().map(|dust| dust.drag);
    let body_law = scene.planetesimals.map(|bodies| bodies.drag);
    let gas = scene.gas.is_some();
    let air = gas || scene.surroundings.disk.is_some();
    let can_dust = air && dust_law.is_some_and(|law| law != DustDrag::None);
    let can_bodies = gas && body_law.is_some_and(|law| law != BodyDrag::None);
    let pairs = [("gas-dust", 0), ("gas-planetesimals", 1)];
    let listed = section.choices("drag", &pairs);
    let wants = |pair, default| listed.as_ref().map_or(default, |list| list.contains(&pair));
    scene.coupling = Coupling {
        gas_dust: wants(0, can_dust),
        gas_planetesimals: wants(1, can_bodies),
        feedback: section.flag("feedback").unwrap_or(true),
        heat_share: section.number("heat_share", Range::PART).unwrap_or(1.0),
        mixtures: section.flag("mixtures").unwrap_or(true),
        tolerance: section.number("tolerance", TOLERANCE),
    };
    if scene.coupling.tolerance.is_some() && !(gas && scene.coupling.gas_dust) {
        section.wrong(
            "tolerance",
            "needs drag between [gas] of particles and [dust]: it is of the steps of that exchange",
        );
    }
    for (on, can, what, law) in [
        (
            scene.coupling.gas_dust,
            can_dust,
            "gas-dust",
            "[gas] and [dust] with dust.drag.law",
        ),
        (
            scene.coupling.gas_planetesimals,
            can_bodies,
            "gas-planetesimals",
            "[gas] and [planetesimals] with planetesimals.drag.law",
        ),
    ] {
        if on && !can {
            section.wrong(
                "drag",
                &format!("names \"{what}\", which needs {law} other than \"none\""),
            );
        }
    }
    section.close();
    scene
}
