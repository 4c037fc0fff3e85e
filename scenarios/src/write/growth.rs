//! Growth of grains as text.

use super::text::Text;
use crate::read::growth::KERNELS;
use crate::scene::{Collisional, GrainMotion, Growth};

pub fn write_growth(text: &mut Text, growth: &Growth) {
    text.table("dust.growth");
    match growth {
        Growth::Exact { kernel, rate } => {
            let named = KERNELS.iter().find(|(_, known)| known == &Some(*kernel));
            text.text("kernel", named.expect("a name for each kernel").0);
            text.number("rate", *rate);
        }
        Growth::Physical(collisional) => {
            text.text("kernel", "physical");
            write_collisional(text, collisional);
        }
    }
}

fn write_collisional(text: &mut Text, growth: &Collisional) {
    text.raw("brownian", growth.brownian);
    text.number("alpha", growth.alpha);
    if let Some(reynolds) = growth.reynolds {
        text.number("reynolds", reynolds);
    }
    match growth.motion {
        GrainMotion::None => text.text("motion", "none"),
        GrainMotion::Resolved => text.text("motion", "resolved"),
        GrainMotion::Steady { headwind } => {
            text.text("motion", "steady");
            text.number("headwind", headwind);
        }
    }
    let (bounces, breaks) = (
        growth.bouncing_speed.is_finite(),
        growth.fragmentation_speed.is_finite(),
    );
    if bounces {
        text.number("bouncing_speed", growth.bouncing_speed);
    }
    if bounces || breaks {
        text.number("transition", growth.transition);
        text.text("speeds", if growth.spread { "maxwellian" } else { "mean" });
    }
    if breaks {
        text.number("fragmentation_speed", growth.fragmentation_speed);
        text.number("fragment_slope", growth.fragment_slope);
        text.number("erosion_ratio", growth.erosion_ratio);
        text.number("erosion", growth.erosion);
        if growth.transfer_ratio.is_finite() {
            text.number("transfer_ratio", growth.transfer_ratio);
            text.number("transfer", growth.transfer);
        }
    }
    if breaks || growth.rolling_energy.is_some() {
        text.number("monomer_radius", growth.monomer_radius);
    }
    text.raw("porosity", growth.rolling_energy.is_some());
    if let Some(energy) = growth.rolling_energy {
        text.number("rolling_energy", energy);
    }
}
