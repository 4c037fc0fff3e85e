//! What a checkpoint holds of a run: all that the next step needs, to the last bit.

use std::path::Path;

use coupling::ledger::{Census, Entry, Totals};
use coupling::stress::{Ring, Stress};
use coupling::system::Stray;
use coupling::torques::Braked;
use coupling::{Pace, System};
use dust::{Dust, Superparticles};
use gas::Solves;
use gas::background::Background;
use gas::{Gas, Particles};
use nbody::points::{Clock, Vec3};

use crate::checkpoint::{Checkpoint, Draft, Fact};
use crate::hdf::FileError;
use crate::populate;
use crate::scene::Scene;
use crate::stopwatch::{Lap, Stopwatch};

/// A run as a checkpoint knows it.
pub struct Saved {
    pub system: System,
    pub laps: [Lap; 8],
    pub wall_s: f64,
    /// Rows written so far to the run's histories.
    pub rows: Vec<u64>,
}

pub fn write(
    path: &Path,
    (scene, system): (&Scene, &System),
    watch: &Stopwatch,
    rows: &[u64],
) -> Result<(), FileError> {
    assert!(
        system.clock.synchronous(),
        "checkpoints are taken at the ends of base steps"
    );
    let mut draft = Draft::default();
    draft
        .set("gas", &system.gas.particles)
        .set("gas rates", &system.gas.rates);
    draft
        .set("dust", &system.dust.particles)
        .set("dust rates", &system.dust.rates);
    draft
        .set("bodies", &system.bodies)
        .set("star", &system.star);
    // Equations of state may need them before the next sums; of others nothing is kept.
    let densities = match needs_density(scene) {
        true => system.gas.derived.rho.clone(),
        false => Vec::new(),
    };
    draft.fact("gas densities", Fact::Reals(densities));
    if solves_pressure(scene) {
        let ratios = system.gas.derived.p_ratio.clone();
        draft.fact("gas pressure ratios", Fact::Reals(ratios));
    }
    let clock = &system.clock;
    draft.fact(
        "clock",
        Fact::Reals(vec![
            clock.start,
            clock.end,
            system.longest,
            system.bodies_step,
            system.drag_step,
        ]),
    );
    let pace = system.pace;
    draft.fact(
        "ticks",
        Fact::Integers(
            [clock.tick, pace.begin, pace.span, pace.end, pace.next_span]
                .map(u64::from)
                .to_vec(),
        ),
    );
    draft.fact("step", Fact::Integer(clock.step));
    draft.fact("pending star", Fact::Reals(flat(&system.pending_star)));
    draft.fact("pending bodies", Fact::Reals(flat(&system.pending_bodies)));
    draft.fact(
        "stray",
        Fact::Reals(flat(&[system.stray.impulse, system.stray.torque])),
    );
    draft.fact("next id", Fact::Integer(system.next_id));
    draft.fact("chosen", Fact::Integer(system.chosen));
    let background = system.gas.background;
    draft.fact(
        "background",
        Fact::Reals(vec![
            background.pressure,
            background.volume,
            background.work,
        ]),
    );
    draft.fact("integrator", Fact::Reals(system.memory.clone()));
    let ledger = &system.ledger;
    draft.fact("ledger initial", Fact::Reals(census_reals(&ledger.initial)));
    let mut sums = vec![ledger.initial_potential, ledger.radiated, ledger.dissipated];
    sums.extend(ledger.accreted);
    sums.extend(totals_reals(&ledger.given_away));
    draft.fact("ledger sums", Fact::Reals(sums));
    draft.fact(
        "floors",
        Fact::Integers(vec![ledger.floors, ledger.lopsided, ledger.whole]),
    );
    draft.fact(
        "operators",
        Fact::Text(
            ledger
                .entries
                .iter()
                .map(|e| e.operator.as_str())
                .collect::<Vec<_>>()
                .join("\n"),
        ),
    );
    draft.fact(
        "operators' changes",
        Fact::Reals(
            ledger
                .entries
                .iter()
                .flat_map(|e| census_reals(&e.change))
                .collect(),
        ),
    );
    draft.fact("rows", Fact::Integers(rows.to_vec()));
    if !system.gas.particles.target.is_empty() {
        let solves = &system.solves;
        let counts = [solves.count, solves.failed, solves.iterations, solves.most];
        draft.fact("solves", Fact::Integers(counts.to_vec()));
        let residuals = vec![solves.before, solves.after];
        draft.fact("residuals", Fact::Reals(residuals));
    }
    let braked = &system.braked;
    draft.fact(
        "braked",
        Fact::Integers(braked.impulses.iter().map(|(id, _)| *id).collect()),
    );
    let impulses: Vec<Vec3> = braked.impulses.iter().map(|(_, p)| *p).collect();
    draft.fact("braked since", Fact::Real(braked.since));
    draft.fact("braked impulses", Fact::Reals(flat(&impulses)));
    draft.fact("stress", Fact::Reals(stress_reals(&system.stress)));
    draft.fact("wall_s", Fact::Real(watch.wall_s()));
    draft.fact(
        "cpu_s",
        Fact::Reals(watch.laps.iter().map(|lap| lap.cpu_s).collect()),
    );
    let counts = watch
        .laps
        .iter()
        .flat_map(|lap| [lap.calls, lap.targets, lap.interactions]);
    draft.fact("counts", Fact::Integers(counts.collect()));
    draft.write(path)
}

