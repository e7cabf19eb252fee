//! Derives the verdicts of a stored folder again by the present rules, and compares them with the
//! stored ones.
//!
//! Nothing in the folder is changed: it may be signed, and the stored verdicts stay as they are.
//! Nothing is run either: [`octant_score::rederive`] has the rules, and lists the quantities that
//! were never stored.

use octant_base::failing::{Failing, FailureKind};
use octant_campaign::execute::Shard;
use octant_campaign::execute::case::{self, CaseResult};
use octant_campaign::judge::status;
use octant_campaign::plan::{self, Plan};
use octant_campaign::report::file_names::STATISTICS;
use octant_campaign::store::writer::PartWriter;
use octant_campaign::store::{CampaignResults, StoredResult, keep_in};
use octant_evidence::ended::is_partial;
use octant_evidence::files;
use octant_evidence::manifest::{self, FILE_NAME, Manifest, ManifestError};
use octant_evidence::planned::unplanned;
use octant_evidence::statements::{SCENARIO, SUMMARY, certified};
use octant_nightly::night::{self, Night};
use octant_scenario::Scenario;
use octant_score::numerics::{NUMERICS, differs};
use octant_score::rederive;
use octant_score::summary::Summary;
use octant_score::verdict::RequirementResult;
use octant_verdict::Verdict;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Version of the result file.
pub const SCHEMA: u32 = 1;
/// Maximum number of cases listed on a terminal.
const TOLD: usize = 20;

/// Present verdicts of a folder, beside the stored ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rejudged {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Version of the program that derived the verdicts again.
    pub octant: String,
    /// Numerics version.
    pub numerics: u32,
    /// The folder.
    pub folder: String,
    /// SHA-256 of the manifest, hexadecimal; null without one, as for a night.
    pub manifest_sha256: Option<String>,
    /// Judged subjects: a run, a campaign, each campaign of a night.
    pub judged: Vec<Subject>,
    /// The worst of the new verdicts.
    pub verdict: Verdict,
}

/// Judged subject.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Subject {
    /// Kind: `run`, `campaign`.
    pub what: &'static str,
    /// Title.
    pub title: String,
    /// Versions of Octant that made the results.
    pub made_by: Vec<String>,
    /// Meaning of each numerics version that differs from this program's.
    pub numerics: Vec<String>,
    /// Verdict at the time of the run; null if the folder doesn't contain it.
    pub then: Option<Verdict>,
    /// Stored reasons.
    pub reasons_then: Vec<String>,
    /// Verdict by the present rules.
    pub now: Verdict,
    /// Present reasons.
    pub reasons_now: Vec<String>,
    /// Requirements.
    pub requirements: Vec<Check>,
    /// Cases of a campaign whose verdict has changed.
    pub cases: Vec<Case>,
    /// Quantities that can't be derived, because they were never stored.
    pub not_stored: Vec<String>,
}

/// Requirement with its stored and its present verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Check {
    /// Id.
    pub id: String,
    /// Verdict at the time of the run; null if the folder doesn't contain it.
    pub then: Option<Verdict>,
    /// Verdict by the present rules.
    pub now: Verdict,
    /// Reason, where it isn't met.
    pub reason: Option<String>,
}

/// Case with its stored and its present verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Id.
    pub case: String,
    /// Stored verdict.
    pub then: Verdict,
    /// Verdict by the present rules.
    pub now: Verdict,
    /// Reasons.
    pub reasons: Vec<String>,
}

/// Reasons why a folder can't be judged again.
#[derive(Debug, thiserror::Error)]
pub enum RejudgeError {
    /// The folder differs from its manifest.
    #[error("judge {folder} anew: it isn't whole: {differences}; octant verify tells more")]
    Differs {
        /// The folder.
        folder: PathBuf,
        /// Differences.
        differences: String,
    },
    /// The content of a file isn't valid.
    #[error("read {path}: {reason}")]
    Form {
        /// The file.
        path: PathBuf,
        /// Found and expected.
        reason: String,
    },
    /// The manifest can't be read.
    #[error(transparent)]
    Manifest(#[from] ManifestError),
    /// The folder contains nothing that has a verdict.
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
    /// A temporary file can't be made.
    #[error("judge {folder} anew: {reason}")]
    System {
        /// The folder.
        folder: PathBuf,
        /// Error of the operating system.
        reason: String,
    },
}

impl Failing for RejudgeError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Differs { .. } | Self::Form { .. } | Self::Manifest(_) | Self::Nothing { .. } => {
                FailureKind::Input
            }
            Self::System { .. } => FailureKind::Bench,
        }
    }
}

