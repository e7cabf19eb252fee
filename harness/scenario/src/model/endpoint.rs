//! Place where the core runs.

use super::fmu::Fmu;
use octant_link::Uri;

/// Place where the core runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Endpoint {
    /// In this process.
    InProcess,
    /// In an FMU.
    Fmu(Box<Fmu>),
    /// At the other end of a wire.
    Live(Box<Live>),
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
