//! The hard part: every cluster on its own over one step, small ones by Gauss-Radau, big ones by Hermite with block steps.
//!
//! Clusters know nothing of each other, so any thread may take any of them; each writes its own range only.

use std::sync::Mutex;

use rayon::prelude::*;

use super::clusters::Clusters;
use super::group::{Group, Member};
use super::radau::Radau;
use crate::encounters::touch;
use crate::integrators::hermite::{Hermite, SPAN};
use crate::points::Vec3;
use crate::points::sum::Parts;

/// Members beyond which Gauss-Radau, whose step is common to all, costs more than Hermite.
const SMALL: usize = 24;
/// Members in all clusters up to which one thread does them.
const FEW: usize = 64;
/// Of big clusters, in units of Aarseth's criterion.
const ETA: f64 = 1e-3;

/// A touch of two members, by their places in [`Clusters::members`], since the begin of the step.
#[derive(Clone, Copy, Debug)]
pub struct Touch {
    pub pair: [usize; 2],
    pub time: f64,
}

/// A cluster that could not be integrated: the place of its first member in [`Clusters::members`].
#[derive(Clone, Copy, Debug)]
pub struct Stalled(pub usize);

/// What one thread needs.
#[derive(Debug, Default)]
struct Worker {
    group: Group,
    radau: Radau,
    hermite: Hermite,
    touches: Vec<Touch>,
}

/// The integration of clusters; keeps its buffers between calls.
#[derive(Debug, Default)]
pub struct Hard {
    workers: Vec<Mutex<Worker>>,
    pub touches: Vec<Touch>,
    /// States at the end of the step, in the order of the members.
    pub x: Vec<Vec3>,
    pub v: Vec<Vec3>,
}

impl Hard {
    /// Integrates all clusters over `dt` about a centre with G times mass `mu`.
    pub fn advance(
        &mut self,
        clusters: &Clusters,
        member: impl Fn(usize) -> Member + Sync,
        [mu, g]: [f64; 2],
        dt: f64,
    ) -> Result<(), Stalled> {
        let n = clusters.members.len();
        self.x.resize(n, Vec3::zeros());
        self.v.resize(n, Vec3::zeros());
        self.touches.clear();
        let threads = rayon::current_num_threads().max(1);
        self.workers
            .resize_with(threads.max(self.workers.len()), Mutex::default);
        let (xs, vs, workers) = (
            Parts::new(&mut self.x),
            Parts::new(&mut self.v),
            &self.workers,
        );
        let solve = |k: usize| -> Result<(), Stalled> {
            let range = clusters.range(k);
            // SAFETY: the ranges of clusters are disjoint.
            let (x, v) = unsafe { (xs.part(range.clone()), vs.part(range.clone())) };
            let thread = rayon::current_thread_index().unwrap_or(0) % threads;
            let mut worker = workers[thread].lock().unwrap_or_else(|e| e.into_inner());
            worker.group.begin(mu, g);
            range.clone().for_each(|k| worker.group.add(member(k)));
            worker.solve(dt).map_err(|()| Stalled(range.start))?;
            worker.group.lay_out(x, v);
            let Worker { group, touches, .. } = &mut *worker;
            touches.extend(group.contacts.iter().map(|contact| Touch {
                pair: contact.pair.map(|i| range.start + i as usize),
                time: contact.time,
            }));
            Ok(())
        };
        let done = if n <= FEW || threads == 1 {
            (0..clusters.count()).try_for_each(solve)
        } else {
            let stalls = (0..clusters.count()).into_par_iter().with_min_len(8);
            let first = stalls.filter_map(|k| solve(k).err()).min_by_key(|s| s.0);
            first.map_or(Ok(()), Err)
        };
        for worker in &mut self.workers {
            let worker = worker.get_mut().unwrap_or_else(|e| e.into_inner());
            self.touches.append(&mut worker.touches);
        }
        done
    }
}

impl Worker {
    fn solve(&mut self, dt: f64) -> Result<(), ()> {
        if self.group.bodies.len() <= SMALL {
            self.radau.advance(&mut self.group, dt).map_err(|_| ())
        } else {
            self.by_blocks(dt).map_err(|_| ())
        }
    }

    fn by_blocks(&mut self, dt: f64) -> Result<(), crate::integrators::hermite::Stall> {
        let Self { group, hermite, .. } = self;
        while let Some(pair) = group.overlap() {
            group.bind(pair, 0.0);
        }
        hermite.eta = ETA;
        let unit = dt / SPAN as f64;
        hermite.begin(group, group.bodies.iter().map(|b| (b.x, b.v)), dt)?;
        while hermite.now < SPAN {
            hermite.step(group)?;
            let bodies = group.bodies.iter_mut();
            let states = hermite.x_now.iter().zip(&hermite.v_now);
            for (body, (x, v)) in bodies.zip(states) {
                (body.x, body.v) = (*x, *v);
            }
            while let Some(pair) = touched(group, hermite) {
                let kept = pair[0];
                let lost = group.bind(pair, hermite.now as f64 * unit);
                hermite.remove(lost);
                hermite.place(group, kept, group.bodies[kept].x, group.bodies[kept].v)?;
            }
        }
        Ok(())
    }
}

