//! Continuity: particles are placed so that the density summed over them is the one that the continuity equation of the fluid's velocities says.
//!
//! d ln q_i / dt = -div v_i,   e_i = sum_j m_j W(|x_i - x_j|, H_i) / q_i - 1,   V_d H_i^d = N m~_i / q_i,   wanted: e = 0
//! m_i dx_i = sum_j f_ij,   f_ij = -m_i m_j [ L_i / q_i grad W(r, H_i) + L_j / q_j grad W(r, H_j) ],   L = s^2 l
//! l' = l + t e,   t = (l' - l)^2 / (l' - l).(e - e'),   weighted by m s^2
//!
//! In shear, particles that move with v do not keep sum m W as div v wants it: so places and velocities are told apart. From Imaeda & Inutsuka (2002), ApJ
//! 569, 501: the diagnosis, the two velocities, and places that follow from an implicit equation. Ours: a density a particle that carries the
//! equation; places by the gradient of a potential l, so that there are as many unknowns as equations; the pairs of which are those before the shift, so that dx is
//! linear in l; its solution by spectral steps (Barzilai & Borwein 1988, IMA J. Numer. Anal. 8, 141; La Cruz et al. 2006, Math. Comp. 75, 1429). The
//! operator from l to e is that of W twice and -s^2 grad^2: all but zero for waves shorter than H, and zero for what is the same everywhere, so
//! that not every q can be had. What is reached in the given number of steps is taken. q of a first order in the step; at edges q follows the sum.

use nalgebra::Vector2;
use nbody::points::Vec3;
use nbody::points::sum::{self, Parts};
use rayon::prelude::*;

use super::each;
use super::site::Site;
use crate::kernel::unit_sphere;
use crate::{Gas, Hydro};

/// The farthest that a solve moves a particle, by the mean distance of particles.
const FARTHEST: f64 = 0.2;
/// Bounds of t.
const STEPS: [f64; 2] = [0.1, 1e3];
/// A residual is too large beyond this many of the least.
const WORSE: f64 = 2.0;
/// The least part by which a residual is less than another: what is the same everywhere is not to be had, and its rounding moves nobody.
const BETTER: f64 = 1e-9;
/// A solve ends when this many iterations have not bettered it by a hundredth.
const PATIENCE: u64 = 8;
/// Particles a task.
const TASK: usize = 256;

/// How well places are solved for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Continuity {
    /// Root mean square of e that is good enough.
    pub tolerance: f64,
    /// Iterations at most.
    pub iterations: u64,
}

/// How often places were solved for, and how that went; residuals are root mean squares of e, summed over the solves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solves {
    pub count: u64,
    pub failed: u64,
    pub iterations: u64,
    /// Most iterations of a solve.
    pub most: u64,
    pub before: f64,
    pub after: f64,
}

impl Solves {
    pub fn and(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            failed: self.failed + other.failed,
            iterations: self.iterations + other.iterations,
            most: self.most.max(other.most),
            before: self.before + other.before,
            after: self.after + other.after,
        }
    }
}

impl Continuity {
    /// Advances the targets over the step `dt` that has passed, and gives `sites` the potentials that bring the densities to them.
    pub(super) fn solve(
        &self,
        sites: &mut [Site],
        gas: &mut Gas,
        hydro: &Hydro,
        dt: f64,
    ) -> Solves {
        let target = &mut gas.particles.target;
        for (q, site) in target.iter_mut().zip(sites.iter()) {
            *q *= (-dt * site.grad_w.trace()).exp();
        }
        for (site, h) in sites.iter_mut().zip(&gas.particles.h) {
            site.reach = hydro.support() * h;
        }
        let mut extent = Vec::new();
        (gas.tree).largest(
            |i| sites[i].reach + 2.0 * FARTHEST * sites[i].s,
            &mut extent,
        );
        let pairs = Pairs::new(sites, gas, hydro, &extent);
        let target = &mut gas.particles.target;
        let mut problem = Problem::new(pairs, sites, target, hydro);
        let solves = self.settle(&mut problem);
        let carried = problem.carried();
        gas.particles.target = carried;
        solves
    }

