//! Hill's frame: coordinates that turn with a circular orbit at Omega, x outwards from the middle of the box, y along the motion.
//!
//! v_x' = 2 Omega v_y + 2 q Omega^2 (x - x_0),   v_y' = -2 Omega v_x
//! w = v + q Omega (x - x_0) e_y,   w_x' = 2 Omega w_y,   w_y' = -(2 - q) Omega w_x,   kappa^2 = 2 (2 - q) Omega^2
//!
//! Particles move on straight lines from kick to kick: opening a step h makes of the velocity the mean velocity of the free motion over h, closing
//! it makes of that the velocity again. So free motion is exact for any h, its canonical momentum v_y + 2 Omega (x - x_0) is kept whatever
//! the step is, and with pair forces in half kicks around it the step is symplectic. Within a step the place is of second order. Bodies, which
//! nobody looks at within their step, do the free motion over the whole of it at once.
//! Sources: Hill (1878); Goldreich & Lynden-Bell (1965); symmetric splitting of the epicycle: Quinn et al. (2010), AJ 139, 803.

use super::Vec3;

/// The frame; y and z axes have no origin in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hill {
    /// Omega.
    pub rate: f64,
    /// q, below 2: 1.5 about a point mass.
    pub shear: f64,
    /// x_0, where there is no tide.
    pub middle: f64,
}

/// How far a particle is in its step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phase {
    /// The planned length of the step, and the time since it began.
    pub step: f64,
    pub elapsed: f64,
}

/// Relative velocities over a time of free motion: w_x cos + lead w_y sin, w_y cos - lag w_x sin.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    cos: f64,
    lead: f64,
    lag: f64,
}

impl Turn {
    pub fn of(&self, w: Vec3) -> Vec3 {
        Vec3::new(
            self.cos * w.x + self.lead * w.y,
            self.cos * w.y - self.lag * w.x,
            w.z,
        )
    }
}

/// Free motion over a time.
#[derive(Clone, Copy, Debug)]
pub struct Free {
    hill: Hill,
    dt: f64,
    mean: Mean,
    turn: Turn,
}

impl Free {
    /// Where a particle at `x` with the velocity `v` is at the end, and how fast.
    pub fn of(&self, x: Vec3, v: Vec3) -> (Vec3, Vec3) {
        let w = self.hill.relative(x, v);
        let [along, across] = self.mean.of(w);
        let end = x + self.dt * Vec3::new(along, across + self.hill.stream(x), v.z);
        let turned = self.turn.of(w);
        (end, turned + Vec3::y() * self.hill.stream(end))
    }
}

/// Mean velocities over a time, relative to the shear at its beginning: (along w_x + across w_y, still w_y - across w_x).
#[derive(Clone, Copy, Debug)]
struct Mean {
    along: f64,
    across: f64,
    still: f64,
}

impl Mean {
    fn of(&self, w: Vec3) -> [f64; 2] {
        [
            self.along * w.x + self.across * w.y,
            self.still * w.y - self.across * w.x,
        ]
    }

    /// The velocity that has this mean; `z` goes through.
    fn before(&self, [x, y]: [f64; 2], z: f64) -> Vec3 {
        let inverse = 1.0 / (self.along * self.still + self.across * self.across);
        Vec3::new(
            (self.still * x - self.across * y) * inverse,
            (self.across * x + self.along * y) * inverse,
            z,
        )
    }
}

impl Hill {
    /// q Omega.
    pub fn gradient(&self) -> f64 {
        self.shear * self.rate
    }

    /// The velocity of the shear at `x`, along y.
    pub fn stream(&self, x: Vec3) -> f64 {
        -self.gradient() * (x.x - self.middle)
    }

    /// Velocity relative to the shear: the same for all images of a particle.
    pub fn relative(&self, x: Vec3, v: Vec3) -> Vec3 {
        Vec3::new(v.x, v.y - self.stream(x), v.z)
    }

    /// Its rate of change by the frame alone.
    pub fn turning(&self, w: Vec3) -> Vec3 {
        Vec3::new(
            2.0 * self.rate * w.y,
            (self.shear - 2.0) * self.rate * w.x,
            0.0,
        )
    }

