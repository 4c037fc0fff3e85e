//! The history of a run: tables that grow a line at a time (`ledger.csv`, `operators.csv`, `events.csv`, `torques.csv`, `stress.csv`), and what the run
//! cost (`timings.json`).
//!
//! Numbers are written with the fewest digits that read back to the same bits.

pub mod operators;
pub mod stress;
pub mod torques;

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use coupling::accretion::Event;
use nbody::points::Vec3;
use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::atomic::publish_bytes;

/// A CSV file that grows by whole lines.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    file: File,
    columns: usize,
    rows: u64,
}

impl Table {
    /// A new table that has a head and no rows.
    pub fn create(path: &Path, head: &[&str]) -> io::Result<Self> {
        publish_bytes(path, format!("{}\n", head.join(",")).as_bytes())?;
        Self::open(path, head.len(), 0)
    }

    /// The table of a run that goes on, cut back to the rows it had at the checkpoint.
    pub fn resume(path: &Path, head: &[&str], rows: u64) -> io::Result<Self> {
        let wrong = |what: String| {
            io::Error::new(
                io::ErrorKind::InvalidData,
                format!("{}: {what}", path.display()),
            )
        };
        let text = fs::read_to_string(path)?;
        let mut lines = text
            .split_inclusive('\n')
            .filter(|line| line.ends_with('\n'));
        if lines.next().map(str::trim_end) != Some(head.join(",").as_str()) {
            return Err(wrong("has other columns than this version writes".into()));
        }
        let kept: Vec<&str> = lines.take(rows as usize).collect();
        if kept.len() as u64 != rows {
            return Err(wrong(format!(
                "has {} rows, but had {rows} at the checkpoint",
                kept.len()
            )));
        }
        let whole = format!("{}\n{}", head.join(","), kept.concat());
        publish_bytes(path, whole.as_bytes())?;
        Self::open(path, head.len(), rows)
    }

    fn open(path: &Path, columns: usize, rows: u64) -> io::Result<Self> {
        Ok(Self {
            path: path.to_path_buf(),
            file: OpenOptions::new().append(true).open(path)?,
            columns,
            rows,
        })
    }

    /// Rows written so far: what a checkpoint has to know.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a line, in one write.
    pub fn push(&mut self, cells: &[String]) -> io::Result<()> {
        assert_eq!(cells.len(), self.columns, "one cell a column");
        self.file
            .write_all(format!("{}\n", cells.join(",")).as_bytes())?;
        self.rows += 1;
        Ok(())
    }

    /// Brings what has been written to the disk.
    pub fn settle(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}

fn cell(x: f64) -> String {
    format!("{x:?}")
}

/// Sums over all particles at one time, code units; errors are relative.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerRow {
    pub time: f64,
    pub mass_gas: f64,
    pub mass_dust: f64,
    pub mass_planetesimals: f64,
    pub mass_star: f64,
    pub momentum: Vec3,
    pub angular_momentum: Vec3,
    pub kinetic_energy: f64,
    pub internal_energy: f64,
    pub potential_energy: f64,
    pub radiated_energy: f64,
    pub accreted_gas: f64,
    pub accreted_dust: f64,
    pub accreted_planetesimals: f64,
    pub error_mass: f64,
    pub error_momentum: f64,
    pub error_angular_momentum: f64,
    pub error_energy: f64,
}

impl LedgerRow {
    pub const HEAD: [&'static str; 22] = [
        "time",
        "mass_gas",
        "mass_dust",
        "mass_planetesimals",
        "mass_star",
        "momentum_x",
        "momentum_y",
        "momentum_z",
        "angular_momentum_x",
        "angular_momentum_y",
        "angular_momentum_z",
        "kinetic_energy",
        "internal_energy",
        "potential_energy",
        "radiated_energy",
        "accreted_gas",
        "accreted_dust",
        "accreted_planetesimals",
        "error_mass",
        "error_momentum",
        "error_angular_momentum",
        "error_energy",
    ];

    /// In the order of the head.
    pub fn cells(&self) -> [f64; 22] {
        let (p, l) = (self.momentum, self.angular_momentum);
        [
            self.time,
            self.mass_gas,
            self.mass_dust,
            self.mass_planetesimals,
            self.mass_star,
            p.x,
            p.y,
            p.z,
            l.x,
            l.y,
            l.z,
            self.kinetic_energy,
            self.internal_energy,
            self.potential_energy,
            self.radiated_energy,
            self.accreted_gas,
            self.accreted_dust,
            self.accreted_planetesimals,
            self.error_mass,
            self.error_momentum,
            self.error_angular_momentum,
            self.error_energy,
        ]
    }

    pub fn push_to(&self, table: &mut Table) -> io::Result<()> {
        table.push(&self.cells().map(cell))
    }
}

/// Columns of `events.csv`: `kind` is "merger", "bounce", "erosion", "accreted-gas", ...; `speed_ratio` is the impact speed by the pair's escape
/// speed, `angle` that between the velocity and the line of centres, radians; `mass_largest` is the mass of the largest body afterwards,
/// `fragments` the number of new bodies.
pub const EVENT_HEAD: [&str; 13] = [
    "time",
    "kind",
    "kept",
    "lost",
    "mass_kept",
    "mass_lost",
    "x",
    "y",
    "z",
    "speed_ratio",
    "angle",
    "mass_largest",
    "fragments",
];

