//! An instrument on a CAN bus, by a database and a mapping of its signals.

use crate::SourceError;
use octant_base::number::counted;
use octant_instruments::Reading;
use octant_instruments::dbc::{CanFrame, Database, DbcProblem, Gatherer, SignalMapping};
use octant_link::Uri;
use octant_link::port::{HeardFrame, Listener};
use octant_scenario::{FileName, Messages};
use std::path::Path;
use std::time::{Duration, Instant};

/// Messages on a bus, and what is gathered of a reading.
#[derive(Debug)]
pub(super) struct Bus {
    listener: Listener,
    gatherer: Gatherer,
    /// Frame that was not taken yet, with its time of arrival.
    frame: Option<(HeardFrame, Instant)>,
}

impl Bus {
    /// Opens the bus. File names are relative to `folder`.
    pub(super) fn open(uri: &Uri, messages: &Messages, folder: &Path) -> Result<Self, SourceError> {
        let gatherer = gatherer(messages, folder)?;
        let identifiers: Vec<(u32, bool)> = gatherer.identifiers().collect();
        let listener = Listener::open(uri, &identifiers).map_err(|error| SourceError::Gone {
            uri: uri.to_string(),
            reason: error.to_string(),
        })?;
        Ok(Self { listener, gatherer, frame: None })
    }

    pub(super) fn reading(&mut self) -> Option<(Reading, Instant)> {
        let (heard, came) = self.frame.take()?;
        let frame = CanFrame { id: heard.id, extended: heard.extended, data: heard.data() };
        self.gatherer.receive(&frame).map(|reading| (reading, came))
    }

    pub(super) fn receive(&mut self, wait: Duration) -> Result<bool, String> {
        let heard = self.listener.hear(wait).map_err(|error| error.to_string())?;
        self.frame = heard.map(|heard| (heard, Instant::now()));
        Ok(self.frame.is_some())
    }

    pub(super) fn said(&self) -> String {
        let counters = self.gatherer.counters();
        format!(
            "received so far: {}, {}, {} of other messages, {} with a missing message, {} with messages \
             of another sample",
            counted(counters.frames, "frame", "frames"),
            counted(counters.readings, "reading", "readings"),
            counted(counters.other, "frame", "frames"),
            counted(counters.incomplete, "reading", "readings"),
            counted(counters.mixed, "reading", "readings"),
        )
    }
}

/// Checks that the files of an instrument exist and fit each other.
pub(super) fn check(messages: &Messages, folder: &Path) -> Result<(), SourceError> {
    gatherer(messages, folder).map(drop)
}

/// Builds the gatherer that assembles readings from CAN messages. File names are relative to
/// `folder`.
///
/// # Errors
/// If a file can't be read, or the files don't fit each other.
fn gatherer(messages: &Messages, folder: &Path) -> Result<Gatherer, SourceError> {
    let read = |name: &FileName| {
        let path = name.path(folder).map_err(SourceError::FileName)?;
        let file = path.display().to_string();
        match std::fs::read_to_string(&path) {
            Ok(text) => Ok((file, text)),
            Err(error) => Err(SourceError::Read { path: file, reason: error.to_string() }),
        }
    };
    let wrong =
        |problem: DbcProblem| SourceError::Read { path: problem.place, reason: problem.what };
    let (file, text) = read(&messages.database)?;
    let database = Database::parse(&file, &text).map_err(wrong)?;
    let (file, text) = read(&messages.mapping)?;
    let mapping = SignalMapping::parse(&file, &text).map_err(wrong)?;
    Gatherer::new(&database, &mapping).map_err(wrong)
}
