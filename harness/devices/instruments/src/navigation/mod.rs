//! Navigation messages: what a unit with a filter of its own says of its position, velocity and attitude.
//!
//! [`NavigationDecoder`] finds them in a stream of bytes, by the framing of the unit's protocol. A message has what it
//! says to be valid: a position before its unit has one is none, and then the time alone is left. Angles are those of this project: heading from
//! north by east, pitch positive with the bow up, roll positive with the starboard side down. Velocities are north,
//! east, down; heights are above the ellipsoid.
//!
//! | protocol | messages | source |
//! |---|---|---|
//! | NovAtel | `INSPVA`, `INSPVAS`, `INSPVAX`, binary and ASCII | OEM7 Commands and Logs Reference Manual |
//! | SBG | `EKF_NAV`, `EKF_EULER`, `EKF_QUAT`, `UTC_TIME` | sbgECom's documentation of its binary messages |
//! | VectorNav | position, velocity, attitude and `InsStatus` of the common, attitude and INS groups | VN-200 and VN-300 user manuals |
//! | Xsens | `LatLon`, `AltitudeEllipsoid`, `VelocityXYZ`, `EulerAngles`, `Quaternion`, `UtcTime` | MT Low-Level Communication Protocol |

mod novatel;
mod reading;
mod sbg;
mod time;
mod vectornav;
mod xsens;

use crate::framing::{FrameDecoder, FramingEvent, ReadingCounters};
pub use novatel::NovatelNavigation;
pub use reading::{NavigationReading, NavigationSigma};
pub use sbg::SbgNavigation;
pub use time::NavigationTime;
pub use vectornav::VectorNavNavigation;
pub use xsens::XsensNavigation;

/// Protocols whose navigation messages are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NavigationProtocol {
    /// NovAtel.
    Novatel,
    /// SBG Systems' sbgECom.
    Sbg,
    /// VectorNav's binary output.
    VectorNav,
    /// Xsens' MTData2.
    Xsens,
}

impl NavigationProtocol {
    /// The messages, for errors.
    #[must_use]
    pub const fn messages(self) -> &'static str {
        match self {
            Self::Novatel => "INSPVA, INSPVAS or INSPVAX",
            Self::Sbg => "EKF_NAV",
            Self::VectorNav => "binary output with Position or PosLla",
            Self::Xsens => "MTData2 with LatLon",
        }
    }
}

/// Finds navigation messages in a stream of bytes.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one for a file")]
pub enum NavigationDecoder {
    /// NovAtel.
    Novatel(FrameDecoder<NovatelNavigation>),
    /// SBG Systems' sbgECom.
    Sbg(FrameDecoder<SbgNavigation>),
    /// VectorNav's binary output.
    VectorNav(FrameDecoder<VectorNavNavigation>),
    /// Xsens' MTData2.
    Xsens(FrameDecoder<XsensNavigation>),
}

macro_rules! each {
    ($self:ident, $decoder:ident => $what:expr) => {
        match $self {
            Self::Novatel($decoder) => $what,
            Self::Sbg($decoder) => $what,
            Self::VectorNav($decoder) => $what,
            Self::Xsens($decoder) => $what,
        }
    };
}

impl NavigationDecoder {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new(protocol: NavigationProtocol) -> Self {
        match protocol {
            NavigationProtocol::Novatel => Self::Novatel(FrameDecoder::default()),
            NavigationProtocol::Sbg => Self::Sbg(FrameDecoder::default()),
            NavigationProtocol::VectorNav => Self::VectorNav(FrameDecoder::default()),
            NavigationProtocol::Xsens => Self::Xsens(FrameDecoder::default()),
        }
    }

    /// Takes bytes up to the next event; `None` when all are taken.
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent<NavigationReading>> {
        each!(self, decoder => decoder.next(bytes))
    }

    /// Ends the input. Call it until it returns `None`.
    pub fn end(&mut self) -> Option<FramingEvent<NavigationReading>> {
        each!(self, decoder => decoder.end())
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &ReadingCounters {
        each!(self, decoder => decoder.counters())
    }
}
