//! Gas and dust of a scene as text.

use gas::BackgroundPressure;
use gas::rearrangement::Order;

use super::growth::write_growth;
use super::text::Text;
use crate::read::gas::{
    FORMULATIONS, GRADIENTS, KERNELS, RECONSTRUCTIONS, name_of, viscosity_name,
};
use crate::scene::{
    Block, Cooling, CoolingTime, Disk, DiskAmount, Dust, DustAmount, DustDrag, Eos, Formulation,
    Gas, Hydro, Lattice, Physical, Precision, Sizes, Thermal, Turbulence,
};

pub fn write_gas(text: &mut Text, gas: &Gas) {
    text.table("gas");
    if gas.particles > 0 {
        text.raw("particles", gas.particles);
    }
    text.softening(gas.softening);
    write_eos(text, gas);
    if let Some(disk) = &gas.disk {
        write_disk(text, disk, &gas.eos);
    }
    for entry in &gas.blocks {
        text.entry("gas.block");
        write_block(text, &entry.block);
        match entry.thermal {
            Thermal::Pressure(pressure) => text.number("pressure", pressure),
            Thermal::InternalEnergy(energy) => text.number("internal_energy", energy),
            Thermal::Eos => {}
        }
    }
    write_cooling(text, &gas.cooling);
    if let Some(edge) = &gas.edge {
        text.table("gas.edge");
        for (keys, zone) in [
            (["inner_radius", "inner_end"], edge.inner),
            (["outer_radius", "outer_end"], edge.outer),
        ] {
            if let Some(zone) = zone {
                text.number(keys[0], zone.begin);
                text.number(keys[1], zone.whole);
            }
        }
        text.number("time", edge.time);
        text.text("inner", if edge.supported { "supported" } else { "open" });
    }
    write_hydro(text, &gas.hydro);
    text.table("gas.viscosity");
    text.text("kind", viscosity_name(&gas.viscosity));
    if let Some([alpha, beta]) = gas.viscosity.parameters() {
        text.number("alpha", alpha);
        text.number("beta", beta);
        let reconstruction = name_of(&RECONSTRUCTIONS, gas.reconstruction);
        text.text("reconstruction", reconstruction);
    }
    match gas.physical {
        Physical::None => {}
        Physical::Constant { nu } => text.number("kinematic", nu),
        Physical::ShakuraSunyaev { alpha, .. } => text.number("shakura_sunyaev", alpha),
    }
    text.table("gas.conduction");
    text.number("alpha", gas.conduction);
    text.table("gas.rearrange");
    write_rearrangement(text, gas.rearrange);
}

fn write_rearrangement(text: &mut Text, order: Option<Order>) {
    match order {
        None => text.number("strength", 0.0),
        Some(Order::Repulsion { strength }) => text.number("strength", strength),
        Some(Order::Continuity(law)) => {
            text.text("kind", "continuity");
            text.number("tolerance", law.tolerance);
            text.raw("iterations", law.iterations);
        }
    }
}

fn write_eos(text: &mut Text, gas: &Gas) {
    text.table("gas.eos");
    text.text("kind", gas.eos.name());
    match &gas.eos {
        Eos::Ideal { gamma } => text.number("gamma", *gamma),
        Eos::Isothermal { sound_speed } => text.number("sound_speed", *sound_speed),
        Eos::LocallyIsothermal {
            aspect_ratio,
            exponent,
            reference_radius,
            ..
        } => {
            text.number("aspect_ratio", *aspect_ratio);
            text.number("exponent", *exponent);
            text.number("reference_radius", *reference_radius);
        }
        Eos::Barotropic(law) => {
            text.number("sound_speed", law.sound_speed);
            text.number("critical_density", law.critical_density);
            text.number("gamma", law.gamma);
        }
        Eos::Stiffened(law) => {
            text.number("gamma", law.gamma);
            text.number("stiffening_pressure", law.pressure);
        }
        Eos::Tillotson { material } => text.text("material", material),
        Eos::Tabulated { file, .. } => text.text("file", &file.to_string_lossy()),
    }
    if let Some(weight) = gas.mean_molecular_weight {
        text.number("mean_molecular_weight", weight);
    }
}

fn write_cooling(text: &mut Text, cooling: &Cooling) {
    text.table("gas.cooling");
    let towards = match cooling {
        Cooling::None => {
            text.text("kind", "none");
            None
        }
        Cooling::Beta { beta, floor } => {
            text.text("kind", "beta");
            text.number("beta", *beta);
            floor.as_ref()
        }
        Cooling::Relaxation { time, towards } => {
            text.text("kind", "relaxation");
            match time {
                CoolingTime::Orbital(beta) => text.number("beta", *beta),
                CoolingTime::Time(time) => text.number("time", *time),
            }
            Some(towards)
        }
    };
    if let Some(towards) = towards {
        text.number("aspect_ratio", towards.aspect_ratio);
        text.number("exponent", towards.exponent);
        text.number("reference_radius", towards.reference_radius);
    }
}

