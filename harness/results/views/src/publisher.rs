//! Topics of a run in its own recording.

use super::about::About;
use super::published::{PublishedChannel, faults, messages};
use super::ros_published;
use super::standard::{StandardEpochs, StandardTopic};
use super::state::RunState;
use octant_recorder::further::{FurtherChannel, FurtherMessages, Publisher, Publishing};
use octant_recorder::reader::Item;
use serde_json::Value;

/// Makes the topics for other tools from the messages of a recording: standard messages of ROS 2, then
/// those of a live run.
pub struct RunTopics {
    state: RunState,
    encoding: RunEncoding,
    standard: Vec<StandardTopic>,
    epochs: StandardEpochs,
    /// Log time of the last message that was taken, ns.
    time_ns: u64,
}

/// Encoding of the messages of a live run. The standard messages are CDR in either.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEncoding {
    /// JSON with a schema.
    Json,
    /// CDR, as every message of a bag of ROS 2 has to be.
    Cdr,
}

impl RunTopics {
    /// Makes them for a run, with these standard topics.
    #[must_use]
    pub fn new(about: About, standard: &[StandardTopic], encoding: RunEncoding) -> Self {
        let epochs = StandardEpochs::new(standard, 0, about.sample_period_ns);
        Self {
            state: RunState::new(about),
            encoding,
            standard: standard.to_owned(),
            epochs,
            time_ns: 0,
        }
    }

    /// Adds a message of a live run.
    fn add(&self, channel: PublishedChannel, message: &Value, to: &mut FurtherMessages) {
        // Neither a value of JSON nor a buffer in memory can fail to be written.
        to.add(self.standard.len() + channel as usize, |bytes| match self.encoding {
            RunEncoding::Json => drop(serde_json::to_writer(bytes, message)),
            RunEncoding::Cdr => ros_published::write(channel, self.time_ns, message, bytes),
        });
    }
}

impl Publisher for RunTopics {
    fn channels(&self) -> Vec<FurtherChannel> {
        let standard = self.standard.iter().map(|topic| topic.channel());
        let own = match self.encoding {
            RunEncoding::Json => PublishedChannel::ALL.map(PublishedChannel::channel),
            RunEncoding::Cdr => PublishedChannel::ALL.map(ros_published::ros_channel),
        };
        standard.chain(own).collect()
    }

    fn begin(&mut self, to: &mut FurtherMessages) {
        self.add(PublishedChannel::Faults, &faults(&self.state), to);
    }

    fn take(&mut self, time_ns: u64, item: &Item, is_due: bool, to: &mut FurtherMessages) {
        self.time_ns = time_ns;
        self.state.take(time_ns, item);
        self.epochs.take(time_ns, item);
        if is_due || matches!(item, Item::Event(_)) {
            messages(&self.state, item, |channel, message| self.add(channel, &message, to));
        }
    }

    fn end_epoch(&mut self, is_due: bool, to: &mut FurtherMessages) {
        self.epochs.end(is_due, to);
    }
}

/// Publishes a run in its own recording, no more often than with this period, ns.
#[must_use]
pub fn publishing(about: About, period_ns: u64) -> Publishing {
    Publishing::new(period_ns, move || {
        Box::new(RunTopics::new(about.clone(), &StandardTopic::BRIEF, RunEncoding::Json))
    })
}
