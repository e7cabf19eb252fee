//! CAN databases (DBC files).

use super::DbcProblem;
use can_dbc::{Dbc, DbcError, Message, MessageId, Signal, SignalExtendedValueType};
use std::format;
use std::string::{String, ToString};

/// A parsed DBC file.
#[derive(Clone, Debug)]
pub struct Database {
    pub(super) file: String,
    pub(super) dbc: Dbc,
    text: String,
}

impl Database {
    /// Parses a database; `file` is its name in messages.
    ///
    /// # Errors
    /// If the text is no database, with file and line.
    pub fn parse(file: &str, text: &str) -> Result<Self, DbcProblem> {
        let dbc = Dbc::try_from(text).map_err(|error| {
            let (line, what) = said(&error, text);
            let place = line.map_or_else(|| file.into(), |line| format!("{file}:{line}"));
            DbcProblem { place, what: format!("this is no DBC: {what}") }
        })?;
        Ok(Self { file: file.into(), dbc, text: text.into() })
    }

    /// File and line of a message, or of one of its signals.
    pub(super) fn place(&self, message: &Message, signal: Option<&str>) -> String {
        let id = message.id.raw().to_string();
        let mut inside = false;
        for (number, line) in (1..).zip(self.text.lines()) {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("BO_") => {
                    inside = words.next() == Some(&id);
                    if inside && signal.is_none() {
                        return format!("{}:{number}", self.file);
                    }
                }
                Some("SG_") if inside => {
                    let name = words.next().map(|name| name.trim_end_matches(':'));
                    if name == signal {
                        return format!("{}:{number}", self.file);
                    }
                }
                _ => {}
            }
        }
        self.file.clone()
    }

    /// Type of a signal's bits: an IEEE float of 32 or 64 bits, or an integer.
    pub(super) fn value_type(&self, id: MessageId, signal: &Signal) -> SignalExtendedValueType {
        self.dbc
            .signal_extended_value_type_list
            .iter()
            .find(|entry| entry.message_id == id && entry.signal_name == signal.name)
            .map_or(SignalExtendedValueType::SignedOrUnsignedInteger, |entry| {
                entry.signal_extended_value_type
            })
    }
}

/// Line and text of an error.
fn said(error: &DbcError, text: &str) -> (Option<usize>, String) {
    let words = error.to_string();
    if matches!(error, DbcError::Pest(_)) {
        // The parser's text has ` --> line:column`, the line itself, a mark, and ` = what`.
        let line = words
            .split_once("-->")
            .and_then(|(_, rest)| rest.trim_start().split(':').next()?.parse().ok());
        let what = words.rsplit_once("= ").map_or(words.as_str(), |(_, what)| what);
        return (line, what.trim().to_string());
    }
    // A value out of range is quoted in the text, and its line is found in the file.
    let line = words.split('\'').nth(1).and_then(|value| {
        text.lines().position(|line| !value.is_empty() && line.contains(value)).map(|at| at + 1)
    });
    (line, words)
}
