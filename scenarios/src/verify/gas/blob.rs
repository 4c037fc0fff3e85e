//! A cloud of ten times the density of a wind of Mach number 2.7 around it, gamma = 5/3, in units of its radius and the wind's density and sound speed.
//!
//! Box 10 x 10 x 40, cloud at (5, 5, 5); cloud gas: rho > 0.64 of its own at the start and T < 0.9 of the wind's, by the same at the start;
//! tau_KH = 1.6 tau_cr, tau_cr = 2 sqrt(10) / 2.7. Some 97 000 particles of equal mass, a thousand of them in the cloud: its surface is
//! a large part of it, and its bow shock is not resolved. The bands of grid codes at 1, 1.5 and 2 tau_KH are rough.
//! Source: Agertz et al. (2007), MNRAS 380, 963.

use gas::Particles;
use nbody::points::{Columns, Vec3};

use super::picture::{Window, maps};
use super::{Bar, End, Row, Scheme};

const CONTRAST: f64 = 10.0;
const WIND: f64 = 2.7;
const GAMMA: f64 = 5.0 / 3.0;
/// Cells of the wind across the box.
const CELLS: u32 = 23;
const BANDS: [[f64; 2]; 3] = [[0.55, 1.0], [0.2, 0.75], [0.03, 0.4]];

fn scene() -> String {
    let spacing = 10.0 / f64::from(CELLS) * 0.5f64.cbrt();
    let block = |lo: f64, hi: [f64; 3], rho: f64, v: f64| {
        format!(
            "[[gas.block]]\nlo = [{lo}, {lo}, {lo}]\nhi = [{}, {}, {}]\nlattice = \"bcc\"\nspacing = {}\ndensity = {rho}\n\
             pressure = {}\nvelocity = [0, 0, {v}]\n",
            hi[0],
            hi[1],
            hi[2],
            spacing / rho.cbrt(),
            1.0 / GAMMA
        )
    };
    format!(
        "[run]\nend_time = 10\n[units]\nsystem = \"dimensionless\"\n[domain]\nkind = \"periodic\"\nsize = [10, 10, 40]\n{}{}\
         [gas.eos]\ngamma = {GAMMA}\n",
        block(0.0, [10.0, 10.0, 40.0], 1.0, WIND),
        block(3.9, [6.1; 3], CONTRAST, 0.0)
    )
}

/// Cuts the cloud out of its block, and its room out of the wind.
fn start(gas: &mut Particles) {
    let keeps = |i: usize| {
        let is_cloud = gas.v[i].z == 0.0;
        is_cloud == ((gas.x[i] - Vec3::repeat(5.0)).norm() < 1.0)
    };
    let kept: Vec<bool> = (0..gas.x.len()).map(keeps).collect();
    gas.retain(&kept);
}

fn cloud(end: &End) -> f64 {
    let wind = 1.0 / (GAMMA * (GAMMA - 1.0));
    let is_cloud = |p: &&super::State| p.rho > 0.64 * CONTRAST && p.u < 0.9 * wind;
    end.gas.iter().filter(is_cloud).map(|p| p.m).sum()
}

pub fn of(scheme: &Scheme) -> Vec<Row> {
    let tau = 1.6 * 2.0 * CONTRAST.sqrt() / WIND;
    let times = [1.0, 1.5, 2.0, 2.5];
    let ends = scheme.run(&scene(), &times.map(|t| t * tau), start);
    let window = Window {
        lo: [0.0, 0.0],
        hi: [40.0, 10.0],
        axes: [2, 1],
    };
    let shown = [1, 2, 4].map(|k| (&ends[k], format!("log density, t / tau = {}", times[k - 1])));
    maps(scheme, "gas-blob", &shown, &window, |p| p.rho.log10());
    let whole = cloud(&ends[0]);
    let left = |k: usize| cloud(&ends[k + 1]) / whole;
    let mut rows: Vec<Row> = (0..3)
        .map(|k| {
            let [lo, hi] = BANDS[k];
            let what = format!(
                "cloud left at {} tau_KH (grid codes: {lo} to {hi})",
                times[k]
            );
            Row::new(what, left(k), Bar::None)
        })
        .collect();
    rows.push(Row::new(
        "cloud left at 2.5 tau_KH",
        left(3),
        Bar::Limit([0.12, 0.3]),
    ));
    rows.push(ends[4].energy_error());
    rows
}
