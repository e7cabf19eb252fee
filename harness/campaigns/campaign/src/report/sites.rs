//! Display units of each case, at its site: the length of a minute of longitude depends on the latitude.

use crate::against::EnsembleComparison;
use crate::plan::shared::SharedText;
use crate::plan::{Case, Plan, PlanError};
use octant_base::display::DisplayUnits;
use std::collections::HashMap;
use std::path::Path;

/// Tables of a scenario on which its display units depend.
const TABLES: [&str; 2] = ["site", "display"];

/// Display units of a case's scenario, at its site. The scenario's file may be gone, as long as the folder
/// of the campaign has a copy.
///
/// # Errors
/// If neither is the planned one, or the scenario isn't valid.
pub fn of_case(plan: &Plan, folder: &Path, case: &Case) -> Result<DisplayUnits, PlanError> {
    let planned = plan.planned(case)?;
    // The reader knows the file, not the copy.
    let copy = |error| planned.copied(folder).scenario(case).map_err(|_| error);
    Ok(planned.scenario(case).or_else(copy)?.display)
}

/// Display units of an ensemble, whose cases differ by their seeds alone, at its site.
///
/// # Errors
/// As for [`of_case`]; also if the plan has no such case.
pub fn of_ensemble(
    plan: &Plan,
    folder: &Path,
    ensemble: &EnsembleComparison,
) -> Result<DisplayUnits, PlanError> {
    let case = ensemble.place(plan).and_then(|place| plan.cases.get(place));
    let case = case.ok_or_else(|| PlanError::Contradiction {
        campaign: plan.campaign.clone(),
        reason: format!("no case is of scenario {:?} with its settings", ensemble.scenario),
    })?;
    of_case(plan, folder, case)
}

/// Display units of the cases of a plan: all that occur, and the place of each case's among them.
///
/// # Errors
/// As for [`of_case`].
pub(crate) fn of_cases(
    plan: &Plan,
    folder: &Path,
) -> Result<(Vec<DisplayUnits>, Vec<u32>), PlanError> {
    // Draws differ from case to case, but few of them are of the site.
    let mut known: HashMap<(&str, Vec<&str>), u32> = HashMap::new();
    let (mut all, mut places) = (Vec::new(), Vec::with_capacity(plan.cases.len()));
    for case in &plan.cases {
        let of_site = case.set.iter().map(SharedText::as_str).filter(|entry| is_of_site(entry));
        let key = (case.scenario.as_str(), of_site.collect());
        let at = match known.get(&key) {
            Some(at) => *at,
            None => {
                all.push(of_case(plan, folder, case)?);
                // A plan has at most ten million cases.
                *known.entry(key).or_insert(u32::try_from(all.len() - 1).unwrap_or(u32::MAX))
            }
        };
        places.push(at);
    }
    Ok((all, places))
}

/// True if a setting, `KEY=VALUE`, is of a table on which the display units depend.
fn is_of_site(setting: &str) -> bool {
    let name = setting.trim_start().split(|c: char| !(c.is_alphanumeric() || c == '_')).next();
    name.is_some_and(|name| TABLES.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_of_the_site_are_told_from_others() {
        for setting in
            ["site.latitude=60 deg", " site={ latitude = \"60 deg\" }", "display.position=\"m\""]
        {
            assert!(is_of_site(setting), "{setting}");
        }
        for setting in ["sites.latitude=60 deg", "imu.site=1", "motion.kind=\"static\"", ""] {
            assert!(!is_of_site(setting), "{setting}");
        }
    }
}
