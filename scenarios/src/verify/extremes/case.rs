//! A case: a scene at an extreme, run as the program runs it into a folder that is removed afterwards, and what must hold of it.

use std::any::Any;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;
use std::{fs, panic, thread};

use super::start::Start;
use crate::history;
use crate::run::{self, Options, Outcome};
use crate::scene::Scene;
use crate::snapshot::{self, Contents, Particles};

/// Wall-clock time after which a case counts as one that does not end, s.
const PATIENCE: u64 = 200;

/// The largest relative error of the mass of any case.
const MASS: f64 = 1e-13;

/// A run that has ended: its ledger, and its snapshots of the start and of the end.
pub struct End {
    ledger: Vec<(String, Vec<f64>)>,
    first: Contents,
    last: Contents,
}

impl End {
    /// The largest size of a column of the ledger; not a number if there is one that is none.
    pub fn largest(&self, column: &str) -> f64 {
        let found = self.ledger.iter().find(|(name, _)| name == column);
        let (_, values) = found.unwrap_or_else(|| panic!("a ledger has the column {column}"));
        values
            .iter()
            .map(|x| x.abs())
            .fold(0.0, |a, b| if a >= b { a } else { b })
    }

    /// The last value of a column of the ledger.
    pub fn final_value(&self, column: &str) -> f64 {
        let found = self.ledger.iter().find(|(name, _)| name == column);
        let last = found.and_then(|(_, values)| values.last());
        *last.unwrap_or(&f64::NAN)
    }

    /// A population at the end, empty if there is none.
    pub fn rows(&self, part_type: usize) -> Particles {
        self.last.group(part_type).cloned().unwrap_or_default()
    }

    /// The same at the start.
    pub fn start(&self, part_type: usize) -> Particles {
        self.first.group(part_type).cloned().unwrap_or_default()
    }

    /// Particles of all populations but the star.
    fn number(&self) -> usize {
        let groups = self.last.groups.iter().filter(|rows| rows.part_type != 4);
        groups.map(Particles::len).sum()
    }
}

/// A figure of a run, and the bar that it must not pass.
struct Bound {
    what: &'static str,
    bar: f64,
    figure: Box<dyn Fn(&End) -> f64 + Send + Sync>,
}

/// What must hold.
enum Holds {
    /// The run ends, and every figure is within its bar.
    Ends(Vec<Bound>),
    /// The scene is refused, or the run fails, in these words, in which `~` stands for anything.
    Refused(String),
}

pub struct Case {
    pub name: String,
    /// Too long for a test.
    pub is_long: bool,
    text: String,
    start: Option<Start>,
    holds: Holds,
}

/// How a case came out.
pub struct Judgement {
    pub name: String,
    pub must_hold: String,
    pub measured: String,
    pub kept: bool,
}

impl Case {
    /// A scene that must run to its end, with all its mass.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let case = Self {
            name: name.into(),
            is_long: false,
            text: text.into(),
            start: None,
            holds: Holds::Ends(Vec::new()),
        };
        case.figure("mass", MASS, |end| end.largest("error_mass"))
    }

    /// A scene that must be refused in these words, in which `~` stands for anything.
    pub fn refused(
        name: impl Into<String>,
        text: impl Into<String>,
        sentence: impl Into<String>,
    ) -> Self {
        Self {
            holds: Holds::Refused(sentence.into()),
            ..Self::new(name, text)
        }
    }

    /// Begins from a file beside the scene.
    pub fn from(mut self, start: Start) -> Self {
        self.text = format!("[initial]\nfile = \"start.hdf5\"\n{}", self.text);
        self.start = Some(start);
        self
    }

    /// Takes too long for a test.
    pub fn long(mut self) -> Self {
        self.is_long = true;
        self
    }

    /// A figure that must be finite and at most `bar`.
    pub fn figure(
        mut self,
        what: &'static str,
        bar: f64,
        figure: impl Fn(&End) -> f64 + Send + Sync + 'static,
    ) -> Self {
        if let Holds::Ends(bounds) = &mut self.holds {
            let figure = Box::new(figure);
            bounds.push(Bound { what, bar, figure });
        }
        self
    }

    /// The largest error of a conserved sum.
    pub fn momentum(self, bar: f64) -> Self {
        self.figure("momentum", bar, |end| end.largest("error_momentum"))
    }

    pub fn angular_momentum(self, bar: f64) -> Self {
        self.figure("angular momentum", bar, |end| {
            end.largest("error_angular_momentum")
        })
    }

    pub fn energy(self, bar: f64) -> Self {
        self.figure("energy", bar, |end| end.largest("error_energy"))
    }

    /// The number of particles and bodies at the end.
    pub fn left(self, number: usize) -> Self {
        self.figure("particles more or less", 0.0, move |end| {
            end.number() as f64 - number as f64
        })
    }

    /// Runs the case.
    pub fn judgement(&self) -> Judgement {
        let outcome = self.outcome();
        let (must_hold, measured, kept) = match (&self.holds, outcome) {
            (Holds::Ends(bounds), Ok(end)) => judged(bounds, &end),
            (Holds::Ends(bounds), Err(sentence)) => (bars(bounds), sentence, false),
            (Holds::Refused(words), Ok(_)) => (said(words), "it ran to its end".into(), false),
            (Holds::Refused(words), Err(sentence)) => {
                let kept = is_like(words, &sentence);
                let measured = if kept { "so refused".into() } else { sentence };
                (said(words), measured, kept)
            }
        };
        Judgement {
            name: self.name.clone(),
            must_hold,
            measured,
            kept,
        }
    }

    /// Runs the case in a thread of its own; the sentence if it was refused, failed, broke a promise or did not end.
    fn outcome(&self) -> Result<End, String> {
        let (tell, told) = mpsc::channel();
        let (text, start) = (self.text.clone(), self.start.clone());
        thread::spawn(move || {
            let done = panic::catch_unwind(|| attempt(&text, start.as_ref()));
            // Nobody listens to one that came too late.
            let _ = tell.send(done.unwrap_or_else(|broken| Err(promise(&*broken))));
        });
        told.recv_timeout(Duration::from_secs(PATIENCE))
            .unwrap_or_else(|_| Err(format!("has not ended after {PATIENCE} s")))
    }
}

