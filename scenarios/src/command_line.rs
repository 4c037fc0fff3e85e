//! The command line: what each command takes, and how the program ends (0 done, 1 failed, 2 refused, 128 + signal interrupted).

mod measure;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, Parser, Subcommand};

use crate::run::{self, Options, Outcome, RunError};
use crate::scene::Scene;
use crate::{info, memory, new, outline, plot, sample, signals, verify};
use measure::{PLAN_HELP, PlanArguments, TRADE_HELP, TradeArguments, plan_scene, trade_scene};

/// Protoplanetary disks of gas, dust and planetesimals that act on each other.
#[derive(Parser)]
#[command(
    name = "tridisk",
    version,
    subcommand_required = true,
    arg_required_else_help = true,
    after_help = "Examples:
  tridisk new disk disk.toml                    a commented scene to start from
  tridisk check disk.toml                       what will be modelled, how large it is
  tridisk run disk.toml --set run.end_time=\"2 yr\"
  tridisk resume runs/disk --end-time \"5 yr\"    go on where a run stopped
  tridisk info runs/disk/snapshot_0003.hdf5     what a file holds
  tridisk plot runs/disk                        pictures of the newest snapshot and the ledger
  tridisk plan disk.toml                        what the run takes and can be trusted with
  tridisk trade disk.toml --budget \"5 min\"       which settings are worth their price
  tridisk sample runs/disk/snapshot_0003.hdf5 points.txt   gas and its gradients at points
  tridisk verify stirring                       a built-in problem against its published answer

Exit status: 0 done, 1 the run failed, 2 the scene or the arguments are wrong, 130 and 143 interrupted."
)]
struct CommandLine {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene
    #[command(
        after_help = "Example:\n  tridisk run disk.toml --output runs/long --set gas.particles=100000 --threads 2"
    )]
    Run(RunArguments),
    /// Go on from the newest checkpoint of a run, as if it had not stopped
    #[command(after_help = "Example:\n  tridisk resume runs/disk --end-time \"20 yr\"")]
    Resume(ResumeArguments),
    /// Validate a scene without running it, and say what it models
    #[command(after_help = "Example:\n  tridisk check disk.toml --set gas.hydro.neighbours=100")]
    Check {
        scene: PathBuf,
        /// Override a key of the scene, with the file's own syntax
        #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
    },
    /// Write a commented scene to start from; without a template list them
    #[command(after_help = "Example:\n  tridisk new disk my_disk.toml")]
    New {
        template: Option<String>,
        /// File to write, `-` for standard output; TEMPLATE.toml if not given
        file: Option<PathBuf>,
    },
    /// Say what a snapshot, a checkpoint or a run's folder holds
    #[command(
        after_help = "Examples:\n  tridisk info runs/disk\n  tridisk info runs/disk --ledger"
    )]
    Info {
        #[arg(value_name = "FILE_OR_DIR")]
        path: PathBuf,
        /// What each operator of a run has changed, by population, as the last report has it
        #[arg(long)]
        ledger: bool,
    },
    /// Draw PNG pictures of a snapshot or of a run's folder
    #[command(after_help = "Example:\n  tridisk plot runs/disk --output pictures")]
    Plot {
        #[arg(value_name = "FILE_OR_DIR")]
        path: PathBuf,
        /// Folder for the pictures; that of the snapshot if not given
        #[arg(long)]
        output: Option<PathBuf>,
    },
    /// Print density, velocity, temperature and gradients of a snapshot's gas at given points, as CSV
    #[command(
        after_help = "Example:\n  echo 1.0 0.2 0.0 | tridisk sample runs/disk/snapshot_0003.hdf5 -"
    )]
    Sample {
        snapshot: PathBuf,
        /// Text of x y z a line, in code units of the snapshot; `-` for standard input
        points: PathBuf,
        /// Write an HDF5 file instead
        #[arg(long, value_name = "FILE.hdf5")]
        output: Option<PathBuf>,
    },
    /// Say what a run takes and what it can be trusted with, before it is run
    #[command(after_help = PLAN_HELP)]
    Plan(PlanArguments),
    /// Measure error against cost over settings of a scene, and say which are worth their price
    #[command(after_help = TRADE_HELP)]
    Trade(TradeArguments),
    /// Run built-in problems against their exact or published answers and print tables; all of them without a name
    #[command(
        after_help = "Examples:\n  tridisk verify stirring\n  tridisk verify gas --set gas.viscosity.kind=balsara --pictures pictures\n  tridisk verify gas-sod --recommended"
    )]
    Verify {
        names: Vec<String>,
        /// Run the problems of the gas by the scheme recommended for shocks, contacts and vortices alike
        #[arg(long)]
        recommended: bool,
        /// Override a key of gas.hydro, gas.viscosity or gas.conduction in the problems of the gas
        #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
        set: Vec<String>,
        /// Folder for a picture of each problem of the gas
        #[arg(long, value_name = "DIR")]
        pictures: Option<PathBuf>,
    },
}

