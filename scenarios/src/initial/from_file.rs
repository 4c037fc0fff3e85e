//! A start from a file: particles and bodies of a snapshot's layout become populations of the scene.

use std::path::Path;

use dust::Superparticles;
use gas::Particles;
use nbody::points::Columns;
use nbody::{Bodies, Kind};

use crate::populate::{Refusal, hydro};
use crate::reader::MOST;
use crate::scene::{Scene, Sizes};
use crate::snapshot::{self, Particles as Rows};

/// The largest smoothing length by the shortest side of a periodic box: a search meets as many images along each axis.
const MOST_BOXES: f64 = 10.0;

/// The largest identity of a file: half of all.
const MOST_ID: u64 = u64::MAX / 2;

/// Columns that a start takes over, beside those that each file has.
const STARTING: [&str; 6] = [
    "InternalEnergies",
    "SmoothingLengths",
    "Radii",
    "Densities",
    "GrainRadii",
    "GrainDensities",
];

/// What a file adds to a scene.
#[derive(Clone, Debug, Default)]
pub struct Start {
    pub gas: Particles,
    pub dust: Superparticles,
    pub bodies: Bodies,
    pub star: Bodies,
}

/// Reads the populations that the scene models; those that it does not model are refused, since a run would lose them.
pub fn read(path: &Path, scene: &Scene) -> Result<Start, Refusal> {
    let contents =
        snapshot::read(path, Some(&scene.units)).map_err(|error| Refusal(error.to_string()))?;
    let mut start = Start::default();
    for rows in contents.groups.iter().filter(|rows| !rows.is_empty()) {
        let (modelled, table) = match rows.part_type {
            0 => (scene.gas.is_some(), "[gas]"),
            1 => (scene.planetesimals.is_some(), "[planetesimals]"),
            2 => (scene.dust.is_some(), "[dust]"),
            4 => (scene.star.is_some(), "[star]"),
            other => {
                return Err(Refusal(format!(
                    "{}: PartType{other} is no population of a scene",
                    path.display()
                )));
            }
        };
        if !modelled {
            let kind = rows.part_type;
            return Err(Refusal(format!(
                "{}: has PartType{kind}, but the scene has no table {table}",
                path.display()
            )));
        }
        let refuse = |what: String| {
            Refusal(format!(
                "{}: PartType{}: {what}",
                path.display(),
                rows.part_type
            ))
        };
        followed(rows).map_err(refuse)?;
        match rows.part_type {
            0 => start.gas = gas(rows, scene).map_err(refuse)?,
            1 if scene.domain.dimensions() == 2 => {
                return Err(refuse("planetesimals need three dimensions".into()));
            }
            1 => start.bodies = bodies(rows, Kind::Planetesimal),
            2 => start.dust = dust(rows, scene).map_err(refuse)?,
            _ if rows.len() > 1 => return Err(refuse("a scene has one star".into())),
            _ => {
                start.star = bodies(rows, Kind::Star);
                start.star.composition.clear();
            }
        }
    }
    Ok(start)
}

/// Whether all numbers are of sizes whose cubes are numbers too, and identities leave room for those of new bodies.
fn followed(rows: &Rows) -> Result<(), String> {
    let vectors = [
        ("Coordinates", &rows.x),
        ("Velocities", &rows.v),
        ("Spins", &rows.spin),
    ];
    for (name, values) in vectors {
        if let Some(i) = values.iter().position(|x| x.amax() > MOST) {
            return Err(format!("{name}: entry {i} (from 0) is beyond {MOST:e}"));
        }
    }
    let columns = STARTING
        .into_iter()
        .filter_map(|name| Some((name, rows.more.get(name)?)));
    for (name, values) in columns.chain([("Masses", &rows.m)]) {
        let strange = |x: &f64| *x != 0.0 && !(1.0 / MOST..=MOST).contains(x);
        if let Some(i) = values.iter().position(strange) {
            return Err(format!(
                "{name}: entry {i} (from 0) is {:e}; allowed are 0 and sizes from {:e} to {MOST:e}",
                values[i],
                1.0 / MOST
            ));
        }
    }
    match rows.id.iter().find(|&&id| id > MOST_ID) {
        Some(id) => Err(format!(
            "ParticleIDs: {id} leaves no identities for new bodies; the most is {MOST_ID}"
        )),
        None => Ok(()),
    }
}

/// Refuses zeros in a column that has to be positive.
fn positive(name: &str, values: &[f64], why: &str) -> Result<(), String> {
    match values.iter().position(|&x| x == 0.0) {
        Some(i) => Err(format!("{name}: entry {i} (from 0) is 0, but {why}")),
        None => Ok(()),
    }
}

fn column(rows: &Rows, name: &str) -> Vec<f64> {
    rows.more.get(name).cloned().unwrap_or_default()
}

