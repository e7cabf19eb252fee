//! Content of the report of one run.

use super::series::SolutionSeries;
use octant_base::display::DisplayUnits;
use octant_evidence::disposition::Dispositions;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_sample::{Innovation, Parameters};
use octant_score::summary::Summary;
use std::collections::BTreeMap;

/// Content of the report. Missing parts are left out of the page, or reported as missing.
#[derive(Clone, Debug)]
pub struct ReportData {
    /// The summary of the run.
    pub summary: Summary,
    /// Setting of the run, in pairs of name and value: site, motion, instrument.
    pub facts: Vec<(String, String)>,
    /// Names that the source has for the body's axes; `None` where it has the same.
    pub axes_of_source: Option<String>,
    /// True parameters, SI, for the convergence of the errors; `None` where they aren't known.
    pub truth: Option<Parameters>,
    /// Convergence of the parameters during the calibration; any rate, 100 to 1000 points look
    /// best.
    pub convergence: Vec<ParameterPoint>,
    /// Normalized innovation squared of every measurement.
    pub nis: Vec<NisPoint>,
    /// Gimbal angles of the whole run; any rate that shows the moves.
    pub gimbals: Vec<GimbalPoint>,
    /// Stops of the calibration, over all passes.
    pub stops: Vec<StopLabel>,
    /// Errors of attitude and velocity over the navigation.
    pub solution: SolutionSeries,
    /// The same of the baseline; empty without one.
    pub baseline_solution: SolutionSeries,
    /// Errors of attitude and velocity over a calibration by a filter, in hours of the run.
    pub calibration_errors: SolutionSeries,
    /// The same of the baseline; empty without one.
    pub baseline_calibration_errors: SolutionSeries,
    /// Time of the run at which the navigation began, h; `None` without one.
    pub navigation_start_h: Option<f64>,
    /// Latitude of the site, rad; `None` if it isn't known.
    pub latitude_rad: Option<f64>,
    /// Interval of the samples, s; `None` if it isn't known.
    pub sample_period_s: Option<f64>,
    /// Covariance of the parameters at the end of the calibration, SI, in the order of
    /// [`octant_sample::parameters::NAMES`]; parameters that were not estimated have variance NaN.
    pub covariance: Option<Box<[[f64; PARAMETER_COUNT]; PARAMETER_COUNT]>>,
    /// Texts of the requirements by their ids.
    pub requirement_texts: BTreeMap<String, String>,
    /// Health events, in order of time.
    pub events: Vec<HealthEvent>,
    /// Dispositions of the discrepancies.
    pub dispositions: Dispositions,
    /// Units of errors.
    pub units: DisplayUnits,
    /// Provenance of the numbers.
    pub provenance: ReportProvenance,
}

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

/// Label of a stop of the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct StopLabel {
    /// Planned angle of the inner gimbal, deg.
    pub azimuth_deg: f64,
    /// Planned angle of the outer gimbal, deg.
    pub roll_deg: f64,
    /// Number and position, such as `7 of 19, position 3 of 8`.
    pub text: String,
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

/// Provenance of the numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportProvenance {
    /// Pairs of name and value: versions, hashes, host.
    pub entries: Vec<(String, String)>,
    /// Command that makes the run again.
    pub rerun: String,
}
