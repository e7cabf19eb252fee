//! Time keeping of a run by the clock, as recordings and summaries have it.

use serde::{Deserialize, Serialize};

/// Timing of a run against the host's clock.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PacingRecord {
    /// Number of frames.
    pub frames: u64,
    /// Period of the frames, µs.
    pub period_us: f64,
    /// Lateness of the frames, µs.
    pub lateness_us: LatenessQuantiles,
    /// Histogram of the lateness: an upper edge, ns, and the number of frames up to it and above the
    /// edge before.
    pub lateness_histogram_ns: Vec<[u64; 2]>,
    /// Lateness over the run; absent in recordings from before it was kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateness_over_run: Option<LatenessOverRun>,
    /// Lateness above which a frame is an overrun, µs.
    pub overrun_us: f64,
    /// Number of overruns.
    pub overruns: u64,
    /// Largest number of overruns in a row.
    pub overruns_in_a_row: u64,
    /// Number of the first overrun frame, from 1.
    pub first_overrun: Option<u64>,
    /// Part of the period that 99 % of the frames left unused at least, µs.
    pub slack_p1_us: f64,
    /// Time from sending a sample to receiving its answer, µs.
    pub answer_us: LatenessQuantiles,
    /// Number of frames that ended without their answer.
    pub late_answers: u64,
    /// Number of samples whose answer never came, while later ones were answered.
    pub missed_answers: u64,
    /// Number of samples that could not be sent: the device's window or the port was full.
    pub not_sent: u64,
    /// Clock of the device against the host's; null if there was none to compare.
    pub device_clock: Option<DeviceClock>,
    /// Number of steps that found no room on their way to the recorder.
    pub dropped_records: u64,
}

/// Lateness over a run, in at most 1000 intervals of equally many frames: an entry of each list for each
/// interval, in the order of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LatenessOverRun {
    /// Number of frames of an interval; the last one may have fewer.
    pub frames_per_interval: u64,
    /// Smallest lateness, ns.
    pub least_ns: Vec<u64>,
    /// Largest lateness, ns.
    pub largest_ns: Vec<u64>,
    /// Number of overruns.
    pub overruns: Vec<u64>,
}

/// Clock of a device against the host's.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeviceClock {
    /// Offset by which it was ahead at the last exchange, µs.
    pub offset_us: f64,
    /// Bound of the error of the offset, µs.
    pub bound_us: f64,
    /// Relative rate by which it is fast; null with too few exchanges.
    pub skew_ppm: Option<f64>,
    /// Number of exchanges of the time.
    pub exchanges: u64,
}

/// Quantiles of a duration, µs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LatenessQuantiles {
    /// Median.
    pub p50: f64,
    /// 99 % quantile.
    pub p99: f64,
    /// 99.9 % quantile.
    pub p999: f64,
    /// Maximum.
    pub max: f64,
}
