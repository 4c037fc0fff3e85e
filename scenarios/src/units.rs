//! Units: what a code unit is in cgs, and quantities like `"5.2 au"` or `"1700 g/cm^2"` brought to code units.
//!
//! Astronomical: au, solar mass, G = 1 exactly, so that the time unit is sqrt(au^3/GM) = yr/2pi and `yr` is the period at 1 au about
//! one solar mass (365.2569 d, 2e-5 longer than the Julian year) in every system. Sources: IAU 2012 B2 (au), IAU 2015 B3 (GM of Sun,
//! Earth, Jupiter; radii), CODATA 2018 (G).

use std::f64::consts::{PI, TAU};
use std::fmt;

use nbody::points::Dimension;

/// Gravitational constant, cgs.
pub const G_CGS: f64 = 6.6743e-8;
/// GM of the Sun, cm^3/s^2.
const GM_SUN: f64 = 1.327_124_400_18e26;
const GM_EARTH: f64 = 3.986_004e20;
const GM_JUPITER: f64 = 1.266_865_3e23;
const AU: f64 = 1.495_978_707e13;

/// Systems of code units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum System {
    Astronomical,
    Dimensionless,
    Cgs,
}

impl System {
    /// The word that scenes and files know it by.
    pub fn name(self) -> &'static str {
        match self {
            Self::Astronomical => "astronomical",
            Self::Dimensionless => "dimensionless",
            Self::Cgs => "cgs",
        }
    }
}

/// Code units in cgs; all one for dimensionless scenes. The unit of temperature is the kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    pub system: System,
    /// cm
    pub length: f64,
    /// g
    pub mass: f64,
    /// s
    pub time: f64,
}

impl Units {
    pub fn new(system: System) -> Self {
        let (length, mass, time) = match system {
            System::Astronomical => (AU, GM_SUN / G_CGS, (AU * AU * AU / GM_SUN).sqrt()),
            System::Dimensionless | System::Cgs => (1.0, 1.0, 1.0),
        };
        Self {
            system,
            length,
            mass,
            time,
        }
    }

    /// G in code units, unless a dimensionless scene sets its own.
    pub fn gravitational_constant(&self) -> f64 {
        match self.system {
            System::Astronomical | System::Dimensionless => 1.0,
            System::Cgs => G_CGS,
        }
    }

    /// One code unit of a quantity in cgs.
    pub fn cgs(&self, dimension: Dimension) -> f64 {
        self.length.powi(dimension.length.into())
            * self.mass.powi(dimension.mass.into())
            * self.time.powi(dimension.time.into())
    }

    /// Name of the code unit of time, length or mass for people; empty for dimensionless scenes.
    pub fn symbol(&self, dimension: Dimension) -> &'static str {
        let astronomical = self.system == System::Astronomical;
        match dimension {
            _ if self.system == System::Dimensionless => "",
            Dimension::LENGTH if astronomical => "au",
            Dimension::MASS if astronomical => "Msun",
            Dimension::TIME if astronomical => "yr/2pi",
            Dimension::LENGTH => "cm",
            Dimension::MASS => "g",
            Dimension::TIME => "s",
            _ => "",
        }
    }

    /// The value of a quantity such as `"5.2 au"` in code units; what is wrong with it otherwise.
    pub fn value(&self, text: &str, wanted: Kind) -> Result<f64, String> {
        let (number, unit) = split(text)?;
        let (factor, found) = unit_product(unit)?;
        if found != wanted {
            return Err(format!("is {found}, where {wanted} is wanted"));
        }
        if wanted == Kind::ANGLE {
            return Ok(number * factor);
        }
        if self.system == System::Dimensionless && found != Kind::NUMBER {
            return Err("has a unit, but units.system = \"dimensionless\": give a plain number, or set units.system to \"astronomical\" or \"cgs\"".into());
        }
        Ok(number * (factor / self.cgs(found.dimension)))
    }

    /// A time in code units of `text`, a quantity or a plain number.
    pub fn time(&self, text: &str) -> Result<f64, String> {
        let time = match text.trim().parse() {
            Ok(number) => number,
            Err(_) => self.value(text, Kind::TIME)?,
        };
        if time.is_finite() {
            Ok(time)
        } else {
            Err("is not a finite number".into())
        }
    }
}

