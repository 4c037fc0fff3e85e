//! A tabulated equation of state: P and c_s on a grid of densities and internal energies, bilinear in the logarithms of all four; u is free.
//!
//! ln P = sum of the four corners' ln P by their weights in ln rho and ln u; c_s likewise. Exact for power laws, hence for ideal gas; else
//! of second order in the grid's steps, and then P and c_s agree with each other to that order only.
//! Limit: outside the grid there is no state, and P and c_s are not numbers.

/// Values over a grid; all by their logarithms, those of a density one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rho: Vec<f64>,
    u: Vec<f64>,
    p: Vec<f64>,
    c: Vec<f64>,
}

/// Where a state lies between the grid's lines: the lower corner, and how far it is from it in parts of a step.
struct Cell {
    corner: usize,
    part: [f64; 2],
}

impl Default for Table {
    /// An ideal gas of gamma = 2 between densities and energies of 1 and 2.
    fn default() -> Self {
        let axis = [0.0, 2f64.ln()];
        Self {
            rho: axis.to_vec(),
            u: axis.to_vec(),
            p: vec![axis[0], axis[1], axis[1], 2.0 * axis[1]],
            c: vec![0.5 * axis[1], axis[1], 0.5 * axis[1], axis[1]],
        }
    }
}

impl Table {
    /// A table of pressures `p` and sound speeds `c` at all pairs of the densities `rho` and energies `u`; or what is wrong with it.
    pub fn new(rho: &[f64], u: &[f64], p: &[f64], c: &[f64]) -> Result<Self, String> {
        for (name, axis) in [("densities", rho), ("internal energies", u)] {
            if axis.len() < 2 {
                return Err(format!("has {} {name}; needed are two", axis.len()));
            }
            if axis.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(format!("has {name} that do not ascend"));
            }
        }
        for (name, values) in [("pressures", p), ("sound speeds", c)] {
            let wanted = rho.len() * u.len();
            if values.len() != wanted {
                return Err(format!(
                    "has {} {name} for {} densities and {} internal energies; needed are {wanted}",
                    values.len(),
                    rho.len(),
                    u.len()
                ));
            }
        }
        let logarithms = |name: &str, values: &[f64]| {
            let wrong = values.iter().find(|x| !(x.is_finite() && **x > 0.0));
            match wrong {
                Some(x) => Err(format!("has {x} among its {name}; all must be above 0")),
                None => Ok(values.iter().map(|x| x.ln()).collect::<Vec<_>>()),
            }
        };
        Ok(Self {
            rho: logarithms("densities", rho)?,
            u: logarithms("internal energies", u)?,
            p: logarithms("pressures", p)?,
            c: logarithms("sound speeds", c)?,
        })
    }

    /// The least and the largest density and internal energy.
    pub fn range(&self) -> [[f64; 2]; 2] {
        [&self.rho, &self.u].map(|axis| [axis[0].exp(), axis[axis.len() - 1].exp()])
    }

    #[inline]
    fn cell(&self, rho: f64, u: f64) -> Option<Cell> {
        let (i, along_rho) = place(&self.rho, rho.ln())?;
        let (j, along_u) = place(&self.u, u.ln())?;
        Some(Cell {
            corner: i * self.u.len() + j,
            part: [along_rho, along_u],
        })
    }

    #[inline]
    fn value(&self, of: &[f64], rho: f64, u: f64) -> f64 {
        let Some(Cell { corner, part }) = self.cell(rho, u) else {
            return f64::NAN;
        };
        let line = |at: usize| of[at] + part[1] * (of[at + 1] - of[at]);
        let (low, high) = (line(corner), line(corner + self.u.len()));
        (low + part[0] * (high - low)).exp()
    }

    /// P(rho, u).
    #[inline]
    pub fn pressure(&self, rho: f64, u: f64) -> f64 {
        self.value(&self.p, rho, u)
    }

    /// c_s(rho, u), adiabatic if the table is.
    #[inline]
    pub fn sound_speed(&self, rho: f64, u: f64) -> f64 {
        self.value(&self.c, rho, u)
    }
}

/// The line at or below `x` that has one above it, and how far `x` is between the two; none outside.
#[inline]
fn place(axis: &[f64], x: f64) -> Option<(usize, f64)> {
    let last = axis.len() - 1;
    if !(x >= axis[0] && x <= axis[last]) {
        return None;
    }
    let above = axis.partition_point(|line| *line <= x).min(last);
    let i = above - 1;
    Some((i, (x - axis[i]) / (axis[above] - axis[i])))
}