/// Whether the gas needs the density that it had to go on.
fn needs_density(scene: &Scene) -> bool {
    let gas = scene.gas.as_ref();
    gas.is_some_and(|gas| {
        let hydro = populate::hydro(scene, gas);
        hydro.eos.follows_density() || hydro.exponent != 1.0
    })
}

/// Whether it needs the pressure.
fn solves_pressure(scene: &Scene) -> bool {
    let gas = scene.gas.as_ref();
    gas.is_some_and(|gas| populate::hydro(scene, gas).solves_pressure())
}

pub fn read(path: &Path, scene: &Scene) -> Result<Saved, FileError> {
    let file = Checkpoint::open(path)?;
    let mut system = System::new(scene.domain, scene.gravity.constant, 0.0);
    let (mut particles, mut rates) = (Particles::default(), gas::Rates::default());
    file.read_set("gas", &mut particles)?;
    file.read_set("gas rates", &mut rates)?;
    system.gas = Gas::restored(particles, rates);
    if needs_density(scene) {
        system.gas.derived.rho = file.reals("gas densities")?;
    }
    if solves_pressure(scene) {
        system.gas.derived.p_ratio = file.reals("gas pressure ratios")?;
    }
    let (mut particles, mut rates) = (Superparticles::default(), dust::Rates::default());
    file.read_set("dust", &mut particles)?;
    file.read_set("dust rates", &mut rates)?;
    system.dust = Dust::restored(particles, rates);
    file.read_set("bodies", &mut system.bodies)?;
    file.read_set("star", &mut system.star)?;
    let (clock, ticks) = (file.reals("clock")?, file.integers("ticks")?);
    let tick = |k: usize| ticks[k] as u32;
    system.clock = Clock {
        start: clock[0],
        end: clock[1],
        tick: tick(0),
        step: file.integer("step")?,
    };
    system.next = system.clock;
    system.pace = Pace {
        begin: tick(1),
        span: tick(2),
        end: tick(3),
        next_span: tick(4),
    };
    (system.longest, system.bodies_step) = (clock[2], clock[3]);
    system.drag_step = clock[4];
    system.look();
    system.pending_star = vectors(&file.reals("pending star")?);
    system.pending_bodies = vectors(&file.reals("pending bodies")?);
    let stray = vectors(&file.reals("stray")?);
    system.stray = Stray {
        impulse: stray[0],
        torque: stray[1],
    };
    system.next_id = file.integer("next id")?;
    system.chosen = file.integer("chosen")?;
    let background = file.reals("background")?;
    system.gas.background = Background {
        pressure: background[0],
        volume: background[1],
        work: background[2],
    };
    system.memory = file.reals("integrator")?;
    read_ledger(&file, &mut system)?;
    let (cpu, counts) = (file.reals("cpu_s")?, file.integers("counts")?);
    let lap = |k: usize| Lap {
        cpu_s: cpu[k],
        calls: counts[3 * k],
        targets: counts[3 * k + 1],
        interactions: counts[3 * k + 2],
    };
    read_braked(&file, &mut system)?;
    system.stress = stress_of(&file.reals("stress")?);
    if !system.gas.particles.target.is_empty() {
        system.solves = solves(&file)?;
    }
    Ok(Saved {
        system,
        laps: std::array::from_fn(lap),
        wall_s: file.real("wall_s")?,
        rows: file.integers("rows")?,
    })
}

