//! Rim: the pressure of the gas that the star has accreted, on that next to the accretion radius.
//!
//! A kernel that reaches within the accretion radius misses neighbours there: the density is found too low, and the gas is pushed into the gap. Layers at
//! the distance y towards the star pull with K(y) = 2 pi y W(y), W the kernel; rho and c^2 = P/rho follow the disk's own profile as rho t_rho(y), c^2 t_c(y):
//!
//! a = c^2 { int_d^H (t_rho + t_c) K dy - int_-H^d [t_rho (g - 1) + t_c (g_y - 1)] K dy },   d = r - R_acc
//! g = 1 / (1 - int_d^H t_rho W_p dy),   W_p(y) = int_y^H K dy': rho by what the kernel sees of it; g_y that of the layer y
//!
//! along r: the first integral is what the missing layers would push with, the second what the low densities of those that are there push too much. Curved
//! layers count as planes (error H / R_acc), all supports as H_i, and grad-h terms as one. The momentum comes from nobody, and is booked as given away.
//! Source: after Bate, Bonnell & Price (1995), MNRAS 277, 362, section 2.2 (corrections of density and pressure at the surface of a sink).

use std::f64::consts::PI;

use gas::{Gas, Hydro};
use nbody::points::{Fault, Vec3};

use crate::System;
use crate::ledger::{Census, Totals};
use crate::operator::{Meter, Operator, Phase};

/// Density and c^2 of the disk's midplane at a distance from the axis; their scales do not matter.
pub type Profile = Box<dyn Fn(f64) -> [f64; 2] + Send + Sync>;

/// Entries of a table over y / H from 0 to 1.
const ROWS: usize = 256;
/// Layers of a kernel's support, on either side.
const LAYERS: usize = 16;
/// The largest part of a kernel that is taken to be missing: a half where gas is outside.
const MOST: f64 = 0.75;

/// Pushes gas at the accretion radius.
pub struct Rim {
    profile: Profile,
    /// H / h
    support: f64,
    shape: Shape,
    /// Those that are pushed now, and their accelerations.
    pushed: Vec<(u32, Vec3)>,
}

/// A kernel by planes, lengths in units of H: W_p, and what of it lies beyond.
struct Shape {
    plane: Vec<f64>,
    beyond: Vec<f64>,
    /// K
    pull: Box<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl Shape {
    fn new(hydro: &Hydro) -> Self {
        let kernel = hydro.kernel;
        let norm = kernel.norm(3);
        let pull = move |y: f64| match y.abs() < 1.0 {
            true => 2.0 * PI * y * norm * kernel.value::<gas::kernel::Scalar, f64>(y.abs()),
            false => 0.0,
        };
        let sums = |f: &dyn Fn(usize) -> f64| {
            let mut sums = vec![0.0; ROWS + 1];
            for row in (0..ROWS).rev() {
                sums[row] = sums[row + 1] + f(row) / ROWS as f64;
            }
            sums
        };
        let plane = sums(&|row| pull((row as f64 + 0.5) / ROWS as f64));
        let beyond = sums(&|row| 0.5 * (plane[row] + plane[row + 1]));
        Self {
            plane,
            beyond,
            pull: Box::new(pull),
        }
    }

    fn at(table: &[f64], y: f64) -> f64 {
        let place = y.clamp(0.0, 1.0) * ROWS as f64;
        let row = (place as usize).min(ROWS - 1);
        table[row] + (place - row as f64) * (table[row + 1] - table[row])
    }
}

impl Rim {
    pub fn new(hydro: &Hydro, profile: Profile) -> Self {
        Self {
            profile,
            support: hydro.support(),
            shape: Shape::new(hydro),
            pushed: Vec::new(),
        }
    }

    /// a of gas at `r` from the star, by c^2 / H; `edge` is the accretion radius.
    fn push(&self, r: f64, reach: f64, edge: f64) -> f64 {
        let d = (r - edge) / reach;
        if d >= 1.0 {
            return 0.0;
        }
        let (d, shape) = (d.max(0.0), &self.shape);
        let here = (self.profile)(r);
        let trend = |y: f64| {
            let there = (self.profile)(r - y * reach);
            [there[0] / here[0], there[1] / here[1]]
        };
        let layers = |from: f64, to: f64| {
            let width = (to - from) / LAYERS as f64;
            (0..LAYERS).map(move |k| (from + (k as f64 + 0.5) * width, width))
        };
        let lost: f64 = layers(d, 1.0)
            .map(|(y, width)| width * trend(y)[0] * Shape::at(&shape.plane, y))
            .sum();
        let low = |lost: f64| 1.0 / (1.0 - lost.min(MOST)) - 1.0;
        let missing: f64 = layers(d, 1.0)
            .map(|(y, width)| {
                let [rho, c2] = trend(y);
                width * (rho + c2) * (shape.pull)(y)
            })
            .sum();
        let at_edge = trend(d)[0];
        let excess: f64 = layers(-1.0, d)
            .map(|(y, width)| {
                let [rho, c2] = trend(y);
                let theirs = Shape::at(&shape.beyond, d - y) * at_edge / rho;
                width * (rho * low(lost) + c2 * low(theirs)) * (shape.pull)(y)
            })
            .sum();
        missing - excess
    }

