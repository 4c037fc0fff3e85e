//! Stationary shocks in isothermal gas (c = 1) and dust: two streams of the mixture meet in a plane.
//!
//! In the frame of the shock, w = v / v_s, M = v_s / c, D = dust to gas: w_g + 1/(M^2 w_g) + D w_d = 1 + 1/M^2 + D,
//! w_d dw_d/dxi = w_g - w_d for a constant stopping time t, xi the distance by v_s t; behind w = 1/(M^2 (1 + D)). M > 1: the gas jumps
//! to 1/M^2 first ("J"); below: all is smooth ("C"). L1: mean over particles of |w - exact|, the front at the place that makes that of the dust least.
//! Source: Lehmann & Wardle 2018 (MNRAS 476, 3185), who take a constant drag coefficient instead.

use super::{Bar, Mixture, Row, State, Trial, mixtures};

/// A shock, and the run that makes it; the stopping time is 1.
struct Shock {
    mach: f64,
    dust_to_gas: f64,
    end: f64,
    /// Half the box: what happens at its ends does not arrive before the end.
    half: f64,
    /// Around the front that is compared, in xi.
    window: [f64; 2],
}

const J: Shock = Shock {
    mach: 2.0,
    dust_to_gas: 1.0,
    end: 16.0,
    half: 54.0,
    window: [-1.0, 1.5],
};

const C: Shock = Shock {
    mach: 0.9,
    dust_to_gas: 1.0,
    end: 40.0,
    half: 76.0,
    window: [-5.0, 5.0],
};

/// Distance of particles before the shock.
const SPACING: f64 = 0.25;
/// Rows of particles.
const ROWS: f64 = 8.0;

/// Velocities of dust along xi, which begin at 1.
struct Profile {
    start: f64,
    step: f64,
    dust: Vec<f64>,
}

impl Shock {
    fn behind(&self) -> f64 {
        1.0 / (self.mach * self.mach * (1.0 + self.dust_to_gas))
    }

    /// Of the gas where the dust has `dust`.
    fn gas(&self, dust: f64) -> f64 {
        let inverse = 1.0 / (self.mach * self.mach);
        let sum = 1.0 + inverse + self.dust_to_gas * (1.0 - dust);
        0.5 * (sum - (sum * sum - 4.0 * inverse).max(0.0).sqrt())
    }

    /// By the classical Runge-Kutta method; a smooth shock has half its jump at xi = 0.
    fn profile(&self) -> Profile {
        let step = 1e-3;
        let slope = |w: f64| (self.gas(w) - w) / w;
        let mut w: f64 = if self.mach > 1.0 { 1.0 } else { 1.0 - 1e-6 };
        let mut dust = vec![w];
        while w - self.behind() > 1e-6 {
            let a = slope(w);
            let b = slope(w + 0.5 * step * a);
            let c = slope(w + 0.5 * step * b);
            let d = slope(w + step * c);
            w += step / 6.0 * (a + 2.0 * b + 2.0 * c + d);
            dust.push(w);
        }
        let middle = 0.5 * (1.0 + self.behind());
        let start = if self.mach > 1.0 {
            0.0
        } else {
            -step * dust.partition_point(|w| *w > middle) as f64
        };
        Profile { start, step, dust }
    }

    fn trial(&self) -> Trial {
        let (length, width) = (2.0 * self.half, ROWS * SPACING);
        let speed = self.mach * (1.0 - self.behind());
        let sides = [(0.0, self.half, speed), (self.half, length, -speed)].map(|(lo, hi, v)| {
            let block = |kind: &str, density: f64| {
                format!(
                    "[[{kind}.block]]\nlo = [{lo:?}, 0, 0]\nhi = [{hi:?}, {width}, 0]\nlattice = \"cubic\"\nspacing = {SPACING}\n\
                     density = {density}\nvelocity = [{v}, 0, 0]\n"
                )
            };
            block("gas", 1.0) + &block("dust", self.dust_to_gas)
        });
        let text = format!(
            "[run]\nend_time = {}\n[units]\nsystem = \"dimensionless\"\n\
             [domain]\nkind = \"periodic\"\nsize = [{length}, {width}, 1]\ndimensions = 2\n\
             [gas.eos]\nkind = \"isothermal\"\nsound_speed = 1\n{}{}\
             [dust.drag]\nlaw = \"constant-stopping-time\"\nstopping_time = 1\n",
            self.end, sides[0], sides[1]
        );
        Trial::new(&text, &[], |_| {})
            .unwrap_or_else(|refusal| panic!("a built-in scene: {refusal}"))
    }

