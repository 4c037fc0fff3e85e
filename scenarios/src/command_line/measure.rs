//! What `plan` and `trade` take from the command line.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, use_threads};
use crate::run::Outcome;
use crate::{plan, signals, trade, units};

pub const PLAN_HELP: &str = "A scene is started and advanced for a moment to see what its steps cost here; a large one is thinned out first.
Without a scene the numbers of a three-dimensional disk of gas particles are given (Makino 2013).

Examples:
  tridisk plan disk.toml --set gas.particles=1000000
  tridisk plan --particles 1e9 --years 1e5
  tridisk plan --seed-table";

#[derive(Args)]
pub struct PlanArguments {
    #[arg(required_unless_present_any = ["particles", "seed_table"])]
    scene: Option<PathBuf>,
    /// Override a key of the scene, with the file's own syntax
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Wall-clock time of the sample
    #[arg(long, default_value = "3 s", value_name = "TIME")]
    sample: String,
    /// Threads to use; all processors if not given
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Print the numbers of a scene's plan as JSON
    #[arg(long, conflicts_with_all = ["particles", "seed_table"])]
    json: bool,
    /// Number of gas particles, instead of a scene
    #[arg(long, value_name = "N", conflicts_with = "scene")]
    particles: Option<f64>,
    /// Years of the run
    #[arg(long, default_value_t = 1e6, value_name = "T")]
    years: f64,
    /// Operations an update
    #[arg(long, default_value_t = 1000.0)]
    operations: f64,
    /// Distance of neighbours, au; 1e-3 at 1e8 particles and with N^(-1/3) from there if not given
    #[arg(long, value_name = "AU")]
    spacing: Option<f64>,
    /// Sound speed, km/s
    #[arg(long, default_value_t = 1.0, value_name = "KM_S")]
    sound_speed: f64,
    /// Step by the sound crossing time of the spacing
    #[arg(long, default_value_t = 0.5)]
    courant: f64,
    /// Step in days, instead of that
    #[arg(long, value_name = "DAYS")]
    step: Option<f64>,
    /// Print the numbers of the slides beside recomputed ones
    #[arg(long, conflicts_with_all = ["scene", "particles"])]
    seed_table: bool,
}

pub const TRADE_HELP: &str = "Each setting is run in a shortened form of the scene, as long as the budget allows, and compared with a reference:
the tightest value of each knob whose tighter side is known, the scene's own of the others. Without --knob the scene
as it is and each knob that suits it alone are tried; with --knob all combinations. A call that was interrupted goes
on where it stopped when it is repeated. A star marks what no cheaper setting matches.

Errors: energy, angular_momentum, momentum, mass (ledger); position, eccentricity, inclination, torque (bodies);
gas_profile, dust_profile, dust_height (sums over rings by the whole).

Examples:
  tridisk trade disk.toml --budget \"5 min\"
  tridisk trade belt.toml --knob planetesimals.integrator=leapfrog,hybrid --knob accuracy.orbit_step=0.2,0.1,0.05
  tridisk trade belt.toml --knob accuracy.preset=draft,standard,precise --error energy=1e-7 --apply
  tridisk trade --presets scenarios";

#[derive(Args)]
pub struct TradeArguments {
    #[arg(required_unless_present = "presets")]
    scene: Option<PathBuf>,
    /// Derive the presets of accuracy from the shipped scenes in this folder, some minutes of CPU time
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scene", "knobs", "set", "errors", "within", "apply", "confirm", "reference", "budget", "full"])]
    presets: Option<PathBuf>,
    /// A key of the scene and the values to try; those that suit the scene if not given
    #[arg(long = "knob", value_name = "KEY.PATH=V1,V2,...")]
    knobs: Vec<String>,
    /// Override a key of the scene, with the file's own syntax
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Name the cheapest setting with at most this error, two standard errors included; may be given for several metrics
    #[arg(long = "error", value_name = "METRIC=VALUE", conflicts_with = "within")]
    errors: Vec<String>,
    /// Name the cheapest setting with at most this error in all metrics
    #[arg(long, value_name = "VALUE")]
    within: Option<f64>,
    /// Write that setting into the scene's file
    #[arg(long)]
    apply: bool,
    /// Run that setting and the reference again with this seed, and fail if its errors are larger then
    #[arg(long, value_name = "SEED")]
    confirm: Option<u64>,
    /// Folder for trade.csv, trade.png and the runs; trade/NAME if not given
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// What the settings are compared with
    #[arg(long, value_name = "KEY.PATH=VALUE,... | auto")]
    reference: Option<String>,
    /// Settings to run at a time, each on one thread; as many as there are processors if not given
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// CPU time that all runs together may take
    #[arg(long, default_value = "10 min", value_name = "TIME")]
    budget: String,
    /// Run the scene in its full length and size, whatever that takes
    #[arg(long, conflicts_with = "budget")]
    full: bool,
    /// Say nothing but the table and errors
    #[arg(long)]
    quiet: bool,
}

