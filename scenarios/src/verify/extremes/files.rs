//! Files whose columns hold what is no number, or too much of one.

use nbody::points::Vec3;

use super::case::Case;
use super::scene;
use super::start::Start;
use crate::hdf::Array;

const ALL: &str = "[star]\nmass = 1\n[gas]\n[dust]\n[dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 0.1\n[planetesimals]\n";

/// All columns of numbers that a start takes over.
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

const VECTORS: [&str; 3] = ["Coordinates", "Velocities", "Spins"];

/// Two of each population, with all columns.
fn start() -> Start {
    let mut start = Start::default();
    for (kind, far) in [(0, 1.0), (1, 2.0), (2, 3.0)] {
        let x = [far * Vec3::x(), far * Vec3::y()];
        start = start.and(kind, &x, &[0.1 * Vec3::y(), 0.1 * Vec3::x()], &[1e-6; 2]);
    }
    for (kind, name) in COLUMNS {
        start = match name {
            "Coordinates" | "Velocities" | "Masses" => start,
            "Spins" => start.with(kind, name, Array::Vector(vec![Vec3::zeros(); 2])),
            "Compositions" => start.with(kind, name, Array::Vector(vec![Vec3::x(); 2])),
            _ => start.reals(kind, name, &[0.1; 2]),
        };
    }
    start
}

/// The refusal of a value in a column, if there is to be one.
fn refusal(kind: usize, name: &str, value: f64) -> Option<String> {
    let place = format!("start.hdf5: PartType{kind}/{name}: entry 1 (from 0)");
    let far = format!("start.hdf5: PartType{kind}: {name}: entry 1 (from 0)");
    let is_vector = VECTORS.contains(&name);
    Some(match value {
        _ if !value.is_finite() => format!("{place} is not a finite number"),
        _ if name == "Compositions" && value.abs() > 1e-9 => {
            format!("{place} is no set of mass fractions that make 1")
        }
        _ if is_vector && value.abs() > 1e100 => format!("{far} is beyond 1e100"),
        _ if is_vector || name == "Compositions" => return None,
        _ if value < 0.0 => format!("{place} is negative, {value:e}"),
        _ => format!("{far} is {value:e}; allowed are 0 and sizes from 1e-100 to 1e100"),
    })
}

pub fn cases() -> Vec<Case> {
    let all = || scene(0.1, ALL);
    let mut cases = vec![
        Case::new("two of each population", all())
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
            1e-320,
        ] {
            let what = format!("{value:e} in PartType{kind}/{name}");
            // At the place of the star.
            let inside = name == "Coordinates" && value == 1e-320;
            let case = match refusal(kind, name, value) {
                _ if inside => Case::refused(
                    what,
                    all(),
                    "~ particle ~ stands at the very place of the star, where its pull has no value: move it, or give star.accretion_radius",
                ),
                Some(sentence) => Case::refused(what, all(), sentence),
                None => Case::new(what, all()).left(6),
            };
            cases.push(case.from(start().spoiled(kind, name, value)));
        }
    }
    identities(&mut cases);
    let short = start().reals(0, "Masses", &[1.0]);
    let sentence = "start.hdf5: PartType0/Masses has 1 entries, but Coordinates has 2";
    cases.push(Case::refused("one mass for two", all(), sentence).from(short));
    let light = start().spoiled(0, "Masses", 0.0);
    let sentence =
        "start.hdf5: PartType0: Masses: entry 1 (from 0) is 0, but gas without mass has no density";
    cases.push(Case::refused("gas without mass", all(), sentence).from(light));
    let half = scene(0.1, "[star]\nmass = 1\n[gas]\n[planetesimals]\n");
    let sentence = "start.hdf5: has PartType2, but the scene has no table [dust]";
    cases.push(Case::refused("dust that the scene leaves out", half, sentence).from(start()));
    cases
}

fn identities(cases: &mut Vec<Case>) {
    for kind in 0..3 {
        let with = |ids: [u64; 2]| start().with(kind, "ParticleIDs", Array::Integer(ids.to_vec()));
        let sentence = format!(
            "start.hdf5: PartType{kind}: ParticleIDs: {} leaves no identities for new bodies; the most is {}",
            u64::MAX,
            u64::MAX / 2
        );
        let what = format!("the largest identity there is in PartType{kind}");
        cases.push(Case::refused(what, scene(0.1, ALL), sentence).from(with([1, u64::MAX])));
        let sentence = format!("start.hdf5: PartType{kind}/ParticleIDs: 7 occurs twice");
        let what = format!("one identity twice in PartType{kind}");
        cases.push(Case::refused(what, scene(0.1, ALL), sentence).from(with([7, 7])));
    }
}
