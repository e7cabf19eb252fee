//! Starts the program for a case, in a folder of its own, as a user would.

use super::judge::Outcome;
use crate::campaign::process::{self, Ended};
use octant_score::summary::Summary;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A case that takes longer than this has failed.
const LIMIT: Duration = Duration::from_secs(300);

/// What the environment of the user says and a case must not hear.
const UNHEARD: [&str; 8] = [
    crate::evidence::signature::KEY,
    crate::evidence::signature::PASSWORD,
    "SLURM_ARRAY_TASK_ID",
    "SLURM_ARRAY_TASK_MIN",
    "SLURM_ARRAY_TASK_MAX",
    "SLURM_ARRAY_TASK_COUNT",
    "JOB_COMPLETION_INDEX",
    "OCTANT_SHARDS",
];

/// The folder of a case, and the program.
#[derive(Debug)]
pub struct Bench<'a> {
    program: &'a Path,
    folder: PathBuf,
    cancel: &'a AtomicBool,
}

/// What a process said, and how it ended.
#[derive(Clone, Debug)]
pub struct Said {
    /// Exit status; `None`: it has none.
    pub status: Option<i32>,
    /// Its standard output.
    pub out: String,
    /// Its standard error.
    pub err: String,
}

impl<'a> Bench<'a> {
    /// A new folder.
    ///
    /// # Errors
    /// In words, if it can't be made.
    pub fn new(program: &'a Path, folder: &Path, cancel: &'a AtomicBool) -> Result<Self, String> {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("make {}: {error}", folder.display()))?;
        Ok(Self { program, folder: folder.to_owned(), cancel })
    }

    /// A file in it.
    #[must_use]
    pub fn at(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// In words.
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), String> {
        let path = self.at(name);
        std::fs::write(&path, contents)
            .map_err(|error| format!("write {}: {error}", path.display()))
    }

    /// Lets nobody else read a file, as a key has to be kept.
    ///
    /// # Errors
    /// In words.
    pub fn keep_private(&self, name: &str) -> Result<(), String> {
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let path = self.at(name);
            std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o600))
                .map_err(|error| format!("keep {}: {error}", path.display()))?;
        }
        let _ = name;
        Ok(())
    }

    /// Reads a file.
    ///
    /// # Errors
    /// In words.
    pub fn read(&self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.at(name);
        std::fs::read(&path).map_err(|error| format!("read {}: {error}", path.display()))
    }

    /// Starts the program with these words, and waits for its end.
    ///
    /// # Errors
    /// In words, if it can't be started.
    pub fn octant(&self, words: &[&str]) -> Result<Said, String> {
        self.octant_with(words, &[])
    }

    /// As [`Bench::octant`], with variables of the environment.
    ///
    /// # Errors
    /// In words, if it can't be started.
    pub fn octant_with(&self, words: &[&str], more: &[(&str, &str)]) -> Result<Said, String> {
        let system = |error| format!("start {}: {error}", self.program.display());
        let mut command = process::command(self.program);
        command.args(words).current_dir(&self.folder).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        for name in UNHEARD {
            command.env_remove(name);
        }
        command.envs(more.iter().copied());
        let mut child = command.spawn().map_err(system)?;
        let (out, err) = (child.stdout.take(), child.stderr.take());
        std::thread::scope(|scope| {
            let out = scope.spawn(|| all(out));
            let err = scope.spawn(|| all(err));
            let status = match process::wait(&mut child, LIMIT, self.cancel).map_err(system)? {
                Ended::Status(status) => status.code(),
                Ended::TooLong | Ended::Cancelled => None,
                Ended::Outside(by) => {
                    let program = self.program.display();
                    return Err(format!("run {program}: it was ended from outside, by {by}"));
                }
            };
            let (out, err) = (out.join().unwrap_or_default(), err.join().unwrap_or_default());
            Ok(Said { status, out, err })
        })
    }

    /// Runs a scenario, given as text, into the folder `run`; its summary comes along where it wrote
    /// one.
    ///
    /// # Errors
    /// In words, if the program can't be started.
    pub fn run(&self, scenario: &str, more: &[&str]) -> Result<Ran, String> {
        self.write("scenario.toml", scenario)?;
        let mut words = vec!["run", "scenario.toml", "--out", "run", "--json"];
        words.extend_from_slice(more);
        let said = self.octant(&words)?;
        let summary = Summary::from_json(&said.out).ok();
        Ok(Ran { said, summary })
    }
}

fn all(pipe: Option<impl Read>) -> String {
    let mut bytes = Vec::new();
    if let Some(mut pipe) = pipe {
        // What can't be read was not said.
        let _ = pipe.read_to_end(&mut bytes);
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

impl From<Said> for Outcome {
    fn from(said: Said) -> Self {
        Self { status: said.status, said: said.err + &said.out, ..Self::default() }
    }
}

/// A run that was made.
#[derive(Clone, Debug)]
pub struct Ran {
    /// What the program said.
    pub said: Said,
    /// Its summary.
    pub summary: Option<Summary>,
}

impl Ran {
    /// The summary, which has to be there for the case to go on.
    ///
    /// # Errors
    /// In words: what the program said instead.
    pub fn summary(&self) -> Result<&Summary, String> {
        self.summary.as_ref().ok_or_else(|| {
            format!("run a scenario: no summary, status {:?}: {}", self.said.status, self.said.err)
        })
    }
}

impl From<Ran> for Outcome {
    fn from(ran: Ran) -> Self {
        let reasons = ran.summary.as_ref().map(|summary| summary.reasons.join("\n"));
        let verdict = ran.summary.as_ref().map(|summary| summary.verdict);
        let mut said = reasons.unwrap_or_default();
        said += "\n";
        said += &ran.said.err;
        Self { status: ran.said.status, verdict, said, ..Self::default() }
    }
}