/// Judges the folder of a run, a campaign or a night again.
///
/// # Errors
/// If it isn't such a folder, was changed, or can't be read.
pub fn folder(path: &Path) -> Result<Rejudged, RejudgeError> {
    let there = |name: &str| path.join(name).is_file();
    let mut manifest_sha256 = None;
    let judged = if there(FILE_NAME) {
        let manifest = Manifest::read(path)?;
        let differences = manifest.verify(path)?;
        let mut words: Vec<String> = differences.iter().map(ToString::to_string).collect();
        if is_partial(path) {
            words.push("the folder is a .partial: its run didn't finish".to_owned());
        }
        if !words.is_empty() {
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

fn run(folder: &Path, manifest: &Manifest) -> Result<Subject, RejudgeError> {
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
    let scenario = Scenario::load(&folder.join(SCENARIO), &[])
        .map_err(|reason| form(&folder.join(SCENARIO), reason))?;
    let found = unplanned(&scenario, &stored);
    if !found.is_empty() {
        return Err(form(&path, format!("it isn't what was planned: {}", found.join("; "))));
    }
    let certified = certified(manifest).map_err(|reason| form(&folder.join(FILE_NAME), reason))?;
    let again = rederive::rejudge(&stored, &certified).map_err(|error| form(&path, error))?;
    let now = again.summary;
    Ok(Subject {
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

/// Reads the verdicts of a campaign's requirements from its statistics.
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

/// Judges a campaign again from its plan and the results of its cases: derives the verdict of each,
/// and combines them by the plan as usual.
fn campaign(
    folder: &Path,
    then: Option<Verdict>,
    requirements: &BTreeMap<String, Verdict>,
) -> Result<Subject, RejudgeError> {
    let path = folder.join(plan::FILE_NAME);
    let plan = Plan::read(&path).map_err(|error| form(&path, error))?;
    let system = |reason: String| RejudgeError::System { folder: folder.to_owned(), reason };
    let place = tempfile::tempdir().map_err(|error| system(error.to_string()))?;
    let (mut made_by, mut numerics) = (BTreeSet::new(), BTreeSet::new());
    let (mut cases, mut not_stored, mut unknown) = (Vec::new(), BTreeSet::new(), 0);
    let results = CampaignResults::open(folder).map_err(|error| form(folder, error))?;
    let mut writer = PartWriter::new(place.path(), "rejudged").unsynced();
    for case in &plan.cases {
        let stored = results.bytes(&case.id).map_err(|error| form(folder, error))?;
        let Some(StoredResult { place: at, bytes, .. }) = stored else { continue };
        let path = at.path().to_owned();
        let stored = CaseResult::unjudged(&at, &bytes).map_err(|reason| form(&path, reason))?;
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
            cases.push(Case {
                case: case.id.to_string(),
                then: stored.verdict,
                now: again.verdict,
                reasons: reasons.unwrap_or_default(),
            });
        }
        // Such a case neither passes nor fails in a probability: it counts as one without a result.
        if is_unknown {
            unknown += 1;
            continue;
        }
        let text = again.to_json().map_err(|error| form(&path, error))?;
        keep_in(&mut writer, &case.id, text.as_bytes(), &[])
            .map_err(|error| system(error.to_string()))?;
    }
    let status =
        status::of(&plan, place.path(), Shard::WHOLE).map_err(|error| system(error.to_string()))?;
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
    Ok(Subject {
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
    /// Renders the comparison as text.
    #[must_use]
    pub fn text(&self) -> String {
        self.judged.iter().map(Subject::text).collect()
    }
}

impl Subject {
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