/// The words that the program has for a panic.
fn promise(broken: &(dyn Any + Send)) -> String {
    let text = broken.downcast_ref::<String>().map(String::as_str);
    let text = text.or(broken.downcast_ref::<&str>().copied());
    let reason = text.unwrap_or("no reason given");
    format!("tridisk broke a promise of its own: {reason}")
}

fn said(words: &str) -> String {
    format!("refused: {words}")
}

fn bars(bounds: &[Bound]) -> String {
    let each = bounds.iter().map(|bound| match bound.bar {
        0.0 => format!("{} 0", bound.what),
        bar => format!("{} {bar:.1e}", bound.what),
    });
    each.collect::<Vec<_>>().join(", ")
}

/// What must hold, what was found, and whether the one is within the other.
fn judged(bounds: &[Bound], end: &End) -> (String, String, bool) {
    let found: Vec<(&Bound, f64)> = bounds.iter().map(|b| (b, (b.figure)(end))).collect();
    let shown = found.iter().map(|(bound, size)| {
        let passed = if size.abs() <= bound.bar { "" } else { " !" };
        format!("{} {size:.1e}{passed}", bound.what)
    });
    (
        bars(bounds),
        shown.collect::<Vec<_>>().join(", "),
        found.iter().all(|(bound, size)| size.abs() <= bound.bar),
    )
}

/// Whether a sentence has these words, `~` standing for anything.
fn is_like(words: &str, sentence: &str) -> bool {
    let mut parts = words.split('~');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = sentence.strip_prefix(first) else {
        return false;
    };
    let parts: Vec<&str> = parts.collect();
    let Some((last, middle)) = parts.split_last() else {
        return rest.is_empty();
    };
    for part in middle {
        let Some(place) = rest.find(part) else {
            return false;
        };
        rest = &rest[place + part.len()..];
    }
    rest.ends_with(last)
}

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, String> {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("tridisk-extremes-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self(path))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Runs a scene from its file, as the program does; folders are left out of sentences.
fn attempt(text: &str, start: Option<&Start>) -> Result<End, String> {
    let folder = Folder::new()?;
    let place = format!("{}/", folder.0.display());
    let named = |sentence: String| sentence.replace(&place, "");
    let file = folder.0.join("case.toml");
    fs::write(&file, text).map_err(|error| error.to_string())?;
    if let Some(start) = start {
        let path = folder.0.join("start.hdf5");
        start.write(&path).map_err(|error| error.to_string())?;
    }
    let scene = Scene::load(&file, &[]).map_err(|refusal| named(refusal.to_string()))?;
    let options = Options {
        output: folder.0.clone(),
        end_time: None,
        quiet: true,
    };
    match run::run(scene, &options) {
        Ok(Outcome::Done) => ending(&folder.0).map_err(named),
        Ok(other) => Err(format!("{other:?}")),
        Err(error) => Err(named(error.to_string())),
    }
}

fn ending(folder: &Path) -> Result<End, String> {
    let ledger = history::read_numbers(&folder.join("ledger.csv"));
    let read = |number: usize| {
        let path = folder.join(format!("snapshot_{number:04}.hdf5"));
        snapshot::read(&path, None).map_err(|error| error.to_string())
    };
    let number = (0..).take_while(|k| folder.join(format!("snapshot_{k:04}.hdf5")).is_file());
    Ok(End {
        ledger: ledger.map_err(|error| error.to_string())?,
        first: read(0)?,
        last: read(number.count().saturating_sub(1))?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sentence_is_compared_whole_but_for_its_numbers() {
        let words = "gas particle 3: needs a time step of ~ at time ~, or none";
        let like = |sentence| is_like(words, sentence);
        assert!(like(
            "gas particle 3: needs a time step of 1e-9 at time 0, or none"
        ));
        assert!(!like(
            "gas particle 3: needs a time step of 1e-9 at time 0, or none; so"
        ));
        assert!(!like(
            "dust particle 3: needs a time step of 1e-9 at time 0, or none"
        ));
        assert!(!like("gas particle 3: needs a time step of 1e-9, or none"));
        assert!(is_like("is empty", "is empty") && !is_like("is empty", "is empty now"));
    }
}