/// What a quantity measures: exponents of cgs units and of the angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    pub dimension: Dimension,
    pub angle: i8,
}

impl Kind {
    pub const NUMBER: Self = Self::of(Dimension::NONE);
    pub const LENGTH: Self = Self::of(Dimension::LENGTH);
    pub const MASS: Self = Self::of(Dimension::MASS);
    pub const TIME: Self = Self::of(Dimension::TIME);
    pub const VELOCITY: Self = Self::of(Dimension::VELOCITY);
    pub const DENSITY: Self = Self::of(Dimension::DENSITY);
    pub const SURFACE_DENSITY: Self = Self::of(Dimension::SURFACE_DENSITY);
    pub const PRESSURE: Self = Self::of(Dimension::PRESSURE);
    pub const PLANAR_PRESSURE: Self = Self::of(Dimension::new(0, 1, -2, 0));
    pub const SPECIFIC_ENERGY: Self = Self::of(Dimension::SPECIFIC_ENERGY);
    pub const KINEMATIC: Self = Self::of(Dimension::new(2, 0, -1, 0));
    pub const PER_LENGTH: Self = Self::of(Dimension::new(-1, 0, 0, 0));
    pub const ANGLE: Self = Self {
        dimension: Dimension::NONE,
        angle: 1,
    };

    pub const fn of(dimension: Dimension) -> Self {
        Self {
            dimension,
            angle: 0,
        }
    }

    /// A quantity of this kind, for messages.
    pub fn example(self) -> &'static str {
        match self {
            Kind::LENGTH => "\"5.2 au\"",
            Kind::MASS => "\"1 Mearth\"",
            Kind::TIME => "\"10 yr\"",
            Kind::VELOCITY => "\"10 m/s\"",
            Kind::DENSITY => "\"1 g/cm^3\"",
            Kind::SURFACE_DENSITY => "\"1700 g/cm^2\"",
            Kind::ANGLE => "\"30 deg\"",
            Kind::PRESSURE => "\"1 g/cm/s^2\"",
            Kind::SPECIFIC_ENERGY => "\"1 km^2/s^2\"",
            Kind::KINEMATIC => "\"1e15 cm^2/s\"",
            Kind::PER_LENGTH => "\"1e-9 1/au\"",
            _ => "0.5",
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let d = self.dimension;
        f.write_str(match *self {
            Kind::NUMBER => "a plain number",
            Kind::LENGTH => "a length",
            Kind::MASS => "a mass",
            Kind::TIME => "a time",
            Kind::VELOCITY => "a velocity",
            Kind::DENSITY => "a density",
            Kind::SURFACE_DENSITY => "a surface density",
            Kind::PRESSURE => "a pressure",
            Kind::PLANAR_PRESSURE => "a pressure in two dimensions",
            Kind::SPECIFIC_ENERGY => "an energy by mass",
            Kind::KINEMATIC => "a kinematic viscosity",
            Kind::PER_LENGTH => "an inverse length",
            Kind::ANGLE => "an angle",
            _ if d == Dimension::TEMPERATURE => "a temperature",
            _ if d == Dimension::RATE => "a frequency",
            _ if d == Dimension::ACCELERATION => "an acceleration",
            _ if d == Dimension::new(2, 0, 0, 0) => "an area",
            _ => {
                return write!(
                    f,
                    "a quantity in cm^{} g^{} s^{} K^{} rad^{}",
                    d.length, d.mass, d.time, d.temperature, self.angle
                );
            }
        })
    }
}

/// Seconds of a wall-clock time: a quantity of any system.
pub fn seconds(text: &str) -> Result<f64, String> {
    Units::new(System::Cgs).value(text, Kind::TIME)
}

