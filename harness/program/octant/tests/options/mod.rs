//! Every option of every command acts or is refused, and this is shown.
//!
//! The command line describes itself: the test walks it, hidden commands and options too, and looks for a row of each
//! option in the tables of this module. An option without a row fails, and so does a row of an option that isn't there.
//!
//! A new option needs a row in the table of its command, `(COMMAND, OPTION, &[EVIDENCE, ...])`:
//!
//! ```text
//! ("run", "--require", &[Acts("run ../short.toml [--require]", "exit status 3")]),
//! ```
//!
//! - [`Evidence::Acts`]: the line is run twice, with the part in brackets and without it. The text is in what the first
//!   one prints or writes, and not in what the second one does.
//! - [`Evidence::Read`]: the line is refused with exit status 2 and these words, because what the option says can't be.
//! - [`Evidence::Refused`]: the same, and the refusal names the option; for a way of the command that can't obey it.
//! - [`Evidence::Tested`]: a test of this program shows it, `module::function`; the function has to mention the option.
//!
//! Lines run in a folder of their own beside the files of [`bench::Bench`].

mod bench;
mod campaigns;
mod fmus;
mod parsed;
mod runs;
mod sources;
mod tools;

use bench::Bench;
use clap::Command;
use std::collections::BTreeMap;

/// How an option is shown to act or to be refused.
enum Evidence {
    /// Line with the option in brackets, and what is there with it alone.
    Acts(&'static str, &'static str),
    /// Line with a value of the option that can't be, and words of the refusal.
    Read(&'static str, &'static str),
    /// Line with the option, and words of the refusal, which names it.
    Refused(&'static str, &'static str),
    /// Test that shows it.
    Tested(&'static str),
}

/// Command without the program's name, option, evidence.
type Row = (&'static str, &'static str, &'static [Evidence]);

/// Returns the rows of all tables.
fn rows() -> impl Iterator<Item = &'static Row> {
    [runs::ROWS, campaigns::ROWS, fmus::ROWS, tools::ROWS].into_iter().flatten()
}

/// Lists the options of a command and of its subcommands: command and option.
fn options(command: &Command, path: &str, all: &mut Vec<(String, String)>) {
    for option in command.get_arguments() {
        if let Some(name) = option.get_long() {
            all.push((path.to_owned(), format!("--{name}")));
        }
    }
    for subcommand in command.get_subcommands() {
        let path = format!("{path} {}", subcommand.get_name());
        options(subcommand, path.trim_start(), all);
    }
}

#[test]
fn every_option_has_a_row_and_every_row_an_option() {
    let mut all = Vec::new();
    options(&octant::command_line(), "", &mut all);
    let mut open: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    for (command, option, evidence) in rows() {
        assert!(!evidence.is_empty(), "octant {command} {option}: a row without evidence");
        *open.entry((*command, *option)).or_default() += 1;
    }
    let missing = all.iter().filter(|(command, option)| {
        open.remove(&(command.as_str(), option.as_str())).is_none_or(|count| count != 1)
    });
    let missing: Vec<String> =
        missing.map(|(command, option)| format!("octant {command} {option}")).collect();
    assert!(missing.is_empty(), "options without one row of their own: {missing:#?}");
    assert!(open.is_empty(), "rows of options that aren't there: {open:#?}");
}

#[test]
fn every_line_shows_what_its_row_says() {
    let bench = Bench::new();
    let lines = rows()
        .flat_map(|(_, option, evidence)| evidence.iter().map(move |evidence| (*option, evidence)));
    let failed: Vec<String> =
        lines.filter_map(|(option, evidence)| bench.failure(option, evidence)).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n\n"));
}

#[test]
fn every_named_test_is_there_and_mentions_its_option() {
    for (command, option, evidence) in rows() {
        for evidence in *evidence {
            let Evidence::Tested(test) = evidence else { continue };
            let body = sources::test_body(test)
                .unwrap_or_else(|| panic!("octant {command} {option}: found no test {test}"));
            assert!(
                sources::mentions(&body, option),
                "octant {command} {option}: {test} doesn't mention it"
            );
        }
    }
}
