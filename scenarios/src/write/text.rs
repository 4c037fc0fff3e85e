//! Lines of TOML: keys with their values, in a text that grows.

use std::fmt::{Display, Write};

use nbody::points::Vec3;

use crate::scene::{Softening, TimeStep};

/// A TOML text in the making.
#[derive(Default)]
pub struct Text(pub String);

impl Text {
    pub fn table(&mut self, name: &str) {
        self.line(format_args!("\n[{name}]"));
    }

    pub fn entry(&mut self, name: &str) {
        self.line(format_args!("\n[[{name}]]"));
    }

    pub fn line(&mut self, line: impl Display) {
        writeln!(self.0, "{line}").expect("writing to a string does not fail");
    }

    pub fn raw(&mut self, key: &str, value: impl Display) {
        self.line(format_args!("{key} = {value}"));
    }

    /// Shortest digits that read back to the same bits.
    pub fn number(&mut self, key: &str, value: f64) {
        self.raw(key, format_args!("{value:?}"));
    }

    pub fn text(&mut self, key: &str, value: &str) {
        self.raw(key, toml::Value::from(value));
    }

    pub fn vector(&mut self, key: &str, v: Vec3) {
        self.raw(key, format_args!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z));
    }

    pub fn time_step(&mut self, step: TimeStep) {
        match step {
            TimeStep::Auto => self.text("time_step", "auto"),
            TimeStep::Fixed(dt) => self.number("time_step", dt),
        }
    }

    pub fn softening(&mut self, softening: Softening) {
        match softening {
            Softening::SmoothingLength => self.text("softening", "smoothing-length"),
            Softening::Fixed(length) => self.number("softening", length),
        }
    }
}
