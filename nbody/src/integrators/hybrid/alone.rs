//! Bodies alone: those without a neighbour, each on its Kepler orbit about the star.

use rayon::prelude::*;

use super::Stuck;
use crate::bodies::Bodies;
use crate::kepler::{self, abreast::drift_all};
use crate::points::Vec3;
use crate::points::sum::CHUNK;

/// Moves everybody but the members of clusters along their Kepler orbits. Members go along circles, which is simpler than to leave them
/// out: their state is replaced afterwards.
pub fn alone(mu: f64, dt: f64, bodies: &mut Bodies, members: &[u32]) -> Result<(), Stuck> {
    for &i in members {
        let r = bodies.x[i as usize].norm();
        let r = if r.is_normal() { r } else { 1.0 };
        bodies.x[i as usize] = Vec3::x() * r;
        bodies.v[i as usize] = Vec3::y() * (mu / r).sqrt();
    }
    let stuck = |(place, refusal): (usize, kepler::Refusal)| Stuck {
        place,
        reason: refusal.into(),
    };
    if bodies.x.len() <= CHUNK {
        return drift_all(mu, dt, &mut bodies.x, &mut bodies.v).map_err(stuck);
    }
    let chunks = bodies
        .x
        .par_chunks_mut(CHUNK)
        .zip(bodies.v.par_chunks_mut(CHUNK));
    let first = chunks.enumerate().filter_map(|(k, (x, v))| {
        let (place, refusal) = drift_all(mu, dt, x, v).err()?;
        Some((k * CHUNK + place, refusal))
    });
    let first = first.min_by_key(|&(place, _)| place);
    first.map_or(Ok(()), |first| Err(stuck(first)))
}
