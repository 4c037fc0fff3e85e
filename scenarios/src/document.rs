//! A document: a TOML file as a tree of values that know their place, with `--set` overrides laid over it.

use std::fmt;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where a value was given.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// Counted from 1.
    Line(usize),
    /// A `--set` argument.
    Set(String),
}

#[derive(Clone, Debug)]
pub struct Node {
    pub place: Place,
    pub value: Value,
}

#[derive(Clone, Debug)]
pub enum Value {
    Text(String),
    /// As written, and whether it is a whole number.
    Number(String, f64, Option<i64>),
    Flag(bool),
    Date(String),
    List(Vec<Node>),
    Table(Entries),
}

pub type Entries = Vec<(String, Node)>;

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Text(text) => write!(f, "{:?}", short(text)),
            Value::Number(text, ..) | Value::Date(text) => f.write_str(&short(text)),
            Value::Flag(flag) => write!(f, "{flag}"),
            Value::List(nodes) => {
                f.write_str("[")?;
                for (i, node) in nodes.iter().enumerate().take(6) {
                    write!(f, "{}{}", if i == 0 { "" } else { ", " }, node.value)?;
                }
                f.write_str(if nodes.len() > 6 { ", ..]" } else { "]" })
            }
            Value::Table(_) => f.write_str("{..}"),
        }
    }
}

/// The start of a text, for messages.
fn short(text: &str) -> String {
    text.chars().take(60).collect()
}

/// The entries of a TOML text; every syntax error with its line otherwise.
pub fn parse(text: &str) -> Result<Entries, Vec<(Place, String)>> {
    let (table, errors) = DeTable::parse_recoverable(text);
    if errors.is_empty() {
        let lines = Lines::of(text);
        return Ok(entries(table.get_ref(), &|at| {
            Place::Line(lines.number(at))
        }));
    }
    let lines = Lines::of(text);
    let mut problems: Vec<_> = errors
        .iter()
        .map(|error| {
            let at = error.span().map_or(0, |span| span.start);
            let what = error.message().replace('\n', ", ");
            (
                Place::Line(lines.number(at)),
                format!("this is not TOML: {what}"),
            )
        })
        .collect();
    problems.dedup_by(|a, b| a.0 == b.0);
    Err(problems)
}

/// Lays `key.path=value` over the entries. What is no TOML value counts as text, since shells eat quotes.
pub fn lay_over(entries: &mut Entries, argument: &str) -> Result<(), (Place, String)> {
    let place = Place::Set(argument.to_owned());
    let wrong = |what: &str| Err((place.clone(), what.to_owned()));
    let Some((path, text)) = argument.split_once('=') else {
        return wrong("wanted is key.path=value, such as gas.particles=1000");
    };
    let steps: Vec<&str> = path.trim().split('.').map(str::trim).collect();
    if steps.iter().any(|step| step.is_empty()) {
        return wrong(
            "the key has an empty part; wanted is key.path=value, such as gas.particles=1000",
        );
    }
    let node = Node {
        place: place.clone(),
        value: override_value(text.trim(), &place),
    };
    match insert(entries, &steps, node, &place) {
        Ok(()) => Ok(()),
        Err(what) => wrong(&what),
    }
}

fn override_value(text: &str, place: &Place) -> Value {
    let line = format!("x = {text}");
    match DeTable::parse(&line) {
        Ok(table) if table.get_ref().len() == 1 => {
            let mut found = entries(table.get_ref(), &|_| place.clone());
            found.remove(0).1.value
        }
        _ => Value::Text(text.to_owned()),
    }
}

/// The value of an override as a scene's text has it.
pub fn override_text(text: &str) -> String {
    let text = text.trim();
    match override_value(text, &Place::Line(0)) {
        Value::Text(word) => format!("{word:?}"),
        _ => text.to_owned(),
    }
}

/// The value at `key.path`, if there is one.
pub fn value<'a>(entries: &'a Entries, path: &str) -> Option<&'a Value> {
    let (step, rest) = match path.split_once('.') {
        Some((step, rest)) => (step, Some(rest)),
        None => (path, None),
    };
    let (_, node) = entries.iter().find(|(key, _)| key == step)?;
    inside(&node.value, rest)
}

fn inside<'a>(at: &'a Value, path: Option<&str>) -> Option<&'a Value> {
    let Some(path) = path else {
        return Some(at);
    };
    match at {
        Value::Table(entries) => value(entries, path),
        Value::List(nodes) => {
            let (step, rest) = match path.split_once('.') {
                Some((step, rest)) => (step, Some(rest)),
                None => (path, None),
            };
            inside(&nodes.get(step.parse::<usize>().ok()?)?.value, rest)
        }
        _ => None,
    }
}