    /// Finds the potentials as far as they can be had.
    fn settle(&self, problem: &mut Problem) -> Solves {
        let n = problem.sites.len();
        let mut l = vec![0.0; n];
        let mut e = problem.excess();
        let before = problem.rms(&e);
        let (mut best, mut least, mut since) = (l.clone(), before, 0);
        let mut best_e = e.clone();
        let (mut step, mut done) = (1.0, 0);
        while least > self.tolerance && done < self.iterations && since < PATIENCE {
            done += 1;
            let mut next: Vec<f64> = l.iter().zip(&e).map(|(l, e)| l + step * e).collect();
            problem.place(&mut next);
            let found = problem.excess();
            let rms = problem.rms(&found);
            let sums = problem.products((&l, &next), (&e, &found));
            step = if sums.y > 0.0 {
                sums.x / sums.y
            } else {
                STEPS[1]
            }
            .clamp(STEPS[0], STEPS[1]);
            since = if rms < 0.99 * least { 0 } else { since + 1 };
            (l, e) = (next, found);
            if rms < (1.0 - BETTER) * least {
                least = rms;
                best.clone_from(&l);
                best_e.clone_from(&e);
            } else if rms > WORSE * least {
                l.clone_from(&best);
                e.clone_from(&best_e);
                step = (0.25 * step).max(STEPS[0]);
            }
        }
        problem.place(&mut best);
        Solves {
            count: 1,
            failed: u64::from(least > self.tolerance),
            iterations: done,
            most: done,
            before,
            after: least,
        }
    }
}

/// Pairs that are or may come within reach of each other, particle by particle.
struct Pairs {
    first: Vec<usize>,
    other: Vec<u32>,
    /// From the other, before the shift.
    r: Vec<Vec3>,
}

/// What is done with a particle and those that are near it.
type Visit<'a> = dyn Fn(usize, &[(u32, Vec3)]) + Sync + 'a;

impl Pairs {
    fn new(sites: &[Site], gas: &Gas, hydro: &Hydro, extent: &[f64]) -> Self {
        let far = |site: &Site| site.reach + 2.0 * FARTHEST * site.s;
        let meets = |i: usize, &(j, x): &(u32, Vec3)| {
            let (j, r) = (j as usize, hydro.domain.in_plane(sites[i].x - x));
            let reach = far(&sites[i]).max(far(&sites[j]));
            (r.norm_squared() < reach * reach).then_some((j as u32, r))
        };
        let moved = FARTHEST * sites.iter().fold(0.0, |most: f64, site| most.max(site.s));
        let all = |visit: &Visit| {
            each(&gas.tree, &hydro.domain, (sites, extent, moved), visit);
        };
        let mut first = vec![0; sites.len() + 1];
        let counts = Parts::new(&mut first[1..]);
        all(&|i, near| {
            let count = near.iter().filter(|near| meets(i, near).is_some()).count();
            // SAFETY: each particle is visited once.
            unsafe { counts.part(i..i + 1)[0] = count };
        });
        for i in 0..sites.len() {
            first[i + 1] += first[i];
        }
        let mut other = vec![0; first[sites.len()]];
        let mut r = vec![Vec3::zeros(); other.len()];
        let (others, separations) = (Parts::new(&mut other), Parts::new(&mut r));
        all(&|i, near| {
            let own = first[i]..first[i + 1];
            // SAFETY: each particle is visited once.
            let (others, separations) =
                unsafe { (others.part(own.clone()), separations.part(own)) };
            for (k, (j, r)) in near.iter().filter_map(|near| meets(i, near)).enumerate() {
                (others[k], separations[k]) = (j, r);
            }
        });
        Self { first, other, r }
    }

    /// The others of particle i, and where it is from them.
    fn of(&self, i: usize) -> impl Iterator<Item = (usize, Vec3)> + '_ {
        let range = self.first[i]..self.first[i + 1];
        range.map(|k| (self.other[k] as usize, self.r[k]))
    }
}

/// Places that are solved for.
struct Problem<'a> {
    pairs: Pairs,
    sites: &'a mut [Site],
    target: &'a [f64],
    hydro: &'a Hydro,
    dx: Vec<Vec3>,
    /// What the particle counts too much of itself, by its own W.
    surplus: f64,
}

impl<'a> Problem<'a> {
    fn new(pairs: Pairs, sites: &'a mut [Site], target: &'a mut [f64], hydro: &'a Hydro) -> Self {
        let (d, kernel) = (hydro.dimensions(), hydro.kernel);
        let surplus = kernel.self_excess(hydro.neighbours, d);
        let volume = unit_sphere(d);
        // The part of the sum of W that a density leaves out.
        let left_out = surplus * kernel.value(0.0) * kernel.norm(d) * volume / hydro.neighbours;
        let dx = vec![Vec3::zeros(); sites.len()];
        let problem = Problem {
            pairs,
            sites,
            target: &[],
            hydro,
            dx,
            surplus,
        };
        let sums = problem.sums();
        for (i, (mass, number)) in sums.into_iter().enumerate() {
            let site = &mut problem.sites[i];
            let own = surplus * site.m * kernel.value(0.0);
            if site.share == 0.0 {
                let norm = kernel.norm(d) / site.reach.powi(d as i32);
                target[i] = norm * (mass - own);
                continue;
            }
            let wanted = hydro.neighbours * (1.0 - left_out) * mass / number;
            site.reach = (wanted / (volume * target[i])).powf(1.0 / d as f64);
        }
        Self { target, ..problem }
    }

