//! The list of the protocols, and the choice of one by its name.

use super::framing::ProtocolFacts;
use crate::Reading;
use crate::described::{DescribedDecoder, LinesDecoder, RecordsDecoder};
use crate::encoding::CannotCarry;
use crate::framing::{FramingEvent, ReadingCounters};
use crate::novatel::{CountScale, NovAtel, NovatelDecoder};

/// Makes everything that there is once for each protocol: `Variant: module, Decoder, Encoder`. A module has
/// `FACTS` and the two types.
macro_rules! protocols {
    ($($variant:ident: $module:ident, $decoder:ident, $encoder:ident;)+) => {
        /// A protocol on a line of bytes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Protocol {
            $(#[doc = concat!("[`crate::", stringify!($module), "`].")] $variant,)+
        }

        impl Protocol {
            /// All protocols.
            pub const ALL: [Self; [$(stringify!($variant)),+].len()] = [$(Self::$variant),+];

            /// Facts of the protocol.
            #[must_use]
            pub const fn facts(self) -> &'static ProtocolFacts {
                match self {
                    $(Self::$variant => const { &crate::$module::FACTS },)+
                }
            }
        }

        /// Decoder of any protocol.
        #[derive(Clone, Debug)]
        #[expect(
            clippy::large_enum_variant,
            reason = "there is one for each port, and nothing to allocate"
        )]
        pub enum AnyDecoder {
            $(#[doc = concat!("[`crate::", stringify!($module), "`].")] $variant(crate::$module::$decoder),)+
            /// [`crate::described`], which no [`Protocol`] names: it needs a description.
            Described(DescribedDecoder),
            /// Records of one length, likewise.
            Records(RecordsDecoder),
            /// Lines of text, likewise.
            Lines(LinesDecoder),
        }

        impl AnyDecoder {
            /// Makes a decoder that has received nothing.
            #[must_use]
            pub fn new(protocol: Protocol) -> Self {
                match protocol {
                    $(Protocol::$variant => Self::$variant(crate::$module::$decoder::default()),)+
                }
            }

            /// Takes bytes up to the end of the next frame with an event, and returns the event. Returns
            /// `None` when all bytes are taken: call it until then.
            #[inline]
            pub fn next(&mut self, bytes: &mut &[u8]) -> Option<FramingEvent> {
                match self {
                    $(Self::$variant(decoder) => decoder.next(bytes),)+
                    Self::Described(decoder) => decoder.next(bytes),
                    Self::Records(decoder) => decoder.next(bytes),
                    Self::Lines(decoder) => decoder.next(bytes),
                }
            }

            /// Ends the input, also after a long silence. Call it until it returns `None`.
            pub fn end(&mut self) -> Option<FramingEvent> {
                match self {
                    $(Self::$variant(decoder) => decoder.end(),)+
                    Self::Described(decoder) => decoder.end(),
                    Self::Records(decoder) => decoder.end(),
                    Self::Lines(decoder) => decoder.end(),
                }
            }

            /// Counts of the traffic so far.
            #[must_use]
            pub fn counters(&self) -> &ReadingCounters {
                match self {
                    $(Self::$variant(decoder) => decoder.counters(),)+
                    Self::Described(decoder) => decoder.counters(),
                    Self::Records(decoder) => decoder.counters(),
                    Self::Lines(decoder) => decoder.counters(),
                }
            }
        }

        /// Encoder of any protocol.
        #[derive(Clone, Debug)]
        pub enum AnyEncoder {
            $(#[doc = concat!("[`crate::", stringify!($module), "`].")] $variant(crate::$module::$encoder),)+
        }

        impl AnyEncoder {
            /// Makes an encoder that has sent nothing.
            #[must_use]
            pub fn new(protocol: Protocol) -> Self {
                match protocol {
                    $(Protocol::$variant => Self::$variant(crate::$module::$encoder::default()),)+
                }
            }

            /// Encodes a reading as a frame.
            ///
            /// # Errors
            /// If the reading lacks a value that the protocol needs.
            pub fn encode(&mut self, reading: &Reading) -> Result<&[u8], CannotCarry> {
                match self {
                    $(Self::$variant(encoder) => encoder.encode(reading),)+
                }
            }
        }
    };
}

// A new protocol stands last: the fuzzer's inputs choose one by its place.
protocols! {
    VectorNav: vectornav, VectorNavDecoder, VectorNavEncoder;
    Xsens: xsens, XsensDecoder, XsensEncoder;
    NovAtel: novatel, NovatelDecoder, NovatelEncoder;
    Sbg: sbg, SbgDecoder, SbgEncoder;
    Octant: own, OwnDecoder, OwnEncoder;
}

impl AnyDecoder {
    /// Makes a decoder that has received nothing, for a unit whose counts have a given size. Only NovAtel's
    /// protocol leaves it to the kind of unit; the others don't need it.
    #[must_use]
    pub fn scaled(protocol: Protocol, scale: Option<CountScale>) -> Self {
        match protocol {
            Protocol::NovAtel => Self::NovAtel(NovatelDecoder::new(NovAtel { scale })),
            other => Self::new(other),
        }
    }
}

impl AnyDecoder {
    /// Notes that what comes next may begin anywhere, as behind a new connection; call it after [`Self::end`]. Frames
    /// have a beginning that is looked for; lines of text have one where the line before them ends.
    pub fn begin_anywhere(&mut self) {
        if let Self::Lines(decoder) = self {
            decoder.begin_anywhere();
        }
    }

    /// Ends a datagram; call it until it returns `None`. A frame with a checksum may continue in the next one. Nothing tells
    /// a frame without one that continues from one whose rest was lost: its piece is dropped. A line may end with its
    /// datagram.
    pub fn end_of_datagram(&mut self) -> Option<FramingEvent> {
        match self {
            Self::Lines(decoder) => decoder.end_of_datagram(),
            Self::Described(decoder) if !decoder.protocol().has_checksums() => decoder.end(),
            _ => None,
        }
    }

    /// True if every frame has a checksum, which alone tells whether pieces of a frame belong together.
    #[must_use]
    pub fn has_checksums(&self) -> bool {
        match self {
            Self::Described(decoder) => decoder.protocol().has_checksums(),
            Self::Lines(decoder) => decoder.has_checksums(),
            // Pieces of a file follow each other.
            Self::Records(_) => true,
            _ => true,
        }
    }
}

impl Protocol {
    /// Name of the protocol in a scenario.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.facts().name
    }

    /// Protocol of a name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|protocol| protocol.name() == name)
    }
}
