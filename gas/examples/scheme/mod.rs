//! A scheme from words: precision, formulation, viscosity, alpha of conduction, gradient, reconstruction.

use gas::{
    Conduction, Formulation, Gradient, Hydro, KernelKind, Precision, Reconstruction, Viscosity,
};

/// Changes `hydro` to what `words` say, in their order: double | single; density | pressure | number | smoothed; none | constant | balsara |
/// cullen-dehnen | neumann-richtmyer | tensor | planar | planar-switch with `alpha` and `beta`; a number; standard | matrix; none | linear. What is missing or unknown
/// stays.
pub fn set(hydro: &mut Hydro, words: &[String], alpha: f64, beta: f64) {
    let word = |k: usize| words.get(k).map_or("", String::as_str);
    match word(0) {
        "single" => hydro.precision = Precision::Single,
        "double" => hydro.precision = Precision::Double,
        _ => {}
    }
    hydro.formulation = match word(1) {
        "density" => Formulation::Density,
        "pressure" => Formulation::Pressure,
        "number" => Formulation::Number,
        "smoothed" => Formulation::Smoothed,
        _ => hydro.formulation,
    };
    hydro.viscosity = match word(2) {
        "none" => Viscosity::None,
        "balsara" => Viscosity::Balsara { alpha, beta },
        "cullen-dehnen" => Viscosity::CullenDehnen { alpha, beta },
        "neumann-richtmyer" => Viscosity::NeumannRichtmyer { alpha, beta },
        "tensor" => Viscosity::Tensor { alpha, beta },
        "planar-switch" => Viscosity::PlanarSwitch { alpha, beta },
        "planar" => Viscosity::Planar { alpha, beta },
        _ => Viscosity::Constant { alpha, beta },
    };
    if let Ok(alpha) = word(3).parse() {
        hydro.conduction = Conduction { alpha };
    }
    if word(4) == "matrix" {
        hydro.gradient = Gradient::Matrix;
    }
    if word(5) == "linear" {
        hydro.reconstruction = Reconstruction::Linear;
    }
}

/// The kernel of this name: cubic | quintic | c4 | c6; C2 of Wendland's by any other.
pub fn kernel(word: Option<&String>) -> KernelKind {
    match word.map_or("", String::as_str) {
        "cubic" => KernelKind::CubicSpline,
        "quintic" => KernelKind::QuinticSpline,
        "c4" => KernelKind::WendlandC4,
        "c6" => KernelKind::WendlandC6,
        _ => KernelKind::WendlandC2,
    }
}
