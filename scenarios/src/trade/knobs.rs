//! Knobs: keys of a scene that are varied, the values that suit it where nobody names any, and where tighter lies.

use crate::document::{self, Entries, Value};
use crate::scene::{GravityMethod, Integrator, Mass, Opening, Precision, Scene};
use crate::units::{Kind, Units};

/// A key and the values it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct Knob {
    pub key: String,
    pub values: Vec<String>,
}

impl Knob {
    /// `key=v1,v2,...`; commas inside quotes and brackets belong to the value.
    pub fn parse(argument: &str) -> Result<Self, String> {
        let (key, values) = pair(argument)?;
        let values = split(values);
        if values.iter().any(String::is_empty) {
            return Err(format!("--knob {argument}: has an empty value"));
        }
        Ok(Self { key, values })
    }

    fn of(key: &str, values: &[&str]) -> Self {
        Self {
            key: key.to_owned(),
            values: values.iter().map(|&value| value.to_owned()).collect(),
        }
    }
}

fn pair(argument: &str) -> Result<(String, &str), String> {
    match argument.split_once('=') {
        Some((key, rest)) if !key.trim().is_empty() && !rest.trim().is_empty() => {
            Ok((key.trim().to_owned(), rest.trim()))
        }
        _ => Err(format!(
            "{argument}: wanted is key=value,value,..., such as gravity.force_error=1e-2,1e-3"
        )),
    }
}

/// `key=value,key=value,...` of a reference.
pub fn pairs(argument: &str) -> Result<Vec<(String, String)>, String> {
    let mut found: Vec<(String, String)> = Vec::new();
    for part in split(argument) {
        match (pair(&part), found.last_mut()) {
            (Ok((key, value)), _) => found.push((key, value.trim_matches('"').to_owned())),
            (Err(sentence), _) => return Err(format!("--reference {sentence}")),
        }
    }
    Ok(found)
}

fn split(text: &str) -> Vec<String> {
    let (mut parts, mut depth, mut quoted) = (vec![String::new()], 0, false);
    for c in text.chars() {
        match c {
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth -= 1,
            ',' if !quoted && depth == 0 => {
                parts.push(String::new());
                continue;
            }
            _ => {}
        }
        parts.last_mut().expect("one part at least").push(c);
    }
    let bare = |part: String| part.trim().trim_matches('"').to_owned();
    parts.into_iter().map(bare).collect()
}

/// Where the tighter values of a key lie.
enum Tighter {
    /// At smaller numbers of a kind; the reference has this part of the smallest, but no less than a least value.
    Below(Kind, f64, f64),
    /// At larger numbers; the reference has the largest.
    Above,
    /// Later in a list; the reference has the last of it.
    Words(&'static [&'static str]),
}

const DIRECTIONS: [(&str, Tighter); 17] = [
    ("run.time_step", Tighter::Below(Kind::TIME, 0.5, 0.0)),
    (
        "planetesimals.time_step",
        Tighter::Below(Kind::TIME, 0.5, 0.0),
    ),
    (
        "planetesimals.softening",
        Tighter::Below(Kind::LENGTH, 1.0, 0.0),
    ),
    ("planetesimals.integrator", Tighter::Words(&INTEGRATORS)),
    ("planetesimals.corrector", Tighter::Above),
    ("planetesimals.cutoff", Tighter::Above),
    ("planetesimals.number", Tighter::Above),
    (
        "accuracy.preset",
        Tighter::Words(&["draft", "standard", "precise", "reference"]),
    ),
    (
        "accuracy.orbit_step",
        Tighter::Below(Kind::NUMBER, 0.5, 0.0),
    ),
    (
        "accuracy.acceleration_step",
        Tighter::Below(Kind::NUMBER, 0.5, 0.0),
    ),
    (
        "gravity.force_error",
        Tighter::Below(Kind::NUMBER, 0.1, 1e-9),
    ),
    (
        "gravity.opening_angle",
        Tighter::Below(Kind::NUMBER, 0.5, 0.0),
    ),
    ("gas.hydro.courant", Tighter::Below(Kind::NUMBER, 0.5, 0.0)),
    (
        "gas.hydro.tolerance",
        Tighter::Below(Kind::NUMBER, 0.1, 1e-12),
    ),
    ("gas.hydro.precision", Tighter::Words(&["single", "double"])),
    ("gas.particles", Tighter::Above),
    ("dust.particles", Tighter::Above),
];

const INTEGRATORS: [&str; 5] = [
    "leapfrog",
    "wisdom-holman",
    "hybrid",
    "hermite",
    "gauss-radau",
];

/// Bodies up to which the integrator that takes all pairs at once is affordable as a reference.
const FEW: usize = 64;

/// What the reference has for a knob; `None`: the scene's own value, since none of the knob's is known to be tighter than the others.
pub fn tightest(knob: &Knob, scene: &Scene) -> Vec<(String, String)> {
    let direction = DIRECTIONS.iter().find(|(key, _)| *key == knob.key);
    let numbers = |kind: Kind| -> Vec<f64> {
        let values = knob.values.iter();
        values
            .filter_map(|value| number(value, kind, &scene.units))
            .collect()
    };
    let set = |value: String| vec![(knob.key.clone(), value)];
    match direction {
        Some((_, Tighter::Below(kind, part, least))) => {
            let smallest = numbers(*kind).into_iter().reduce(f64::min);
            smallest.map_or_else(Vec::new, |x| set(format!("{:?}", (part * x).max(*least))))
        }
        Some((_, Tighter::Above)) => {
            let last = |a: &&String, b: &&String| {
                let number = |x: &str| x.parse().unwrap_or(f64::NEG_INFINITY);
                number(a).total_cmp(&number(b))
            };
            knob.values
                .iter()
                .max_by(last)
                .map_or_else(Vec::new, |x| set(x.clone()))
        }
        Some((_, Tighter::Words(_))) if knob.key == "planetesimals.integrator" => {
            integrator(knob, scene)
        }
        Some((_, Tighter::Words(words))) => set(words[words.len() - 1].to_owned()),
        None => Vec::new(),
    }
}

