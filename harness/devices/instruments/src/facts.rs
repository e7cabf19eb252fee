//! Facts that every protocol states of itself.

/// Facts of a protocol.
#[derive(Debug)]
pub struct ProtocolFacts {
    /// Name in a scenario.
    pub name: &'static str,
    /// Messages that it means, in a few words.
    pub doc: &'static str,
    /// Largest error of its resolution in an increment over 5 ms, and in the sum of all: rad and m/s.
    pub resolution: [f64; 2],
    /// Bytes that look like the beginning of a long frame, and are none.
    pub false_starts: &'static [&'static [u8]],
}
