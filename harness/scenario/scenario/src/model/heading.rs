//! Heading test of a marine instrument.

/// Kind of a heading test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HeadingTestKind {
    /// Settling and settle point at rest.
    Settle,
    /// Settling and settle point while the table moves, and after it stopped.
    SettleInMotion,
    /// Heading after a motion of the table.
    Scorsby,
    /// Error while the table moves.
    Dynamic,
}

/// Heading test of a scenario: one run-up or several, each from switching on to the end of the navigation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingTestSpec {
    /// Kind.
    pub test: HeadingTestKind,
    /// Number of run-ups.
    pub run_ups: u32,
    /// Time without power between two run-ups, s.
    pub off_s: f64,
    /// Resolution of the headings that are read, rad; 0: exact.
    pub resolution_rad: f64,
}

/// Switching of a unit in a run: numbers of the first sample without power and of the first one with it, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerCycle {
    /// Number of the sample before which the power is cut.
    pub off_before: u64,
    /// Number of the sample before which the power is back.
    pub on_before: u64,
}
