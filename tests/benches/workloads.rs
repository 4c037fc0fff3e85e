//! Workloads that are measured: small scenes of every kind that take a number of equal steps.

use std::f64::consts::TAU;

use gas::Particles;
use nbody::points::random::{Purpose, stream};
use nbody::points::{Domain, Vec3};
use rand::RngExt;
use tridisk::trial::Trial;

/// A workload: a name, its scene but for `[run]` in two parts, and the length of its step.
pub struct Workload {
    pub name: &'static str,
    base: &'static str,
    more: &'static str,
    step: f64,
    prepare: fn(&mut Particles),
}

/// A periodic cube of 12^3 particles, to be jittered.
pub const BOX: &str = r#"
[units]
system = "dimensionless"
[domain]
kind = "periodic"
size = [1.0, 1.0, 1.0]
[[gas.block]]
lo = [0.0, 0.0, 0.0]
hi = [1.0, 1.0, 1.0]
lattice = "cubic"
spacing = 0.08333333333333333
density = 1.0
pressure = 1.0
"#;

/// A belt of 2000 massive bodies; the integrator is to be named.
const PLANETESIMALS: &str = r#"
[star]
mass = "1 Msun"
[planetesimals]
number = 2000
total_mass = "10 Mearth"
inner_radius = "0.5 au"
outer_radius = "1.5 au"
eccentricity = 0.01
inclination = 0.005
density = "2 g/cm^3"
"#;

/// All workloads.
pub const ALL: &[Workload] = &[
    Workload {
        name: "gas, constant viscosity, double",
        base: BOX,
        more: "[gas.viscosity]\nkind = \"constant\"\n",
        step: 0.004,
        prepare: jitter,
    },
    Workload {
        name: "gas, constant viscosity, single",
        base: BOX,
        more: "[gas.hydro]\nprecision = \"single\"\n[gas.viscosity]\nkind = \"constant\"\n",
        step: 0.004,
        prepare: jitter,
    },
    Workload {
        name: "gas, Cullen & Dehnen, double",
        base: BOX,
        more: "[gas.viscosity]\nkind = \"cullen-dehnen\"\n",
        step: 0.004,
        prepare: jitter,
    },
    Workload {
        name: "gas with its gravity",
        base: "",
        more: r#"
[units]
system = "dimensionless"
[[gas.block]]
lo = [-0.5, -0.5, -0.5]
hi = [0.5, 0.5, 0.5]
lattice = "cubic"
spacing = 0.08333333333333333
density = 1.0
pressure = 1.0
[gravity]
force_error = 1e-3
"#,
        step: 0.004,
        prepare: as_they_are,
    },
    Workload {
        name: "grains in gas",
        base: BOX,
        more: r#"
[[dust.block]]
lo = [0.0, 0.0, 0.0]
hi = [1.0, 1.0, 1.0]
lattice = "cubic"
spacing = 0.1
density = 1.0
velocity = [0.1, 0.0, 0.0]
[dust.drag]
law = "constant-stopping-time"
stopping_time = 0.001
"#,
        step: 0.004,
        prepare: jitter,
    },
    Workload {
        name: "planetesimals, leapfrog",
        base: PLANETESIMALS,
        more: "integrator = \"leapfrog\"\n",
        step: 0.01,
        prepare: as_they_are,
    },
    Workload {
        name: "planetesimals, hybrid",
        base: PLANETESIMALS,
        more: "integrator = \"hybrid\"\n",
        step: 0.05,
        prepare: as_they_are,
    },
];

fn as_they_are(_: &mut Particles) {}

/// Moves each particle by up to a fifth of the lattice's spacing, and sets all in a solenoidal motion.
pub fn jitter(gas: &mut Particles) {
    let domain = Domain::periodic(Vec3::repeat(1.0));
    let spacing = (gas.x.len() as f64).powf(-1.0 / 3.0);
    for i in 0..gas.x.len() {
        let mut random = stream(1, Purpose::GasPositions, gas.id[i], 0);
        gas.x[i] += Vec3::from_fn(|_, _| 0.4 * spacing * (random.random::<f64>() - 0.5));
        domain.wrap(&mut gas.x[i]);
        let (a, b) = ((TAU * gas.x[i].x).sin_cos(), (TAU * gas.x[i].y).sin_cos());
        gas.v[i] = 0.3 * Vec3::new(a.0 * b.1, -a.1 * b.0, 0.0);
    }
}

/// Takes `steps` of the named workload. Returns the energy error.
pub fn run(name: &str, steps: usize) -> f64 {
    let workload = ALL.iter().find(|workload| workload.name == name);
    let workload = workload.unwrap_or_else(|| panic!("no workload {name}"));
    let end = steps as f64 * workload.step;
    let Workload {
        base, more, step, ..
    } = workload;
    let text =
        format!("title = \"{name}\"\n[run]\nend_time = {end}\ntime_step = {step}\n{base}{more}");
    let trial = Trial::new(&text, &[], workload.prepare);
    let mut trial = trial.unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
    let mut error = f64::NAN;
    let done = trial.run(&[0.0, end], |stop| {
        error = stop.books.error_energy;
    });
    done.unwrap_or_else(|fault| panic!("{name}: {fault}"));
    error
}
