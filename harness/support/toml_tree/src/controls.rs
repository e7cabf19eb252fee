//! Control characters in texts and keys.

use crate::error::{Place, Problem};
use crate::tree::{Node, Table, Value};

/// Keys whose texts are names, which have one line.
const NAMES: [&str; 6] = ["title", "id", "name", "label", "serial", "certificate"];

/// Finds control characters in texts and keys, which a terminal would execute and other file formats
/// can't hold. A text that isn't a name may have line breaks and tabs.
pub(crate) fn controls(table: &Table, path: &str) -> Vec<Problem> {
    let mut found = Vec::new();
    for entry in &table.entries {
        let path =
            if path.is_empty() { entry.key.clone() } else { format!("{path}.{}", entry.key) };
        if let Some(c) = control(&entry.key, true) {
            found.push(problem_of(c, &entry.place, path.escape_debug().to_string()));
        } else {
            controls_of(&entry.node, &path, NAMES.contains(&entry.key.as_str()), &mut found);
        }
    }
    found
}

fn controls_of(node: &Node, path: &str, is_name: bool, found: &mut Vec<Problem>) {
    match &node.value {
        Value::Text(text) => {
            let c = control(text, is_name);
            found.extend(c.map(|c| problem_of(c, &node.place, path.to_owned())));
        }
        Value::Array(entries) => {
            entries.iter().for_each(|entry| controls_of(entry, path, is_name, found));
        }
        Value::Table(table) => found.extend(controls(table, path)),
        _ => {}
    }
}

fn problem_of(c: char, place: &Place, path: String) -> Problem {
    let message = format!("found the control character {:?}, expected text that can be printed", c);
    Problem { place: place.clone(), path, message }
}

/// First control character of a text.
fn control(text: &str, is_name: bool) -> Option<char> {
    // Characters that reverse the direction of text can hide text around them.
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_bad = |c: char| turns(c) || (c.is_control() && (is_name || !"\n\r\t".contains(c)));
    text.chars().find(|c| is_bad(*c))
}

/// First problem of a control character in the value of an argument.
pub fn controls_of_argument(path: &str, node: &Node) -> Option<Problem> {
    let mut found = Vec::new();
    let name = path.rsplit('.').next().unwrap_or(path);
    controls_of(node, &path.escape_debug().to_string(), NAMES.contains(&name), &mut found);
    found.into_iter().next()
}
