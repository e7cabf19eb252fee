//! Recordings, message by message, bit for bit.

use super::error::DiffError;
use super::fields::{encode, first_difference};
use super::side::Side;
use octant_earth::ellipsoid::Ellipsoid;
use octant_recorder::message::Topic;
use octant_recorder::reader::{Item, Recording};
use octant_sample::Output;
use serde::Serialize;
use std::cmp::Ordering;
use std::fs::File;
use std::io::BufReader;
use std::path::PathBuf;

/// Most points of the series of differences.
const POINTS_MAX: usize = 2000;

/// First difference of a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FirstDiff {
    /// Channel.
    pub channel: &'static str,
    /// Run time, s.
    pub time_s: f64,
    /// Field that differs; `message` where only one run has the message.
    pub field: String,
    /// Value in the first run.
    pub first: String,
    /// Value in the second run.
    pub second: String,
}

/// Comparison of a channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChannelDiff {
    /// Channel.
    pub channel: &'static str,
    /// Number of messages that both runs have.
    pub compared: u64,
    /// Number of those that differ in a bit.
    pub differing: u64,
    /// Number of messages that only the first run has.
    pub only_first: u64,
    /// Number of messages that only the second run has.
    pub only_second: u64,
}

/// Comparison of two recordings. Events aren't compared: some tell about the host.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct StreamDiff {
    /// True if both keep the same samples, so that every message has a partner.
    pub is_same_policy: bool,
    /// First difference; null if there is none.
    pub first: Option<FirstDiff>,
    /// Channels that have messages.
    pub channels: Vec<ChannelDiff>,
    /// Difference of the solutions, second minus first: hours, north in m, east in m.
    pub position_m: Vec<[f64; 3]>,
}

impl StreamDiff {
    /// Returns whether no difference was found.
    #[must_use]
    pub const fn is_equal(&self) -> bool {
        self.first.is_none()
    }
}

/// Recording with its next message.
struct Reader {
    path: PathBuf,
    recording: Recording<BufReader<File>>,
    next: Option<(u64, Item)>,
}

impl Reader {
    fn open(side: &Side) -> Result<Self, DiffError> {
        let path = side.recording.clone();
        let recording = Recording::open(&path)
            .map_err(|source| DiffError::Recording { path: path.clone(), source })?;
        let mut reader = Self { path, recording, next: None };
        reader.advance()?;
        Ok(reader)
    }

    /// Reads the next message of a sample stream.
    fn advance(&mut self) -> Result<(), DiffError> {
        loop {
            self.next = self
                .recording
                .next_item()
                .map_err(|source| DiffError::Recording { path: self.path.clone(), source })?;
            if !matches!(self.next, Some((_, Item::Event(_)))) {
                return Ok(());
            }
        }
    }

    fn key(&self) -> Option<(u64, Topic)> {
        self.next.as_ref().map(|(time_ns, item)| (*time_ns, item.topic()))
    }
}

/// Compares two recordings to the end of both.
pub(crate) fn compare(first: &Side, second: &Side) -> Result<StreamDiff, DiffError> {
    let is_same_policy =
        (first.info.samples, first.info.period_ns) == (second.info.samples, second.info.period_ns);
    let mut found = Found {
        diff: StreamDiff { is_same_policy, ..StreamDiff::default() },
        channels: Topic::ALL
            .map(|topic| ChannelDiff { channel: topic.name(), ..ChannelDiff::default() }),
        bytes: [Vec::new(), Vec::new()],
        series: Series::default(),
    };
    let (mut a, mut b) = (Reader::open(first)?, Reader::open(second)?);
    loop {
        let order = match (a.key(), b.key()) {
            (None, None) => break,
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (Some(a), Some(b)) => a.cmp(&b),
        };
        match order {
            Ordering::Equal => {
                if let (Some((time_ns, one)), Some((_, other))) = (&a.next, &b.next) {
                    found.pair(*time_ns, one, other);
                }
                a.advance()?;
                b.advance()?;
            }
            Ordering::Less => {
                found.single(a.key(), true);
                a.advance()?;
            }
            Ordering::Greater => {
                found.single(b.key(), false);
                b.advance()?;
            }
        }
    }
    let mut diff = found.diff;
    diff.channels = found
        .channels
        .into_iter()
        .filter(|channel| channel.compared + channel.only_first + channel.only_second > 0)
        .collect();
    diff.position_m = found.series.points;
    Ok(diff)
}

struct Found {
    diff: StreamDiff,
    channels: [ChannelDiff; Topic::ALL.len()],
    bytes: [Vec<u8>; 2],
    series: Series,
}

impl Found {
    fn pair(&mut self, time_ns: u64, one: &Item, other: &Item) {
        let topic = one.topic();
        let [first, second] = &mut self.bytes;
        if !encode(one, first) || !encode(other, second) {
            return;
        }
        let channel = &mut self.channels[topic as usize];
        channel.compared += 1;
        if let (Item::Output(one), Item::Output(other)) = (one, other) {
            self.series.push(time_ns, one, other);
        }
        if first == second {
            return;
        }
        channel.differing += 1;
        if self.diff.first.is_none()
            && let Some((field, a, b)) = first_difference(topic, first, second)
        {
            self.diff.first = Some(FirstDiff {
                channel: topic.name(),
                time_s: time_ns as f64 / 1e9,
                field,
                first: a,
                second: b,
            });
        }
    }

    /// Counts a message that only one run has; it is a difference where both keep the same samples. How
    /// many covariances are kept is the choice of another key, and earlier recordings have none.
    fn single(&mut self, key: Option<(u64, Topic)>, is_first: bool) {
        let Some((time_ns, topic)) = key else { return };
        let channel = &mut self.channels[topic as usize];
        *(if is_first { &mut channel.only_first } else { &mut channel.only_second }) += 1;
        let is_stream = topic != Topic::Covariance;
        if self.diff.first.is_none() && self.diff.is_same_policy && is_stream {
            let words = |is_there: bool| if is_there { "recorded" } else { "missing" }.to_owned();
            self.diff.first = Some(FirstDiff {
                channel: topic.name(),
                time_s: time_ns as f64 / 1e9,
                field: "message".to_owned(),
                first: words(is_first),
                second: words(!is_first),
            });
        }
    }
}

/// Differences of the solutions, thinned to a bounded number: when it is full, every other point goes.
#[derive(Default)]
struct Series {
    points: Vec<[f64; 3]>,
    seen: u64,
    left_out: u64,
}

impl Series {
    fn push(&mut self, time_ns: u64, one: &Output, other: &Output) {
        let is_kept = self.seen.is_multiple_of(self.left_out + 1);
        self.seen += 1;
        if !is_kept {
            return;
        }
        let (one, other) = (&one.navigation, &other.navigation);
        let earth = Ellipsoid::at(one.latitude_rad, one.height_m);
        let north_m = (other.latitude_rad - one.latitude_rad) * earth.meridian_radius_m;
        let east_m = (other.longitude_rad - one.longitude_rad)
            * earth.transverse_radius_m
            * earth.cos_latitude;
        if !(north_m.is_finite() && east_m.is_finite()) {
            return;
        }
        self.points.push([time_ns as f64 / 3.6e12, north_m, east_m]);
        if self.points.len() > POINTS_MAX {
            let mut is_odd = false;
            self.points.retain(|_| {
                is_odd = !is_odd;
                is_odd
            });
            self.left_out = 2 * self.left_out + 1;
        }
    }
}
