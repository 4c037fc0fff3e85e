//! Mixed: dust and bodies that exchange with the gas at once.

use dust::{Dust, Sphere, StoppingLaw};
use nbody::points::Vec3;

use super::immersed::{BodiesInGas, Grains, Immersed};

/// Dust and bodies in gas: bodies have the places after all dust.
pub struct Mixed<'a> {
    pub grains: Grains<'a>,
    pub bodies: BodiesInGas<'a>,
    /// That of the bodies.
    pub law: StoppingLaw,
}

impl<'a> Mixed<'a> {
    /// Dust, and bodies that have the law `law`, about the star of these.
    pub fn new(dust: &'a mut Dust, bodies: BodiesInGas<'a>, law: StoppingLaw) -> Self {
        let star = bodies.star;
        let grains = Grains { dust, star };
        Self {
            grains,
            bodies,
            law,
        }
    }

    /// What its own population says of a particle.
    fn own<T>(
        &self,
        i: usize,
        of_grain: impl Fn(&Grains<'a>, usize) -> T,
        of_body: impl Fn(&BodiesInGas<'a>, usize) -> T,
    ) -> T {
        match i.checked_sub(self.grains.dust.len()) {
            None => of_grain(&self.grains, i),
            Some(body) => of_body(&self.bodies, body),
        }
    }
}

impl Immersed for Mixed<'_> {
    fn position(&self, i: usize) -> Vec3 {
        self.own(i, Grains::position, BodiesInGas::position)
    }

    fn mass(&self, i: usize) -> f64 {
        self.own(i, Grains::mass, BodiesInGas::mass)
    }

    fn sphere(&self, i: usize) -> Sphere {
        self.own(i, Grains::sphere, BodiesInGas::sphere)
    }

    fn law(&self, i: usize, law: StoppingLaw) -> StoppingLaw {
        self.own(i, |grains, i| grains.law(i, law), |_, _| self.law)
    }

    fn omega(&self, i: usize) -> f64 {
        self.own(i, Grains::omega, BodiesInGas::omega)
    }

    fn bodies(&self) -> u32 {
        self.grains.dust.len() as u32
    }

    fn velocity(&self, i: usize) -> Vec3 {
        self.own(i, Grains::velocity, BodiesInGas::velocity)
    }

    fn acceleration(&self, i: usize) -> Option<Vec3> {
        self.own(i, Grains::acceleration, BodiesInGas::acceleration)
    }

    fn excess(&self, i: usize) -> Vec3 {
        self.own(i, Grains::excess, BodiesInGas::excess)
    }

    fn keep_excess(&mut self, i: usize, a: Vec3) {
        // Bodies expect nothing.
        self.grains.keep_excess(i, a);
    }

    fn smoothing(&self, i: usize) -> f64 {
        self.own(i, Grains::smoothing, BodiesInGas::smoothing)
    }

    fn keep_smoothing(&mut self, i: usize, h: f64, crossing: f64) {
        match i.checked_sub(self.grains.dust.len()) {
            None => self.grains.keep_smoothing(i, h, crossing),
            Some(body) => self.bodies.keep_smoothing(body, h, crossing),
        }
    }

    fn push(&mut self, i: usize, dv: Vec3, t_stop: f64, rho_gas: f64) {
        match i.checked_sub(self.grains.dust.len()) {
            None => self.grains.push(i, dv, t_stop, rho_gas),
            Some(body) => self.bodies.push(body, dv, t_stop, rho_gas),
        }
    }

    fn asks(&self) -> bool {
        self.grains.asks()
    }

    fn hear(&mut self, i: usize, c: f64, slip: Vec3) {
        // Bodies do not ask.
        self.grains.hear(i, c, slip);
    }
}
