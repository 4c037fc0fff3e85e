//! The state of the map as plain numbers, so that a restart goes on bit for bit.

use super::{Jacobi, Scheme, State};
use crate::bodies::Bodies;
use crate::integrators::wisdom_holman::chain::{Chain, zeros};
use crate::points::Vec3;

/// Numbers of a checkpoint before those of the bodies.
const HEAD: usize = 9;
/// Numbers of a checkpoint a body.
const BODY: usize = 13;

impl Jacobi {
    /// The whole state in plain numbers; masses, softening and scheme apart.
    pub fn state(&self) -> Vec<f64> {
        let (x, v, t) = self.centre;
        let n = self.chain.order.len();
        let mut state = Vec::with_capacity(HEAD + BODY * n);
        state.extend([n as f64, self.step]);
        state.extend(x.iter().chain(v.iter()).copied().chain([t]));
        let State {
            x,
            v,
            x_lost,
            v_lost,
        } = &self.state;
        for (k, &place) in self.chain.order.iter().enumerate() {
            state.push(place as f64);
            for columns in [x, v, x_lost, v_lost] {
                state.extend(columns.iter().map(|column| column[k]));
            }
        }
        state
    }

    /// The integrator whose [`Jacobi::state`] was `state`; none if the numbers are not such a state of these bodies.
    pub fn restored(
        scheme: Scheme,
        g: f64,
        star: &Bodies,
        bodies: &Bodies,
        state: &[f64],
    ) -> Option<Self> {
        let &[n, step, x, y, z, vx, vy, vz, t] = state.first_chunk::<HEAD>()?;
        let count = bodies.m.len();
        if state.len() != HEAD + BODY * count || n != count as f64 {
            return None;
        }
        let links = || state[HEAD..].chunks_exact(BODY);
        let order: Vec<usize> = links().map(|link| link[0] as usize).collect();
        let mut places = order.clone();
        places.sort_unstable();
        if !places.into_iter().eq(0..count) {
            return None;
        }
        let chain = Chain::new(g, star, bodies, order);
        let mut columns = [(); 4].map(|()| zeros(chain.padded()));
        columns[0][0].fill(1.0);
        for (k, link) in links().enumerate() {
            for (numbers, columns) in link[1..].chunks_exact(3).zip(&mut columns) {
                for (number, column) in numbers.iter().zip(columns) {
                    column[k] = *number;
                }
            }
        }
        let [x0, v0, x_lost, v_lost] = columns;
        let whole = State {
            x: x0,
            v: v0,
            x_lost,
            v_lost,
        };
        let centre = (Vec3::new(x, y, z), Vec3::new(vx, vy, vz), t);
        let restored = Self::with(scheme, chain, whole, centre);
        Some(Self { step, ..restored })
    }
}
