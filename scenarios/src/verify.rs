//! Verification: built-in problems of physics that take longer than a test should, against their exact or published answers.

mod coupling;
mod dust;
pub mod extremes;
mod field_steps;
mod gammie;
pub mod gas;
mod inner_edge;
mod orbits;
pub mod ring;
mod secular;
mod shearing_glass;
mod sheet;
mod steps;
mod stirring;
mod toomre;
mod viscous;
mod wide_disk;

use std::path::Path;

use cpu_time::ProcessTime;

use self::extremes::case::Case;
use self::gas::scheme::Scheme;

/// A figure of a problem beside what it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub what: String,
    pub measured: f64,
    /// Standard error of what was measured; zero if it has none.
    pub uncertainty: f64,
    pub bar: Bar,
}

/// What a figure is judged by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bar {
    /// Smallest values that are good and acceptable.
    Least([f64; 2]),
    /// Largest differences from a value, relative to it, that are good and acceptable.
    Reference {
        value: f64,
        good: f64,
        acceptable: f64,
    },
    /// A value that it should be within two (good) or three (acceptable) of its own standard errors from.
    Statistics(f64),
    /// Largest sizes that are good and acceptable.
    Limit([f64; 2]),
    /// Told for information.
    None,
}

impl Row {
    /// A figure without an uncertainty.
    pub fn new(what: impl Into<String>, measured: f64, bar: Bar) -> Self {
        Self {
            what: what.into(),
            measured,
            uncertainty: 0.0,
            bar,
        }
    }

    /// What is judged, and what it may be for good and acceptable.
    fn margins(&self) -> Option<(f64, [f64; 2])> {
        match self.bar {
            Bar::Reference {
                value,
                good,
                acceptable,
            } => Some((self.measured / value - 1.0, [good, acceptable])),
            Bar::Statistics(value) => {
                Some(((self.measured - value) / self.uncertainty, [2.0, 3.0]))
            }
            Bar::Limit(limits) | Bar::Least(limits) => Some((self.measured, limits)),
            Bar::None => None,
        }
    }

    fn verdict(&self) -> &'static str {
        let Some((size, bars)) = self.margins() else {
            return "told";
        };
        let keeps = |bar: f64| match self.bar {
            Bar::Least(_) => size >= bar,
            _ => size.abs() <= bar,
        };
        match bars.map(keeps) {
            [true, _] => "good",
            [_, true] => "acceptable",
            _ => "FAILED",
        }
    }

    /// The figure, what it should be, how far it is from it, and the bars.
    fn cells(&self) -> [String; 4] {
        let measured = if self.uncertainty > 0.0 {
            format!("{:.4e} +- {:.1e}", self.measured, self.uncertainty)
        } else {
            format!("{:.4e}", self.measured)
        };
        let none = String::new;
        match (self.bar, self.margins()) {
            (Bar::Reference { value, .. }, Some((difference, bars))) => [
                measured,
                format!("{value:.4e}"),
                format!("{:+.2} %", 100.0 * difference),
                format!("{} %, {} %", 100.0 * bars[0], 100.0 * bars[1]),
            ],
            (Bar::Statistics(value), Some((errors, bars))) => [
                measured,
                format!("{value:.4e}"),
                format!(
                    "{:+.0} %, {errors:+.1} standard errors",
                    100.0 * (self.measured / value - 1.0)
                ),
                format!("{}, {} standard errors", bars[0], bars[1]),
            ],
            (bar, Some((_, [good, acceptable]))) => [
                measured,
                none(),
                none(),
                match bar {
                    Bar::Least(_) => format!("at least {good}, {acceptable}"),
                    _ => format!("{good:e}, {acceptable:e}"),
                },
            ],
            (_, None) => [measured, none(), none(), none()],
        }
    }
}

/// A named problem.
pub struct Problem {
    pub name: &'static str,
    pub about: &'static str,
    rows: Rows,
}

/// How a problem comes to its rows.
enum Rows {
    Own(fn() -> Vec<Row>),
    /// With the hydrodynamics that the command line asks for.
    Of(fn(&Scheme) -> Vec<Row>),
    /// As cases, each with what must hold of it.
    Cases(fn() -> Vec<Case>),
}

