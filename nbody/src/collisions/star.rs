//! The star's accretion radius: bodies that are within, or passed their pericentre there within the step.

use super::{Collision, Kind, Outcome};
use crate::bodies::Bodies;
use crate::orbit::Elements;
use crate::points::Vec3;

/// Accretes onto the star the bodies that are within its radius, or passed their pericentre there within the step of `dt` that ends now.
///
/// The star keeps its radius; the bodies' angular momentum about the centre of mass becomes its spin. Without a star, or with a star
/// without radius, nothing happens.
pub fn accrete(star: &mut Bodies, bodies: &Bodies, g: f64, now: f64, dt: f64) -> Outcome {
    let mut outcome = Outcome {
        keep: vec![true; bodies.x.len()],
        events: Vec::new(),
    };
    let Some(&radius) = star.radius.first().filter(|&&r| r > 0.0) else {
        return outcome;
    };
    let mut fallen: Vec<(f64, u64, usize)> = (0..bodies.x.len())
        .filter_map(|i| {
            let (d, w) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
            let mu = g * (star.m[0] + bodies.m[i]);
            Some((plunge(mu, d, w, radius, dt)?, bodies.id[i], i))
        })
        .collect();
    fallen.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    for (since, _, i) in fallen {
        outcome
            .events
            .push(swallow(star, bodies, i, g, now + since));
        outcome.keep[i] = false;
    }
    outcome
}

fn swallow(star: &mut Bodies, bodies: &Bodies, i: usize, g: f64, time: f64) -> Collision {
    let (d, w) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
    let (big, small, radius) = (star.m[0], bodies.m[i], star.radius[0]);
    let (total, share) = (big + small, small / (big + small));
    let distance = d.norm().max(f64::MIN_POSITIVE);
    let w2 = w.norm_squared();
    let speed2 = w2 + 2.0 * g * total * (1.0 / radius - 1.0 / distance);
    let speed = speed2.max(0.0).sqrt();
    let momentum = d.cross(&w);
    let sine = (momentum.norm() / (radius * speed)).min(1.0);
    star.x[0] += d * share;
    star.v[0] += w * share;
    star.m[0] = total;
    star.spin[0] += momentum * (big * share) + bodies.spin[i];
    Collision {
        time,
        kind: Kind::Accretion,
        id_kept: star.id[0],
        id_lost: bodies.id[i],
        mass_kept: big,
        mass_lost: small,
        mass_largest: total,
        fragments: 0,
        position: bodies.x[i],
        speed: speed / (2.0 * g * total / radius).sqrt(),
        angle: if speed > 0.0 { sine.asin() } else { 0.0 },
        energy_lost: big * share * 0.5 * w2 - g * big * small / distance,
    }
}

/// When, counted from now, a body entered the star: now if it is inside, at its pericentre if that lay inside and within the step.
fn plunge(mu: f64, d: Vec3, w: Vec3, radius: f64, dt: f64) -> Option<f64> {
    let r = d.norm();
    if r < radius {
        return Some(0.0);
    }
    let outwards = d.dot(&w);
    // Outside the star it went no faster than this since then.
    let fastest = (w.norm_squared() + 2.0 * mu / radius).sqrt();
    if outwards <= 0.0 || r - radius > dt * fastest {
        return None;
    }
    let ago = match Elements::of(mu, d, w) {
        Some(orbit) if orbit.pericentre_distance() < radius => {
            orbit.mean_anomaly / orbit.mean_motion(mu)
        }
        Some(_) => return None,
        None => r * r / outwards,
    };
    (ago <= dt).then_some(-ago)
}
