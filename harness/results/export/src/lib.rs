//! Recordings as files that other tools open: CSV, Parquet, MAT, KML, and MCAP with messages of ROS 2.
//!
//! A recording is read twice. The first reading counts rows and finds the columns that have values ([`survey`]);
//! the second writes them, in bounded memory whatever the length of the recording. A file gets its name when it is
//! complete, and replaces no other one unless that was asked for.
//!
//! - [`table`] names the tables, [`columns`](mod@columns) defines the columns of each with units
//! - [`rows`] joins the messages of an epoch into rows, [`resample`] chooses those of a coarser grid
//! - one file a format: `csv`, `parquet`, `mat`, `kml`, `rosbag`

pub mod columns;
mod csv;
pub mod error;
mod job;
mod kml;
mod mat;
mod parquet;
pub mod resample;
mod rosbag;
pub mod rows;
pub mod survey;
pub mod table;

pub use error::ExportFailure;
pub use job::EXPORT_VERSION;
pub use rows::Choice;
pub use table::Table;

use job::Job;
use std::path::{Path, PathBuf};

/// Format of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A folder of CSV files, one a table.
    Csv,
    /// A folder of Parquet files, one a table.
    Parquet,
    /// One MAT-file of level 5, a structure a table.
    Mat,
    /// Ground track and true track for maps.
    Kml,
    /// MCAP with messages of ROS 2, and those of a live run.
    RosbagMcap,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 5] = [Self::Csv, Self::Parquet, Self::Mat, Self::Kml, Self::RosbagMcap];

    /// Name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Mat => "mat",
            Self::Kml => "kml",
            Self::RosbagMcap => "rosbag-mcap",
        }
    }

    /// Format of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.name() == name)
    }

    /// End of the name of the file or folder that is written by default.
    #[must_use]
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::Csv => "-csv",
            Self::Parquet => "-parquet",
            Self::Mat => ".mat",
            Self::Kml => ".kml",
            Self::RosbagMcap => "-ros.mcap",
        }
    }

    /// True if the format has tables, of which some can be chosen.
    #[must_use]
    pub const fn has_tables(self) -> bool {
        matches!(self, Self::Csv | Self::Parquet | Self::Mat)
    }
}

/// Result of an export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// Files that were written.
    pub files: Vec<PathBuf>,
    /// Sentences about what the export doesn't have.
    pub notes: Vec<String>,
}

/// Exports a recording to a file or folder `out`.
///
/// # Errors
/// If the recording can't be read or has nothing for the format, a file is in the way and `force` is false, or the
/// operating system refuses.
pub fn export(
    choice: &Choice,
    format: Format,
    out: &Path,
    force: bool,
) -> Result<Exported, ExportFailure> {
    let job = Job::new(choice, out, force)?;
    if job.survey.tables.is_empty() {
        return Err(ExportFailure::Nothing {
            path: choice.recording.clone(),
            reason: "the chosen tables have no rows".to_owned(),
        });
    }
    let files = match format {
        Format::Csv => csv::write(&job)?,
        Format::Parquet => parquet::write(&job)?,
        Format::Mat => mat::write(&job)?,
        Format::Kml => kml::write(&job)?,
        Format::RosbagMcap => rosbag::write(&job)?,
    };
    Ok(Exported { files, notes: job.survey.notes() })
}