#[derive(Args)]
struct RunArguments {
    scene: PathBuf,
    /// Folder of the run; runs/NAME if not given, NAME being that of the scene
    #[arg(long)]
    output: Option<PathBuf>,
    /// Override a key of the scene, with the file's own syntax
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    /// Threads to use; all processors if not given
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// End the run at this time instead of run.end_time
    #[arg(long, value_name = "TIME")]
    end_time: Option<String>,
    /// Say nothing but errors
    #[arg(long)]
    quiet: bool,
    /// Remove the files of an earlier run from the folder
    #[arg(long)]
    force: bool,
}

#[derive(Args)]
struct ResumeArguments {
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// End the run at this time instead of run.end_time
    #[arg(long, value_name = "TIME")]
    end_time: Option<String>,
    /// Threads to use; all processors if not given
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Say nothing but errors
    #[arg(long)]
    quiet: bool,
}

/// Why a command did not do what it was asked to.
enum Failure {
    Refused(String),
    Failed(String),
}

impl From<RunError> for Failure {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Refused(sentence) => Failure::Refused(sentence),
            other => Failure::Failed(other.to_string()),
        }
    }
}

/// Does what the arguments say.
pub fn main() -> ExitCode {
    std::panic::set_hook(Box::new(|broken| {
        let what = broken.payload_as_str().unwrap_or("no reason given");
        let place = broken
            .location()
            .map(|place| format!(" ({}:{})", place.file(), place.line()));
        eprintln!(
            "error: tridisk broke a promise of its own: {what}{}",
            place.unwrap_or_default()
        );
        std::process::exit(1);
    }));
    memory::keep_apart();
    let outcome = match CommandLine::parse().command {
        Command::Run(arguments) => run_scene(arguments),
        Command::Resume(arguments) => resume(arguments),
        Command::Trade(arguments) => trade_scene(arguments),
        other => {
            signals::end_on_broken_pipe();
            look(other).map(|()| Outcome::Done)
        }
    };
    match outcome {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Interrupted(signal)) => ExitCode::from(signals::status(signal)),
        Err(Failure::Refused(sentence)) => {
            eprintln!("error: {sentence}");
            ExitCode::from(2)
        }
        Err(Failure::Failed(sentence)) => {
            eprintln!("error: {sentence}");
            ExitCode::from(1)
        }
    }
}

/// The commands that run no scene.
fn look(command: Command) -> Result<(), Failure> {
    match command {
        Command::Check { scene, set } => {
            let scene = load(&scene, &set)?;
            print!("{}", outline::outline(&scene)?);
            Ok(())
        }
        Command::New { template, file } => {
            let message =
                new::write(template.as_deref(), file.as_deref()).map_err(Failure::Refused)?;
            print!("{message}");
            Ok(())
        }
        Command::Plan(arguments) => plan_scene(&arguments),
        Command::Info { path, ledger } => {
            let text = match ledger {
                true => info::ledger(&path),
                false => info::describe(&path),
            };
            print!("{}", text.map_err(Failure::Refused)?);
            Ok(())
        }
        Command::Plot { path, output } => {
            for picture in plot::draw(&path, output.as_deref()).map_err(Failure::Refused)? {
                println!("{}", picture.display());
            }
            Ok(())
        }
        Command::Verify {
            names,
            recommended,
            set,
            pictures,
        } => {
            let all = verify::verify(&names, recommended, &set, pictures.as_deref());
            if all.map_err(Failure::Refused)? {
                return Ok(());
            }
            let sentence = "a problem has left its acceptable bars";
            Err(Failure::Failed(sentence.to_owned()))
        }
        Command::Sample {
            snapshot,
            points,
            output,
        } => {
            let samples = sample::sample(&snapshot, &points, output.as_deref());
            print!("{}", samples.map_err(Failure::Refused)?);
            Ok(())
        }
        Command::Run(_) | Command::Resume(_) | Command::Trade(_) => {
            unreachable!("these run something")
        }
    }
}

