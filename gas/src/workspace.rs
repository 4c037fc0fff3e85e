//! What sweeps keep between leaves and steps, in either precision.

use std::cell::RefCell;

use crate::density::Target;
use crate::lanes::Real;
use crate::neighbours::{Packed, Region};

/// Precision of sums over neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// f32: pair forces are exactly opposite all the same.
    Single,
    /// f64.
    Double,
}

/// Packed particles in either precision; one of both is empty.
#[derive(Clone, Debug, Default)]
pub struct Both {
    single: Packed<f32>,
    double: Packed<f64>,
}

/// Buffers of a thread.
#[derive(Debug, Default)]
pub struct Workspace<E> {
    pub region: Region<E>,
    pub pending: Vec<Target>,
}

/// Elements that sweeps work in.
pub trait Element: Real {
    fn packed(both: &mut Both) -> &mut Packed<Self>;
    fn with_workspace<T>(work: impl FnOnce(&mut Workspace<Self>) -> T) -> T;
}

macro_rules! element {
    ($element:ty, $field:ident) => {
        impl Element for $element {
            fn packed(both: &mut Both) -> &mut Packed<Self> {
                &mut both.$field
            }

            fn with_workspace<T>(work: impl FnOnce(&mut Workspace<Self>) -> T) -> T {
                thread_local! {
                    static SPACE: RefCell<Workspace<$element>> = RefCell::default();
                }
                SPACE.with_borrow_mut(work)
            }
        }
    };
}

element!(f32, single);
element!(f64, double);

#[cfg(test)]
mod tests;
