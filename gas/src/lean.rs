//! Leaning: gas as the drag that is to come will leave it.
//!
//! Drag acts in halves, an impulse at the beginning t of a grain's step 2s and one, d, at its end. In between the gas has had one half, but should have
//! had a part (t' - t)/2s of the whole: forces that depend on velocity or heat, taken at the end of a step before drag closes it, would lag by half a
//! step, which leaves the splitting of first order. So sweeps see v_pred + d (f - 1), f = (t' - t)/s up to 2, with the d that is expected
//! when the step begins; what drag then does beyond it changes the work of pressure by so much, which is made up for when it does.

use nbody::points::Vec3;

use crate::Gas;

/// How far beyond its step a drag is still expected, by rounding.
const LATE: f64 = 1e-9;

/// What a gas particle is to receive at the end of a drag's step that begins now.
#[derive(Clone, Copy, Debug)]
pub struct Coming {
    pub dv: Vec3,
    pub du: f64,
    /// Half of the step.
    pub half: f64,
}

impl Gas {
    /// Makes room for what is to come of drag.
    pub fn expect_drag(&mut self) {
        let n = self.len();
        let r = &mut self.rates;
        r.drag_dv.resize(n, Vec3::zeros());
        for column in [&mut r.drag_du, &mut r.drag_since, &mut r.drag_half] {
            column.resize(n, 0.0);
        }
    }

    /// Notes what gas particle `j` is to receive of a step that begins at `time`, beside what else it is to since then.
    pub fn expect_impulse(&mut self, j: usize, time: f64, coming: Coming) {
        let r = &mut self.rates;
        if r.drag_since[j] == time && r.drag_half[j] > 0.0 {
            r.drag_dv[j] += coming.dv;
            r.drag_du[j] += coming.du;
        } else {
            (r.drag_dv[j], r.drag_du[j]) = (coming.dv, coming.du);
            (r.drag_since[j], r.drag_half[j]) = (time, coming.half);
        }
    }

    /// What part of its coming impulse gas particle `j` leans by at `time`.
    fn leaning(&self, j: usize, time: f64) -> f64 {
        let r = &self.rates;
        let passed = (time - r.drag_since[j]) / r.drag_half[j];
        // Not for those that drag has never met, either.
        if passed <= 2.0 + LATE {
            passed - 1.0
        } else {
            0.0
        }
    }

    /// The change of velocity that the sweeps at `time` have foreseen of the drag of gas particle `j`, which comes now and is expected no more.
    pub fn has_come(&mut self, j: usize, time: f64) -> Vec3 {
        if self.rates.drag_dv.is_empty() {
            return Vec3::zeros();
        }
        let seen = self.rates.drag_dv[j] * self.leaning(j, time);
        self.rates.drag_half[j] = 0.0;
        seen
    }

    /// Shows the sweeps at `time` the gas as if drag had acted evenly; its heat, too, unless the gas is bound to a temperature, which is then
    /// the sweeps' to set.
    pub fn lean(&mut self, time: f64, bound: bool) {
        if self.rates.drag_dv.is_empty() {
            return;
        }
        let (mut v, mut u) = std::mem::take(&mut self.upright);
        v.clone_from(&self.rates.v_pred);
        u.clear();
        if !bound {
            u.extend_from_slice(&self.rates.u_pred);
        }
        for j in 0..v.len() {
            let part = self.leaning(j, time);
            let r = &mut self.rates;
            r.v_pred[j] += part * r.drag_dv[j];
            if let Some(&u) = u.get(j) {
                // Heat that is still to come is none that could be missing: of what there is, half may be.
                r.u_pred[j] = (u + part * r.drag_du[j]).max(0.5 * u);
            }
        }
        self.upright = (v, u);
    }

    /// Ends what [`Gas::lean`] began.
    pub fn stand_upright(&mut self) {
        if self.rates.drag_dv.is_empty() {
            return;
        }
        std::mem::swap(&mut self.rates.v_pred, &mut self.upright.0);
        if !self.upright.1.is_empty() {
            std::mem::swap(&mut self.rates.u_pred, &mut self.upright.1);
        }
    }
}

#[cfg(test)]
mod tests {
    use nbody::points::Columns;

    use super::*;
    use crate::Particles;

    #[test]
    fn gas_leans_back_while_drag_begins_and_forward_when_it_ends() {
        let mut particles = Particles::default();
        particles.resize(2);
        let mut gas = Gas::new(particles);
        gas.rates.u_pred.fill(1.0);
        gas.expect_drag();
        let coming = Coming {
            dv: Vec3::x(),
            du: 0.5,
            half: 0.25,
        };
        gas.expect_impulse(0, 3.0, coming);
        for (time, seen) in [(3.0, -1.0), (3.25, 0.0), (3.5, 1.0), (3.6, 0.0)] {
            gas.lean(time, false);
            assert_eq!(
                gas.rates.v_pred,
                [seen * Vec3::x(), Vec3::zeros()],
                "{time}"
            );
            assert_eq!(gas.rates.u_pred, [1.0 + 0.5 * seen, 1.0]);
            gas.stand_upright();
            assert_eq!(gas.rates.v_pred, [Vec3::zeros(); 2]);
        }
        gas.expect_impulse(0, 3.0, coming);
        gas.lean(3.5, false);
        assert_eq!(gas.rates.v_pred[0], 2.0 * Vec3::x());
    }
    #[test]
    fn what_sweeps_make_of_a_bound_temperature_stays() {
        let mut particles = Particles::default();
        particles.resize(1);
        let mut gas = Gas::new(particles);
        gas.rates.u_pred.fill(1.0);
        gas.expect_drag();
        let (dv, du) = (Vec3::x(), 0.5);
        gas.expect_impulse(0, 3.0, Coming { dv, du, half: 0.25 });
        gas.lean(3.5, true);
        assert_eq!(gas.rates.v_pred, [dv]);
        assert_eq!(gas.rates.u_pred, [1.0]);
        gas.rates.u_pred[0] = 0.7;
        gas.stand_upright();
        assert_eq!(gas.rates.v_pred, [Vec3::zeros()]);
        assert_eq!(gas.rates.u_pred, [0.7]);
    }
}