/// The first pair of a body whose step has just ended that touched since it was looked at last, on the straight line of its end.
fn touched(group: &Group, hermite: &Hermite) -> Option<[usize; 2]> {
    let pairs = hermite.active.iter().flat_map(|&i| {
        let others = 0..group.bodies.len();
        others.map(move |j| [(i as usize).min(j), (i as usize).max(j)])
    });
    pairs.into_iter().find(|&[i, j]| {
        let (a, b) = (&group.bodies[i], &group.bodies[j]);
        let (d, w) = (b.x - a.x, b.v - a.v);
        let reach = a.radius + b.radius;
        let step = hermite.since(i, j);
        i != j
            && group.can_touch(i, j)
            && touch(d, w, reach, step).is_some_and(|time| time > -step || d.dot(&w) <= 0.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::random::{self, Purpose};
    use rand::RngExt;

    /// A swarm of 30 within each other's cut-offs.
    fn swarm(radius: f64, spread: f64) -> Group {
        let mut random = random::stream(5, Purpose::Orbits, 0, 0);
        let mut vector = || Vec3::from_fn(|_, _| random.random::<f64>() - 0.5);
        let mut group = Group::default();
        group.begin(1.0, 1.0);
        for k in 0..30 {
            group.add(Member {
                m: 1e-7 * f64::from(k % 4),
                radius,
                eps2: 0.0,
                cutoff: 0.03,
                x: Vec3::x() + vector() * 0.05,
                v: Vec3::y() + vector() * spread,
            });
        }
        group
    }

    /// Both ends of a swarm after `dt`: by Gauss-Radau and by blocks.
    fn both(radius: f64, spread: f64, dt: f64) -> [Group; 2] {
        let (mut one, mut other) = (Worker::default(), Worker::default());
        (one.group, other.group) = (swarm(radius, spread), swarm(radius, spread));
        one.radau.advance(&mut one.group, dt).expect("a way");
        other.by_blocks(dt).expect("a way");
        [one.group, other.group]
    }

    #[test]
    fn blocks_take_a_big_cluster_where_gauss_radau_does() {
        let [radau, blocks] = both(0.0, 0.05, 0.3);
        let pairs = radau.bodies.iter().zip(&blocks.bodies);
        let miss = pairs.map(|(a, b)| (a.x - b.x).norm());
        let miss = miss.fold(0.0, |most, d| if d > most || d.is_nan() { d } else { most });
        assert!(miss < 7e-10, "{miss:e}");
    }

    #[test]
    fn blocks_find_the_touches_that_gauss_radau_finds() {
        let [radau, blocks] = both(5e-3, 0.15, 0.3);
        let told = |group: &Group| -> Vec<[u32; 2]> {
            let pair = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
            group.contacts.iter().map(|c| pair(c.pair)).collect()
        };
        assert_eq!(radau.contacts.len(), 15);
        assert_eq!(told(&radau), told(&blocks));
    }

    /// Miss of a light body that passes a heavy one on a hyperbola with its pericentre at 1/80 of the start: by both ways.
    fn passage(light: f64) -> [f64; 2] {
        let (mut d, mut w) = (Vec3::new(-5.0, 0.3, 0.0), Vec3::new(1.2, 0.0, 0.0));
        let (place, way) = (Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.3, 0.2, 0.1));
        let member = |m, x, v| Member {
            m,
            cutoff: 100.0,
            x,
            v,
            ..Member::default()
        };
        let mut workers: [Worker; 2] = Default::default();
        for worker in &mut workers {
            worker.group.begin(0.0, 1.0);
            worker.group.add(member(1.0, place, way));
            worker.group.add(member(light, place + d, way + w));
        }
        let [radau, blocks] = &mut workers;
        radau.radau.advance(&mut radau.group, 8.0).expect("a way");
        blocks.by_blocks(8.0).expect("a way");
        crate::kepler::drift(1.0 + light, 8.0, &mut d, &mut w).expect("an orbit");
        let miss = |worker: &Worker| {
            let [a, b] = [0, 1].map(|i| worker.group.bodies[i].x);
            // The centre of mass goes straight.
            let centre = (a + b * light) / (1.0 + light);
            let straight = place
                + way * 8.0
                + (Vec3::new(-5.0, 0.3, 0.0) + Vec3::x() * 9.6) * (light / (1.0 + light));
            (b - a - d).norm().max((centre - straight).norm())
        };
        [miss(&workers[0]), miss(&workers[1])]
    }

    #[test]
    fn light_bodies_pass_heavy_ones_on_their_hyperbolas() {
        for light in [0.0, 1e-12, 1e-3] {
            let [radau, blocks] = passage(light);
            assert!(
                radau < 7e-13 && blocks < 3e-8,
                "{light:e} {radau:e} {blocks:e}"
            );
        }
    }
}
