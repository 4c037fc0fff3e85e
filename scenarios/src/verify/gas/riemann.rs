//! The exact solution of the Riemann problem of an ideal gas: two states that meet at x = 0 at t = 0, as a function of xi = x / t.
//!
//! p* is the root of f_l(p) + f_r(p) + v_r - v_l = 0, with f of a shock for p > p_k and of a rarefaction otherwise.
//! States that part so fast that a vacuum opens between them are not among its problems.
//! Source: Toro (2009), Riemann Solvers and Numerical Methods for Fluid Dynamics, chapter 4.

/// Gas at rest in itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    pub rho: f64,
    pub v: f64,
    pub p: f64,
}

/// The waves between two states.
#[derive(Clone, Copy, Debug)]
pub struct Waves {
    pub gamma: f64,
    pub left: State,
    pub right: State,
    /// On the left and on the right of the contact.
    pub inner: [State; 2],
}

impl Waves {
    pub fn new(left: State, right: State, gamma: f64) -> Self {
        let speed = |k: State| (gamma * k.p / k.rho).sqrt();
        let opening = 2.0 / (gamma - 1.0) * (speed(left) + speed(right));
        assert!(right.v - left.v < opening, "a vacuum opens");
        let balance = |p: f64| change(left, p, gamma) + change(right, p, gamma) + right.v - left.v;
        let (mut lo, mut hi) = (1e-20f64, 1e20f64);
        for _ in 0..200 {
            let p = (lo * hi).sqrt();
            if balance(p) < 0.0 { lo = p } else { hi = p }
        }
        let p = (lo * hi).sqrt();
        let mean = 0.5 * (left.v + right.v);
        let v = mean + 0.5 * (change(right, p, gamma) - change(left, p, gamma));
        let inner = [left, right].map(|k| State {
            rho: density(k, p, gamma),
            v,
            p,
        });
        Self {
            gamma,
            left,
            right,
            inner,
        }
    }

    /// Speed of the contact.
    pub fn contact(&self) -> f64 {
        self.inner[0].v
    }

    /// Speeds of the outer and the inner edge of the wave on the right; equal in a shock.
    pub fn right_wave(&self) -> [f64; 2] {
        self.edges(self.right, self.inner[1], 1.0)
    }

    /// Speeds of the outer and the inner edge of the wave on the left.
    pub fn left_wave(&self) -> [f64; 2] {
        self.edges(self.left, self.inner[0], -1.0)
    }

    fn edges(&self, outer: State, inner: State, side: f64) -> [f64; 2] {
        let g = self.gamma;
        let speed = |k: State| (g * k.p / k.rho).sqrt();
        if inner.p > outer.p {
            let mach2 = (g + 1.0) / (2.0 * g) * inner.p / outer.p + (g - 1.0) / (2.0 * g);
            [outer.v + side * speed(outer) * mach2.sqrt(); 2]
        } else {
            [outer, inner].map(|k| k.v + side * speed(k))
        }
    }

    pub fn at(&self, xi: f64) -> State {
        let is_left = xi < self.contact();
        let (outer, inner, side) = if is_left {
            (self.left, self.inner[0], -1.0)
        } else {
            (self.right, self.inner[1], 1.0)
        };
        let [head, tail] = self.edges(outer, inner, side);
        if side * xi > side * head {
            outer
        } else if side * xi < side * tail {
            inner
        } else {
            self.fan(outer, side, xi)
        }
    }

    /// Inside a rarefaction.
    fn fan(&self, outer: State, side: f64, xi: f64) -> State {
        let g = self.gamma;
        let c = (g * outer.p / outer.rho).sqrt();
        let slower = 2.0 / (g + 1.0) - side * (g - 1.0) / ((g + 1.0) * c) * (outer.v - xi);
        State {
            rho: outer.rho * slower.powf(2.0 / (g - 1.0)),
            v: 2.0 / (g + 1.0) * (-side * c + 0.5 * (g - 1.0) * outer.v + xi),
            p: outer.p * slower.powf(2.0 * g / (g - 1.0)),
        }
    }
}

