//! The chain of Jacobi coordinates: each body seen from the centre of mass of the star and the bodies before it.
//!
//! With M_i = m_0 + .. + m_i, heliocentric q_i = x'_i + sum_{j<i} m_j/M_j x'_j. What is left of the forces beside the Kepler part
//! -G M_i x'/x'^3 is  a'_i = M_i (t_i - m_0/M_{i-1} s_i) + p_i - (m_0 sum_{j>i} m_j s_j + sum_{j<i} m_j p_j)/M_{i-1}  with t = G x'/x'^3,
//! s = G q/q^3 and p the pull of the other bodies: the star's great pulls are nowhere subtracted from each other, and massless bodies
//! are as good as others. Bodies pull each other by direct sum, softened; the star's pull is not softened.
//! Source: Wisdom & Holman (1991); Rein & Tamayo (2015).

use fearless_simd::{Select, Simd};

use crate::bodies::Bodies;
use crate::kepler::abreast::Wide;
use crate::orbit::Elements;
use crate::points::Vec3;

/// Coordinates of the bodies along the chain, one column an axis.
pub type Columns = [Vec<f64>; 3];

/// What masses and order of the bodies fix. Columns are padded to whole lanes with bodies that neither pull nor move.
#[derive(Clone, Debug)]
pub struct Chain {
    /// Place of each link among the bodies, outwards from the star.
    pub order: Vec<usize>,
    /// G m_0
    gm_star: f64,
    /// G m_i
    gm: Vec<f64>,
    /// G M_i; zero in padding
    pub mu: Vec<f64>,
    /// 1/(G M_{i-1}); zero in padding
    inner: Vec<f64>,
    /// m_0/M_{i-1}
    share: Vec<f64>,
    /// m_i/M_i
    part: Vec<f64>,
    /// m_i/M_n
    weight: Vec<f64>,
    /// squared softening length
    eps2: Vec<f64>,
    /// one; zero in padding
    unit: Vec<f64>,
}

/// Buffers of the forces.
#[derive(Clone, Debug, Default)]
pub struct Forces {
    q: Columns,
    s: Columns,
    p: Columns,
    rest: Columns,
    /// The accelerations a'.
    pub a: Columns,
}

pub fn zeros(n: usize) -> Columns {
    [vec![0.0; n], vec![0.0; n], vec![0.0; n]]
}

impl Forces {
    pub fn sized(n: usize) -> Self {
        Self {
            q: zeros(n),
            s: zeros(n),
            p: zeros(n),
            rest: zeros(n),
            a: zeros(n),
        }
    }
}

/// The bodies' places in the order of their semi-major axes about the star, unbound ones last.
pub fn outwards(g: f64, star: &Bodies, bodies: &Bodies) -> Vec<usize> {
    let axis = |i: usize| {
        let mu = g * (star.m[0] + bodies.m[i]);
        let (x, v) = (bodies.x[i] - star.x[0], bodies.v[i] - star.v[0]);
        match Elements::of(mu, x, v) {
            Some(orbit) if orbit.semi_major_axis > 0.0 => orbit.semi_major_axis,
            _ => f64::INFINITY,
        }
    };
    let axes: Vec<f64> = (0..bodies.m.len()).map(axis).collect();
    let mut order: Vec<usize> = (0..axes.len()).collect();
    order.sort_by(|&i, &j| axes[i].total_cmp(&axes[j]));
    order
}

impl Chain {
    /// The chain of `bodies` in the given order.
    pub fn new(g: f64, star: &Bodies, bodies: &Bodies, order: Vec<usize>) -> Self {
        assert!(star.m[0] > 0.0, "a star with mass holds the chain");
        let n = order.len();
        let padded = n.next_multiple_of(if n > 4 { 8 } else { 4 });
        let column = || vec![0.0; padded];
        let gm_star = g * star.m[0];
        let total = gm_star + order.iter().map(|&i| g * bodies.m[i]).sum::<f64>();
        let mut chain = Self {
            gm_star,
            gm: column(),
            mu: column(),
            inner: column(),
            share: column(),
            part: column(),
            weight: column(),
            eps2: column(),
            unit: column(),
            order,
        };
        let mut inside = gm_star;
        for k in 0..n {
            let i = chain.order[k];
            let gm = g * bodies.m[i];
            (chain.gm[k], chain.mu[k], chain.unit[k]) = (gm, inside + gm, 1.0);
            (chain.inner[k], chain.share[k]) = (1.0 / inside, gm_star / inside);
            inside += gm;
            (chain.part[k], chain.weight[k]) = (gm / inside, gm / total);
            chain.eps2[k] = bodies.softening[i] * bodies.softening[i];
        }
        chain
    }

    /// Bodies with padding.
    pub fn padded(&self) -> usize {
        self.gm.len()
    }

