//! Requests of other processes, by files in the folder of the run: whoever may write there may answer.
//!
//! A request is a file `ask-N.json` in the folder `operator`, written whole before it has its name. The run takes it away
//! and leaves `told-N.json`, which the other process takes away. Unlike a socket this works on every system, over shared
//! folders, and with paths of any length. Links and anything else that is no regular file are refused.

use crate::desk::Desk;
use crate::mails::Mails;
use crate::record::AnswerWay;
use octant_base::failing::{Failing, FailureKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Name of the folder.
pub const FOLDER: &str = "operator";

/// Most problems that stay and are told.
const STAYING: usize = 20;

/// Pause between two looks for a reply.
const LOOK: Duration = Duration::from_millis(20);

/// Looks for which the last reply is left in place.
const LAST_LOOKS: u32 = 50;

/// A request to the desk.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "do", rename_all = "kebab-case", deny_unknown_fields)]
pub enum DeskRequest {
    /// An answer to a step.
    Answer {
        /// The step.
        id: String,
        /// The answer.
        value: String,
        /// Who answers.
        by: String,
    },
    /// Hold the run.
    Hold {
        /// Who asks for it.
        by: String,
    },
    /// Let it go on.
    Resume {
        /// Who asks for it.
        by: String,
    },
    /// End it.
    Abort {
        /// Who asks for it.
        by: String,
    },
}

/// The reply.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeskReply {
    /// It counts, in these words.
    Taken(String),
    /// It doesn't, for this reason.
    Refused(String),
}

impl DeskRequest {
    /// Puts the request to the desk.
    #[must_use]
    pub fn apply(&self, desk: &Desk, way: AnswerWay) -> DeskReply {
        let done = match self {
            Self::Answer { id, value, by } => desk.answer(id, value, by, way),
            Self::Hold { by } => desk.hold(by, way).map(|()| "held".to_owned()),
            Self::Resume { by } => desk.resume(by, way).map(|()| "resumed".to_owned()),
            Self::Abort { by } => desk.abort(by, way).map(|()| "aborted".to_owned()),
        };
        match done {
            Ok(words) => DeskReply::Taken(words),
            Err(refusal) => DeskReply::Refused(refusal.to_string()),
        }
    }
}

/// The run's end of the requests. The folder goes with it.
#[derive(Debug)]
pub struct Mailbox {
    folder: PathBuf,
    mails: Mails,
    /// Problems that stay, each of which is told once.
    told: Mutex<BTreeSet<String>>,
}

