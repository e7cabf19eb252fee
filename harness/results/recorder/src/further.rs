//! Further topics of a recording, for other tools, made on the recorder's thread from what it writes.
//!
//! The recorder knows neither their content nor their meaning: a [`Publisher`] makes them from the
//! messages of the recording. Readers of recordings pass over them.

use super::item::Item;
use std::sync::Arc;

/// Channel of further messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FurtherChannel {
    /// Topic; none of the recorder's own.
    pub topic: &'static str,
    /// Name of the schema.
    pub schema_name: &'static str,
    /// Encoding of the schema.
    pub schema_encoding: &'static str,
    /// The schema.
    pub schema: String,
    /// Encoding of the messages.
    pub message_encoding: &'static str,
}

/// Messages that a publisher has made, in order. The buffers keep their memory.
#[derive(Debug, Default)]
pub struct FurtherMessages {
    bytes: Vec<u8>,
    /// Channel and end of each message.
    ends: Vec<(usize, usize)>,
}

impl FurtherMessages {
    /// Adds a message on a channel, by its number: `write` appends its bytes.
    pub fn add(&mut self, channel: usize, write: impl FnOnce(&mut Vec<u8>)) {
        write(&mut self.bytes);
        self.ends.push((channel, self.bytes.len()));
    }

    /// Messages with the numbers of their channels.
    pub fn iter(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let mut start = 0;
        self.ends.iter().map(move |(channel, end)| {
            let message = self.bytes.get(start..*end).unwrap_or_default();
            start = *end;
            (*channel, message)
        })
    }

    /// True if there is no message.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Removes all messages.
    pub fn clear(&mut self) {
        self.bytes.clear();
        self.ends.clear();
    }
}

/// Makes further messages from the messages of a recording.
pub trait Publisher: Send {
    /// Channels; a message names its channel by the place in this list.
    fn channels(&self) -> Vec<FurtherChannel>;

    /// Makes the messages at the beginning of the run.
    fn begin(&mut self, messages: &mut FurtherMessages);

    /// Takes a message of the recording with its log time, in the order of the file. `is_due` tells
    /// whether the epoch of the message is one for which messages are wanted; events are always.
    fn take(&mut self, time_ns: u64, item: &Item, is_due: bool, messages: &mut FurtherMessages);

    /// Makes the messages that need the whole epoch: its last message was taken.
    fn end_epoch(&mut self, is_due: bool, messages: &mut FurtherMessages);
}

/// Makes the publisher of a recording, and tells how often it is due.
#[derive(Clone)]
pub struct Publishing {
    /// Shortest time between two epochs that are due, ns; epochs in which the mode changes are due too.
    pub period_ns: u64,
    make: Arc<dyn Fn() -> Box<dyn Publisher> + Send + Sync>,
}

impl Publishing {
    /// Publishes with what `make` makes.
    pub fn new(
        period_ns: u64,
        make: impl Fn() -> Box<dyn Publisher> + Send + Sync + 'static,
    ) -> Self {
        Self { period_ns, make: Arc::new(make) }
    }

    /// Makes a publisher.
    #[must_use]
    pub fn publisher(&self) -> Box<dyn Publisher> {
        (self.make)()
    }
}

impl std::fmt::Debug for Publishing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Publishing").field("period_ns", &self.period_ns).finish_non_exhaustive()
    }
}
