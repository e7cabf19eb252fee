//! Place where the core runs.

use super::fmu::Fmu;
use octant_link::Uri;

/// Place where the core runs.
#[derive(Clone, Debug, PartialEq)]
pub enum EndpointSpec {
    /// In this process.
    InProcess,
    /// In an FMU.
    Fmu(Box<Fmu>),
    /// At the other end of a wire.
    Live(Box<Live>),
}

impl EndpointSpec {
    /// True if the core is called directly.
    #[must_use]
    pub fn is_in_process(&self) -> bool {
        matches!(self, Self::InProcess)
    }

    /// The device, which does one thing at a time.
    #[must_use]
    pub fn device(&self) -> Option<&Live> {
        match self {
            Self::Live(live) => Some(live),
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

    /// Fact for the report about the core; `None` for the one in this process.
    #[must_use]
    pub fn fact(&self) -> Option<String> {
        match self {
            Self::InProcess => None,
            Self::Fmu(fmu) => Some(format!("FMU {}", fmu.file.0)),
            Self::Live(live) => Some(format!("device at {}, in lock-step", live.uri)),
        }
    }
}

/// A device on a port.
#[derive(Clone, Debug, PartialEq)]
pub struct Live {
    /// The port.
    pub uri: Uri,
    /// Longest wait for the first hello, s.
    pub hello_s: f64,
    /// Longest wait for an answer, s.
    pub answer_s: f64,
    /// Interval after which a request is repeated, s.
    pub repeat_s: f64,
    /// Longest wait for a port that went away, s; 0: the run ends at once.
    pub reconnect_s: f64,
}
