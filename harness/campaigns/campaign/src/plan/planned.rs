//! Scenarios and cases of a plan.

use super::case_id::CaseId;
use super::error::{PlanError, short, system};
use super::factor_values::FactorValues;
use super::shared::{SharedText, SharedTexts};
use octant_scenario::{FilePlaces, RequirementSpec, Scenario};
use octant_verdict::verdict::LimitCheck;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folder with copies of the files from which a campaign was planned, in the folder of the campaign.
pub const INPUTS: &str = "inputs";

/// A scenario of a plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlannedScenario {
    /// Name in the campaign.
    pub id: String,
    /// File.
    pub file: PathBuf,
    /// BLAKE3 of the file, hexadecimal.
    pub blake3: String,
    /// Ids of the requirements that its cases check.
    pub requirements: Vec<String>,
    /// Checks of those requirements that the scenario itself doesn't have.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub checks: Vec<LimitCheck>,
    /// Files that the scenario names, by the names as written, if they came from a bundle.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, PlannedFile>,
}

/// File of a bundle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlannedFile {
    /// The file: in `plan.json` relative to its folder.
    pub file: PathBuf,
    /// BLAKE3 of the file, hexadecimal.
    pub blake3: String,
}

impl PlannedFile {
    /// Checks that the file is the one of the bundle.
    ///
    /// # Errors
    /// If it can't be read, or was changed.
    pub fn check(&self) -> Result<(), PlanError> {
        check(&self.file, &self.blake3, "the bundle was made")
    }
}

fn check(file: &Path, blake3: &str, after: &str) -> Result<(), PlanError> {
    let (found, _) = system("read", file, hash_of_file(file))?;
    if found == blake3 {
        return Ok(());
    }
    Err(PlanError::Form {
        path: file.to_owned(),
        reason: format!(
            "it was changed after {after}: found {}, expected {}",
            short(&found),
            short(blake3)
        ),
    })
}

/// Returns the BLAKE3 of a file, hexadecimal, and its length.
pub fn hash_of_file(path: &Path) -> std::io::Result<(String, u64)> {
    let mut hasher = blake3::Hasher::new();
    std::io::copy(&mut std::fs::File::open(path)?, &mut hasher)?;
    Ok((hasher.finalize().to_hex().to_string(), hasher.count()))
}

/// Case: everything that determines its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// First 16 digits of the BLAKE3 over the scenario's BLAKE3, the additional checks, `set`,
    /// `faults` and `seed`.
    pub id: CaseId,
    /// Name of the scenario.
    pub scenario: SharedText,
    /// Seed of the run.
    pub seed: u64,
    /// Number of the run in its combination, from 0.
    pub replicate: u32,
    /// Keys that are set in the scenario, as `KEY=VALUE`.
    pub set: SharedTexts,
    /// Faults that are injected; null: all faults of the scenario.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faults: Option<SharedTexts>,
    /// Value of each factor, for display and statistics.
    pub factors: FactorValues,
}

impl PlannedScenario {
    /// Checks that the scenario's file, and the files beside it that came from a bundle, are those of the
    /// plan.
    pub(crate) fn check_file(&self) -> Result<(), PlanError> {
        check(&self.file, &self.blake3, "the campaign was planned")?;
        self.files.values().try_for_each(PlannedFile::check)
    }

    /// Returns the scenario of a case, as it is run.
    ///
    /// # Errors
    /// If the file isn't the planned one, or the scenario isn't valid.
    pub fn scenario(&self, case: &Case) -> Result<Scenario, PlanError> {
        self.check_file()?;
        self.with(case)
    }

    /// Returns this scenario with its copy in the folder of the campaign as its file.
    #[must_use]
    pub fn copied(&self, folder: &Path) -> Self {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let file = folder.join(INPUTS).join(format!("{}-{name}", short(&self.blake3)));
        Self { file, ..self.clone() }
    }

    /// Returns the places of the files that came from a bundle.
    #[must_use]
    pub fn places(&self) -> FilePlaces {
        self.files.iter().map(|(name, planned)| (name.clone(), planned.file.clone())).collect()
    }

    /// Returns the requirements that the campaign adds to those of the scenario.
    #[must_use]
    pub fn required(&self) -> Vec<RequirementSpec> {
        let required = |check: &LimitCheck| RequirementSpec {
            check: check.clone(),
            text: format!("{} {} {}", check.measure, check.comparison.sign(), check.limit),
            limit_text: check.limit.to_string(),
            clause: None,
        };
        self.checks.iter().map(required).collect()
    }

    /// Returns the scenario of a case without a check of its file.
    pub(crate) fn with(&self, case: &Case) -> Result<Scenario, PlanError> {
        let mut scenario =
            Scenario::load_placed(&self.file, &case.set.to_strings(), &[], &self.places())?;
        scenario.require(self.required());
        let Some(faults) = &case.faults else { return Ok(scenario) };
        scenario
            .with_only(&faults.to_strings())
            .map_err(|error| PlanError::Form { path: self.file.clone(), reason: error.to_string() })
    }
}
