//! `octant campaign merge`: the tables of all parts.

use super::planned::read;
use crate::failure::Failure;
use crate::place::{CampaignPlace, Needs};
use crate::terminal::{print, tell_account};
use octant_base::number::counted;
use octant_campaign::execute::Shard;
use octant_campaign::merge::results;
use octant_campaign::merge::{self, MergeError};
use octant_campaign::plan::Plan;
use octant_campaign::store::CampaignResults;
use octant_verdict::Verdict;
use std::path::{Path, PathBuf};

impl From<MergeError> for Failure {
    fn from(error: MergeError) -> Self {
        Self::of(&error).failed()
    }
}

/// Merges the tables of all parts, here or on object storage.
pub(super) fn command(folder: &Path, others: &[PathBuf]) -> Result<Verdict, Failure> {
    let mut place = CampaignPlace::of(folder, Needs::Results)?;
    let folder = &place.folder().to_owned();
    let plan = read(folder)?;
    if place.is_stored() {
        tables(&plan, &place)?;
    }
    let mut folders = vec![folder.to_owned()];
    folders.extend_from_slice(others);
    let end = merge::end(&plan, &folders)?;
    let merged = merge::merge(&plan, &folders, folder, end)?;
    place.put_back()?;
    tell_account(&merged.account);
    let missing = match merged.missing {
        0 => String::new(),
        missing => format!(", {missing} without a result yet"),
    };
    print(&format!(
        "{} of {} from {}{missing}\n",
        merged.cases,
        counted(end, "case", "cases"),
        counted(merged.parts, "part", "parts")
    ))?;
    for (table, _) in results::TABLES {
        print(&format!("{}\n", place.shown(&merge::merged(folder, table))))?;
    }
    Ok(if merged.missing == 0 { Verdict::Pass } else { Verdict::Inconclusive })
}

/// Writes the tables of a campaign on object storage, where workers leave results alone, as those of one part.
fn tables(plan: &Plan, place: &CampaignPlace) -> Result<(), Failure> {
    let bench = |error: &dyn std::fmt::Display| Failure::bench(error).failed();
    let stored = CampaignResults::open(place.folder()).map_err(|error| bench(&error))?;
    for case in &plan.cases {
        if let Some(second) = stored.differing(&case.id).map_err(|error| bench(&error))? {
            return Err(Failure::bench(format!(
                "failed to merge {}: case {} has another result in {}: the same case has to come to the same result",
                place.shown(place.folder()),
                case.id,
                second.path().file_name().unwrap_or_default().to_string_lossy()
            )));
        }
    }
    let there = |index: &usize| plan.cases.get(*index).is_some_and(|case| stored.has(&case.id));
    let cases = (0..plan.cases.len()).filter(there);
    results::tables(plan, place.folder(), cases, |table| {
        merge::part(place.folder(), Shard::WHOLE, table)
    })
    .map_err(|error| bench(&error))
}
