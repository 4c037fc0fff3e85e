//! Tillotson's equation of state of rock, ice and metal, from cold solid to vapour; u is free.
//!
//! eta = rho / rho_0,   mu = eta - 1,   z = 1 / eta - 1,   w = u / (u_0 eta^2) + 1
//! condensed (rho >= rho_0 or u <= u_iv):  P_c = (a + b / w) rho u + A mu + B mu^2
//! expanded and hot (u >= u_cv):           P_e = a rho u + [b rho u / w + A mu exp(-beta z)] exp(-alpha z^2)
//! between:                                P = [(u - u_iv) P_e + (u_cv - u) P_c] / (u_cv - u_iv)
//! c_s^2 = P_rho + P P_u / rho^2 by the derivatives of each, but never below that of a hundredth of the bulk modulus A: in cold expanded
//! matter (eta below about a half) it would be imaginary, where a solid breaks. P may be negative: tension.
//! Limits: no melting, no strength; P is continuous, c_s is not where branches meet.
//! Source: Tillotson (1962), GA-3216; Melosh (1989), Impact Cratering, app. II; Benz & Asphaug (1999), Icarus 142, 5, table II.

/// A material's constants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tillotson {
    /// rho_0
    pub density: f64,
    /// u_0
    pub energy: f64,
    /// u_iv, at which vaporisation begins
    pub incipient: f64,
    /// u_cv, at which it is complete
    pub complete: f64,
    pub a: f64,
    pub b: f64,
    /// A
    pub bulk: f64,
    /// B
    pub hardening: f64,
    pub alpha: f64,
    pub beta: f64,
}

/// The least c_s^2, by A / rho_0.
const LEAST: f64 = 0.01;

/// A pressure and its derivatives.
#[derive(Clone, Copy)]
struct Surface {
    p: f64,
    by_rho: f64,
    by_u: f64,
}

/// Materials by name, in g/cm^3, erg/g and erg/cm^3.
pub const MATERIALS: [(&str, Tillotson); 4] = [
    ("basalt", BASALT),
    ("granite", GRANITE),
    ("ice", ICE),
    ("iron", IRON),
];

/// Benz & Asphaug (1999).
pub const BASALT: Tillotson = Tillotson {
    density: 2.7,
    energy: 4.87e12,
    incipient: 4.72e10,
    complete: 1.82e11,
    a: 0.5,
    b: 1.5,
    bulk: 2.67e11,
    hardening: 2.67e11,
    alpha: 5.0,
    beta: 5.0,
};

/// Benz, Cameron & Melosh (1989), Icarus 81, 113.
pub const GRANITE: Tillotson = Tillotson {
    density: 2.7,
    energy: 1.6e11,
    incipient: 3.5e10,
    complete: 1.8e11,
    a: 0.5,
    b: 1.3,
    bulk: 1.8e11,
    hardening: 1.8e11,
    alpha: 5.0,
    beta: 5.0,
};

/// Benz & Asphaug (1999).
pub const ICE: Tillotson = Tillotson {
    density: 0.917,
    energy: 1e11,
    incipient: 7.73e9,
    complete: 3.04e10,
    a: 0.3,
    b: 0.1,
    bulk: 9.47e10,
    hardening: 9.47e10,
    alpha: 10.0,
    beta: 5.0,
};

/// Benz, Cameron & Melosh (1989).
pub const IRON: Tillotson = Tillotson {
    density: 7.86,
    energy: 9.5e10,
    incipient: 1.42e10,
    complete: 8.45e10,
    a: 0.5,
    b: 1.5,
    bulk: 1.279e12,
    hardening: 1.05e12,
    alpha: 5.0,
    beta: 5.0,
};

impl Tillotson {
    /// The same material where `density` and `energy` are the units of density and of energy by mass.
    pub fn in_units(&self, density: f64, energy: f64) -> Self {
        Self {
            density: self.density / density,
            energy: self.energy / energy,
            incipient: self.incipient / energy,
            complete: self.complete / energy,
            bulk: self.bulk / (density * energy),
            hardening: self.hardening / (density * energy),
            ..*self
        }
    }

    /// w, and its logarithmic slope (w - 1) / w^2.
    #[inline]
    fn heat(&self, eta: f64, u: f64) -> [f64; 2] {
        let hot = u / (self.energy * eta * eta);
        let w = hot + 1.0;
        [w, hot / (w * w)]
    }

    #[inline]
    fn condensed(&self, rho: f64, u: f64) -> Surface {
        let eta = rho / self.density;
        let mu = eta - 1.0;
        let [w, slope] = self.heat(eta, u);
        let thermal = self.a + self.b / w;
        Surface {
            p: thermal * rho * u + (self.bulk + self.hardening * mu) * mu,
            by_rho: (thermal + 2.0 * self.b * slope) * u
                + (self.bulk + 2.0 * self.hardening * mu) / self.density,
            by_u: rho * (thermal - self.b * slope),
        }
    }

    #[inline]
    fn expanded(&self, rho: f64, u: f64) -> Surface {
        let eta = rho / self.density;
        let (mu, z) = (eta - 1.0, 1.0 / eta - 1.0);
        let [w, slope] = self.heat(eta, u);
        let fade = (-self.alpha * z * z).exp();
        let cold = self.bulk * (-self.beta * z).exp();
        // -dz/drho
        let thinning = (1.0 + z) / rho;
        let bound = self.b * rho * u / w + cold * mu;
        Surface {
            p: self.a * rho * u + bound * fade,
            by_rho: self.a * u
                + fade
                    * (self.b * u * (1.0 / w + 2.0 * slope)
                        + cold * (1.0 / self.density + mu * self.beta * thinning)
                        + bound * 2.0 * self.alpha * z * thinning),
            by_u: rho * (self.a + self.b * (1.0 / w - slope) * fade),
        }
    }

    #[inline]
    fn surface(&self, rho: f64, u: f64) -> Surface {
        if rho >= self.density || u <= self.incipient {
            return self.condensed(rho, u);
        }
        if u >= self.complete {
            return self.expanded(rho, u);
        }
        let width = self.complete - self.incipient;
        let part = (u - self.incipient) / width;
        let (solid, vapour) = (self.condensed(rho, u), self.expanded(rho, u));
        let mean = |solid: f64, vapour: f64| solid + part * (vapour - solid);
        Surface {
            p: mean(solid.p, vapour.p),
            by_rho: mean(solid.by_rho, vapour.by_rho),
            by_u: mean(solid.by_u, vapour.by_u) + (vapour.p - solid.p) / width,
        }
    }

    /// P(rho, u).
    #[inline]
    pub fn pressure(&self, rho: f64, u: f64) -> f64 {
        self.surface(rho, u).p
    }

    /// The square of the sound speed by the derivatives; negative where cold matter is torn.
    #[inline]
    pub fn square(&self, rho: f64, u: f64) -> f64 {
        let surface = self.surface(rho, u);
        surface.by_rho + surface.p / (rho * rho) * surface.by_u
    }

    /// c_s(rho, u), adiabatic.
    #[inline]
    pub fn sound_speed(&self, rho: f64, u: f64) -> f64 {
        let least = LEAST * self.bulk / self.density;
        self.square(rho, u).max(least).sqrt()
    }
}
