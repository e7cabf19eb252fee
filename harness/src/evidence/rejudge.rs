//! Verdicts of a stored folder, derived anew by the rules of this program and put beside those that it holds.
//!
//! Nothing in the folder is changed: it may be signed, and what was said stays what was said. Nothing is run
//! either: [`octant_score::rederive`] has the rules, and says what was never stored.

use super::files;
use super::inside::{SUMMARY, certified};
use super::manifest::{self, FILE_NAME, Manifest, ManifestError};
use crate::campaign::case::{self, CaseResult};
use crate::campaign::execute::Shard;
use crate::campaign::plan::{self, Plan};
use crate::campaign::report::evidence::STATISTICS;
use crate::campaign::status;
use crate::nightly::night::{self, Night};
use octant_requirements::Verdict;
use octant_score::numerics::{NUMERICS, differs};
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Version of the file with what came of it.
pub const SCHEMA: u32 = 1;
/// Cases that are told on a terminal.
const TOLD: usize = 20;

/// What a folder comes to now, beside what it came to then.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rejudged {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program that judged anew.
    pub octant: String,
    /// Its numerics version.
    pub numerics: u32,
    /// The folder.
    pub folder: String,
    /// SHA-256 of its manifest, hexadecimal; null without one, as of a night.
    pub manifest_sha256: Option<String>,
    /// What was judged: a run, a campaign, each campaign of a night.
    pub judged: Vec<Judged>,
    /// The worst of the new verdicts.
    pub verdict: Verdict,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judged {
    /// `run`, `campaign`.
    pub what: &'static str,
    /// Its title.
    pub title: String,
    /// Versions of Octant that made its results.
    pub made_by: Vec<String>,
    /// Where their numerics version is another one, what that means.
    pub numerics: Vec<String>,
    /// As it was judged; null: nothing in the folder says.
    pub then: Option<Verdict>,
    /// Reasons of then.
    pub reasons_then: Vec<String>,
    /// As it is judged now.
    pub now: Verdict,
    /// Reasons of now.
    pub reasons_now: Vec<String>,
    /// Its requirements.
    pub requirements: Vec<Check>,
    /// Cases of a campaign whose verdict is another one.
    pub cases: Vec<Turned>,
    /// What can't be derived, since it was never stored.
    pub not_stored: Vec<String>,
}

/// A requirement then and now.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Its id.
    pub id: String,
    /// As it was judged; null: nothing in the folder says.
    pub then: Option<Verdict>,
    /// As it is judged now.
    pub now: Verdict,
    /// Why, where it isn't met.
    pub reason: Option<String>,
}

/// A case then and now.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Turned {
    /// Its id.
    pub case: String,
    /// As it was judged.
    pub then: Verdict,
    /// As it is judged now.
    pub now: Verdict,
    /// Why.
    pub reasons: Vec<String>,
}

