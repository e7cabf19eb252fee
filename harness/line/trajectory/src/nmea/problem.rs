//! Reasons why a file of sentences can't be read as it is asked for.

/// A reason: place, what was found, what was expected.
#[derive(Debug, thiserror::Error)]
pub(crate) enum NmeaProblem {
    /// The file can't be read.
    #[error("{}{error}", place(*line))]
    File {
        /// The line; `None`: the file as a whole.
        line: Option<u64>,
        /// Error of the operating system.
        error: std::io::Error,
    },
    /// Something else is there.
    #[error("{}found {found}, expected {expected}", place(*line))]
    Found {
        /// The line; `None`: the file as a whole.
        line: Option<u64>,
        /// Found text.
        found: String,
        /// Expected text.
        expected: String,
    },
    /// Two instruments, or two sentences of one, contradict each other.
    #[error("{}{what}, expected {expected}", place(*line))]
    Contradiction {
        /// The line of the second one.
        line: Option<u64>,
        /// Statements by who makes them.
        what: String,
        /// Expected text.
        expected: String,
    },
    /// There is nothing to read.
    #[error(
        "found no sentence of NMEA 0183 with a position, a speed or an attitude, and a right checksum"
    )]
    Nothing,
}

fn place(line: Option<u64>) -> String {
    line.map_or_else(String::new, |line| format!("line {line}: "))
}

impl NmeaProblem {
    pub(super) fn found(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Found { line: None, found: found.into(), expected: expected.into() }
    }

    /// The problem with its line.
    pub(super) fn at(mut self, number: u64) -> Self {
        match &mut self {
            Self::File { line, .. }
            | Self::Found { line, .. }
            | Self::Contradiction { line, .. } => {
                *line = Some(number);
            }
            Self::Nothing => {}
        }
        self
    }
}
