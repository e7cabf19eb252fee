//! Statements of a run without faults and with known noise besides its scores.

use super::method::MethodRun;
use octant_base::number;
use octant_scenario::Scenario;
use octant_score::counterfactual::Counterfactual;

/// Counts the reports of the core in the run without faults: the run itself, or its twin.
pub(super) fn false_alarms(
    scenario: &Scenario,
    run: &MethodRun,
    counterfactual: Option<&Counterfactual>,
) -> Option<u64> {
    let health = &run.observed.measurements.health;
    let own = || health.episodes().len() as u64 + health.unlisted();
    match counterfactual {
        Some(counterfactual) => Some(counterfactual.false_alarms),
        None => scenario.faults.is_empty().then(own),
    }
}

/// Says how much noise is added to the samples, and what that costs.
pub(super) fn dither_fact(scenario: &Scenario) -> Option<(String, String)> {
    let part = scenario.dither?;
    let grows = 100.0 * (libm::hypot(1.0, part) - 1.0);
    let fact = format!(
        "{} of the random walks, from the seed: the noise of the samples grows by {grows:.1} %",
        number::plain(part, 4)
    );
    Some(("dither".to_owned(), fact))
}
