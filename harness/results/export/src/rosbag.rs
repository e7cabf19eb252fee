//! MCAP with the topics for other tools, from every output and sample of a recording.
//!
//! The topics are those of [`standard`](octant_views::standard), and those of a live run. All messages are CDR with schemas
//! `ros2msg`: readers of bags refuse a file with another encoding as a whole.

use super::error::ExportFailure;
use super::job::{EXPORT_VERSION, Job, NewFile};
use super::resample::Grid;
use super::rows::each_item;
use mcap::records::{MessageHeader, Metadata};
use octant_recorder::further::{FurtherChannel, FurtherMessages, Publisher};
use octant_recorder::reader::Item;
use octant_sample::Sample;
use octant_views::about::About;
use octant_views::boundary::EpochBoundary;
use octant_views::publisher::{RunEncoding, RunTopics};
use octant_views::standard::StandardTopic;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// Writes the file.
pub(crate) fn write(job: &Job<'_>) -> Result<Vec<PathBuf>, ExportFailure> {
    let path = &job.choice.recording;
    let mut about = About::of(&job.info, path.parent().unwrap_or(Path::new("")));
    if about.sample_period_ns.is_none() {
        about.sample_period_ns = measured_period_ns(path)?;
    }
    let new = NewFile::create(job.out, job.force)?;
    let mut topics = RunTopics::new(about, &StandardTopic::ALL, RunEncoding::Cdr);
    let begun = Bag::begin(job, new.file()?, topics.channels());
    let mut bag = begun.map_err(|error| new.format(error))?;
    let mut messages = FurtherMessages::default();
    topics.begin(&mut messages);
    bag.put(0, &mut messages).map_err(|error| new.format(error))?;
    let mut grid = Grid::new(job.choice.every_ns);
    let mut boundary = EpochBoundary::default();
    // Whether sample and output of the epoch are on the grid, once one of them was read.
    let mut on_grid: Option<bool> = None;
    each_item(path, &mut |time_ns, item| {
        if let Some(before_ns) = boundary.take(time_ns, item.topic()) {
            topics.end_epoch(on_grid.take() == Some(true), &mut messages);
            bag.put(before_ns, &mut messages).map_err(|error| new.format(error))?;
        }
        if matches!(item, Item::Sample(_) | Item::Output(_)) {
            on_grid.get_or_insert_with(|| grid.keeps(time_ns));
        }
        // Parameters are rare, and all of them are kept.
        let is_due = on_grid == Some(true) || matches!(item, Item::Parameters(..));
        topics.take(time_ns, &item, is_due, &mut messages);
        bag.put(time_ns, &mut messages).map_err(|error| new.format(error))
    })?;
    topics.end_epoch(on_grid == Some(true), &mut messages);
    bag.put(boundary.time_ns(), &mut messages).map_err(|error| new.format(error))?;
    bag.mcap.finish().map_err(|error| new.format(error))?;
    drop(bag);
    Ok(vec![new.finish()?])
}

/// Period of the samples, ns, from the first two of the recording with their numbers: those between them may not be
/// recorded.
fn measured_period_ns(path: &Path) -> Result<Option<u64>, ExportFailure> {
    let wrong = |source| ExportFailure::Recording { path: path.to_owned(), source };
    let mut recording = octant_recorder::reader::Recording::open(path).map_err(wrong)?;
    let mut first: Option<Sample> = None;
    while let Some((_, item)) = recording.next_item().map_err(wrong)? {
        let Item::Sample(sample) = item else { continue };
        let Some(first) = &first else {
            first = Some(sample);
            continue;
        };
        let numbers = sample.sequence.checked_sub(first.sequence).filter(|n| *n > 0);
        let time_ns = sample.device_time.ns.checked_sub(first.device_time.ns).filter(|t| *t > 0);
        if let Some((numbers, time_ns)) = numbers.zip(time_ns) {
            return Ok(Some((time_ns as f64 / numbers as f64).round() as u64));
        }
    }
    Ok(None)
}

/// File under construction.
struct Bag {
    mcap: mcap::Writer<BufWriter<File>>,
    channels: Vec<u16>,
    sequence: u32,
}

impl Bag {
    fn begin(
        job: &Job<'_>,
        file: File,
        further: Vec<FurtherChannel>,
    ) -> Result<Self, mcap::McapError> {
        let mut mcap = mcap::WriteOptions::new()
            .profile("ros2")
            .library(concat!("octant ", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_threads(0)
            .create(BufWriter::new(file))?;
        let mut metadata = BTreeMap::from([
            ("version".to_owned(), EXPORT_VERSION.to_string()),
            ("octant".to_owned(), env!("CARGO_PKG_VERSION").to_owned()),
            ("stamps".to_owned(), "run time, ns since the start of the run".to_owned()),
            ("axes".to_owned(), "REP 103: east, north, up; forward, left, up".to_owned()),
        ]);
        metadata
            .extend(job.info.run.iter().map(|(key, value)| (format!("run.{key}"), value.clone())));
        mcap.write_metadata(&Metadata { name: "octant.export".to_owned(), metadata })?;
        let mut channels = Vec::new();
        // A recorder of ROS 2 writes the profiles of each topic; none are the default ones.
        let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
        for one in further {
            let (name, encoding) = (one.schema_name, one.schema_encoding);
            let schema = mcap.add_schema(name, encoding, one.schema.as_bytes())?;
            channels.push(mcap.add_channel(schema, one.topic, one.message_encoding, &metadata)?);
        }
        Ok(Self { mcap, channels, sequence: 0 })
    }

    /// Writes messages, and removes them.
    fn put(&mut self, time_ns: u64, messages: &mut FurtherMessages) -> Result<(), mcap::McapError> {
        for (channel, message) in messages.iter() {
            self.sequence = self.sequence.wrapping_add(1);
            let header = MessageHeader {
                channel_id: self.channels[channel],
                sequence: self.sequence,
                log_time: time_ns,
                publish_time: time_ns,
            };
            self.mcap.write_to_known_channel(&header, message)?;
        }
        messages.clear();
        Ok(())
    }
}
