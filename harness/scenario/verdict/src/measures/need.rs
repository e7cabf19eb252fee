//! Conditions without which a run doesn't have a measure.

use serde::{Serialize, Serializer};

/// Condition without which a run doesn't have a measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum MeasureNeed {
    /// A calibration.
    Calibration,
    /// States of the filter beside the parameters.
    Further,
    /// A navigation.
    Navigation,
    /// A heading test.
    Heading,
    /// Truth to compare with.
    Truth,
    /// σ that the unit states.
    Sigma,
    /// A navigation of at least one Schuler period.
    SchulerPeriod,
    /// A navigation of at least 24 h.
    Day,
    /// A navigation of at least 72 h.
    ThreeDays,
    /// A second method.
    Baseline,
    /// Faults, with their twin.
    Twin,
    /// A run by the clock.
    Clock,
    /// A device whose clock can be compared.
    DeviceClock,
    /// Noise that the bench knows to be in the samples.
    KnownNoise,
}

impl MeasureNeed {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::Calibration,
        Self::Further,
        Self::Navigation,
        Self::Heading,
        Self::Truth,
        Self::Sigma,
        Self::SchulerPeriod,
        Self::Day,
        Self::ThreeDays,
        Self::Baseline,
        Self::Twin,
        Self::Clock,
        Self::DeviceClock,
        Self::KnownNoise,
    ];

    /// Name, as in lists of measures.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibration => "calibration",
            Self::Further => "further",
            Self::Navigation => "navigation",
            Self::Heading => "heading",
            Self::Truth => "truth",
            Self::Sigma => "sigma",
            Self::SchulerPeriod => "schuler-period",
            Self::Day => "24h",
            Self::ThreeDays => "72h",
            Self::Baseline => "baseline",
            Self::Twin => "twin",
            Self::Clock => "clock",
            Self::DeviceClock => "device-clock",
            Self::KnownNoise => "known-noise",
        }
    }

    /// Meaning, in words.
    #[must_use]
    pub const fn meaning(self) -> &'static str {
        match self {
            Self::Calibration => "a calibration: [procedure.calibration]",
            Self::Further => {
                "errors beside the parameters in the filter: [procedure.calibration.further]"
            }
            Self::Navigation => "a navigation: [procedure.navigation]",
            Self::Heading => "a heading test: [procedure.heading_test]",
            Self::Truth => "truth to compare with: a simulated source, or one that delivers truth",
            Self::Sigma => {
                "a standard deviation that the unit states; of a solution a core in this process states it, \
                 with estimator = \"kalman\""
            }
            Self::SchulerPeriod => "a navigation of at least one Schuler period, 84 min",
            Self::Day => "a navigation of at least 24 h",
            Self::ThreeDays => "a navigation of at least 72 h",
            Self::Baseline => "a second method: [baseline]",
            Self::Twin => "faults and the twin without them: [[faults]], without --no-twin",
            Self::Clock => "a run by the clock: realtime.pace = \"clock\"",
            Self::DeviceClock => "a device on a port, by the clock, that exchanges its time",
            Self::KnownNoise => {
                "noise that the bench knows: a simulated instrument, or source.dither; half an hour of navigation"
            }
        }
    }
}

impl Serialize for MeasureNeed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}
