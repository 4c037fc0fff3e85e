//! Tubes: two states that meet at x = 1 in a periodic box of length 2, on lattices of cells 1/n, or coarser by a factor: in space
//! body-centred ones, 16/n wide, in the plane glasses of as many particles as square ones.
//!
//! Strong rarefactions to near vacuum ("1-2-3") and a shock of Mach number 199, gamma = 1.4: the former in the plane with n = 400, the
//! latter in space with n = 100. L1 is relative to the mean of the exact density, over the waves. Source: Toro (2009), section 4.3.3, tests 2 and 3. What happens where both states meet at the
//! box's ends reaches no particle within 0.5 of the middle.

use super::picture::{Profile, profiles};
use super::riemann::{State, Waves};
use super::{Bar, End, Quantity, Row, Scheme, median};

/// A quantity of the exact solution.
type Exact = fn(State) -> f64;

/// One side of a tube.
pub struct Side {
    pub state: State,
    /// Its cells by 1/n.
    pub coarser: f64,
}

pub struct Tube {
    pub title: &'static str,
    pub left: Side,
    pub right: Side,
    pub gamma: f64,
    pub end: f64,
    pub dimensions: u32,
    /// Cells across the tube, of those on a side that is not coarser: more than both sides of the widest kernel.
    pub across: u32,
}

const fn uniform(v: f64, p: f64) -> Side {
    Side {
        state: State { rho: 1.0, v, p },
        coarser: 1.0,
    }
}

const RAREFACTIONS: Tube = Tube {
    title: "1-2-3: double rarefaction",
    left: uniform(-2.0, 0.4),
    right: uniform(2.0, 0.4),
    gamma: 1.4,
    end: 0.15,
    dimensions: 2,
    across: 48,
};

const BLAST: Tube = Tube {
    title: "shock of Mach number 199",
    left: uniform(0.0, 1000.0),
    right: uniform(0.0, 0.01),
    gamma: 1.4,
    end: 0.012,
    dimensions: 3,
    across: 16,
};

impl Tube {
    /// The scene with n cells a length.
    pub fn scene(&self, n: u32) -> String {
        let width = f64::from(self.across) / f64::from(n);
        let is_plane = self.dimensions == 2;
        // Square cells that are stretched fifty times would be columns farther apart than kernels reach: gas left to them parts into sheets.
        let lattice = if is_plane { "glass" } else { "bcc" };
        let depth = if is_plane { 0.0 } else { width };
        let sides = [(0.0, 1.0, &self.left), (1.0, 2.0, &self.right)].map(|(lo, hi, side)| {
            let State { rho, v, p } = side.state;
            let spacing = side.coarser * self.distance(n);
            format!(
                "[[gas.block]]\nlo = [{lo:?}, 0, 0]\nhi = [{hi:?}, {width}, {depth:?}]\nlattice = \"{lattice}\"\n\
                 spacing = {spacing}\ndensity = {rho}\npressure = {p}\nvelocity = [{v}, 0, 0]\n"
            )
        });
        format!(
            "[run]\nend_time = {}\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\n\
             size = [2, {width}, {width}]\ndimensions = {}\n{}{}[gas.eos]\ngamma = {}\n",
            self.end, self.dimensions, sides[0], sides[1], self.gamma
        )
    }

    /// Distance of particles where they are not coarser: a body-centred cell has two.
    fn distance(&self, n: u32) -> f64 {
        let cell = 1.0 / f64::from(n);
        if self.dimensions == 2 {
            cell
        } else {
            cell * 0.5f64.cbrt()
        }
    }

    /// The exact solution.
    pub fn waves(&self) -> Waves {
        Waves::new(self.left.state, self.right.state, self.gamma)
    }

    /// x / t, counted from the middle.
    pub(super) fn xi(&self, particle: &super::State) -> f64 {
        (particle.x.x - 1.0) / self.end
    }

    /// Profiles of density, velocity and pressure.
    pub(super) fn picture(&self, scheme: &Scheme, name: &str, end: &End) {
        let waves = self.waves();
        let quantities: [(&str, Quantity, Exact); 3] = [
            ("density", |particle| particle.rho, |exact| exact.rho),
            ("velocity", |particle| particle.v.x, |exact| exact.v),
            ("pressure", |particle| particle.p, |exact| exact.p),
        ];
        profiles(scheme, name, self.title, || {
            let middle = || end.gas.iter().filter(|p| (p.x.x - 1.0).abs() < 0.5);
            let places = (0..=1000).map(|k| 0.001 * f64::from(k) - 0.5);
            let profile = |(axis, of, exact): (_, Quantity, Exact)| {
                let line = places.clone().map(|x| (x, exact(waves.at(x / self.end))));
                Profile {
                    axes: ["x", axis],
                    points: middle().map(|p| (p.x.x - 1.0, of(p))).collect(),
                    exact: line.collect(),
                }
            };
            quantities.map(profile).into_iter().collect()
        });
    }

