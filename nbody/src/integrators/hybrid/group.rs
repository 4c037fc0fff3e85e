//! A group: the members of one cluster, heliocentric, with what they do to each other in the hard part.
//!
//! a_i = -G M q_i/q_i^3 + sum_j G m_j (1 - K(r/c)) d_ij/(r^2 + eps^2)^(3/2). Two that touch are bound together: they go on as one body
//! with their common mass and centre of mass, and are laid apart again at the end as they were at the touch. So nobody passes
//! through anybody, and what becomes of the pair, and of its energy, is decided by whoever handles the touch.

use super::changeover::{slope, soft_part};
use crate::integrators::hermite::Field;
use crate::points::Vec3;

/// A member of a cluster.
#[derive(Clone, Copy, Debug, Default)]
pub struct Member {
    pub m: f64,
    /// Zero: it touches nobody.
    pub radius: f64,
    pub eps2: f64,
    pub cutoff: f64,
    pub x: Vec3,
    pub v: Vec3,
}

/// Two members that touched: the second is `d` away from the first and moves apart with `w`.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Numbers within the cluster.
    pub pair: [u32; 2],
    /// Since the begin of the step.
    pub time: f64,
    share: f64,
    d: Vec3,
    w: Vec3,
}

#[derive(Debug, Default)]
pub struct Group {
    pub mu: f64,
    pub g: f64,
    /// Those that move; some of them bound pairs.
    pub bodies: Vec<Member>,
    /// The number in the cluster of each of `bodies`.
    number: Vec<u32>,
    pub contacts: Vec<Contact>,
}

impl Group {
    /// Empties the group for the next cluster.
    pub fn begin(&mut self, mu: f64, g: f64) {
        (self.mu, self.g) = (mu, g);
        self.bodies.clear();
        self.number.clear();
        self.contacts.clear();
    }

    pub fn add(&mut self, member: Member) {
        self.number.push(self.bodies.len() as u32);
        self.bodies.push(member);
    }

    /// The hard force of i and j on each other over the separation and one of the masses, G included.
    #[inline(always)]
    pub fn pull(&self, i: usize, j: usize, r2: f64) -> f64 {
        let (a, b) = (&self.bodies[i], &self.bodies[j]);
        let c = if a.cutoff > b.cutoff {
            a.cutoff
        } else {
            b.cutoff
        };
        if r2 >= c * c || r2 == 0.0 {
            return 0.0;
        }
        let hard = 1.0 - soft_part((r2 / (c * c)).sqrt());
        let q2 = r2 + (a.eps2 + b.eps2);
        self.g * hard / (q2 * q2.sqrt())
    }

    /// A first step: a part of the orbit and of the shortest time in which a pair changes.
    pub fn first_step(&self) -> f64 {
        let mut shortest = f64::INFINITY;
        for (i, a) in self.bodies.iter().enumerate() {
            let q2 = a.x.norm_squared();
            if self.mu > 0.0 && q2 > 0.0 {
                shortest = shortest.min(0.3 * (q2 * q2.sqrt() / self.mu).sqrt());
            }
            for b in &self.bodies[..i] {
                let r2 = (a.x - b.x).norm_squared();
                let c = a.cutoff.max(b.cutoff);
                if r2 < c * c && r2 > 0.0 {
                    let crossing = (r2 / (a.v - b.v).norm_squared()).sqrt();
                    let fall = (r2 * r2.sqrt() / (self.g * (a.m + b.m))).sqrt();
                    shortest = shortest.min(0.4 * crossing.min(fall));
                }
            }
        }
        shortest
    }

    /// The first pair that overlaps and comes closer.
    pub fn overlap(&self) -> Option<[usize; 2]> {
        let n = self.bodies.len();
        let pairs = (0..n).flat_map(|i| (0..i).map(move |j| [j, i]));
        pairs.into_iter().find(|&[i, j]| {
            let (a, b) = (&self.bodies[i], &self.bodies[j]);
            let reach = a.radius + b.radius;
            let d = b.x - a.x;
            d.norm_squared() < reach * reach && d.dot(&(b.v - a.v)) <= 0.0 && self.can_touch(i, j)
        })
    }

    /// Whether there is a sense in these two touching.
    pub fn can_touch(&self, i: usize, j: usize) -> bool {
        let (a, b) = (&self.bodies[i], &self.bodies[j]);
        a.radius + b.radius > 0.0 && a.m + b.m > 0.0
    }