    /// Calls `of` for every particle.
    fn map<T: Send>(&self, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        let all = (0..self.sites.len()).into_par_iter().with_min_len(TASK);
        all.map(of).collect()
    }

    /// Sums of m w and w at the places as they are.
    fn sums(&self) -> Vec<(f64, f64)> {
        let (sites, dx, kernel) = (&*self.sites, &self.dx, self.hydro.kernel);
        self.map(|i| {
            self.pairs.of(i).fold((0.0, 0.0), |(mass, number), (j, r)| {
                let q = (r + dx[i] - dx[j]).norm() / sites[i].reach;
                let w = kernel.value(q.min(1.0));
                (mass + sites[j].m * w, number + w)
            })
        })
    }

    /// e, zero at edges.
    fn excess(&self) -> Vec<f64> {
        let (d, kernel) = (self.hydro.dimensions(), self.hydro.kernel);
        let e = |(i, (mass, _)): (usize, (f64, f64))| {
            let site = &self.sites[i];
            let own = self.surplus * site.m * kernel.value(0.0);
            let rho = kernel.norm(d) / site.reach.powi(d as i32) * (mass - own);
            if site.share > 0.0 {
                rho / self.target[i] - 1.0
            } else {
                0.0
            }
        };
        self.sums().into_iter().enumerate().map(e).collect()
    }

    /// The root mean square, edges left out.
    fn rms(&self, e: &[f64]) -> f64 {
        let sum = sum::ordered(e.len(), Vector2::zeros(), |range| {
            range.fold(Vector2::zeros(), |sum, i| {
                let inside = f64::from(u8::from(self.sites[i].share > 0.0));
                sum + Vector2::new(e[i] * e[i], inside)
            })
        });
        (sum.x / f64::max(sum.y, 1.0)).sqrt()
    }

    /// (l' - l)^2 and (l' - l).(e - e').
    fn products(&self, (l, next): (&[f64], &[f64]), (e, found): (&[f64], &[f64])) -> Vector2<f64> {
        sum::ordered(l.len(), Vector2::zeros(), |range| {
            range.fold(Vector2::zeros(), |sum, i| {
                let site = &self.sites[i];
                let (weight, step) = (site.m * site.s * site.s, next[i] - l[i]);
                sum + weight * step * Vector2::new(step, e[i] - found[i])
            })
        })
    }

    /// The targets at the places as they are: those of the fluid there.
    fn carried(&self) -> Vec<f64> {
        let (sites, q, kernel) = (&*self.sites, self.target, self.hydro.kernel);
        self.map(|i| {
            let mut slope = (Vec3::zeros(), 0.0);
            for (j, r) in self.pairs.of(i) {
                let w = kernel.value((r.norm() / sites[i].reach).min(1.0));
                slope.0 -= w * (q[j] / q[i]).ln() * r;
                slope.1 += w * r.norm_squared();
            }
            let d = self.hydro.dimensions() as f64;
            let rise = if slope.1 > 0.0 {
                d * self.dx[i].dot(&slope.0) / slope.1
            } else {
                0.0
            };
            q[i] * rise.exp()
        })
    }

    /// Gives sites the potential `l`.
    fn push(&mut self, l: &[f64]) {
        let d = self.hydro.dimensions();
        let norm = self.hydro.kernel.norm(d);
        for (i, site) in self.sites.iter_mut().enumerate() {
            let potential = site.s * site.s * l[i] / self.target[i];
            site.push = norm * potential / site.reach.powi(d as i32 + 2);
        }
    }

    /// Moves particles by the potential `l`, which is made less where that would be too far.
    fn place(&mut self, l: &mut [f64]) {
        self.push(l);
        let (law, sites) = (super::Law::potential(self.hydro), &*self.sites);
        let mut dx = self.map(|i| {
            let shift = |(j, r): (usize, Vec3)| law.pair(&sites[i], &sites[j], r).map(|p| p.shift);
            self.pairs.of(i).filter_map(shift).sum::<Vec3>() / sites[i].m
        });
        let far = |most: f64, (dx, site): (&Vec3, &Site)| most.max(dx.norm() / site.s);
        let most = dx.iter().zip(sites.iter()).fold(0.0, far);
        if most > FARTHEST {
            let part = FARTHEST / most;
            dx.iter_mut().for_each(|dx| *dx *= part);
            l.iter_mut().for_each(|l| *l *= part);
        }
        self.dx = dx;
    }
}

#[cfg(test)]
mod tests;
