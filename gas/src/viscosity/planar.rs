//! Planar viscosity: only where gas is compressed along one axis, and along that axis alone.
//!
//! l_1 <= l_2 <= l_3: rates of strain,   xi = -l_1 / (|l_1| + |l_2| + |l_3|),   n: the axis of l_1,   l = min(0, l_1 + max(0, l_3)): what no shear makes up for
//! gate:   w = s^2 (3 - 2 s), s = (xi - 0.55) / 0.2 between 0 and 1;   strength:  e = h |l| / c_s
//! alpha:  at once to  alpha_max w e^2 / (e^2 + 0.15^2)  where that is more, else down to it as exp(-0.1 v_sig t / H) (Cullen & Dehnen 2010)
//! stress: q(l) n n as in [`stress`](super::stress); beta keeps its ratio to alpha. As a switch, alpha is that of the pairs instead
//!
//! A shear of any strength has xi = 1/2 and no viscosity at all; a shock has l_1 alone and xi = 1, on whatever background; gas that falls
//! together from all sides has xi = 1/3 until it shocks. A sound wave, which has xi = 1, is damped by the square of its strain.
//! A stress that is smooth over a kernel leaves noise from particle to particle as it is: behind a shock gas rings longer than by pairs.
//! After a suggestion of Makino (2013, lecture slides), who named no numbers: the bounds are ours.

use nalgebra::Matrix3;

use super::stress::{Place, Strain};

/// xi at which viscosity begins, and how much more makes it whole.
const GATE: [f64; 2] = [0.55, 0.2];

/// Compression in a crossing of h from which gas counts as shocked.
const STRONG: f64 = 0.15;

/// The compression that a shear does not account for.
fn excess(strain: &Strain) -> f64 {
    (strain.rates[0] + strain.rates[2].max(0.0)).min(0.0)
}

/// alpha where it would stand if the gas went on as now, by the largest.
pub fn target(place: &Place, strain: &Strain) -> f64 {
    let open = ((strain.one_sidedness() - GATE[0]) / GATE[1]).clamp(0.0, 1.0);
    let strength = place.h * -excess(strain);
    let square = strength * strength;
    if open > 0.0 && square > 0.0 {
        open * open * (3.0 - 2.0 * open) * square / (square + (STRONG * place.cs).powi(2))
    } else {
        0.0
    }
}

/// The stress at viscosity `alpha`, of which beta is `ratio` times as much.
pub fn stress(place: &Place, strain: &Strain, alpha: f64, ratio: f64) -> Matrix3<f64> {
    let axis = strain.axes.column(0);
    place.pressure(excess(strain), alpha, alpha * ratio) * axis * axis.transpose()
}
