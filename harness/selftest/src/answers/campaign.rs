//! Report of a campaign of six runs that all pass.

use super::numbers::Found;
use crate::bench::CaseBench;
use crate::error::CaseSetupError;
use crate::judge::CaseOutcome;
use crate::scenarios::{ALWAYS, campaign};
use serde_json::Value;

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
    Ok(CaseOutcome { status: Some(0), numbers: all, ..CaseOutcome::default() })
}