fn load(path: &Path, set: &[String]) -> Result<Scene, Failure> {
    Scene::load(path, set).map_err(|refusal| Failure::Refused(refusal.to_string()))
}

fn run_scene(arguments: RunArguments) -> Result<Outcome, Failure> {
    let mut scene = load(&arguments.scene, &arguments.set)?;
    if let Some(text) = &arguments.end_time {
        scene.run.end_time = end_time(text, &scene)?;
    }
    let default = || Path::new("runs").join(&scene.name);
    let output = arguments.output.unwrap_or_else(default);
    clear(&output, arguments.force)?;
    use_threads(arguments.threads);
    signals::listen();
    let options = Options {
        output,
        end_time: None,
        quiet: arguments.quiet,
    };
    // Inside the pool loops begin without waking another thread.
    Ok(rayon::scope(|_| run::run(scene, &options))?)
}

fn resume(arguments: ResumeArguments) -> Result<Outcome, Failure> {
    let file = arguments.folder.join("scene.toml");
    if !file.is_file() {
        let sentence = format!(
            "{} is no folder of a run: it has no scene.toml",
            arguments.folder.display()
        );
        return Err(Failure::Refused(sentence));
    }
    let scene = load(&file, &[])?;
    let text = arguments.end_time.as_deref();
    let options = Options {
        end_time: text.map(|text| end_time(text, &scene)).transpose()?,
        output: arguments.folder,
        quiet: arguments.quiet,
    };
    use_threads(arguments.threads);
    signals::listen();
    Ok(rayon::scope(|_| run::resume(&options.output, &options))?)
}

fn end_time(text: &str, scene: &Scene) -> Result<f64, Failure> {
    match scene.units.time(text) {
        Ok(time) if time > 0.0 => Ok(time),
        Ok(_) => Err(Failure::Refused(format!(
            "--end-time {text}: must be greater than 0"
        ))),
        Err(sentence) => Err(Failure::Refused(format!("--end-time {text}: {sentence}"))),
    }
}

fn use_threads(threads: Option<u16>) {
    if let Some(threads) = threads {
        // It fails only if a pool exists already, and nothing has made one yet.
        let _ = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global();
    }
}

/// Whether a file of this name is one that a run writes.
fn of_a_run(name: &str) -> bool {
    let snapshot = name.starts_with("snapshot_") && name.ends_with(".hdf5");
    let other = [
        "scene.toml",
        "checkpoint.hdf5",
        "ledger.csv",
        "events.csv",
        "timings.json",
    ];
    snapshot || other.contains(&name) || name.ends_with(".hdf5.tmp")
}

/// Makes the folder of a run; refuses one that holds a run, unless its files may be removed.
fn clear(folder: &Path, force: bool) -> Result<(), Failure> {
    let wrong = |error: std::io::Error| {
        Failure::Refused(format!(
            "the folder {} cannot be used: {error}",
            folder.display()
        ))
    };
    fs::create_dir_all(folder).map_err(wrong)?;
    for entry in fs::read_dir(folder).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let name = entry.file_name();
        let Some(name) = name.to_str().filter(|name| of_a_run(name)) else {
            continue;
        };
        if force {
            fs::remove_file(entry.path()).map_err(wrong)?;
        } else if name.ends_with(".hdf5") {
            return Err(Failure::Refused(format!(
                "the folder {} holds a run already: give another by --output, go on with it by `tridisk resume`, or remove it by --force",
                folder.display()
            )));
        }
    }
    Ok(())
}
