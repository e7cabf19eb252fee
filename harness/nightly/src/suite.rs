//! Runs the fault suite: every scenario with its twin, compared with the expected end.

use super::error::NightError;
use super::file::write;
use octant_base::child::{ChildEnded, finish};
use octant_base::pool::in_order;
use octant_campaign::process::{self, TRIES};
use octant_requirements::Verdict;
use octant_scenario::suite::{Suite, SuiteCase};
use octant_score::summary::Summary;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Time limit of a case; a longer one is an error.
const LIMIT: Duration = Duration::from_secs(1800);

/// Result of a case of the suite.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SuiteResult {
    /// Name: that of its file, without the extension.
    pub name: String,
    /// The file.
    pub scenario: PathBuf,
    /// BLAKE3 of the file, hexadecimal.
    pub scenario_blake3: String,
    /// Expected verdict.
    pub expected: Verdict,
    /// Verdict; null if there was none.
    pub verdict: Option<Verdict>,
    /// Reasons for the verdict.
    pub reasons: Vec<String>,
    /// Deviation from the expectation; null if there is none.
    pub problem: Option<String>,
    /// Hash of its stream.
    pub stream_hash: Option<String>,
    /// Place of the evidence in the folder of the night; null if the case ended as expected, when
    /// only this record is kept.
    pub evidence: Option<String>,
}

impl SuiteResult {
    /// Returns whether two results agree in everything that a run determines.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        (self.verdict, &self.reasons, &self.stream_hash)
            == (other.verdict, &other.reasons, &other.stream_hash)
    }
}

/// Lists the names of a suite's cases, in its order.
#[must_use]
pub fn names(suite: &Suite) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for case in &suite.cases {
        let stem = case.scenario.file_stem().map_or("case".into(), |stem| stem.to_string_lossy());
        let name = |n: u32| if n == 1 { stem.to_string() } else { format!("{stem}-{n}") };
        names.extend((1..).map(name).find(|name| !names.contains(name)));
    }
    names
}

/// Computes the BLAKE3 of a suite: of its expectations, and of every scenario.
///
/// # Errors
/// If a scenario can't be read.
pub fn hash(suite: &Suite) -> Result<String, NightError> {
    let mut hasher = blake3::Hasher::new();
    for case in &suite.cases {
        let bytes = scenario(&case.scenario)?;
        let because = case.because.as_deref().unwrap_or("");
        hasher.update(format!("{}\0{because}\0{}\0", case.expect.name(), bytes.len()).as_bytes());
        hasher.update(&bytes);
    }
    Ok(hasher.finalize().to_hex().to_string())
}

fn scenario(path: &Path) -> Result<Vec<u8>, NightError> {
    std::fs::read(path).map_err(NightError::of("read", path))
}

/// Runs the cases of a suite that have no result yet in a folder; `None` if the end was requested.
///
/// # Errors
/// If the operating system refuses: stored results stay.
pub fn run(
    suite: &Suite,
    folder: &Path,
    program: &Path,
    jobs: usize,
    cancel: &AtomicBool,
    tell: &(dyn Fn(&SuiteResult) + Sync),
) -> Result<Option<Vec<SuiteResult>>, NightError> {
    std::fs::create_dir_all(folder).map_err(NightError::of("create", folder))?;
    let names = names(suite);
    let work = |index: usize| {
        let result = one(&suite.cases[index], &names[index], folder, program, cancel)?;
        if let Some(result) = &result {
            tell(result);
        }
        Ok::<_, NightError>(result)
    };
    let done = in_order(jobs, names.len(), || cancel.load(Ordering::Relaxed), work)?;
    // Incomplete where the end was requested.
    Ok(done.into_iter().collect())
}

