//! The fault suite: every scenario of a suite run by the program, with its twin, and held against the
//! end that the suite says.

use super::night::write;
use crate::campaign::process::{self, Ended, TRIES};
use octant_requirements::Verdict;
use octant_scenario::suite::{Case, Suite};
use octant_score::summary::Summary;
use serde::{Deserialize, Serialize};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A case that takes longer is an error.
const LIMIT: Duration = Duration::from_secs(1800);

/// What a case of the suite came to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SuiteResult {
    /// Its name: that of its file, without the ending.
    pub name: String,
    /// The file.
    pub scenario: PathBuf,
    /// BLAKE3 of the file, hexadecimal.
    pub scenario_blake3: String,
    /// The verdict that it has to end with.
    pub expected: Verdict,
    /// The verdict that it ended with; null: it came to none.
    pub verdict: Option<Verdict>,
    /// Why it ended so.
    pub reasons: Vec<String>,
    /// What is wrong with that; null: it ended as it has to.
    pub problem: Option<String>,
    /// Hash of its stream.
    pub stream_hash: Option<String>,
    /// Where its evidence is, in the folder of the night; null: it ended as it has to, and nothing
    /// but this is kept.
    pub evidence: Option<String>,
}

impl SuiteResult {
    /// Whether two of them are the same in everything that a run decides.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        (self.verdict, &self.reasons, &self.stream_hash)
            == (other.verdict, &other.reasons, &other.stream_hash)
    }
}

/// Names of the cases of a suite, in its order.
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

/// BLAKE3 of a suite: of what it expects, and of every scenario.
///
/// # Errors
/// In words, if a scenario can't be read.
pub fn hash(suite: &Suite) -> Result<String, String> {
    let mut hasher = blake3::Hasher::new();
    for case in &suite.cases {
        let bytes = scenario(&case.scenario)?;
        let because = case.because.as_deref().unwrap_or("");
        hasher.update(format!("{}\0{because}\0{}\0", case.expect.name(), bytes.len()).as_bytes());
        hasher.update(&bytes);
    }
    Ok(hasher.finalize().to_hex().to_string())
}

fn scenario(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|error| format!("failed to read {}: {error}", path.display()))
}

/// Runs the cases of a suite that have no result yet in a folder; `None`: somebody wanted it to end.
///
/// # Errors
/// In words, if the system refuses: what was kept before stays.
pub fn run(
    suite: &Suite,
    folder: &Path,
    program: &Path,
    jobs: usize,
    cancel: &AtomicBool,
    tell: &(dyn Fn(&SuiteResult) + Sync),
) -> Result<Option<Vec<SuiteResult>>, String> {
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("failed to create {}: {error}", folder.display()))?;
    let names = names(suite);
    let next = AtomicUsize::new(0);
    let done: Mutex<Vec<(usize, SuiteResult)>> = Mutex::new(Vec::new());
    let broken: Mutex<Option<String>> = Mutex::new(None);
    std::thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, names.len().max(1)) {
            scope.spawn(|| {
                while !cancel.load(Ordering::Relaxed) {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let (Some(case), Some(name)) = (suite.cases.get(index), names.get(index))
                    else {
                        break;
                    };
                    match one(case, name, folder, program, cancel) {
                        Ok(None) => {}
                        Ok(Some(result)) => {
                            tell(&result);
                            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
                            done.push((index, result));
                        }
                        Err(reason) => {
                            next.fetch_max(names.len(), Ordering::Relaxed);
                            let mut first = broken.lock().unwrap_or_else(PoisonError::into_inner);
                            first.get_or_insert(reason);
                        }
                    }
                }
            });
        }
    });
    if let Some(reason) = broken.into_inner().unwrap_or_else(PoisonError::into_inner) {
        return Err(reason);
    }
    let mut done = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    if done.len() < names.len() {
        return Ok(None);
    }
    done.sort_by_key(|(index, _)| *index);
    Ok(Some(done.into_iter().map(|(_, result)| result).collect()))
}

