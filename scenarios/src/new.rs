//! Templates: commented scenes to start from.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::reader::nearest;

/// Name, what it is, text.
const TEMPLATES: [(&str, &str, &str); 7] = [
    (
        "disk",
        "gas, dust, planetesimals and a planet about a star",
        include_str!("new/disk.toml"),
    ),
    (
        "gas-disk",
        "a disk of gas about a star",
        include_str!("new/gas-disk.toml"),
    ),
    (
        "dusty-box",
        "gas and dust in a periodic box, the classic test of drag",
        include_str!("new/dusty-box.toml"),
    ),
    (
        "shearing-box",
        "a patch of a disk that turns with its orbit, of gas and dust",
        include_str!("new/shearing-box.toml"),
    ),
    (
        "shock-tube",
        "gas of two pressures side by side",
        include_str!("new/shock-tube.toml"),
    ),
    (
        "belt",
        "a belt of planetesimals that pull each other and merge",
        include_str!("new/belt.toml"),
    ),
    (
        "planets",
        "the Sun and the four giant planets",
        include_str!("new/planets.toml"),
    ),
];

/// Writes a template, or lists them; what to print, or why not.
pub fn write(template: Option<&str>, file: Option<&Path>) -> Result<String, String> {
    let Some(name) = template else {
        return Ok(list());
    };
    let names = TEMPLATES.map(|(name, ..)| name);
    let Some((_, _, text)) = TEMPLATES.iter().find(|entry| entry.0 == name) else {
        let near = nearest(name, &names);
        let near = near.map_or_else(String::new, |near| format!("the nearest is \"{near}\"; "));
        return Err(format!(
            "there is no template \"{name}\"; {near}allowed are {}",
            names.join(", ")
        ));
    };
    if file == Some(Path::new("-")) {
        return Ok((*text).to_owned());
    }
    let path = file.map_or_else(|| PathBuf::from(format!("{name}.toml")), Path::to_path_buf);
    let written = OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path)
        .and_then(|mut file| file.write_all(text.as_bytes()));
    match written {
        Ok(()) => Ok(format!(
            "{}: edit it, then `tridisk check {0}` and `tridisk run {0}`\n",
            path.display()
        )),
        Err(error) => Err(format!("{} cannot be written: {error}", path.display())),
    }
}

fn list() -> String {
    TEMPLATES
        .iter()
        .map(|(name, what, _)| format!("{name:<12} {what}\n"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn every_template_is_a_valid_scene() {
        for (name, _, text) in TEMPLATES {
            let scene = Scene::parse(text, name, Path::new("."), &[]);
            assert!(scene.is_ok(), "{name}: {:?}", scene.err());
        }
    }
}
