//! Starts the program for a case, in a folder of its own, as a user would.

use super::error::{BenchError, FileError};
use super::judge::CaseOutcome;
use octant_base::child::{ChildEnded, finish};
use octant_campaign::execute::process;
use octant_score::summary::Summary;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Time limit of a case; a longer one has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// Variables of the user's environment that a case must not see.
const UNHEARD: [&str; 8] = [
    octant_evidence::signature::KEY,
    octant_evidence::signature::PASSWORD,
    "SLURM_ARRAY_TASK_ID",
    "SLURM_ARRAY_TASK_MIN",
    "SLURM_ARRAY_TASK_MAX",
    "SLURM_ARRAY_TASK_COUNT",
    "JOB_COMPLETION_INDEX",
    "OCTANT_SHARDS",
];

/// Folder of a case, and the program.
#[derive(Debug)]
pub struct CaseBench<'a> {
    program: &'a Path,
    folder: PathBuf,
    cancel: &'a AtomicBool,
}

/// Output of a process, and its exit status.
#[derive(Clone, Debug)]
pub struct ProcessOutput {
    /// Exit status; `None` if there is none.
    pub status: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl<'a> CaseBench<'a> {
    /// Creates a folder.
    ///
    /// # Errors
    /// If it can't be made.
    pub fn new(
        program: &'a Path,
        folder: &Path,
        cancel: &'a AtomicBool,
    ) -> Result<Self, BenchError> {
        std::fs::create_dir_all(folder).map_err(FileError::of("make", folder))?;
        Ok(Self { program, folder: folder.to_owned(), cancel })
    }

    /// Returns the path of a file in it.
    #[must_use]
    pub fn at(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), BenchError> {
        let path = self.at(name);
        Ok(std::fs::write(&path, contents).map_err(FileError::of("write", &path))?)
    }

    /// Makes a file readable by its owner only, as required of a key.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn keep_private(&self, name: &str) -> Result<(), BenchError> {
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let path = self.at(name);
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600))
                .map_err(FileError::of("keep", &path))?;
        }
        let _ = name;
        Ok(())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// If the operating system refuses.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, BenchError> {
        let path = self.at(name);
        Ok(std::fs::read(&path).map_err(FileError::of("read", &path))?)
    }

    /// Starts the program with these arguments, and waits for its end.
    ///
    /// # Errors
    /// If it can't be started.
    pub fn octant(&self, words: &[&str]) -> Result<ProcessOutput, BenchError> {
        self.octant_with(words, &[])
    }

    /// Starts as [`CaseBench::octant`], with environment variables.
    ///
    /// # Errors
    /// If it can't be started.
    pub fn octant_with(
        &self,
        words: &[&str],
        more: &[(&str, &str)],
    ) -> Result<ProcessOutput, BenchError> {
        let system = FileError::of("start", self.program);
        let mut command = process::command(self.program);
        command.args(words).current_dir(&self.folder).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        for name in UNHEARD {
            command.env_remove(name);
        }
        command.envs(more.iter().copied());
        let child = command.spawn().map_err(&system)?;
        let outcome = finish(child, &[], u64::MAX, LIMIT, self.cancel).map_err(&system)?;
        let status = match outcome.ended {
            ChildEnded::Status(status) => status.code(),
            ChildEnded::TooLong | ChildEnded::Cancelled => None,
            ChildEnded::Outside(by) => {
                return Err(BenchError::Outside { program: self.program.to_owned(), by });
            }
        };
        Ok(ProcessOutput { status, out: outcome.out, err: outcome.err })
    }

    /// Runs a scenario, given as text, into the folder `run`; returns its summary if it was
    /// written.
    ///
    /// # Errors
    /// If the program can't be started.
    pub fn run(&self, scenario: &str, more: &[&str]) -> Result<Ran, BenchError> {
        self.write("scenario.toml", scenario)?;
        let mut words = vec!["run", "scenario.toml", "--out", "run", "--json"];
        words.extend_from_slice(more);
        let said = self.octant(&words)?;
        let summary = Summary::from_json(&said.out).ok();
        Ok(Ran { said, summary })
    }
}

impl From<ProcessOutput> for CaseOutcome {
    fn from(said: ProcessOutput) -> Self {
        Self { status: said.status, said: said.err + &said.out, ..Self::default() }
    }
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Ran {
    /// Output of the program.
    pub said: ProcessOutput,
    /// Summary.
    pub summary: Option<Summary>,
}

impl Ran {
    /// Returns the summary, without which the case can't go on.
    ///
    /// # Errors
    /// If there is none.
    pub fn summary(&self) -> Result<&Summary, BenchError> {
        self.summary.as_ref().ok_or_else(|| BenchError::NoSummary {
            status: self.said.status,
            said: self.said.err.clone(),
        })
    }
}

impl From<Ran> for CaseOutcome {
    fn from(ran: Ran) -> Self {
        let reasons = ran.summary.as_ref().map(|summary| summary.reasons.join("\n"));
        let verdict = ran.summary.as_ref().map(|summary| summary.verdict);
        let mut said = reasons.unwrap_or_default();
        said += "\n";
        said += &ran.said.err;
        Self { status: ran.said.status, verdict, said, ..Self::default() }
    }
}