    /// Binds two bodies together at `time`; the last body takes the place of the one that is absorbed, which is returned.
    pub fn bind(&mut self, [i, j]: [usize; 2], time: f64) -> usize {
        let (kept, lost) = (i.min(j), i.max(j));
        let (a, b) = (self.bodies[kept], self.bodies[lost]);
        let share = b.m / (a.m + b.m);
        let (d, w) = (b.x - a.x, b.v - a.v);
        self.contacts.push(Contact {
            pair: [self.number[kept], self.number[lost]],
            time,
            share,
            d,
            w,
        });
        self.bodies[kept] = Member {
            m: a.m + b.m,
            radius: (a.radius.powi(3) + b.radius.powi(3)).cbrt(),
            eps2: a.eps2.max(b.eps2),
            cutoff: a.cutoff.max(b.cutoff),
            x: a.x + d * share,
            v: a.v + w * share,
        };
        self.bodies.swap_remove(lost);
        self.number.swap_remove(lost);
        lost
    }

    /// Positions and velocities of all members, by number.
    pub fn lay_out(&self, x: &mut [Vec3], v: &mut [Vec3]) {
        for (body, &number) in self.bodies.iter().zip(&self.number) {
            (x[number as usize], v[number as usize]) = (body.x, body.v);
        }
        for contact in self.contacts.iter().rev() {
            let [kept, lost] = contact.pair.map(|i| i as usize);
            x[kept] -= contact.d * contact.share;
            v[kept] -= contact.w * contact.share;
            (x[lost], v[lost]) = (x[kept] + contact.d, v[kept] + contact.w);
        }
    }
}

impl Field for Group {
    type Common = ();

    fn common(&self, _: &[Vec3], _: &[Vec3]) {}

    fn centre(&self, _: usize) -> [f64; 2] {
        [self.mu, 0.0]
    }

    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], (): &()) -> [Vec3; 2] {
        let newton = |d: &Vec3, w: &Vec3, q2: f64| {
            let inverse = 1.0 / q2;
            let cube = inverse * inverse.sqrt();
            [d * cube, (w - d * (3.0 * inverse * d.dot(w))) * cube]
        };
        let mut sum = [Vec3::zeros(); 2];
        let a = &self.bodies[i];
        for (j, b) in self.bodies.iter().enumerate() {
            let d = x[j] - x[i];
            let r2 = d.norm_squared();
            let c = a.cutoff.max(b.cutoff);
            if j == i || r2 >= c * c || r2 == 0.0 {
                continue;
            }
            let w = v[j] - v[i];
            let y = r2.sqrt() / c;
            let [pull, jerk] = newton(&d, &w, r2 + (a.eps2 + b.eps2));
            let hard = 1.0 - soft_part(y);
            let rate = -slope(y) * d.dot(&w) / (y * c * c);
            sum[0] += pull * (self.g * b.m * hard);
            sum[1] += (jerk * hard + pull * rate) * (self.g * b.m);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> Group {
        let mut group = Group::default();
        group.begin(1.0, 1.0);
        for k in 0..3 {
            let f = f64::from(k);
            group.add(Member {
                m: 0.01 * (1.0 + f),
                radius: 0.01,
                eps2: 1e-4 * f,
                cutoff: 0.4,
                x: Vec3::new(1.0, 0.1 * f, 0.07 * f * f),
                v: Vec3::new(0.2 * f, 1.0 - 0.1 * f, 0.0),
            });
        }
        group
    }

    #[test]
    fn the_jerk_is_the_change_of_the_pull() {
        let group = three();
        let at = |t: f64| -> Vec<Vec3> { group.bodies.iter().map(|b| b.x + b.v * t).collect() };
        let v: Vec<Vec3> = group.bodies.iter().map(|b| b.v).collect();
        for i in 0..3 {
            let pull = |t: f64| Field::pull(&group, i, &at(t), &v, &());
            let numerical = (pull(1e-5)[0] - pull(-1e-5)[0]) / 2e-5;
            let jerk = pull(0.0)[1];
            assert!((numerical - jerk).norm() < 1e-8 * jerk.norm());
        }
    }

    #[test]
    fn what_is_bound_together_is_laid_apart_as_it_was() {
        let mut group = three();
        let before: Vec<Member> = group.bodies.clone();
        assert_eq!(group.bind([0, 1], 0.1), 1);
        assert_eq!(group.bind([0, 1], 0.2), 1);
        assert_eq!(group.bodies.len(), 1);
        let total: f64 = before.iter().map(|b| b.m).sum();
        let centre: Vec3 = before.iter().map(|b| b.x * b.m).sum::<Vec3>() / total;
        assert!((group.bodies[0].x - centre).norm() < 1e-15);
        let mut x = [Vec3::zeros(); 3];
        let mut v = x;
        group.lay_out(&mut x, &mut v);
        for i in 0..3 {
            assert!((x[i] - before[i].x).norm() < 1e-15 && (v[i] - before[i].v).norm() < 1e-15);
        }
    }
}