    /// Lists who is pushed.
    fn look(&mut self, gas: &Gas, (star, edge): (Vec3, f64)) {
        self.pushed.clear();
        let mut pushed = std::mem::take(&mut self.pushed);
        for &i in gas.active_ones() {
            let (x, reach) = (
                gas.particles.x[i as usize] - star,
                self.support * gas.particles.h[i as usize],
            );
            let r = x.norm();
            if r - edge < reach {
                let c2 = gas.derived.p[i as usize] / gas.derived.rho[i as usize];
                let push = c2 / reach * self.push(r, reach, edge);
                pushed.push((i, push / r * x));
            }
        }
        self.pushed = pushed;
    }

    /// What `dv` takes from a particle that it brings to `v`.
    fn lost(m: f64, x: Vec3, v: Vec3, dv: Vec3) -> Totals {
        let momentum = -m * dv;
        Totals {
            momentum,
            angular_momentum: x.cross(&momentum),
            kinetic: momentum.dot(&(v - 0.5 * dv)),
            ..Totals::default()
        }
    }

    fn book(&self, system: &mut System, lost: Totals) -> Census {
        let mut change = Census::default();
        change.0[0] = Totals::default() - lost;
        system.ledger.add(self.name(), &change);
        system.ledger.given_away += lost;
        change
    }
}

impl Operator for Rim {
    fn name(&self) -> &'static str {
        "rim"
    }

    fn counted(&self, _: &System) -> bool {
        false
    }

    /// After the forces of the same tick, to which it adds.
    fn prepare(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<(), Fault> {
        meter.enter(Phase::Hydro);
        self.pushed.clear();
        if let Some(&star) = system.seen.star_x.first() {
            self.look(&system.gas, (star, system.star.radius[0]));
        }
        for &(i, a) in &self.pushed {
            let i = i as usize;
            let dt = system.opening(system.gas.rates.next_span[i]);
            system.gas.rates.hydro[i] += a;
            system.gas.rates.dv_open[i] += dt * a;
        }
        Ok(())
    }

    /// Before the other kicks close.
    fn close(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let mut lost = Totals::default();
        for &(i, a) in &self.pushed {
            let i = i as usize;
            let p = &system.gas.particles;
            let dv = system.closing(p.begin[i], p.span[i]) * a;
            lost += Self::lost(p.m[i], p.x[i], p.v[i] + dv, dv);
            system.gas.particles.v[i] += dv;
        }
        self.book(system, lost);
        Ok(true)
    }

    /// After the other kicks have opened, with what `prepare` gave them: it is theirs no longer.
    fn open(&mut self, system: &mut System, meter: &mut dyn Meter) -> Result<bool, Fault> {
        meter.enter(Phase::Hydro);
        let p = &system.gas.particles;
        let lost = self.pushed.iter().fold(Totals::default(), |lost, &(i, a)| {
            let i = i as usize;
            let dv = system.opening(system.gas.rates.next_span[i]) * a;
            lost + Self::lost(p.m[i], p.x[i], p.v[i], dv)
        });
        let change = self.book(system, lost);
        let theirs = Census(change.0.map(|change| Totals::default() - change));
        system.ledger.add("kick gas", &theirs);
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use gas::KernelKind;
    use nbody::points::Domain;

    use super::*;

    fn rim(kernel: KernelKind, profile: fn(f64) -> [f64; 2]) -> Rim {
        let eos = gas::Eos::Ideal { gamma: 1.4 };
        let hydro = Hydro {
            kernel,
            ..Hydro::new(Domain::open(), eos)
        };
        Rim::new(&hydro, Box::new(profile))
    }

    #[test]
    fn planes_of_a_kernel_hold_all_of_it() {
        for kernel in KernelKind::ALL {
            let rim = rim(kernel, |_| [1.0, 1.0]);
            let half = rim.shape.beyond[0];
            assert!((half - 0.5).abs() < 1e-4, "{kernel:?}: {half}");
        }
    }

    /// The push of the layers within `H` of a plane at `d` that are there, each and the particle with the density that the kernel finds; by c^2 / H.
    fn there(rim: &Rim, d: f64) -> f64 {
        let lost = |d: f64| Shape::at(&rim.shape.beyond, d);
        let n = 20_000;
        let width = (1.0 + d) / f64::from(n);
        let push = |y: f64| {
            let both = 1.0 / (1.0 - lost(d)) + 1.0 / (1.0 - lost(d - y));
            width * both * (rim.shape.pull)(y)
        };
        (0..n)
            .map(|k| push(-1.0 + (f64::from(k) + 0.5) * width))
            .sum()
    }

    #[test]
    fn even_gas_at_a_plane_is_left_at_rest() {
        let rim = rim(KernelKind::CubicSpline, |_| [1.0, 1.0]);
        let most = there(&rim, 0.0).abs();
        for d in [0.0, 0.1, 0.3, 0.6, 0.9] {
            // Supports far smaller than the edge's radius.
            let (push, bare) = (rim.push(1e6 + d, 1.0, 1e6), there(&rim, d));
            println!("{d}: {push} against {bare}");
            // Sixteen layers: 0.5 per cent of the push at the edge.
            assert!((push + bare).abs() < 5e-3 * most, "{d}: {push} {bare}");
        }
        assert_eq!(rim.push(1e6 + 1.0, 1.0, 1e6), 0.0);
    }

    #[test]
    fn gas_that_is_denser_inwards_is_pushed_more() {
        let even = rim(KernelKind::WendlandC2, |_| [1.0, 1.0]);
        let falling = rim(KernelKind::WendlandC2, |r| [r.powi(-3), 1.0]);
        let rising = rim(KernelKind::WendlandC2, |r| [r.powi(3), 1.0]);
        let push = |rim: &Rim| rim.push(10.2, 1.0, 10.0);
        assert!(push(&falling) > push(&even) && push(&even) > push(&rising));
    }
}
