//! Source of the samples.

use super::file_name::FileName;
use super::fmu::Fmu;
use super::instrument::{Instrument, InstrumentLog};
use crate::recorded::{McapMapping, TextMapping};
use crate::trajectory::{SolutionReference, SolutionSpec};

/// Source of the samples.
#[derive(Clone, Debug, PartialEq)]
pub enum SourceSpec {
    /// Simulated.
    Plant,
    /// An MCAP file: written by this program, or by another one, with a mapping of its channel.
    Replay {
        /// The file.
        file: FileName,
        /// Mapping of a foreign file.
        mapping: Option<McapMapping>,
    },
    /// Text files of a real instrument. File names in it are as written: see [`FileName`].
    Text(TextMapping),
    /// The bytes that an instrument sent, as a file.
    Log(InstrumentLog),
    /// An FMU: Octant's plant, another instrument, or the ship below Octant's plant.
    Fmu(Box<Fmu>),
    /// A real instrument on a port.
    Live(Instrument),
    /// An instrument's own solution, with the trajectory that it is scored against.
    Solution(Box<SolutionSpec>),
}

impl SourceSpec {
    /// True for a recording, whose samples don't follow gimbal commands.
    #[must_use]
    pub fn is_recorded(&self) -> bool {
        matches!(self, Self::Replay { .. } | Self::Text(_) | Self::Log(_) | Self::Solution(_))
    }

    /// True if this program's plant makes the samples; an FMU may move its case.
    #[must_use]
    pub fn has_plant(&self) -> bool {
        self.is_plant_alone() || self.motion().is_some()
    }

    /// True if this program's plant makes the samples, and nothing else moves it.
    #[must_use]
    pub fn is_plant_alone(&self) -> bool {
        matches!(self, Self::Plant)
    }

    /// True for a simulation; `has_truth` tells whether its samples came with truth.
    #[must_use]
    pub fn is_simulated(&self, has_truth: bool) -> bool {
        match self {
            Self::Plant | Self::Fmu(_) => true,
            // An octant recording that contains truth comes from a simulation.
            Self::Replay { mapping: None, .. } => has_truth,
            Self::Replay { .. }
            | Self::Text(_)
            | Self::Log(_)
            | Self::Live(_)
            | Self::Solution(_) => false,
        }
    }

    /// The real instrument, which measures once and moves equipment.
    #[must_use]
    pub fn instrument(&self) -> Option<&Instrument> {
        match self {
            Self::Live(instrument) => Some(instrument),
            _ => None,
        }
    }

    /// The FMU.
    #[must_use]
    pub fn fmu(&self) -> Option<&Fmu> {
        match self {
            Self::Fmu(fmu) => Some(fmu),
            _ => None,
        }
    }

    /// The FMU that moves the case of this program's plant.
    #[must_use]
    pub fn motion(&self) -> Option<&Fmu> {
        self.fmu().filter(|fmu| fmu.is_motion())
    }

    /// The mapping of text files, whose raw numbers a data sheet refers to.
    #[must_use]
    pub fn text(&self) -> Option<&TextMapping> {
        match self {
            Self::Text(mapping) => Some(mapping),
            _ => None,
        }
    }

    /// Recordings from which the samples come, as written.
    #[must_use]
    pub fn recordings(&self) -> Vec<FileName> {
        match self {
            Self::Replay { file, .. } => vec![file.clone()],
            // What the bytes mean is evidence too.
            Self::Log(InstrumentLog { file, speaks, .. }) => {
                [Some(file), speaks.described_by()].into_iter().flatten().cloned().collect()
            }
            Self::Text(mapping) => {
                mapping.files.all().map(|path| FileName(path.display().to_string())).collect()
            }
            Self::Solution(spec) => std::iter::once(&spec.solution)
                .filter(|_| spec.line.is_none())
                .chain(spec.reference.file())
                .map(|trajectory| trajectory.file.clone())
                .collect(),
            Self::Plant | Self::Fmu(_) | Self::Live(_) => Vec::new(),
        }
    }

    /// Words for the times of a recording that has none of its own.
    #[must_use]
    pub fn assumed_time(&self) -> Option<String> {
        let mapping = self.text().filter(|mapping| mapping.time.is_none())?;
        Some(format!(
            "no time stamps: the time is assumed, not measured, the row's number over {} Hz",
            octant_base::number::plain(mapping.nominal_rate_hz, 9)
        ))
    }

    /// Reason for having no truth; `None` if there is some. An FMU without a map may be Octant's
    /// plant, which has it.
    pub(crate) fn without_truth(&self) -> Option<&'static str> {
        match self {
            Self::Plant | Self::Solution(_) => None,
            Self::Fmu(fmu) if fmu.is_motion() || fmu.map.is_empty() => None,
            Self::Fmu(fmu) if fmu.map.iter().any(|m| m.channel.name.starts_with("truth.")) => None,
            Self::Fmu(_) => Some("source.fmu.map has no truth"),
            Self::Replay { .. } | Self::Text(_) | Self::Log(_) => Some("the source is a recording"),
            Self::Live(_) => Some("the source is a real instrument"),
        }
    }

    /// Fact for the report, with its name; `None` for the plant alone.
    #[must_use]
    pub fn fact(&self) -> Option<(&'static str, String)> {
        match self {
            Self::Plant => None,
            Self::Replay { .. } | Self::Text(_) => {
                let time = self.assumed_time().map(|time| format!("; {time}")).unwrap_or_default();
                Some(("source", format!("recorded samples, no truth{time}")))
            }
            Self::Log(InstrumentLog { speaks, .. }) => {
                Some(("source", format!("recorded bytes of {}, no truth", speaks.told())))
            }
            Self::Solution(spec) => {
                let against = match &spec.reference {
                    SolutionReference::Unknown => "no reference".to_owned(),
                    SolutionReference::File(reference) => reference.file.short().to_owned(),
                    SolutionReference::Heading { heading_rad, .. } => format!(
                        "a true heading of {} deg",
                        octant_base::number::plain(heading_rad.to_degrees(), 9)
                    ),
                };
                Some((
                    "source",
                    format!("solution {} against {against}", spec.solution.file.short()),
                ))
            }
            Self::Fmu(fmu) => {
                let name = if fmu.is_motion() { "motion of the case" } else { "source" };
                Some((name, format!("FMU {}", fmu.file.0)))
            }
            Self::Live(Instrument { uri, speaks, .. }) => {
                Some(("source", format!("instrument at {uri}, {}, no truth", speaks.told())))
            }
        }
    }
}