const fn own(name: &'static str, about: &'static str, rows: fn() -> Vec<Row>) -> Problem {
    Problem {
        name,
        about,
        rows: Rows::Own(rows),
    }
}

const fn of_scheme(
    name: &'static str,
    about: &'static str,
    rows: fn(&Scheme) -> Vec<Row>,
) -> Problem {
    Problem {
        name,
        about,
        rows: Rows::Of(rows),
    }
}

/// All problems but those with lists of their own, in the order in which they run.
pub const PROBLEMS: &[Problem] = &[
    own(
        "sod",
        "shock tube of 57 600 particles in both precisions; about 1 minute",
        gas::sod::rows,
    ),
    own(
        "gresho",
        "vortex of 24 576 particles in both precisions; about 2 minutes",
        gas::gresho::rows,
    ),
    own(
        "evrard",
        "cold collapse of 14 328 particles in both precisions; about 2 minutes",
        gas::evrard::rows,
    ),
    own(
        "liquid",
        "shock tube and contact of a stiffened gas, by sums of densities and of pressures; about 5 seconds",
        gas::liquid::rows,
    ),
    own(
        "shearing-glass",
        "noise that shear makes of a glass of 2500 particles over 5 orbits, by scheme, without and with rearrangement; about 10 minutes",
        shearing_glass::rows,
    ),
    own(
        "keplerian-ring",
        "a cold ring of 16 000 particles, gradients by viscosity: orbits survived, torques, noise; hours",
        ring::rows,
    ),
    own(
        "toomre",
        "waves in a razor-thin annulus of 60 000 and 120 000 particles that pulls itself, one that oscillates and two that grow; about 1 minute",
        toomre::rows,
    ),
    own(
        "gammie",
        "razor-thin disks of 20 000 particles that pull themselves and cool: fragments or turbulence; about 8 minutes",
        gammie::rows,
    ),
    own(
        "gammie-boundary",
        "the same disks at beta = 5 to 10, for 20 cooling times or until they break: alpha by its sources; about 10 minutes",
        gammie::boundary,
    ),
    own(
        "wide-disk",
        "a gas disk of 1e5 particles without self-gravity through three orbits of its inner edge; about 1 minute",
        wide_disk::rows,
    ),
    own(
        "inner-edge",
        "the wide disk's inner edge with 20 000 particles, by what holds it, through twelve of its orbits; about 2 minutes",
        inner_edge::rows,
    ),
    own(
        "individual-steps",
        "what individual time steps save in a gas disk from 0.1 to 10 au, at equal error, six disks of 20 000 particles; about 5 minutes of two cores",
        steps::rows,
    ),
    own(
        "field-steps",
        "steps of the tree's field apart from those of the forces, in a collapse and a disk; about 3 minutes",
        field_steps::rows,
    ),
    own(
        "orbits",
        "energy of the outer Solar System by the corrected Jacobi map over 1e6 yr; e = 0.999999 through 1000 pericentres; about 1 minute",
        orbits::rows,
    ),
    own(
        "random-walk",
        "energy of Jupiter and Saturn by Gauss-Radau over 1e6 orbits, 2 systems; about 8 minutes of each of two cores",
        orbits::walk,
    ),
    own(
        "secular-frequencies",
        "frequencies of the apsides and nodes of the outer Solar System from 5 Myr; about 20 seconds",
        secular::rows,
    ),
    own(
        "stirring",
        "viscous stirring of 800 equal planetesimals over 150 orbits (Ohtsuki, Stewart & Ida 2002), 3 runs; about 2 minutes",
        stirring::equal_masses,
    ),
    own(
        "stirring-two-masses",
        "stirring and dynamical friction between two populations over 100 orbits, 3 runs; about 4 minutes",
        stirring::two_masses,
    ),
    of_scheme(
        "gas-sod",
        "shock tube of up to 57 600 particles",
        gas::sod::of,
    ),
    of_scheme(
        "gas-gresho",
        "vortex of up to 24 576 particles to t = 1",
        gas::gresho::of,
    ),
    of_scheme(
        "gas-kelvin-helmholtz",
        "smooth shear layers (McNally et al. 2012), 24 576 and 55 296 particles and the plane, to t = 1.5",
        gas::shear_layer::of,
    ),
    of_scheme(
        "gas-contrast-2",
        "sharp shear layers of density contrast 2 in the plane (Saitoh & Makino 2013)",
        gas::sharp_layer::contrast_2,
    ),
    of_scheme(
        "gas-contrast-8",
        "the same of contrast 8",
        gas::sharp_layer::contrast_8,
    ),
    of_scheme(
        "gas-square",
        "square of dense gas in balance of pressure, in the plane, to t = 8 (Saitoh & Makino 2013)",
        gas::square::of,
    ),
    of_scheme(
        "gas-wave",
        "sound wave of amplitude 0.001 through one period",
        gas::wave::of,
    ),
    of_scheme(
        "gas-noh-2d",
        "cold gas that meets in a point of the plane (Noh 1987)",
        gas::noh::plane,
    ),
    of_scheme(
        "gas-noh-3d",
        "the same in space, at three distances of the particles; about 5 minutes",
        gas::noh::space,
    ),
    of_scheme(
        "gas-sedov",
        "blast in cold gas, 265 302 particles (Sedov 1959)",
        gas::sedov::of,
    ),
    of_scheme(
        "gas-123",
        "double rarefaction to near vacuum (Toro 2009)",
        gas::tube::rarefactions,
    ),
    of_scheme(
        "gas-blast",
        "shock of Mach number 199 (Toro 2009)",
        gas::tube::blast,
    ),
    of_scheme(
        "gas-yee",
        "isentropic vortex in the plane to t = 10 (Yee et al. 1999)",
        gas::yee::of,
    ),
    of_scheme(
        "gas-evrard",
        "cold collapse of 14 328 and of 102 208 particles to t = 0.8",
        gas::evrard::of,
    ),
    of_scheme(
        "gas-passing-rows",
        "change of the force as rows of particles pass each other, which should be none (Makino 2013)",
        gas::passing_rows::of,
    ),
    of_scheme(
        "gas-noise",
        "forces, velocities and energy flux of particles in steady shear, by distance and rate (Makino 2013)",
        gas::noise::of,
    ),
    of_scheme(
        "gas-oblique",
        "Sod's tube in the plane with lattices turned by 0 to 45 degrees, by every viscosity (Makino 2013)",
        gas::oblique::of,
    ),
    of_scheme(
        "gas-blob",
        "cloud in a wind of Mach number 2.7 (Agertz et al. 2007)",
        gas::blob::of,
    ),
];