/// Few bodies have the adaptive one of high order as a reference; many have the best that is named, with a quarter of the step.
fn integrator(knob: &Knob, scene: &Scene) -> Vec<(String, String)> {
    let key = knob.key.clone();
    let number = scene.planets.len() + scene.planetesimals.map_or(0, |p| p.number);
    if number <= FEW && scene.initial_file.is_none() && !has_fluids(scene) {
        return vec![(key, "gauss-radau".to_owned())];
    }
    let place = |value: &&String| INTEGRATORS.iter().position(|word| word == value);
    let Some(best) = knob.values.iter().max_by_key(place) else {
        return Vec::new();
    };
    let step = match scene.planetesimals.map(|p| p.time_step) {
        Some(crate::scene::TimeStep::Fixed(dt)) => (
            "planetesimals.time_step".to_owned(),
            format!("{:?}", 0.25 * dt),
        ),
        _ => (
            "accuracy.orbit_step".to_owned(),
            format!("{:?}", 0.25 * scene.accuracy.orbit_step),
        ),
    };
    vec![(key, best.clone()), step]
}

fn has_fluids(scene: &Scene) -> bool {
    scene.gas.is_some() || scene.dust.is_some()
}

fn number(text: &str, kind: Kind, units: &Units) -> Option<f64> {
    let plain = text.parse().ok();
    plain.or_else(|| units.value(text, kind).ok())
}

/// The value that a scene has for a key, as shown; empty if it writes none.
pub fn own(resolved: &Entries, key: &str) -> String {
    match document::value(resolved, key) {
        Some(Value::Text(text)) => text.clone(),
        Some(value) => value.to_string(),
        None => String::new(),
    }
}

/// What is worth varying in a scene. `given` is what its file says.
pub fn defaults(scene: &Scene, given: &Entries) -> Vec<Knob> {
    let mut knobs = Vec::new();
    let says = |key: &str| document::value(given, key).is_some();
    if scene.star.is_some() {
        knobs.push(Knob::of("accuracy.orbit_step", &["0.2", "0.1", "0.05"]));
    }
    if let Some(gas) = &scene.gas {
        let counts: Vec<String> = crate::preset::PRESETS[..3]
            .iter()
            .map(|(_, preset)| preset.neighbours(gas.hydro.kernel, scene.domain.dimensions()))
            .map(|count| format!("{count}"))
            .collect();
        let counts: Vec<&str> = counts.iter().map(String::as_str).collect();
        knobs.push(Knob::of("gas.hydro.courant", &["0.4", "0.25", "0.15"]));
        knobs.push(Knob::of("gas.hydro.neighbours", &counts));
        if !says("gas.hydro.neighbours") {
            knobs.push(Knob::of(
                "gas.hydro.kernel",
                &["wendland-c2", "wendland-c4"],
            ));
        }
        let precise = gas.hydro.precision == Precision::Double;
        let other = if precise { "single" } else { "double" };
        knobs.push(Knob::of("gas.hydro.precision", &[other]));
        knobs.push(Knob::of("gas.hydro.formulation", &["density", "pressure"]));
        let kinds = ["balsara", "cullen-dehnen", "planar"];
        knobs.push(Knob::of("gas.viscosity.kind", &kinds));
    }
    if of_the_tree(scene) {
        knobs.push(match scene.gravity.opening {
            Opening::ForceError(_) => Knob::of("gravity.force_error", &["1e-2", "3e-3", "1e-3"]),
            Opening::Angle(_) => Knob::of("gravity.opening_angle", &["0.9", "0.7", "0.5"]),
        });
    }
    if let Some(bodies) = &scene.planetesimals {
        let number = bodies.number + scene.planets.len();
        let usual = ["leapfrog", "wisdom-holman", "hybrid"];
        let all = ["leapfrog", "wisdom-holman", "hybrid", "gauss-radau"];
        let few = number <= FEW && !has_fluids(scene);
        let names: &[&str] = if few { &all } else { &usual };
        if bodies.integrator != Integrator::Hermite && scene.domain.hill().is_none() {
            knobs.push(Knob::of("planetesimals.integrator", names));
        }
    }
    knobs
}

/// Whether more than the star's pull is summed.
fn of_the_tree(scene: &Scene) -> bool {
    let masses = [Mass::Gas, Mass::Dust, Mass::Planetesimals];
    let pulls = |&a: &Mass| masses.iter().any(|&b| scene.gravity.pulls.has(a, b));
    scene.gravity.method == GravityMethod::Tree && masses.iter().any(pulls)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_cut_at_commas_outside_of_brackets() {
        let knob = Knob::parse("a.b=1, \"2 yr\",[1,2],x").expect("a knob");
        assert_eq!(knob.values, ["1", "2 yr", "[1,2]", "x"]);
        assert!(Knob::parse("a.b").is_err());
        assert!(Knob::parse("a.b=1,,2").is_err());
        let pairs = pairs("a=1,b=\"2 yr\"").expect("pairs");
        assert_eq!(pairs[1], ("b".to_owned(), "2 yr".to_owned()));
    }
}
