//! Common parts of the clock faults: the clocks that are wrong, and their error.

use crate::catalogue::{FaultParameter, Takes};
use crate::setup::FaultBuildError;
use crate::values::Values;
use octant_sample::Epoch;

/// Parameter for the stamps that are wrong.
pub(super) const CLOCK: FaultParameter = FaultParameter {
    name: "clock",
    takes: Takes::Choice(&[
        ("instrument", "the stamps of the samples; aiding keeps its own"),
        ("reference", "the stamps of the aiding; samples keep theirs"),
        ("both", "both, as where they share a clock"),
    ]),
    default: Some("instrument"),
    doc: "Whose clock is wrong.",
};

/// Choices for a clock's error at the end of the fault.
pub(super) const AFTERWARDS: &[(&str, &str)] = &[
    ("stays", "the clock goes on at its right rate from where it is, and keeps its error"),
    ("corrected", "the clock shows the right time again at once"),
];

/// Returns whether a clock keeps its error after the fault.
pub(super) fn stays(values: &Values) -> Result<bool, FaultBuildError> {
    Ok(values.choice("afterwards")? == "stays")
}

/// The clocks that are wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clocks {
    sample: bool,
    aiding: bool,
}

impl Clocks {
    /// Reads the parameter [`CLOCK`].
    pub(super) fn of(values: &Values) -> Result<Self, FaultBuildError> {
        let choice = values.choice("clock")?;
        Ok(Self { sample: choice != "reference", aiding: choice != "instrument" })
    }

    /// Adds an error to the stamps, each by its own time, ns. Stamps stay within the range of the
    /// format: none is before zero.
    pub(super) fn shift_by(self, epoch: &mut Epoch, error_ns: impl Fn(u64) -> i64) {
        let shift = |ns: &mut u64| *ns = ns.saturating_add_signed(error_ns(*ns));
        if self.sample {
            shift(&mut epoch.sample.device_time.ns);
        }
        if let (true, Some(aiding)) = (self.aiding, &mut epoch.aiding) {
            shift(&mut aiding.device_time.ns);
        }
    }

    /// Adds the same error to the stamps.
    pub(super) fn shift(self, epoch: &mut Epoch, error_ns: i64) {
        self.shift_by(epoch, |_| error_ns);
    }
}

/// Reads a time to the nearest nanosecond, which must not be zero.
pub(super) fn nanoseconds(values: &Values, name: &'static str) -> Result<i64, FaultBuildError> {
    let seconds = values.quantity(name)?;
    match to_ns(seconds * 1e9) {
        0 => {
            let problem = alloc::format!("{seconds} s, at least half a nanosecond is expected");
            Err(FaultBuildError::value(name, problem))
        }
        ns => Ok(ns),
    }
}

/// Rounds to the nearest nanosecond; saturates.
pub(super) fn to_ns(ns: f64) -> i64 {
    libm::round(ns) as i64
}
