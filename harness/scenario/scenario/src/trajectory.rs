//! Files with positions over time: an instrument's own solution, and what it is scored against.

use crate::model::FileName;
use crate::recorded::{Delimiter, RecordedColumn, TimeUnit};
use octant_instruments::navigation::NavigationProtocol;

/// A file with positions over time.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectorySpec {
    /// The file.
    pub file: FileName,
    /// What it is.
    pub format: TrajectoryFormat,
}

/// What a file is.
#[derive(Clone, Debug, PartialEq)]
pub enum TrajectoryFormat {
    /// Columns of text.
    Csv(Box<TrajectoryColumns>),
    /// Sentences of NMEA 0183 (IEC 61162-1).
    Nmea(NmeaChoice),
    /// A solution of RTKLIB.
    Rtklib,
    /// A smoothed best estimate of trajectory: records of 17 doubles.
    Sbet,
    /// The bytes that a unit sent.
    Messages(NavigationProtocol),
}

/// Sentences of an NMEA file that count.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NmeaChoice {
    /// Letters of the talker; `None`: all, which have to agree.
    pub talker: Option<String>,
    /// True if estimated positions and headings (dead reckoning) are left out, as in a reference.
    pub fixes_alone: bool,
    /// Sentences that make a point each; `None`: positions, where the file has some, else headings.
    pub points: Option<NmeaPoints>,
    /// Time of headings that have none of their own; `None`: the first way that the file allows.
    pub heading_time: Option<HeadingTime>,
    /// Place of such headings in their cycle; `None`: anywhere from the time of day before them to the next one.
    pub heading_delay: Option<HeadingDelay>,
    /// True if an answer without a heading makes a point, too: a heading test tells it from silence.
    pub tells_none: bool,
}

/// Time from a time of day to the measurement of the first heading behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingDelay {
    /// The time, s; negative: the heading was measured before.
    pub delay_s: f64,
    /// How far it may be off (95 %), s.
    pub uncertainty_s: f64,
}

/// Sentences of an NMEA file that make a point each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NmeaPoints {
    /// Positions, each with the heading that follows it.
    Positions,
    /// Headings, each alone.
    Headings,
}

/// Time of a heading that has none of its own, such as that of HDT and THS.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HeadingTime {
    /// Parameter `c` of the TAG block before the sentence.
    Tag,
    /// The stamp that a logger wrote before the sentence.
    Stamp,
    /// The sentences with a time of day around it: headings are evenly spread from one to the next.
    Cycle,
    /// An even rate, Hz, from a first time on, ns since 1970, UTC; without one from zero.
    Rate(f64, Option<i64>),
}

/// Columns of a text file; `None`: the name that Octant's exports have, where the header has it.
#[derive(Clone, Debug, PartialEq)]
pub struct TrajectoryColumns {
    /// True if names with `true_` before them come first: Octant's exports have a solution and its truth side by
    /// side.
    pub truth_first: bool,
    /// What separates columns.
    pub delimiter: Delimiter,
    /// Lines to skip at the start.
    pub skip_lines: usize,
    /// Lines that start with this are skipped; empty: none.
    pub comment: String,
    /// Time, and its unit where it is a number.
    pub time: (Option<RecordedColumn>, TimeUnit),
    /// Latitude, longitude and height.
    pub position: [Option<RecordedColumn>; 3],
    /// Velocity over ground, north and east.
    pub velocity: [Option<RecordedColumn>; 2],
    /// Roll, pitch and heading.
    pub attitude: [Option<RecordedColumn>; 3],
    /// Standard deviations of north and east, of the velocities north and east, and of roll, pitch and heading.
    pub sigma: [Option<RecordedColumn>; 7],
    /// Quality of a row, in words or numbers of its own.
    pub quality: Option<RecordedColumn>,
    /// Qualities whose rows are left out.
    pub left_out: Vec<String>,
    /// Radians in a unit of the angles.
    pub angle_rad: f64,
    /// Metres per second in a unit of the velocities.
    pub velocity_mps: f64,
}

/// Reference of a solution.
#[derive(Clone, Debug, PartialEq)]
pub enum SolutionReference {
    /// A file.
    File(TrajectorySpec),
    /// A heading that was surveyed, of an instrument that stands still.
    Heading {
        /// True heading, rad.
        heading_rad: f64,
        /// Its expanded uncertainty (95 %), rad.
        uncertainty_rad: Option<f64>,
    },
    /// None: a heading test scores scatter, repeatability and settling, and no errors.
    Unknown,
}

impl SolutionReference {
    /// The file, where there is one.
    #[must_use]
    pub fn file(&self) -> Option<&TrajectorySpec> {
        match self {
            Self::File(spec) => Some(spec),
            Self::Heading { .. } | Self::Unknown => None,
        }
    }
}

/// File of a solution that came from a port, in the folder of its run: the name stays relative to the scenario beside it.
pub const OF_RUN: &str = "octant-solution.nmea";

/// A port from which a solution comes while the run goes.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionLine {
    /// The port.
    pub uri: octant_link::Uri,
    /// Time without a byte that ends the run.
    pub silence: std::time::Duration,
    /// True if the time of the run is that of the TAG blocks that come: a rehearsal with a simulated unit.
    pub rehearsal: bool,
}

/// Run-ups of a heading test in a solution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolutionRunUps {
    /// Number of run-ups of the plan; 0: it is no heading test.
    pub count: u32,
    /// Time for which the unit stays switched on in each, ns.
    pub length_ns: i64,
    /// Times at which the unit was switched on, ns since 1970, UTC; none: one run-up, from the beginning of the file on.
    pub switched_on_ns: Vec<i64>,
    /// Angles by which the table had turned the unit in each, rad; none: it stood at zero.
    pub azimuths_rad: Vec<f64>,
}

/// A solution, and the trajectory that it is scored against.
#[derive(Clone, Debug, PartialEq)]
pub struct SolutionSpec {
    /// The port from which it comes; `None`: it is in a file already.
    pub line: Option<SolutionLine>,
    /// True for a rehearsal with a simulated unit, which is no evidence.
    pub rehearsal: bool,
    /// Run-ups of a heading test.
    pub run_ups: SolutionRunUps,
    /// The instrument's solution.
    pub solution: TrajectorySpec,
    /// Time at its beginning that isn't scored, ns.
    pub skip_ns: i64,
    /// The reference.
    pub reference: SolutionReference,
    /// Time added to the solution's times to get those of the reference, ns; `None`: nothing, if both
    /// tell the time on a scale that is known.
    pub offset_ns: Option<i64>,
    /// How far that may be wrong (95 %), s.
    pub offset_uncertainty_s: f64,
    /// Longest time between two rows of the reference that is no gap, ns.
    pub gap_ns: i64,
}
