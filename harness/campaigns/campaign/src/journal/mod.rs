//! Journal of a campaign: every plan, extension, look, repetition and restriction, in the order in which they happened.
//!
//! The file has [chained lines](octant_base::chained_lines) of JSON, and is only appended to: a line that is edited or left out
//! is found. The chain has no key: the manifest holds the hash of the whole file, and a signature covers the manifest.

use octant_base::chained_lines::{ChainedLines, ChainedLinesError};
use octant_base::failing::{Failing, FailureKind};
use octant_base::not_finite;
use octant_evidence::maker::Maker;
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Name of the file, in the folder of a campaign.
pub const FILE_NAME: &str = "campaign.journal";
/// First line of the file.
const FIRST: &str = "octant campaign journal 1";
/// Beginning of the first line, of any version.
const KIND: &str = "octant campaign journal ";
/// Time for which a process waits for another one that writes.
const WAIT: Duration = Duration::from_secs(10);
/// Accuracy with which times are compared.
const SECOND: Duration = Duration::from_secs(1);
/// Largest number of cases that an entry names.
const NAMED: usize = 20;

/// Event of a campaign.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum JournalEvent {
    /// A plan was made, or came from a bundle.
    Planned(PlannedEvent),
    /// A plan took the place of a smaller one.
    Extended {
        /// Id of the plan before.
        before: String,
        /// Its cases.
        cases_before: usize,
        /// The new plan.
        to: PlannedEvent,
    },
    /// A folder without a journal was used: nobody knows how often it was looked at before.
    Begun {
        /// Results that were there.
        results: usize,
        /// The plan.
        plan: PlannedEvent,
    },
    /// Outcomes were shown.
    Look {
        /// The plan.
        plan: String,
        /// Command that showed them.
        by: String,
        /// Cases of the plan at that time.
        cases: usize,
        /// Cases that had a result.
        results: usize,
    },
    /// The outcome of a single case was shown before the look.
    Opened {
        /// The case.
        case: String,
        /// Command that showed it.
        by: String,
    },
    /// Cases were run again although they had a result.
    Rerun {
        /// Number of results that were forgotten, of cases that ended as errors.
        forgotten: usize,
        /// Number of cases that had to come to the same result again.
        repeated: usize,
        /// The first of them.
        cases: Vec<String>,
    },
    /// A run left cases of the plan out.
    Restricted {
        /// Patterns of the cases that it ran.
        only: Vec<String>,
        /// Number of these.
        cases: usize,
        /// Number of all cases.
        of: usize,
    },
}

/// Statement of a journal on a plan.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlannedEvent {
    /// Its id.
    pub plan: String,
    /// Cases.
    pub cases: usize,
    /// Draws of each combination.
    pub replicates: u32,
    /// Seed, and where it comes from.
    pub seed: String,
    /// How it is looked at.
    pub looks: String,
}

/// Entry of a journal.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JournalEntry {
    /// Time, UTC.
    pub at: String,
    /// Person, host and program.
    pub by: Maker,
    /// Event.
    pub event: JournalEvent,
}

/// Journal of a campaign, as it was when it was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Journal {
    /// The entries, in their order; none without a file.
    pub entries: Vec<JournalEntry>,
    /// True if there is a file.
    pub is_there: bool,
}

/// Reasons why a journal can't be used. The text fits after "failed to".
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The operating system refuses.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// A line isn't the expected one.
    #[error("read {path}: line {line}: {problem}")]
    Line {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Found and expected content.
        problem: String,
    },
}

impl Failing for JournalError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::System { .. } => FailureKind::Bench,
            Self::Line { .. } => FailureKind::Input,
        }
    }
}

impl From<ChainedLinesError> for JournalError {
    fn from(error: ChainedLinesError) -> Self {
        match error {
            ChainedLinesError::System { action, path, source } => {
                Self::System { action, path, source }
            }
            ChainedLinesError::Line { path, line, problem } => Self::Line { path, line, problem },
        }
    }
}

impl JournalEntry {
    /// Returns whether outcomes were shown.
    #[must_use]
    pub fn is_look(&self) -> bool {
        matches!(self.event, JournalEvent::Look { .. })
    }
}

