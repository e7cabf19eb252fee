//! Runs the fault suite: every scenario with its twin, compared with the expected end.
//!
//! The cases run in one process, in which those that begin alike share their beginning. A case that doesn't end
//! as expected, or gave no result there, runs again alone and leaves its evidence. So does a part of the others,
//! a different one each night: both runs have to be the same.

use super::error::NightError;
use super::file::write;
use octant_base::child::{ChildEnded, finish};
use octant_base::not_finite;
use octant_base::pool::in_order;
use octant_campaign::execute::process::{self, TRIES};
use octant_scenario::suite::{Suite, SuiteCase};
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Number of nights in which every case has run alone once.
const NIGHTS_FOR_ALL: u64 = 16;
/// Time limit of a case that runs alone, and of all cases together; a longer case is an error.
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

/// Settings of a suite's run.
#[derive(Debug)]
pub struct SuiteOptions<'a> {
    /// Folder of the results.
    pub folder: &'a Path,
    /// Program that runs the cases.
    pub program: &'a Path,
    /// Number of runs at a time.
    pub jobs: usize,
    /// Number of the night; it selects the cases that also run alone.
    pub night: u64,
    /// Set to end it.
    pub cancel: &'a AtomicBool,
}

/// Input of the process that runs cases together, on its standard input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SharedCases {
    /// Files of the scenarios.
    pub scenarios: Vec<PathBuf>,
    /// Number of runs at a time.
    pub jobs: usize,
}

/// A line of the output of that process.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SharedCase {
    /// Place of the scenario in the input.
    pub index: usize,
    /// Its summary.
    pub summary: Summary,
}

/// Runs the cases of a suite that have no result yet in a folder; `None` if the end was requested.
///
/// # Errors
/// If the operating system refuses: stored results stay.
pub fn run(
    suite: &Suite,
    options: &SuiteOptions<'_>,
    tell: &(dyn Fn(&SuiteResult) + Sync),
) -> Result<Option<Vec<SuiteResult>>, NightError> {
    let SuiteOptions { folder, jobs, cancel, .. } = *options;
    std::fs::create_dir_all(folder).map_err(NightError::of("create", folder))?;
    let names = names(suite);
    let cases = suite.cases.iter().zip(&names).map(|(case, name)| Case::of(case, name, folder));
    let cases = cases.collect::<Result<Vec<_>, _>>()?;
    let Some(shared) = shared(&cases, options)? else { return Ok(None) };
    let period = NIGHTS_FOR_ALL.min(cases.len().max(1) as u64);
    let work = |index: usize| {
        let case = &cases[index];
        let result = match &case.stored {
            Some(stored) => Some(stored.clone()),
            None => {
                let is_sampled = (index as u64 + options.night).is_multiple_of(period);
                case.run(shared.get(&index), is_sampled, options)?
            }
        };
        if let Some(result) = &result {
            tell(result);
        }
        Ok::<_, NightError>(result)
    };
    let done = in_order(jobs, cases.len(), || cancel.load(Ordering::Relaxed), work)?;
    // Incomplete where the end was requested.
    Ok(done.into_iter().collect())
}

