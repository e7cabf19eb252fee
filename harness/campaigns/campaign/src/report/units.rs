//! Units of errors on the page of a campaign: those that are chosen, else those of its scenarios.

use super::error::ReportError;
use super::sites;
use crate::plan::Plan;
use octant_base::display::{DisplayUnits, UnitChoice};
use std::path::Path;

/// Units of errors on the page, with the site of each case.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignUnits {
    /// Units of errors that no site changes: radial errors, attitude, velocity.
    shown: DisplayUnits,
    /// Units that were chosen, in place of the scenarios'.
    chosen: Option<UnitChoice>,
    /// Sites of the cases, or the reason why they aren't known.
    sites: Result<CaseSites, String>,
    /// Quantities of which the scenarios have several units.
    several: Vec<&'static str>,
}

/// Sites of cases.
#[derive(Clone, Debug, PartialEq)]
struct CaseSites {
    /// Length of a minute of arc of latitude and of longitude at each site, m.
    arcmin_m: Vec<[f64; 2]>,
    /// Site of each case, by its place among them.
    places: Vec<u32>,
}

impl CampaignUnits {
    /// Takes the units of the scenarios, where all of them have the same, else the defaults. Without the
    /// files of the scenarios the units are the defaults.
    pub(super) fn of(plan: &Plan, folder: &Path) -> Self {
        let mut shown = DisplayUnits::default();
        let (mut several, mut lengths) = (Vec::new(), Err("there is no case".to_owned()));
        match sites::of_cases(plan, folder) {
            Err(error) => lengths = Err(error.to_string()),
            Ok((all, places)) => {
                if let Some(first) = all.first() {
                    let mut agree = |quantity, same: fn(&DisplayUnits, &DisplayUnits) -> bool| {
                        let agrees = all.iter().all(|other| same(first, other));
                        if !agrees {
                            several.push(quantity);
                        }
                        agrees
                    };
                    if agree("position", |a, b| a.position == b.position) {
                        shown.position = first.position;
                    }
                    if agree("attitude", |a, b| a.attitude == b.attitude) {
                        shown.attitude = first.attitude;
                    }
                    if agree("velocity", |a, b| a.velocity == b.velocity) {
                        shown.velocity = first.velocity;
                    }
                    let arcmin_m = all.iter().map(|units| units.arcmin_m).collect();
                    lengths = Ok(CaseSites { arcmin_m, places });
                }
            }
        }
        Self { shown, chosen: None, sites: lengths, several }
    }

    /// Replaces the units that are chosen.
    ///
    /// # Errors
    /// If positions are to be distances, and the sites of the cases aren't known.
    pub(super) fn choose(&mut self, choice: UnitChoice) -> Result<(), ReportError> {
        let shown = self.shown.with(choice);
        if let (true, Err(reason)) = (shown.position.is_distance(), &self.sites) {
            return Err(ReportError::Units { unit: shown.position.name(), reason: reason.clone() });
        }
        self.several.retain(|quantity| match *quantity {
            "position" => choice.position.is_none(),
            "attitude" => choice.attitude.is_none(),
            _ => choice.velocity.is_none(),
        });
        (self.shown, self.chosen) = (shown, Some(choice));
        Ok(())
    }

    /// Units that were chosen, in place of the scenarios'.
    #[must_use]
    pub fn chosen(&self) -> Option<UnitChoice> {
        self.chosen
    }

    /// Units of errors that no site changes. Those of latitude and longitude are [`CampaignUnits::at`] a case.
    #[must_use]
    pub fn shown(&self) -> &DisplayUnits {
        &self.shown
    }

    /// Units of errors at the site of a case, by its place in the plan.
    #[must_use]
    pub fn at(&self, case: usize) -> DisplayUnits {
        let length = self.sites.as_ref().ok().and_then(|sites| {
            let place = sites.places.get(case)?;
            sites.arcmin_m.get(*place as usize)
        });
        DisplayUnits { arcmin_m: length.copied().unwrap_or(self.shown.arcmin_m), ..self.shown }
    }

    /// Units of errors at the site that all of these cases have; `None` if they have several, and positions
    /// are distances.
    #[must_use]
    pub fn at_all(&self, cases: impl IntoIterator<Item = usize>) -> Option<DisplayUnits> {
        if !self.shown.position.is_distance() {
            return Some(self.shown);
        }
        let mut all = cases.into_iter().map(|case| self.at(case));
        let Some(first) = all.next() else { return Some(self.shown) };
        all.all(|other| other == first).then_some(first)
    }

    /// True if the page has the units of `statistics.json`.
    #[must_use]
    pub fn are_default(&self) -> bool {
        self.shown == DisplayUnits::default()
    }

    /// Remark about units that the scenarios don't agree on.
    #[must_use]
    pub fn remark(&self) -> Option<String> {
        if self.several.is_empty() {
            return None;
        }
        let (quantities, defaults) = (self.several.join(" and "), DisplayUnits::default());
        let shown: Vec<&str> = self
            .several
            .iter()
            .map(|quantity| match *quantity {
                "position" => defaults.position.name(),
                "attitude" => defaults.attitude().name,
                _ => defaults.velocity().name,
            })
            .collect();
        Some(format!(
            "The scenarios have several units of {quantities} in [display]: the page has {}. --units chooses \
             others.",
            shown.join(" and ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn units(sites: Result<CaseSites, String>) -> CampaignUnits {
        CampaignUnits {
            shown: DisplayUnits::default(),
            chosen: None,
            sites,
            several: vec!["position", "velocity"],
        }
    }

    #[test]
    fn a_distance_needs_the_site_of_each_case() {
        let mut unknown = units(Err("read short.toml: it is gone".to_owned()));
        let choice = |text: &str| text.parse::<UnitChoice>().unwrap();
        let error = unknown.choose(choice("m,deg")).unwrap_err().to_string();
        assert!(error.contains("short.toml") && error.contains("arcmin"), "{error}");
        assert!(unknown.are_default(), "nothing is chosen by halves");
        unknown.choose(choice("deg")).unwrap();
        assert_eq!(unknown.shown().attitude().name, "deg");
        let arcmin_m = vec![[1850.0, 1850.0], [1850.0, 925.0]];
        let mut known = units(Ok(CaseSites { arcmin_m, places: vec![0, 1] }));
        assert!(known.at_all([0, 1]).is_some(), "minutes of arc are the same everywhere");
        assert!(known.remark().unwrap().contains("position and velocity"));
        known.choose(choice("km")).unwrap();
        assert!(known.remark().unwrap().contains("units of velocity in"));
        assert_eq!([0, 1].map(|case| known.at(case).longitude().of(2.0)), [3.7, 1.85]);
        assert!(known.at_all([0, 1]).is_none() && known.at_all([1]).is_some());
        known.choose(choice("km,kn")).unwrap();
        assert_eq!(known.remark(), None);
    }
}
