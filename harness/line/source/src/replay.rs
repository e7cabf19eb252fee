//! A recording as a source: an octant recording, or a foreign MCAP file.
//!
//! Reads from first to last in bounded memory, whatever the length. The gimbal commands of the core
//! are ignored: a recording can't react to them.

use super::foreign::Foreign;
use super::{Epoch, Source, SourceError};
use octant_account::Account;
use octant_plant::Truth;
use octant_recorder::Samples;
use octant_recorder::event::BenchRecord;
use octant_recorder::reader::{Epochs, Info, ReadError, RecordedEpoch, Recording};
use octant_sample::GimbalCommand;
use octant_scenario::Scenario;
use octant_scenario::recorded::McapMapping;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

/// Replays an MCAP file.
pub struct Replay {
    path: String,
    kind: Kind,
    last: RecordedEpoch,
}

enum Kind {
    Octant { epochs: Box<Epochs<BufReader<File>>>, total: Option<u64> },
    Foreign(Box<Foreign<BufReader<File>>>),
}

impl Replay {
    /// Opens a recording. With a mapping, any MCAP file is read through that mapping; without one,
    /// the file must be a full octant recording.
    ///
    /// # Errors
    /// If the file can't be read, is of a newer version, or is decimated.
    pub fn open(path: &Path, mapping: Option<&McapMapping>) -> Result<Self, SourceError> {
        let name = path.display().to_string();
        let kind = match mapping {
            Some(mapping) => {
                let open = || {
                    let file = File::open(path);
                    file.map(BufReader::new).map_err(|e| read_error(&name, &ReadError::Open(e)))
                };
                other_container(&name, &mut open()?)?;
                Kind::Foreign(Box::new(Foreign::new(open, &name, mapping)?))
            }
            None => {
                let recording = Recording::open(path).map_err(|e| read_error(&name, &e))?;
                require_full(&name, recording.info())?;
                Kind::Octant {
                    epochs: Box::new(Epochs::new(recording)),
                    total: samples_in_summary(path),
                }
            }
        };
        Ok(Self { path: name, kind, last: RecordedEpoch::default() })
    }

    /// True if the file ends in the middle; everything before that point was delivered. Known only
    /// at the end.
    #[must_use]
    pub fn truncated(&self) -> bool {
        match &self.kind {
            Kind::Octant { epochs, .. } => epochs.recording().truncated(),
            Kind::Foreign(foreign) => foreign.truncated(),
        }
    }

    /// Number of samples so far in which a count saturated during the conversion of a foreign
    /// file's quantities.
    #[must_use]
    pub fn saturated(&self) -> u64 {
        match &self.kind {
            Kind::Octant { .. } => 0,
            Kind::Foreign(foreign) => foreign.saturated(),
        }
    }

    /// Returns the recording's description of itself; `None` for a foreign file.
    #[must_use]
    pub fn info(&self) -> Option<&Info> {
        match &self.kind {
            Kind::Octant { epochs, .. } => Some(epochs.recording().info()),
            Kind::Foreign(_) => None,
        }
    }

    /// Returns everything recorded of the epoch last delivered: output of the recorded core, clean
    /// sample, parameters.
    #[must_use]
    pub fn recorded(&self) -> &RecordedEpoch {
        &self.last
    }
}

impl Source for Replay {
    /// Delivers the epoch as it reached the recorded core, faults included.
    fn next(&mut self, _command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        let mut events = Vec::new();
        match &mut self.kind {
            Kind::Foreign(foreign) => Ok(epoch.take(foreign.next()?)),
            Kind::Octant { epochs, .. } => loop {
                match epochs.next_epoch().map_err(|e| read_error(&self.path, &e))? {
                    None => return Ok(false),
                    Some(mut recorded) => {
                        // Events stored with an epoch that never reached the core are kept and
                        // passed on with the next epoch.
                        events.append(&mut recorded.events);
                        // A truncated file may end with aiding whose sample is missing.
                        if let Some(sample) = recorded.sample {
                            *epoch = Epoch { sample, aiding: recorded.aiding };
                            recorded.events = events;
                            self.last = recorded;
                            return Ok(true);
                        }
                    }
                }
            },
        }
    }

