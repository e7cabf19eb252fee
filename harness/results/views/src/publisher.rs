//! Topics of a run in its own recording.

use super::about::About;
use super::published::{PublishedChannel, faults, messages};
use super::standard::{StandardEpochs, StandardTopic};
use super::state::RunState;
use octant_recorder::further::{FurtherChannel, FurtherMessages, Publisher, Publishing};
use octant_recorder::reader::Item;
use serde_json::Value;

/// Makes the topics for other tools from the messages of a recording: standard messages of ROS 2, then
/// the JSON of a live run.
pub struct RunTopics {
    state: RunState,
    standard: Vec<StandardTopic>,
    epochs: StandardEpochs,
}

impl RunTopics {
    /// Makes them for a run, with these standard topics.
    #[must_use]
    pub fn new(about: About, standard: &[StandardTopic]) -> Self {
        let epochs = StandardEpochs::new(standard, 0, about.sample_period_ns);
        Self { state: RunState::new(about), standard: standard.to_owned(), epochs }
    }
}

impl Publisher for RunTopics {
    fn channels(&self) -> Vec<FurtherChannel> {
        let standard = self.standard.iter().map(|topic| topic.channel());
        standard.chain(PublishedChannel::ALL.map(PublishedChannel::channel)).collect()
    }

    fn begin(&mut self, to: &mut FurtherMessages) {
        add(PublishedChannel::Faults, self.standard.len(), &faults(&self.state), to);
    }

    fn take(&mut self, time_ns: u64, item: &Item, is_due: bool, to: &mut FurtherMessages) {
        self.state.take(time_ns, item);
        self.epochs.take(time_ns, item);
        if is_due || matches!(item, Item::Event(_)) {
            let first = self.standard.len();
            messages(&self.state, item, |channel, message| add(channel, first, &message, to));
        }
    }

    fn end_epoch(&mut self, is_due: bool, to: &mut FurtherMessages) {
        self.epochs.end(is_due, to);
    }
}

/// Adds a message in JSON, whose channels begin with the number `first`.
fn add(channel: PublishedChannel, first: usize, message: &Value, to: &mut FurtherMessages) {
    // Neither a value of JSON nor a buffer in memory can fail to be written.
    to.add(first + channel as usize, |bytes| {
        let _ = serde_json::to_writer(bytes, message);
    });
}

/// Publishes a run in its own recording, no more often than with this period, ns.
#[must_use]
pub fn publishing(about: About, period_ns: u64) -> Publishing {
    Publishing::new(period_ns, move || {
        Box::new(RunTopics::new(about.clone(), &StandardTopic::BRIEF))
    })
}
