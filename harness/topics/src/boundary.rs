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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_time_or_a_topic_of_no_higher_rank_begins_an_epoch() {
        let mut boundary = EpochBoundary::default();
        let found = [
            (5, Topic::Aiding),
            (5, Topic::Imu),
            (5, Topic::Output),
            (5, Topic::Event),
            (5, Topic::Truth),
            // Two samples reached the core in this step.
            (5, Topic::Imu),
            (9, Topic::Output),
        ]
        .map(|(time_ns, topic)| boundary.take(time_ns, topic));
        assert_eq!(found, [None, None, None, None, None, Some(5), Some(5)]);
        assert_eq!(boundary.time_ns(), 9);
    }
}
