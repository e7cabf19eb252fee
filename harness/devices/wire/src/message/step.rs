//! Numbers of steps.

/// Number of a step, which the harness requests and the device answers, modulo 2¹⁵.
///
/// The step number isn't the sequence number of the sample: a fault may repeat, skip or change the
/// latter, and each sample delivered is a step of its own. The first step of a session has number 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct StepNumber(u16);

impl StepNumber {
    /// Number of bits.
    pub const BITS: u32 = 15;

    /// Makes a step from the lower 15 bits of a number.
    #[must_use]
    pub const fn new(number: u16) -> Self {
        Self(number & 0x7FFF)
    }

    /// Number of the step, below 2¹⁵.
    #[must_use]
    pub const fn number(self) -> u16 {
        self.0
    }

    /// The step after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        Self::new(self.0 + 1)
    }

    /// Number of steps from `earlier` to this one, from −2¹⁴ to 2¹⁴ − 1; negative if this one is
    /// earlier.
    #[must_use]
    pub const fn since(self, earlier: Self) -> i16 {
        let difference = self.0.wrapping_sub(earlier.0) & 0x7FFF;
        // The sign is bit 14: shifted to the sign bit of i16, and back.
        ((difference << 1) as i16) >> 1
    }

    /// Adds a flag in bit 15, as on the wire.
    #[inline]
    #[must_use]
    pub const fn with_flag(self, flag: bool) -> u16 {
        self.0 | (flag as u16) << 15
    }

    /// Splits the bits of the wire into the step and the flag in bit 15.
    #[inline]
    #[must_use]
    pub const fn and_flag(bits: u16) -> (Self, bool) {
        (Self::new(bits), bits >> 15 != 0)
    }
}
