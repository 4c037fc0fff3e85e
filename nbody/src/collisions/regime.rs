//! Regimes: what an impact of two gravity-dominated bodies comes to, by its speed, angle and masses.
//!
//! R_C1 = (3 M/4 pi rho_1)^(1/3);  Q* = c* (4/5) pi rho_1 G R_C1^2 ((gamma+1)^2/4 gamma)^(2/(3 mu)-1);  Q' = Q* (m/m_alpha)^(2-3 mu/2);
//! Q = m v^2/2M, m the reduced mass. Largest remnant: M (1 - Q/2Q') below 1.8 Q', 0.1 M (Q/1.8Q')^-1.5 above.
//! alpha = (3 r l^2 - l^3)/4r^3 is the part of the projectile that the target's path cuts. Grazing (sin theta >= R/(R+r)) and not
//! erosive: bodies merge in the end below v_hr, part above; v_hr = v_esc (2.43 G s - 0.0408 G + 1.86 s + 1.08), G = ((M_t-M_p)/M)^2,
//! s = (1 - sin theta)^2.5. Strength against tension is neglected: bodies larger than about a kilometre.
//! Source: Leinhardt & Stewart (2012), sections 2 to 4; v_hr: Genda, Kokubo & Ida (2012), equation 16.

use std::f64::consts::PI;

/// The material's resistance to disruption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Offset of the critical specific energy, c*: 1.9 for bodies with a fluid interior, 5 for small ones.
    pub offset: f64,
    /// Exponent of the coupling, mu: 0.36 or 0.37.
    pub coupling: f64,
    /// rho_1, 1 g/cm^3.
    pub density: f64,
}

/// The outcomes that are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Regime {
    Merging,
    GrazeAndMerge,
    HitAndRun,
    PartialAccretion,
    Erosion,
    SuperCatastrophic,
}

/// Two bodies that meet, the heavier first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    pub g: f64,
    pub m: [f64; 2],
    pub radius: [f64; 2],
    pub speed: f64,
    /// Sine of the angle between velocity and line of centres.
    pub sine: f64,
}

/// Specific energy of the impact by that which disperses half the mass.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Severity(f64);

impl Severity {
    /// Mass of the largest remnant by the total.
    fn remnant(self) -> f64 {
        if self.0 < SUPER {
            1.0 - 0.5 * self.0
        } else {
            0.1 * (self.0 / SUPER).powf(-1.5)
        }
    }
}

/// Beyond this times the energy of catastrophic disruption the largest remnant follows a power law.
const SUPER: f64 = 1.8;

/// What the scaling laws say of a meeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    pub regime: Regime,
    /// Mass of the largest remnant by the total.
    pub largest: f64,
}

impl Meeting {
    pub fn verdict(&self, strength: &Strength) -> Verdict {
        let total = self.m[0] + self.m[1];
        let severity = self.severity(strength);
        let regime = if self.speed <= self.interacting_escape() {
            Regime::Merging
        } else if severity.0 >= SUPER {
            Regime::SuperCatastrophic
        } else if severity.remnant() * total <= self.m[0] {
            Regime::Erosion
        } else if self.sine < self.radius[0] / (self.radius[0] + self.radius[1]) {
            Regime::PartialAccretion
        } else if self.speed < self.hit_and_run() {
            Regime::GrazeAndMerge
        } else {
            Regime::HitAndRun
        };
        let largest = match regime {
            Regime::Merging | Regime::GrazeAndMerge => 1.0,
            Regime::HitAndRun => self.m[0] / total,
            _ => severity.remnant(),
        };
        Verdict { regime, largest }
    }

    pub fn escape(&self) -> f64 {
        let reach = self.radius[0] + self.radius[1];
        (2.0 * self.g * (self.m[0] + self.m[1]) / reach).sqrt()
    }

    /// Length of the projectile that the target's path cuts.
    fn overlap(&self) -> f64 {
        let reach = self.radius[0] + self.radius[1];
        (reach * (1.0 - self.sine)).clamp(0.0, 2.0 * self.radius[1])
    }

    /// Part of the projectile's mass that the target's path cuts, alpha.
    fn interacting(&self) -> f64 {
        let (r, l) = (self.radius[1], self.overlap());
        if self.radius[0] >= r + self.sine * (self.radius[0] + r) {
            1.0
        } else {
            l * l * (3.0 * r - l) / (4.0 * r * r * r)
        }
    }

    /// Escape speed of the target with what interacts of the projectile, at the target's density.
    fn interacting_escape(&self) -> f64 {
        let mass = self.m[0] + self.interacting() * self.m[1];
        let radius = self.radius[0] * (mass / self.m[0]).cbrt();
        (2.0 * self.g * mass / radius).sqrt()
    }

    fn severity(&self, strength: &Strength) -> Severity {
        let [target, projectile] = self.m;
        let total = target + projectile;
        let reduced = target * projectile / total;
        let cut = self.interacting() * projectile;
        let reduced_cut = cut * target / (cut + target);
        let oblique = (reduced / reduced_cut).powf(2.0 - 1.5 * strength.coupling);
        let energy = 0.5 * reduced * self.speed * self.speed / total;
        Severity(energy / (strength.disruption(self.g, self.m) * oblique))
    }

    fn hit_and_run(&self) -> f64 {
        let total = self.m[0] + self.m[1];
        let gap = ((self.m[0] - self.m[1]) / total).powi(2);
        let s = (1.0 - self.sine).powf(2.5);
        self.escape() * (2.43 * gap * s - 0.0408 * gap + 1.86 * s + 1.08)
    }

    /// Mass that the projectile keeps in a hit-and-run, when what it meets of the target is taken as the projectile (section 4.2 there).
    pub fn projectile_remnant(&self, strength: &Strength) -> f64 {
        let ([big, small], l) = (self.radius, self.overlap());
        let phi = 2.0 * ((l - small) / small).acos();
        let area = small * small * (PI - 0.5 * (phi - phi.sin()));
        let length = 2.0 * (big * big - (big - 0.5 * l).powi(2)).sqrt();
        let density = self.m[0] / (4.0 / 3.0 * PI * big.powi(3));
        let (own, met) = (self.m[1], area * length * density);
        let total = own + met;
        let energy = 0.5 * own * met * self.speed * self.speed / (total * total);
        let severity = Severity(energy / strength.disruption(self.g, [own, met]));
        let remnant = severity.remnant() * total;
        // Without a cut, or without a size, nothing is met: the quotient above is no number.
        if remnant < own { remnant } else { own }
    }
}

impl Strength {
    /// Specific energy of a head-on impact that disperses half the mass.
    fn disruption(&self, g: f64, m: [f64; 2]) -> f64 {
        let total = m[0] + m[1];
        let radius2 = (3.0 * total / (4.0 * PI * self.density)).powf(2.0 / 3.0);
        let unequal = total * total / (4.0 * m[0] * m[1]);
        let equal = self.offset * 0.8 * PI * self.density * g * radius2;
        equal * unequal.powf(2.0 / (3.0 * self.coupling) - 1.0)
    }
}

#[cfg(test)]
mod tests;
