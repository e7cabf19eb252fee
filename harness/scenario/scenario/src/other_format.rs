//! Files of another format than the one that a command reads: a scenario given as a campaign, and the
//! like.

use super::error::{FileProblems, Place, Problem};
use super::keys::{CampaignKeys, Keys, SCENARIO, Section, SuiteKeys};
use octant_toml_tree::Table;

/// Formats that a user can confuse: name, keys of the root, and the command that takes such a file.
fn formats() -> [(&'static str, &'static Section, &'static str); 3] {
    [
        (
            "a scenario",
            SCENARIO,
            "octant run FILE runs it, and a campaign names it in [[scenarios]]",
        ),
        ("a campaign", CampaignKeys::SECTION, "octant campaign plan FILE plans it"),
        ("a suite", SuiteKeys::SECTION, "octant nightly --suite FILE runs it"),
    ]
}

/// Refuses a text whose root keys are all those of another format, and not all of this one:
/// `expected` is its name in the list above.
///
/// # Errors
/// One problem that names both formats and the command to use.
pub(crate) fn refuse(text: &str, file: &str, expected: &str) -> Result<(), FileProblems> {
    // A text that isn't TOML is reported by the reader of the format.
    let Ok(document) = octant_toml_tree::parse(text) else { return Ok(()) };
    let Some((found, command)) = other(&document, expected) else { return Ok(()) };
    let command = command.replace("FILE", file);
    let problem = Problem {
        place: Place::Default,
        path: String::new(),
        message: format!("found {found}, expected {expected}: {command}"),
    };
    Err(FileProblems { file: file.to_owned(), problems: vec![problem] })
}

/// Name and command of the other format that a document has.
fn other(document: &Table, expected: &str) -> Option<(&'static str, &'static str)> {
    let keys = || document.entries.iter().map(|entry| entry.key.as_str());
    let fits = |section: &Section| keys().all(|key| section.key(key).is_some());
    let mut fitting = formats().into_iter().filter(|(_, section, _)| fits(section));
    let found = fitting.next()?;
    // An incomplete file may fit several formats.
    let is_expected = found.0 == expected || fitting.any(|(name, ..)| name == expected);
    (!is_expected).then_some((found.0, found.2))
}