/// The result of a case: one that is there already, or a new one; `None`: it was broken off.
fn one(
    case: &Case,
    name: &str,
    folder: &Path,
    program: &Path,
    cancel: &AtomicBool,
) -> Result<Option<SuiteResult>, String> {
    let scenario_blake3 = blake3::hash(&scenario(&case.scenario)?).to_hex().to_string();
    let file = folder.join(format!("{name}.json"));
    if file.exists() {
        let text = std::fs::read_to_string(&file)
            .map_err(|error| format!("failed to read {}: {error}", file.display()))?;
        let result: SuiteResult = serde_json::from_str(&text).map_err(|error| {
            format!("failed to read {}: expected a result of the suite: {error}", file.display())
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
        Some(verdict) => case.hold(verdict, &reasons),
    };
    let unfired = match unfired {
        Some(fault) if case.expect != Verdict::Inconclusive => {
            Err(format!("fault {} never fired", fault.id))
        }
        _ => Ok(()),
    };
    let problem = held.and(unfired).err();
    if problem.is_none() {
        // The scenario and the program make the rest again.
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
        .map_err(|error| format!("failed to write {}: {error}", file.display()))?;
    write(&file, &(text + "\n"))?;
    Ok(Some(result))
}

fn first_line(said: &str, status: Option<i32>) -> String {
    let line = said.lines().map(str::trim).find(|line| !line.is_empty());
    let line = line.map(|line| line.trim_start_matches("octant: ").to_owned());
    line.unwrap_or_else(|| match status {
        Some(status) => format!("it ended with status {status} and no word"),
        None => "it crashed or took too long, without a word".to_owned(),
    })
}

/// Exit status, summary and standard error of a run.
type Said = (Option<i32>, Option<Summary>, String);

/// Runs a scenario, again where somebody else ends its process; `None`: somebody wanted it to end.
fn whole(
    program: &Path,
    scenario: &Path,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<Option<Said>, String> {
    let mut by = String::new();
    for _ in 0..TRIES {
        remove_left(out)?;
        match start(program, scenario, out, cancel)? {
            Tried::Said(said) => return Ok(Some(*said)),
            Tried::Cancelled => return Ok(None),
            Tried::Outside(signal) => by = signal,
        }
    }
    Err(format!(
        "failed to run {}: its process was ended from outside {TRIES} times, the last time by {by}: the \
         case has no result",
        scenario.display()
    ))
}

/// Removes what a run that was killed left, in whatever state.
fn remove_left(out: &Path) -> Result<(), String> {
    for left in ["", ".partial", ".replaced"] {
        let mut path = out.as_os_str().to_owned();
        path.push(left);
        match std::fs::remove_dir_all(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
                return Err(format!("failed to remove {}: {error}", Path::new(&path).display()));
            }
            _ => {}
        }
    }
    Ok(())
}

enum Tried {
    Said(Box<Said>),
    Cancelled,
    /// Its process was ended by somebody else.
    Outside(String),
}

fn start(
    program: &Path,
    scenario: &Path,
    out: &Path,
    cancel: &AtomicBool,
) -> Result<Tried, String> {
    let system = |error| format!("failed to start {}: {error}", program.display());
    let mut child = process::command(program)
        .arg("run")
        .arg(scenario)
        .arg("--out")
        .arg(out)
        .args(["--force", "--json"])
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(system)?;
    let (printed, words) = (child.stdout.take(), child.stderr.take());
    std::thread::scope(|scope| {
        let printed = scope.spawn(|| all(printed));
        let words = scope.spawn(|| all(words));
        let status = match process::wait(&mut child, LIMIT, cancel).map_err(system)? {
            Ended::Cancelled => return Ok(Tried::Cancelled),
            Ended::Outside(by) => return Ok(Tried::Outside(by)),
            Ended::TooLong => None,
            Ended::Status(status) => status.code(),
        };
        let printed = printed.join().unwrap_or_default();
        let summary = Summary::from_json(&printed).ok();
        Ok(Tried::Said(Box::new((status, summary, words.join().unwrap_or_default()))))
    })
}

fn all(pipe: Option<impl Read>) -> String {
    let mut bytes = Vec::new();
    if let Some(mut pipe) = pipe {
        // What can't be read was not said.
        let _ = pipe.read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
