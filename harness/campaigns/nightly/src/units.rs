//! Units of errors on the trend page: those that are chosen, else those of each scenario.
//!
//! The history keeps percentiles over the cases, and not the latitude of each case: a percentile of minutes
//! of longitude can't become one of distances. Position errors therefore stay in minutes of arc, and radial
//! errors in nautical miles.

use super::history::History;
use super::night::nights;
use octant_base::display::{DisplayUnits, PositionUnit, UnitChoice};
use octant_campaign::plan::{FILE_NAME, Plan};
use octant_campaign::report::sites;
use std::collections::BTreeMap;
use std::path::Path;

/// Unit that the trend page can't have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "found {unit:?} as the unit of position: the history keeps percentiles over the cases in minutes of arc, and \
     the length of a minute of longitude depends on the latitude of each case; expected arcmin, which leaves \
     radial errors in nmi, or units of attitude and velocity alone"
)]
pub struct TrendUnitError {
    /// Name of the unit.
    unit: &'static str,
}

/// Units of errors on the trend page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrendUnits {
    /// Units of a scenario, by campaign and scenario.
    of: BTreeMap<(String, String), DisplayUnits>,
    chosen: UnitChoice,
}

impl TrendUnits {
    /// Creates the units that scenarios have, by campaign and scenario, and those that are chosen for all.
    #[must_use]
    pub fn new(of: BTreeMap<(String, String), DisplayUnits>, chosen: UnitChoice) -> Self {
        Self { of, chosen }
    }

    /// Checks units that are chosen for the page.
    ///
    /// # Errors
    /// If positions are to be distances.
    pub fn check(choice: UnitChoice) -> Result<(), TrendUnitError> {
        match choice.position {
            Some(position) if position.is_distance() => {
                Err(TrendUnitError { unit: position.name() })
            }
            _ => Ok(()),
        }
    }

    /// Finds the units of every scenario of a history: those of its `[display]` in the newest night whose
    /// folder has its plan. A scenario that was changed or removed since then has the defaults.
    #[must_use]
    pub fn read(folder: &Path, history: &History, chosen: UnitChoice) -> Self {
        let mut found = BTreeMap::new();
        let mut plans: BTreeMap<String, Option<Plan>> = BTreeMap::new();
        let newest_first: Vec<String> = (history.nights().into_iter().rev())
            .filter_map(|mut night| night.remove("night"))
            .collect();
        for line in history.lines() {
            let key = (line.campaign.clone(), line.scenario.clone());
            if found.contains_key(&key) {
                continue;
            }
            let plan = plans.entry(line.campaign).or_insert_with_key(|campaign| {
                let of = |night: &String| {
                    let folder = nights(folder).join(night).join(campaign);
                    Plan::read(&folder.join(FILE_NAME)).ok()
                };
                newest_first.iter().find_map(of)
            });
            let units = plan.as_ref().and_then(|plan| {
                let case = plan.cases.iter().find(|case| case.scenario == line.scenario)?;
                // Folders of nights have no copies of scenarios.
                sites::of_case(plan, folder, case).ok()
            });
            found.insert(key, units.unwrap_or_default());
        }
        Self { of: found, chosen }
    }

    /// Units of the errors of a scenario.
    #[must_use]
    pub fn of(&self, campaign: &str, scenario: &str) -> DisplayUnits {
        let arcmin = PositionUnit::ArcMinute;
        DisplayUnits { position: arcmin, ..self.asked(campaign, scenario) }
    }

    /// Remark about a unit that a scenario has and the page can't have.
    #[must_use]
    pub fn remark(&self, campaign: &str, scenario: &str) -> Option<String> {
        let position = self.asked(campaign, scenario).position;
        position.is_distance().then(|| {
            format!(
                "Position errors stay in arcmin, and radial errors in nmi, although the scenario asks for {}: the \
                 history keeps percentiles over the cases, and the length of a minute of longitude depends on \
                 the latitude of each case.",
                position.name()
            )
        })
    }

    /// Units that the scenario and the choice ask for.
    fn asked(&self, campaign: &str, scenario: &str) -> DisplayUnits {
        let key = (campaign.to_owned(), scenario.to_owned());
        self.of.get(&key).copied().unwrap_or_default().with(self.chosen)
    }
}
