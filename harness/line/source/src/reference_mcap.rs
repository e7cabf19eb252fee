//! A recorded reference in the messages on a topic of an MCAP file.

use super::SourceError;
use super::messages::TopicMessages;
use octant_scenario::reference::ReferenceFields;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Streams the messages of a reference.
pub(super) struct ReferenceMcap {
    path: String,
    messages: TopicMessages<BufReader<File>>,
}

impl ReferenceMcap {
    /// Opens the file of a reference, whose name is expanded to `path`.
    pub(super) fn open(path: &Path, reference: &ReferenceFields) -> Result<Self, SourceError> {
        let name = path.display().to_string();
        let fail = |reason: String| SourceError::Read { path: name.clone(), reason };
        let file = File::open(path).map_err(|error| fail(error.to_string()))?;
        let ReferenceFields { topic, fields, stamp, .. } = reference;
        let fields = fields.iter().map(String::as_str);
        let messages = TopicMessages::new(BufReader::new(file), topic, fields, stamp);
        Ok(Self { messages: messages.map_err(fail)?, path: name })
    }

    /// Returns stamp, ns, and numbers of the next reference; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<(u64, [f64; 3])>, SourceError> {
        let message = self.messages.next().map_err(|reason| self.error_of_file(reason))?;
        let Some(message) = message else { return Ok(None) };
        let mut values = [0.0; 3];
        for (index, (value, number)) in values.iter_mut().zip(&message.numbers).enumerate() {
            *value = number.real();
            if !value.is_finite() {
                let path = self.messages.path(index);
                return Err(
                    self.error(format!("field {path} is {value}, expected a finite number"))
                );
            }
        }
        Ok(Some((message.time_ns, values)))
    }

    /// The file.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Makes an error of the last message.
    pub(super) fn error(&self, reason: String) -> SourceError {
        self.error_of_file(self.messages.in_message(&reason))
    }

    /// Makes an error of the file as a whole.
    pub(super) fn error_of_file(&self, reason: String) -> SourceError {
        SourceError::Read { path: self.path.clone(), reason }
    }
}
