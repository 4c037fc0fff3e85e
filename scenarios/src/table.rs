//! A table of an equation of state from a file, text or HDF5.
//!
//! Text: a line a state, "density energy pressure sound_speed", by blanks or commas, in any order; every density with every energy once;
//! lines that begin with # are remarks. HDF5: the axes `Densities` and `InternalEnergies`, and `Pressures` and `SoundSpeeds` over both
//! (densities first). All numbers in cgs; in code units where a scene is dimensionless.

use std::path::Path;

use gas::Table;

use crate::hdf::read_values;

/// The numbers of a file: axes, and values over both, those of a density one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    rho: Vec<f64>,
    u: Vec<f64>,
    p: Vec<f64>,
    c: Vec<f64>,
}

impl Grid {
    /// The table in units that are so much in those of the file: density, energy by mass, pressure, velocity.
    pub fn table(&self, [rho, u, p, c]: [f64; 4]) -> Result<Table, String> {
        let scaled = |values: &[f64], unit: f64| -> Vec<f64> {
            values.iter().map(|value| value / unit).collect()
        };
        Table::new(
            &scaled(&self.rho, rho),
            &scaled(&self.u, u),
            &scaled(&self.p, p),
            &scaled(&self.c, c),
        )
    }
}

/// What a file holds, or a sentence.
pub fn read(path: &Path) -> Result<Grid, String> {
    if !path.is_file() {
        return Err(format!("there is no file {}", path.display()));
    }
    match std::fs::read_to_string(path) {
        Ok(text) => from_text(&text),
        Err(_) => from_hdf(path).map_err(|trouble| format!("is neither text nor HDF5: {trouble}")),
    }
}

fn from_hdf(path: &Path) -> crate::hdf::Result<Grid> {
    let file = hdf5::File::open(path)?;
    let values = |name: &str| -> crate::hdf::Result<Vec<f64>> { read_values(&file.dataset(name)?) };
    Ok(Grid {
        rho: values("Densities")?,
        u: values("InternalEnergies")?,
        p: values("Pressures")?,
        c: values("SoundSpeeds")?,
    })
}

fn from_text(text: &str) -> Result<Grid, String> {
    let mut states = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words = line.split(|c: char| c == ',' || c.is_whitespace());
        let numbers: Result<Vec<f64>, _> = words
            .filter(|word| !word.is_empty())
            .map(str::parse)
            .collect();
        match numbers.as_deref() {
            Ok(&[rho, u, p, c]) => states.push([rho, u, p, c]),
            _ => {
                return Err(format!(
                    "has no four numbers (density, energy, pressure, sound speed) in line {}",
                    k + 1
                ));
            }
        }
    }
    states.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let axis = |k: usize| {
        let mut axis: Vec<f64> = states.iter().map(|state| state[k]).collect();
        axis.sort_by(f64::total_cmp);
        axis.dedup();
        axis
    };
    let (rho, u) = (axis(0), axis(1));
    let wanted = || rho.iter().flat_map(|&rho| u.iter().map(move |&u| [rho, u]));
    let complete = states.len() == rho.len() * u.len()
        && wanted()
            .zip(&states)
            .all(|(pair, state)| pair == state[..2]);
    if !complete {
        return Err(format!(
            "has {} states for {} densities and {} internal energies; wanted is each pair once",
            states.len(),
            rho.len(),
            u.len()
        ));
    }
    let column = |k: usize| states.iter().map(|state| state[k]).collect();
    Ok(Grid {
        p: column(2),
        c: column(3),
        rho,
        u,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "# rho u P c\n2 1, 4 1\n1 1 2 1\n\n1 3 6 2\n2 3 12 2\n";

    fn grid() -> Grid {
        Grid {
            rho: vec![1.0, 2.0],
            u: vec![1.0, 3.0],
            p: vec![2.0, 6.0, 4.0, 12.0],
            c: vec![1.0, 2.0, 1.0, 2.0],
        }
    }

    #[test]
    fn text_and_hdf_hold_the_same_table() {
        assert_eq!(from_text(TEXT), Ok(grid()));
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("table.hdf5");
        let file = hdf5::File::create(&path).expect("a file");
        let grid = grid();
        let write = |name: &str, values: &[f64], shape: &[usize]| {
            let dataset = file.new_dataset::<f64>().shape(shape).create(name);
            dataset
                .expect("a dataset")
                .write_raw(values)
                .expect("values");
        };
        write("Densities", &grid.rho, &[2]);
        write("InternalEnergies", &grid.u, &[2]);
        write("Pressures", &grid.p, &[2, 2]);
        write("SoundSpeeds", &grid.c, &[2, 2]);
        file.close().expect("closed");
        assert_eq!(read(&path), Ok(grid.clone()));
        let table = grid.table([2.0, 1.0, 4.0, 0.5]).expect("a table");
        assert!((table.pressure(1.0, 3.0) - 3.0).abs() < 1e-14);
        assert!((table.sound_speed(0.5, 1.0) - 2.0).abs() < 1e-14);
    }

    #[test]
    fn files_that_are_no_tables_are_refused_in_words() {
        let fault = |text: &str| from_text(text).expect_err("a refusal");
        assert!(fault("1 1 2 1\n1 2 3").contains("no four numbers"));
        assert!(fault("1 1 2 1\n1 2 3").contains("line 2"));
        assert!(fault("1 1 2 1\n2 2 3 1").contains("2 states for 2 densities"));
        assert!(fault("1 1 2 1\n1 1 2 1\n2 1 2 1\n1 2 2 1").contains("each pair once"));
        let folder = tempfile::tempdir().expect("a folder");
        let none = read(&folder.path().join("none"));
        assert!(none.expect_err("a refusal").contains("there is no file"));
    }
}
