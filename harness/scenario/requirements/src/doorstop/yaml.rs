//! YAML as a tree with lines.

use saphyr_parser::{Event, Parser, ScalarStyle};

/// Most levels of nesting.
const DEPTH: usize = 50;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Yaml {
    /// Text, and whether it is plain, without quotes.
    Scalar(String, bool),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

/// A value with its line, from 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub(super) value: Yaml,
    pub(super) line: usize,
}

impl Node {
    pub(super) fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Yaml::Map(entries) => {
                entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
            }
            _ => None,
        }
    }

    /// Text of a scalar; `None` for null, and for lists and maps.
    pub(super) fn text(&self) -> Option<&str> {
        match &self.value {
            Yaml::Scalar(text, true)
                if ["", "~", "null", "Null", "NULL"].contains(&text.as_str()) =>
            {
                None
            }
            Yaml::Scalar(text, _) => Some(text),
            _ => None,
        }
    }

    /// Truth of a scalar, by the words of YAML 1.1.
    pub(super) fn truth(&self) -> Option<bool> {
        match self.text()?.to_ascii_lowercase().as_str() {
            "true" | "yes" | "on" | "1" | "enabled" => Some(true),
            "false" | "no" | "off" | "0" => Some(false),
            _ => None,
        }
    }

    pub(super) fn describe(&self) -> &'static str {
        match self.value {
            Yaml::Scalar(..) => "a single value",
            Yaml::List(_) => "a list",
            Yaml::Map(_) => "a mapping",
        }
    }
}

/// An open list or map.
enum Open {
    List(Vec<Node>, usize),
    Map(Vec<(String, Node)>, Option<String>, usize),
}

/// Parses one YAML document; errors have a line.
pub(super) fn parse(text: &str) -> Result<Node, (usize, String)> {
    let mut open: Vec<Open> = Vec::new();
    let mut root = None;
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| {
            (error.marker().line().max(1), format!("not YAML: {}", error.info()))
        })?;
        let line = span.start.line().max(1);
        let value = match event {
            Event::Scalar(text, style, ..) => {
                Yaml::Scalar(text.into_owned(), style == ScalarStyle::Plain)
            }
            Event::SequenceStart(..) => {
                open.push(Open::List(Vec::new(), line));
                Yaml::List(Vec::new())
            }
            Event::MappingStart(..) => {
                open.push(Open::Map(Vec::new(), None, line));
                Yaml::Map(Vec::new())
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some(Open::List(entries, line)) => {
                    place(Node { value: Yaml::List(entries), line }, &mut open, &mut root)?;
                    continue;
                }
                Some(Open::Map(entries, _, line)) => {
                    place(Node { value: Yaml::Map(entries), line }, &mut open, &mut root)?;
                    continue;
                }
                None => {
                    return Err((line, "not YAML: found an end without a beginning".to_owned()));
                }
            },
            // An alias can make a huge tree from a small file, and no item has one.
            Event::Alias(_) => return Err((line, "found an alias, expected values".to_owned())),
            _ => continue,
        };
        if open.len() > DEPTH {
            return Err((line, format!("more than {DEPTH} levels of nesting")));
        }
        if matches!(value, Yaml::Scalar(..)) {
            place(Node { value, line }, &mut open, &mut root)?;
        }
    }
    root.ok_or_else(|| (1, "found an empty file, expected a mapping".to_owned()))
}

/// Puts a value into the innermost list or map.
fn place(node: Node, open: &mut [Open], root: &mut Option<Node>) -> Result<(), (usize, String)> {
    match open.last_mut() {
        None if root.is_some() => {
            return Err((node.line, "found a second document, expected one".to_owned()));
        }
        None => *root = Some(node),
        Some(Open::List(entries, _)) => entries.push(node),
        Some(Open::Map(entries, key, _)) => match key.take() {
            Some(name) => entries.push((name, node)),
            None => match node.value {
                Yaml::Scalar(text, _) if entries.iter().any(|(known, _)| *known == text) => {
                    return Err((node.line, format!("the key {text:?} is there a second time")));
                }
                Yaml::Scalar(text, _) => *key = Some(text),
                _ => {
                    let found = node.describe();
                    return Err((node.line, format!("found {found} as a key, expected a text")));
                }
            },
        },
    }
    Ok(())
}

/// Writes a text as a scalar in double quotes.
pub(super) fn quoted(text: &str) -> String {
    let mut out = serde_json::Value::from(text).to_string();
    // YAML takes these for line breaks, or doesn't print them.
    for c in ['\u{7f}', '\u{85}', '\u{2028}', '\u{2029}', '\u{feff}'] {
        out = out.replace(c, &format!("\\u{:04x}", u32::from(c)));
    }
    out
}

/// Writes a text of several lines as a block, or else in quotes.
pub(super) fn block(text: &str) -> String {
    let is_plain =
        |c: char| c == '\n' || (!c.is_control() && !('\u{2028}'..='\u{2029}').contains(&c));
    let has_end = text.lines().any(|line| line.ends_with(' '));
    if text.is_empty()
        || has_end
        || text.starts_with(' ')
        || !text.chars().all(is_plain)
        || text.contains('\u{feff}')
    {
        return quoted(text);
    }
    let mut out = String::from("|");
    for line in text.split('\n') {
        out.push('\n');
        if !line.is_empty() {
            out.push_str("  ");
            out.push_str(line);
        }
    }
    out
}
