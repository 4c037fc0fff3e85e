//! What an update of gas costs, as tables: CPU time of all threads a particle and step, whole step, by phase.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p tridisk-tests --bench gas -- box 1e4 1.1e5 1e6 2e6` (a periodic cube of a jittered lattice, by precision and
//! scheme, and the exponent of a step's cost in N), `... -- disk 1e5 5e5` (self-gravitating disk). Steps are short and common, so that
//! each is an update of every particle; set-up and the first step are left out.

use coupling::Phase;
use tridisk::stopwatch::Lap;
use tridisk::trial::Trial;
use tridisk_tests::workloads::{BOX, jitter};

/// Steps that are measured.
const STEPS: u32 = 3;

/// Schemes by name: what the scene says of the gas beside its blocks.
const SCHEMES: [(&str, &str); 5] = [
    ("density, constant viscosity", ""),
    ("density, Balsara", "[gas.viscosity]\nkind = \"balsara\"\n"),
    (
        "density, Cullen & Dehnen",
        "[gas.viscosity]\nkind = \"cullen-dehnen\"\n",
    ),
    (
        "density, Cullen & Dehnen, conduction",
        "[gas.viscosity]\nkind = \"cullen-dehnen\"\n[gas.conduction]\nalpha = 1.0\n",
    ),
    (
        "pressure, Cullen & Dehnen",
        "[gas.viscosity]\nkind = \"cullen-dehnen\"\n",
    ),
];

/// CPU time an update by phase, us: tree, gravity, density, hydro, and the whole step.
struct Cost {
    n: usize,
    phases: [f64; 4],
    whole: f64,
}

/// Runs a scene through a step that is left out and the steps that count.
fn cost(scene: &str, dt: f64, prepare: fn(&mut gas::Particles)) -> Cost {
    let end = f64::from(STEPS + 1) * dt;
    let text = format!("title = \"a bench\"\n[run]\nend_time = {end}\ntime_step = {dt}\n{scene}");
    let mut trial = Trial::new(&text, &[], prepare).unwrap_or_else(|refusal| panic!("{refusal}"));
    let mut marks: Vec<[Lap; 8]> = Vec::new();
    let done = trial.run(&[0.0, dt, end], |stop| marks.push(stop.watch.laps));
    done.unwrap_or_else(|fault| panic!("{fault}"));
    let n = trial.system.gas.len();
    let spent = |phase: Phase| {
        let [first, last] = [1, 2].map(|k: usize| marks[k][phase as usize].cpu_s);
        (last - first) / (n as f64 * f64::from(STEPS)) * 1e6
    };
    let phases = [Phase::Tree, Phase::Gravity, Phase::Density, Phase::Hydro];
    Cost {
        n,
        phases: phases.map(spent),
        whole: Phase::ALL.into_iter().map(spent).sum(),
    }
}

fn row(what: &str, precision: &str, cost: &Cost) {
    let Cost { n, phases, whole } = cost;
    let [tree, gravity, density, hydro] = phases;
    println!(
        "| {n} | {what} | {precision} | {density:.2} | {hydro:.2} | {tree:.2} | {gravity:.2} | {whole:.2} |"
    );
}

fn head() {
    println!(
        "| N | scheme | precision | density | forces, kicks | tree, drift | gravity | whole step, us |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
}

fn hydro(scheme: &str, precision: &str) -> String {
    let formulation = scheme.split(',').next().unwrap_or_default();
    format!("[gas.hydro]\nprecision = \"{precision}\"\nformulation = \"{formulation}\"\n")
}

fn boxes(numbers: &[f64]) {
    head();
    let mut steps = Vec::new();
    for &n in numbers {
        let side = n.cbrt().round();
        let spacing = format!("spacing = {}", 1.0 / side);
        let scene = BOX.replace("spacing = 0.08333333333333333", &spacing);
        for (scheme, tables) in SCHEMES {
            for precision in ["single", "double"] {
                let text = format!("{scene}{tables}{}", hydro(scheme, precision));
                let cost = cost(&text, 0.05 / side, jitter);
                if steps.len() < numbers.len() && scheme == SCHEMES[0].0 && precision == "double" {
                    steps.push((cost.n as f64, cost.n as f64 * cost.whole));
                }
                row(scheme, precision, &cost);
            }
        }
    }
    println!("\na step's cost grows as N to the {:.3}", slope(&steps));
}

/// The slope of the straight line through the logarithms.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let n = logs.len() as f64;
    let mean = |value: fn(&(f64, f64)) -> f64| logs.iter().map(value).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let cross: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    cross / logs.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

fn disks(numbers: &[f64]) {
    head();
    for &n in numbers {
        for precision in ["single", "double"] {
            let text = format!(
                r#"
[star]
mass = 1.0
accretion_radius = 10.0
[gas]
particles = {n}
[gas.disk]
mass = 0.1
slope = -1.0
inner_radius = 10.0
outer_radius = 100.0
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.05
reference_radius = 10.0
exponent = 0.25
[gas.viscosity]
kind = "cullen-dehnen"
[gravity]
force_error = 1e-3
{}"#,
                hydro("density", precision)
            );
            let cost = cost(&text, 0.1, |_| ());
            row("self-gravitating disk", precision, &cost);
        }
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let or = |default: &[f64]| match numbers.as_slice() {
        [] => default.to_vec(),
        given => given.to_vec(),
    };
    if words.iter().any(|word| word == "disk") {
        disks(&or(&[1e5]));
    } else {
        boxes(&or(&[1e4, 1.1e5]));
    }
}