    /// Jacobi coordinates of what the bodies have as `of`, the star as `star`. Padding lies at (1, 0, 0).
    pub fn coordinates(&self, star: Vec3, of: &[Vec3]) -> Columns {
        let mut columns = zeros(self.padded());
        columns[0].fill(1.0);
        let mut sum = Vec3::zeros();
        for (k, &i) in self.order.iter().enumerate() {
            let q = of[i] - star;
            let x = q - sum * self.inner[k];
            sum += q * self.gm[k];
            for axis in 0..3 {
                columns[axis][k] = x[axis];
            }
        }
        columns
    }

    /// The inverse of [`Chain::coordinates`] for a centre of mass at `centre`: writes the bodies' to `of`, answers the star's.
    pub fn places(&self, columns: &Columns, centre: Vec3, of: &mut [Vec3]) -> Vec3 {
        let (mut sum, mut lever) = (Vec3::zeros(), Vec3::zeros());
        for (k, &i) in self.order.iter().enumerate() {
            let x = Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
            of[i] = x + sum;
            sum += x * self.part[k];
            lever += of[i] * self.weight[k];
        }
        let star = centre - lever;
        of.iter_mut().for_each(|x| *x += star);
        star
    }

    /// Centre of mass of star and bodies.
    pub fn centre(&self, star: Vec3, of: &[Vec3]) -> Vec3 {
        let links = self.order.iter().zip(&self.weight);
        star + links.map(|(&i, w)| (of[i] - star) * *w).sum::<Vec3>()
    }

    /// The accelerations a' at Jacobi coordinates `x`, into `forces`.
    #[inline(always)]
    pub fn accelerations<S: Simd, V: Wide<S>>(&self, simd: S, x: &Columns, forces: &mut Forces) {
        let n = self.order.len();
        for (q, x) in forces.q.iter_mut().zip(x) {
            let mut sum = 0.0;
            for ((q, x), part) in q.iter_mut().zip(x).zip(&self.part) {
                *q = x + sum;
                sum += part * x;
            }
        }
        for i in (0..self.padded()).step_by(V::LEN) {
            self.pulls::<S, V>(simd, i, forces);
        }
        for axis in 0..3 {
            let (s, p, rest) = (&forces.s[axis], &forces.p[axis], &mut forces.rest[axis]);
            let mut sum = 0.0;
            for k in (0..n).rev() {
                rest[k] = sum;
                sum += self.gm[k] * s[k];
            }
            sum = 0.0;
            for k in 0..n {
                rest[k] = (self.gm_star * rest[k] + sum) * self.inner[k];
                sum += self.gm[k] * p[k];
            }
        }
        for i in (0..self.padded()).step_by(V::LEN) {
            self.remainder::<S, V>(simd, i, x, forces);
        }
    }

    /// s and p of the links from `i` on.
    #[inline(always)]
    fn pulls<S: Simd, V: Wide<S>>(&self, simd: S, i: usize, forces: &mut Forces) {
        let load = |column: &[f64]| V::from_slice(simd, &column[i..i + V::LEN]);
        let zero = V::splat(simd, 0.0);
        let q: [V; 3] = std::array::from_fn(|axis| load(&forces.q[axis]));
        let eps2 = load(&self.eps2);
        let mut p = [zero; 3];
        for j in 0..self.order.len() {
            let d: [V; 3] = std::array::from_fn(|axis| q[axis] - forces.q[axis][j]);
            let r2 = square::<S, V>(d) + (eps2 + self.eps2[j]);
            let cube = r2 * r2.sqrt();
            // A body does not pull itself, nor do bodies at one place.
            let w = cube
                .simd_gt(zero)
                .select(V::splat(simd, self.gm[j]) / cube, zero);
            p = std::array::from_fn(|axis| p[axis] - w * d[axis]);
        }
        let r2 = square::<S, V>(q);
        let w = V::splat(simd, 1.0) / (r2 * r2.sqrt());
        for axis in 0..3 {
            p[axis].store_slice(&mut forces.p[axis][i..i + V::LEN]);
            (q[axis] * w).store_slice(&mut forces.s[axis][i..i + V::LEN]);
        }
    }

    /// a' of the links from `i` on.
    #[inline(always)]
    fn remainder<S: Simd, V: Wide<S>>(&self, simd: S, i: usize, x: &Columns, forces: &mut Forces) {
        let load = |column: &[f64]| V::from_slice(simd, &column[i..i + V::LEN]);
        let (mu, share, unit) = (load(&self.mu), load(&self.share), load(&self.unit));
        let x: [V; 3] = std::array::from_fn(|axis| load(&x[axis]));
        let r2 = square::<S, V>(x);
        let w = V::splat(simd, 1.0) / (r2 * r2.sqrt());
        for (axis, x) in x.into_iter().enumerate() {
            let own = mu * (x * w - share * load(&forces.s[axis]));
            let a = (own + (load(&forces.p[axis]) - load(&forces.rest[axis]))) * unit;
            a.store_slice(&mut forces.a[axis][i..i + V::LEN]);
        }
    }
}

#[inline(always)]
fn square<S: Simd, V: Wide<S>>([x, y, z]: [V; 3]) -> V {
    z.mul_add(z, y.mul_add(y, x * x))
}
