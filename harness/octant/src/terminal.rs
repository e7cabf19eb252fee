//! Results on stdout, notes on stderr, and files that are written whole.

use crate::failure::Failure;

/// Prints a line on stderr, with control characters escaped so that the terminal doesn't obey them.
macro_rules! note {
    ($($words:tt)*) => { eprintln!("{}", $crate::terminal::printable(&format!($($words)*))) };
}

pub(crate) use note;

/// Escapes the control characters of a text, except line breaks and tabs, so that the terminal
/// doesn't obey them. Names come from files, devices and file systems.
pub(crate) fn printable(text: &str) -> std::borrow::Cow<'_, str> {
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

/// Writes a result to stdout. A reader that has gone (`| head`) is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    match std::io::stdout().write_all(printable(text).as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::bench(format!("failed to write to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// Writes a file whole or not at all, if the path is a regular file or doesn't exist yet.
pub(crate) fn write(path: &std::path::Path, contents: impl AsRef<[u8]>) -> Result<(), Failure> {
    let is_other = std::fs::symlink_metadata(path).is_ok_and(|there| !there.is_file());
    let written = if is_other {
        std::fs::write(path, contents)
    } else {
        octant_campaign::keep(path, contents.as_ref())
    };
    written.map_err(|error| Failure::bench(format!("failed to write {}: {error}", path.display())))
}

/// Prints one JSON value and a newline on stdout.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::bench(format!("failed to write the result as JSON: {error}")))?;
    print(&(text + "\n"))
}