    /// Acceleration by Coriolis force and tide.
    pub fn acceleration(&self, x: Vec3, v: Vec3) -> Vec3 {
        Vec3::new(
            2.0 * self.rate * self.relative(x, v).y,
            -2.0 * self.rate * v.x,
            0.0,
        )
    }

    fn epicyclic(&self) -> f64 {
        (2.0 * (2.0 - self.shear)).sqrt() * self.rate
    }

    /// What `dt` of free motion does to relative velocities.
    pub fn turn(&self, dt: f64) -> Turn {
        let angle = self.epicyclic() * dt;
        let (cos, sin) = (angle.cos(), dt * sine(angle));
        Turn {
            cos,
            lead: 2.0 * self.rate * sin,
            lag: (2.0 - self.shear) * self.rate * sin,
        }
    }

    fn mean(&self, dt: f64) -> Mean {
        let angle = self.epicyclic() * dt;
        let coriolis = 2.0 * self.rate * dt;
        let half = sine(0.5 * angle);
        Mean {
            along: sine(angle),
            across: coriolis * 0.5 * half * half,
            still: 1.0 - coriolis * coriolis * excess(angle),
        }
    }

    /// Free motion over `dt`, the whole of it at once.
    pub fn free(&self, dt: f64) -> Free {
        Free {
            hill: *self,
            dt,
            mean: self.mean(dt),
            turn: self.turn(dt),
        }
    }

    /// The mean velocity over a step that begins at `x` with `v`.
    pub fn opened(&self, x: Vec3, v: Vec3, step: f64) -> Vec3 {
        let [along, across] = self.mean(step).of(self.relative(x, v));
        Vec3::new(along, across + self.stream(x), v.z)
    }

    /// The velocity at `phase` of a step whose mean velocity is `mean`, on the straight way at `x`.
    pub fn seen(&self, x: Vec3, mean: Vec3, phase: Phase) -> Vec3 {
        let place = x.x - self.middle;
        let start = place - phase.elapsed * mean.x;
        let drift = [mean.x, mean.y + self.gradient() * start];
        let w = self.mean(phase.step).before(drift, mean.z);
        let canonical = w.y + (2.0 - self.shear) * self.rate * start;
        Vec3::new(
            self.turn(phase.elapsed).of(w).x,
            canonical - 2.0 * self.rate * place,
            w.z,
        )
    }

    /// The change of the mean velocity that changes the velocity at `phase` by `dv`.
    pub fn pushed(&self, dv: Vec3, phase: Phase) -> Vec3 {
        let (mean, turn) = (self.mean(phase.step), self.turn(phase.elapsed));
        let change = |x: f64, y: f64| {
            let start = -phase.elapsed * x;
            let w = mean.before([x, y + self.gradient() * start], 0.0);
            let canonical = w.y + (2.0 - self.shear) * self.rate * start;
            [turn.of(w).x, canonical]
        };
        let (a, b) = (change(1.0, 0.0), change(0.0, 1.0));
        let inverse = 1.0 / (a[0] * b[1] - a[1] * b[0]);
        Vec3::new(
            (b[1] * dv.x - b[0] * dv.y) * inverse,
            (a[0] * dv.y - a[1] * dv.x) * inverse,
            dv.z,
        )
    }
}

/// sin x / x.
fn sine(x: f64) -> f64 {
    if x.abs() < 1e-4 {
        1.0 - x * x / 6.0
    } else {
        x.sin() / x
    }
}

/// (x - sin x) / x^3.
fn excess(x: f64) -> f64 {
    if x.abs() > 0.5 {
        return (x - x.sin()) / (x * x * x);
    }
    // 1/3! - x^2/5! + ..., to x^12 for 16 digits at 0.5.
    let (mut term, mut sum) = (1.0 / 6.0, 1.0 / 6.0);
    for n in 2..8 {
        let k = f64::from(2 * n);
        term *= -x * x / (k * (k + 1.0));
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests;
