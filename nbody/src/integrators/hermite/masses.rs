//! Star and bodies as point masses, softened by their own lengths: a = G m d/(d^2 + eps_i^2 + eps_j^2)^(3/2).
//!
//! Around a star places count from it: a_i = -G (M + m_i) r_i/q_i^3 + sum_j G m_j (d_ij/q_ij^3 - r_j/q_j^3). The star is where the centre of mass,
//! which goes straight, wants it.

use super::{Field, Hermite, Stall};
use crate::bodies::Bodies;
use crate::points::Vec3;

#[derive(Clone, Debug, Default)]
pub struct Masses {
    pub g: f64,
    /// Mass and square of the softening length of the star in the middle.
    star: Option<[f64; 2]>,
    m: Vec<f64>,
    eps2: Vec<f64>,
    /// Places and velocities, from the star.
    state: [Vec<Vec3>; 2],
}

impl Field for Masses {
    /// Acceleration and jerk of the star in the middle, turned round.
    type Common = [Vec3; 2];

    fn common(&self, x: &[Vec3], v: &[Vec3]) -> [Vec3; 2] {
        let mut sum = [Vec3::zeros(); 2];
        if let Some([_, eps2]) = self.star {
            (0..x.len()).for_each(|j| self.add_recoil(&mut sum, -self.g, eps2, (j, x, v)));
        }
        sum
    }

    fn centre(&self, i: usize) -> [f64; 2] {
        self.star.map_or([0.0; 2], |[m, eps2]| {
            [self.g * (m + self.m[i]), eps2 + self.eps2[i]]
        })
    }

    fn pull(&self, i: usize, x: &[Vec3], v: &[Vec3], common: &[Vec3; 2]) -> [Vec3; 2] {
        let mut sum = *common;
        if let Some([_, eps2]) = self.star {
            self.add_recoil(&mut sum, self.g, eps2, (i, x, v));
        }
        for j in (0..x.len()).filter(|&j| j != i) {
            let (d, w) = (x[j] - x[i], v[j] - v[i]);
            add(
                &mut sum,
                self.g * self.m[j],
                (d, w),
                self.eps2[i] + self.eps2[j],
            );
        }
        sum
    }
}

/// Adds acceleration and jerk by `gm` at `d`, which changes with `w`.
#[inline(always)]
fn add(sum: &mut [Vec3; 2], gm: f64, (d, w): (Vec3, Vec3), eps2: f64) {
    let q2 = d.norm_squared() + eps2;
    if q2 != 0.0 {
        let inverse = 1.0 / q2;
        let pull = gm * inverse * inverse.sqrt();
        sum[0] += d * pull;
        sum[1] += (w - d * (3.0 * inverse * d.dot(&w))) * pull;
    }
}

impl Masses {
    /// Unsoftened masses; a star of none leaves places where they count from.
    pub fn new(g: f64, star: f64, m: &[f64]) -> Self {
        Self {
            g,
            star: (star > 0.0).then_some([star, 0.0]),
            m: m.to_vec(),
            eps2: vec![0.0; m.len()],
            ..Self::default()
        }
    }

    /// Adds `g` times what body j does to a star of softening `eps2`.
    #[inline(always)]
    fn add_recoil(
        &self,
        sum: &mut [Vec3; 2],
        g: f64,
        eps2: f64,
        (j, x, v): (usize, &[Vec3], &[Vec3]),
    ) {
        add(sum, g * self.m[j], (x[j], v[j]), eps2 + self.eps2[j]);
    }

    /// Moves star and bodies on each other by `dt`. The place of a stall counts the star as the first.
    pub fn drift(
        &mut self,
        hermite: &mut Hermite,
        star: &mut Bodies,
        bodies: &mut Bodies,
        dt: f64,
    ) -> Result<(), Stall> {
        let stars = star.x.len();
        let own = star.m.iter().zip(&star.softening).next();
        self.star = own.map(|(m, eps)| [*m, eps * eps]);
        self.m.clone_from(&bodies.m);
        self.eps2.clear();
        let softening = bodies.softening.iter();
        self.eps2.extend(softening.map(|eps| eps * eps));
        let mut state = std::mem::take(&mut self.state);
        let mut origin = [Vec3::zeros(); 2];
        if stars > 0 {
            origin = [star.x[0], star.v[0]];
        }
        for ((all, column), origin) in state.iter_mut().zip([&bodies.x, &bodies.v]).zip(origin) {
            all.clear();
            all.extend(column.iter().map(|value| value - origin));
        }
        let before = self.lever(&state);
        let [x, v] = &mut state;
        let done = hermite.advance(self, (x, v), dt);
        let after = self.lever(&state);
        if stars > 0 {
            // The centre of mass goes straight.
            star.x[0] += (before[0] - after[0]) + (origin[1] + before[1]) * dt;
            star.v[0] += before[1] - after[1];
            origin = [star.x[0], star.v[0]];
        }
        let columns = [&mut bodies.x, &mut bodies.v];
        for ((column, all), origin) in columns.into_iter().zip(&state).zip(origin) {
            let values = all.iter().map(|value| value + origin);
            column
                .iter_mut()
                .zip(values)
                .for_each(|(to, value)| *to = value);
        }
        self.state = state;
        done.map_err(|stall| Stall {
            place: stall.place + stars,
        })
    }

    /// Place and velocity of the centre of mass, from the star.
    fn lever(&self, state: &[Vec<Vec3>; 2]) -> [Vec3; 2] {
        let total = self.star.map_or(0.0, |[m, _]| m) + self.m.iter().sum::<f64>();
        let inverse = if total > 0.0 { 1.0 / total } else { 0.0 };
        let mean = |all: &Vec<Vec3>| {
            let parts = all.iter().zip(&self.m).map(|(value, m)| value * *m);
            parts.sum::<Vec3>() * inverse
        };
        [mean(&state[0]), mean(&state[1])]
    }
}
