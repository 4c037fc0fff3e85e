//! What a run writes into its folder, and the checks it makes on the way.

use std::path::{Path, PathBuf};

use coupling::accretion::Event;
use coupling::ledger::Report;
use coupling::{Phase as Part, System};
use nbody::Bodies;
use nbody::points::{ColumnRef, Columns, Dimension, Domain, Fault, Label, Population, Vec3};

use super::RunError;
use crate::atomic::publish_bytes;
use crate::history::{
    EVENT_HEAD, LedgerRow, Phase, Solved, Table, Timings, operators, push_event, stress, torques,
};
use crate::populate::sublimation::kelvins;
use crate::scene::{Scene, Turbulence};
use crate::snapshot::{self, Group};
use crate::stopwatch::Stopwatch;

/// A history of a run: its file and its columns.
type History = (&'static str, &'static [&'static str]);

/// The histories that every run has.
const HISTORIES: [History; 3] = [
    ("ledger.csv", &LedgerRow::HEAD),
    ("operators.csv", &operators::HEAD),
    ("events.csv", &EVENT_HEAD),
];

/// The history that runs with planets among gas, dust or planetesimals have beside them.
const TORQUES: History = ("torques.csv", &torques::HEAD);

/// The history that runs have in which the stress of the gas stirs the dust.
const STRESS: History = ("stress.csv", &stress::HEAD);

/// The folder of a run with its open histories.
pub struct Folder {
    path: PathBuf,
    ledger: Table,
    operators: Table,
    events: Table,
    torques: Vec<Table>,
    stress: Vec<Table>,
    /// The least alpha that stirs.
    floor: f64,
}

impl Folder {
    /// The folder of a new run.
    pub fn new(path: &Path, scene: &Scene) -> Result<Self, RunError> {
        publish_bytes(&path.join("scene.toml"), scene.to_toml().as_bytes())?;
        Self::with(path, scene, |path, head, _| Table::create(path, head))
    }

    /// The folder of a run that goes on from a checkpoint at which the histories had `rows`.
    pub fn reopened(path: &Path, scene: &Scene, rows: &[u64]) -> Result<Self, RunError> {
        Self::with(path, scene, |path, head, k| {
            let rows = rows.get(k).copied().unwrap_or(0);
            Table::resume(path, head, rows)
        })
    }

    fn with(
        path: &Path,
        scene: &Scene,
        open: impl Fn(&Path, &[&str], usize) -> std::io::Result<Table>,
    ) -> Result<Self, RunError> {
        let table = |k: usize, (name, head): History| open(&path.join(name), head, k);
        let [ledger, operators, events] = [0, 1, 2].map(|k| table(k, HISTORIES[k]));
        let small = scene.planetesimals.as_ref().map_or(0, |p| p.number);
        let pulled = scene.gas.is_some() || scene.dust.is_some() || small > 0;
        // Torques are about the star, which a shearing box has not.
        let pulled = pulled && !scene.planets.is_empty() && scene.domain.hill().is_none();
        let torques = pulled.then(|| table(HISTORIES.len(), TORQUES));
        let turbulence = scene.dust.as_ref().map(|dust| dust.turbulence);
        let floor = match turbulence {
            Some(Turbulence::Measured { floor }) => Some(floor),
            _ => None,
        };
        let stress = floor.map(|_| table(HISTORIES.len() + usize::from(pulled), STRESS));
        Ok(Self {
            path: path.to_path_buf(),
            ledger: ledger?,
            operators: operators?,
            events: events?,
            torques: torques.into_iter().collect::<Result<_, _>>()?,
            stress: stress.into_iter().collect::<Result<_, _>>()?,
            floor: floor.unwrap_or(0.0),
        })
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Rows of the histories so far, all of them on the disk.
    pub fn rows(&self) -> Result<Vec<u64>, RunError> {
        let mut rows = Vec::new();
        for table in [&self.ledger, &self.operators, &self.events]
            .into_iter()
            .chain(&self.torques)
            .chain(&self.stress)
        {
            table.settle()?;
            rows.push(table.rows());
        }
        Ok(rows)
    }

    /// Writes the books as they stand, and the torques and the stress of this report.
    pub fn report(&mut self, row: &Report, system: &mut System) -> Result<(), RunError> {
        ledger_row(row).push_to(&mut self.ledger)?;
        let ledger = &system.ledger;
        operators::push(
            row.time,
            &ledger.initial,
            &ledger.entries,
            &mut self.operators,
        )?;
        let mut found = std::mem::take(&mut system.torques);
        found.extend(system.braked.settle(row.time));
        for table in &mut self.torques {
            torques::push(row.time, &found, system, table)?;
        }
        for table in &mut self.stress {
            stress::push(row.time, &system.stress, self.floor, table)?;
        }
        Ok(())
    }

    /// Writes what has happened since the last call.
    pub fn events(&mut self, events: &mut Vec<Event>) -> Result<(), RunError> {
        for event in events.drain(..) {
            push_event(&event, &mut self.events)?;
        }
        Ok(())
    }

    pub fn timings(&self, watch: &Stopwatch, system: &System) -> Result<(), RunError> {
        let phase = |part: Part| {
            let lap = watch.laps[part as usize];
            let counts = |n: u64| (part != Part::Tree && part != Part::Output).then_some(n);
            let interactions = (part == Part::Gravity).then_some(lap.interactions);
            (
                part.name(),
                Phase {
                    cpu_s: lap.cpu_s,
                    calls: lap.calls,
                    targets: counts(lap.targets),
                    interactions,
                },
            )
        };
        let timings = Timings {
            wall_s: watch.wall_s(),
            cpu_s: watch.cpu_s(),
            threads: rayon::current_num_threads(),
            steps: system.clock.step,
            phases: Part::ALL.map(phase).to_vec(),
            rearrangement: Solved::of(&system.solves),
        };
        Ok(timings.write(&self.path("timings.json"))?)
    }
}

/// Writes the state as it stands, closed at `now`.
pub fn snapshot(path: &Path, scene: &Scene, system: &System, now: f64) -> Result<(), RunError> {
    let extra = Extra::of(scene, system);
    snapshot::write(path, scene, now, &extra.groups(scene, system))?;
    Ok(())
}

fn ledger_row(report: &Report) -> LedgerRow {
    LedgerRow {
        time: report.time,
        mass_gas: report.mass[0],
        mass_dust: report.mass[1],
        mass_planetesimals: report.mass[2],
        mass_star: report.mass[3],
        momentum: report.momentum,
        angular_momentum: report.angular_momentum,
        kinetic_energy: report.kinetic,
        internal_energy: report.internal,
        potential_energy: report.potential,
        radiated_energy: report.radiated,
        accreted_gas: report.accreted[0],
        accreted_dust: report.accreted[1],
        accreted_planetesimals: report.accreted[2],
        error_mass: report.error_mass,
        error_momentum: report.error_momentum,
        error_angular_momentum: report.error_angular_momentum,
        error_energy: report.error_energy,
    }
}

/// Datasets of a snapshot that no population keeps.
struct Extra {
    temperatures: Vec<f64>,
    swarm_numbers: Vec<f64>,
    body_densities: Vec<f64>,
    accelerations: [Vec<Vec3>; 4],
    /// Empty where nothing pulls the gas.
    gravity_of_gas: Vec<Vec3>,
}

const TEMPERATURE: Label = Label::snapshot("Temperatures", Dimension::TEMPERATURE, "temperature");
const SWARM_NUMBER: Label = Label::snapshot("SwarmNumbers", Dimension::NONE, "grains in the swarm");
const BODY_DENSITY: Label = Label::snapshot(
    "Densities",
    Dimension::DENSITY,
    "mean density; zero for a point",
);
const ACCELERATION: Label = Label::snapshot(
    "Accelerations",
    Dimension::ACCELERATION,
    "acceleration by everything but drag",
);
const GRAVITY: Label = Label::snapshot(
    "GravitationalAccelerations",
    Dimension::ACCELERATION,
    "acceleration by gravity",
);
const POTENTIAL: Label = Label::snapshot(
    "Potentials",
    Dimension::SPECIFIC_ENERGY,
    "gravitational potential",
);

fn volume(radius: f64) -> f64 {
    4.0 / 3.0 * std::f64::consts::PI * radius.powi(3)
}

impl Extra {
    fn of(scene: &Scene, system: &System) -> Self {
        let (gas, dust, bodies) = (&system.gas, &system.dust.particles, &system.bodies);
        let mut extra = Self {
            temperatures: temperatures(scene, system),
            swarm_numbers: dust_numbers(&dust.m, &dust.grain_radius, &dust.grain_density),
            body_densities: (0..bodies.len()).map(|i| bodies.mean_density(i)).collect(),
            accelerations: Default::default(),
            gravity_of_gas: Vec::new(),
        };
        if scene.run.write_accelerations {
            let mut of_bodies = central_pulls(system);
            if gas.rates.gravity.len() + gas.rates.field.len() > 0 {
                extra.gravity_of_gas = (0..gas.len()).map(|i| gas.rates.attraction(i)).collect();
            }
            let frame = |x: Vec3, v: Vec3| match system.domain.hill() {
                Some(hill) => hill.acceleration(x, v),
                None => Vec3::zeros(),
            };
            let p = &gas.particles;
            let of_gas = |i: usize| gas.acceleration(i) + frame(p.x[i], p.v[i]);
            let of_dust = |i: usize| system.dust.rates.gravity[i] + frame(dust.x[i], dust.v[i]);
            let [vertical, middle] = crate::assemble::oscillation(scene);
            for ((a, x), v) in of_bodies.iter_mut().zip(&bodies.x).zip(&bodies.v) {
                *a += frame(*x, *v) + Vec3::z() * (vertical * vertical * (middle - x.z));
            }
            extra.accelerations = [
                (0..gas.len()).map(of_gas).collect(),
                (0..dust.len()).map(of_dust).collect(),
                of_bodies,
                system.star.a.clone(),
            ];
        }
        extra
    }

    fn groups<'a>(&'a self, scene: &Scene, system: &'a System) -> Vec<Group<'a>> {
        let mut groups = Vec::new();
        let (gas, dust) = (&system.gas, &system.dust);
        let moving = scene.run.write_accelerations;
        let forces =
            |group: Group<'a>, all: &'a [Vec3], gravity: &'a [Vec3], potential: &'a [f64]| {
                if !moving {
                    return group;
                }
                let group = group.with_column(ACCELERATION, ColumnRef::Vector(all));
                // What pulls in a shearing box is no gravity of masses, and has no potential here.
                if gravity.is_empty() || potential.is_empty() {
                    return group;
                }
                group
                    .with_column(GRAVITY, ColumnRef::Vector(gravity))
                    .with_column(POTENTIAL, ColumnRef::Real(potential))
            };
        let [a_gas, a_dust, a_bodies, a_star] = &self.accelerations;
        if !gas.is_empty() {
            let group = Group::new(0).with(&gas.particles).with(&gas.derived);
            let group = match self.temperatures.is_empty() {
                // What is no gas has none that is known.
                true => group,
                false => group.with_column(TEMPERATURE, ColumnRef::Real(&self.temperatures)),
            };
            groups.push(forces(
                group,
                a_gas,
                &self.gravity_of_gas,
                &gas.rates.potential,
            ));
        }
        if !system.bodies.is_empty() {
            let group = Group::new(1)
                .with(&system.bodies)
                .with_column(BODY_DENSITY, ColumnRef::Real(&self.body_densities));
            let pulls: &[Vec3] = match system.domain.hill() {
                Some(_) => &[],
                None => a_bodies,
            };
            groups.push(forces(group, a_bodies, pulls, &system.bodies.potential));
        }
        if !dust.is_empty() {
            let group = Group::new(2).with(&dust.particles).with(&dust.derived);
            let group = group.with_column(SWARM_NUMBER, ColumnRef::Real(&self.swarm_numbers));
            groups.push(forces(
                group,
                a_dust,
                &dust.rates.gravity,
                &dust.rates.potential,
            ));
        }
        if !system.star.is_empty() {
            let group = Group::new(4).with(&system.star);
            groups.push(forces(group, a_star, a_star, &system.star.potential));
        }
        groups
    }
}

fn dust_numbers(m: &[f64], radius: &[f64], density: &[f64]) -> Vec<f64> {
    let number = |i: usize| {
        let grain = density[i] * volume(radius[i]);
        if grain > 0.0 { m[i] / grain } else { 0.0 }
    };
    (0..m.len()).map(number).collect()
}

/// T = mu m_H c^2 / k_B with the isothermal sound speed c, in kelvin; without physical units, k_B = m_H = 1. None of what is no gas.
fn temperatures(scene: &Scene, system: &System) -> Vec<f64> {
    let weight = scene.gas.as_ref().and_then(|gas| gas.mean_molecular_weight);
    let Some(mean_molecular_weight) = weight else {
        return Vec::new();
    };
    let factor = if scene.units.system == crate::units::System::Dimensionless {
        mean_molecular_weight
    } else {
        kelvins(scene)
    };
    let d = &system.gas.derived;
    d.p.iter()
        .zip(&d.rho)
        .map(|(p, rho)| if *rho > 0.0 { factor * p / rho } else { 0.0 })
        .collect()
}

/// Accelerations of the bodies, the star's pull with them where their integrator has it.
fn central_pulls(system: &System) -> Vec<Vec3> {
    let bodies: &Bodies = &system.bodies;
    let mut a = bodies.a.clone();
    for (a, held) in a.iter_mut().zip(&system.held_back) {
        *a += held;
    }
    if !system.star_in_kick
        && let Some(&centre) = system.star.x.first()
    {
        for (a, x) in a.iter_mut().zip(&bodies.x) {
            let r = centre - x;
            *a += r * (system.g * system.star.m[0] / r.norm().powi(3));
        }
    }
    a
}

/// Whether every number that a snapshot would show is finite.
pub fn finite(system: &System, time: f64) -> Result<(), RunError> {
    let (gas, dust) = (&system.gas.particles, &system.dust.particles);
    let sets: [(Population, &dyn Columns, &[u64]); 4] = [
        (Population::Gas, gas, &gas.id),
        (Population::Dust, dust, &dust.id),
        (Population::Planetesimals, &system.bodies, &system.bodies.id),
        (Population::Star, &system.star, &system.star.id),
    ];
    for (population, set, ids) in sets {
        if let Some((quantity, i)) = set.non_finite() {
            return Err(Fault::NonFinite {
                population,
                id: ids[i],
                quantity,
                time,
            }
            .into());
        }
    }
    Ok(())
}

/// The largest relative errors of conserved sums that a run goes on with.
const BARS: [(&str, f64); 3] = [
    ("mass", 1e-10),
    ("momentum", 1e-2),
    ("angular momentum", 1e-2),
];

/// Whether what must be conserved is.
pub fn conserved(row: &Report, domain: &Domain) -> Result<(), RunError> {
    let errors = [
        row.error_mass,
        row.error_momentum,
        row.error_angular_momentum,
    ];
    for ((quantity, bar), error) in BARS.into_iter().zip(errors) {
        let kept = quantity != "angular momentum" || (0..3).all(|axis| domain.period(axis) == 0.0);
        if kept && (error.is_nan() || error.abs() > bar) {
            return Err(Fault::NotConserved {
                quantity,
                error,
                bar,
                time: row.time,
            }
            .into());
        }
    }
    Ok(())
}
