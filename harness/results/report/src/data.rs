//! Content of the report of one run.

use octant_base::display::DisplayUnits;
use octant_evidence::disposition::Dispositions;
use octant_sample::Parameters;
use octant_sample::parameters::PARAMETER_COUNT;
use octant_score::points::{GimbalPoint, HealthEvent, NisPoint, ParameterPoint};
use octant_score::run_series::SolutionSeries;
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
    /// Documents and clauses of the requirements by their ids, where they have one.
    pub requirement_clauses: BTreeMap<String, String>,
    /// Condition of a heading test: latitude, heading, motion.
    pub heading_condition: String,
    /// Health events, in order of time.
    pub events: Vec<HealthEvent>,
    /// Dispositions of the discrepancies.
    pub dispositions: Dispositions,
    /// Units of errors.
    pub units: DisplayUnits,
    /// Provenance of the numbers.
    pub provenance: ReportProvenance,
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

/// Provenance of the numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportProvenance {
    /// Pairs of name and value: versions, hashes, host.
    pub entries: Vec<(String, String)>,
    /// Command that makes the run again.
    pub rerun: String,
}
