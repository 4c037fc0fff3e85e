//! Stopping time of a sphere in gas, and how far a relative speed decays in a given time.
//!
//! du/dt = -u / t(u) at frozen gas, u the speed relative to the gas, M = u / v_th, v_th = sqrt(8/pi) c, c the isothermal sound speed.
//! Epstein: t = rho_s s / (rho v_th f), f = sqrt(1 + 9 pi/128 (u/c)^2) (Kwok 1975, PASP 87, 583), within 1.5 % of the exact integral.
//! Stokes: t = 8 rho_s s / (3 C_D rho u), C_D = 24/Re, 24 Re^-0.6, 0.44 for Re < 1, < 800, above; Re = 2 s u / nu, nu = v_th l / 2
//! (Whipple 1972; Weidenschilling 1977, MNRAS 180, 57), l = mass / (cross section rho).
//! Auto: 1/t = (E^-4 + S^-4)^(-1/4), E Epstein's rate and S that of Stokes' law with the norm of order 32 of its three C_D: smooth in all it
//! depends on, at M < 0.01 t within 2.8 % of the laws joined by hand except for 1.1 l < s < 4.2 l, where it is longer by up to 19 % at 9/4 l (34 % at M = 0.2); subsonic beyond Epstein.
//! Bodies: C_D = 1 / (1 / (24/Re + 40/(10 + Re)) + 3 M/8) + (2 - w) M/(1 + M) + w, w = 0.4, or 0.2 above Re = 2e5: a smooth form
//! of the laws of Adachi, Hayashi & Nakazawa (1976, Prog. Theor. Phys. 56, 1756) as given by Tanigawa, Maruta & Machida (2014, ApJ 784, 109).

mod abreast;

use std::f64::consts::{LN_2, PI};

pub use abreast::Abreast;

/// Molecules of the gas: what the mean free path follows from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Molecules {
    /// mass of a molecule
    pub mass: f64,
    /// collision cross section of two molecules
    pub cross_section: f64,
}

/// A sphere: a grain of a swarm, or a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub radius: f64,
    /// material density
    pub density: f64,
}

/// The gas around a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ambient {
    /// density
    pub rho: f64,
    /// isothermal sound speed
    pub c: f64,
    /// orbital frequency; only constant Stokes numbers ask for it
    pub omega: f64,
}

/// How gas slows a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StoppingLaw {
    None,
    /// Free molecular flow.
    Epstein,
    /// Continuous flow at any Reynolds number.
    Stokes(Molecules),
    /// Epstein's law for spheres much smaller than 9/4 mean free paths, Stokes' for much larger ones, smoothly joined.
    Auto(Molecules),
    /// One smooth law for all Reynolds and Mach numbers.
    Adachi(Molecules),
    /// t is the same everywhere.
    ConstantStoppingTime(f64),
    /// t = stokes / omega.
    ConstantStokes(f64),
    /// du/dt = -coefficient u^2; the coefficient is an inverse length.
    Quadratic(f64),
}

/// Reynolds number of the drag crisis, where the boundary layer of a sphere becomes turbulent.
const CRISIS: f64 = 2e5;

impl Molecules {
    pub fn mean_free_path(&self, rho: f64) -> f64 {
        self.mass / (self.cross_section * rho)
    }

    /// Reynolds number of a sphere at unit speed.
    fn reynolds(&self, sphere: &Sphere, gas: &Ambient) -> f64 {
        4.0 * sphere.radius / (gas.thermal_speed() * self.mean_free_path(gas.rho))
    }
}

impl Ambient {
    /// Mean speed of the molecules.
    pub fn thermal_speed(&self) -> f64 {
        (8.0 / PI).sqrt() * self.c
    }
}

impl StoppingLaw {
    /// Whether the stopping time is the same at all speeds.
    pub fn is_linear(&self) -> bool {
        matches!(
            self,
            Self::None | Self::ConstantStoppingTime(_) | Self::ConstantStokes(_)
        )
    }

    /// The same law with another constant, where it is one of a constant time or number and `own` is not zero.
    pub fn with(self, own: f64) -> Self {
        match self {
            Self::ConstantStoppingTime(_) if own > 0.0 => Self::ConstantStoppingTime(own),
            Self::ConstantStokes(_) if own > 0.0 => Self::ConstantStokes(own),
            law => law,
        }
    }

    /// Stopping time at relative speed `speed`; infinite where nothing slows.
    pub fn stopping_time(&self, sphere: &Sphere, gas: &Ambient, speed: f64) -> f64 {
        1.0 / self.rate(sphere, gas, speed)
    }