fn gas(rows: &Rows, scene: &Scene) -> Result<Particles, String> {
    let Some(gas) = &scene.gas else {
        return Ok(Particles::default());
    };
    let hydro = hydro(scene, gas);
    positive("Masses", &rows.m, "gas without mass has no density")?;
    let u = column(rows, "InternalEnergies");
    if u.is_empty() && hydro.eos.is_free() {
        return Err(
            "InternalEnergies are missing, and the equation of state does not set them".into(),
        );
    }
    let mut h = column(rows, "SmoothingLengths");
    let periods = (0..3).map(|axis| scene.domain.period(axis));
    let shortest = periods.filter(|&p| p > 0.0).fold(f64::INFINITY, f64::min);
    if let Some(i) = h.iter().position(|&h| h > MOST_BOXES * shortest) {
        return Err(format!(
            "SmoothingLengths: entry {i} (from 0) is {:e}, more than {MOST_BOXES} times the periodic box",
            h[i]
        ));
    }
    if h.is_empty() {
        h = vec![guess(rows, scene, hydro.support(), hydro.neighbours); rows.len()];
    }
    let mut particles = Particles {
        id: rows.id.clone(),
        x: rows.x.clone(),
        v: rows.v.clone(),
        m: rows.m.clone(),
        u,
        h,
        vapour: vapour(rows, scene)?,
        ..Default::default()
    };
    particles.resize(rows.len());
    Ok(particles)
}

/// What the file brings of vapour, where the scene follows it.
fn vapour(rows: &Rows, scene: &Scene) -> Result<Vec<f64>, String> {
    let composition = scene.dust.as_ref().and_then(|dust| dust.composition);
    if !composition.is_some_and(|composition| composition.sublimation) {
        return Ok(Vec::new());
    }
    let vapour = column(rows, "VapourFractions");
    match vapour.iter().position(|&f| f > 1.0) {
        Some(i) => Err(format!(
            "VapourFractions: entry {i} (from 0) is {:e}; allowed are mass fractions from 0 to 1",
            vapour[i]
        )),
        None => Ok(vapour),
    }
}

/// A smoothing length to start the search from: that of a uniform filling of the box around all particles.
fn guess(rows: &Rows, scene: &Scene, support: f64, neighbours: f64) -> f64 {
    let (lo, hi) = nbody::points::sort::bounds(&rows.x);
    let d = scene.domain.dimensions();
    let volume: f64 = (0..3)
        .filter(|&a| scene.domain.axes[a])
        .map(|a| (hi[a] - lo[a]).max(1e-3 * (hi - lo).max()))
        .product();
    let unit = if d == 3 {
        4.0 / 3.0 * std::f64::consts::PI
    } else {
        std::f64::consts::PI
    };
    let length = (neighbours * volume / (unit * rows.len() as f64)).powf(1.0 / d as f64) / support;
    if length > 0.0 { length } else { 1.0 }
}

fn dust(rows: &Rows, scene: &Scene) -> Result<Superparticles, String> {
    let Some(dust) = &scene.dust else {
        return Ok(Superparticles::default());
    };
    let n = rows.len();
    let mut grain_radius = column(rows, "GrainRadii");
    if grain_radius.is_empty() {
        grain_radius = match dust.sizes {
            Some(Sizes::One(radius)) => vec![radius; n],
            Some(Sizes::Range { .. }) => return Err("GrainRadii are missing; dust.size gives a range, which a file's grains cannot share".into()),
            None => vec![0.0; n],
        };
    }
    let mut grain_density = column(rows, "GrainDensities");
    if grain_density.is_empty() {
        grain_density = vec![dust.material_density; n];
    }
    if dust.drag.is_physical() && scene.coupling.gas_dust {
        let why = "the law of drag asks for the size and the density of grains";
        positive("GrainRadii", &grain_radius, why)?;
        positive("GrainDensities", &grain_density, why)?;
    }
    let sublimates = dust.composition.is_some_and(|c| c.sublimation);
    if sublimates {
        let why = "ice sublimates from the surface of grains";
        positive("GrainRadii", &grain_radius, why)?;
        let pure = |mixture: &nbody::points::Vec3| mixture.y + mixture.z <= 0.0;
        if let Some(i) = rows.composition.iter().position(pure) {
            return Err(format!(
                "Compositions: entry {i} (from 0) is nothing but ice, which leaves no core when it sublimates"
            ));
        }
    }
    let mut particles = Superparticles {
        id: rows.id.clone(),
        x: rows.x.clone(),
        v: rows.v.clone(),
        m: rows.m.clone(),
        grain_radius,
        grain_density,
        composition: match dust.composition {
            Some(_) => rows.composition.clone(),
            None => Vec::new(),
        },
        ..Default::default()
    };
    particles.resize(n);
    Ok(particles)
}

fn bodies(rows: &Rows, kind: Kind) -> Bodies {
    let radius = match (rows.more.get("Radii"), rows.more.get("Densities")) {
        (Some(radius), _) => radius.clone(),
        (None, Some(rho)) => rows
            .m
            .iter()
            .zip(rho)
            .map(|(m, rho)| (3.0 * m / (4.0 * std::f64::consts::PI * rho)).cbrt())
            .collect(),
        (None, None) => Vec::new(),
    };
    let massless = |(&m, &rho): (&f64, &f64)| if m == 0.0 { rho } else { 0.0 };
    let density = rows.more.get("Densities").map_or_else(Vec::new, |rho| {
        rows.m.iter().zip(rho).map(massless).collect()
    });
    let mut bodies = Bodies {
        id: rows.id.clone(),
        x: rows.x.clone(),
        v: rows.v.clone(),
        m: rows.m.clone(),
        radius,
        spin: rows.spin.clone(),
        composition: rows.composition.clone(),
        density,
        ..Default::default()
    };
    bodies.resize(rows.len());
    bodies.kind.fill(kind as u32);
    bodies
}
