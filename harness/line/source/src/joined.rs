//! Messages of gyros and accelerometers, on one topic or on two.
//!
//! Of two topics the messages with equal stamps are taken together. What has no partner is counted and left out: nothing is
//! interpolated. Each topic is read by a reader of its own, so that no message waits in memory for another.

use super::fields::FieldPath;
use super::messages::{TopicMessage, TopicMessages};
use octant_account::{AccountEntry, OutsideClock, Weight};
use octant_base::number::{counted, plain};
use std::io::Read;

/// More messages without a partner than one for so many pairs could have changed the verdict.
const UNPAIRED_MAX: u64 = 10;

/// Messages that are taken together.
pub(super) struct Joined<R> {
    gyro: TopicMessages<R>,
    accel: Option<Accel<R>>,
}

/// The other topic.
struct Accel<R> {
    messages: TopicMessages<R>,
    /// Number of fields of the gyros' topic that come before those of the accelerometers.
    before: usize,
    /// Number of its fields.
    count: usize,
    /// Message that has no partner yet.
    ahead: Option<TopicMessage>,
    has_begun: bool,
    pairs: u64,
    /// Messages without a partner: gyros, accelerometers.
    unpaired: [Unpaired; 2],
    /// Smallest difference of two stamps that aren't equal, ns.
    nearest_ns: Option<u64>,
    /// Stamp of the last message of each, ns.
    last_ns: [Option<u64>; 2],
}

#[derive(Clone, Copy, Debug, Default)]
struct Unpaired {
    count: u64,
    /// Number of the first one.
    first: u64,
}

impl<R: Read> Joined<R> {
    /// All fields on one topic.
    pub(super) fn one(messages: TopicMessages<R>) -> Self {
        Self { gyro: messages, accel: None }
    }

    /// Two topics. The `count` fields of the second one are put behind the first `before` ones of the first.
    pub(super) fn two(
        gyro: TopicMessages<R>,
        accel: TopicMessages<R>,
        before: usize,
        count: usize,
    ) -> Self {
        let accel = Accel {
            messages: accel,
            before,
            count,
            ahead: None,
            has_begun: false,
            pairs: 0,
            unpaired: [Unpaired::default(); 2],
            nearest_ns: None,
            last_ns: [None; 2],
        };
        Self { gyro, accel: Some(accel) }
    }

    pub(super) fn truncated(&self) -> bool {
        self.gyro.truncated() || self.accel.as_ref().is_some_and(|accel| accel.messages.truncated())
    }

    /// Path of the field with this index.
    pub(super) fn path(&self, index: usize) -> &FieldPath {
        match &self.accel {
            Some(accel) if index >= accel.before && index < accel.before + accel.count => {
                accel.messages.path(index - accel.before)
            }
            Some(accel) if index >= accel.before => self.gyro.path(index - accel.count),
            _ => self.gyro.path(index),
        }
    }

    /// Adds the place of the last message to a reason; of two topics it is that of the gyros' message.
    pub(super) fn in_message(&self, reason: &str) -> String {
        self.gyro.in_message(reason)
    }

    /// Adds the place of a message that was read before to a reason.
    pub(super) fn in_message_number(&self, number: u64, reason: &str) -> String {
        self.gyro.in_message_number(number, reason)
    }

    /// Number of the last message, from 1; of two topics that of the gyros.
    pub(super) const fn number(&self) -> u64 {
        self.gyro.number()
    }

    /// Describes a topic without a message.
    pub(super) fn no_message(&self) -> String {
        self.gyro.no_message()
    }

    /// Clock of the stamps against the one that logged them.
    pub(super) fn outside(&self) -> Option<OutsideClock> {
        self.gyro.outside()
    }