    /// Inverse stopping time.
    fn rate(&self, sphere: &Sphere, gas: &Ambient, speed: f64) -> f64 {
        if gas.rho <= 0.0 {
            return 0.0;
        }
        match *self {
            Self::None => 0.0,
            Self::ConstantStoppingTime(t) => 1.0 / t,
            Self::ConstantStokes(stokes) => gas.omega / stokes,
            Self::Quadratic(coefficient) => coefficient * speed,
            Self::Epstein => epstein_rate(sphere, gas) * kwok(gas, speed),
            Self::Stokes(molecules) => {
                let per_speed = molecules.reynolds(sphere, gas);
                let branch = Branch::at(per_speed * speed);
                branch.coefficient(sphere, gas, per_speed) * speed.powf(branch.power)
            }
            Self::Auto(molecules) => auto_rate(&molecules, sphere, gas, speed),
            Self::Adachi(molecules) => adachi_rate(&molecules, sphere, gas, speed),
        }
    }

    /// ln(u(0) / u(dt)) for a start at `speed`: how often the relative speed falls by e within dt. Exact for every law but Adachi's and
    /// the joined one (1e-7).
    pub fn e_foldings(&self, sphere: &Sphere, gas: &Ambient, speed: f64, dt: f64) -> f64 {
        if gas.rho <= 0.0 || dt <= 0.0 {
            return 0.0;
        }
        match *self {
            Self::None | Self::ConstantStoppingTime(_) | Self::ConstantStokes(_) => {
                dt * self.rate(sphere, gas, speed)
            }
            Self::Quadratic(coefficient) => (coefficient * speed * dt).ln_1p(),
            Self::Epstein => {
                // With y = u/c sqrt(9 pi/128): y' = -y sqrt(1 + y^2) / t(0), so asinh(1/y) grows linearly.
                let x = dt * epstein_rate(sphere, gas);
                let y2 = KWOK * (speed / gas.c).powi(2);
                let excess = 0.5 * y2 / (1.0 + (1.0 + y2).sqrt());
                x + (excess * -(-2.0 * x).exp_m1()).ln_1p()
            }
            Self::Stokes(molecules) => stokes_e_foldings(&molecules, sphere, gas, speed, dt),
            Self::Auto(molecules) => {
                if sphere.radius < FREE * molecules.mean_free_path(gas.rho) {
                    return Self::Epstein.e_foldings(sphere, gas, speed, dt);
                }
                let t = |u: f64| 1.0 / auto_rate(&molecules, sphere, gas, u);
                integrated_e_foldings(t, 0.0, speed, dt)
            }
            Self::Adachi(molecules) => {
                let crisis = CRISIS / molecules.reynolds(sphere, gas);
                let t = |u: f64| 1.0 / adachi_rate(&molecules, sphere, gas, u);
                integrated_e_foldings(t, crisis, speed, dt)
            }
        }
    }

    /// u(dt) / u(0) for a start at `speed`.
    pub fn decay(&self, sphere: &Sphere, gas: &Ambient, speed: f64, dt: f64) -> f64 {
        (-self.e_foldings(sphere, gas, speed, dt)).exp()
    }
}

const KWOK: f64 = 9.0 * PI / 128.0;

fn kwok(gas: &Ambient, speed: f64) -> f64 {
    (1.0 + KWOK * (speed / gas.c).powi(2)).sqrt()
}

fn epstein_rate(sphere: &Sphere, gas: &Ambient) -> f64 {
    gas.rho * gas.thermal_speed() / (sphere.density * sphere.radius)
}

/// A range of Reynolds numbers, from `floor` up, in which C_D = factor Re^(power - 1), so that 1/t is proportional to u^power.
struct Branch {
    floor: f64,
    factor: f64,
    power: f64,
}

impl Branch {
    fn at(reynolds: f64) -> Self {
        let (floor, factor, power) = if reynolds > 800.0 {
            (800.0, 0.44, 1.0)
        } else if reynolds > 1.0 {
            (1.0, 24.0, 0.4)
        } else {
            (0.0, 24.0, 0.0)
        };
        Self {
            floor,
            factor,
            power,
        }
    }

    /// 1 / (t u^power); `per_speed` is the Reynolds number at unit speed.
    fn coefficient(&self, sphere: &Sphere, gas: &Ambient, per_speed: f64) -> f64 {
        0.375 * self.factor * per_speed.powf(self.power - 1.0) * gas.rho
            / (sphere.density * sphere.radius)
    }
}

