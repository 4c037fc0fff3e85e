//! A reader of a scene's tables, which asks for the keys it knows and gathers everything that is wrong, a sentence each.

use std::cell::{Cell, RefCell};

use nbody::points::Vec3;

use crate::document::{Node, Place, Value};
use crate::units::{self, Kind, System, Units};

/// The largest size of a number of a scene.
pub const MOST: f64 = 1e100;

/// What is allowed of a number, in a test and in words.
#[derive(Clone, Copy)]
pub struct Range {
    pub test: fn(f64) -> bool,
    pub text: &'static str,
}

impl Range {
    pub const ANY: Self = Self {
        test: |_| true,
        text: "any finite number",
    };
    pub const POSITIVE: Self = Self {
        test: |x| x > 0.0,
        text: "greater than 0",
    };
    pub const NOT_NEGATIVE: Self = Self {
        test: |x| x >= 0.0,
        text: "0 or greater",
    };
    pub const ECCENTRICITY: Self = Self {
        test: |x| (0.0..1.0).contains(&x),
        text: "at least 0 and less than 1",
    };
    pub const FRACTION: Self = Self {
        test: |x| x > 0.0 && x <= 1.0,
        text: "greater than 0 and at most 1",
    };
    pub const PART: Self = Self {
        test: |x| (0.0..=1.0).contains(&x),
        text: "from 0 to 1",
    };
}

/// What all sections of one scene share.
pub struct Door {
    pub units: Cell<Units>,
    problems: RefCell<Vec<(Place, String)>>,
}

impl Default for Door {
    fn default() -> Self {
        Self {
            units: Cell::new(Units::new(System::Astronomical)),
            problems: RefCell::default(),
        }
    }
}

impl Door {
    pub fn report(&self, place: &Place, sentence: String) {
        self.problems.borrow_mut().push((place.clone(), sentence));
    }

    /// Whether nothing has been found wrong.
    pub fn is_content(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// All problems in the order of the file.
    pub fn into_problems(self) -> Vec<(Place, String)> {
        let mut problems = self.problems.into_inner();
        problems.sort_by(|a, b| a.0.cmp(&b.0));
        let mut said = std::collections::BTreeSet::new();
        problems.retain(|problem| said.insert(problem.clone()));
        problems
    }
}

/// A table of the file; one that the file does not have is empty.
pub struct Section<'a> {
    pub present: bool,
    path: String,
    place: Place,
    entries: &'a [(String, Node)],
    known: RefCell<Vec<&'static str>>,
    door: &'a Door,
}

impl<'a> Section<'a> {
    pub fn root(entries: &'a [(String, Node)], door: &'a Door) -> Self {
        Self::new(String::new(), Place::Line(1), entries, door, true)
    }

    fn new(
        path: String,
        place: Place,
        entries: &'a [(String, Node)],
        door: &'a Door,
        present: bool,
    ) -> Self {
        Self {
            present,
            path,
            place,
            entries,
            known: RefCell::default(),
            door,
        }
    }

