//! `selftest.json`: result of a self-test, with program, machine and time.

use super::case::Case;
use super::error::{CaseSetupError, FileError};
use super::judge::{CaseOutcome, CaseVerdict, judge};
use octant_base::hash::sha256;
use octant_evidence::RunFacts;
use octant_evidence::manifest::{Git, Machine, Manifest};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Version of the form of `selftest.json`.
pub const SCHEMA: u32 = 1;
/// Name in the folder of a campaign.
pub const FILE_NAME: &str = "selftest.json";
/// Exit status of an alarm.
pub const ALARM: u8 = 5;

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseRecord {
    /// Name.
    pub id: &'static str,
    /// `golden`, `must pass`, `must not pass` or `same bytes`.
    pub kind: &'static str,
    /// Purpose of the case.
    pub about: &'static str,
    /// Expected outcome.
    pub expected: String,
    /// Source of the expectation; null where it follows from the meaning of a verdict.
    pub source: Option<&'static str>,
    /// Outcome.
    pub found: String,
    /// Overall verdict.
    pub verdict: CaseVerdict,
}

/// Record of a self-test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Record {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// Worst verdict of all cases: `pass`, `fail`, `error`, `alarm`; `inconclusive` if it was
    /// aborted.
    pub verdict: &'static str,
    /// Time of its end, UTC, RFC 3339.
    pub at: String,
    /// Time of its beginning.
    pub started: String,
    /// Version of octant.
    pub octant: String,
    /// State of the repository that octant was built from; null outside of one.
    pub git: Option<Git>,
    /// Compiler that octant was built with.
    pub rustc: Option<String>,
    /// SHA-256 of the lock file with which it was built.
    pub lock_file: Option<String>,
    /// The program.
    pub program: PathBuf,
    /// SHA-256 of the program file, hexadecimal.
    pub program_sha256: String,
    /// The machine.
    pub host: Machine,
    /// Operator.
    pub operator: Option<String>,
    /// Number of planned cases.
    pub cases_planned: usize,
    /// Number of cases by verdict.
    pub counts: BTreeMap<&'static str, usize>,
    /// Cases that were run.
    pub cases: Vec<CaseRecord>,
}

impl CaseRecord {
    /// Creates the record of a case with its outcome.
    #[must_use]
    pub fn of(case: &Case, outcome: &Result<CaseOutcome, CaseSetupError>) -> Self {
        let (verdict, found) = match outcome {
            Ok(outcome) => judge(&case.expectation, outcome),
            Err(reason) => (CaseVerdict::Error, format!("failed to {reason}")),
        };
        Self {
            id: case.id,
            kind: case.expectation.kind(),
            about: case.about,
            expected: case.expectation.in_words(),
            source: case.expectation.source(),
            found,
            verdict,
        }
    }
}

impl Record {
    /// Creates the record of the cases that were run, out of `planned` cases.
    ///
    /// # Errors
    /// If the program can't be read.
    pub fn new(
        program: &Path,
        started: SystemTime,
        planned: usize,
        cases: Vec<CaseRecord>,
    ) -> Result<Self, FileError> {
        let manifest = Manifest::of(&RunFacts::between(started, SystemTime::now()));
        let program_sha256 = sha256(program).map_err(FileError::of("read", program))?;
        let mut counts = BTreeMap::new();
        for case in &cases {
            *counts.entry(case.verdict.name()).or_default() += 1;
        }
        Ok(Self {
            schema: SCHEMA,
            verdict: verdict(planned, &cases),
            at: manifest.ended,
            started: manifest.started,
            octant: manifest.octant,
            git: manifest.git,
            rustc: manifest.rustc,
            lock_file: manifest.lock_file,
            program: program.to_owned(),
            program_sha256,
            host: manifest.host,
            operator: manifest.operator,
            cases_planned: planned,
            counts,
            cases,
        })
    }

    /// Returns the exit status of the program.
    #[must_use]
    pub fn exit_code(&self) -> u8 {
        match self.verdict {
            "pass" => 0,
            "fail" => 1,
            "inconclusive" => 3,
            "alarm" => ALARM,
            _ => 4,
        }
    }

    /// Returns the bytes of the file.
    ///
    /// # Errors
    /// If it can't be written as JSON.
    pub fn to_json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Renders the record as text.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        let width = self.cases.iter().map(|case| case.id.len()).max().unwrap_or(0);
        let mut kind = "";
        for case in &self.cases {
            if case.kind != kind {
                kind = case.kind;
                _ = writeln!(text, "{kind}");
            }
            let sign =
                if case.verdict == CaseVerdict::Alarm { "ALARM" } else { case.verdict.name() };
            _ = writeln!(text, "  {sign:5}  {:width$}  {}", case.id, clipped(&case.found));
            if case.verdict != CaseVerdict::Pass {
                _ = writeln!(text, "         {:width$}  expected: {}", "", case.expected);
                _ = writeln!(text, "         {:width$}  {}", "", case.about);
            }
        }
        let passed = self.counts.get("pass").copied().unwrap_or(0);
        _ = writeln!(text, "{}: {passed} of {} cases", self.verdict, self.cases_planned);
        let git = self.git.as_ref().map_or("no repository known".to_owned(), |git| {
            format!("{}{}", git.commit, if git.dirty { ", with local changes" } else { "" })
        });
        _ = writeln!(text, "octant {}, {git}", self.octant);
        _ = writeln!(text, "program {} SHA-256 {}", self.program.display(), self.program_sha256);
        if self.verdict == "alarm" {
            text += "ALARM: what must not pass has passed. Don't believe a pass of this program.\n";
        }
        text
    }
}

/// Returns the worst verdict; inconclusive if a case is missing, or if there is none.
#[must_use]
pub fn verdict(planned: usize, cases: &[CaseRecord]) -> &'static str {
    let worst = cases.iter().map(|case| case.verdict).max();
    match worst {
        Some(worst) if worst > CaseVerdict::Pass => worst.name(),
        Some(_) if cases.len() == planned => "pass",
        _ => "inconclusive",
    }
}

/// Shortens a line to the width of a screen.
fn clipped(text: &str) -> String {
    const MOST: usize = 110;
    let line = text.lines().next().unwrap_or("");
    if line.chars().count() <= MOST {
        return line.to_owned();
    }
    line.chars().take(MOST - 1).chain(['…']).collect()
}

/// Writes a file: whole or not at all.
///
/// # Errors
/// If the operating system refuses.
pub fn write(path: &Path, text: &str) -> Result<(), FileError> {
    let failed = FileError::of("write", path);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    octant_base::whole_file::clean(folder);
    let new = octant_base::whole_file::new_file(folder).map_err(&failed)?;
    std::fs::write(new.path(), text).map_err(&failed)?;
    new.as_file().sync_data().map_err(&failed)?;
    new.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}
