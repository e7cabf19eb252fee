//! Messages that an FMU logs.
#![allow(unsafe_code, reason = "C strings of the FMU are read, and C calls back")]

use super::super::description::{Description, Standard};
use octant_fmi::{fmi2, fmi3};
use serde::{Deserialize, Serialize};
use std::ffi::{CStr, c_char, c_int, c_void};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};

/// Largest number of messages held until they are read; further ones are counted.
const MESSAGES_MAX: usize = 1000;

/// Largest length of a message, bytes.
const TEXT_MAX: usize = 65536;

/// One message of an FMU.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FmuMessage {
    /// Severity: `ok`, `warning`, `discard`, `error`, `fatal`.
    pub status: String,
    /// Category, normally one of the description's.
    pub category: String,
    /// Text of the message.
    pub text: String,
}

/// Category of warnings of this program.
const HOST: &str = "octant";

impl FmuMessage {
    /// Returns whether it is a warning of this program about the FMU.
    #[must_use]
    pub fn is_of_host(&self) -> bool {
        self.category == HOST
    }
}

impl fmt::Display for FmuMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}] {}: {}", self.status, self.category, self.text)
    }
}

/// Name of a status, the same in both standards.
pub(super) fn status_name(status: i32) -> &'static str {
    match status {
        fmi2::OK => "ok",
        fmi2::WARNING => "warning",
        fmi2::DISCARD => "discard",
        fmi2::ERROR => "error",
        fmi2::FATAL => "fatal",
        fmi2::PENDING => "pending",
        _ => "a status that the standard doesn't have",
    }
}

/// Log of one instance, to which its callbacks write. The callback of FMI 2.0 finds `take` at its
/// beginning.
#[repr(C)]
pub(super) struct Log {
    take: unsafe extern "C" fn(*const Log, c_int, *const c_char, *const c_char),
    said: Mutex<Said>,
}

#[derive(Default)]
struct Said {
    messages: Vec<FmuMessage>,
    dropped: u64,
}

impl Log {
    pub(super) fn new() -> Arc<Self> {
        Arc::new(Self { take, said: Mutex::default() })
    }

    /// Removes and returns all messages.
    pub(super) fn drain(&self, description: &Description) -> Vec<FmuMessage> {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let mut messages = std::mem::take(&mut said.messages);
        let dropped = std::mem::take(&mut said.dropped);
        drop(said);
        for message in &mut messages {
            message.text = with_names(&message.text, description);
        }
        if dropped > 0 {
            messages.push(FmuMessage {
                status: "warning".into(),
                category: HOST.into(),
                text: format!("{dropped} more messages were dropped"),
            });
        }
        messages
    }

    /// Last message that indicates a failure, in one line after a colon; empty if there is none.
    pub(super) fn last(&self, description: &Description) -> String {
        let said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        let is_failure = |message: &&FmuMessage| message.status != "ok" && !message.is_of_host();
        let last = said.messages.iter().rev().find(is_failure);
        last.map_or(String::new(), |message| {
            format!(": {}", with_names(message.text.trim(), description))
        })
    }

    /// Adds a warning of this program.
    pub(super) fn note(&self, text: &str) {
        self.push(fmi2::WARNING, HOST.into(), text.replace('#', "##"));
    }

    fn push(&self, status: i32, category: String, text: String) {
        let mut said = self.said.lock().unwrap_or_else(PoisonError::into_inner);
        if said.messages.len() < MESSAGES_MAX {
            said.messages.push(FmuMessage { status: status_name(status).into(), category, text });
        } else {
            said.dropped += 1;
        }
    }
}

/// Reads a text of the FMU, which needn't be UTF-8; null is empty.
///
/// # Safety
/// The pointer is null or points to a text that ends with a null byte.
pub(super) unsafe fn text(text: *const c_char, bytes_max: usize) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller vouches for it.
    let bytes = unsafe { CStr::from_ptr(text) }.to_bytes();
    String::from_utf8_lossy(&bytes[..bytes.len().min(bytes_max)]).into_owned()
}

/// Takes a message of the callback of FMI 2.0.
unsafe extern "C" fn take(
    log: *const Log,
    status: c_int,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the environment is the log of an instance, which outlives the instance; the texts are
    // the FMU's, alive during the call.
    let (log, category, message) =
        unsafe { (&*log, text(category, TEXT_MAX), text(message, TEXT_MAX)) };
    log.push(status, category, message);
}

/// Callback of FMI 3.0.
pub(super) unsafe extern "C" fn log_message(
    environment: fmi3::Environment,
    status: fmi3::Status,
    category: fmi3::String,
    message: fmi3::String,
) {
    let log: *const Log = environment.cast();
    if !log.is_null() {
        // SAFETY: as the environment only a log is given, and it outlives the instance.
        unsafe { take(log, status, category, message) };
    }
}

unsafe extern "C" {
    fn octant_fmi2_logger(
        environment: fmi2::Environment,
        instance: fmi2::String,
        status: fmi2::Status,
        category: fmi2::String,
        message: fmi2::String,
        ...
    );
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(memory: *mut c_void);
}

/// Callbacks of an instance of FMI 2.0, with its log as the environment.
pub(super) fn callbacks(log: &Arc<Log>) -> fmi2::CallbackFunctions {
    fmi2::CallbackFunctions {
        logger: Some(octant_fmi2_logger),
        allocate_memory: Some(calloc),
        free_memory: Some(free),
        // Null: the host polls whether a pending step is finished.
        step_finished: None,
        environment: Arc::as_ptr(log).cast_mut().cast(),
    }
}

/// Replaces `#r12#` (FMI 2.0) and `#12#` (FMI 3.0) by names of variables, and `##` by `#`.
fn with_names(text: &str, description: &Description) -> String {
    if !text.contains('#') {
        return text.into();
    }
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find('#') {
        out.push_str(&rest[..start]);
        rest = &rest[start + 1..];
        let end = rest.find('#');
        let name = match end {
            Some(0) => Some("#".into()),
            Some(end) => name_of(&rest[..end], description),
            None => None,
        };
        if let (Some(end), Some(name)) = (end, name) {
            out.push_str(&name);
            rest = &rest[end + 1..];
        } else {
            out.push('#');
        }
    }
    out.push_str(rest);
    out
}

/// Finds the variable for a reference in a message.
fn name_of(reference: &str, description: &Description) -> Option<String> {
    use super::super::description::VariableType;
    let (kinds, number): (&[VariableType], &str) = match description.standard {
        Standard::Fmi3 => (&[], reference),
        Standard::Fmi2 => match reference.split_at_checked(1)? {
            ("r", number) => (&[VariableType::Float64], number),
            ("i", number) => (&[VariableType::Int32, VariableType::Enumeration], number),
            ("b", number) => (&[VariableType::Boolean], number),
            ("s", number) => (&[VariableType::String], number),
            _ => return None,
        },
    };
    let number: u32 = number.parse().ok()?;
    description
        .variables
        .iter()
        .find(|variable| {
            variable.reference == number && (kinds.is_empty() || kinds.contains(&variable.kind))
        })
        .map(|variable| variable.name.clone())
}
