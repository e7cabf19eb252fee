//! Requests of other processes, by files in the folder of the run: whoever may write there may answer.
//!
//! A request is a file `ask-N.json` in the folder `operator`, written whole before it has its name. The run takes it away
//! and leaves `told-N.json`, which the other process takes away. Unlike a socket this works on every system, over shared
//! folders, and with paths of any length.

use crate::desk::Desk;
use crate::record::AnswerWay;
use octant_base::failing::{Failing, FailureKind};
use serde::{Deserialize, Serialize};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Name of the folder.
pub const FOLDER: &str = "operator";

/// Most bytes of a request.
const LARGEST: u64 = 1 << 16;

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
        match std::fs::create_dir(&folder) {
            Ok(()) => Ok(Self { folder }),
            Err(source) => Err(MailboxError::System { action: "make", path: folder, source }),
        }
    }

    /// Takes the requests that are there, and replies to each.
    pub fn serve(&self, mut reply: impl FnMut(DeskRequest) -> DeskReply) {
        let Ok(entries) = std::fs::read_dir(&self.folder) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            let Some(number) = name.strip_prefix("ask-") else { continue };
            let path = entry.path();
            let is_file = std::fs::symlink_metadata(&path)
                .is_ok_and(|found| found.is_file() && found.len() <= LARGEST);
            let text = if is_file { std::fs::read_to_string(&path).ok() } else { None };
            // Gone: the other process gave up, and its request doesn't count.
            if std::fs::remove_file(&path).is_err() {
                continue;
            }
            let request = text.and_then(|text| serde_json::from_str(&text).ok());
            let told = match request {
                Some(request) => reply(request),
                None => DeskReply::Refused("the request can't be read".to_owned()),
            };
            // Where this fails the other process says that it heard nothing.
            let _ = put(&self.folder, &format!("told-{number}"), &told);
        }
    }
}

impl Drop for Mailbox {
    fn drop(&mut self) {
        // The last reply is for a process that looks for it many times a second.
        let is_reply = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with("told-");
        for _ in 0..LAST_LOOKS {
            let Ok(mut entries) = std::fs::read_dir(&self.folder) else { return };
            if !entries.any(|entry| entry.is_ok_and(|entry| is_reply(&entry.file_name()))) {
                break;
            }
            std::thread::sleep(LOOK);
        }
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Writes a file whole.
fn put(folder: &Path, name: &str, content: &impl Serialize) -> io::Result<()> {
    let text = serde_json::to_string(content)?;
    let draft = folder.join(format!(".{name}"));
    std::fs::write(&draft, text)?;
    std::fs::rename(&draft, folder.join(name))
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
    if !folder.is_dir() {
        return Err(MailboxError::Nobody(run.to_owned()));
    }
    let number = number();
    let asked = folder.join(format!("ask-{number}"));
    let told = folder.join(format!("told-{number}"));
    let system = |action, path: &Path| {
        let path = path.to_owned();
        move |source| MailboxError::System { action, path, source }
    };
    put(&folder, &format!("ask-{number}"), request).map_err(system("write", &asked))?;
    let begun = Instant::now();
    loop {
        match std::fs::read_to_string(&told) {
            Ok(text) => {
                let _ = std::fs::remove_file(&told);
                let read = serde_json::from_str(&text).map_err(io::Error::from);
                return read.map_err(system("read", &told));
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(system("read", &told)(error)),
        }
        if !folder.is_dir() {
            return Err(MailboxError::Nobody(run.to_owned()));
        }
        // Taken away: the run has not taken it, and won't.
        if begun.elapsed() >= patience && std::fs::remove_file(&asked).is_ok() {
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
