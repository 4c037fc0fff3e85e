//! Row: one immersed particle in an exchange: the gas around it, and what it does.

use gas::probe::Shape;
use nbody::points::Vec3;

use super::relaxation::Relaxation;
use super::{Ambient, Booking, Half, Immersed, StoppingLaw};

/// An immersed particle: the gas around it, and its exchange.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    /// which particle it is, and its place in the block's list
    pub i: u32,
    pub place: u32,
    pub h: f64,
    pub rho: f64,
    pub c: f64,
    /// time in which sound and particle cross h
    pub crossing: f64,
    pub shape: Shape,
    pub gain: f64,
    pub eps: f64,
    pub m: f64,
    pub t_stop: f64,
    /// change of its velocity
    pub dv: Vec3,
    /// change and heat to be expected of the other half, if this one opens a step
    pub coming: Vec3,
    pub coming_heat: f64,
    /// its change per velocity that the gas is found to have gained beyond -eps dv
    pub share: f64,
    /// velocity relative to the gas: at this tick, and in the middle of the half step's kick
    pub u_tick: Vec3,
    pub u_middle: Vec3,
    /// velocity of the gas at this tick
    pub v_gas: Vec3,
    pub x: Vec3,
}

impl Row {
    /// The change over the half step at relative acceleration `a`, as if the gas changed by -eps times that.
    pub fn relax<I: Immersed>(
        &mut self,
        law: &StoppingLaw,
        immersed: &I,
        i: usize,
        (step, half): (f64, Half),
        a: Vec3,
    ) {
        let kick = a * step;
        let (start, sign) = match half {
            Half::Closing => (self.u_tick - kick, -0.5),
            Half::Opening => (self.u_tick, 0.5),
        };
        self.u_middle = self.u_tick + sign * kick;
        let (sphere, law) = (immersed.sphere(i), immersed.law(i, *law));
        let ambient = Ambient {
            rho: self.rho,
            c: self.c,
            omega: immersed.omega(i),
        };
        let load = 1.0 + self.eps;
        let depth = |speed: f64| law.e_foldings(&sphere, &ambient, speed, load * step);
        let mut relaxation = Relaxation::of(depth(start.norm()));
        if !law.is_linear() && kick != Vec3::zeros() {
            // Half of what the kick leaves at the end stands for its effect on the stopping time.
            let middle = start + 0.5 * (1.0 - relaxation.lag) * kick;
            relaxation = Relaxation::of(depth(middle.norm()));
        }
        let change = relaxation.change(start, kick);
        self.dv = change / load;
        self.share = relaxation.lag / load;
        if half == Half::Opening {
            // The other half goes on from here, by the same kick.
            let next = start + kick + change;
            if !law.is_linear() {
                relaxation = Relaxation::of(depth(next.norm()));
            }
            self.coming = relaxation.change(next, kick) / load;
            self.coming_heat = -self.m * self.coming.dot(&(next + 0.5 * (kick + self.coming)));
        }
        self.t_stop = law.stopping_time(&sphere, &ambient, self.u_tick.norm());
    }

    /// Gives particle `i` its change of velocity.
    pub fn push<I: Immersed>(&self, immersed: &mut I, i: usize, booking: &mut Booking) {
        let v = immersed.velocity(i);
        booking.immersed.add((self.x, v), self.m, self.dv);
        booking.kick += self.m * self.dv.dot(&(self.u_tick - self.u_middle));
        immersed.push(i, self.dv, self.t_stop, self.rho);
        // The gas around has changed by -eps dv.
        immersed.hear(i, self.c, self.u_tick + (1.0 + self.eps) * self.dv);
    }

    /// Books what a gas that feels no reaction would have got.
    pub fn give_away(&self, booking: &mut Booking) {
        booking.gas.momentum -= self.m * self.dv;
        booking.gas.angular_momentum -= self.m * self.x.cross(&self.dv);
        booking.gas.kinetic -= self.m * self.dv.dot(&self.v_gas);
        booking.radiated += self.heat();
    }

    /// Heat of the row's change in gas of fixed velocity.
    pub fn heat(&self) -> f64 {
        -self.m * self.dv.dot(&(self.u_middle + 0.5 * self.dv))
    }
}
