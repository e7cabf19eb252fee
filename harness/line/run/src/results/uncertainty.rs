//! Uncertainty of a measure of a run: what is stated of its reference, what its files state, and the last digits of both.

use super::compared::{band, digits, of_heading_test, output_path};
use octant_scenario::Scenario;
use octant_score::heading_output::HeadingOutputScore;
use octant_score::summary::HeadingScore;
use octant_trajectory::Comparison;
use octant_verdict::decision::{DecisionRule, NavigationContext, UnknownUncertainty};

/// Values of a run for the measures that have an uncertainty of their own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<'a> {
    /// Comparison of a solution with its reference.
    pub(super) compared: Option<&'a Comparison>,
    /// Heading test.
    pub(super) heading: Option<&'a HeadingScore>,
    /// Output of a heading.
    pub(super) output: Option<HeadingOutputScore>,
}

/// Expanded uncertainty (95 %) of a measure, in its unit.
///
/// # Errors
/// If it has a reference whose uncertainty isn't stated.
pub(super) fn uncertainty(
    scenario: &Scenario,
    measure: &str,
    against: &NavigationContext,
    found: &Found<'_>,
) -> Result<f64, UnknownUncertainty> {
    let Found { compared, heading, output } = found;
    let of_resolution =
        heading.map_or(0.0, |heading| heading.resolution_error(measure.trim_matches('|')));
    if scenario.decision.rule() == DecisionRule::SimpleAcceptance {
        return Ok(0.0);
    }
    if let (Some(compared), Some(heading)) = (compared, heading) {
        let of_test = of_heading_test(compared, heading, measure, scenario);
        if let Some(uncertainty) = of_test {
            return uncertainty.map(|uncertainty| uncertainty + of_resolution);
        }
    }
    let stated = scenario.decision.uncertainty(measure, against);
    let of_file = compared.and_then(|compared| band(compared, measure, scenario));
    let known = match (stated, of_file) {
        (Ok(stated), of_file) => of_file.map_or(stated, |of_file| stated.max(of_file)),
        (Err(_), Some(of_file)) => of_file,
        (unknown, None) => return unknown,
    };
    let rounded = match (output_path(measure), output) {
        (Some(path), Some(output)) => output.uncertainty(path),
        _ => compared.map_or(0.0, |compared| digits(compared, measure, scenario)),
    };
    Ok(libm::hypot(known, rounded) + of_resolution)
}
