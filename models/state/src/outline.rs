//! Content of a state as text: names and kinds of its values without the values. A test that
//! compares it with a stored outline finds a layout that changed without its version.

use alloc::string::String;
use serde::Serialize;

#[derive(Debug, Default)]
pub(crate) struct Outline {
    text: String,
    depth: usize,
    last: String,
    count: usize,
}

impl Outline {
    pub(crate) fn value<T: Serialize + ?Sized>(&mut self, name: &str, value: &T) {
        let json = serde_json::to_string(value).unwrap_or_else(|error| alloc::format!("{error}"));
        self.line(&alloc::format!("{name}: {}", kinds(&json)));
    }

    pub(crate) fn enter(&mut self, name: &str) {
        self.line(&alloc::format!("{name}:"));
        self.close();
        self.depth += 1;
    }

    pub(crate) fn leave(&mut self) {
        self.close();
        self.depth -= 1;
    }

    /// Adds a line; equal lines in sequence become one line with their number.
    fn line(&mut self, line: &str) {
        if self.last == line {
            self.count += 1;
            return;
        }
        self.close();
        for _ in 0..self.depth {
            self.text.push_str("  ");
        }
        self.text.push_str(line);
        self.last = line.into();
        self.count = 1;
    }

    /// The text, at the end.
    pub(crate) fn into_text(mut self) -> String {
        self.close();
        self.text
    }

    fn close(&mut self) {
        if self.count > 1 {
            self.text.push_str(&alloc::format!(" (x {})", self.count));
        }
        if self.count > 0 {
            self.text.push('\n');
        }
        self.last.clear();
        self.count = 0;
    }
}

fn close(out: &mut String, last: &mut Option<(&str, usize)>) {
    if let Some((kind, count)) = last.take() {
        out.push_str(kind);
        if count > 1 {
            out.push_str(&alloc::format!(" x {count}"));
        }
    }
}

/// Replaces the numbers, booleans and nulls (NaN is one) of JSON by a letter, and counts equal
/// neighbours.
fn kinds(json: &str) -> String {
    let mut out = String::new();
    let mut rest = json;
    let mut last: Option<(&str, usize)> = None;
    while let Some(first) = rest.chars().next() {
        if first == '"' {
            close(&mut out, &mut last);
            // The names in our states need no escapes.
            let end = rest[1..].find('"').map_or(rest.len(), |at| at + 2);
            let is_key = rest[end..].starts_with(':');
            out.push_str(if is_key { &rest[..end] } else { "text" });
            rest = &rest[end..];
        } else if first.is_ascii_alphanumeric() || first == '-' {
            let end = rest
                .find(|c: char| !c.is_ascii_alphanumeric() && !"+-.".contains(c))
                .unwrap_or(rest.len());
            let kind = match &rest[..end] {
                "true" | "false" => "bool",
                "null" => "null",
                number if number.contains(['.', 'e']) => "real",
                _ => "int",
            };
            rest = &rest[end..];
            match &mut last {
                Some((known, count)) if *known == kind => *count += 1,
                _ => {
                    if last.is_some() {
                        close(&mut out, &mut last);
                        out.push(',');
                    }
                    last = Some((kind, 1));
                }
            }
            // A comma before another such value is not written yet: it may be part of a count.
            if let Some(after) = rest.strip_prefix(',')
                && after.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '-')
            {
                rest = after;
                continue;
            }
        } else {
            close(&mut out, &mut last);
            out.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    close(&mut out, &mut last);
    out
}

/// Lists name and kinds of one value that isn't a state, such as a configuration.
#[must_use]
pub fn outline_of<T: Serialize>(name: &str, value: &T) -> String {
    let mut outline = Outline::default();
    outline.value(name, value);
    outline.into_text()
}

/// Compares a layout, made of outlines with their names, with the stored one, which begins with its
/// version; for tests. With `OCTANT_WRITE_FIXTURES` set, writes the stored one instead.
///
/// # Panics
/// If the layouts differ.
pub fn assert_layout(path: &str, version: u16, outlines: &[(&str, String)]) {
    let mut text = alloc::format!("version {version}\n");
    for (name, outline) in outlines {
        text.push_str(&alloc::format!("\n== {name}\n{outline}"));
    }
    if std::env::var_os("OCTANT_WRITE_FIXTURES").is_some() {
        std::fs::write(path, &text).unwrap_or_else(|error| panic!("write {path}: {error}"));
        return;
    }
    let stored =
        std::fs::read_to_string(path).unwrap_or_else(|error| panic!("read {path}: {error}"));
    let differs = stored.lines().zip(text.lines()).find(|(stored, found)| stored != found);
    assert!(
        differs.is_none() && stored.len() == text.len(),
        "the layout of a state is not that of {path}: first difference {differs:?}. Raise its \
         version, and run the test once with OCTANT_WRITE_FIXTURES set"
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_and_not_values_are_told() {
        #[derive(Serialize)]
        enum Choice {
            A { b: f64 },
            C,
        }
        #[derive(Serialize)]
        struct Leaf {
            three: [f64; 3],
            pair: (u8, f64, f64),
            choice: Choice,
            other: Choice,
            nothing: Option<u8>,
        }
        let json = |leaf: &Leaf| kinds(&serde_json::to_string(leaf).unwrap());
        let mut leaf = Leaf {
            three: [1.0, -2e-9, 3.5],
            pair: (1, -2.0, 0.5),
            choice: Choice::A { b: 1e300 },
            other: Choice::C,
            nothing: None,
        };
        let told = r#"{"three":[real x 3],"pair":[int,real x 2],"choice":{"A":{"b":real}},"other":text,"nothing":null}"#;
        assert_eq!(json(&leaf), told);
        leaf.three = [0.0, 1e-12, -1.0];
        leaf.pair = (9, 7.0, 1.0);
        assert_eq!(json(&leaf), told);
    }
}
