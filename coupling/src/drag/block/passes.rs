//! Passes: what a block does in an exchange, between which the sums over the gas are formed.

use gas::Gas;
use gas::probe::Shape;
use nbody::points::{Domain, Vec3};

use super::{Block, Motion, SCRATCH, Scratch, empty, vector};
use crate::drag::row::{ABREAST, Drive, Outcome, Wind, relax};
use crate::drag::{ABSOLUTE, Booking, Half, Immersed, Parcel, Settings, StoppingLaw};

impl Block {
    /// Lets each row relax. `loads` are those of the touched gas, if they are new.
    pub fn relax<I: Immersed>(
        &mut self,
        gas: &Gas,
        (immersed, members): (&I, &[u32]),
        loads: Option<&[[f64; 1]]>,
        (steps, half): (&[f64], Half),
        (settings, domain): (&Settings, &Domain),
    ) {
        self.half = steps.iter().sum::<f64>() / steps.len() as f64;
        SCRATCH.with_borrow_mut(|scratch| {
            self.coming = std::mem::take(&mut scratch.coming);
            self.see(gas, loads, (settings, domain), scratch);
            let joint = settings.joint;
            scratch.motion.clear();
            // In the order of memory.
            scratch.motion.extend(members.iter().map(|&i| {
                let i = i as usize;
                let v = domain.relative(immersed.position(i), immersed.velocity(i));
                let a = immersed.acceleration(i).filter(|_| joint);
                Motion {
                    sphere: immersed.sphere(i),
                    v,
                    a: a.map(|a| a + turning(domain, v)),
                    excess: immersed.excess(i),
                }
            }));
            self.change(
                immersed,
                loads.is_some(),
                (steps, half),
                &settings.law,
                scratch,
            );
            if !settings.feedback {
                scratch.coming = std::mem::take(&mut self.coming);
            }
        });
    }

    /// Spreads what rows give over the slots, and forgets what they are to give.
    pub fn spread(&mut self, half: Half) {
        match half {
            Half::Closing => self.spread_impulse(),
            Half::Opening => self.spread_both(),
        }
        SCRATCH.with_borrow_mut(|scratch| scratch.coming = std::mem::take(&mut self.coming));
    }

    /// Velocity, acceleration and load of the gas around each row.
    fn see(
        &mut self,
        gas: &Gas,
        loads: Option<&[[f64; 1]]>,
        (settings, domain): (&Settings, &Domain),
        Scratch { field, seen, .. }: &mut Scratch,
    ) {
        field.clear();
        field.extend(self.gas.iter().zip(&self.place).map(|(&j, &place)| {
            let j = j as usize;
            // Relative to a shear, since neighbours may be images.
            let v = domain.relative(gas.particles.x[j], gas.rates.v_pred[j]);
            let a = if settings.joint {
                gas.acceleration(j) + turning(domain, v)
            } else {
                Vec3::zeros()
            };
            let load = loads.map_or(0.0, |loads| loads[place as usize][0]);
            [v.x, v.y, v.z, load, a.x, a.y, a.z, 0.0]
        }));
        empty(seen, self.rows.len(), [0.0; 8]);
        self.bundles.seen::<7, 8>(field, seen);
        self.loose.seen(field, seen);
    }

    /// Each row's change of velocity, as if all gas around it changed by -eps times that; `fresh` if eps is new.
    fn change<I: Immersed>(
        &mut self,
        immersed: &I,
        fresh: bool,
        (steps, half): (&[f64], Half),
        law: &StoppingLaw,
        Scratch { seen, motion, .. }: &mut Scratch,
    ) {
        empty(&mut self.coming, self.rows.len(), [0.0; 4]);
        let rows = self.rows.chunks_mut(ABREAST).zip(seen.chunks(ABREAST));
        for ((rows, seen), coming) in rows.zip(self.coming.chunks_mut(ABREAST)) {
            let mut drive = Drive {
                step: [0.0; ABREAST],
                a: [Vec3::zeros(); ABREAST],
                sphere: [motion[rows[0].place as usize].sphere; ABREAST],
            };
            for (lane, (row, seen)) in rows.iter_mut().zip(seen).enumerate() {
                let Motion {
                    sphere,
                    v,
                    a,
                    excess,
                } = motion[row.place as usize];
                row.u_tick = v - vector(seen, 0);
                if fresh {
                    row.eps = row.gain * seen[ABSOLUTE];
                }
                drive.step[lane] = steps[row.place as usize];
                drive.sphere[lane] = sphere;
                (row.excess, row.expected) = (excess, drive.step[lane] * excess);
                drive.a[lane] = a.map_or_else(Vec3::zeros, |a| a - vector(seen, 4));
            }
            relax((rows, coming), law, immersed, &drive, half);
        }
    }

