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
    pub(crate) const fn with_flag(self, flag: bool) -> u16 {
        self.0 | (flag as u16) << 15
    }

    /// Splits the bits of the wire into the step and the flag in bit 15.
    #[inline]
    pub(crate) const fn and_flag(bits: u16) -> (Self, bool) {
        (Self::new(bits), bits >> 15 != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_go_round() {
        assert_eq!(StepNumber::new(0x7FFF).next(), StepNumber::new(0));
        assert_eq!(StepNumber::new(2).since(StepNumber::new(0x7FFE)), 4);
        assert_eq!(StepNumber::new(0x7FFE).since(StepNumber::new(2)), -4);
        assert_eq!(StepNumber::new(5).since(StepNumber::new(5)), 0);
        assert_eq!(StepNumber::new(0x4000).since(StepNumber::new(0)), -0x4000);
        assert_eq!(StepNumber::new(0x3FFF).since(StepNumber::new(0)), 0x3FFF);
    }

    #[test]
    fn the_flag_leaves_the_number_alone() {
        for number in [0, 1, 0x1234, 0x7FFF] {
            for flag in [false, true] {
                let step = StepNumber::new(number);
                assert_eq!(StepNumber::and_flag(step.with_flag(flag)), (step, flag));
            }
        }
    }
}
