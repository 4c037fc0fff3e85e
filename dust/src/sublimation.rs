//! Sublimation and recondensation of ice: the exchange between the vapour of a room of gas and the grains that share it.
//!
//! Hertz and Knudsen: a surface loses ice at the rate c_v (rho_sat - rho_v) an area, c_v = sqrt(R T / 2 pi), R = k / m(H2O), so every mantle in
//! a room retreats by the same thickness l, whatever the grain's size:
//!     rho_ice dl/dt = c_v (rho_sat - rho_v),  rho_v = (q + M(l)) / V,  M(l) = sum n 4/3 pi rho_ice (s^3 - max(s - l, core)^3).
//! Over a step dt with the secant area A = M(l) / (rho_ice l) that is l = (c_v dt / rho_ice) (rho_sat - rho_v(0)) (1 - e^-y)/y, y = A c_v dt / V, an
//! equation for l with one root: exact for a constant area and in equilibrium, of second order between, and ice and vapour stay
//! positive at any step. Curvature and a sticking probability below one are left out; only ice sublimates.
//! Saturation over hexagonal ice: ln(P / Pa) = 9.550426 - 5723.265 / T + 3.53068 ln T - 0.00728332 T, T in K, above 110 K (Murphy & Koop 2005,
//! QJRMS 131, 1539, eq. 7).

use std::f64::consts::{PI, TAU};

/// Mass of a water molecule, g (18.0153 u, CODATA 2018).
pub const MOLECULE: f64 = 18.0153 * 1.660_539_07e-24;
/// Coefficients of 1, 1/T, ln T and T in ln P, P in pascals and T in kelvins.
pub const SATURATION: [f64; 4] = [9.550426, -5723.265, 3.53068, -0.00728332];

/// Water in code units and kelvins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Water {
    /// density of the ice
    pub ice: f64,
    /// gas constant of the vapour, P / (rho T)
    pub gas_constant: f64,
    /// coefficients of 1, 1/T, ln T and T in the logarithm of the saturation pressure
    pub saturation: [f64; 4],
}

impl Water {
    /// Density of saturated vapour.
    pub fn saturated(&self, temperature: f64) -> f64 {
        if temperature <= 0.0 {
            return 0.0;
        }
        let [a, b, c, d] = self.saturation;
        let log = a + b / temperature + c * temperature.ln() + d * temperature;
        log.exp() / (self.gas_constant * temperature)
    }

    /// c_v: what hits a surface, by the density of the vapour.
    pub fn arrival(&self, temperature: f64) -> f64 {
        (self.gas_constant * temperature / TAU).sqrt()
    }
}

/// The part of a swarm that shares a room.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// 4/3 pi rho_ice times the number of grains
    number: f64,
    radius: f64,
    core: f64,
    /// mass of the ice
    ice: f64,
}

impl Share {
    /// So many grains of these radii, with `ice` among them.
    pub fn new(number: f64, radius: f64, core: f64, ice: f64, water: &Water) -> Self {
        Self {
            number: 4.0 / 3.0 * PI * water.ice * number,
            radius,
            core,
            ice,
        }
    }

    fn thickness(&self) -> f64 {
        if self.ice > 0.0 {
            self.radius - self.core
        } else {
            0.0
        }
    }

    /// M(l): mass that retreat by `l` turns into vapour; negative for growth.
    pub fn lost(&self, l: f64) -> f64 {
        if l > 0.0 && l >= self.thickness() {
            return self.ice;
        }
        let s = self.radius;
        self.number * l * (3.0 * s * (s - l) + l * l)
    }

    /// dM/dl.
    fn surface(&self, l: f64) -> f64 {
        if l > 0.0 && l >= self.thickness() {
            return 0.0;
        }
        self.number * 3.0 * (self.radius - l).powi(2)
    }
}

/// Gas that shares its vapour with grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub volume: f64,
    /// mass of the vapour
    pub vapour: f64,
    pub temperature: f64,
}

/// (1 - e^-y) / y and its derivative.
fn relaxation(y: f64) -> (f64, f64) {
    if y < 1e-3 {
        let slope = -0.5 + y * (1.0 / 3.0 - y * (0.125 - y / 30.0));
        return (1.0 - y * (0.5 - y * (1.0 / 6.0 - y / 24.0)), slope);
    }
    let lost = -(-y).exp_m1();
    (lost / y, ((-y).exp() - lost / y) / y)
}

impl Room {
    /// l: by how much the mantles of all shares retreat in a step `dt`.
    pub fn retreat(&self, shares: &[Share], water: &Water, dt: f64) -> f64 {
        let thirst = water.saturated(self.temperature) - self.vapour / self.volume;
        let sweep = water.arrival(self.temperature) * dt;
        let (sign, most) = (thirst.signum(), sweep * thirst.abs() / water.ice);
        let area: f64 = shares.iter().map(|share| share.surface(0.0)).sum();
        let last = match sign > 0.0 {
            true => shares.iter().fold(0.0, |m: f64, s| m.max(s.thickness())),
            false => self.volume * thirst.abs() / area,
        };
        let bound = most.min(last);
        // Nothing to give or to take, or nowhere to take it from.
        if bound.is_nan() || bound <= 0.0 {
            return 0.0;
        }
        // Of |l| - most (1 - e^-y)/y.
        let excess = |x: f64| {
            let (lost, surface) = shares.iter().fold((0.0, 0.0), |(lost, surface), share| {
                (
                    lost + share.lost(sign * x),
                    surface + share.surface(sign * x),
                )
            });
            let (mean, turn) = (lost.abs() / x, sweep / (water.ice * self.volume));
            let (part, slope) = relaxation(turn * mean);
            (
                x - most * part,
                1.0 - most * slope * turn * (surface - mean) / x,
            )
        };
        if sign > 0.0 && bound == last && excess(last).0 <= 0.0 {
            return last;
        }
        let (part, _) = relaxation(area * sweep / (water.ice * self.volume));
        sign * root(bound, most * part, excess)
    }
}

/// The zero, between zero and `high`, of a function that is negative below and positive above, which tells its value and slope.
fn root(mut high: f64, start: f64, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let (mut low, mut x) = (0.0, start.min(high));
    for _ in 0..200 {
        let (value, slope) = f(x);
        if value < 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - x).abs() <= 2.0 * f64::EPSILON * next {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests;
