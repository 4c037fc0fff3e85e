//! Files whose columns hold what is no number, or too much of one.

use nbody::points::Vec3;

use super::case::Case;
use super::scene;
use super::start::Start;
use crate::hdf::Array;

const ALL: &str = "[star]\nmass = 1\n[gas]\n[dust]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n[planetesimals]\n";

/// Two of each population, with all columns that a start may have.
fn start() -> Start {
    let mut start = Start::default();
    for (kind, far) in [(0, 1.0), (1, 2.0), (2, 3.0)] {
        let x = [far * Vec3::x(), far * Vec3::y()];
        let v = [0.1 * Vec3::y(), 0.1 * Vec3::x()];
        start = start.and(kind, &x, &v, &[1e-6; 2]);
    }
    for (kind, name) in COLUMNS
        .iter()
        .filter(|(_, name)| !["Coordinates", "Velocities", "Masses"].contains(name))
    {
        start = match *name {
            "Spins" => start.with(*kind, name, Array::Vector(vec![Vec3::zeros(); 2])),
            "Compositions" => start.with(*kind, name, Array::Vector(vec![Vec3::x(); 2])),
            _ => start.reals(*kind, name, &[0.1; 2]),
        };
    }
    start
}

const COLUMNS: [(usize, &str); 17] = [
    (0, "Coordinates"),
    (0, "Velocities"),
    (0, "Masses"),
    (0, "InternalEnergies"),
    (0, "SmoothingLengths"),
    (1, "Coordinates"),
    (1, "Velocities"),
    (1, "Masses"),
    (1, "Radii"),
    (1, "Densities"),
    (1, "Spins"),
    (1, "Compositions"),
    (2, "Coordinates"),
    (2, "Velocities"),
    (2, "Masses"),
    (2, "GrainRadii"),
    (2, "GrainDensities"),
];

pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        Case::new("two of each population", scene(0.1, ALL))
            .from(start())
            .left(6),
    ];
    for (kind, name) in COLUMNS {
        for value in [
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e200,
            -1e200,
            -1.0,
            1e-320,
        ] {
            let what = format!("{value:e} in PartType{kind}/{name}");
            cases.push(Case::new(what, scene(0.1, ALL)).from(start().spoiled(kind, name, value)));
        }
    }
    for ids in [[u64::MAX, 1], [0, 0], [0, 7], [u64::MAX - 1, u64::MAX]] {
        for kind in 0..3 {
            let spoiled = start().with(kind, "ParticleIDs", Array::Integer(ids.to_vec()));
            cases.push(
                Case::new(
                    format!("identities {ids:?} of PartType{kind}"),
                    scene(0.1, ALL),
                )
                .from(spoiled),
            );
        }
    }
    let short = start().reals(0, "Masses", &[1.0]);
    cases.push(Case::new("one mass of two", scene(0.1, ALL)).from(short));
    let half = ALL.replace("[dust]\n", "").replace(
        "[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n",
        "",
    );
    cases.push(Case::new("dust of a file beside a scene without", scene(0.1, &half)).from(start()));
    cases
}
