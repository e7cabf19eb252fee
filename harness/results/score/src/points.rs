//! Points of a run over its time, as an observer notes them and a report draws them.

use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Innovation, Parameters};

/// Parameters and σ at one time of the calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterPoint {
    /// Hours since the start of the calibration.
    pub hours: f64,
    /// Estimates.
    pub estimate: Parameters,
    /// 1σ, SI, in the order of [`octant_sample::parameters::NAMES`].
    pub sigma: [f64; PARAMETER_COUNT],
}

/// Normalized innovation squared of one measurement of three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NisPoint {
    /// Hours since the start of the calibration.
    pub hours: f64,
    /// NIS.
    pub nis: f64,
    /// Innovation of each axis, where the core tells it.
    pub innovation: Option<Innovation>,
}

/// Gimbal angles at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GimbalPoint {
    /// Hours since the start of the run.
    pub hours: f64,
    /// Inner gimbal, deg.
    pub azimuth_deg: f64,
    /// Outer gimbal, deg.
    pub roll_deg: f64,
    /// True while the gimbals move.
    pub moving: bool,
    /// Stop of the calibration that the core reports, from 0 over all passes; `None` in other modes.
    pub stop: Option<u16>,
}

/// Health event that the core reported.
#[derive(Clone, Debug, PartialEq)]
pub struct HealthEvent {
    /// Hours since the start of the run.
    pub hours: f64,
    /// Duration of the event's cause, s.
    pub duration_s: f64,
    /// Name of the event.
    pub name: String,
    /// Meaning in this run.
    pub detail: String,
}
