//! The domain: where particles may be, what lies beyond its faces, and how many dimensions it has.
//!
//! In a shearing box what lies across x is the box moved by the shear: an image i periods outwards stands i q Omega L_x t behind along y, and
//! moves i q Omega L_x slower. Velocities relative to the shear are the same for all images.
//! Source: Hawley, Gammie & Balbus (1995), ApJ 440, 742, section 2.3.

use super::{Hill, Vec3};

/// What lies beyond the faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// Empty space without end.
    Open,
    /// Copies of the box [0, size) along every dimension of the domain.
    Periodic { size: Vec3 },
    /// The same in Hill's frame; `offset` is how far the next box outwards stands behind along y now ([`Domain::at`]).
    Shearing { size: Vec3, hill: Hill, offset: f64 },
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

    /// A three-dimensional shearing box [0, size) at time zero, with no tide in its middle; `rate` is Omega and `shear` is q.
    pub fn shearing(size: Vec3, rate: f64, shear: f64) -> Self {
        let hill = Hill {
            rate,
            shear,
            middle: 0.5 * size.x,
        };
        Self {
            boundary: Boundary::Shearing {
                size,
                hill,
                offset: 0.0,
            },
            axes: [true; 3],
        }
    }

    /// The same domain as it is at `time`.
    pub fn at(self, time: f64) -> Self {
        let Boundary::Shearing { size, hill, .. } = self.boundary else {
            return self;
        };
        let offset = (hill.gradient() * size.x * time).rem_euclid(size.y);
        Self {
            boundary: Boundary::Shearing { size, hill, offset },
            ..self
        }
    }

    /// The frame of a shearing box.
    pub fn hill(&self) -> Option<&Hill> {
        match &self.boundary {
            Boundary::Shearing { hill, .. } => Some(hill),
            _ => None,
        }
    }

    /// Velocity relative to the shear, if there is one.
    #[inline(always)]
    pub fn relative(&self, x: Vec3, v: Vec3) -> Vec3 {
        self.hill().map_or(v, |hill| hill.relative(x, v))
    }

    /// -dv_y/dx of the shear; zero without one.
    pub fn shear_rate(&self) -> f64 {
        self.hill().map_or(0.0, Hill::gradient)
    }

    /// Lengths of a closed domain.
    pub fn size(&self) -> Option<Vec3> {
        match self.boundary {
            Boundary::Open => None,
            Boundary::Periodic { size } | Boundary::Shearing { size, .. } => Some(size),
        }
    }

    /// How far the next box outwards stands behind along y.
    fn offset(&self) -> f64 {
        match self.boundary {
            Boundary::Shearing { offset, .. } if self.axes[1] => offset,
            _ => 0.0,
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

    /// `margin` along the axes of the domain, without end along missing ones: distances there do not count.
    pub fn widened(&self, margin: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| {
            if self.axes[axis] {
                margin
            } else {
                f64::INFINITY
            }
        })
    }

    /// Period along `axis`; zero where the domain does not repeat.
    pub fn period(&self, axis: usize) -> f64 {
        match self.size() {
            Some(size) if self.axes[axis] => size[axis],
            _ => 0.0,
        }
    }

    /// Volume of a closed domain (area in two dimensions); infinite for an open one.
    pub fn volume(&self) -> f64 {
        self.size().map_or(f64::INFINITY, |size| {
            (0..3)
                .filter(|&axis| self.axes[axis])
                .map(|axis| size[axis])
                .product()
        })
    }

    /// Brings a position back into the box; returns what that changes the velocity by.
    pub fn wrap(&self, x: &mut Vec3) -> Vec3 {
        let mut change = Vec3::zeros();
        if let Boundary::Shearing { size, hill, .. } = self.boundary {
            let boxes = (x.x / size.x).floor();
            if boxes != 0.0 {
                x.y += boxes * self.offset();
                change.y = boxes * hill.gradient() * size.x;
            }
        }
        for axis in 0..3 {
            let period = self.period(axis);
            if period > 0.0 && !(x[axis] >= 0.0 && x[axis] < period) {
                x[axis] = x[axis].rem_euclid(period);
                if x[axis] >= period {
                    x[axis] = 0.0;
                }
            }
        }
        change
    }

    /// The separation to the nearest image.
    #[inline(always)]
    pub fn nearest(&self, dx: Vec3) -> Vec3 {
        let far = |size: Vec3| (0..3).any(|axis| dx[axis].abs() >= 0.5 * size[axis]);
        if self.size().is_some_and(far) {
            self.nearest_image(dx)
        } else {
            dx
        }
    }

    fn nearest_image(&self, mut dx: Vec3) -> Vec3 {
        if self.period(0) > 0.0 {
            dx.y += (dx.x / self.period(0)).round() * self.offset();
        }
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
        // The images along an axis that stands `moved` from where it is.
        let images = |axis: usize, moved: f64| {
            let period = self.period(axis);
            if period > 0.0 {
                let first = ((query_lo[axis] - moved - hi[axis]) / period).ceil();
                let last = ((query_hi[axis] - moved - lo[axis]) / period).floor();
                first as i32..=last as i32
            } else {
                0..=0
            }
        };
        for k in images(2, 0.0) {
            for i in images(0, 0.0) {
                let behind = f64::from(i) * self.offset();
                for j in images(1, -behind) {
                    visit(Vec3::new(
                        f64::from(i) * self.period(0),
                        f64::from(j) * self.period(1) - behind,
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
    fn the_nearest_image_is_at_most_half_a_period_away() {
        let size = Vec3::new(2.0, 3.0, 1.0);
        let sheared = Domain::shearing(size, 0.8, 1.5).at(1.7);
        for domain in [Domain::periodic(size), sheared] {
            for axis in 0..3 {
                for part in [0.3, 0.49, 0.5, 0.51, 0.9, 1.4] {
                    let mut dx = 0.1 * size;
                    dx[axis] = part * size[axis];
                    let near = domain.nearest(dx);
                    let apart = near.component_div(&size).amax();
                    assert!(apart <= 0.5 + 1e-15, "{part} along {axis}: {near}");
                    assert!(part >= 0.5 || near == dx, "{part} along {axis}: {near}");
                }
            }
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

    #[test]
    fn images_of_a_shearing_box_move_with_the_shear() {
        let (size, t) = (Vec3::new(2.0, 3.0, 1.0), 1.7);
        let domain = Domain::shearing(size, 0.8, 1.5).at(t);
        let hill = *domain.hill().expect("a frame");
        let x = Vec3::new(0.3, 2.9, 0.5);
        let v = Vec3::new(0.1, 0.2, 0.0);
        for boxes in [-2.0, -1.0, 1.0, 3.0] {
            // A particle that has always kept the velocity of the shear beside this one, `boxes` periods outwards.
            let moved = -boxes * hill.gradient() * size.x;
            let mut image = x + Vec3::new(boxes * size.x, moved * t, 0.0);
            let change = domain.wrap(&mut image);
            assert!((image - x).norm() < 1e-14, "{boxes}: {image}");
            assert!((v.y + moved + change.y - v.y).abs() < 1e-15);
            let apart = Vec3::new(boxes * size.x, moved * t, 0.0);
            assert!(domain.nearest(apart).norm() < 1e-14);
            let outside = x + Vec3::new(boxes * size.x, 0.0, 0.0);
            let faster = Vec3::new(0.0, moved, 0.0);
            let same = domain.relative(outside, v + faster) - domain.relative(x, v);
            assert!(same.norm() < 1e-14);
        }
        let mut found = Vec::new();
        let (lo, hi) = (Vec3::new(1.9, 0.0, 0.4), Vec3::new(2.1, 3.0, 0.6));
        let inside = size * 0.999;
        domain.shifts(lo, hi, Vec3::zeros(), inside, |s| found.push(s));
        let offset = (1.2 * 2.0 * t) % 3.0;
        assert!(found.iter().any(|s| *s == Vec3::zeros()));
        assert!(
            found
                .iter()
                .any(|s| (s - Vec3::new(2.0, -offset, 0.0)).norm() < 1e-14)
        );
        assert!(
            found
                .iter()
                .any(|s| (s - Vec3::new(2.0, 3.0 - offset, 0.0)).norm() < 1e-14)
        );
        assert_eq!(found.len(), 4);
    }
}
