//! Coupling: the system of all populations, the operators that advance it, and the ledger of what they change.
//!
//! A step is a visible list of operators, composed symmetrically (Strang 1968); what a scene leaves out is not in the list.

pub mod accretion;
pub mod cooling;
pub mod drag;
pub mod drift;
pub mod edge;
pub mod external;
pub mod gravity;
pub mod growth;
pub mod kick;
pub mod ledger;
pub mod operator;
pub mod rearrange;
pub mod splitting;
pub mod stirring;
pub mod stress;
pub mod sublimation;
pub mod system;
pub mod torques;

pub use ledger::{Ledger, Totals};
pub use operator::{Meter, Operator, Phase, Unmetered};
pub use splitting::Splitting;
pub use system::{Pace, System};
