//! Where one epoch of a recording ends and the next one begins.

use octant_recorder::message::Topic;

/// Finds the epochs among the messages of a recording, in the order of the file.
///
/// The messages of an epoch have one log time, and come in the order of their topics. Events belong to
/// none.
#[derive(Clone, Copy, Debug, Default)]
pub struct EpochBoundary {
    time_ns: u64,
    last: Option<Topic>,
}

impl EpochBoundary {
    /// Takes a message. Returns the log time of the epoch before, if the message begins another one.
    pub fn take(&mut self, time_ns: u64, topic: Topic) -> Option<u64> {
        if topic == Topic::Event {
            return None;
        }
        let before_ns = self.time_ns;
        let begins = self.last.is_some_and(|last| time_ns != before_ns || topic <= last);
        self.last = Some(topic);
        self.time_ns = time_ns;
        begins.then_some(before_ns)
    }

    /// Log time of the present epoch, ns.
    #[must_use]
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }
}
