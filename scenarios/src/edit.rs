//! Edits of a scene's text: keys get other values, and everything else, remarks and blanks too, stays as it is.

use std::ops::Range;
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::document::override_text;
use crate::scene::Scene;

/// The text of a scene in `folder` in which each key has its value; refused if that would not read as the overrides do.
pub fn with_keys(text: &str, folder: &Path, keys: &[(String, String)]) -> Result<String, String> {
    let mut changed = text.to_owned();
    for (key, value) in keys {
        changed = with_key(&changed, key, &override_text(value))?;
    }
    let overrides: Vec<String> = keys.iter().map(|(k, v)| format!("{k}={v}")).collect();
    let read = |text: &str, overrides: &[String]| Scene::parse(text, "scene", folder, overrides);
    match (read(&changed, &[]), read(text, &overrides)) {
        (Ok(changed), Ok(wanted)) if changed == wanted => {}
        _ => {
            let keys: Vec<&str> = keys.iter().map(|(key, _)| key.as_str()).collect();
            return Err(format!(
                "{} cannot be set without rewriting more of the scene; set it by hand",
                keys.join(", ")
            ));
        }
    }
    Ok(changed)
}

/// The text with one key set.
fn with_key(text: &str, key: &str, value: &str) -> Result<String, String> {
    let table = DeTable::parse(text).map_err(|error| error.message().to_owned())?;
    let steps: Vec<&str> = key.split('.').map(str::trim).collect();
    let (last, path) = steps.split_last().expect("a split has one part at least");
    let mut replaced = text.to_owned();
    match place(&table, path, last) {
        Some(Place::Value(span)) => replaced.replace_range(span, value),
        Some(Place::Inside(at)) => replaced.insert_str(at, &format!(", {last} = {value}")),
        Some(Place::After(at)) => {
            let line = text[at..].find('\n').map_or(text.len(), |end| at + end);
            replaced.insert_str(line, &format!("\n{last} = {value}"));
        }
        None => match headline(text, path) {
            Some(line) => replaced.insert_str(line, &format!("\n{last} = {value}")),
            None if path.is_empty() => replaced.insert_str(0, &format!("{last} = {value}\n")),
            None => {
                let gap = if text.ends_with('\n') { "" } else { "\n" };
                replaced += &format!("{gap}\n[{}]\n{last} = {value}\n", path.join("."));
            }
        },
    }
    Ok(replaced)
}

/// Where a value stands or could stand.
enum Place {
    Value(Range<usize>),
    /// Behind the last value of a table in braces.
    Inside(usize),
    /// On the line after this.
    After(usize),
}

fn place(table: &Spanned<DeTable<'_>>, path: &[&str], last: &str) -> Option<Place> {
    let mut here = table.get_ref();
    let mut braces = false;
    let mut steps = path.iter();
    while let Some(step) = steps.next() {
        let mut value = entry(here, step)?;
        if let DeValue::Array(list) = value.get_ref() {
            value = list.get(steps.next()?.parse::<usize>().ok()?)?;
        }
        let DeValue::Table(inner) = value.get_ref() else {
            return None;
        };
        // A table in braces spans more than one under a headline, whose span is that of the headline.
        let ends = inner.iter().map(|(_, value)| value.span().end);
        braces = ends.max().is_some_and(|end| end < value.span().end);
        here = inner;
    }
    if let Some(value) = entry(here, last) {
        return Some(Place::Value(value.span()));
    }
    let plain = |value: &&Spanned<DeValue>| !matches!(value.get_ref(), DeValue::Table(_));
    let tables = |value: &&Spanned<DeValue>| match value.get_ref() {
        DeValue::Array(list) => !list.iter().any(|item| item.get_ref().is_table()),
        _ => true,
    };
    let values = here.iter().map(|(_, value)| value);
    let end = values.filter(plain).filter(tables).map(|v| v.span().end);
    let end = end.max()?;
    Some(match braces {
        true => Place::Inside(end),
        false => Place::After(end),
    })
}

fn entry<'a, 'b>(table: &'a DeTable<'b>, key: &str) -> Option<&'a Spanned<DeValue<'b>>> {
    let mut entries = table.iter();
    entries
        .find(|(name, _)| name.get_ref().as_ref() == key)
        .map(|(_, value)| value)
}

/// The end of the line that heads a table.
fn headline(text: &str, path: &[&str]) -> Option<usize> {
    let wanted = format!("[{}]", path.join("."));
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let code = line.split('#').next().unwrap_or_default();
        let bare: String = code.chars().filter(|c| !c.is_whitespace()).collect();
        if !path.is_empty() && bare == wanted {
            return Some(start + line.trim_end_matches(['\n', '\r']).len());
        }
        start += line.len();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: &str = r#"# A remark at the top.
title = "two planets"   # and one here

[run]
end_time = "10 yr"  # long
[star]
mass = "1 Msun"
[planetesimals] # how they move
# nothing set
[[planet]]
mass = "1 Mjup"
semi_major_axis = "5 au"
[[planet]]
mass = { } # never read
"#;

    fn set(key: &str, value: &str) -> String {
        with_key(SCENE, key, value).expect("an edit")
    }

    #[test]
    fn a_value_changes_and_remarks_stay() {
        let text = set("run.end_time", "\"2 yr\"");
        assert_eq!(text, SCENE.replace("\"10 yr\"", "\"2 yr\""));
        let text = set("planet.0.mass", "1.0");
        assert_eq!(text, SCENE.replace("\"1 Mjup\"", "1.0"));
    }

    #[test]
    fn a_missing_key_finds_its_table_or_makes_it() {
        let text = set("run.seed", "7");
        assert!(text.contains("\"10 yr\"  # long\nseed = 7\n[star]"));
        let text = set("planetesimals.time_step", "0.1");
        assert!(text.contains("# how they move\ntime_step = 0.1\n# nothing set"));
        let text = set("planet.0.radius", "0.1");
        assert!(text.contains("\"5 au\"\nradius = 0.1\n[[planet]]"));
        let text = set("accuracy.orbit_step", "0.1");
        assert!(text.ends_with("# never read\n\n[accuracy]\norbit_step = 0.1\n"));
        let braces = "[dust]\nsize = { min = 1, max = 2 } # both\n";
        let text = with_key(braces, "dust.size.slope", "-3.5").expect("an edit");
        assert_eq!(
            text,
            "[dust]\nsize = { min = 1, max = 2, slope = -3.5 } # both\n"
        );
    }

    #[test]
    fn an_edit_reads_as_the_overrides_do() {
        let good = SCENE.replace("[[planet]]\nmass = { } # never read\n", "");
        let keys = [
            ("planetesimals.integrator", "wisdom-holman"),
            ("accuracy.preset", "draft"),
            ("run.seed", "5"),
        ]
        .map(|(key, value)| (key.to_owned(), value.to_owned()));
        let text = with_keys(&good, Path::new("."), &keys).expect("an edit");
        assert!(text.contains("integrator = \"wisdom-holman\"") && text.contains("# long"));
        let wrong = [("run.seed".to_owned(), "many".to_owned())];
        assert!(with_keys(&good, Path::new("."), &wrong).is_err());
    }
}