/// Why a folder can't be judged anew.
#[derive(Debug, thiserror::Error)]
pub enum RejudgeError {
    /// It isn't what the manifest names.
    #[error("judge {folder} anew: it isn't whole: {differences}; octant verify tells more")]
    Differs {
        /// The folder.
        folder: PathBuf,
        /// What differs.
        differences: String,
    },
    /// Something in it can't be read.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Found and expected.
        reason: String,
    },
    /// Its manifest can't be read.
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    /// There is nothing in it that has a verdict.
    #[error(
        "judge {folder} anew: found neither {FILE_NAME} nor {} nor {} in it, expected the folder of a run, a \
         campaign or a night",
        plan::FILE_NAME,
        night::FILE_NAME
    )]
    Nothing {
        /// The folder.
        folder: PathBuf,
    },
    /// A file to work with can't be made.
    #[error("judge {folder} anew: {reason}")]
    System {
        /// The folder.
        folder: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Judges the folder of a run, a campaign or a night anew.
///
/// # Errors
/// If it isn't one, was changed, or can't be read.
pub fn folder(path: &Path) -> Result<Rejudged, RejudgeError> {
    let there = |name: &str| path.join(name).is_file();
    let mut manifest_sha256 = None;
    let judged = if there(FILE_NAME) {
        let manifest = Manifest::read(path)?;
        let differences = manifest.verify(path)?;
        if !differences.is_empty() {
            let words: Vec<String> = differences.iter().map(ToString::to_string).collect();
            let differences = words.join("; ");
            return Err(RejudgeError::Differs { folder: path.to_owned(), differences });
        }
        manifest_sha256 = Some(manifest::sha256_of(path)?);
        vec![match &manifest.campaign {
            Some(facts) => campaign(path, Some(facts.verdict), &stored_requirements(path)?)?,
            None => run(path, &manifest)?,
        }]
    } else if there(night::FILE_NAME) {
        let night =
            Night::read(path).map_err(|reason| form(&path.join(night::FILE_NAME), reason))?;
        let mut all = Vec::new();
        for one in &night.campaigns {
            all.push(campaign(&path.join(&one.name), one.verdict, &one.requirements)?);
        }
        all
    } else if there(plan::FILE_NAME) {
        vec![campaign(path, None, &stored_requirements(path)?)?]
    } else {
        return Err(RejudgeError::Nothing { folder: path.to_owned() });
    };
    if judged.is_empty() {
        return Err(RejudgeError::Nothing { folder: path.to_owned() });
    }
    Ok(Rejudged {
        schema: SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        numerics: NUMERICS,
        folder: path.display().to_string(),
        manifest_sha256,
        verdict: judged.iter().map(|one| one.now).fold(Verdict::None, Verdict::worst),
        judged,
    })
}

fn form(path: &Path, reason: impl ToString) -> RejudgeError {
    RejudgeError::Form { path: path.to_owned(), reason: reason.to_string() }
}

fn run(folder: &Path, manifest: &Manifest) -> Result<Judged, RejudgeError> {
    let path = folder.join(SUMMARY);
    let bytes = manifest.read_file(folder, SUMMARY)?;
    let text = String::from_utf8(bytes).map_err(|_| form(&path, "it is no text"))?;
    let is_system = serde_json::from_str::<serde_json::Value>(&text)
        .is_ok_and(|document| document.get("system").is_some());
    if is_system {
        return Err(form(
            &path,
            "it is of a system of FMUs, whose verdict is how it ended: there is nothing to derive anew",
        ));
    }
    let stored = Summary::from_json(&text).map_err(|error| form(&path, error))?;
    let certified = certified(manifest).map_err(|reason| form(&folder.join(FILE_NAME), reason))?;
    let again = rederive::rejudge(&stored, &certified).map_err(|error| form(&path, error))?;
    let now = again.summary;
    Ok(Judged {
        what: "run",
        title: stored.scenario.clone(),
        made_by: vec![stored.octant.clone()],
        numerics: differs(stored.numerics).into_iter().collect(),
        then: Some(stored.verdict),
        reasons_then: stored.reasons.clone(),
        now: now.verdict,
        requirements: checks(&stored.requirements, &now.requirements),
        reasons_now: now.reasons,
        cases: Vec::new(),
        not_stored: again.not_stored,
    })
}

fn checks(then: &[RequirementResult], now: &[RequirementResult]) -> Vec<Check> {
    let one = |(then, now): (&RequirementResult, &RequirementResult)| Check {
        id: now.id.clone(),
        then: Some(then.verdict),
        now: now.verdict,
        reason: now.told(),
    };
    then.iter().zip(now).map(one).collect()
}

/// What the statistics of a campaign say of its requirements.
fn stored_requirements(folder: &Path) -> Result<BTreeMap<String, Verdict>, RejudgeError> {
    #[derive(serde::Deserialize)]
    struct Stored {
        id: String,
        verdict: Verdict,
    }
    #[derive(serde::Deserialize)]
    struct Statistics {
        requirements: Vec<Stored>,
    }
    let path = folder.join(STATISTICS);
    let bytes = match files::read(&path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        Err(error) => return Err(form(&path, error)),
    };
    let all: Statistics = serde_json::from_slice(&bytes).map_err(|error| form(&path, error))?;
    Ok(all.requirements.into_iter().map(|one| (one.id, one.verdict)).collect())
}

/// A campaign from its plan and the results of its cases: all of them are judged anew, and put together by the
/// plan as ever.
fn campaign(
    folder: &Path,
    then: Option<Verdict>,
    requirements: &BTreeMap<String, Verdict>,
) -> Result<Judged, RejudgeError> {
    let path = folder.join(plan::FILE_NAME);
    let plan = Plan::read(&path).map_err(|error| form(&path, error))?;
    let system = |reason: String| RejudgeError::System { folder: folder.to_owned(), reason };
    let place = tempfile::tempdir().map_err(|error| system(error.to_string()))?;
    let (mut made_by, mut numerics) = (BTreeSet::new(), BTreeSet::new());
    let (mut cases, mut not_stored, mut unknown) = (Vec::new(), BTreeSet::new(), 0);
    for case in &plan.cases {
        let path = case::file(folder, &case.id);
        let bytes = match files::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => continue,
            Err(error) => return Err(form(&path, error)),
        };
        let stored = CaseResult::unjudged(&path, &bytes).map_err(|reason| form(&path, reason))?;
        let mut is_unknown = false;
        let again = match &stored.summary {
            None => stored.clone(),
            Some(summary) => {
                made_by.insert(summary.octant.clone());
                numerics.extend(differs(summary.numerics));
                let again = rederive::rejudge(summary, &[]).map_err(|error| form(&path, error))?;
                is_unknown = again.is_unknown();
                not_stored.extend(again.not_stored);
                let planned = plan.planned(case).map_err(|error| form(&path, error))?;
                let hash = Some(case::hash_of(planned, case));
                let mut result = CaseResult::of(&case.id, hash, again.summary)
                    .map_err(|error| form(&path, error))?;
                if stored.error.is_some() {
                    (result.error, result.verdict) = (stored.error.clone(), Verdict::Error);
                }
                result
            }
        };
        if again.verdict != stored.verdict {
            let reasons = again.summary.as_ref().map(|summary| summary.reasons.clone());
            cases.push(Turned {
                case: case.id.clone(),
                then: stored.verdict,
                now: again.verdict,
                reasons: reasons.unwrap_or_default(),
            });
        }
        // In a probability such a case is neither passed nor failed: it counts as one without a result.
        if is_unknown {
            unknown += 1;
            continue;
        }
        let text = again.to_json().map_err(|error| form(&path, error))?;
        case::keep(place.path(), &case.id, text.as_bytes())
            .map_err(|error| system(error.to_string()))?;
    }
    let status = status::of(&plan, place.path(), Shard::WHOLE).map_err(system)?;
    let one = |(id, found): (&String, &status::RequirementStatus)| Check {
        id: id.clone(),
        then: requirements.get(id).copied(),
        now: found.verdict,
        reason: Some(found.reason.clone()),
    };
    let mut reasons_now = Vec::new();
    if status.open > unknown {
        let open = status.open - unknown;
        reasons_now.push(format!("{open} of {} cases have no result", status.cases));
    }
    if unknown > 0 {
        reasons_now.push(format!(
            "{unknown} of {} cases hold too little for a pass, and nothing that speaks against one",
            status.cases
        ));
    }
    Ok(Judged {
        what: "campaign",
        title: plan.title.clone(),
        made_by: made_by.into_iter().collect(),
        numerics: numerics.into_iter().collect(),
        then,
        reasons_then: Vec::new(),
        now: status.verdict(),
        reasons_now,
        requirements: status.requirements.iter().map(one).collect(),
        cases,
        not_stored: not_stored.into_iter().collect(),
    })
}