pub fn plan_scene(arguments: &PlanArguments) -> Result<(), Failure> {
    if arguments.seed_table {
        print!("{}", plan::seed::table());
        return Ok(());
    }
    use_threads(arguments.threads);
    let Some(scene) = &arguments.scene else {
        print!("{}", plan::of_number(&particles(arguments)?)?);
        return Ok(());
    };
    let seconds = duration("--sample", &arguments.sample)?;
    let say = match arguments.json {
        true => plan::numbers,
        false => plan::of_scene,
    };
    let text = rayon::scope(|_| say(scene, &arguments.set, seconds))?;
    print!("{text}");
    Ok(())
}

/// The disk of particles that the arguments describe.
fn particles(arguments: &PlanArguments) -> Result<plan::seed::Particles, Failure> {
    let slide = plan::seed::Particles::default();
    let number = arguments.particles.unwrap_or(slide.number);
    let by_number = || slide.spacing * (slide.number / number).cbrt();
    let plan = plan::seed::Particles {
        number,
        spacing: arguments.spacing.unwrap_or_else(by_number),
        sound_speed: arguments.sound_speed,
        years: arguments.years,
        operations: arguments.operations,
        step: arguments.step,
        courant: arguments.courant,
    };
    for (name, value) in [
        ("--particles", plan.number),
        ("--spacing", plan.spacing),
        ("--sound-speed", plan.sound_speed),
        ("--years", plan.years),
        ("--operations", plan.operations),
        ("--step", plan.step.unwrap_or(1.0)),
        ("--courant", plan.courant),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            let sentence = format!("{name} {value}: must be a finite number greater than 0");
            return Err(Failure::Refused(sentence));
        }
    }
    Ok(plan)
}

/// A wall-clock or CPU time in seconds, given as an argument.
fn duration(name: &str, text: &str) -> Result<f64, Failure> {
    match units::seconds(text) {
        Ok(seconds) if seconds > 0.0 && seconds.is_finite() => Ok(seconds),
        Ok(_) => Err(Failure::Refused(format!(
            "{name} {text}: must be a finite time greater than 0"
        ))),
        Err(sentence) => Err(Failure::Refused(format!("{name} {text}: {sentence}"))),
    }
}

pub fn trade_scene(arguments: TradeArguments) -> Result<Outcome, Failure> {
    let budget = duration("--budget", &arguments.budget)?;
    let processors = std::thread::available_parallelism().map_or(1, |count| count.get());
    // What is sampled here costs what it will cost its own process: one thread.
    use_threads(Some(1));
    signals::listen();
    let request = trade::Request {
        scene: arguments.scene.unwrap_or_default(),
        knobs: arguments.knobs,
        set: arguments.set,
        errors: arguments.errors,
        within: arguments.within,
        apply: arguments.apply,
        confirm: arguments.confirm,
        output: arguments.output,
        reference: arguments.reference,
        threads: arguments.threads.map_or(processors, usize::from),
        budget,
        full: arguments.full,
        quiet: arguments.quiet,
    };
    Ok(rayon::scope(|_| match &arguments.presets {
        Some(folder) => trade::presets::derive(&request, folder),
        None => trade::trade(&request),
    })?)
}