/// The lists of all problems, in the order in which they run.
const LISTS: [&[Problem]; 4] = [
    PROBLEMS,
    dust::PROBLEMS,
    coupling::PROBLEMS,
    extremes::PROBLEMS,
];

/// Names of groups: each means all problems whose names begin with it and a dash.
const GROUPS: [&str; 4] = ["gas", "dust", "coupling", "extremes"];

fn problems() -> impl Iterator<Item = &'static Problem> {
    LISTS.into_iter().flatten()
}

impl Problem {
    /// Whether a name on the command line means this problem.
    fn is_meant(&self, name: &str) -> bool {
        let rest = self.name.strip_prefix(name);
        rest.is_some_and(|rest| rest.is_empty() || GROUPS.contains(&name) && rest.starts_with('-'))
    }
}

/// The problems that the names mean, all if there is none.
fn chosen(names: &[String]) -> Result<Vec<&'static Problem>, String> {
    let is_known = |name: &&String| problems().any(|problem| problem.is_meant(name));
    if let Some(stranger) = names.iter().find(|name| !is_known(name)) {
        let known: Vec<&str> = problems().map(|problem| problem.name).collect();
        return Err(format!(
            "there is no problem \"{stranger}\"; known are {}; and {} mean all whose names begin so",
            known.join(", "),
            GROUPS.join(", ")
        ));
    }
    let meant =
        |problem: &&Problem| names.is_empty() || names.iter().any(|name| problem.is_meant(name));
    Ok(problems().filter(meant).collect())
}

