//! Cooling: gas gives off its heat, or is brought to the temperature of its place, in a time of its own.
//!
//! du/dt = du_hydro/dt - (u - u_0) / t_cool,   t_cool = beta / Omega(R) or a given time
//! u_0 = c_0^2 (R / R_0)^(-2 exponent) / (gamma - 1);   R the distance from the star's axis
//!
//! What u has grown to at the end of a step, u_b + H by heat and work H, is replaced by what it is by the law with du_hydro/dt = H/dt:
//! u_0 + (u_b - u_0) e^-x + H (1 - e^-x) / x,   x = dt / t_cool at mid-step.   Exact without heating, for any dt; u_0 + H t_cool / dt where
//! cooling is fast. Where u_0 changes on the way of the gas, that counts as heat with the other sign. Second order: H is taken by the rate at the end of the step, which saw u cool (`foresee`). Gas of u < u_0 stays as it is
//! unless the law warms. What is taken is booked as radiated to the last bit.
//! Sources: Gammie (2001), ApJ 553, 174 (beta); Cox & Matthews (2002), J. Comput. Phys. 176, 430, eq. 4 (the exponential step).

use nbody::points::clock::Centre;
use nbody::points::sum::{self, Parts};
use nbody::points::{Clock, Vec3};

use crate::{Gas, Heat};

/// What the time of cooling is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Duration {
    /// So many 1/Omega.
    Orbital(f64),
    Time(f64),
}

/// Isothermal sound speeds about the star: `sound_speed` at `radius`, falling by `exponent`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    pub sound_speed: f64,
    pub radius: f64,
    pub exponent: f64,
}

/// The law of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cooling {
    pub duration: Duration,
    /// What gas is brought to; nothing: it cools until it is cold.
    pub profile: Option<Profile>,
    /// Whether gas that is colder than the profile is warmed.
    pub warms: bool,
    /// Adiabatic index of the gas.
    pub gamma: f64,
}

/// The least part that the estimate of heat leaves of what cooling alone would.
const LEAST_PART: f64 = 0.1;

/// Where gas stands and how fast it moves away from the star's axis.
#[derive(Clone, Copy)]
struct Place {
    radius: f64,
    receding: f64,
}

impl Place {
    fn new(x: Vec3, v: Vec3) -> Self {
        let (x, v) = (x.xy(), v.xy());
        let radius = x.norm();
        Self {
            radius,
            receding: if radius > 0.0 {
                x.dot(&v) / radius
            } else {
                0.0
            },
        }
    }

    /// The distance at `dt` from now.
    fn at(self, dt: f64) -> f64 {
        (self.radius + dt * self.receding).max(0.5 * self.radius)
    }
}

/// What cooling makes of a particle.
struct Cooled {
    u: f64,
    /// Whether the estimate of heat had to be cut.
    cut: bool,
}

impl Cooling {
    /// x of a time `dt` at `radius`, about a mass of `gm`.
    fn depth(&self, dt: f64, radius: f64, gm: f64) -> f64 {
        match self.duration {
            _ if dt == 0.0 => 0.0,
            Duration::Orbital(beta) => dt * (gm / radius.powi(3)).sqrt() / beta,
            Duration::Time(time) => dt / time,
        }
    }

    /// u_0 at `radius`.
    fn rest(&self, radius: f64) -> f64 {
        self.profile.map_or(0.0, |profile| {
            let c = profile.sound_speed * (radius / profile.radius).powf(-profile.exponent);
            c * c / (self.gamma - 1.0)
        })
    }

    /// What becomes of `u`, that has gained `heat` over the step more than what it goes to, towards `rest` at depth x.
    fn cooled(&self, u: f64, heat: f64, rest: f64, depth: f64) -> Cooled {
        if depth == 0.0 || (u <= rest && !self.warms) {
            return Cooled { u, cut: false };
        }
        let left = (-depth).exp();
        // (1 - e^-x) / x - e^-x: what is left of heat beyond what is left of the rest.
        let late = -(-depth).exp_m1() / depth - left;
        let alone = rest + (u - rest) * left;
        let wanted = alone + heat * late;
        let wanted = match self.warms {
            true => wanted,
            false => wanted.clamp(rest, u),
        };
        let least = LEAST_PART * alone.min(u);
        Cooled {
            u: wanted.max(least),
            cut: wanted < least,
        }
    }
}

impl Gas {
    /// Cools the particles whose steps end now over these steps, after all else that closes them; `centre` is the star and `drift` its
    /// velocity.
    pub fn cool(&mut self, cooling: &Cooling, clock: &Clock, centre: &Centre, drift: Vec3) -> Heat {
        let p = &mut self.particles;
        let (x, v, m, begin) = (&p.x, &p.v, &p.m, &p.begin);
        let (u, u_pred) = (Parts::new(&mut p.u), Parts::new(&mut self.rates.u_pred));
        let (active, du) = (&self.vicinity.active, &self.rates.du);
        sum::ordered(active.len(), Heat::default(), |range| {
            active[range].iter().fold(Heat::default(), |heat, &i| {
                let i = i as usize;
                let dt = f64::from(clock.tick - begin[i]) * clock.unit();
                let place = Place::new(x[i] - centre.x, v[i] - drift);
                let depth = cooling.depth(dt, place.at(-0.5 * dt), centre.gm);
                let (rest, before) = (cooling.rest(place.radius), cooling.rest(place.at(-dt)));
                // SAFETY: each active particle is listed once.
                let (u, u_pred) = unsafe { (u.part(i..i + 1), u_pred.part(i..i + 1)) };
                let cooled = cooling.cooled(u[0], du[i] * dt - (rest - before), rest, depth);
                let taken = m[i] * (u[0] - cooled.u);
                (u[0], u_pred[0]) = (cooled.u, cooled.u);
                heat + Heat {
                    radiated: taken,
                    floors: usize::from(cooled.cut),
                    ..Heat::default()
                }
            })
        })
    }

    /// Lets the prediction of the steps that begin now cool; before anything opens them.
    pub fn foresee(&mut self, cooling: &Cooling, next: &Clock, centre: &Centre, drift: Vec3) {
        let (p, r) = (&self.particles, &mut self.rates);
        for &i in &self.vicinity.active {
            let i = i as usize;
            let dt = f64::from(r.next_span[i]) * next.unit();
            let (u, heat) = (p.u[i], r.du[i] * dt);
            if !(dt > 0.0 && u > 0.0) {
                continue;
            }
            let place = Place::new(p.x[i] - centre.x, p.v[i] - drift);
            let depth = cooling.depth(dt, place.at(0.5 * dt), centre.gm);
            let (rest, before) = (cooling.rest(place.at(dt)), cooling.rest(place.radius));
            // Gas that heat or work alone would take below nothing is taken to cool by the law alone.
            let grown = if u + heat > 0.0 { u + heat } else { u };
            let end = cooling.cooled(grown, grown - u - (rest - before), rest, depth);
            // The prediction of what loses energy is a decay.
            let end = end.u.max(f64::MIN_POSITIVE);
            r.du[i] = match end < u {
                true => u * (end / u).ln() / dt,
                false => (end - u) / dt,
            };
        }
    }
}

#[cfg(test)]
mod tests;
