//! The shortened form of a scene: the end time, and if need be the particle numbers, at which all settings together fit into a budget.
//!
//! Each setting is sampled for a moment; what its CPU time a unit of time is then gives the end time. Particles are thinned out only if the scene
//! would not last an orbit at its inner edge otherwise; a CPU time ~ N^(4/3) says by how much.

use std::f64::consts::TAU;
use std::path::Path;

use super::settings::{Setting, Source};
use crate::atomic::publish_bytes;
use crate::cost;
use crate::run::RunError;
use crate::scene::{Orbit, Scene};
use crate::signals;
use crate::thin::thinned;
use crate::units::System;

/// Wall-clock time of a sample, s.
const MOMENT: f64 = 0.2;
/// What is spent on samples of each setting rather than of a typical one alone, as a part of the budget.
const SAMPLES: f64 = 0.05;
/// Base steps that a shortened scene has at least.
const STEPS: f64 = 3.0;

/// What has been done to a scene to make it short.
#[derive(Clone, Debug, PartialEq)]
pub struct Short {
    /// As of `--set`.
    pub overrides: Vec<String>,
    pub sentence: String,
}

impl Default for Short {
    /// Nothing.
    fn default() -> Self {
        Self {
            overrides: Vec::new(),
            sentence: "not shortened".to_owned(),
        }
    }
}

/// What a folder remembers of an earlier call that traded the same, so that its runs are found again; else what is made now.
pub fn remembered(
    folder: &Path,
    of: &str,
    make: impl FnOnce() -> Result<Short, RunError>,
) -> Result<Short, RunError> {
    let file = folder.join("shortened.json");
    let known = std::fs::read_to_string(&file).ok();
    let known = known.and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
    if let Some(known) = known.filter(|known| known["of"] == of) {
        let list = known["overrides"].as_array().into_iter().flatten();
        return Ok(Short {
            overrides: list.filter_map(|x| x.as_str().map(str::to_owned)).collect(),
            sentence: known["sentence"].as_str().unwrap_or_default().to_owned(),
        });
    }
    let short = make()?;
    if signals::caught().is_some() {
        return Ok(short);
    }
    let all = serde_json::json!({
        "of": of,
        "overrides": short.overrides,
        "sentence": short.sentence,
    });
    std::fs::create_dir_all(folder).map_err(|error| {
        let place = folder.display();
        RunError::Refused(format!("the folder {place} cannot be used: {error}"))
    })?;
    publish_bytes(&file, format!("{all:#}\n").as_bytes())?;
    Ok(short)
}

/// What every setting is run with besides.
pub fn quiet() -> Vec<String> {
    [
        "run.snapshots=[]",
        "run.checkpoint=\"1 min\"",
        "run.write_accelerations=false",
    ]
    .map(str::to_owned)
    .to_vec()
}

/// Shortens the scene of `source` so that the settings that `make` makes of it take `budget` seconds of CPU time in all.
pub fn shorten(
    source: &Source,
    make: impl Fn(&Source) -> Vec<Setting>,
    budget: f64,
    may_thin: bool,
) -> Result<Short, RunError> {
    let whole = source.scene(&[]).map_err(RunError::Refused)?;
    let least = orbit(&whole)
        .unwrap_or(0.1 * whole.run.end_time)
        .min(whole.run.end_time);
    let (mut thin, mut part) = (Vec::new(), 1.0);
    for attempt in 0..4 {
        let mut here = source.clone();
        here.overrides.extend(thin.iter().cloned());
        let (lasting, longest) = lasting(&make(&here), budget)?;
        if lasting >= least || !may_thin || attempt == 3 {
            return Ok(short(&whole, lasting.max(STEPS * longest), part, thin));
        }
        part *= (lasting / least).powf(0.75).max(0.05);
        let thinner = thinned(&whole, &source.entries(), part);
        if thinner == thin {
            return Ok(short(&whole, lasting.max(STEPS * longest), part, thin));
        }
        thin = thinner;
    }
    unreachable!("the last attempt returns")
}

