//! Report of a campaign of six runs that all pass.

use super::numbers::Found;
use crate::bench::CaseBench;
use crate::error::CaseSetupError;
use crate::judge::CaseOutcome;
use crate::scenarios::{ALWAYS, campaign};
use octant_campaign::execute::case::ResultError;
use octant_campaign::store::CampaignResults;
use serde_json::Value;
use std::path::Path;

pub(super) fn found(bench: &CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError> {
    campaign(bench, 6, ALWAYS, "")?;
    let said = bench.octant(&["campaign", "report", "campaign"])?;
    let statistics: Value = serde_json::from_slice(&bench.read("campaign/statistics.json")?)
        .map_err(|error| format!("read statistics.json: {error}; {}", said.err))?;
    let requirement = &statistics["requirements"][0];
    let mut all = Found::new();
    let mut put = |name: String, value: &Value| {
        value.as_f64().map(|value| all.insert(name.clone(), value)).ok_or(format!("find {name}"))
    };
    put("confidence of the report".to_owned(), &statistics["confidence"])?;
    put("confidence".to_owned(), &requirement["confidence"])?;
    put("lower bound".to_owned(), &requirement["lower_bound"])?;
    for at in requirement["convergence"].as_array().into_iter().flatten() {
        let runs = &at["runs"];
        put(format!("interval after {runs}, low"), &at["estimate"]["low"])?;
        put(format!("interval after {runs}, high"), &at["estimate"]["high"])?;
    }
    envelope(bench, &mut all, &statistics)?;
    Ok(CaseOutcome { status: Some(0), numbers: all, ..CaseOutcome::default() })
}

/// Collects how far the report's curves lie between the runs at the end: by the order of the runs'
/// errors, a whole number at a run and a share of the way to the next between them.
fn envelope(
    bench: &CaseBench<'_>,
    all: &mut Found,
    statistics: &Value,
) -> Result<(), CaseSetupError> {
    let envelope = &statistics["combinations"][0]["envelope"];
    let hours = numbers(&envelope["hours"]);
    let end_h = *hours.last().ok_or("find the envelope")?;
    let runs = summaries(&bench.at("campaign"))?;
    for (column, axis) in [(1, "latitude"), (2, "longitude")] {
        let at_end = |run: &Value| {
            let series = run["summary"]["navigation"]["series_hours"].as_array()?;
            let [.., from, to] = series.as_slice() else { return None };
            let (from, to) = (numbers(from), numbers(to));
            let share = (end_h - from[0]) / (to[0] - from[0]);
            Some(from[column] + share * (to[column] - from[column]))
        };
        let mut errors: Vec<f64> = runs.iter().filter_map(at_end).collect();
        errors.sort_by(f64::total_cmp);
        let curves = envelope[format!("{axis}_arcmin")].as_array().into_iter().flatten();
        for (percentile, curve) in numbers(&envelope["percentiles"]).into_iter().zip(curves) {
            let value = *numbers(curve).last().ok_or("find a curve of the envelope")?;
            let above = errors.partition_point(|error| *error <= value);
            let (Some(low), Some(high)) = (errors.get(above.wrapping_sub(1)), errors.get(above))
            else {
                return Err(format!("find the runs beside {value}").into());
            };
            let place = (above - 1) as f64 + (value - low) / (high - low);
            all.insert(format!("place of percentile {percentile} of the {axis}"), place);
        }
    }
    Ok(())
}

fn numbers(of: &Value) -> Vec<f64> {
    of.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// Reads the results of all runs.
fn summaries(folder: &Path) -> Result<Vec<Value>, CaseSetupError> {
    let failed = |error: ResultError| format!("failed to {error}");
    let results = CampaignResults::open(folder).map_err(failed)?;
    let mut all = Vec::new();
    for case in results.ids() {
        let stored = results.bytes(case).map_err(failed)?;
        // A result that isn't one leaves a run too few, which moves every place.
        all.extend(stored.and_then(|stored| serde_json::from_slice::<Value>(&stored.bytes).ok()));
    }
    Ok(all)
}