/// Adds an event's line to its table.
pub fn push_event(event: &Event, table: &mut Table) -> io::Result<()> {
    let x = event.position;
    let mut cells = vec![
        cell(event.time),
        event.kind.to_owned(),
        event.kept.to_string(),
        event.lost.to_string(),
    ];
    cells.extend(
        [
            event.mass_kept,
            event.mass_lost,
            x.x,
            x.y,
            x.z,
            event.speed_ratio,
            event.angle,
            event.mass_largest,
        ]
        .map(cell),
    );
    cells.push(event.fragments.to_string());
    table.push(&cells)
}

/// What one phase of a run cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Phase {
    pub cpu_s: f64,
    pub calls: u64,
    /// Particles that were evaluated, where that is counted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub targets: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interactions: Option<u64>,
}

/// What a run cost; the phases add up to `cpu_s`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Timings {
    pub wall_s: f64,
    pub cpu_s: f64,
    pub threads: usize,
    pub steps: u64,
    #[serde(serialize_with = "in_order")]
    pub phases: Vec<(&'static str, Phase)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rearrangement: Option<Solved>,
}

/// How places of the gas were solved for; means are over the solves, residuals root mean squares of the density's relative error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Solved {
    pub solves: u64,
    pub failed: u64,
    pub mean_iterations: f64,
    pub most_iterations: u64,
    pub mean_residual_before: f64,
    pub mean_residual_after: f64,
}

impl Solved {
    /// None where nothing was solved for.
    pub fn of(solves: &gas::Solves) -> Option<Self> {
        let mean = |sum: f64| sum / solves.count as f64;
        (solves.count > 0).then(|| Self {
            solves: solves.count,
            failed: solves.failed,
            mean_iterations: mean(solves.iterations as f64),
            most_iterations: solves.most,
            mean_residual_before: mean(solves.before),
            mean_residual_after: mean(solves.after),
        })
    }

    /// The same in words.
    pub fn words(&self) -> String {
        format!(
            "rearrangement: {} solves, {} without convergence, {:.1} iterations in the mean, {} at most, residual {:.1e} before, {:.1e} after",
            self.solves,
            self.failed,
            self.mean_iterations,
            self.most_iterations,
            self.mean_residual_before,
            self.mean_residual_after
        )
    }
}

fn in_order<S: Serializer>(
    phases: &[(&'static str, Phase)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    let mut map = serializer.serialize_map(Some(phases.len()))?;
    for (name, phase) in phases {
        map.serialize_entry(name, phase)?;
    }
    map.end()
}

impl Timings {
    pub fn write(&self, path: &Path) -> io::Result<()> {
        let mut text = serde_json::to_string_pretty(self)?;
        text.push('\n');
        publish_bytes(path, text.as_bytes())
    }
}

/// The columns of a CSV file of numbers, with their names; what is no number is not-a-number.
pub fn read_numbers(path: &Path) -> io::Result<Vec<(String, Vec<f64>)>> {
    let text = fs::read_to_string(path)?;
    let mut lines = text.lines();
    let head = lines.next().unwrap_or_default();
    let mut columns: Vec<(String, Vec<f64>)> = head
        .split(',')
        .map(|name| (name.to_owned(), Vec::new()))
        .collect();
    let width = columns.len();
    for line in lines.filter(|line| line.split(',').count() == width) {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.1.push(cell.parse().unwrap_or(f64::NAN));
        }
    }
    Ok(columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("tridisk-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn a_ledger_reads_back_exactly_and_is_cut_on_resume() {
        let folder = folder("ledger");
        let path = folder.join("ledger.csv");
        let mut table = Table::create(&path, &LedgerRow::HEAD).unwrap();
        let row = |i: u32| LedgerRow {
            time: 0.1 * f64::from(i),
            momentum: Vec3::new(1e-300, -0.0, 1.0 / 3.0),
            error_energy: f64::NAN,
            ..LedgerRow::default()
        };
        (0..5).for_each(|i| row(i).push_to(&mut table).unwrap());
        // A line that a crash cut short.
        table.file.write_all(b"0.5,1.0").unwrap();
        let mut table = Table::resume(&path, &LedgerRow::HEAD, 3).unwrap();
        row(3).push_to(&mut table).unwrap();
        assert_eq!(table.rows(), 4);
        let columns = read_numbers(&path).unwrap();
        assert_eq!(columns.len(), 22);
        for (i, &time) in columns[0].1.iter().enumerate() {
            assert_eq!(time.to_bits(), row(i as u32).time.to_bits());
        }
        assert_eq!(columns[0].1.len(), 4);
        assert_eq!(columns[7].1[0].to_bits(), (1.0f64 / 3.0).to_bits());
        assert!(Table::resume(&path, &LedgerRow::HEAD, 9).is_err());
        assert!(Table::resume(&path, &EVENT_HEAD, 1).is_err());
        fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn timings_keep_the_order_of_the_phases() {
        let folder = folder("timings");
        let path = folder.join("timings.json");
        let timings = Timings {
            phases: vec![
                ("tree", Phase::default()),
                (
                    "gravity",
                    Phase {
                        targets: Some(3),
                        ..Phase::default()
                    },
                ),
            ],
            ..Timings::default()
        };
        timings.write(&path).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.find("tree").unwrap() < text.find("gravity").unwrap());
        assert!(text.contains("\"targets\": 3") && !text.contains("null"));
        fs::remove_dir_all(&folder).unwrap();
    }
}