/// The scene in `lasting` units of time, or to its end.
fn short(whole: &Scene, lasting: f64, part: f64, thin: Vec<String>) -> Short {
    let (factor, unit) = match whole.units.system {
        System::Astronomical => (TAU.recip(), " yr"),
        System::Dimensionless => (1.0, ""),
        System::Cgs => (1.0, " s"),
    };
    let end = round(lasting * factor);
    let cut = end < whole.run.end_time * factor;
    let fewer = if thin.is_empty() {
        String::new()
    } else {
        format!(", {part:.3} of the particles ({})", thin.join(", "))
    };
    let all = whole.run.end_time * factor;
    let sentence = match (cut, thin.is_empty()) {
        (true, _) => format!("shortened to {end:.6}{unit} of {all:.6}{unit}{fewer}"),
        (false, false) => format!("shortened: whole time, but{}", &fewer[1..]),
        (false, true) => "not shortened: the budget lasts to the end".to_owned(),
    };
    let mut overrides = thin;
    if cut {
        let value = if unit.is_empty() {
            format!("{end:?}")
        } else {
            format!("\"{end:?}{unit}\"")
        };
        overrides.push(format!("run.end_time={value}"));
    }
    Short {
        overrides,
        sentence,
    }
}

/// The time that all settings can be run to, and their longest base step.
fn lasting(settings: &[Setting], budget: f64) -> Result<(f64, f64), RunError> {
    let scenes: Vec<&Scene> = settings
        .iter()
        .filter_map(|s| s.scene.as_deref().ok())
        .collect();
    let (mut rate, mut start, mut longest, mut spent) = (0.0, 0.0, 0.0f64, 0.0);
    let mut sampled = 0;
    // The first is the reference, the dearest of all; one in the middle stands for those that there is no time for.
    let middle = scenes.len() / 2;
    let order = [0, middle]
        .into_iter()
        .chain((1..scenes.len()).filter(|&i| i != middle));
    let mut first_rate = 0.0;
    for i in order.take(scenes.len()) {
        if signals::caught().is_some() || sampled >= 2 && spent > SAMPLES * budget {
            break;
        }
        let began = cpu_time::ProcessTime::now();
        // A scene that fails in its first steps fails in its row.
        if let Ok(sample) = cost::sample(scenes[i], MOMENT) {
            let cost = sample.cost;
            let each = cost.rate + cost.report_s * cost.reports / cost.end;
            rate += each;
            start += cost.start_s;
            if cost.longest.is_finite() {
                longest = longest.max(cost.longest);
            }
            if sampled == 0 {
                first_rate = each;
            }
        }
        sampled += 1;
        spent += began.elapsed().as_secs_f64();
    }
    if rate == 0.0 {
        return Ok((f64::INFINITY, longest));
    }
    // Those without a sample cost what the others do, the reference apart.
    let (others, all) = ((sampled - 1).max(1) as f64, (scenes.len() - 1) as f64);
    let rate = first_rate + (rate - first_rate).max(0.0) / others * all;
    let start = start / sampled as f64 * scenes.len() as f64;
    Ok(((budget - start).max(0.1 * budget) / rate, longest))
}

/// Two digits, downwards.
fn round(time: f64) -> f64 {
    if !time.is_finite() {
        return time;
    }
    let unit = 10f64.powf(time.log10().floor() - 1.0);
    (time / unit).floor() * unit
}

/// The shortest orbital period that the scene names; none without a star.
fn orbit(scene: &Scene) -> Option<f64> {
    if let Some(hill) = scene.domain.hill() {
        return Some(TAU / hill.rate);
    }
    let star = scene.star?;
    let planets = scene.planets.iter().map(|planet| match planet.orbit {
        Orbit::Elements {
            semi_major_axis, ..
        } => semi_major_axis,
        Orbit::State { position, .. } => position.norm(),
    });
    let gas = scene
        .gas
        .as_ref()
        .and_then(|gas| gas.disk)
        .map(|disk| disk.inner_radius);
    let belt = scene
        .planetesimals
        .filter(|p| p.number > 0)
        .map(|p| p.inner_radius);
    let inner = planets.chain(gas).chain(belt).reduce(f64::min)?;
    Some(TAU * (inner.powi(3) / (scene.gravity.constant * star.mass)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_times_have_two_digits() {
        assert!((round(123.4) - 120.0).abs() < 1e-9);
        assert!((round(0.0099) - 0.0099).abs() < 1e-9);
        assert_eq!(round(f64::INFINITY), f64::INFINITY);
    }
}