    fn truth(&self) -> Option<Truth> {
        self.last.truth
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        match &mut self.kind {
            Kind::Octant { .. } => Ok(None),
            Kind::Foreign(foreign) => foreign.temperature_c(),
        }
    }

    fn samples_total(&self) -> Option<u64> {
        match &self.kind {
            Kind::Octant { total, .. } => *total,
            Kind::Foreign(_) => None,
        }
    }

    fn samples_planned(&self) -> Option<u64> {
        let folder = Path::new(&self.path).parent().unwrap_or(Path::new(""));
        let recorded = self.info().and_then(|info| {
            Scenario::parse(&info.scenario, "scenario.toml", folder, &[]).ok()?.samples()
        });
        self.samples_total().max(recorded)
    }

    fn cut_short(&self) -> Option<String> {
        if self.truncated() {
            return Some(format!("{} ends in the middle of a recording", self.path));
        }
        match &self.kind {
            Kind::Octant { .. } => None,
            Kind::Foreign(foreign) => foreign.gaps(),
        }
    }

    fn accounts(&self) -> Vec<Account> {
        match &self.kind {
            Kind::Octant { .. } => Vec::new(),
            Kind::Foreign(foreign) => vec![foreign.account()],
        }
    }

    fn conclude(
        &mut self,
        _broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        let bench = match &self.kind {
            Kind::Octant { .. } => None,
            Kind::Foreign(foreign) => foreign.bench(),
        };
        (bench, None)
    }
}

/// Refuses files of which it is known what they are, with what turns them into MCAP.
fn other_container(path: &str, file: &mut impl Read) -> Result<(), SourceError> {
    let mut begins = Vec::new();
    // A file that can't be read says so where it is read.
    let _ = file.take(16).read_to_end(&mut begins);
    let reason = if begins.starts_with(b"#ROSBAG V") {
        "found a bag of ROS 1, expected MCAP: write `mcap convert BAG FILE.mcap`, or `rosbags-convert --src BAG --dst \
         FOLDER --dst-storage mcap`"
    } else if begins.starts_with(b"SQLite format 3") {
        "found a bag of ROS 2 in SQLite, expected MCAP: write `mcap convert BAG.db3 FILE.mcap`, or `rosbags-convert --src \
         FOLDER --dst FOLDER --dst-storage mcap`"
    } else {
        return Ok(());
    };
    Err(SourceError::Read { path: path.into(), reason: reason.into() })
}

fn require_full(path: &str, info: &Info) -> Result<(), SourceError> {
    if info.samples == Samples::Full {
        return Ok(());
    }
    Err(SourceError::Read {
        path: path.into(),
        reason: format!(
            "the recording keeps a sample every {} s, and a replay needs every sample: record the \
             run again with record.samples = \"full\"",
            info.period_ns as f64 * 1e-9
        ),
    })
}

/// Returns the number of samples if the file has its summary. A truncated file has none.
fn samples_in_summary(path: &Path) -> Option<u64> {
    use mcap::sans_io::summary_reader::{SummaryReadEvent, SummaryReader};
    use std::io::Seek;
    let mut file = File::open(path).ok()?;
    let mut reader = SummaryReader::new();
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            SummaryReadEvent::ReadRequest(n) => {
                let n = n.min(octant_recorder::records::RECORD_BYTES_MAX);
                let read = file.read(reader.insert(n)).ok()?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => {
                let position = file.seek(to).ok()?;
                reader.notify_seeked(position);
            }
        }
    }
    let summary = reader.finish()?;
    let channel = summary
        .channels
        .values()
        .find(|channel| channel.topic == octant_recorder::message::Topic::Imu.name())?;
    summary.stats?.channel_message_counts.get(&channel.id).copied()
}

pub(super) fn read_error(path: &str, error: &ReadError) -> SourceError {
    SourceError::Read { path: path.into(), reason: error.to_string() }
}
