//! The switch of Cullen & Dehnen (2010): alpha rises at once where a flow begins to converge, and decays slowly behind.
//!
//! A = xi max(0, -d(div v)/dt),   alpha_loc = alpha_max H^2 A / (v_sig^2 + H^2 A)                                  (eqs. 13, 14)
//! alpha = alpha_loc where that is larger, else d(alpha)/dt = (alpha_loc - alpha) / tau, tau = H / (2 l v_sig), l = 0.05  (eq. 16)
//! xi = |2 (1 - R)^4 div v|^2 / (|2 (1 - R)^4 div v|^2 + tr S S^T)                                                (eqs. 17, 18)
//!
//! with V = grad v linear-exact, S its traceless symmetric part, and H the kernel's support. d(div v)/dt is the change over the
//! particle's own step, first order in it; before the first step there is none, and alpha stays what it is.

/// l: decay lengths by H.
const DECAY: f64 = 0.05;

/// What the flow around a particle does.
#[derive(Clone, Copy, Debug)]
pub struct Compression {
    /// div v now, and at the beginning of the step that has passed.
    pub div_v: f64,
    pub before: f64,
    /// Length of that step.
    pub dt: f64,
    /// tr S S^T
    pub shear2: f64,
    /// R
    pub order: f64,
    pub v_sig: f64,
    /// H
    pub reach: f64,
}

impl Compression {
    /// xi: one in pure compression, zero in shear.
    fn limiter(&self) -> f64 {
        let weight = (2.0 * (1.0 - self.order).powi(4) * self.div_v).powi(2);
        if weight > 0.0 {
            weight / (weight + self.shear2)
        } else {
            0.0
        }
    }

    /// alpha at the end of the step that began with `alpha`; at most `most`.
    pub fn alpha(&self, alpha: f64, most: f64) -> f64 {
        if self.dt <= 0.0 {
            return alpha;
        }
        let rate = (self.div_v - self.before) / self.dt;
        let source = self.limiter() * (-rate).max(0.0) * self.reach * self.reach;
        let local = if source > 0.0 {
            most * source / (self.v_sig * self.v_sig + source)
        } else {
            0.0
        };
        relaxed(alpha, local, decay(self.v_sig * self.dt / self.reach))
    }
}

/// What is left of alpha after `crossings` of H at the signal speed.
pub fn decay(crossings: f64) -> f64 {
    (-2.0 * DECAY * crossings).exp()
}

/// alpha that was `alpha`: at once `local` where that is more, else `decay` of the way from it is left.
pub fn relaxed(alpha: f64, local: f64, decay: f64) -> f64 {
    if alpha <= local {
        local
    } else {
        local + (alpha - local) * decay
    }
}

#[cfg(test)]
mod tests {
    use nbody::points::{Columns, Domain, Vec3};

    use super::*;
    use crate::samples::{hydro, lattice, still};
    use crate::{Gas, Viscosity, alone};

    const CONVERGING: Compression = Compression {
        div_v: -3.0,
        before: -1.0,
        dt: 0.1,
        shear2: 0.0,
        order: -1.0,
        v_sig: 2.0,
        reach: 0.5,
    };

    #[test]
    fn alpha_rises_at_once_and_decays_over_ten_crossings() {
        // A = 20: H^2 A = 5, alpha = 5 / 9.
        assert!((CONVERGING.alpha(0.0, 1.0) - 5.0 / 9.0).abs() < 1e-15);
        let passed = Compression {
            before: -3.0,
            ..CONVERGING
        };
        // 2 l v_sig dt / H = 0.04.
        assert!((passed.alpha(0.6, 1.0) - 0.6 * (-0.04f64).exp()).abs() < 1e-15);
        let expanding = Compression {
            before: -4.0,
            ..CONVERGING
        };
        assert_eq!(expanding.alpha(0.0, 1.0), 0.0);
    }

    #[test]
    fn shear_and_disorder_silence_the_switch() {
        let sheared = Compression {
            shear2: 1e8,
            ..CONVERGING
        };
        assert!(sheared.alpha(0.0, 1.0) < 1e-3);
        // Noise: as much diverges as converges; xi = 36 / (36 + 36).
        let noisy = Compression {
            order: 0.0,
            shear2: 36.0,
            ..CONVERGING
        };
        assert!((noisy.limiter() - 0.5).abs() < 1e-15);
        let first = Compression {
            dt: 0.0,
            ..CONVERGING
        };
        assert_eq!(first.alpha(0.3, 1.0), 0.3);
    }

    /// What is left of the velocity of a sound wave of amplitude 1 % after two periods, 32 particles a wavelength: the lattice holds as long.
    fn left(viscosity: Viscosity) -> f64 {
        let (n, wave, amplitude, gamma) = (32, std::f64::consts::TAU, 0.01, 5.0 / 3.0);
        let spacing = 1.0 / n as f64;
        let mut particles = still(lattice([n, 8, 8], spacing), spacing.powi(3), 0.0);
        for i in 0..particles.len() {
            let x = particles.x[i].x;
            let rise = amplitude * (wave * x).sin();
            particles.x[i].x += amplitude / wave * (wave * x).cos();
            // Sound speed one.
            particles.v[i].x = rise;
            particles.u[i] = (1.0 + rise).powf(gamma - 1.0) / (gamma * (gamma - 1.0));
        }
        let across = 8.0 * spacing;
        let mut hydro = hydro(Domain::periodic(Vec3::new(1.0, across, across)));
        hydro.viscosity = viscosity;
        let mut gas = Gas::new(particles);
        let mode = |gas: &Gas| {
            let p = &gas.particles;
            let part = |f: fn(f64) -> f64| -> f64 {
                p.x.iter().zip(&p.v).map(|(x, v)| v.x * f(wave * x.x)).sum()
            };
            part(f64::sin).hypot(part(f64::cos))
        };
        let before = mode(&gas);
        alone::advance(&mut gas, &hydro, 0.0, 2.0, 0.25).expect("a run");
        mode(&gas) / before
    }

    #[test]
    fn a_sound_wave_outlives_the_constant_viscosity_that_would_damp_it() {
        let (alpha, beta) = (1.0, 2.0);
        let switched = left(Viscosity::CullenDehnen { alpha, beta });
        let constant = left(Viscosity::Constant { alpha, beta });
        let without = left(Viscosity::None);
        println!("{switched} {constant} {without}");
        assert!(switched > 0.99 * without, "{switched} of {without}");
        // 0.80.
        assert!(constant < 0.85 * without, "{constant} of {without}");
    }
}
