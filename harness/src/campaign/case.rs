//! One case: run to its summary, and its result as a file.

use super::plan::{Case, PlanError, PlannedScenario};
use crate::run::method::MethodError;
use crate::run::{Control, Recording, assemble, run_method};
use crate::scenario::Method;
use crate::score::summary::Summary;
use crate::score::verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};

/// Version of the file of a result.
pub const SCHEMA: u32 = 1;

/// What came of a case. Nothing of host or clock is in it, where it came to a summary.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseResult {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// The case.
    pub case: String,
    /// The worst of everything: an error where the case came to no summary, inconclusive where it
    /// checks no requirement.
    pub verdict: Verdict,
    /// Why it came to no summary; null: it did.
    pub error: Option<String>,
    /// The summary of the run.
    pub summary: Option<Summary>,
}

/// Why a case gave no summary.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// Its scenario isn't the planned one, or not right.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// It could not be run.
    #[error(transparent)]
    Method(#[from] MethodError),
    /// Its summary can't be written.
    #[error("write the summary: {0}")]
    Json(#[from] serde_json::Error),
}

/// What a process of its own is given, on its standard input.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Job {
    /// The case.
    pub case: Case,
    /// Its scenario.
    pub scenario: PlannedScenario,
    /// The most memory that it may have, MiB.
    pub memory_mib: u64,
    /// The folder of the campaign.
    pub folder: PathBuf,
}

/// Runs a case.
///
/// # Errors
/// If its scenario isn't the planned one, or can't be run.
pub fn run(
    planned: &PlannedScenario,
    case: &Case,
    control: &Control,
) -> Result<CaseResult, CaseError> {
    let scenario = planned.scenario(case)?;
    let one = |method| run_method(&scenario, method, case.seed, Recording::HashAlone, control);
    let primary = one(Method::Primary)?;
    let baseline = match &scenario.baseline {
        Some(_) => Some(one(Method::Baseline)?),
        None => None,
    };
    Ok(CaseResult::of(case, assemble(&scenario, case.seed, primary, baseline)?.summary))
}

impl CaseResult {
    fn of(case: &Case, summary: Summary) -> Self {
        // A case that checks nothing shows nothing.
        let nothing = summary.requirements.is_empty();
        let verdict =
            summary.verdict.worst(if nothing { Verdict::Inconclusive } else { Verdict::Pass });
        Self { schema: SCHEMA, case: case.id.clone(), verdict, error: None, summary: Some(summary) }
    }

    /// The result of a case that came to no summary.
    #[must_use]
    pub fn broken(case: &str, error: String) -> Self {
        Self {
            schema: SCHEMA,
            case: case.to_owned(),
            verdict: Verdict::Error,
            error: Some(error),
            summary: None,
        }
    }

    /// The verdict of a requirement in it: an error where it came to no summary, inconclusive where it
    /// wasn't checked.
    #[must_use]
    pub fn check(&self, requirement: &str) -> Verdict {
        let Some(summary) = &self.summary else { return Verdict::Error };
        let checks = summary.requirements.iter().filter(|check| check.id == requirement);
        // Checked more than once: all have to hold.
        checks.map(|check| check.verdict).reduce(Verdict::worst).unwrap_or(Verdict::Inconclusive)
    }

    /// The bytes of its file.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string(self)? + "\n")
    }

    /// Reads the file of a result.
    ///
    /// # Errors
    /// In words: what was found and what was expected.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| format!("read {}: {error}", path.display()))?;
        let form =
            |error| format!("read {}: expected the result of a case: {error}", path.display());
        // The version first: nothing else can be relied on in a newer one.
        let Version { schema } = serde_json::from_str(&text).map_err(form)?;
        if schema != SCHEMA {
            return Err(format!(
                "read {}: found version {schema}, this program reads version {SCHEMA}{}",
                path.display(),
                if schema > SCHEMA { ": a newer Octant wrote it" } else { "" }
            ));
        }
        let result: Self = serde_json::from_str(&text).map_err(form)?;
        let name = path.file_name().map_or("".into(), |name| name.to_string_lossy());
        if name.split('.').next() != Some(result.case.as_str()) {
            return Err(format!(
                "read {}: it is the result of case {}, expected that of the case it is named for",
                path.display(),
                result.case
            ));
        }
        Ok(result)
    }
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

/// What became of a result that was to be kept.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kept {
    /// It is there now.
    New,
    /// It was there, the same to the byte.
    Same,
    /// Another one is there: the same case came to two results. This one is kept beside it.
    Differs(PathBuf),
}

/// File of the result of a case in the folder of its campaign.
#[must_use]
pub fn file(folder: &Path, id: &str) -> PathBuf {
    folder.join("cases").join(id.get(..2).unwrap_or("")).join(format!("{id}.json"))
}

/// Keeps a result: whole or not at all, and never over another one.
///
/// # Errors
/// If the system refuses.
pub fn keep(folder: &Path, id: &str, bytes: &[u8]) -> io::Result<Kept> {
    let path = file(folder, id);
    let parent = path.parent().unwrap_or(folder);
    std::fs::create_dir_all(parent)?;
    let new = super::new_file(parent)?;
    std::fs::write(new.path(), bytes)?;
    new.as_file().sync_data()?;
    match new.persist_noclobber(&path) {
        Ok(_) => Ok(Kept::New),
        Err(refused) if refused.error.kind() == io::ErrorKind::AlreadyExists => {
            if std::fs::read(&path)? == bytes {
                return Ok(Kept::Same);
            }
            let hash = blake3::hash(bytes).to_hex();
            let other = path.with_file_name(format!("{id}.differs-{}.json", &hash.as_str()[..8]));
            refused.file.persist(&other).map_err(|error| error.error)?;
            Ok(Kept::Differs(other))
        }
        Err(refused) => Err(refused.error),
    }
}
