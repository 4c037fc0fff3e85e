//! A scheme: the hydrodynamics with which the battery of the gas is run, and where pictures of it go.
//!
//! Its keys are those of [gas.hydro], [gas.viscosity] and [gas.conduction]. A number of neighbours is one in space; in the plane
//! the kernel has the same reach by the distance of neighbours: N_2 = pi (3 N_3 / 4 pi)^(2/3). The recommended scheme has a number for each.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use gas::Particles;

use super::End;
use crate::scene::Scene;
use crate::trial::Trial;

const TABLES: [&str; 3] = ["gas.hydro.", "gas.viscosity.", "gas.conduction."];
const NEIGHBOURS: &str = "gas.hydro.neighbours";

/// The scheme recommended for flows in which shocks, contacts and vortices count alike, in space and in the plane.
const RECOMMENDED: [&str; 4] = [
    "gas.hydro.formulation=pressure",
    "gas.hydro.kernel=quintic-spline",
    "gas.hydro.background_pressure=least",
    "gas.hydro.precision=single",
];
const RECOMMENDED_NEIGHBOURS: [&str; 2] = ["gas.hydro.neighbours=71", "gas.hydro.neighbours=46"];
/// Left out where a scheme names a viscosity: another one has its own keys.
const RECOMMENDED_VISCOSITY: [&str; 4] = [
    "gas.viscosity.kind=balsara",
    "gas.viscosity.alpha=1",
    "gas.viscosity.beta=3.5",
    "gas.viscosity.reconstruction=linear",
];
const KIND: &str = "gas.viscosity.kind";

pub struct Scheme {
    is_recommended: bool,
    /// As of `--set`: they outrank the recommended ones.
    keys: Vec<String>,
    pictures: Option<PathBuf>,
}

