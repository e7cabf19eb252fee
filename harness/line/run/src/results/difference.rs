//! Compares a run with its twin: the run without its faults, on the same instrument with the same
//! noise.

use super::method::MethodRun;
use crate::bench::ended::Ended;
use octant_faults::Receipt;
use octant_scenario::Scenario;
use octant_score::counterfactual::{Counterfactual, CounterfactualSide, counterfactual};

/// Returns the effects of a run's faults, if it has a twin and both came to their end.
#[must_use]
pub fn difference(scenario: &Scenario, run: &MethodRun) -> Option<Counterfactual> {
    between(scenario, run, run.twin.as_deref()?)
}

/// Returns the effects of a run's faults, compared with a twin that may be shared by many runs.
#[must_use]
pub fn between(scenario: &Scenario, run: &MethodRun, twin: &MethodRun) -> Option<Counterfactual> {
    if [run, twin]
        .iter()
        .any(|side| matches!(side.ended, Ended::Cancelled | Ended::Broken | Ended::Lost))
    {
        return None;
    }
    let sample_s = scenario.sample_period_ns as f64 * 1e-9;
    let onset_s = |receipt: &Receipt| receipt.first_sample.map(|k| (k - 1) as f64 * sample_s);
    let onsets: Vec<_> =
        run.receipts.iter().map(|receipt| (receipt.id.clone(), onset_s(receipt))).collect();
    let site = &scenario.site;
    Some(counterfactual(
        &side(run)?,
        &side(twin)?,
        &onsets,
        sample_s,
        site.latitude_rad,
        site.height_m,
    ))
}

fn side(run: &MethodRun) -> Option<CounterfactualSide<'_>> {
    Some(CounterfactualSide {
        calibration: run.calibration.as_ref(),
        navigation: run.navigation.as_ref(),
        episodes: run.observed.measurements.health.episodes(),
        trace: run.observed.trace.as_ref()?,
        stream_hash: &run.recorder.stream_hash,
        elapsed_s: run.observed.elapsed_s(),
    })
}
