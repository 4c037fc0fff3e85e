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
    /// Takes up the points that `near` names by position, support and pull.
    pub fn gather(&mut self, centre: Vec3, near: impl FnOnce(&mut dyn FnMut(Vec3, f64, f64))) {
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
        near(&mut |x, support, pull| {
            let x = x - centre;
            self.x.push(x.x as f32);
            self.y.push(x.y as f32);
            self.z.push(x.z as f32);
            self.support.push(support as f32);
            self.pull.push(pull as f32);
        });
        self.inside.resize(self.x.len(), false);
        self.near.resize(self.x.len() + 1, 0);
    }

    /// Leaves in `pairs` the separations dx, dy, dz, and inverse support and pull, of the points within either support.
    pub fn select(&mut self, x: Vec3, support: f64) {
        let n = self.x.len();
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
        for column in &mut self.pairs {
            column.clear();
        }
        for &j in &self.near[..count] {
            let j = j as usize;
            self.pairs[0].push(at.x - self.x[j]);
            self.pairs[1].push(at.y - self.y[j]);
            self.pairs[2].push(at.z - self.z[j]);
            self.pairs[3].push(1.0 / self.support[j]);
            self.pairs[4].push(self.pull[j]);
        }
        let full = count.next_multiple_of(LANES);
        for (column, out) in self
            .pairs
            .iter_mut()
            .zip([1.0, 0.0, 0.0, f32::INFINITY, 0.0])
        {
            column.resize(full, out);
        }
        // A filler at distance support is outside of the point's own kernel too.
        self.pairs[0][count..].fill(2.0 * own);
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