    fn full(&self, key: &str) -> String {
        if self.path.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.path)
        }
    }

    pub fn units(&self) -> Units {
        self.door.units.get()
    }

    pub fn has(&self, key: &str) -> bool {
        self.entries.iter().any(|(name, _)| name == key)
    }

    fn find(&self, key: &'static str) -> Option<&'a Node> {
        self.known.borrow_mut().push(key);
        self.entries
            .iter()
            .find(|(name, _)| name == key)
            .map(|(_, node)| node)
    }

    /// Says what is wrong with a key that the file has, or with the section without it.
    pub fn wrong(&self, key: &str, sentence: &str) {
        match self.entries.iter().find(|(name, _)| name == key) {
            Some((_, node)) => self.refuse(key, node, sentence),
            None if self.path.is_empty() => self.door.report(&self.place, sentence.to_owned()),
            None => self
                .door
                .report(&self.place, format!("[{}]: {sentence}", self.path)),
        }
    }

    fn refuse(&self, key: &str, node: &Node, sentence: &str) {
        let shown = match &node.value {
            Value::Table(_) => format!("[{}]", self.full(key)),
            value => format!("{} = {value}", self.full(key)),
        };
        self.door
            .report(&node.place, format!("{shown}: {sentence}"));
    }

    /// The value, or a word that it is missing; nothing is said of a value that was wrong, since that has been said.
    pub fn required<T>(&self, key: &str, value: Option<T>, what: &str, fallback: T) -> T {
        if value.is_none() && !self.has(key) {
            self.wrong(key, &format!("needs {key}, {what}"));
        }
        value.unwrap_or(fallback)
    }

    /// A quantity or a number in code units.
    pub fn quantity(&self, key: &'static str, kind: Kind, range: Range) -> Option<f64> {
        let node = self.find(key)?;
        let found = match scalar(node, kind, &self.units()) {
            Ok(x) if !x.is_finite() => Err("must be a finite number".to_owned()),
            Ok(x) if x != 0.0 && !(1.0 / MOST..=MOST).contains(&x.abs()) => Err(format!(
                "is {x:e} in code units; allowed are 0 and sizes from {:e} to {MOST:e}, whose cubes are numbers",
                1.0 / MOST
            )),
            Ok(x) if !(range.test)(x) => Err(format!("must be {}", range.text)),
            other => other,
        };
        found
            .map_err(|sentence| self.refuse(key, node, &sentence))
            .ok()
    }

    pub fn number(&self, key: &'static str, range: Range) -> Option<f64> {
        self.quantity(key, Kind::NUMBER, range)
    }

    /// A wall-clock time in seconds.
    pub fn wall_clock(&self, key: &'static str) -> Option<f64> {
        let node = self.find(key)?;
        let found = match &node.value {
            Value::Text(text) => units::seconds(text),
            Value::Number(_, x, _) => Ok(*x),
            _ => Err("must be a wall-clock time, such as \"5 min\"".to_owned()),
        };
        match found {
            Ok(x) if x.is_finite() && x > 0.0 => Some(x),
            Ok(_) => {
                self.refuse(key, node, "must be a finite time greater than 0");
                None
            }
            Err(sentence) => {
                self.refuse(key, node, &sentence);
                None
            }
        }
    }

    pub fn whole(&self, key: &'static str, least: u64, most: u64) -> Option<u64> {
        let node = self.find(key)?;
        if let Value::Number(_, _, Some(i)) = node.value
            && let Ok(i) = u64::try_from(i)
            && (least..=most).contains(&i)
        {
            return Some(i);
        }
        let sentence = format!("must be a whole number from {least} to {most}");
        self.refuse(key, node, &sentence);
        None
    }

    pub fn flag(&self, key: &'static str) -> Option<bool> {
        let node = self.find(key)?;
        if let Value::Flag(flag) = node.value {
            return Some(flag);
        }
        self.refuse(key, node, "must be true or false");
        None
    }

    pub fn text(&self, key: &'static str) -> Option<&'a str> {
        let node = self.find(key)?;
        if let Value::Text(text) = &node.value {
            return Some(text);
        }
        self.refuse(key, node, "must be a text in quotes");
        None
    }

    /// One of `options`; those of `later` are known but not to be had.
    pub fn choice<T: Copy>(
        &self,
        key: &'static str,
        options: &[(&str, T)],
        later: &[&str],
    ) -> Option<T> {
        let node = self.find(key)?;
        self.chosen(key, node, options, later)
    }

    fn chosen<T: Copy>(
        &self,
        key: &str,
        node: &Node,
        options: &[(&str, T)],
        later: &[&str],
    ) -> Option<T> {
        let names: Vec<&str> = options.iter().map(|(name, _)| *name).collect();
        let allowed = quoted(&names);
        let Value::Text(text) = &node.value else {
            self.refuse(key, node, &format!("must be one of {allowed}"));
            return None;
        };
        let found = options.iter().find(|(name, _)| name == text);
        if found.is_none() {
            let sentence = if later.contains(&text.as_str()) {
                format!("is not available in this version; allowed are {allowed}")
            } else {
                match nearest(text, &names) {
                    Some(near) => {
                        format!("is unknown; the nearest is \"{near}\", allowed are {allowed}")
                    }
                    None => format!("is unknown; allowed are {allowed}"),
                }
            };
            self.refuse(key, node, &sentence);
        }
        found.map(|(_, value)| *value)
    }

    /// A list of `options`, each at most once.
    pub fn choices<T: Copy>(&self, key: &'static str, options: &[(&str, T)]) -> Option<Vec<T>> {
        let node = self.find(key)?;
        let Value::List(items) = &node.value else {
            let names: Vec<&str> = options.iter().map(|(name, _)| *name).collect();
            let sentence = format!("must be a list of {}", quoted(&names));
            self.refuse(key, node, &sentence);
            return None;
        };
        items
            .iter()
            .map(|item| self.chosen(key, item, options, &[]))
            .collect()
    }

    /// A list of quantities.
    pub fn quantities(&self, key: &'static str, kind: Kind) -> Option<Vec<f64>> {
        let node = self.find(key)?;
        let Value::List(items) = &node.value else {
            return self.quantity(key, kind, Range::ANY).map(|x| vec![x]);
        };
        let mut found = Vec::with_capacity(items.len());
        for item in items {
            match scalar(item, kind, &self.units()) {
                Ok(x) if x.abs() <= MOST => found.push(x),
                Ok(x) if x.is_finite() => {
                    let sentence = format!("is {x:e} in code units; the most is {MOST:e}");
                    self.refuse(key, item, &sentence);
                }
                Ok(_) => self.refuse(key, item, "must be a finite number"),
                Err(sentence) => self.refuse(key, item, &sentence),
            }
        }
        (found.len() == items.len()).then_some(found)
    }

    pub fn vector(&self, key: &'static str, kind: Kind) -> Option<Vec3> {
        let found = self.quantities(key, kind)?;
        if let [x, y, z] = found[..] {
            return Some(Vec3::new(x, y, z));
        }
        let sentence = format!("must be a list of three, [x, y, z], each {kind} or a number");
        self.wrong(key, &sentence);
        None
    }

    /// Whether the value is a list, a table or a text.
    pub fn is_list(&self, key: &str) -> bool {
        matches!(self.peek(key), Some(Value::List(_)))
    }

    pub fn is_table(&self, key: &str) -> bool {
        matches!(self.peek(key), Some(Value::Table(_)))
    }

    pub fn is_text(&self, key: &str, text: &str) -> bool {
        matches!(self.peek(key), Some(Value::Text(found)) if found == text)
    }

    fn peek(&self, key: &str) -> Option<&'a Value> {
        self.entries
            .iter()
            .find(|(name, _)| name == key)
            .map(|(_, node)| &node.value)
    }

    pub fn section(&self, key: &'static str) -> Section<'a> {
        let path = self.full(key);
        match self.find(key) {
            Some(Node {
                place,
                value: Value::Table(entries),
            }) => Section::new(path, place.clone(), entries, self.door, true),
            Some(node) => {
                self.refuse(key, node, &format!("must be a table, [{path}]"));
                Section::new(path, node.place.clone(), &[], self.door, false)
            }
            None => Section::new(path, self.place.clone(), &[], self.door, false),
        }
    }

    /// The tables of an array such as `[[planet]]`.
    pub fn sections(&self, key: &'static str) -> Vec<Section<'a>> {
        let Some(node) = self.find(key) else {
            return Vec::new();
        };
        let path = self.full(key);
        let Value::List(items) = &node.value else {
            self.refuse(key, node, &format!("must be a list of tables, [[{path}]]"));
            return Vec::new();
        };
        let mut found = Vec::with_capacity(items.len());
        for (i, item) in items.iter().enumerate() {
            if let Value::Table(entries) = &item.value {
                let path = format!("{path}.{i}");
                found.push(Section::new(
                    path,
                    item.place.clone(),
                    entries,
                    self.door,
                    true,
                ));
            } else {
                self.refuse(key, item, &format!("must be a table, [[{path}]]"));
            }
        }
        found
    }

    /// Says of keys that the file has where they belong.
    pub fn misplaced(&self, keys: &[&'static str], sentence: &str) {
        for &key in keys {
            if self.find(key).is_some() {
                self.wrong(key, sentence);
            }
        }
    }

    /// Says nothing of keys whose meaning hangs on a value that was refused.
    pub fn pass_over(&self, keys: &[&'static str]) {
        self.known.borrow_mut().extend(keys);
    }

    /// Says of keys that the file has that they are not to be had yet.
    pub fn later(&self, keys: &[&'static str]) {
        self.misplaced(keys, "is not available in this version");
    }

    /// Says that of two alternatives only one may be given.
    pub fn exclusive(&self, a: &str, b: &str) {
        if self.has(a) && self.has(b) {
            self.wrong(b, &format!("cannot stand beside {a}: give one of the two"));
        }
    }

    /// Names the keys that nobody asked for.
    pub fn close(self) {
        let known = self.known.borrow();
        let mut names: Vec<&str> = known.clone();
        names.sort_unstable();
        names.dedup();
        for (key, node) in self.entries {
            if names.contains(&key.as_str()) {
                continue;
            }
            let sentence = match nearest(key, &names) {
                Some(near) => format!("unknown key; the nearest is \"{near}\""),
                None => format!("unknown key; known here are {}", names.join(", ")),
            };
            self.refuse(key, node, &sentence);
        }
    }
}

fn scalar(node: &Node, kind: Kind, units: &Units) -> Result<f64, String> {
    match &node.value {
        Value::Number(_, x, _) => Ok(*x),
        Value::Text(text) => units.value(text, kind),
        _ if kind == Kind::NUMBER => Err("must be a number".into()),
        _ => Err(format!(
            "must be {kind}, such as {}, or a number in code units",
            kind.example()
        )),
    }
}

fn quoted(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("{name:?}")).collect();
    quoted.join(", ")
}

/// The known word nearest to a mistyped one, if it is near at all.
pub fn nearest<'n>(word: &str, names: &[&'n str]) -> Option<&'n str> {
    let bar = (word.chars().count() / 3).clamp(1, 4);
    names
        .iter()
        .map(|name| (edits(word, name), *name))
        .filter(|(distance, _)| *distance <= bar)
        .min()
        .map(|(_, name)| name)
}

/// Insertions, deletions, replacements and swaps of neighbours that lead from `a` to `b`.
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut table = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replace = table[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut best = replace.min(table[i - 1][j] + 1).min(table[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(table[i - 2][j - 2] + 1);
                }
                best
            };
        }
    }
    table[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_count_typing_errors() {
        for (a, b, count) in [
            ("mass", "mass", 0),
            ("mas", "mass", 1),
            ("masss", "mass", 1),
            ("msas", "mass", 1),
            ("gas", "dust", 3),
            ("", "ab", 2),
        ] {
            assert_eq!(edits(a, b), count, "{a} {b}");
        }
        assert_eq!(
            nearest("inner_radus", &["outer_radius", "inner_radius"]),
            Some("inner_radius")
        );
        assert_eq!(nearest("temperature", &["mass", "slope"]), None);
    }
}
