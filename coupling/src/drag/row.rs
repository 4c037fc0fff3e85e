//! Row: one immersed particle in an exchange: the gas around it, and what it does.

use dust::{Abreast, Sphere};
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, f64x8};
use gas::probe::Shape;
use nbody::points::Vec3;

use super::relaxation::{Relaxation, Vectors};
use super::{Ambient, Booking, Half, Immersed, Parcel, StoppingLaw};

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
    /// sum of |w|
    pub absolute: f64,
    pub eps: f64,
    pub m: f64,
    pub t_stop: f64,
    /// change of its velocity
    pub dv: Vec3,
    /// change of the velocity of the gas around
    pub gas_dv: Vec3,
    /// What the gas does beyond -eps dv: its acceleration as it is expected, the velocity that makes, and the change of dv and of what is expected per
    /// velocity that it is found to gain beyond that.
    pub excess: Vec3,
    pub expected: Vec3,
    pub share: f64,
    pub lasting: f64,
    /// velocity relative to the gas: at this tick, and in the middle of the half step's kick
    pub u_tick: Vec3,
    pub u_middle: Vec3,
    pub x: Vec3,
}

/// What a particle is told of its exchange.
#[derive(Clone, Copy, Debug, Default)]
pub struct Outcome {
    dv: Vec3,
    t_stop: f64,
    rho: f64,
}

/// What a particle that asks is told of the gas around: the sound speed, the velocity relative to it after the exchange, and what to expect of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wind {
    c: f64,
    slip: Vec3,
    /// acceleration of the gas beyond what the particle makes it do, as it is to be expected
    excess: Vec3,
}

impl Outcome {
    /// Gives particle `i` its change of velocity.
    pub fn push<I: Immersed>(&self, immersed: &mut I, i: usize) {
        immersed.push(i, self.dv, self.t_stop, self.rho);
    }
}

impl Wind {
    /// Tells particle `i`.
    pub fn tell<I: Immersed>(&self, immersed: &mut I, i: usize) {
        immersed.hear(i, self.c, self.slip);
        immersed.keep_excess(i, self.excess);
    }
}

/// Rows that are worked on at once.
pub const ABREAST: usize = 8;

/// What rows relax by: their half steps, their relative accelerations, and what they are.
pub struct Drive {
    pub step: [f64; ABREAST],
    pub a: [Vec3; ABREAST],
    pub sphere: [Sphere; ABREAST],
}

/// The changes of up to eight rows over their half steps, as if the gas changed by -eps times that. If they open a step, `coming` is what they
/// are to give in the other half: impulse and heat.
pub fn relax<I: Immersed>(
    (rows, coming): (&mut [Row], &mut [Parcel]),
    law: &StoppingLaw,
    immersed: &I,
    drive: &Drive,
    half: Half,
) {
    // Lanes to spare repeat the last row.
    let row = |lane: usize| &rows[lane.min(rows.len() - 1)];
    let particles: [usize; ABREAST] = std::array::from_fn(|lane| row(lane).i as usize);
    let abreast = Abreast::new(
        particles.map(|i| immersed.law(i, *law)),
        drive.sphere,
        std::array::from_fn(|lane| Ambient {
            rho: row(lane).rho,
            c: row(lane).c,
            omega: immersed.omega(particles[lane]),
        }),
    );
    nbody::widest!(Level::new(), simd => relax_lanes(simd, (rows, coming), &abreast, drive, half));
}

/// A vector of each row.
#[inline(always)]
fn vectors<S: Simd>(simd: S, of: impl Fn(usize) -> Vec3) -> Vectors<S> {
    let mut columns = [[0.0; ABREAST]; 3];
    let [x, y, z] = &mut columns;
    for (lane, ((x, y), z)) in x.iter_mut().zip(y).zip(z).enumerate() {
        let v = of(lane);
        (*x, *y, *z) = (v.x, v.y, v.z);
    }
    [
        f64x8::from_slice(simd, &columns[0]),
        f64x8::from_slice(simd, &columns[1]),
        f64x8::from_slice(simd, &columns[2]),
    ]
}

