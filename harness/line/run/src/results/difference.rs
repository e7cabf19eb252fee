//! Compares a run with its twin: the run without its faults, on the same instrument with the same
//! noise.

use super::method::MethodRun;
use crate::bench::ended::Ended;
use octant_faults::Receipt;
use octant_scenario::Scenario;
use octant_score::counterfactual::{Counterfactual, CounterfactualSide, counterfactual};
use octant_score::sessions::{FirstSession, PublishedPair, Sessions};
use octant_score::work::duration;

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
    let mut found = counterfactual(
        &side(run)?,
        &side(twin)?,
        &onsets,
        sample_s,
        site.latitude_rad,
        site.height_m,
    );
    let onset_s = onsets.iter().filter_map(|(_, onset_s)| *onset_s).reduce(f64::min);
    found.sessions = sessions(run, twin, onset_s).map(Box::new);
    Some(found)
}

/// Compares the answers of two sessions of a unit that may remember the first one.
fn sessions(run: &MethodRun, twin: &MethodRun, onset_s: Option<f64>) -> Option<Sessions> {
    let (faulted, clean) = (run.observed.session.as_ref()?, twin.observed.session.as_ref()?);
    let first = if faulted.session.is_first { FirstSession::Faulted } else { FirstSession::Twin };
    let dither_counts = clean.session.dither?.amplitude_counts();
    let points: [&[_]; 2] = [&faulted.points, &clean.points];
    Some(Sessions::compare(first, dither_counts, points, onset_s, &published(run, twin)))
}

/// Parameters that both runs published.
fn published<'a>(run: &'a MethodRun, twin: &'a MethodRun) -> Vec<PublishedPair<'a>> {
    let (Some(one), Some(other)) = (&run.calibration, &twin.calibration) else {
        return Vec::new();
    };
    if one.refused.is_some() || other.refused.is_some() {
        return Vec::new();
    }
    let both = one.parameters.iter().filter_map(|(name, score)| {
        let twin = other.parameters.get(name)?;
        let (estimates, sigmas) = ([score.estimate, twin.estimate], [score.sigma?, twin.sigma?]);
        Some(PublishedPair { name, estimates, sigmas })
    });
    both.collect()
}

fn side(run: &MethodRun) -> Option<CounterfactualSide<'_>> {
    Some(CounterfactualSide {
        calibration: run.calibration.as_ref(),
        navigation: run.navigation.as_ref(),
        episodes: run.observed.measurements.health.episodes(),
        trace: run.observed.trace.as_ref()?,
        stream_hash: &run.recorder.stream_hash,
        elapsed_s: run.observed.elapsed_s(),
        lacks: lacks(run),
    })
}

/// Returns why a run isn't whole.
fn lacks(run: &MethodRun) -> Option<String> {
    if let Some(broke) = &run.observed.answers.bench_broke {
        return Some(format!("the bench failed at {}: {}", duration(broke.at_s), broke.reason));
    }
    if let Some(reason) = run.calibration.as_ref().and_then(|c| c.refused.as_ref()) {
        return Some(format!("its calibration was refused: {reason}"));
    }
    let (planned, done) = run.observed.done.planned_and_done();
    planned.short_of(&done).into_iter().next().map(|short| short.text)
}
