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

impl HeadingTestSpec {
    /// Time from the first switching on to the last switching off, pauses among it, s, of run-ups of this length.
    #[must_use]
    pub fn lasts_s(&self, run_up_s: f64) -> f64 {
        let run_ups = f64::from(self.run_ups);
        run_ups * run_up_s + (run_ups - 1.0).max(0.0) * self.off_s
    }

    /// Times within which a unit is without power, s since the first switching on: from switching off to switching on.
    pub fn pauses_s(&self, run_up_s: f64) -> impl Iterator<Item = [f64; 2]> + use<> {
        let every_s = run_up_s + self.off_s;
        (1..self.run_ups).map(move |number| {
            let on_s = f64::from(number) * every_s;
            [f64::from(number - 1) * every_s + run_up_s, on_s]
        })
    }
}

/// Switching of a unit in a run: numbers of the first sample without power and of the first one with it, from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerCycle {
    /// Number of the sample before which the power is cut.
    pub off_before: u64,
    /// Number of the sample before which the power is back.
    pub on_before: u64,
}
