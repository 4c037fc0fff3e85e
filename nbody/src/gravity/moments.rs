//! Moments of the nodes: mass m, centre of mass c, mean softening, and second moments about the centre of mass.
//!
//! S = sum m (x - c)(x - c), exactly shifted from children to parents: S_parent = sum S + m (c - c_parent)(c - c_parent).
//! Masses are in units of the total mass, the rest in code units. eps^2 is the mass-weighted mean of the squares.

use crate::points::{Node, Tree, Vec3};

use super::sources::Sources;

/// Moments of one node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    pub m: f64,
    pub centre: Vec3,
    pub eps2: f64,
    /// xx, yy, zz, xy, xz, yz
    pub second: [f64; 6],
}

impl Moment {
    pub fn trace(&self) -> f64 {
        self.second[0] + self.second[1] + self.second[2]
    }

    /// Moments of several parts together.
    pub fn of(parts: impl Iterator<Item = Moment> + Clone) -> Self {
        let mut sum = Self::default();
        for part in parts.clone() {
            sum.m += part.m;
            sum.centre += part.m * part.centre;
            sum.eps2 += part.m * part.eps2;
        }
        if sum.m > 0.0 {
            sum.centre /= sum.m;
            sum.eps2 /= sum.m;
        }
        for part in parts {
            let d = part.centre - sum.centre;
            let products = [
                d.x * d.x,
                d.y * d.y,
                d.z * d.z,
                d.x * d.y,
                d.x * d.z,
                d.y * d.z,
            ];
            for (second, (own, product)) in
                sum.second.iter_mut().zip(part.second.iter().zip(products))
            {
                *second += own + part.m * product;
            }
        }
        sum
    }
}

/// Moments of all nodes of `tree`, leaves from their particles, parents from their children.
pub fn refresh(tree: &Tree, sources: &Sources, moments: &mut Vec<Moment>) {
    let leaf = |node: &Node| {
        Moment::of(sources.of(node.range()).map(|j| Moment {
            m: sources.m[j],
            centre: sources.position(j),
            eps2: sources.eps2(j),
            second: [0.0; 6],
        }))
    };
    let both = |a, b| Moment::of([a, b].into_iter());
    tree.accumulate(moments, &leaf, &both);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(n: u32) -> Vec<Moment> {
        let f = |i: u32, k: f64| (f64::from(i) * k).fract();
        let point = |i| Moment {
            m: 0.1 + f(i, 0.316_228),
            centre: Vec3::new(f(i, 0.618_034), f(i, 0.414_214), f(i, 0.732_051)),
            eps2: f(i, 0.236_068),
            second: [0.0; 6],
        };
        (1..=n).map(point).collect()
    }

    #[test]
    fn shifted_moments_are_those_of_the_particles() {
        let all = points(30);
        let whole = Moment::of(all.iter().copied());
        let parts = [&all[..7], &all[7..20], &all[20..]];
        let shifted = Moment::of(parts.map(|p| Moment::of(p.iter().copied())).into_iter());
        let near = |a: f64, b: f64| (a - b).abs() < 1e-14 * a.abs().max(1.0);
        assert!(near(whole.m, shifted.m) && near(whole.eps2, shifted.eps2));
        assert!((whole.centre - shifted.centre).norm() < 1e-14);
        let plain = |f: fn(Vec3) -> f64| -> f64 {
            let spread = |p: &Moment| p.m * f(p.centre - whole.centre);
            all.iter().map(spread).sum()
        };
        assert!(near(plain(|d| d.norm_squared()), whole.trace()));
        assert!(near(plain(|d| d.x * d.y), whole.second[3]));
        assert!(near(plain(|d| d.x * d.z), whole.second[4]));
        assert!(near(plain(|d| d.y * d.z), whole.second[5]));
        let pairs = whole.second.iter().zip(shifted.second);
        assert!(pairs.into_iter().all(|(&a, b)| near(a, b)));
    }
}