fn insert(entries: &mut Entries, steps: &[&str], node: Node, place: &Place) -> Result<(), String> {
    let found = entries.iter().position(|(key, _)| key == steps[0]);
    let index = found.unwrap_or_else(|| {
        let table = Node {
            place: place.clone(),
            value: Value::Table(Vec::new()),
        };
        entries.push((steps[0].to_owned(), table));
        entries.len() - 1
    });
    descend(&mut entries[index].1, &steps[1..], node, place)
}

fn descend(at: &mut Node, steps: &[&str], node: Node, place: &Place) -> Result<(), String> {
    let Some(step) = steps.first() else {
        *at = node;
        return Ok(());
    };
    match &mut at.value {
        Value::Table(entries) => insert(entries, steps, node, place),
        Value::List(nodes) => {
            let count = nodes.len();
            let index = step.parse::<usize>().ok().filter(|&i| i < count);
            let index = index.ok_or_else(|| {
                format!("`{step}` is none of the list's {count} entries, which count from 0")
            })?;
            descend(&mut nodes[index], &steps[1..], node, place)
        }
        other => Err(format!("`{step}` lies inside {other}, which is no table")),
    }
}

fn entries(table: &DeTable<'_>, place: &dyn Fn(usize) -> Place) -> Entries {
    let mut found: Vec<(usize, String, Node)> = table
        .iter()
        .map(|(key, value)| {
            let at = key.span().start;
            let node = Node {
                place: place(at),
                value: value_of(value, place),
            };
            (at, key.get_ref().to_string(), node)
        })
        .collect();
    found.sort_by_key(|(at, ..)| *at);
    found
        .into_iter()
        .map(|(_, key, node)| (key, node))
        .collect()
}

fn value_of(value: &Spanned<DeValue<'_>>, place: &dyn Fn(usize) -> Place) -> Value {
    match value.get_ref() {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(number) => {
            let whole = i64::from_str_radix(number.as_str(), number.radix()).ok();
            let real = whole.map_or_else(
                || number.as_str().parse().unwrap_or(f64::INFINITY),
                |i| i as f64,
            );
            Value::Number(number.to_string(), real, whole)
        }
        DeValue::Float(number) => {
            let real = number.as_str().parse().unwrap_or(f64::NAN);
            Value::Number(number.to_string(), real, None)
        }
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(date) => Value::Date(date.to_string()),
        DeValue::Array(list) => Value::List(
            list.iter()
                .map(|item| Node {
                    place: place(item.span().start),
                    value: value_of(item, place),
                })
                .collect(),
        ),
        DeValue::Table(table) => Value::Table(entries(table, place)),
    }
}

/// Where lines begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(
            std::iter::once(0)
                .chain(text.match_indices('\n').map(|(i, _)| i + 1))
                .collect(),
        )
    }

    fn number(&self, at: usize) -> usize {
        self.0.partition_point(|&start| start <= at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_know_their_lines() {
        let entries = parse("a = 1\n[b]\nc = [\n 1,\n 2]\n[[d]]\ne = 0x10\n").unwrap();
        assert_eq!(entries[0].1.place, Place::Line(1));
        let Value::Table(b) = &entries[1].1.value else {
            panic!()
        };
        let Value::List(c) = &b[0].1.value else {
            panic!()
        };
        assert_eq!(c[1].place, Place::Line(5));
        let Value::List(d) = &entries[2].1.value else {
            panic!()
        };
        assert_eq!(d[0].place, Place::Line(6));
    }

    #[test]
    fn overrides_reach_into_tables_and_lists() {
        let mut entries = parse("[a]\nb = 1\n[[c]]\nd = 2\n").unwrap();
        lay_over(&mut entries, "a.b = 3").unwrap();
        lay_over(&mut entries, "c.0.d=1 au").unwrap();
        lay_over(&mut entries, "e.f=\"x\"").unwrap();
        let shown: Vec<_> = entries
            .iter()
            .map(|(k, n)| (k.as_str(), format!("{:?}", n.value)))
            .collect();
        assert!(shown[0].1.contains("Number(\"3\""));
        assert!(shown[1].1.contains("Text(\"1 au\")"));
        assert!(shown[2].1.contains("Text(\"x\")"));
        assert!(lay_over(&mut entries, "c.1.d=2").is_err());
        assert!(lay_over(&mut entries, "a.b.c=2").is_err());
        assert!(lay_over(&mut entries, "nothing").is_err());
        assert!(lay_over(&mut entries, "a..b=1").is_err());
    }

    #[test]
    fn all_syntax_errors_come_with_their_lines() {
        let problems = parse("a = 1\nb = = 2\nc = 3\nd 4\n").unwrap_err();
        let lines: Vec<_> = problems.iter().map(|p| p.0.clone()).collect();
        assert_eq!(lines, [Place::Line(2), Place::Line(4)]);
    }
}
