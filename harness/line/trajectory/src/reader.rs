//! Files of trajectories, point by point.

use super::columns::ColumnsReader;
use super::messages::MessageReader;
use super::nmea;
use super::point::{PointAttitude, Points, TimeScale, TrajectoryPoint};
use super::rtklib::RtklibReader;
use super::sbet::SbetReader;
use super::tally::{OUT_OF_ORDER, Tally};
use octant_account::{Account, AccountEntry};
use octant_scenario::trajectory::TrajectoryFormat;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::path::Path;

/// A file can't be read, or isn't what it is said to be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct TrajectoryError {
    /// The file.
    pub path: String,
    /// Place, what was found, and what was expected.
    pub reason: String,
}

impl TrajectoryError {
    pub(crate) fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self { path: path.display().to_string(), reason: reason.into() }
    }
}

/// Reads the points of a file, in the order of their times.
pub struct TrajectoryReader {
    path: std::path::PathBuf,
    points: Box<dyn Points>,
    last_ns: Option<i64>,
}

impl std::fmt::Debug for TrajectoryReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TrajectoryReader").field("path", &self.path).finish_non_exhaustive()
    }
}

impl TrajectoryReader {
    /// Opens a file.
    ///
    /// # Errors
    /// If it can't be read, or its beginning isn't that of such a file.
    pub fn open(path: &Path, format: &TrajectoryFormat) -> Result<Self, TrajectoryError> {
        let fail = |reason| TrajectoryError::new(path, reason);
        let file = std::fs::File::open(path).map_err(|error| fail(error.to_string()))?;
        let points: Box<dyn Points> = match format {
            TrajectoryFormat::Csv(columns) => {
                Box::new(ColumnsReader::new(file, columns).map_err(fail)?)
            }
            TrajectoryFormat::Nmea(choice) => {
                nmea::open(file, choice).map_err(|problem| fail(problem.to_string()))?
            }
            TrajectoryFormat::Rtklib => Box::new(RtklibReader::new(file).map_err(fail)?),
            TrajectoryFormat::Sbet => Box::new(SbetReader::new(file).map_err(fail)?),
            TrajectoryFormat::Messages(protocol) => {
                Box::new(MessageReader::new(file, *protocol).map_err(fail)?)
            }
        };
        Ok(Self { path: path.to_owned(), points, last_ns: None })
    }

    /// Scale of the times; that of text is known after its first row.
    #[must_use]
    pub fn scale(&self) -> TimeScale {
        self.points.scale()
    }

    /// Latest time that the file told so far, if that of a point that isn't valid counts too.
    pub(crate) fn heard_ns(&self) -> Option<i64> {
        self.points.heard_ns()
    }

    /// Choices that were made in reading the file, in words that follow its name; known after its first points.
    #[must_use]
    pub fn choices(&self) -> Vec<&'static str> {
        self.points.choices()
    }

    /// True if a point is given once the next one has begun.
    pub(crate) fn looks_ahead(&self) -> bool {
        self.points.looks_ahead()
    }

    /// Counts of what became of the units read so far.
    pub(crate) fn tally(&self) -> &Tally {
        self.points.tally()
    }

    /// Place of the last point, as in "line 17".
    pub(crate) fn place(&self) -> String {
        self.points.place()
    }

    /// The account of what was read so far; `role` says what the file is: `solution`, `reference`.
    pub(crate) fn account(&self, role: &str) -> Account {
        // The whole path is that of one host.
        let file =
            self.path.file_name().map_or_else(Default::default, |name| name.to_string_lossy());
        let account = self.tally().account(&format!("{role} {file}"), self.points.unit());
        let used = account.used_count();
        self.points.choices().into_iter().fold(account, |account, choice| {
            account.note(AccountEntry::new(used, format!("{}: {choice}", self.points.unit()[1])))
        })
    }

    /// Returns the next point; `None` at the end. A point whose time isn't after that of the one before is left out and
    /// counted.
    ///
    /// # Errors
    /// If the file is damaged, or a number can't be what it is said to be.
    #[expect(clippy::should_implement_trait, reason = "an iterator's `next` can't fail")]
    pub fn next(&mut self) -> Result<Option<TrajectoryPoint>, TrajectoryError> {
        loop {
            let next = self.points.next();
            let next = next.map_err(|reason| TrajectoryError::new(&self.path, reason))?;
            let Some(point) = next else { return Ok(None) };
            if let Some(reason) = impossible(&point) {
                let place = self.points.place();
                return Err(TrajectoryError::new(&self.path, format!("{place}: {reason}")));
            }
            let Some(last_ns) = self.last_ns.filter(|last_ns| point.time_ns <= *last_ns) else {
                self.last_ns = Some(point.time_ns);
                return Ok(Some(point));
            };
            let place = self.points.place();
            self.points.tally_mut().discard(OUT_OF_ORDER, || {
                let before_s = (last_ns - point.time_ns) as f64 * 1e-9;
                format!("{place}: found a time {before_s:.9} s before the point before it")
            });
        }
    }
}

/// Reason why a point can't be one.
fn impossible(point: &TrajectoryPoint) -> Option<String> {
    let [north, east] = point.velocity_mps.unwrap_or_default();
    let [roll, pitch, heading] =
        point.attitude.map(PointAttitude::or_level_rad).unwrap_or_default();
    let [latitude, longitude, height_m] = point.position.map_or([0.0; 3], |position| {
        [position.latitude_rad, position.longitude_rad, position.height_m]
    });
    let numbers = [
        ("latitude", latitude.to_degrees(), FRAC_PI_2.to_degrees(), "deg"),
        ("longitude", longitude.to_degrees(), TAU.to_degrees(), "deg"),
        ("height", height_m, 1e7, "m"),
        ("velocity north", north, 2e4, "m/s"),
        ("velocity east", east, 2e4, "m/s"),
        // Angles may run on over a whole turn.
        ("roll", roll.to_degrees(), 720.0, "deg"),
        ("pitch", pitch.to_degrees(), FRAC_PI_2.to_degrees(), "deg"),
        ("heading", heading.to_degrees(), 720.0, "deg"),
    ];
    // A comparison that NaN fails. A limit in another unit rounds.
    let wrong = numbers.into_iter().find(|(_, value, most, _)| !(value.abs() <= most * 1.000_001));
    wrong.map(|(name, value, most, unit)| {
        format!("found {name} {value} {unit}, expected -{most} to {most} {unit}")
    })
}