/// The number before the unit, and the unit.
fn split(text: &str) -> Result<(f64, &str), String> {
    let text = text.trim();
    let (number, end) = (1..=text.len())
        .filter(|&end| text.is_char_boundary(end))
        .filter(|&end| !text[..end].contains(|c: char| c.is_alphabetic() && !"eE".contains(c)))
        .filter_map(|end| text[..end].parse::<f64>().ok().map(|x| (x, end)))
        .next_back()
        .ok_or("is not a number with a unit, such as \"5.2 au\"")?;
    if number.is_finite() {
        Ok((number, text[end..].trim()))
    } else {
        Err("is not a finite number".into())
    }
}

/// Value in cgs (radians) and kind of a product of units such as `g/cm^2` or `km s^-1`.
fn unit_product(unit: &str) -> Result<(f64, Kind), String> {
    let mut product = (1.0, Kind::NUMBER);
    let mut rest = unit.trim_start();
    let mut sign = 1;
    while !rest.is_empty() {
        let end = rest
            .find(|c: char| c == '*' || c == '/' || c.is_whitespace())
            .unwrap_or(rest.len());
        let (name, power) = match rest[..end].split_once('^') {
            Some((name, power)) => {
                let power = power
                    .parse::<i8>()
                    .ok()
                    .filter(|p| p.abs() <= 12)
                    .ok_or_else(|| {
                        format!("has the power `{power}`, where a whole number is wanted")
                    })?;
                (name, power)
            }
            None => (&rest[..end], 1),
        };
        let (factor, kind) = single_unit(name)?;
        product.0 *= factor.powi((sign * power).into());
        product.1 = raised(product.1, kind, sign * power)?;
        rest = rest[end..].trim_start();
        sign = 1;
        if let Some(next) = rest.strip_prefix(['*', '/']) {
            sign = if rest.starts_with('/') { -1 } else { 1 };
            rest = next.trim_start();
            if rest.is_empty() {
                return Err("ends in the middle of its unit".into());
            }
        }
    }
    Ok(product)
}

fn raised(a: Kind, b: Kind, power: i8) -> Result<Kind, String> {
    let add = |x: i8, y: i8| {
        y.checked_mul(power)
            .and_then(|y| x.checked_add(y))
            .ok_or("has powers of units beyond reason")
    };
    let (p, q) = (a.dimension, b.dimension);
    Ok(Kind {
        dimension: Dimension::new(
            add(p.length, q.length)?,
            add(p.mass, q.mass)?,
            add(p.time, q.time)?,
            add(p.temperature, q.temperature)?,
        ),
        angle: add(a.angle, b.angle)?,
    })
}

const KNOWN: &str = "um mm cm m km au pc Rsun Rearth Rjup; mg g kg Msun Mearth Mjup; s min h day yr kyr Myr; K; rad deg";