/// Runs the cases without a result together; returns the summaries by their places. A case that it misses has
/// to run alone. `None` if the end was requested.
fn shared(
    cases: &[Case<'_>],
    options: &SuiteOptions<'_>,
) -> Result<Option<BTreeMap<usize, Summary>>, NightError> {
    let open: Vec<usize> = (0..cases.len()).filter(|i| cases[*i].stored.is_none()).collect();
    if open.len() < 2 {
        return Ok(Some(BTreeMap::new()));
    }
    let scenarios = open.iter().map(|index| cases[*index].case.scenario.clone()).collect();
    let job = serde_json::to_vec(&SharedCases { scenarios, jobs: options.jobs })
        .map_err(|source| NightError::Json { what: "the cases of a suite".to_owned(), source })?;
    let system = NightError::of("start", options.program);
    let child = process::command(options.program)
        .args(["nightly", "cases"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(&system)?;
    let outcome = finish(child, &job, u64::MAX, LIMIT, options.cancel).map_err(&system)?;
    if matches!(outcome.ended, ChildEnded::Cancelled) {
        return Ok(None);
    }
    // A process that ends early has told the cases up to there; an incomplete line is none.
    let lines = outcome.out.lines().filter_map(|line| serde_json::from_str(line).ok());
    let found =
        lines.filter_map(|SharedCase { index, summary }| Some((*open.get(index)?, summary)));
    Ok(Some(found.collect()))
}

/// A case, with its result where it is stored.
struct Case<'a> {
    case: &'a SuiteCase,
    name: &'a str,
    scenario_blake3: String,
    file: PathBuf,
    stored: Option<SuiteResult>,
}

impl<'a> Case<'a> {
    fn of(case: &'a SuiteCase, name: &'a str, folder: &Path) -> Result<Self, NightError> {
        let scenario_blake3 = blake3::hash(&scenario(&case.scenario)?).to_hex().to_string();
        let file = folder.join(format!("{name}.json"));
        let mut stored = None;
        if file.exists() {
            let text = std::fs::read_to_string(&file).map_err(NightError::of("read", &file))?;
            let result: SuiteResult = not_finite::from_str(&text).map_err(|source| {
                NightError::Form { path: file.clone(), expected: "a result of the suite", source }
            })?;
            stored = (result.scenario_blake3 == scenario_blake3 && result.expected == case.expect)
                .then_some(result);
        }
        Ok(Self { case, name, scenario_blake3, file, stored })
    }

    /// Judges what the case came to among the others, runs it alone where that has to be, and stores the
    /// result; `None` if it was aborted.
    fn run(
        &self,
        shared: Option<&Summary>,
        is_sampled: bool,
        options: &SuiteOptions<'_>,
    ) -> Result<Option<SuiteResult>, NightError> {
        // A run alone that was killed leaves a part of its folder, and needn't be repeated.
        remove_left(&options.folder.join(self.name))?;
        let among = shared.map(|summary| self.judged(Some(summary), String::new()));
        let result = match &among {
            Some(among) if among.problem.is_none() && !is_sampled => among.clone(),
            _ => {
                let Some(alone) = self.alone(among.as_ref(), options)? else { return Ok(None) };
                alone
            }
        };
        let text = serde_json::to_string_pretty(&result)
            .map_err(|source| NightError::Json { what: self.file.display().to_string(), source })?;
        write(&self.file, &(text + "\n"))?;
        Ok(Some(result))
    }

    /// Runs the case alone; `among`: its result with a shared beginning.
    fn alone(
        &self,
        among: Option<&SuiteResult>,
        options: &SuiteOptions<'_>,
    ) -> Result<Option<SuiteResult>, NightError> {
        let out = options.folder.join(self.name);
        let done = whole(options.program, &self.case.scenario, &out, options.cancel)?;
        let Some((status, summary, said)) = done else { return Ok(None) };
        let mut result = self.judged(summary.as_ref(), first_line(&said, status));
        if let Some(among) = among.filter(|among| !among.is_same(&result)) {
            let told = |result: &SuiteResult| {
                let verdict = result.verdict.map_or("no verdict", Verdict::name);
                format!("{verdict}, stream {}", result.stream_hash.as_deref().unwrap_or("none"))
            };
            result.problem = Some(format!(
                "with a beginning that it shares with other cases it came to another result ({}) than alone \
                 ({}): an error of this program",
                told(among),
                told(&result)
            ));
        }
        if result.problem.is_none() {
            // The scenario and the program can reproduce the rest.
            let _ = std::fs::remove_dir_all(&out);
        } else {
            result.evidence = Some(format!("suite/{}", self.name));
        }
        Ok(Some(result))
    }

    fn judged(&self, summary: Option<&Summary>, said: String) -> SuiteResult {
        let (verdict, reasons) = match summary {
            Some(summary) => (Some(summary.verdict), summary.reasons.clone()),
            None => (None, vec![said]),
        };
        let unfired = summary.iter().flat_map(|s| &s.faults).find(|fault| !fault.fired);
        let held = match verdict {
            None => Err(format!("it came to no verdict: {}", reasons.join("; "))),
            Some(verdict) => self.case.hold(verdict, &reasons).map_err(|found| found.to_string()),
        };
        let unfired = match unfired {
            Some(fault) if self.case.expect != Verdict::Inconclusive => {
                Err(format!("fault {} never fired", fault.id))
            }
            _ => Ok(()),
        };
        SuiteResult {
            name: self.name.to_owned(),
            scenario: self.case.scenario.clone(),
            scenario_blake3: self.scenario_blake3.clone(),
            expected: self.case.expect,
            verdict,
            reasons,
            problem: held.and(unfired).err(),
            stream_hash: summary.map(|summary| summary.stream_hash.clone()),
            evidence: None,
        }
    }
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
    // A summary of a run that ended otherwise than it says is no verdict: its folder may not be whole.
    let agrees = |summary: &Summary| status == Some(i32::from(summary.verdict.exit_code()));
    let summary = Summary::from_json(&outcome.out).ok().filter(agrees);
    Ok(Tried::Said(Box::new((status, summary, outcome.err))))
}