    /// Distances from the middle and velocities in the frame of the shock.
    fn seen(&self, states: &[State]) -> Vec<[f64; 2]> {
        let of = |s: &State| {
            let (r, v) = (s.x.x - self.half, s.v.x);
            [
                r.abs(),
                (self.mach * self.behind() - v * r.signum()) / self.mach,
            ]
        };
        states.iter().map(of).collect()
    }

    fn rows(&self) -> Vec<Row> {
        let end = mixtures(self.trial(), &[0.0, self.end]).pop();
        let end: Mixture = end.expect("a run has an end");
        let (gas, dust) = (self.seen(&end.gas), self.seen(&end.dust));
        let profile = self.profile();
        let of_dust = |xi: f64| profile.at(xi);
        let of_gas = |xi: f64| {
            if xi < profile.start {
                1.0
            } else {
                self.gas(profile.at(xi))
            }
        };
        let guess = self.mach * self.behind() * self.end;
        let l1 = |seen: &[[f64; 2]], front: f64, exact: &dyn Fn(f64) -> f64| {
            let errors = seen.iter().filter_map(|[r, w]| {
                let xi = (front - r) / self.mach;
                let inside = (self.window[0]..self.window[1]).contains(&xi);
                inside.then(|| (w - exact(xi)).abs())
            });
            let (sum, number) = errors.fold((0.0, 0.0), |(s, n), e| (s + e, n + 1.0));
            if number > 0.0 {
                sum / number
            } else {
                f64::INFINITY
            }
        };
        let front = (-400..400)
            .map(|k| guess + 0.01 * self.mach * f64::from(k))
            .min_by(|a, b| l1(&dust, *a, &of_dust).total_cmp(&l1(&dust, *b, &of_dust)))
            .expect("places");
        let settled = front - self.mach * self.window[1];
        let still = end
            .gas
            .iter()
            .zip(&gas)
            .filter(|(_, seen)| seen[0] < settled && seen[0] > 0.25 * settled);
        let (mass, volume) = still.fold((0.0, 0.0), |(m, v), (s, _)| (m + s.m, v + s.m / s.rho));
        vec![
            Row::new(
                "L1 of the dust's velocity",
                l1(&dust, front, &of_dust),
                Bar::Limit([0.02, 0.08]),
            ),
            Row::new(
                "L1 of the gas's velocity",
                l1(&gas, front, &of_gas),
                Bar::Limit([0.02, 0.08]),
            ),
            Row::new(
                "compression of the gas",
                mass / volume,
                Bar::Reference {
                    value: 1.0 / self.behind(),
                    good: 0.005,
                    acceptable: 0.03,
                },
            ),
            Row::new(
                "place of the front by what it would be without a start",
                front / guess,
                Bar::None,
            ),
            Row::new("error of the momentum", end.books.error_momentum, Bar::None),
        ]
    }
}

impl Profile {
    fn at(&self, xi: f64) -> f64 {
        let k = (xi - self.start) / self.step;
        if k < 0.0 {
            return 1.0;
        }
        let last = self.dust.len() - 1;
        self.dust[(k.round() as usize).min(last)]
    }
}

pub fn jump() -> Vec<Row> {
    J.rows()
}

pub fn continuous() -> Vec<Row> {
    C.rows()
}
