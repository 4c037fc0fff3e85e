//! The integrator's state as plain numbers, so that a restart goes on bit for bit.

use super::GaussRadau;
use super::series::LANES;
use crate::points::Vec3;

/// Numbers of a checkpoint before those of the bodies.
const HEAD: usize = 6;
/// Numbers of a checkpoint a component.
const COMPONENT: usize = 18;

impl GaussRadau {
    /// The whole state in plain numbers, for a checkpoint.
    pub fn state(&self) -> Vec<f64> {
        let head = [
            self.epsilon,
            self.time,
            self.time_lost,
            self.wanted,
            self.last,
        ];
        let mut state = vec![self.x.len() as f64];
        state.extend(head);
        for c in 0..self.x_lost.len() {
            let (i, axis) = (c / 3, c % 3);
            state.extend([
                self.x[i][axis],
                self.v[i][axis],
                self.x_lost[c],
                self.v_lost[c],
            ]);
            let (series, l) = (&self.series[c / LANES], c % LANES);
            state.extend(series.b_last.map(|b| b[l]));
            state.extend(series.e_last.map(|e| e[l]));
        }
        state
    }

    /// The integrator whose [`GaussRadau::state`] was `state`; none if the numbers are not such a state.
    pub fn restored(state: &[f64]) -> Option<Self> {
        let &[n, epsilon, time, time_lost, wanted, last] = state.first_chunk::<HEAD>()?;
        let components = (state.len() - HEAD) / COMPONENT;
        if HEAD + COMPONENT * components != state.len() || 3.0 * n != components as f64 {
            return None;
        }
        let zeros = vec![Vec3::zeros(); components / 3];
        let mut whole = Self {
            epsilon,
            time_lost,
            wanted,
            last,
            ..Self::new(time, &zeros, &zeros)
        };
        for (c, numbers) in state[HEAD..].chunks_exact(COMPONENT).enumerate() {
            let (i, axis) = (c / 3, c % 3);
            whole.x[i][axis] = numbers[0];
            whole.v[i][axis] = numbers[1];
            whole.x_lost[c] = numbers[2];
            whole.v_lost[c] = numbers[3];
            let (series, l) = (&mut whole.series[c / LANES], c % LANES);
            for k in 0..7 {
                series.b_last[k][l] = numbers[4 + k];
                series.e_last[k][l] = numbers[11 + k];
            }
        }
        Some(whole)
    }
}
