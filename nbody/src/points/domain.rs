//! The domain: where particles may be, what lies beyond its faces, and how many dimensions it has.

use super::Vec3;

/// What lies beyond the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// Empty space without end.
    Open,
    /// Copies of the box [0, size) along every dimension of the domain.
    Periodic { size: Vec3 },
}

/// The domain of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    pub boundary: Boundary,
    /// Which axes the domain has: all three, or the two of its plane. Positions keep their value along a missing axis.
    pub axes: [bool; 3],
}

impl Domain {
    /// Three-dimensional space without faces.
    pub const fn open() -> Self {
        Self {
            boundary: Boundary::Open,
            axes: [true; 3],
        }
    }

    /// A three-dimensional periodic box [0, size).
    pub const fn periodic(size: Vec3) -> Self {
        Self {
            boundary: Boundary::Periodic { size },
            axes: [true; 3],
        }
    }

    /// The same domain with the given axes alone, e.g. `[true, true, false]` for the xy plane.
    pub const fn with_axes(self, axes: [bool; 3]) -> Self {
        Self { axes, ..self }
    }

    /// 2 or 3.
    pub fn dimensions(&self) -> usize {
        self.axes.iter().filter(|&&axis| axis).count()
    }

    /// The part of `v` that moves a particle: zero along missing axes.
    pub fn in_plane(&self, mut v: Vec3) -> Vec3 {
        for axis in 0..3 {
            if !self.axes[axis] {
                v[axis] = 0.0;
            }
        }
        v
    }

    /// Period along `axis`; zero where the domain does not repeat.
    pub fn period(&self, axis: usize) -> f64 {
        match self.boundary {
            Boundary::Periodic { size } if self.axes[axis] => size[axis],
            _ => 0.0,
        }
    }

    /// Volume of a closed domain (area in two dimensions); infinite for an open one.
    pub fn volume(&self) -> f64 {
        match self.boundary {
            Boundary::Open => f64::INFINITY,
            Boundary::Periodic { size } => (0..3)
                .filter(|&axis| self.axes[axis])
                .map(|axis| size[axis])
                .product(),
        }
    }

    /// Brings a position back into the box.
    pub fn wrap(&self, x: &mut Vec3) {
        for axis in 0..3 {
            let period = self.period(axis);
            if period > 0.0 && !(x[axis] >= 0.0 && x[axis] < period) {
                x[axis] = x[axis].rem_euclid(period);
                if x[axis] >= period {
                    x[axis] = 0.0;
                }
            }
        }
    }

    /// The separation to the nearest image.
    pub fn nearest(&self, mut dx: Vec3) -> Vec3 {
        for axis in 0..3 {
            let period = self.period(axis);
            if period > 0.0 {
                dx[axis] -= period * (dx[axis] / period).round();
            }
        }
        dx
    }

    /// Calls `visit` with every shift s, for which points in the box [lo, hi], moved by s, may meet the box [query_lo, query_hi].
    ///
    /// In an open domain that is the zero shift alone. The order is fixed.
    pub fn shifts(
        &self,
        query_lo: Vec3,
        query_hi: Vec3,
        lo: Vec3,
        hi: Vec3,
        mut visit: impl FnMut(Vec3),
    ) {
        let mut first = [0i32; 3];
        let mut last = [0i32; 3];
        for axis in 0..3 {
            let period = self.period(axis);
            if period > 0.0 {
                first[axis] = ((query_lo[axis] - hi[axis]) / period).ceil() as i32;
                last[axis] = ((query_hi[axis] - lo[axis]) / period).floor() as i32;
            }
        }
        for k in first[2]..=last[2] {
            for j in first[1]..=last[1] {
                for i in first[0]..=last[0] {
                    visit(Vec3::new(
                        f64::from(i) * self.period(0),
                        f64::from(j) * self.period(1),
                        f64::from(k) * self.period(2),
                    ));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapping_lands_inside_even_just_below_zero() {
        let domain = Domain::periodic(Vec3::new(1.0, 2.0, 3.0));
        for start in [-1e-300, -1e-17, -0.25, 1.0, 7.5, -7.5] {
            let mut x = Vec3::new(start, start, start);
            domain.wrap(&mut x);
            assert!(
                (0..3).all(|a| x[a] >= 0.0 && x[a] < domain.period(a)),
                "{start} became {x}"
            );
        }
    }

    #[test]
    fn shifts_name_each_image_that_a_query_meets() {
        let domain = Domain::periodic(Vec3::new(1.0, 1.0, 1.0)).with_axes([true, true, false]);
        let mut found = Vec::new();
        domain.shifts(
            Vec3::new(-0.1, 0.4, 0.0),
            Vec3::new(0.1, 0.6, 0.0),
            Vec3::zeros(),
            Vec3::new(0.99, 0.99, 0.0),
            |s| found.push((s.x, s.y, s.z)),
        );
        assert_eq!(found, [(-1.0, 0.0, 0.0), (0.0, 0.0, 0.0)]);
    }
}
