//! Choice of a protocol by its name.

use crate::encoding::CannotCarry;
use crate::framing::{Counters, Event};
use crate::novatel::{NovAtel, Scale, scale_of};
use crate::vectornav::VectorNav;
use crate::xsens::Xsens;
use crate::{Reading, novatel, own, sbg, vectornav, xsens};

/// A protocol on a line of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// [`crate::vectornav`].
    VectorNav,
    /// [`crate::xsens`].
    Xsens,
    /// [`crate::novatel`].
    NovAtel,
    /// [`crate::sbg`].
    Sbg,
    /// [`crate::own`].
    Octant,
}

impl Protocol {
    /// All protocols.
    pub const ALL: [Self; 5] =
        [Self::VectorNav, Self::Xsens, Self::NovAtel, Self::Sbg, Self::Octant];

    /// Name of the protocol in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::VectorNav => "vectornav",
            Self::Xsens => "xsens",
            Self::NovAtel => "novatel",
            Self::Sbg => "sbg",
            Self::Octant => "octant",
        }
    }

    /// Protocol of a name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|protocol| protocol.name() == name)
    }
}

/// Decoder of any protocol.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "there is one for each port, and nothing to allocate"
)]
pub enum AnyDecoder {
    /// VectorNav.
    VectorNav(vectornav::Decoder),
    /// Xsens.
    Xsens(xsens::Decoder),
    /// NovAtel.
    NovAtel(novatel::Decoder),
    /// SBG.
    Sbg(sbg::Decoder),
    /// Octant.
    Octant(own::Decoder),
}

macro_rules! each {
    ($any:expr, $decoder:ident => $what:expr) => {
        match $any {
            AnyDecoder::VectorNav($decoder) => $what,
            AnyDecoder::Xsens($decoder) => $what,
            AnyDecoder::NovAtel($decoder) => $what,
            AnyDecoder::Sbg($decoder) => $what,
            AnyDecoder::Octant($decoder) => $what,
        }
    };
}

impl AnyDecoder {
    /// Makes a decoder that has received nothing.
    #[must_use]
    pub fn new(protocol: Protocol) -> Self {
        match protocol {
            Protocol::VectorNav => Self::VectorNav(vectornav::Decoder::new(VectorNav)),
            Protocol::Xsens => Self::Xsens(xsens::Decoder::new(Xsens::default())),
            Protocol::NovAtel => Self::NovAtel(novatel::Decoder::new(NovAtel::default())),
            Protocol::Sbg => Self::Sbg(sbg::Decoder::new(sbg::Sbg::default())),
            Protocol::Octant => Self::Octant(own::Decoder::new()),
        }
    }

    /// Takes bytes up to the end of the next frame with an event, and returns the event. Returns `None`
    /// when all bytes are taken: call it until then.
    #[inline]
    pub fn next(&mut self, bytes: &mut &[u8]) -> Option<Event> {
        each!(self, decoder => decoder.next(bytes))
    }

    /// Ends the input, also after a long silence. Call it until it returns `None`.
    pub fn end(&mut self) -> Option<Event> {
        each!(self, decoder => decoder.end())
    }

    /// Counts of the traffic so far.
    #[must_use]
    pub fn counters(&self) -> &Counters {
        each!(self, decoder => decoder.counters())
    }
}

/// Kind of unit that [`AnyEncoder`] uses for NovAtel: HG4930, which has the finest counts.
const NOVATEL_KIND: u8 = 58;

/// Encoder of any protocol.
#[derive(Clone, Debug)]
pub enum AnyEncoder {
    /// VectorNav.
    VectorNav(vectornav::Encoder),
    /// Xsens.
    Xsens(xsens::Encoder),
    /// NovAtel, binary.
    NovAtel(novatel::Encoder),
    /// SBG.
    Sbg(sbg::Encoder),
    /// Octant.
    Octant(own::Encoder),
}

impl AnyEncoder {
    /// Makes an encoder that has sent nothing.
    #[must_use]
    pub fn new(protocol: Protocol) -> Self {
        match protocol {
            Protocol::VectorNav => Self::VectorNav(vectornav::Encoder::new()),
            Protocol::Xsens => Self::Xsens(xsens::Encoder::new()),
            Protocol::NovAtel => {
                const SCALE: Scale = match scale_of(NOVATEL_KIND) {
                    Some(scale) => scale,
                    None => panic!("the kind is in the table"),
                };
                Self::NovAtel(novatel::Encoder::new(NOVATEL_KIND, SCALE))
            }
            Protocol::Sbg => Self::Sbg(sbg::Encoder::new()),
            Protocol::Octant => Self::Octant(own::Encoder::new()),
        }
    }

    /// Encodes a reading as a frame.
    ///
    /// # Errors
    /// If the reading lacks a value that the protocol needs.
    pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
        match self {
            Self::VectorNav(encoder) => encoder.encode(reading),
            Self::Xsens(encoder) => encoder.encode(reading),
            Self::NovAtel(encoder) => encoder.encode(reading),
            Self::Sbg(encoder) => encoder.encode(reading),
            Self::Octant(encoder) => encoder.encode(reading),
        }
    }
}