/// A number of each row.
#[inline(always)]
fn numbers<S: Simd>(simd: S, of: impl Fn(usize) -> f64) -> f64x8<S> {
    let mut column = [0.0; ABREAST];
    for (lane, number) in column.iter_mut().enumerate() {
        *number = of(lane);
    }
    f64x8::from_slice(simd, &column)
}

#[inline(always)]
fn array<S: Simd>(lanes: f64x8<S>) -> [f64; ABREAST] {
    let mut array = [0.0; ABREAST];
    lanes.store_slice(&mut array);
    array
}

/// a + factor b.
#[inline(always)]
fn sum<S: Simd>(a: &Vectors<S>, factor: f64x8<S>, b: &Vectors<S>) -> Vectors<S> {
    [
        factor.mul_add(b[0], a[0]),
        factor.mul_add(b[1], a[1]),
        factor.mul_add(b[2], a[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(a: &Vectors<S>, b: &Vectors<S>) -> f64x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn norm<S: Simd>(a: &Vectors<S>) -> f64x8<S> {
    dot(a, a).sqrt()
}

/// The relaxation from the velocities `u` over `dt`.
#[inline(always)]
fn relaxation<S: Simd>(simd: S, abreast: &Abreast, u: &Vectors<S>, dt: f64x8<S>) -> Relaxation<S> {
    Relaxation::of(simd, abreast.e_foldings(simd, norm(u), dt))
}

#[inline(always)]
fn relax_lanes<S: Simd>(
    simd: S,
    (rows, coming): (&mut [Row], &mut [Parcel]),
    abreast: &Abreast,
    drive: &Drive,
    half: Half,
) {
    let row = |lane: usize| &rows[lane.min(rows.len() - 1)];
    let one = f64x8::splat(simd, 1.0);
    let step = f64x8::from_slice(simd, &drive.step);
    let u = vectors(simd, |lane| row(lane).u_tick);
    let load = numbers(simd, |lane| 1.0 + row(lane).eps);
    let m = numbers(simd, |lane| row(lane).m);
    let a = vectors(simd, |lane| drive.a[lane]);
    let kick = [step * a[0], step * a[1], step * a[2]];
    let expected = vectors(simd, |lane| row(lane).expected);
    let forced = sum(&kick, -one, &expected);
    let (start, sign) = match half {
        Half::Closing => (sum(&u, -one, &kick), -0.5),
        Half::Opening => (u, 0.5),
    };
    let middle = sum(&u, one * sign, &kick);
    let linear = abreast.is_linear();
    let mut relaxed = relaxation(simd, abreast, &start, load * step);
    if !linear {
        // Half of what the kick leaves at the end stands for its effect on the stopping time.
        let left = (one - relaxed.lag) * 0.5;
        let halfway = sum(&start, left, &forced);
        relaxed = relaxation(simd, abreast, &halfway, load * step);
    }
    let each = one / load;
    let change = relaxed.change(&start, &forced);
    let dv = [change[0] * each, change[1] * each, change[2] * each];
    let share = array(relaxed.lag * each);
    // Drag that brakes decays, drag that balances forces lasts.
    let braking = sum(&change, one, &forced);
    let balancing = dot(&forced, &forced);
    let whole = (balancing + dot(&braking, &braking)).max(f64::MIN_POSITIVE);
    let lasting = array(balancing / whole / step.max(f64::MIN_POSITIVE));
    if half == Half::Opening {
        // The other half goes on from here, by the same kick.
        let next = sum(&sum(&start, one, &forced), one, &change);
        if !linear {
            relaxed = relaxation(simd, abreast, &next, load * step);
        }
        let change = relaxed.change(&next, &forced);
        let dv = [change[0] * each, change[1] * each, change[2] * each];
        let mean = sum(&next, one * 0.5, &sum(&kick, one, &dv));
        let heat = array(-(m * dot(&dv, &mean)));
        let [x, y, z] = columns(&[-(m * dv[0]), -(m * dv[1]), -(m * dv[2])]);
        for (lane, coming) in coming.iter_mut().enumerate() {
            *coming = [x[lane], y[lane], z[lane], heat[lane]];
        }
    }
    let t_stop = array(abreast.stopping_time(simd, norm(&u)));
    let (dv, middle) = (columns(&dv), columns(&middle));
    for (lane, row) in rows.iter_mut().enumerate() {
        let vector = |of: &[[f64; ABREAST]; 3]| Vec3::new(of[0][lane], of[1][lane], of[2][lane]);
        (row.dv, row.share, row.t_stop) = (vector(&dv), share[lane], t_stop[lane]);
        row.u_middle = vector(&middle);
        (row.lasting, row.gas_dv) = (lasting[lane], Vec3::zeros());
    }
}

#[inline(always)]
fn columns<S: Simd>(vectors: &Vectors<S>) -> [[f64; ABREAST]; 3] {
    [array(vectors[0]), array(vectors[1]), array(vectors[2])]
}

impl Row {
    /// Takes the velocity relative to the gas, and the square of the sound speed summed by |w|.
    pub fn hear(&mut self, u: Vec3, square: f64) {
        (self.c, self.crossing) = match self.shape {
            Shape::Empty => (0.0, f64::INFINITY),
            _ => {
                let c = (square / self.absolute).sqrt();
                (c, self.h / (c + u.norm()))
            }
        };
    }

    /// What it starts its half step with, by the gas around: its velocity, and what its kick makes of that.
    pub fn start(&self, half: Half) -> (Vec3, Vec3) {
        let kick = 2.0 * (self.u_middle - self.u_tick);
        match half {
            Half::Closing => (self.u_tick + kick, -kick),
            Half::Opening => (self.u_tick, kick),
        }
    }

    /// How much of a response to its surroundings over the half step `step` there is in the next: what balances forces lasts, what brakes decays.
    pub fn kept(&self, step: f64) -> f64 {
        let lasting = self.lasting * step;
        lasting + (1.0 - lasting) * (1.0 - self.share * (1.0 + self.eps))
    }

    /// Books the change of a particle of the velocity `v`.
    pub fn book(&self, v: Vec3, booking: &mut Booking) {
        booking.immersed.add((self.x, v), self.m, self.dv);
        booking.kick += self.m * self.dv.dot(&(self.u_tick - self.u_middle));
    }

    /// What the particle is to know of its exchange.
    pub fn outcome(&self) -> Outcome {
        Outcome {
            dv: self.dv,
            t_stop: self.t_stop,
            rho: self.rho,
        }
    }

    /// What it is to know of the gas around.
    pub fn wind(&self) -> Wind {
        Wind {
            c: self.c,
            // The gas around has changed by -eps dv.
            slip: self.u_tick + (1.0 + self.eps) * self.dv,
            excess: self.excess,
        }
    }

    /// What the row gives to the gas: the reaction to its change, and its heat.
    pub fn given(&self) -> Parcel {
        let p = -self.m * self.dv;
        [p.x, p.y, p.z, self.heat()]
    }

    /// Books what a gas that feels no reaction would have got from a row that had the velocity `v`.
    pub fn give_away(&self, v: Vec3, booking: &mut Booking) {
        booking.gas.momentum -= self.m * self.dv;
        booking.gas.angular_momentum -= self.m * self.x.cross(&self.dv);
        booking.gas.kinetic -= self.m * self.dv.dot(&(v - self.u_tick));
        booking.radiated += self.heat();
    }

    /// Heat of the row's change in gas that changes by `gas_dv`.
    pub fn heat(&self) -> f64 {
        let slip = self.u_middle + 0.5 * (self.dv - self.gas_dv);
        -self.m * self.dv.dot(&slip)
    }
}
