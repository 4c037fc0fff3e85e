//! The pairs of a glass: points near a leaf gathered once, chosen for each of the leaf's points, and summed side by side.

use nbody::points::Vec3;

/// Pairs that are summed side by side.
const LANES: usize = 8;

/// Sums over the pairs of a point: of (1-q)^4 (1+4q) and q^2 (1-q)^3 in its own kernel, and of the forces in its own and in the others'.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    pub value: f64,
    pub rim: f64,
    pub own: Vec3,
    pub others: Vec3,
}

/// Points near a leaf, one coordinate a column, relative to the leaf's centre; and those of them near one point, relative to that.
/// Single precision: no length here is more than a few kernels.
#[derive(Debug, Default)]
pub struct Candidates {
    centre: Vec3,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    support: Vec<f32>,
    /// Weight of the point's own kernel gradient.
    pull: Vec<f32>,
    inside: Vec<bool>,
    near: Vec<u32>,
    pairs: [Vec<f32>; 5],
}

impl Candidates {
    /// Forgets all points; those to come are near `centre`.
    pub fn clear(&mut self, centre: Vec3) {
        for column in [
            &mut self.x,
            &mut self.y,
            &mut self.z,
            &mut self.support,
            &mut self.pull,
        ] {
            column.clear();
        }
        self.centre = centre;
    }

    /// Takes up points by position, moved by `shift`, support and pull.
    pub fn gather(&mut self, x: &[Vec3], shift: Vec3, support: &[f64], pull: &[f64]) {
        let shift = shift - self.centre;
        self.x.extend(x.iter().map(|x| (x.x + shift.x) as f32));
        self.y.extend(x.iter().map(|x| (x.y + shift.y) as f32));
        self.z.extend(x.iter().map(|x| (x.z + shift.z) as f32));
        self.support.extend(support.iter().map(|&s| s as f32));
        self.pull.extend(pull.iter().map(|&p| p as f32));
    }

    /// Leaves in `pairs` the separations dx, dy, dz, and inverse support and pull, of the points within either support.
    pub fn select(&mut self, x: Vec3, support: f64) {
        let n = self.x.len();
        self.inside.resize(n, false);
        self.near.resize(n + 1, 0);
        let own = support as f32;
        let at = (x - self.centre).map(|c| c as f32);
        let (xs, ys, zs) = (&self.x[..n], &self.y[..n], &self.z[..n]);
        let (supports, inside) = (&self.support[..n], &mut self.inside[..n]);
        for j in 0..n {
            let (dx, dy, dz) = (at.x - xs[j], at.y - ys[j], at.z - zs[j]);
            let reach = if own > supports[j] { own } else { supports[j] };
            inside[j] = dx * dx + dy * dy + dz * dz < reach * reach;
        }
        let mut count = 0;
        for (j, &inside) in inside.iter().enumerate() {
            // Without a branch: a guess would be wrong too often.
            self.near[count] = j as u32;
            count += usize::from(inside);
        }
        let chosen = &self.near[..count];
        for column in &mut self.pairs {
            column.resize(count.next_multiple_of(LANES), 0.0);
        }
        let [x, y, z, inverse, pull] = &mut self.pairs;
        for (k, &j) in chosen.iter().enumerate() {
            let j = j as usize;
            x[k] = at.x - xs[j];
            y[k] = at.y - ys[j];
            z[k] = at.z - zs[j];
            inverse[k] = 1.0 / supports[j];
            pull[k] = self.pull[j];
        }
        // Fillers lie outside of the point's own kernel and have none.
        x[count..].fill(2.0 * own);
        pull[count..].fill(0.0);
    }

    /// Sums over what `select` left, in the point's own kernel of inverse support `inverse`.
    pub fn sums(&self, inverse: f32) -> Found {
        let mut sums = [[0f32; LANES]; 8];
        let [x, y, z, inverses, pulls] = &self.pairs;
        let columns = x
            .chunks_exact(LANES)
            .zip(y.chunks_exact(LANES))
            .zip(z.chunks_exact(LANES))
            .zip(inverses.chunks_exact(LANES))
            .zip(pulls.chunks_exact(LANES));
        for ((((x, y), z), inverses), pulls) in columns {
            for k in 0..LANES {
                let r = (x[k] * x[k] + y[k] * y[k] + z[k] * z[k]).sqrt();
                let q = r * inverse;
                let rest = if q < 1.0 { 1.0 - q } else { 0.0 };
                let cube = rest * rest * rest;
                sums[0][k] += cube * rest * (1.0 + 4.0 * q);
                sums[1][k] += q * q * cube;
                let q = r * inverses[k];
                let rest = if q < 1.0 { 1.0 - q } else { 0.0 };
                let other = rest * rest * rest * pulls[k];
                sums[2][k] += cube * x[k];
                sums[3][k] += cube * y[k];
                sums[4][k] += cube * z[k];
                sums[5][k] += other * x[k];
                sums[6][k] += other * y[k];
                sums[7][k] += other * z[k];
            }
        }
        let total = |k: usize| f64::from(sums[k].iter().sum::<f32>());
        Found {
            value: total(0),
            rim: total(1),
            own: Vec3::new(total(2), total(3), total(4)),
            others: Vec3::new(total(5), total(6), total(7)),
        }
    }
}