/// Change of velocity across the wave from state `k` to pressure `p`.
fn change(k: State, p: f64, g: f64) -> f64 {
    if p > k.p {
        (p - k.p) * (2.0 / (k.rho * ((g + 1.0) * p + (g - 1.0) * k.p))).sqrt()
    } else {
        let c = (g * k.p / k.rho).sqrt();
        2.0 * c / (g - 1.0) * ((p / k.p).powf((g - 1.0) / (2.0 * g)) - 1.0)
    }
}

/// Density behind that wave.
fn density(k: State, p: f64, g: f64) -> f64 {
    let q = p / k.p;
    if q > 1.0 {
        k.rho * ((g + 1.0) * q + g - 1.0) / ((g - 1.0) * q + g + 1.0)
    } else {
        k.rho * q.powf(1.0 / g)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn waves(left: [f64; 3], right: [f64; 3], gamma: f64) -> Waves {
        let state = |[rho, v, p]: [f64; 3]| State { rho, v, p };
        Waves::new(state(left), state(right), gamma)
    }

    #[test]
    fn waves_are_those_of_published_tables() {
        // Left, right, gamma; p, v, both densities of the inner states, outer edges of the waves. Toro (2009), tests 1 to 3 and 5.
        let near = |a: f64, b: f64, what: &str| {
            assert!((a - b).abs() < 1e-9 * b.abs().max(1e-2), "{what}: {a} {b}");
        };
        for (left, right, gamma, p, v, rho, outer) in [
            (
                [1.0, 0.0, 1.0],
                [0.125, 0.0, 0.1],
                5.0 / 3.0,
                0.293_945_187_666,
                0.841_194_852_169,
                [0.479_689_058_721, 0.229_805_749_312],
                [-1.290_994_448_74, 1.844_473_367_05],
            ),
            (
                [1.0, -2.0, 0.4],
                [1.0, 2.0, 0.4],
                1.4,
                0.001_893_873_420_05,
                0.0,
                [0.021_852_118_206_8, 0.021_852_118_206_8],
                [-2.748_331_477_35, 2.748_331_477_35],
            ),
            (
                [1.0, 0.0, 1000.0],
                [1.0, 0.0, 0.01],
                1.4,
                460.893_787_491,
                19.597_451_388_7,
                [0.575_062_298_477, 5.999_240_704_8],
                [-37.416_573_867_7, 23.517_536_966_9],
            ),
            (
                [5.99924, 19.5975, 460.894],
                [5.99242, -6.19633, 46.095],
                1.4,
                1_691.646_955_4,
                8.689_774_411_63,
                [14.282_349_952, 31.042_601_641_6],
                [0.789_593_919_264, 12.250_778_123_1],
            ),
        ] {
            let waves = waves(left, right, gamma);
            near(waves.inner[0].p, p, "pressure");
            near(waves.contact(), v, "speed of the contact");
            near(waves.inner[0].rho, rho[0], "density on the left");
            near(waves.inner[1].rho, rho[1], "density on the right");
            near(waves.left_wave()[0], outer[0], "left edge");
            near(waves.right_wave()[0], outer[1], "right edge");
        }
    }

    #[test]
    fn a_fan_meets_its_neighbours() {
        for waves in [
            waves([1.0, 0.0, 1.0], [0.125, 0.0, 0.1], 1.4),
            waves([1.0, -2.0, 0.4], [1.0, 2.0, 0.4], 1.4),
            // A rarefaction to the right.
            waves([0.125, 0.3, 0.1], [1.0, 0.3, 1.0], 5.0 / 3.0),
        ] {
            for edge in waves.left_wave().into_iter().chain(waves.right_wave()) {
                let [a, b] = [edge - 1e-9, edge + 1e-9].map(|xi| waves.at(xi));
                let jump = (a.rho - b.rho).abs() + (a.v - b.v).abs() + (a.p - b.p).abs();
                let is_shock = waves.left_wave()[0] == edge && waves.left_wave()[1] == edge
                    || waves.right_wave()[0] == edge && waves.right_wave()[1] == edge;
                assert!((jump < 1e-7) != is_shock, "{jump} at {edge}");
            }
        }
    }
}