    /// Spreads the reaction to each row's change, and its heat, over the slots.
    fn spread_impulse(&mut self) {
        empty(&mut self.partial, self.gas.len(), [0.0; 4]);
        let of = |row: usize| self.rows[row].given();
        self.bundles.spread(of, &mut self.partial);
        self.loose.spread(of, &mut self.partial);
    }

    /// Spreads these and what each row is to give in the other half of its step.
    fn spread_both(&mut self) {
        empty(&mut self.both, self.gas.len(), [0.0; 8]);
        let of = |row: usize| {
            let ([a, b, c, d], [e, f, g, h]) = (self.rows[row].given(), self.coming[row]);
            [a, b, c, d, e, f, g, h]
        };
        self.bundles.spread_both(of, &mut self.both);
        self.loose.spread_both(of, &mut self.both);
    }

    /// Makes up for what the gas did beyond -eps dv and what was expected, and spreads what each row then gives.
    pub fn refine(&mut self, touched: &[Parcel]) {
        SCRATCH.with_borrow_mut(|Scratch { sums, seen, .. }| {
            sums.clear();
            sums.extend(self.place.iter().map(|&place| touched[place as usize]));
            empty(seen, self.rows.len(), [0.0; 8]);
            self.bundles.seen::<3, 4>(sums, seen);
            self.loose.seen(sums, seen);
            for (row, seen) in self.rows.iter_mut().zip(&*seen) {
                row.gas_dv = vector(seen, 0);
                let more = row.gas_dv + row.eps * row.dv - row.expected;
                row.dv += row.share * more;
                row.excess += row.lasting * more;
            }
        });
        self.spread_impulse();
    }

    /// Books what the exchange did to the members, and notes it in their order; without feedback, what it would have done to the gas, too.
    pub fn settle<I: Immersed>(
        &mut self,
        (immersed, members): (&I, &[u32]),
        (settings, domain): (&Settings, &Domain),
    ) {
        let mut booking = Booking::default();
        self.heaviest = 0.0;
        SCRATCH.with_borrow_mut(
            |Scratch {
                 velocity, outcome, ..
             }| {
                outcome.resize(self.rows.len(), Outcome::default());
                velocity.clear();
                velocity.extend(members.iter().map(|&i| immersed.velocity(i as usize)));
                for row in &self.rows {
                    let v = velocity[row.place as usize];
                    row.book(v, &mut booking);
                    self.heaviest = self.heaviest.max(row.eps);
                    if !settings.feedback {
                        row.give_away(domain.relative(row.x, v), &mut booking);
                    }
                    booking.rigid += usize::from(row.shape == Shape::Rigid);
                    booking.plain += usize::from(row.shape == Shape::Plain);
                    booking.without_gas += usize::from(row.shape == Shape::Empty);
                    outcome[row.place as usize] = row.outcome();
                }
                // The block's own is far away in memory: written from end to end.
                self.outcome.clear();
                self.outcome.extend_from_slice(&outcome[..self.rows.len()]);
            },
        );
        self.wind.clear();
        if immersed.asks() {
            self.wind.resize(self.rows.len(), Wind::default());
            for row in &self.rows {
                self.wind[row.place as usize] = row.wind();
            }
        }
        self.booking = booking;
    }

    /// Gives the members their change of velocity.
    pub fn push<I: Immersed>(&self, immersed: &mut I, members: &[u32]) {
        for (&i, outcome) in members.iter().zip(&self.outcome) {
            outcome.push(immersed, i as usize);
        }
        for (&i, wind) in members.iter().zip(&self.wind) {
            wind.tell(immersed, i as usize);
        }
    }
}

/// What turns velocities relative to a shear.
fn turning(domain: &Domain, v: Vec3) -> Vec3 {
    domain
        .hill()
        .map_or_else(Vec3::zeros, |hill| hill.turning(v))
}
