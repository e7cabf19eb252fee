//! Results on stdout, notes on stderr, and files that are written whole.

use crate::failure::Failure;
use octant_account::{Account, ClockAccount};
pub(crate) use octant_base::printable::printable;

/// Prints a line on stderr, with control characters escaped so that the terminal doesn't obey them.
macro_rules! note {
    ($($words:tt)*) => { eprintln!("{}", $crate::terminal::printable(&format!($($words)*))) };
}

pub(crate) use note;

/// Prints an account: a line where every unit was used as it was found and at the configured rate, else a line for each repair
/// and loss too.
pub(crate) fn tell_account(account: &Account) {
    note!("octant: {}", account.headline());
    let is_off = account.clocked().is_some_and(ClockAccount::is_off);
    if !account.is_plain() || !account.doubts().is_empty() || is_off {
        account.lines().iter().skip(1).for_each(|line| note!("octant:   {line}"));
    }
}

/// Set while a person is asked on the terminal, which then has no bar of progress.
static ASKING: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);

/// Tells whether a person is asked on the terminal.
pub(crate) fn set_asking(asking: bool) {
    ASKING.store(asking, std::sync::atomic::Ordering::Relaxed);
}

/// Returns whether a person is asked on the terminal.
pub(crate) fn is_asking() -> bool {
    ASKING.load(std::sync::atomic::Ordering::Relaxed)
}

/// Returns whether a stream shows styles: it is a terminal, and neither `NO_COLOR` nor `TERM=dumb` is set.
/// Consoles of Windows get none, because some show the codes.
pub(crate) fn shows_styles(stream: &impl std::io::IsTerminal) -> bool {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let is_dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb");
    cfg!(unix) && stream.is_terminal() && !is_set("NO_COLOR") && !is_dumb
}

/// Sets off the headings of help, where the stream shows styles.
#[must_use]
pub fn styled<'a>(help: &'a str, stream: &impl std::io::IsTerminal) -> std::borrow::Cow<'a, str> {
    if shows_styles(stream) { with_headings(help).into() } else { help.into() }
}

/// Underlines headings, and makes the word before an error red.
#[must_use]
pub fn with_headings(help: &str) -> String {
    let line = |line: &str| {
        let (text, end) = line.split_at(line.trim_end().len());
        let is_heading = !text.starts_with(' ') && text.ends_with(':');
        let (head, rest) = match text.split_once(": ") {
            Some((head @ ("Usage" | "error"), _)) => text.split_at(head.len() + 1),
            _ if is_heading => (text, ""),
            _ => return line.to_owned(),
        };
        let style = if head == "error:" { "1;31" } else { "1;4" };
        format!("\u{1b}[{style}m{head}\u{1b}[0m{rest}{end}")
    };
    help.split_inclusive('\n').map(line).collect()
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
        octant_base::whole_file::keep(path, contents.as_ref())
    };
    written.map_err(|error| Failure::bench(format!("failed to write {}: {error}", path.display())))
}

/// Prints one JSON value and a newline on stdout.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|error| Failure::bench(format!("failed to write the result as JSON: {error}")))?;
    print(&(text + "\n"))
}
