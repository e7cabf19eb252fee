//! Events of a recording: what happens rarely in a run, stored as JSON.
//!
//! The fields of a payload are stored in alphabetical order.

mod bench;
mod fault_result;
mod link;
mod pacing;
mod power;

pub use bench::{
    BenchAngles, BenchAxis, BenchClock, BenchDelay, BenchPulses, BenchReadings, BenchRecord,
    BenchShared, BenchTable, BenchTime,
};
pub use fault_result::FaultResult;
pub use link::LinkRecord;
pub use pacing::{DeviceClock, LatenessOverRun, LatenessQuantiles, PacingRecord};
pub use power::{PowerReadingRecord, PowerRecord, SwitchingRecord};

use octant_realtime::schedule::Granted;
use octant_sample::parameters::{NAMES, PARAMETER_COUNT};
use serde::ser::Error;
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;
use std::collections::BTreeMap;

/// Values of the parameters by name; null where a number isn't finite.
pub type ByName = BTreeMap<String, Option<f64>>;

/// A rare event.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", content = "detail", rename_all = "kebab-case")]
pub enum Event {
    /// A real instrument and the table under it, at the end of a run.
    Bench(Box<BenchRecord>),
    /// Parameters, SI, of a calibration that ended with the stream.
    Calibration {
        /// The parameters.
        parameters: ByName,
        /// Their revision.
        revision: u32,
        /// σ, null where a parameter isn't estimated.
        sigma: ByName,
    },
    /// Failure in the middle that ended the run.
    Error {
        /// The failure.
        reason: String,
    },
    /// Onset or end of a fault.
    Fault {
        /// True for the onset.
        begins: bool,
        /// Id in the scenario.
        id: String,
        /// Kind.
        kind: String,
        /// Number of the step, from 1.
        sample: u64,
    },
    /// Processors that were starved, at the end of a run.
    Host {
        /// Scheduling of the threads that took the processors.
        scheduling: String,
        /// Time that they had together, s.
        taken_s: f64,
        /// Number of these threads.
        threads: usize,
    },
    /// Device and traffic of a run over a wire, at its end.
    Link(Box<LinkRecord>),
    /// Change of the core's mode.
    Mode {
        /// Mode before; null at the first output.
        from: Option<String>,
        /// Sequence number of the output that changed it.
        sequence: u64,
        /// The new mode.
        to: String,
    },
    /// Record of a person's part in the run: a line of `operator.jsonl`, at its end.
    Operator(Value),
    /// Time keeping so far of a run by the clock, once a second.
    Pace(Pace),
    /// Time keeping of a run by the clock, at its end.
    Pacing {
        /// Real-time settings that the host granted.
        #[serde(serialize_with = "sorted")]
        granted: Granted,
        /// Figures as in the summary.
        #[serde(serialize_with = "sorted")]
        pacing: Box<PacingRecord>,
    },
    /// The supply or the relay of a device, at the end of a run.
    Power(Box<PowerRecord>),
    /// Results of all faults, at the end of a run.
    Receipts(#[serde(serialize_with = "sorted")] Vec<FaultResult>),
    /// Refusal of a calibration.
    Refused {
        /// Reason of the refusal.
        reason: String,
    },
    /// Event of the unit under test, which a replay applies again.
    Unit {
        /// Action on the unit.
        action: UnitAction,
        /// Difference added to the stored parameters, SI; only with [`UnitAction::RestartWith`].
        #[serde(skip_serializing_if = "Option::is_none")]
        offset: Option<ByName>,
        /// Number of the step before which it happened, from 1.
        sample: u64,
    },
    /// Event of a newer or foreign recording: another kind, or other details than here.
    #[serde(untagged)]
    Other {
        /// Kind of event.
        kind: String,
        /// Details.
        detail: Value,
    },
}

/// Time keeping so far of a run by the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Number of frames that began.
    pub frames: u64,
    /// Number of frames that ended without their answer.
    pub late_answers: u64,
    /// Largest lateness since the last report, µs.
    pub latest_us: f64,
    /// Number of overruns.
    pub overruns: u64,
}

/// Action on the unit under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum UnitAction {
    /// The unit restarts.
    Restart,
    /// The unit restarts with another stored calibration.
    RestartWith,
    /// The unit loses power.
    PowerOff,
    /// Power returns.
    PowerOn,
}

impl UnitAction {
    /// Name in recordings.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Restart => "restart",
            Self::RestartWith => "restart-with",
            Self::PowerOff => "power-off",
            Self::PowerOn => "power-on",
        }
    }
}

/// Assigns the values of the parameters to their names.
#[must_use]
pub fn by_name(values: &[f64; PARAMETER_COUNT]) -> ByName {
    let finite = |value: &f64| Some(*value).filter(|value| value.is_finite());
    NAMES.iter().zip(values).map(|(name, value)| ((*name).to_owned(), finite(value))).collect()
}

/// Writes a value that has another order of fields elsewhere: the fields of a JSON value are sorted.
fn sorted<T: Serialize, S: Serializer>(value: &T, to: S) -> Result<S::Ok, S::Error> {
    serde_json::to_value(value).map_err(S::Error::custom)?.serialize(to)
}