/// What drag has given to planets since the last report.
fn read_braked(file: &Checkpoint, system: &mut System) -> Result<(), FileError> {
    let ids = file.integers("braked")?;
    let impulses = vectors(&file.reals("braked impulses")?);
    system.braked = Braked {
        since: file.real("braked since")?,
        impulses: ids.into_iter().zip(impulses).collect(),
    };
    Ok(())
}

fn stress_reals(stress: &Stress) -> Vec<f64> {
    let rings = stress.rings.iter();
    let averages = rings.flat_map(|ring| [ring.stress, ring.pressure]);
    [stress.inner, stress.width, stress.time]
        .into_iter()
        .chain(averages)
        .collect()
}

fn stress_of(reals: &[f64]) -> Stress {
    let ring = |averages: &[f64]| Ring {
        stress: averages[0],
        pressure: averages[1],
    };
    Stress {
        inner: reals[0],
        width: reals[1],
        time: reals[2],
        rings: reals[3..].chunks(2).map(ring).collect(),
    }
}

fn solves(file: &Checkpoint) -> Result<Solves, FileError> {
    let (counts, residuals) = (file.integers("solves")?, file.reals("residuals")?);
    Ok(Solves {
        count: counts[0],
        failed: counts[1],
        iterations: counts[2],
        most: counts[3],
        before: residuals[0],
        after: residuals[1],
    })
}

fn read_ledger(file: &Checkpoint, system: &mut System) -> Result<(), FileError> {
    let ledger = &mut system.ledger;
    ledger.initial = census_of(&file.reals("ledger initial")?);
    let sums = file.reals("ledger sums")?;
    (ledger.initial_potential, ledger.radiated, ledger.dissipated) = (sums[0], sums[1], sums[2]);
    ledger.accreted = [sums[3], sums[4], sums[5]];
    ledger.given_away = totals_of(&sums[6..]);
    let uses = file.integers("floors")?;
    (ledger.floors, ledger.lopsided, ledger.whole) = (uses[0], uses[1], uses[2]);
    let changes = file.reals("operators' changes")?;
    let names = file.text("operators")?;
    let names = names.lines().zip(changes.chunks(4 * TOTALS));
    ledger.entries = names
        .map(|(name, change)| Entry {
            operator: name.to_owned(),
            change: census_of(change),
        })
        .collect();
    Ok(())
}

/// Numbers in [`Totals`].
const TOTALS: usize = 11;

fn totals_reals(t: &Totals) -> [f64; TOTALS] {
    let (p, l) = (t.momentum, t.angular_momentum);
    [
        t.mass,
        p.x,
        p.y,
        p.z,
        l.x,
        l.y,
        l.z,
        t.kinetic,
        t.internal,
        t.momentum_scale,
        t.angular_scale,
    ]
}

fn totals_of(r: &[f64]) -> Totals {
    Totals {
        mass: r[0],
        momentum: Vec3::new(r[1], r[2], r[3]),
        angular_momentum: Vec3::new(r[4], r[5], r[6]),
        kinetic: r[7],
        internal: r[8],
        momentum_scale: r[9],
        angular_scale: r[10],
    }
}

fn census_reals(census: &Census) -> Vec<f64> {
    census.0.iter().flat_map(totals_reals).collect()
}

fn census_of(reals: &[f64]) -> Census {
    Census(std::array::from_fn(|k| totals_of(&reals[TOTALS * k..])))
}

fn flat(v: &[Vec3]) -> Vec<f64> {
    v.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

fn vectors(reals: &[f64]) -> Vec<Vec3> {
    reals
        .chunks(3)
        .map(|v| Vec3::new(v[0], v[1], v[2]))
        .collect()
}
