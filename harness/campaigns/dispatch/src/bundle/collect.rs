//! Collects the files of a plan, and makes the plan name them relative to its folder.

use super::entry_name::{self, FILES};
use super::error::BundleError;
use octant_campaign::plan::planned::hash_of_file;
use octant_campaign::plan::shared::SharedText;
use octant_campaign::plan::{BundledCampaign, Plan, PlannedFile, PlannedScenario};
use octant_scenario::Scenario;
use octant_scenario::campaign::Campaign;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// Files of a plan.
#[derive(Debug)]
pub(super) struct Collected {
    /// The plan, with relative names of files.
    pub(super) plan: Plan,
    /// File of each entry.
    pub(super) files: BTreeMap<String, CollectedFile>,
    /// Devices and programs outside that cases talk to.
    pub(super) outside: BTreeSet<String>,
}

/// File of an entry.
#[derive(Debug)]
pub(super) struct CollectedFile {
    pub(super) file: PathBuf,
    pub(super) bytes: u64,
    pub(super) blake3: String,
}

impl Collected {
    /// Collects the files that the cases of a plan need.
    pub(super) fn of(plan: Plan) -> Result<Self, BundleError> {
        plan.check_files()?;
        let mut all = Self { plan, files: BTreeMap::new(), outside: BTreeSet::new() };
        let bundled = match all.plan.bundled.clone() {
            // A plan that came from a bundle goes into another one.
            Some(BundledCampaign { campaign, requirements }) => BundledCampaign {
                campaign: all.add(&campaign.file)?,
                requirements: requirements.map(|planned| all.add(&planned.file)).transpose()?,
            },
            None => {
                let campaign = all.plan.campaign.clone();
                let requirements = Campaign::load(&campaign)?.requirements;
                // Says so if the requirements aren't the planned ones.
                octant_campaign::judge::trace::requirements_of(&all.plan)?;
                BundledCampaign {
                    campaign: all.add(&campaign)?,
                    requirements: requirements.map(|file| all.add(&file)).transpose()?,
                }
            }
        };
        all.plan.campaign.clone_from(&bundled.campaign.file);
        all.plan.bundled = Some(bundled);
        let mut scenarios = std::mem::take(&mut all.plan.scenarios);
        for scenario in &mut scenarios {
            all.scenario(scenario)?;
        }
        all.plan.scenarios = scenarios;
        Ok(all)
    }

    /// Adds the files of a scenario, as its cases set it.
    fn scenario(&mut self, planned: &mut PlannedScenario) -> Result<(), BundleError> {
        let mut named: BTreeMap<String, PathBuf> = BTreeMap::new();
        // The files of a scenario that came from a bundle are known by their names as written.
        let known = planned.places();
        let mut seen: HashSet<&[SharedText]> = HashSet::new();
        for case in self.plan.cases.iter().filter(|case| case.scenario == planned.id) {
            if !seen.insert(&case.set) {
                continue;
            }
            let scenario =
                Scenario::load_placed(&planned.file, &case.set.to_strings(), &[], &known)?;
            let talks = scenario.devices().into_iter();
            self.outside.extend(talks.map(|uri| format!("{uri} of scenario {:?}", planned.id)));
            if planned.files.is_empty() {
                for name in scenario.files() {
                    let path = name.path(&scenario.folder)?;
                    named.insert(name.0, path);
                }
            }
        }
        named.extend(planned.files.iter().map(|(name, file)| (name.clone(), file.file.clone())));
        planned.files = named
            .into_iter()
            .map(|(name, path)| Ok((name, self.add(&path)?)))
            .collect::<Result<_, BundleError>>()?;
        planned.file = self.add(&planned.file)?.file;
        Ok(())
    }

    /// Adds a file, and returns it with its name in the bundle.
    fn add(&mut self, path: &Path) -> Result<PlannedFile, BundleError> {
        if path.is_dir() {
            return Err(BundleError::Unfit {
                path: path.to_owned(),
                reason: "found a folder, expected a file: an unpacked FMU has to be packed as a ZIP archive"
                    .to_owned(),
            });
        }
        let (blake3, bytes) = hash_of_file(path).map_err(BundleError::system("read", path))?;
        let name = entry_name::plain(&path.file_name().unwrap_or_default().to_string_lossy());
        let entry = format!("{FILES}/{blake3}/{name}");
        let planned = PlannedFile { file: PathBuf::from(&entry), blake3: blake3.clone() };
        self.files.insert(entry, CollectedFile { file: path.to_owned(), bytes, blake3 });
        Ok(planned)
    }
}