/// Follows the speed down through the branches; in each of them the decay has a closed form.
fn stokes_e_foldings(
    molecules: &Molecules,
    sphere: &Sphere,
    gas: &Ambient,
    speed: f64,
    dt: f64,
) -> f64 {
    let per_speed = molecules.reynolds(sphere, gas);
    let (mut u, mut left, mut x) = (speed, dt, 0.0);
    loop {
        let branch = Branch::at(per_speed * u);
        let coefficient = branch.coefficient(sphere, gas, per_speed);
        if branch.power == 0.0 {
            return x + coefficient * left;
        }
        let rate = coefficient * u.powf(branch.power);
        let to_floor = (per_speed * u / branch.floor).ln();
        let time = (branch.power * to_floor).exp_m1() / (branch.power * rate);
        if time >= left {
            return x + (branch.power * rate * left).ln_1p() / branch.power;
        }
        // A hair below the floor, to be in the next branch.
        (u, left, x) = (
            branch.floor / per_speed * (1.0 - 1e-15),
            left - time,
            x + to_floor,
        );
    }
}

/// Radii by the mean free path below which the joined law is Epstein's to 1e-9 at all speeds.
const FREE: f64 = 0.015;

/// 1/t of the laws of Epstein and Stokes, joined; finite at rest.
fn auto_rate(molecules: &Molecules, sphere: &Sphere, gas: &Ambient, speed: f64) -> f64 {
    let per_speed = molecules.reynolds(sphere, gas);
    let reynolds = per_speed * speed;
    // C_D by 24/Re, whose three branches meet at Re = 1 and 800.
    let [slow, fast] = [reynolds.powf(0.4), 0.44 / 24.0 * reynolds];
    let most = slow.max(fast).max(1.0);
    let powers = [1.0, slow, fast].map(|branch| (branch / most).powi(32));
    let drag = most * powers.iter().sum::<f64>().powf(1.0 / 32.0);
    let continuous = 9.0 * gas.rho / (per_speed * sphere.density * sphere.radius) * drag;
    let free = epstein_rate(sphere, gas) * kwok(gas, speed);
    let (less, ratio) = if free < continuous {
        (free, free / continuous)
    } else {
        (continuous, continuous / free)
    };
    less / (1.0 + ratio.powi(4)).sqrt().sqrt()
}

/// 1/t of the smooth law, written such that it is finite at rest.
fn adachi_rate(molecules: &Molecules, sphere: &Sphere, gas: &Ambient, speed: f64) -> f64 {
    let per_speed = molecules.reynolds(sphere, gas);
    let (reynolds, v_th) = (per_speed * speed, gas.thermal_speed());
    let mach = speed / v_th;
    let w = if reynolds > CRISIS { 0.2 } else { 0.4 };
    let creeping = 1.0 / (per_speed / (24.0 + 40.0 * reynolds / (10.0 + reynolds)) + 0.375 / v_th);
    let drag_times_speed = creeping + speed * ((2.0 - w) * mach / (1.0 + mach) + w);
    0.375 * gas.rho * drag_times_speed / (sphere.density * sphere.radius)
}

/// Nodes and weights of Gauss's rule with four points on [0, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_2, 0.173_927_422_568_726_93),
];

/// The interval of `depth` e-foldings from `u` down, halved until halving it once more changes the time that it takes by less than 1e-8;
/// and that time.
fn halved(elapsed: &impl Fn(f64, f64) -> f64, u: f64, mut depth: f64) -> (f64, f64) {
    let mut time = elapsed(u, depth);
    for _ in 0..12 {
        let half = 0.5 * depth;
        let first = elapsed(u, half);
        let whole = first + elapsed(u * (-half).exp(), half);
        if (whole - time).abs() <= 1e-8 * whole {
            return (depth, whole);
        }
        (depth, time) = (half, first);
    }
    (depth, time)
}

/// Inverts dt = integral of t(u) d ln u, in intervals of at most a factor two in speed that do not straddle `jump`.
fn integrated_e_foldings(t: impl Fn(f64) -> f64, jump: f64, speed: f64, dt: f64) -> f64 {
    let elapsed = |u: f64, depth: f64| {
        depth
            * GAUSS
                .iter()
                .map(|(node, weight)| weight * t(u * (-node * depth).exp()))
                .sum::<f64>()
    };
    let (mut u, mut left, mut x) = (speed, dt, 0.0);
    loop {
        let here = t(u);
        if u == 0.0 || (t(0.5 * u) / here - 1.0).abs() < 1e-9 {
            return x + left / here;
        }
        let depth = if u > jump && 0.5 * u < jump {
            (u / jump).ln() * (1.0 + 1e-15) + 1e-15
        } else {
            LN_2
        };
        let (depth, time) = halved(&elapsed, u, depth);
        if time >= left {
            let mut part = depth * left / time;
            for _ in 0..4 {
                part -= (elapsed(u, part) - left) / t(u * (-part).exp());
            }
            return x + part;
        }
        (u, left, x) = (u * (-depth).exp(), left - time, x + depth);
    }
}

#[cfg(test)]
mod tests;
