//! Further topics in the file: when they are due, and their messages on their channels.

use super::further::{FurtherMessages, Publisher, Publishing};
use super::item::Item;
use super::sink::Container;
use mcap::records::MessageHeader;
use std::collections::BTreeMap;
use std::io::Write;

/// Further topics of a file.
pub(super) struct Published {
    publisher: Box<dyn Publisher>,
    channels: Vec<u16>,
    messages: FurtherMessages,
    period_ns: u64,
    next_ns: u64,
    /// True if messages of the present epoch are wanted.
    is_due: bool,
    /// True if messages of the present epoch were taken.
    is_open: bool,
}

impl Published {
    /// Adds the channels to a file, and makes the first messages.
    pub(super) fn begin<W: Write>(
        publishing: &Publishing,
        mcap: &mut Container<W>,
    ) -> Result<Self, mcap::McapError> {
        let mut publisher = publishing.publisher();
        let mut channels = Vec::new();
        for channel in publisher.channels() {
            let (name, encoding) = (channel.schema_name, channel.schema_encoding);
            let schema = mcap.add_schema(name, encoding, channel.schema.as_bytes())?;
            let (topic, encoding) = (channel.topic, channel.message_encoding);
            channels.push(mcap.add_channel(schema, topic, encoding, &BTreeMap::new())?);
        }
        let mut messages = FurtherMessages::default();
        publisher.begin(&mut messages);
        Ok(Self {
            publisher,
            channels,
            messages,
            period_ns: publishing.period_ns,
            next_ns: 0,
            is_due: false,
            is_open: false,
        })
    }

    /// Decides whether messages of an epoch are wanted that the recording keeps.
    pub(super) fn decide(&mut self, time_ns: u64, on_grid: bool, changes_mode: bool) {
        self.is_due = changes_mode || (on_grid && time_ns >= self.next_ns);
        if self.is_due {
            self.next_ns = next_on_grid(time_ns, self.period_ns);
        }
    }

    /// Wants what is left at the end of the run.
    pub(super) fn decide_last(&mut self) {
        self.is_due = true;
    }

    /// True if messages of the present epoch are wanted.
    pub(super) fn is_due(&self) -> bool {
        self.is_due
    }

    /// Takes a message of the recording.
    pub(super) fn take(&mut self, time_ns: u64, item: &Item) {
        self.is_open = true;
        self.publisher.take(time_ns, item, self.is_due, &mut self.messages);
    }

    /// Ends the present epoch.
    pub(super) fn end_epoch(&mut self) {
        if std::mem::take(&mut self.is_open) {
            self.publisher.end_epoch(self.is_due, &mut self.messages);
        }
        self.is_due = false;
    }

    /// Writes the messages with the stamps of a header. Returns whether there were any.
    pub(super) fn put<W: Write>(
        &mut self,
        mcap: &mut Container<W>,
        header: MessageHeader,
    ) -> Result<bool, mcap::McapError> {
        let is_empty = self.messages.is_empty();
        let channels = &self.channels;
        let written = self.messages.iter().try_for_each(|(channel, message)| {
            let header = MessageHeader { channel_id: channels[channel], ..header };
            mcap.write_to_known_channel(&header, message)
        });
        self.messages.clear();
        written.map(|()| !is_empty)
    }
}

/// First multiple of the period after a time.
pub(super) fn next_on_grid(time_ns: u64, period_ns: u64) -> u64 {
    let period_ns = period_ns.max(1);
    (time_ns / period_ns).saturating_add(1).saturating_mul(period_ns)
}
