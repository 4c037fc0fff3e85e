//! Sod's shock tube in three dimensions, gamma = 5/3, 57 600 particles on body-centred lattices, at t = 0.2.
//!
//! L1 = sum (m/rho) |f - exact| / sum (m/rho) over |x - 1| < 0.5. Exact solution: Toro (2009), chapter 4.

use super::{Bar, End, Row, both, pair};

const SCENE: &str = include_str!("../../../gas/sod.toml");
const END: f64 = 0.2;
const GAMMA: f64 = 5.0 / 3.0;

pub fn rows() -> Vec<Row> {
    let runs = both(SCENE, END, |_| {});
    let [rho, v] = errors(&runs[0]);
    let [rho_between, v_between] = differences(&runs);
    // SWIFT's density SPH at this number of particles: 0.0084 and 0.0198.
    [
        pair(
            "L1 of density",
            Bar::Limit([0.0055, 0.0084]),
            rho,
            rho_between,
        ),
        pair("L1 of velocity", Bar::Limit([0.018, 0.0198]), v, v_between),
    ]
    .concat()
}

/// The L1 errors of density and velocity.
fn errors(run: &End) -> [f64; 2] {
    let fan = Fan::default();
    mean(run, |i| {
        let particle = &run.gas[i];
        let [rho, v, _] = fan.at((particle.x.x - 1.0) / END);
        [(particle.rho - rho).abs(), (particle.v.x - v).abs()]
    })
}

/// The L1 differences between two runs, particle by particle.
fn differences([a, b]: &[End; 2]) -> [f64; 2] {
    mean(a, |i| {
        let (a, b) = (&a.gas[i], &b.gas[i]);
        [(a.rho - b.rho).abs(), (a.v.x - b.v.x).abs()]
    })
}

/// The mean over the middle of the tube, weighted by volume.
fn mean(run: &End, value: impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
    let (mut sum, mut volume) = ([0.0; 2], 0.0);
    for (i, particle) in run.gas.iter().enumerate() {
        if (particle.x.x - 1.0).abs() < 0.5 {
            let part = particle.m / particle.rho;
            volume += part;
            for (sum, value) in sum.iter_mut().zip(value(i)) {
                *sum += part * value;
            }
        }
    }
    sum.map(|sum| sum / volume)
}

/// The exact solution of the tube, gamma = 5/3, from (rho, P) = (1, 1) on the left and (0.125, 0.1) on the right, in these units:
/// rarefaction to the left, contact, shock to the right (Toro 2009, chapter 4).
pub struct Fan {
    /// Velocity and pressure of the contact; densities on its left and right.
    v: f64,
    p: f64,
    rho: [f64; 2],
    /// Speeds of the rarefaction's head and tail, and of the shock.
    head: f64,
    tail: f64,
    shock: f64,
}

impl Default for Fan {
    fn default() -> Self {
        let (rl, pl, rr, pr) = (1.0f64, 1.0f64, 0.125f64, 0.1f64);
        let g = GAMMA;
        let (cl, cr) = ((g * pl / rl).sqrt(), (g * pr / rr).sqrt());
        let expansion = |p: f64| (p / pl).powf((g - 1.0) / (2.0 * g));
        let rarefied = |p: f64| 2.0 * cl / (g - 1.0) * (1.0 - expansion(p));
        let shocked = |p: f64| (p - pr) * (2.0 / (rr * ((g + 1.0) * p + (g - 1.0) * pr))).sqrt();
        let (mut lo, mut hi) = (pr, pl);
        for _ in 0..100 {
            let p = 0.5 * (lo + hi);
            if shocked(p) < rarefied(p) {
                lo = p
            } else {
                hi = p
            }
        }
        let p = 0.5 * (lo + hi);
        let (v, q) = (shocked(p), p / pr);
        Self {
            v,
            p,
            rho: [
                rl * (p / pl).powf(1.0 / g),
                rr * ((g + 1.0) * q + g - 1.0) / ((g - 1.0) * q + g + 1.0),
            ],
            head: -cl,
            tail: v - cl * expansion(p),
            shock: cr * ((g + 1.0) / (2.0 * g) * q + (g - 1.0) / (2.0 * g)).sqrt(),
        }
    }
}

impl Fan {
    /// Density, velocity and pressure at xi = x / t, where x is counted from the diaphragm.
    pub fn at(&self, xi: f64) -> [f64; 3] {
        if xi < self.head {
            [1.0, 0.0, 1.0]
        } else if xi < self.tail {
            let g = GAMMA;
            let k = 2.0 / (g + 1.0) - (g - 1.0) / (g + 1.0) * xi / -self.head;
            let v = 2.0 / (g + 1.0) * (xi - self.head);
            [k.powf(2.0 / (g - 1.0)), v, k.powf(2.0 * g / (g - 1.0))]
        } else if xi < self.v {
            [self.rho[0], self.v, self.p]
        } else if xi < self.shock {
            [self.rho[1], self.v, self.p]
        } else {
            [0.125, 0.0, 0.1]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_solution_is_that_of_the_reference_table() {
        // States between the waves: u = 0.841194852169, rho = 0.479689058721 and 0.229805749312, shock at 1.84447336705.
        let fan = Fan::default();
        assert!((fan.v - 0.841_194_852_169).abs() < 1e-10);
        assert!((fan.rho[0] - 0.479_689_058_721).abs() < 1e-10);
        assert!((fan.rho[1] - 0.229_805_749_312).abs() < 1e-10);
        assert!((fan.shock - 1.844_473_367_05).abs() < 1e-10);
        // The fan meets its neighbours.
        for edge in [fan.head, fan.tail] {
            let (below, above) = (fan.at(edge - 1e-9), fan.at(edge + 1e-9));
            for (below, above) in below.into_iter().zip(above) {
                assert!((below - above).abs() < 1e-8);
            }
        }
    }
}