/// Returns the result of a case, stored or new; `None` if it was aborted.
fn one(
    case: &SuiteCase,
    name: &str,
    folder: &Path,
    program: &Path,
    cancel: &AtomicBool,
) -> Result<Option<SuiteResult>, NightError> {
    let scenario_blake3 = blake3::hash(&scenario(&case.scenario)?).to_hex().to_string();
    let file = folder.join(format!("{name}.json"));
    if file.exists() {
        let text = std::fs::read_to_string(&file).map_err(NightError::of("read", &file))?;
        let result: SuiteResult = serde_json::from_str(&text).map_err(|source| {
            NightError::Form { path: file.clone(), expected: "a result of the suite", source }
        })?;
        if result.scenario_blake3 == scenario_blake3 && result.expected == case.expect {
            return Ok(Some(result));
        }
    }
    let out = folder.join(name);
    let Some((status, summary, said)) = whole(program, &case.scenario, &out, cancel)? else {
        return Ok(None);
    };
    let (verdict, reasons) = match &summary {
        Some(summary) => (Some(summary.verdict), summary.reasons.clone()),
        None => (None, vec![first_line(&said, status)]),
    };
    let unfired = summary.iter().flat_map(|summary| &summary.faults).find(|fault| !fault.fired);
    let held = match verdict {
        None => Err(format!("it came to no verdict: {}", reasons.join("; "))),
        Some(verdict) => case.hold(verdict, &reasons).map_err(|found| found.to_string()),
    };
    let unfired = match unfired {
        Some(fault) if case.expect != Verdict::Inconclusive => {
            Err(format!("fault {} never fired", fault.id))
        }
        _ => Ok(()),
    };
    let problem = held.and(unfired).err();
    if problem.is_none() {
        // The scenario and the program can reproduce the rest.
        let _ = std::fs::remove_dir_all(&out);
    }
    let evidence = problem.as_ref().map(|_| format!("suite/{name}"));
    let result = SuiteResult {
        name: name.to_owned(),
        scenario: case.scenario.clone(),
        scenario_blake3,
        expected: case.expect,
        verdict,
        reasons,
        problem,
        stream_hash: summary.map(|summary| summary.stream_hash),
        evidence,
    };
    let text = serde_json::to_string_pretty(&result)
        .map_err(|source| NightError::Json { what: file.display().to_string(), source })?;
    write(&file, &(text + "\n"))?;
    Ok(Some(result))
}

fn first_line(said: &str, status: Option<i32>) -> String {
    let line = said.lines().map(str::trim).find(|line| !line.is_empty());
    let line = line.map(|line| line.trim_start_matches("error: ").to_owned());
    line.unwrap_or_else(|| match status {
        Some(status) => format!("it ended with status {status} and no word"),
        None => "it crashed or took too long, without a word".to_owned(),
    })
}

/// Exit status, summary and standard error of a run.
type Said = (Option<i32>, Option<Summary>, String);

/// Runs a scenario, again if its process is ended from outside; `None` if the end was requested.
fn whole(
    program: &Path,
    scenario: &Path,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<Option<Said>, NightError> {
    let mut by = String::new();
    for _ in 0..TRIES {
        remove_left(out)?;
        match start(program, scenario, out, cancel)? {
            Tried::Said(said) => return Ok(Some(*said)),
            Tried::Cancelled => return Ok(None),
            Tried::Outside(signal) => by = signal,
        }
    }
    Err(NightError::Outside { scenario: scenario.to_owned(), tries: TRIES, by })
}

/// Removes the remains of a killed run, in whatever state.
fn remove_left(out: &Path) -> Result<(), NightError> {
    for left in ["", ".partial", ".replaced"] {
        let mut path = out.as_os_str().to_owned();
        path.push(left);
        match std::fs::remove_dir_all(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(NightError::of("remove", Path::new(&path))(error));
            }
            _ => {}
        }
    }
    Ok(())
}

enum Tried {
    Said(Box<Said>),
    Cancelled,
    /// The process was ended from outside.
    Outside(String),
}

fn start(
    program: &Path,
    scenario: &Path,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<Tried, NightError> {
    let system = NightError::of("start", program);
    let child = process::command(program)
        .arg("run")
        .arg(scenario)
        .arg("--out")
        .arg(out)
        .args(["--force", "--json"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(&system)?;
    let outcome = finish(child, &[], u64::MAX, LIMIT, cancel).map_err(&system)?;
    let status = match outcome.ended {
        ChildEnded::Cancelled => return Ok(Tried::Cancelled),
        ChildEnded::Outside(by) => return Ok(Tried::Outside(by)),
        ChildEnded::TooLong => None,
        ChildEnded::Status(status) => status.code(),
    };
    let summary = Summary::from_json(&outcome.out).ok();
    Ok(Tried::Said(Box::new((status, summary, outcome.err))))
}
