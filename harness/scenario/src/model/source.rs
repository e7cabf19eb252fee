//! Source of the samples.

use super::file_name::FileName;
use super::fmu::Fmu;
use super::instrument::Instrument;
use crate::recorded::{McapMapping, TextMapping};

/// Source of the samples.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
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
    /// An FMU: Octant's plant, another instrument, or the ship below Octant's plant.
    Fmu(Box<Fmu>),
    /// A real instrument on a port.
    Live(Instrument),
}

impl Source {
    /// True for a recording, whose samples don't follow gimbal commands.
    #[must_use]
    pub fn is_recorded(&self) -> bool {
        matches!(self, Self::Replay { .. } | Self::Text(_))
    }

    /// True if this program's plant makes the samples; an FMU may move its case.
    #[must_use]
    pub fn has_plant(&self) -> bool {
        match self {
            Self::Plant => true,
            Self::Fmu(fmu) => fmu.is_motion(),
            Self::Replay { .. } | Self::Text(_) | Self::Live(_) => false,
        }
    }
}