    /// Means over slices of width 1/n of |x - 1| < 0.5.
    fn slices(&self, end: &End, n: u32, value: impl Fn(&super::State) -> f64) -> Vec<(f64, f64)> {
        let means = end.binned(n as usize, |particle| particle.x.x - 0.5, value);
        let middle = |k: usize| (k as f64 + 0.5) / f64::from(n) - 0.5;
        let slices = means.into_iter().enumerate();
        slices.map(|(k, mean)| (middle(k), mean)).collect()
    }

    /// The largest |P/P* - 1| of a slice within five distances of particles (of the coarser side) from the contact.
    pub(super) fn blip(&self, end: &End, n: u32) -> f64 {
        let waves = self.waves();
        let contact = waves.contact() * self.end;
        let coarser = self.left.coarser.max(self.right.coarser);
        let reach = 5.0 * coarser * self.distance(n);
        let slices = self.slices(end, n, |particle| particle.p);
        let near = slices.iter().filter(|(x, _)| (x - contact).abs() < reach);
        let step = near.map(|(_, p)| (p / waves.inner[0].p - 1.0).abs());
        step.fold(0.0, f64::max)
    }

    /// L1 of density over the waves, by the mean of the exact density there.
    fn relative_l1(&self, end: &End) -> f64 {
        let waves = self.waves();
        let (lo, hi) = (waves.left_wave()[0], waves.right_wave()[0]);
        let over = |value: &dyn Fn(f64, &super::State) -> f64| {
            end.mean(|particle| {
                let xi = self.xi(particle);
                (lo < xi && xi < hi).then(|| value(waves.at(xi).rho, particle))
            })
        };
        over(&|exact, particle| (particle.rho - exact).abs()) / over(&|exact, _| exact)
    }
}

/// The double rarefaction.
pub fn rarefactions(scheme: &Scheme) -> Vec<Row> {
    let tube = &RAREFACTIONS;
    let end = scheme.end(&tube.scene(400), tube.end, |_| {});
    tube.picture(scheme, "gas-123", &end);
    let least = |of: Quantity| end.gas.iter().map(of).fold(f64::INFINITY, f64::min);
    let thinnest = least(|particle| particle.rho) / tube.waves().inner[0].rho - 1.0;
    vec![
        Row::new(
            "relative L1 of density",
            tube.relative_l1(&end),
            Bar::Limit([0.03, 0.06]),
        ),
        Row::new(
            "least density by the exact one, less one",
            thinnest,
            Bar::Limit([0.5, 2.0]),
        ),
        Row::new(
            "least internal energy",
            least(|particle| particle.u),
            Bar::Least([0.0, 0.0]),
        ),
        end.energy_error(),
    ]
}

/// The strong shock.
pub fn blast(scheme: &Scheme) -> Vec<Row> {
    const CELLS: u32 = 100;
    let tube = &BLAST;
    let end = scheme.end(&tube.scene(CELLS), tube.end, |_| {});
    tube.picture(scheme, "gas-blast", &end);
    let waves = tube.waves();
    let (tail, shock) = (waves.left_wave()[1], waves.right_wave()[0]);
    let plateau = |of: Quantity| {
        let flat = |p: &&super::State| (tail..shock).contains(&tube.xi(p));
        median(end.gas.iter().filter(flat).map(of).collect())
    };
    let exact = waves.inner[1];
    let slices = tube.slices(&end, CELLS, |particle| particle.rho);
    let (peak, front) = front(&slices, 1.0);
    let relative = |measured: f64, exact: f64| measured / exact - 1.0;
    let plateaus = Bar::Limit([0.02, 0.05]);
    vec![
        Row::new(
            "relative L1 of density",
            tube.relative_l1(&end),
            Bar::Limit([0.08, 0.2]),
        ),
        Row::new(
            "velocity between the waves, error",
            relative(plateau(|particle| particle.v.x), exact.v),
            plateaus,
        ),
        Row::new(
            "pressure between the waves, error",
            relative(plateau(|particle| particle.p), exact.p),
            plateaus,
        ),
        Row::new(
            "highest density, error",
            relative(peak, exact.rho),
            Bar::Limit([0.1, 0.3]),
        ),
        Row::new(
            "way of the shock, error",
            relative(front, shock * tube.end),
            Bar::Limit([0.01, 0.03]),
        ),
        Row::new(
            "largest step of the pressure at the contact, mean over slices",
            tube.blip(&end, CELLS),
            Bar::Limit([0.05, 0.2]),
        ),
        end.energy_error(),
    ]
}

/// The highest of the values along a line, and where behind it they fall to the middle between it and what lies `ahead`.
pub fn front(values: &[(f64, f64)], ahead: f64) -> (f64, f64) {
    let highest = |best: usize, k: usize| {
        if values[k].1 > values[best].1 {
            k
        } else {
            best
        }
    };
    let top = (0..values.len()).fold(0, highest);
    let middle = 0.5 * (values[top].1 + ahead);
    let crossing = values[top..].windows(2).find_map(|pair| {
        let [(x, a), (y, b)] = [pair[0], pair[1]];
        (b < middle).then(|| x + (y - x) * (a - middle) / (a - b))
    });
    (values[top].1, crossing.unwrap_or(f64::NAN))
}