impl Journal {
    /// Reads the journal in the folder of a campaign; it is empty if there is none.
    ///
    /// # Errors
    /// If it can't be read, is of a newer version, or a line was edited or left out.
    pub fn read(folder: &Path) -> Result<Self, JournalError> {
        let path = folder.join(FILE_NAME);
        let mut entries = Vec::new();
        match ChainedLines::read(&path, is_mine, |line| take(line, &mut entries)) {
            Ok(()) => Ok(Self { entries, is_there: true }),
            Err(ChainedLinesError::System { source, .. })
                if source.kind() == ErrorKind::NotFound =>
            {
                Ok(Self::default())
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Appends an event that happens now; it is on the disk when this returns.
    ///
    /// # Errors
    /// As [`Journal::read`], and if the file can't be written.
    pub fn append(folder: &Path, event: JournalEvent) -> Result<(), JournalError> {
        let path = folder.join(FILE_NAME);
        let at = octant_base::utc::millis(SystemTime::now());
        let entry = JournalEntry { at, by: Maker::this(), event };
        let text = serde_json::to_string(&entry).map_err(|error| JournalError::System {
            action: "write",
            path: path.clone(),
            source: error.into(),
        })?;
        std::fs::create_dir_all(folder).map_err(|source| JournalError::System {
            action: "create",
            path: folder.to_owned(),
            source,
        })?;
        let begun = Instant::now();
        let mut lines = loop {
            // Another process may write at the same time, for as long as it takes to write a line.
            match ChainedLines::open(&path, FIRST, is_mine, |_| Ok(())) {
                Err(ChainedLinesError::System { action: "lock", source, .. })
                    if source.kind() == ErrorKind::WouldBlock && begun.elapsed() < WAIT =>
                {
                    std::thread::sleep(Duration::from_millis(5));
                }
                opened => break opened?,
            }
        };
        Ok(lines.append([text])?)
    }

    /// Returns the number of cases of the plan at the first look; `None` before.
    #[must_use]
    pub fn cases_at_first_look(&self) -> Option<usize> {
        self.entries.iter().find_map(|entry| match &entry.event {
            JournalEvent::Look { cases, .. } => Some(*cases),
            _ => None,
        })
    }

    /// Returns the plan, and its results, of the last look.
    #[must_use]
    pub fn last_look(&self) -> Option<(&str, usize)> {
        self.entries.iter().rev().find_map(|entry| match &entry.event {
            JournalEvent::Look { plan, results, .. } => Some((plan.as_str(), *results)),
            _ => None,
        })
    }

    /// Returns the id of the plan that it names last.
    #[must_use]
    pub fn plan(&self) -> Option<&str> {
        self.entries.iter().rev().find_map(|entry| match &entry.event {
            JournalEvent::Planned(plan)
            | JournalEvent::Extended { to: plan, .. }
            | JournalEvent::Begun { plan, .. } => Some(plan.plan.as_str()),
            _ => None,
        })
    }

    /// Describes where it contradicts a folder with this plan, in which so many results were taken back, the first of
    /// them stored at a time.
    #[must_use]
    pub fn contradictions(
        &self,
        plan: &str,
        taken_back: u64,
        first_result: Option<SystemTime>,
    ) -> Vec<String> {
        let mut found = Vec::new();
        let planned = self.entries.first();
        let planned = planned.filter(|entry| matches!(entry.event, JournalEvent::Planned(_)));
        let planned = planned.and_then(|entry| octant_base::utc::parse(&entry.at).ok());
        if planned.zip(first_result).is_some_and(|(planned, first)| first + SECOND < planned) {
            found.push(format!("{FILE_NAME} begins after the first result was stored"));
        }
        if let Some(named) = self.plan().filter(|named| *named != plan) {
            let short = |id: &str| id.chars().take(12).collect::<String>();
            found.push(format!(
                "{FILE_NAME} ends with plan {}, the folder has plan {}: it is an older one, or of another campaign",
                short(named),
                short(plan)
            ));
        }
        let said = self.forgotten() as u64;
        if said != taken_back {
            found.push(format!(
                "{taken_back} results were taken back, and {FILE_NAME} tells of {said}"
            ));
        }
        found
    }

    /// Describes what was done that a claim has to be read with; `results` is the number of results now.
    #[must_use]
    pub fn doubts(&self, results: usize) -> Vec<String> {
        let mut opened = 0;
        let mut found = Vec::new();
        // The same words as those of the entry that begins one.
        if !self.is_there && results > 0 {
            found.push(unknown_before(results));
        }
        for entry in &self.entries {
            match &entry.event {
                JournalEvent::Begun { results, .. } if *results > 0 => {
                    found.push(unknown_before(*results));
                }
                JournalEvent::Opened { .. } => opened += 1,
                _ => {}
            }
        }
        if opened > 0 {
            found.push(format!(
                "outcomes of single cases were shown before the look: {opened} times"
            ));
        }
        found
    }

    /// Returns the number of results that were forgotten.
    #[must_use]
    pub fn forgotten(&self) -> usize {
        let of = |entry: &JournalEntry| match &entry.event {
            JournalEvent::Rerun { forgotten, .. } => *forgotten,
            _ => 0,
        };
        self.entries.iter().map(of).sum()
    }
}

impl JournalEvent {
    /// Makes the entry of cases that are run again.
    #[must_use]
    pub fn rerun<'a>(
        forgotten: usize,
        repeated: usize,
        cases: impl Iterator<Item = &'a str>,
    ) -> Self {
        let cases = cases.take(NAMED).map(str::to_owned).collect();
        Self::Rerun { forgotten, repeated, cases }
    }

    /// Describes it.
    #[must_use]
    pub fn in_words(&self) -> String {
        let plan = |plan: &PlannedEvent| {
            let PlannedEvent { plan, cases, replicates, seed, looks } = plan;
            let plan: String = plan.chars().take(12).collect();
            format!("plan {plan}: {cases} cases, {replicates} draws, {seed}, {looks}")
        };
        let named = |cases: &[String], all: usize| {
            let more = if all > cases.len() { ", …" } else { "" };
            format!("{}{more}", cases.join(", "))
        };
        match self {
            Self::Planned(planned) => plan(planned),
            Self::Extended { cases_before, to, .. } => {
                format!("extended from {cases_before} cases, {}", plan(to))
            }
            Self::Begun { results, plan: planned } => {
                format!("found no journal, with {results} results there, {}", plan(planned))
            }
            Self::Look { by, cases, results, .. } => {
                format!("looked at by {by}: {results} results of {cases} cases")
            }
            Self::Opened { case, by } => format!("case {case} shown by {by} before the look"),
            Self::Rerun { forgotten, repeated, cases } => format!(
                "{forgotten} errors forgotten, {repeated} cases repeated: {}",
                named(cases, forgotten + repeated)
            ),
            Self::Restricted { only, cases, of } => {
                format!("{cases} of {of} cases run alone, those of {}", only.join(" and "))
            }
        }
    }
}

fn unknown_before(results: usize) -> String {
    format!(
        "{FILE_NAME} begins with {results} results there: nobody knows how often they were looked at before"
    )
}

fn is_mine(line: &str) -> Result<(), String> {
    if line == FIRST {
        return Ok(());
    }
    Err(match line.strip_prefix(KIND) {
        Some(version) => format!("found version {version}, this program reads version 1"),
        None => format!("found {line:?}, expected {FIRST:?}"),
    })
}

fn take(line: &str, entries: &mut Vec<JournalEntry>) -> Result<(), String> {
    let entry =
        not_finite::from_str(line).map_err(|error| format!("expected an entry: {error}"))?;
    entries.push(entry);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn look(results: usize) -> JournalEvent {
        JournalEvent::Look { plan: "p".to_owned(), by: "status".to_owned(), cases: 9, results }
    }

    #[test]
    fn entries_come_back_and_a_line_that_is_left_out_is_found() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Journal::read(folder.path()).unwrap(), Journal::default());
        for results in [3, 5, 9] {
            Journal::append(folder.path(), look(results)).unwrap();
        }
        let found = Journal::read(folder.path()).unwrap();
        let events: Vec<_> = found.entries.iter().map(|entry| entry.event.clone()).collect();
        assert_eq!(events, [look(3), look(5), look(9)]);
        assert_eq!(found.last_look(), Some(("p", 9)));
        assert_eq!((found.cases_at_first_look(), found.plan()), (Some(9), None));
        let path = folder.path().join(FILE_NAME);
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<&str> = text.split_inclusive('\n').collect();
        for (changed, expected) in [
            ([lines[0], lines[1], lines[3]].concat(), "line 3: the checksum doesn't fit"),
            (text.replace("\"results\":5", "\"results\":4"), "line 3: the checksum doesn't fit"),
            (text.replace("journal 1", "journal 2"), "line 1: found version 2, this program"),
            (text.replace("octant campaign", "another"), "line 1: found \"another journal 1\""),
        ] {
            std::fs::write(&path, changed).unwrap();
            let error = Journal::read(folder.path()).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
            assert!(Journal::append(folder.path(), look(1)).is_err());
        }
    }

    #[test]
    fn several_processes_append_at_once() {
        let folder = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| {
                    (0..5).for_each(|n| Journal::append(folder.path(), look(n)).unwrap())
                });
            }
        });
        assert_eq!(Journal::read(folder.path()).unwrap().entries.len(), 20);
    }
}
