//! Text from outside, such that a terminal shows it and doesn't obey it.

use std::borrow::Cow;

/// Escapes the control characters of a text, except line breaks and tabs, so that the terminal
/// doesn't obey them. Names come from files, devices and file systems.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_bad = |c: char| turns(c) || (c.is_control() && !"\n\t".contains(c));
    if !text.contains(is_bad) {
        return text.into();
    }
    let mut all = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_bad(c) {
            // In the form of JSON, because results may be JSON.
            all += &format!("\\u{:04x}", u32::from(c));
        } else {
            all.push(c);
        }
    }
    all.into()
}
