//! Lines of a file with sentences and other bytes.

use super::problem::NmeaProblem;
use crate::point::LINE_BYTES_MAX;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Seek};

/// Lines of a file with sentences.
pub(super) struct NmeaLines {
    file: BufReader<File>,
    pub(super) text: String,
    pub(super) line: u64,
    bytes: Vec<u8>,
}

impl NmeaLines {
    pub(super) fn new(file: File) -> Self {
        let file = BufReader::with_capacity(1 << 16, file);
        Self { file, text: String::new(), line: 0, bytes: Vec::new() }
    }

    /// Begins the file again.
    pub(super) fn again(self) -> Result<Self, NmeaProblem> {
        let mut file = self.file.into_inner();
        file.rewind().map_err(|error| NmeaProblem::File { line: None, error })?;
        Ok(Self::new(file))
    }

    pub(super) fn into_file(self) -> File {
        self.file.into_inner()
    }

    /// Reads the next line; `false` at the end. Loggers mix in bytes that aren't text.
    pub(super) fn advance(&mut self) -> Result<bool, NmeaProblem> {
        self.bytes.clear();
        self.line += 1;
        let read = (&mut self.file).take(LINE_BYTES_MAX).read_until(b'\n', &mut self.bytes);
        let line = Some(self.line);
        let read = read.map_err(|error| NmeaProblem::File { line, error })?;
        self.text.clear();
        self.text.push_str(&String::from_utf8_lossy(&self.bytes));
        Ok(read > 0)
    }
}