fn single_unit(name: &str) -> Result<(f64, Kind), String> {
    let year = TAU * (AU * AU * AU / GM_SUN).sqrt();
    Ok(match name {
        "1" => (1.0, Kind::NUMBER),
        "um" | "µm" | "μm" => (1e-4, Kind::LENGTH),
        "mm" => (0.1, Kind::LENGTH),
        "cm" => (1.0, Kind::LENGTH),
        "m" => (100.0, Kind::LENGTH),
        "km" => (1e5, Kind::LENGTH),
        "au" | "AU" => (AU, Kind::LENGTH),
        "pc" => (AU * 648_000.0 / PI, Kind::LENGTH),
        "Rsun" => (6.957e10, Kind::LENGTH),
        "Rearth" => (6.3781e8, Kind::LENGTH),
        "Rjup" => (7.1492e9, Kind::LENGTH),
        "mg" => (1e-3, Kind::MASS),
        "g" => (1.0, Kind::MASS),
        "kg" => (1e3, Kind::MASS),
        "Msun" => (GM_SUN / G_CGS, Kind::MASS),
        "Mearth" => (GM_EARTH / G_CGS, Kind::MASS),
        "Mjup" => (GM_JUPITER / G_CGS, Kind::MASS),
        "s" => (1.0, Kind::TIME),
        "min" => (60.0, Kind::TIME),
        "h" => (3600.0, Kind::TIME),
        "day" | "d" => (86400.0, Kind::TIME),
        "yr" => (year, Kind::TIME),
        "kyr" => (1e3 * year, Kind::TIME),
        "Myr" => (1e6 * year, Kind::TIME),
        "K" => (1.0, Kind::of(Dimension::TEMPERATURE)),
        "rad" => (1.0, Kind::ANGLE),
        "deg" => (PI / 180.0, Kind::ANGLE),
        _ => {
            return Err(format!(
                "has the unknown unit `{name}`; known are {KNOWN}, joined by * / ^"
            ));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, wanted: f64, bar: f64) {
        assert!(
            (found / wanted - 1.0).abs() < bar,
            "{found} is not {wanted}"
        );
    }

    #[test]
    fn astronomical_units_make_the_gravitational_constant_one() {
        let units = Units::new(System::Astronomical);
        close(
            G_CGS * units.mass * units.time.powi(2) / units.length.powi(3),
            1.0,
            1e-14,
        );
        close(units.value("1 yr", Kind::TIME).unwrap(), TAU, 1e-15);
        close(units.mass, 1.98841e33, 1e-5);
        close(units.value("1 Msun", Kind::MASS).unwrap(), 1.0, 1e-15);
        close(
            units.value("1 Mearth", Kind::MASS).unwrap(),
            3.0035e-6,
            1e-4,
        );
        // 29.7847 km/s is the circular speed at 1 au.
        close(
            units.value("29.7847 km/s", Kind::VELOCITY).unwrap(),
            1.0,
            1e-5,
        );
    }

    #[test]
    fn compound_units_multiply_out() {
        let units = Units::new(System::Cgs);
        let of = |text, kind| units.value(text, kind).unwrap();
        assert_eq!(of("1700 g/cm^2", Kind::SURFACE_DENSITY), 1700.0);
        close(of("1e3 kg*m^-3", Kind::DENSITY), 1.0, 1e-15);
        close(of("36 km h^-1", Kind::VELOCITY), 1000.0, 1e-15);
        close(of("-180 deg", Kind::ANGLE), -PI, 1e-15);
        close(of("0.1um", Kind::LENGTH), 1e-5, 1e-15);
        close(of("2 1/m", Kind::PER_LENGTH), 0.02, 1e-15);
        close(of("1e-5 m", Kind::LENGTH), 1e-3, 1e-15);
    }

    #[test]
    fn what_is_wrong_is_said_in_words() {
        let units = Units::new(System::Astronomical);
        let wrong = |text, kind| units.value(text, kind).unwrap_err();
        assert!(wrong("5 kg", Kind::LENGTH).contains("is a mass, where a length is wanted"));
        assert!(wrong("5 parsec", Kind::LENGTH).contains("unknown unit `parsec`"));
        assert!(wrong("five au", Kind::LENGTH).contains("not a number with a unit"));
        assert!(wrong("nan au", Kind::LENGTH).contains("not a number"));
        assert!(wrong("inf au", Kind::LENGTH).contains("not a number"));
        assert!(wrong("1e999 au", Kind::LENGTH).contains("not a finite number"));
        assert!(wrong("5 g/", Kind::MASS).contains("ends in the middle"));
        assert!(wrong("5 g^x", Kind::MASS).contains("the power `x`"));
        assert!(
            wrong(
                "5 g^12*g^12*g^12*g^12*g^12*g^12*g^12*g^12*g^12*g^12*g^12",
                Kind::MASS
            )
            .contains("beyond reason")
        );
        assert!(wrong("", Kind::MASS).contains("not a number"));
        assert!(wrong("30 deg", Kind::LENGTH).contains("is an angle, where a length"));
        let plain = Units::new(System::Dimensionless);
        assert!(
            plain
                .value("1 au", Kind::LENGTH)
                .unwrap_err()
                .contains("plain number")
        );
        assert!(plain.value("30 deg", Kind::ANGLE).is_ok());
    }
}