/// Runs the problems named, all if none is; prints a table of each as it is done. Answers whether all were at least acceptable.
pub fn verify(
    names: &[String],
    is_recommended: bool,
    set: &[String],
    pictures: Option<&Path>,
) -> Result<bool, String> {
    let problems = chosen(names)?;
    let scheme = Scheme::new(is_recommended, set, pictures)?;
    let mut verdicts = Vec::new();
    if let Some(other) = problems.iter().find(|p| !matches!(p.rows, Rows::Of(_)))
        && (is_recommended || !set.is_empty() || pictures.is_some())
    {
        return Err(format!(
            "--recommended, --set and --pictures belong to gas and the problems gas-...; \"{}\" takes none of them",
            other.name
        ));
    }
    let start = ProcessTime::now();
    for problem in problems {
        let since = ProcessTime::now();
        println!("{}: {}", problem.name, problem.about);
        let mut rows = match problem.rows {
            Rows::Own(rows) => rows(),
            Rows::Of(rows) => rows(&scheme),
            Rows::Cases(cases) => {
                verdicts.extend(extremes::table(cases()));
                continue;
            }
        };
        println!("| | measured | reference | difference | bars | |");
        println!("| --- | --- | --- | --- | --- | --- |");
        rows.push(Row::new(
            "CPU time, s",
            since.elapsed().as_secs_f64(),
            Bar::None,
        ));
        for row in rows {
            let verdict = row.verdict();
            verdicts.push(verdict);
            let [measured, reference, difference, bars] = row.cells();
            println!(
                "| {} | {measured} | {reference} | {difference} | {bars} | {verdict} |",
                row.what
            );
        }
    }
    let number = |verdict: &str| verdicts.iter().filter(|v| **v == verdict).count();
    println!(
        "{} good, {} acceptable, {} FAILED; {:.0} s of CPU time",
        number("good"),
        number("acceptable"),
        number("FAILED"),
        start.elapsed().as_secs_f64()
    );
    Ok(number("FAILED") == 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_judged_by_its_bars_and_a_number_that_is_none_fails() {
        let row = |measured, bar| Row {
            what: String::new(),
            measured,
            uncertainty: 0.1,
            bar,
        };
        let expected = ["good", "acceptable", "FAILED", "FAILED"];
        let reference = Bar::Reference {
            value: 2.0,
            good: 0.1,
            acceptable: 0.3,
        };
        for (bar, figures) in [
            (reference, [2.1, 1.5, 2.7, f64::NAN]),
            (Bar::Statistics(2.0), [2.15, 1.75, 2.31, f64::NAN]),
            (Bar::Least([0.5, -0.1]), [0.6, 0.0, -0.2, f64::NAN]),
            (
                Bar::Limit([1e-3, 2e-3]),
                [-0.9e-3, 1.1e-3, -2.1e-3, f64::NAN],
            ),
        ] {
            assert_eq!(figures.map(|figure| row(figure, bar).verdict()), expected);
        }
        assert_eq!(row(1.0, Bar::None).verdict(), "told");
    }

    #[test]
    fn a_group_means_the_problems_that_begin_with_its_name() {
        for group in ["gas", "dust"] {
            let problems = chosen(&[group.to_string()]).expect("a group");
            for problem in problems {
                assert_eq!(problem.name.split('-').next(), Some(group));
            }
        }
        for stranger in ["gas-", "stir", "dus"] {
            assert!(chosen(&[stranger.to_string()]).is_err(), "{stranger}");
        }
    }

    #[test]
    fn every_problem_of_the_gas_takes_a_scheme() {
        let problems = chosen(&["gas".to_owned()]).expect("a group");
        for problem in problems {
            assert!(matches!(problem.rows, Rows::Of(_)), "{}", problem.name);
        }
    }

    #[test]
    fn an_unknown_problem_is_refused_with_the_known_ones() {
        let refused = |name: &str, set: &[&str]| {
            let set: Vec<String> = set.iter().map(|key| key.to_string()).collect();
            verify(&[name.to_string()], false, &set, None).expect_err("a refusal")
        };
        let refusal = refused("stiring", &[]);
        assert!(refusal.contains("\"stiring\"") && refusal.contains("stirring-two-masses"));
        let refusal = refused("stirring", &["gas.viscosity.kind=balsara"]);
        assert!(refusal.contains("\"stirring\" takes none of them"));
    }
}
