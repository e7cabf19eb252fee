//! Text from outside, without what acts on a terminal or breaks a file.
//!
//! Names come from files, devices, other programs and file systems. Whatever shows such a text, on a terminal, in HTML,
//! in XML or in another file, shows it through [`printable`].

use std::borrow::Cow;

/// Escapes the characters of a text that act instead of being shown, as JSON does (`\u001b`).
///
/// These are control characters except line breaks and tabs, characters that turn the direction of text around, and the two
/// that no XML may contain (U+FFFE and U+FFFF).
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
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

/// Returns whether a character acts instead of being shown.
#[must_use]
pub fn is_bad(c: char) -> bool {
    let turns = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || matches!(c, '\u{fffe}' | '\u{ffff}') || (c.is_control() && !"\n\t".contains(c))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_is_escaped_and_what_is_shown_stays() {
        for plain in ["", "a plain text", "two\nlines\tand a tab", "Größe ≤ 3 µg, 深さ, שלום"]
        {
            assert!(matches!(printable(plain), Cow::Borrowed(same) if same == plain));
        }
        for (text, expected) in [
            ("\u{1b}[2J", "\\u001b[2J"),
            ("a\rb\0c\u{7}", "a\\u000db\\u0000c\\u0007"),
            ("\u{9b}31m\u{7f}", "\\u009b31m\\u007f"),
            ("\u{202e}txt.exe\u{2069}", "\\u202etxt.exe\\u2069"),
            ("\u{ffff}", "\\uffff"),
        ] {
            assert_eq!(printable(text), expected);
        }
    }
}