    /// Messages without a partner, for the account; none of one topic.
    pub(super) fn unpaired(&self) -> Vec<AccountEntry> {
        let Some(accel) = &self.accel else { return Vec::new() };
        let topics = [self.gyro.topic(), accel.messages.topic()];
        let entries = accel.unpaired.iter().enumerate().filter(|(_, one)| one.count > 0);
        entries
            .map(|(index, Unpaired { count, first })| {
                let kind = format!(
                    "messages on {} without one of the same stamp on {}",
                    topics[index],
                    topics[1 - index]
                );
                AccountEntry::new(*count, kind)
                    .first(format!("message {first}"))
                    .weight(Weight::doubt_if(*count > accel.pairs / UNPAIRED_MAX))
            })
            .collect()
    }

    /// Returns the next message; `None` at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<TopicMessage>, String> {
        let Some(accel) = &mut self.accel else { return self.gyro.next() };
        if !std::mem::replace(&mut accel.has_begun, true) {
            accel.ahead = accel.next()?;
        }
        loop {
            let gyro = self.gyro.next()?;
            let Some(mut gyro) = gyro else {
                while accel.ahead.is_some() {
                    accel.leave(1, accel.messages.number());
                    accel.ahead = accel.next()?;
                }
                return if accel.pairs == 0 { Err(accel.strangers(&self.gyro)) } else { Ok(None) };
            };
            follows(&mut accel.last_ns[0], gyro.time_ns)
                .map_err(|reason| self.gyro.in_message(&reason))?;
            while let Some(ahead) = &accel.ahead
                && ahead.time_ns < gyro.time_ns
            {
                accel.near(gyro.time_ns);
                accel.leave(1, accel.messages.number());
                accel.ahead = accel.next()?;
            }
            if let Some(ahead) = accel.ahead.take_if(|ahead| ahead.time_ns == gyro.time_ns) {
                accel.pairs += 1;
                let behind = gyro.numbers.split_off(accel.before);
                gyro.numbers.extend(ahead.numbers);
                gyro.numbers.extend(behind);
                accel.ahead = accel.next()?;
                return Ok(Some(gyro));
            }
            accel.near(gyro.time_ns);
            accel.leave(0, self.gyro.number());
        }
    }
}

impl<R: Read> Accel<R> {
    fn next(&mut self) -> Result<Option<TopicMessage>, String> {
        let message = self.messages.next()?;
        if let Some(message) = &message {
            follows(&mut self.last_ns[1], message.time_ns)
                .map_err(|reason| self.messages.in_message(&reason))?;
        }
        Ok(message)
    }

    /// Counts a message without a partner.
    fn leave(&mut self, topic: usize, number: u64) {
        let unpaired = &mut self.unpaired[topic];
        if unpaired.count == 0 {
            unpaired.first = number;
        }
        unpaired.count += 1;
    }

    /// Notes how near the message ahead is to a stamp.
    fn near(&mut self, time_ns: u64) {
        if let Some(ahead) = &self.ahead {
            let apart = ahead.time_ns.abs_diff(time_ns);
            self.nearest_ns = Some(self.nearest_ns.map_or(apart, |nearest| nearest.min(apart)));
        }
    }

    /// Describes topics of which no two messages have the same stamp.
    fn strangers(&self, gyro: &TopicMessages<R>) -> String {
        let [of_gyro, of_accel] =
            self.unpaired.map(|one| counted(one.count, "message", "messages"));
        let nearest = match self.nearest_ns {
            Some(ns) => format!("the nearest two are {} ms apart", plain(ns as f64 * 1e-6, 4)),
            None => "none follow each other".to_owned(),
        };
        format!(
            "{of_gyro} on {} and {of_accel} on {}, of which no two have the same stamp: {nearest}; expected equal stamps, \
             or a topic of the driver on which it joins both",
            gyro.topic(),
            self.messages.topic()
        )
    }
}

/// Checks that the stamps of a topic increase: by stamps that don't, nothing can be joined.
fn follows(last_ns: &mut Option<u64>, time_ns: u64) -> Result<(), String> {
    if let Some(last) = *last_ns
        && time_ns <= last
    {
        return Err(format!("stamp {time_ns} ns is not after the one before, {last} ns"));
    }
    *last_ns = Some(time_ns);
    Ok(())
}
