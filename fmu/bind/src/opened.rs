//! FMUs of a run, each opened once.

use super::stepper::UseError;
use octant_fmu_host::{FmuOpenError, OpenedFmu};
use octant_scenario::{Fmu, Scenario};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// FMUs by their files: the first use opens a file, later ones share the opening. Clones share the FMUs.
///
/// One of these belongs to one run: a file that changes between two runs is opened again.
#[derive(Clone, Debug, Default)]
pub struct OpenedFmus {
    fmus: Arc<Mutex<BTreeMap<PathBuf, OpenedFmu>>>,
}

impl OpenedFmus {
    /// Returns the FMU of a file.
    ///
    /// # Errors
    /// If it can't be opened. The next use tries it again.
    pub fn file(&self, path: &Path) -> Result<OpenedFmu, FmuOpenError> {
        let mut fmus = self.fmus.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(fmu) = fmus.get(path) {
            return Ok(fmu.clone());
        }
        let fmu = OpenedFmu::open(path)?;
        fmus.insert(path.to_owned(), fmu.clone());
        Ok(fmu)
    }

    /// Returns an FMU of a scenario, and the path of its file.
    ///
    /// # Errors
    /// If its name can't be expanded, or it can't be opened.
    pub fn of(&self, scenario: &Scenario, fmu: &Fmu) -> Result<(OpenedFmu, PathBuf), UseError> {
        let path = path(scenario, fmu)?;
        match self.file(&path) {
            Ok(opened) => Ok((opened, path)),
            Err(error) => Err(UseError::open(&format!("fmu:{}", path.display()), error)),
        }
    }
}

/// Returns the path of a scenario's FMU.
///
/// # Errors
/// If its name can't be expanded.
fn path(scenario: &Scenario, fmu: &Fmu) -> Result<PathBuf, UseError> {
    let problem = |reason: String| UseError::problems(&scenario.file, vec![fmu.at.problem(reason)]);
    fmu.file.path(&scenario.folder).map_err(|reason| problem(format!("failed to {reason}")))
}