/// Reasons why a request wasn't taken.
#[derive(Debug, thiserror::Error)]
pub enum MailboxError {
    /// Nobody attends to the run.
    #[error(
        "{0}: no operator is heard there: the run hasn't begun, has ended, or has no operator's steps"
    )]
    Nobody(PathBuf),
    /// The run doesn't answer.
    #[error(
        "{folder}: the run took no request for {waited:?}: it was killed, or its host stands still"
    )]
    Silent {
        /// Folder of the run.
        folder: PathBuf,
        /// Time for which it was waited.
        waited: Duration,
    },
    /// The operating system refuses.
    #[error("{action} {path}: {source}")]
    System {
        /// Action that failed.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

impl Failing for MailboxError {
    fn kind(&self) -> FailureKind {
        match self {
            Self::Nobody(_) => FailureKind::Input,
            Self::Silent { .. } | Self::System { .. } => FailureKind::Bench,
        }
    }
}

impl Mailbox {
    /// Makes the folder for requests to the run in this folder.
    ///
    /// # Errors
    /// If it can't be made.
    pub fn open(run: &Path) -> Result<Self, MailboxError> {
        let folder = run.join(FOLDER);
        let made = std::fs::create_dir(&folder).and_then(|()| Mails::open(&folder));
        match made {
            Ok(mails) => Ok(Self { folder, mails, told: Mutex::default() }),
            Err(source) => Err(MailboxError::System { action: "make", path: folder, source }),
        }
    }

    /// Takes the requests that are there, and replies to each. Returns what was found there that is none, in words.
    #[must_use]
    pub fn serve(&self, mut reply: impl FnMut(DeskRequest) -> DeskReply) -> Vec<String> {
        let names = match self.mails.names() {
            Ok(names) => names,
            Err(error) => {
                let problem = format!("failed to list {}: {error}", self.folder.display());
                return self.once(problem).into_iter().collect();
            }
        };
        let mut problems = Vec::new();
        for name in names {
            let Some(number) = name.strip_prefix("ask-") else { continue };
            let text = self.mails.read(&name);
            if let Err(error) = self.mails.remove(&name) {
                // Gone: the other process gave up, and its request doesn't count.
                if error.kind() != io::ErrorKind::NotFound {
                    let path = self.folder.join(&name);
                    let problem = format!("{}: found no request of an operator", path.display());
                    problems.extend(self.once(problem));
                }
                continue;
            }
            let mut problem = |problem: String| {
                problems.push(format!("{}: {problem}", self.folder.join(&name).display()));
            };
            let request = text.and_then(|text| Ok(serde_json::from_str(&text)?));
            let told = match request {
                Ok(request) => reply(request),
                Err(error) => {
                    problem(format!("found no request of an operator: {error}"));
                    DeskReply::Refused(format!("the request can't be read: {error}"))
                }
            };
            // The other process hears nothing then.
            if let Err(error) = self.mails.put(&format!("told-{number}"), &told) {
                problem(format!("its reply can't be written: {error}"));
            }
        }
        problems
    }

    /// Returns a problem that wasn't told before.
    fn once(&self, problem: String) -> Option<String> {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        (told.len() < STAYING && told.insert(problem.clone())).then_some(problem)
    }
}

impl Drop for Mailbox {
    fn drop(&mut self) {
        // The last reply is for a process that looks for it many times a second.
        for _ in 0..LAST_LOOKS {
            let Ok(names) = self.mails.names() else { break };
            if !names.iter().any(|name| name.starts_with("told-")) {
                break;
            }
            std::thread::sleep(LOOK);
        }
        // If a link was put in its place, the link is removed and not its target.
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Sends a request to the run in this folder, and waits for its reply.
///
/// # Errors
/// If nobody takes it within this time.
pub fn request(
    run: &Path,
    request: &DeskRequest,
    patience: Duration,
) -> Result<DeskReply, MailboxError> {
    let folder = run.join(FOLDER);
    let system =
        |action, path: PathBuf| move |source| MailboxError::System { action, path, source };
    let mails = match Mails::open(&folder) {
        Ok(mails) => mails,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            return Err(MailboxError::Nobody(run.to_owned()));
        }
        Err(error) => return Err(system("open", folder)(error)),
    };
    let number = number();
    let asked = format!("ask-{number}");
    let told = format!("told-{number}");
    mails.put(&asked, request).map_err(system("write", folder.join(&asked)))?;
    let begun = Instant::now();
    loop {
        match mails.read(&told) {
            Ok(text) => {
                let _ = mails.remove(&told);
                let read = serde_json::from_str(&text).map_err(io::Error::from);
                return read.map_err(system("read", folder.join(&told)));
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(system("read", folder.join(&told))(error)),
        }
        if !mails.is_there() {
            return Err(MailboxError::Nobody(run.to_owned()));
        }
        // Taken away: the run has not taken it, and won't.
        if begun.elapsed() >= patience && mails.remove(&asked).is_ok() {
            let folder = run.to_owned();
            return Err(MailboxError::Silent { folder, waited: patience });
        }
        if begun.elapsed() >= 2 * patience {
            let folder = run.to_owned();
            return Err(MailboxError::Silent { folder, waited: 2 * patience });
        }
        std::thread::sleep(LOOK);
    }
}

/// Number that no other request has.
fn number() -> String {
    use std::hash::{BuildHasher, Hasher};
    // `RandomState` is keyed by random numbers of the system.
    let mut hasher = std::hash::RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    format!("{:016x}", hasher.finish())
}