impl Rejudged {
    /// For people.
    #[must_use]
    pub fn text(&self) -> String {
        self.judged.iter().map(Judged::text).collect()
    }
}

impl Judged {
    fn text(&self) -> String {
        let name = |verdict: Option<Verdict>| verdict.map_or("not told", Verdict::name);
        let mut text = format!("{} {}\n", self.what, self.title);
        if !self.made_by.is_empty() {
            text += &format!("  made by octant {}\n", self.made_by.join(", "));
        }
        for told in &self.numerics {
            text += &format!("  {told}\n");
        }
        let mut side = |when: &str, verdict: Option<Verdict>, reasons: &[String]| {
            text += &format!("  {when}: {}\n", name(verdict));
            for reason in reasons {
                text += &format!("    {reason}\n");
            }
        };
        side("then", self.then, &self.reasons_then);
        side("now", Some(self.now), &self.reasons_now);
        for check in &self.requirements {
            let reason = check.reason.as_ref().map_or(String::new(), |why| format!(" ({why})"));
            text += &format!(
                "  {}: {}, now {}{reason}\n",
                check.id,
                name(check.then),
                check.now.name()
            );
        }
        for turned in self.cases.iter().take(TOLD) {
            let [then, now] = [turned.then, turned.now].map(Verdict::name);
            let reasons = turned.reasons.join("; ");
            text += &format!("  case {}: {then}, now {now}: {reasons}\n", turned.case);
        }
        if self.cases.len() > TOLD {
            text += &format!("  and {} more cases\n", self.cases.len() - TOLD);
        }
        for what in &self.not_stored {
            text += &format!("  never stored: {what}\n");
        }
        text
    }
}