fn write_disk(text: &mut Text, disk: &Disk, eos: &Eos) {
    text.table("gas.disk");
    match disk.amount {
        DiskAmount::SurfaceDensity(sigma) => text.number("surface_density", sigma),
        DiskAmount::Mass(mass) => text.number("mass", mass),
    }
    text.number("slope", disk.slope);
    text.number("reference_radius", disk.reference_radius);
    if matches!(eos, Eos::Ideal { .. }) {
        text.number("aspect_ratio", disk.aspect_ratio);
        text.number("exponent", disk.exponent);
    }
    text.number("inner_radius", disk.inner_radius);
    text.number("outer_radius", disk.outer_radius);
    text.number("taper", disk.taper);
}

fn write_block(text: &mut Text, block: &Block) {
    text.vector("lo", block.lo);
    text.vector("hi", block.hi);
    text.number("spacing", block.spacing);
    text.text(
        "lattice",
        match block.lattice {
            Lattice::Cubic => "cubic",
            Lattice::Bcc => "bcc",
            Lattice::Random => "random",
            Lattice::Glass => "glass",
        },
    );
    text.number("density", block.density);
    text.vector("velocity", block.velocity);
}

fn write_hydro(text: &mut Text, hydro: &Hydro) {
    text.table("gas.hydro");
    text.text("formulation", name_of(&FORMULATIONS, hydro.formulation));
    if hydro.formulation == Formulation::Pressure {
        text.number("pressure_exponent", hydro.exponent);
    }
    text.raw("grad_h", hydro.grad_h);
    text.text("gradient", name_of(&GRADIENTS, hydro.gradient));
    text.text("kernel", name_of(&KERNELS, hydro.kernel));
    text.number("neighbours", hydro.neighbours);
    text.number("courant", hydro.courant);
    text.number("tolerance", hydro.tolerance);
    match hydro.background_pressure {
        BackgroundPressure::NONE => {}
        BackgroundPressure::Fixed(p) => text.number("background_pressure", p),
        BackgroundPressure::Least => text.text("background_pressure", "least"),
    }
    text.text(
        "precision",
        match hydro.precision {
            Precision::Single => "single",
            Precision::Double => "double",
        },
    );
}

pub fn write_dust(text: &mut Text, dust: &Dust) {
    text.table("dust");
    if dust.particles > 0 {
        text.raw("particles", dust.particles);
        text.number("scale_height", dust.scale_height);
        text.number("inner_radius", dust.inner_radius);
        text.number("outer_radius", dust.outer_radius);
    }
    text.softening(dust.softening);
    match dust.amount {
        Some(DustAmount::DustToGas(ratio)) => text.number("dust_to_gas", ratio),
        Some(DustAmount::Mass(mass)) => text.number("mass", mass),
        None => {}
    }
    match dust.sizes {
        Some(Sizes::One(radius)) => text.number("size", radius),
        Some(Sizes::Range { min, max, slope }) => text.raw(
            "size",
            format_args!("{{ min = {min:?}, max = {max:?}, slope = {slope:?} }}"),
        ),
        None => {}
    }
    if dust.composition.is_none() {
        text.number("material_density", dust.material_density);
    }
    for entry in &dust.blocks {
        text.entry("dust.block");
        write_block(text, &entry.block);
        let stopping = match dust.drag {
            DustDrag::ConstantStokesNumber(_) => "stokes_number",
            _ => "stopping_time",
        };
        for (key, own) in [
            ("size", entry.size),
            ("material_density", entry.material_density),
            (stopping, entry.stopping),
        ] {
            if let Some(own) = own {
                text.number(key, own);
            }
        }
    }
    if let Some(composition) = &dust.composition {
        let [ice, silicate, iron] = composition.fractions;
        text.table("dust.composition");
        text.number("ice", ice);
        text.number("silicate", silicate);
        text.number("iron", iron);
        text.raw("sublimation", composition.sublimation);
    }
    match dust.turbulence {
        Turbulence::None => {}
        Turbulence::Given(alpha) => {
            text.table("dust.turbulence");
            text.number("alpha", alpha);
        }
        Turbulence::Measured { floor } => {
            text.table("dust.turbulence");
            text.text("alpha", "measured");
            text.number("floor", floor);
        }
    }
    text.table("dust.drag");
    text.text("law", crate::read::dust::name(dust.drag));
    match dust.drag {
        DustDrag::ConstantStoppingTime(time) => text.number("stopping_time", time),
        DustDrag::ConstantStokesNumber(stokes) => text.number("stokes_number", stokes),
        DustDrag::Quadratic(coefficient) => text.number("coefficient", coefficient),
        _ => {}
    }
    if let Some(growth) = &dust.growth {
        write_growth(text, growth);
    }
}
