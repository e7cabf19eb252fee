//! Messages to the importer.
//!
//! Messages are collected during a call and delivered at its end, so that a callback never meets an
//! instance in the middle of a call.

#![allow(unsafe_code, reason = "callbacks of the importer are called")]

use super::mode::ServedStandard;
use core::ffi::{CStr, c_void};
use octant_fmi::fmi2::{self, DISCARD, ERROR, OK, Status, WARNING};
use octant_fmi::fmi3;
use std::ffi::CString;

/// Categories of messages: name and description.
pub const CATEGORIES: [(&str, &str); 6] = [
    ("logEvents", "What happens in the model: changes of its mode."),
    ("logStatusWarning", "Calls that were answered with a warning."),
    ("logStatusDiscard", "Calls that were refused, after which the simulation can go on."),
    ("logStatusError", "Calls that failed."),
    ("logStatusFatal", "Faults of the model itself, which end its instance."),
    ("logAll", "All of them."),
];

const ALL: usize = CATEGORIES.len() - 1;

/// Category of the messages of a status.
const fn category(status: Status) -> usize {
    match status {
        OK => 0,
        WARNING => 1,
        DISCARD => 2,
        ERROR => 3,
        _ => 4,
    }
}

/// Callback of the importer, in the form of each standard.
#[derive(Clone, Copy, Debug)]
pub(super) enum Callback {
    Fmi2(fmi2::Logger),
    Fmi3(fmi3::LogMessage),
}

/// Destination of the messages of an instance.
#[derive(Clone, Debug)]
pub(super) struct Outlet {
    pub name: CString,
    pub callback: Option<Callback>,
    pub environment: *mut c_void,
}

// SAFETY: the environment is handed back to the importer's callback, and not touched. An importer
// that calls an instance from several threads has to have callbacks that stand it.
unsafe impl Send for Outlet {}

/// A message with its status.
#[derive(Clone, Debug)]
pub(super) struct Message {
    status: Status,
    text: String,
}

/// Messages of an instance, and the categories wanted.
#[derive(Debug)]
pub(super) struct Log {
    standard: ServedStandard,
    wanted: [bool; CATEGORIES.len()],
    heard: bool,
    waiting: Vec<Message>,
}

impl Log {
    pub(super) fn new(standard: ServedStandard, on: bool, heard: bool) -> Self {
        Self { standard, wanted: [on; CATEGORIES.len()], heard, waiting: Vec::new() }
    }

    /// Returns whether messages of this status are wanted.
    #[inline]
    pub(super) fn wants(&self, status: Status) -> bool {
        // FMI 2.0 switches debugging on and off, and gets warnings and errors in any case.
        let always = self.standard == ServedStandard::Fmi2 && status != OK && status != DISCARD;
        self.heard && (always || self.wanted[category(status)])
    }

    pub(super) fn say(&mut self, status: Status, text: String) {
        if self.wants(status) {
            self.waiting.push(Message { status, text });
        }
    }

    /// Says a message whatever categories are wanted: the standards' switch is for debugging.
    pub(super) fn insist(&mut self, status: Status, text: String) {
        if self.heard {
            self.waiting.push(Message { status, text });
        }
    }

    /// Switches categories; `None`: all of them. Returns the unknown ones.
    pub(super) fn switch(&mut self, on: bool, names: Option<&[String]>) -> Vec<String> {
        let Some(names) = names else {
            self.wanted = [on; CATEGORIES.len()];
            return Vec::new();
        };
        let mut unknown = Vec::new();
        if on {
            // Only the named categories are wanted.
            self.wanted = [false; CATEGORIES.len()];
        }
        for name in names {
            match CATEGORIES.iter().position(|(known, _)| known == name) {
                Some(ALL) => self.wanted = [on; CATEGORIES.len()],
                Some(known) => self.wanted[known] = on,
                None => unknown.push(name.clone()),
            }
        }
        unknown
    }

    #[inline]
    pub(super) fn is_silent(&self) -> bool {
        self.waiting.is_empty()
    }

    pub(super) fn take(&mut self) -> Vec<Message> {
        core::mem::take(&mut self.waiting)
    }
}

impl Outlet {
    /// Passes messages to the importer.
    pub(super) fn deliver(&self, messages: &[Message]) {
        let Some(callback) = self.callback else { return };
        for message in messages {
            let text = text(&message.text);
            let (name, _) = CATEGORIES[category(message.status)];
            let category = CString::new(name).unwrap_or_default();
            let (name, category, text) = (self.name.as_ptr(), category.as_ptr(), text.as_ptr());
            match callback {
                // SAFETY: the importer vouches for its callback, and the strings live until after
                // the call. A format that takes one string, so that no text is taken for a format.
                Callback::Fmi2(log) => unsafe {
                    log(self.environment, name, message.status, category, c"%s".as_ptr(), text);
                },
                // SAFETY: as above.
                Callback::Fmi3(log) => unsafe {
                    log(self.environment, message.status, category, text);
                },
            }
        }
    }

    /// Delivers the reason why there is no instance: the one message without an instance.
    pub(super) fn deliver_failure(&self, reason: String) {
        self.deliver(&[Message { status: ERROR, text: reason }]);
    }
}

/// Converts a text for importers: `#` begins a reference to a variable and is doubled, and a NUL
/// would end the text.
pub(super) fn text(text: &str) -> CString {
    let clean: String = text.trim_end().replace('\0', " ").replace('#', "##");
    CString::new(clean).unwrap_or_default()
}

/// Reads a text of an importer; `None`: a null pointer.
///
/// # Safety
/// The pointer has to be null, or lead to a string that ends with a NUL.
pub(super) unsafe fn string(pointer: *const core::ffi::c_char) -> Option<String> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: the caller's.
    let string = unsafe { CStr::from_ptr(pointer) };
    Some(string.to_string_lossy().into_owned())
}