impl Scheme {
    /// The default scheme or the recommended one with these keys, or what is wrong with them.
    pub fn new(
        is_recommended: bool,
        set: &[String],
        pictures: Option<&Path>,
    ) -> Result<Self, String> {
        if let Some(other) = set
            .iter()
            .find(|key| !TABLES.iter().any(|t| key.starts_with(t)))
        {
            return Err(format!(
                "--set {other}: a scheme has keys of [gas.hydro], [gas.viscosity] and [gas.conduction]"
            ));
        }
        let scheme = Self {
            is_recommended,
            keys: set.to_vec(),
            pictures: pictures.map(Path::to_path_buf),
        };
        for scene in [cube(3), cube(2)] {
            let keys = scheme.keys_of(&scene);
            let parsed = Scene::parse(&scene, "scheme", Path::new("."), &keys);
            if let Err(problems) = parsed {
                let sentences = problems.into_iter().map(|(_, sentence)| sentence);
                return Err(sentences.collect::<Vec<_>>().join("; "));
            }
        }
        if let Some(folder) = pictures {
            std::fs::create_dir_all(folder)
                .map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        Ok(scheme)
    }

    /// The viscosity that it names, if it does.
    pub(super) fn viscosity(&self) -> Option<String> {
        let key = self.keys.iter().rfind(|key| key.starts_with(KIND))?;
        let (_, kind) = key.split_once('=')?;
        Some(kind.trim_matches([' ', '"', '\'']).to_owned())
    }

    /// The same with another viscosity, if its other keys allow it; without pictures.
    pub(super) fn with_viscosity(&self, kind: &str) -> Option<Self> {
        let mut keys = self.keys.clone();
        keys.push(format!("{KIND}={kind}"));
        Self::new(self.is_recommended, &keys, None).ok()
    }

    /// The keys for a scene.
    fn keys_of(&self, scene: &str) -> Vec<String> {
        let is_plane = scene.lines().any(|line| line == "dimensions = 2");
        let key = |key: &String| match key.strip_prefix(NEIGHBOURS) {
            Some(rest) if is_plane => match rest.trim_start_matches([' ', '=']).parse::<f64>() {
                Ok(n) => format!("{NEIGHBOURS}={:.1}", PI * (0.75 * n / PI).powf(2.0 / 3.0)),
                Err(_) => key.clone(),
            },
            _ => key.clone(),
        };
        let mut keys: Vec<String> = Vec::new();
        if self.is_recommended {
            keys.extend(RECOMMENDED.map(str::to_owned));
            keys.push(RECOMMENDED_NEIGHBOURS[usize::from(is_plane)].to_owned());
            if !self.keys.iter().any(|key| key.starts_with(KIND)) {
                keys.extend(RECOMMENDED_VISCOSITY.map(str::to_owned));
            }
        }
        keys.extend(self.keys.iter().map(key));
        keys
    }

    /// A scene in place, its gas changed by `prepare` before the start.
    pub(super) fn trial(&self, scene: &str, prepare: impl FnOnce(&mut Particles)) -> Trial {
        Trial::new(scene, &self.keys_of(scene), prepare)
            .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
    }

    /// What a scene is at the start and at each of the times, its gas changed by `prepare` before the start.
    pub(super) fn run(
        &self,
        scene: &str,
        times: &[f64],
        prepare: impl FnOnce(&mut Particles),
    ) -> Vec<End> {
        let mut trial = self.trial(scene, prepare);
        let stops: Vec<f64> = std::iter::once(0.0).chain(times.iter().copied()).collect();
        let mut ends = Vec::new();
        let done = trial.run(&stops, |stop| ends.push(End::of(stop.system, stop.books)));
        done.unwrap_or_else(|fault| panic!("a built-in problem: {fault}"));
        ends
    }

    /// What a scene is at its end.
    pub(super) fn end(&self, scene: &str, time: f64, prepare: impl FnOnce(&mut Particles)) -> End {
        let mut ends = self.run(scene, &[time], prepare);
        ends.pop().expect("a run has an end")
    }

    /// The file of a problem's picture, if pictures are wanted.
    pub(super) fn picture(&self, name: &str) -> Option<PathBuf> {
        let folder = self.pictures.as_ref()?;
        Some(folder.join(format!("{name}.png")))
    }
}

/// A small box, to see whether keys are sound.
fn cube(dimensions: usize) -> String {
    format!(
        "[run]\nend_time = 1\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [1, 1, 1]\n\
         dimensions = {dimensions}\n[[gas.block]]\nlo = [0, 0, 0]\nhi = [1, 1, 1]\nspacing = 0.1\ndensity = 1\npressure = 1\n"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scheme(keys: &[&str]) -> Result<Scheme, String> {
        let keys: Vec<String> = keys.iter().map(|key| key.to_string()).collect();
        Scheme::new(false, &keys, None)
    }

    #[test]
    fn keys_that_are_no_scheme_are_refused() {
        let sentence = |keys: &[&str]| scheme(keys).err().unwrap_or_default();
        assert!(sentence(&["gas.eos.gamma=2"]).contains("gas.eos.gamma=2"));
        assert!(sentence(&["gas.viscosity.kind=balzara"]).contains("balsara"));
        assert!(sentence(&["gas.hydro.neighbours=2000"]).contains("from 6 to 1000"));
        assert_eq!(sentence(&["gas.hydro.formulation=pressure"]), "");
    }

    #[test]
    fn neighbours_in_the_plane_are_within_the_same_reach() {
        let scheme = scheme(&["gas.hydro.neighbours=140"]).expect("a scheme");
        assert_eq!(scheme.keys_of(&cube(3)), ["gas.hydro.neighbours=140"]);
        // H is 3.2211 distances: 32.59 within a disk.
        assert_eq!(scheme.keys_of(&cube(2)), ["gas.hydro.neighbours=32.6"]);
    }

    #[test]
    fn keys_of_ones_own_outrank_the_recommended_ones() {
        let keys = ["gas.hydro.neighbours=100", "gas.viscosity.kind=none"].map(str::to_owned);
        let scheme = Scheme::new(true, &keys, None).expect("a scheme");
        for (dimensions, neighbours) in [(3, 100.0), (2, 26.0)] {
            let text = cube(dimensions);
            let parsed = Scene::parse(&text, "scheme", Path::new("."), &scheme.keys_of(&text));
            let gas = parsed.expect("a scene").gas.expect("gas");
            assert_eq!(gas.hydro.neighbours, neighbours);
        }
        let plain = Scheme::new(true, &[], None).expect("a scheme");
        let keys = plain.keys_of(&cube(2));
        assert_eq!(keys[4], "gas.hydro.neighbours=46");
        assert_eq!(keys[5..], RECOMMENDED_VISCOSITY);
        // Of a scheme that names a viscosity none of these are left.
        assert!(
            scheme.keys_of(&cube(2))[5..]
                .iter()
                .all(|key| !key.contains("beta"))
        );
    }
}
