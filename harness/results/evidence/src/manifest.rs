//! `manifest.json`: origin of a run, versions, and the hashes of everything in its folder.

pub use super::error::ManifestError;
pub use super::facts::{CampaignFacts, FmuFacts, JournalCounts, RunFacts};
pub use super::files::{FileHash, MANIFEST as FILE_NAME};
pub use super::host::Machine;
pub use super::program::{operator, program_sha256};

use super::files::LOCK;
use super::files::{self, Entries, system};
use super::inputs::InputFacts;
use octant_account::Account;
use octant_base::printable::printable;
use octant_operator::{OperatorRecord, journal};
use octant_realtime::schedule::Granted;
use octant_score::numerics::NUMERICS;
use octant_verdict::equipment::Equipment;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Version of the manifest's layout.
pub const SCHEMA: u32 = 1;

/// The manifest of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Version of this layout.
    pub schema: u32,
    /// Version of octant.
    pub octant: String,
    /// Numerics version of octant; `null` in manifests from before there was one.
    #[serde(default)]
    pub numerics: Option<u32>,
    /// State of the repository that octant was built from; `null` outside of one.
    pub git: Option<Git>,
    /// Compiler that octant was built with; `null` if it isn't known.
    pub rustc: Option<String>,
    /// The machine.
    pub host: Machine,
    /// Seed of the run; `null` where there is none, as in a replay.
    pub seed: Option<u64>,
    /// Start of the run, UTC, RFC 3339.
    pub started: String,
    /// End of the run, UTC, RFC 3339.
    pub ended: String,
    /// Command line that reproduces the run, program first: with the seed that was used, without
    /// the folder.
    pub command_line: Vec<String>,
    /// A line for a POSIX shell that runs it again.
    pub rerun: String,
    /// FMUs that took part; omitted if there were none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fmus: Vec<FmuFacts>,
    /// Recordings from which its samples came; omitted if there were none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inputs: Vec<InputFacts>,
    /// Accounts of what came in from outside, as in `summary.json`; omitted if nothing did.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub accounts: Vec<Account>,
    /// Equipment of the bench; omitted if the scenario names none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub equipment: Vec<Equipment>,
    /// Device of a run over a wire, and the traffic counts; omitted in other runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<serde_json::Value>,
    /// Clocks and counts of a real instrument and the table under it; omitted in other runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bench: Option<serde_json::Value>,
    /// Real-time settings that the host granted a run by the clock; omitted in other runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub realtime: Option<Granted>,
    /// Questions to a person, answers and requests, as in `operator.jsonl`; omitted where nobody was asked.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub answers: Vec<OperatorRecord>,
    /// Result of a campaign; omitted in runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub campaign: Option<CampaignFacts>,
    /// Every other file of the folder, by path.
    pub files: Vec<FileHash>,
    /// Empty folders; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub empty_folders: Vec<String>,
    /// Operator: the value of `OCTANT_OPERATOR`, or the name of the account; `null` without either.
    #[serde(default)]
    pub operator: Option<String>,
    /// SHA-256 of the lock file that octant was built by, hexadecimal.
    #[serde(default)]
    pub lock_file: Option<String>,
    /// SHA-256 of the program, hexadecimal; `null` where it can't be read, and in older manifests.
    #[serde(default)]
    pub program_sha256: Option<String>,
    /// Key whose signature of this file is beside it, in `manifest.json.minisig`; `null` if it
    /// isn't signed.
    pub signature: Option<String>,
}

/// State of a repository.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Git {
    /// The commit.
    pub commit: String,
    /// True if there were uncommitted changes.
    pub dirty: bool,
}

impl Manifest {
    /// Creates a manifest from the facts, still without files.
    #[must_use]
    pub fn of(facts: &RunFacts) -> Self {
        let some = |text: &str| (!text.is_empty()).then(|| text.to_owned());
        let build = super::build::this();
        Self {
            schema: SCHEMA,
            octant: env!("CARGO_PKG_VERSION").into(),
            numerics: Some(NUMERICS),
            git: some(build.git_commit).map(|commit| Git { commit, dirty: build.is_git_dirty }),
            rustc: some(build.rustc),
            host: Machine::this(),
            seed: facts.seed,
            started: octant_base::utc::millis(facts.started),
            ended: octant_base::utc::millis(facts.ended),
            rerun: match &facts.campaign {
                Some(campaign) => campaign.rerun.clone(),
                None => shell_line(&facts.command_line),
            },
            command_line: facts.command_line.clone(),
            fmus: facts.fmus.clone(),
            inputs: facts.inputs.clone(),
            accounts: facts.accounts.clone(),
            equipment: facts.equipment.clone(),
            link: facts.link.clone(),
            bench: facts.bench.clone(),
            realtime: facts.realtime.clone(),
            answers: facts.answers.clone(),
            campaign: facts.campaign.clone(),
            files: Vec::new(),
            empty_folders: Vec::new(),
            operator: operator(),
            lock_file: some(build.lock_file_sha256),
            program_sha256: program_sha256(),
            signature: facts.key.as_ref().map(|key| format!("minisign key {}", key.id())),
        }
    }

    /// Lists name and value of the entries that a report shows about its origin.
    #[must_use]
    pub fn entries(&self) -> Vec<(String, String)> {
        let git = self.git.as_ref().map_or("not known".to_owned(), |git| {
            format!("{}{}", git.commit, if git.dirty { ", with local changes" } else { "" })
        });
        let host = &self.host;
        let cpu = host.cpu.as_deref().unwrap_or(&host.arch);
        let fmus = self.fmus.iter().map(|fmu| {
            let sha256 = fmu.sha256.as_deref().unwrap_or("not hashed");
            let text = format!(
                "{} (FMI {}, {}, SHA-256 {sha256}), in {} process",
                fmu.file,
                fmu.fmi,
                if fmu.generation_tool.is_empty() {
                    "tool not named"
                } else {
                    &fmu.generation_tool
                },
                if fmu.process == "own" { "its own" } else { "the program's" },
            );
            (format!("FMU as {}", fmu.role), text)
        });
        let inputs = self.inputs.iter().map(|input| {
            ("recording".to_owned(), format!("{} (SHA-256 {})", input.file, input.sha256))
        });
        let equipment = self.equipment.iter().map(|piece| {
            let holds = format!("certificate {}, until {}", piece.certificate, piece.expires);
            (piece.named(), holds)
        });
        let link = self.link.iter().flat_map(|link| {
            ["device", "firmware", "port", "pacing"]
                .into_iter()
                .filter_map(|name| Some((name.to_owned(), link.get(name)?.as_str()?.to_owned())))
        });
        // The parts of the bench that a report shows are stored as text under their names.
        let bench = self.bench.iter().flat_map(|bench| {
            [
                "instrument",
                "instrument's clock",
                "samples' times",
                "turntable",
                "table's angles",
                "power of the device",
            ]
            .into_iter()
            .filter_map(|name| Some((name.to_owned(), bench.get(name)?.as_str()?.to_owned())))
        });
        let realtime = self.realtime.iter().flat_map(|granted| {
            [
                ("real-time scheduling", granted.scheduling.text()),
                ("locked memory", granted.memory.text()),
                ("processor", granted.cpu.text()),
            ]
            .map(|(name, value)| (name.to_owned(), value))
        });
        let answers = self
            .answers
            .iter()
            .map(|record| (format!("operator's part, {}", record.at), record.text()));
        [
            ("octant", self.octant.clone()),
            ("numerics version", self.numerics.map_or("not known".to_owned(), |v| v.to_string())),
            ("source revision", git),
            (
                "program, SHA-256",
                self.program_sha256.clone().unwrap_or_else(|| "not known".to_owned()),
            ),
            ("compiler", self.rustc.clone().unwrap_or_else(|| "not known".to_owned())),
            ("host", format!("{}, {}, {cpu}, {} processors", host.name, host.os, host.cpus)),
            ("operator", self.operator.clone().unwrap_or_else(|| "not known".to_owned())),
            ("started", self.started.clone()),
            ("ended", self.ended.clone()),
            ("signature", self.signature.clone().unwrap_or_else(|| "unsigned".to_owned())),
        ]
        .map(|(name, value)| (name.to_owned(), value))
        .into_iter()
        .chain(fmus)
        .chain(inputs)
        .chain(equipment)
        .chain(link)
        .chain(bench)
        .chain(realtime)
        .chain(answers)
        .collect()
    }

    /// Hashes everything in the folder of a run, writes its manifest, and signs it if there is a
    /// key.
    ///
    /// # Errors
    /// If a file can't be read, or the manifest can't be written.
    pub fn write(folder: &Path, facts: &RunFacts) -> Result<Self, ManifestError> {
        let path = folder.join(FILE_NAME);
        let entries = Entries::of(folder)?;
        if let Some((name, what)) = entries.others.first_key_value() {
            return Err(ManifestError::Form {
                path: folder.join(name),
                reason: format!("it is {what}: evidence is regular files and folders"),
            });
        }
        let hash = |path: &String| files::hash(folder, path);
        let manifest = Self {
            files: entries.files.iter().map(hash).collect::<Result<_, _>>()?,
            empty_folders: entries.empty.into_iter().collect(),
            ..Self::of(facts)
        };
        let mut text = serde_json::to_string_pretty(&manifest).map_err(|error| {
            ManifestError::Content { path: path.clone(), reason: error.to_string() }
        })?;
        text.push('\n');
        // The escapes are those of JSON: the same text is read.
        system("write", &path, std::fs::write(&path, &*printable(&text)))?;
        if let Some(key) = &facts.key {
            key.sign(&path)?;
        }
        Ok(manifest)
    }

    /// Reads the manifest of a run.
    ///
    /// # Errors
    /// If there is none of this version.
    pub fn read(folder: &Path) -> Result<Self, ManifestError> {
        let path = folder.join(FILE_NAME);
        let text = system("read", &path, files::read(&path))?;
        let content = |reason: String| ManifestError::Content { path: path.clone(), reason };
        // The version is checked first: a later layout must not fail on a field.
        #[derive(Deserialize)]
        struct Version {
            schema: u32,
        }
        let version: Version =
            serde_json::from_slice(&text).map_err(|error| content(error.to_string()))?;
        if version.schema != SCHEMA {
            return Err(content(format!(
                "manifest of schema {}, this octant reads {SCHEMA}",
                version.schema
            )));
        }
        serde_json::from_slice(&text).map_err(|error| content(error.to_string()))
    }

    /// Compares a folder with this manifest; no difference means that every file is unchanged.
    ///
    /// # Errors
    /// If a file can't be read.
    pub fn verify(&self, folder: &Path) -> Result<Vec<FolderDifference>, ManifestError> {
        let mut found = Entries::of(folder)?;
        let mut differences = Vec::new();
        for file in &self.files {
            if let Some(what) = found.others.remove(&file.path) {
                differences.push(FolderDifference::NoFile(file.path.clone(), what));
            } else if !found.files.remove(&file.path) {
                differences.push(FolderDifference::Missing(file.path.clone()));
            } else if files::hash(folder, &file.path)? != *file {
                differences.push(FolderDifference::Changed(file.path.clone()));
            }
        }
        for empty in &self.empty_folders {
            if !found.empty.remove(empty) {
                differences.push(FolderDifference::Missing(empty.clone()));
            }
        }
        differences.extend(found.files.into_iter().map(FolderDifference::Unknown));
        // A folder that should have files is empty because they are missing, which is reported
        // already.
        let had = |empty: &String| {
            let start = format!("{empty}/");
            self.files.iter().any(|file| file.path.starts_with(&start))
        };
        let added = found.empty.into_iter().filter(|empty| !had(empty));
        differences.extend(added.map(FolderDifference::EmptyFolder));
        let others = found.others.into_iter();
        differences.extend(others.map(|(path, what)| FolderDifference::NoFile(path, what)));
        if found.locked {
            differences.push(FolderDifference::Locked);
        }
        // A journal that can't be read was changed, which is reported already.
        if journal::read(folder).is_ok_and(|records| records != self.answers) {
            differences.push(FolderDifference::Answers);
        }
        Ok(differences)
    }

    /// Returns the bytes of a file of the folder, if they are those that the manifest names.
    ///
    /// # Errors
    /// If the file can't be read, the manifest doesn't name it, or its content differs.
    pub fn read_file(&self, folder: &Path, name: &str) -> Result<Vec<u8>, ManifestError> {
        let path = folder.join(name);
        let bytes = system("read", &path, files::read(&path))?;
        let hash = blake3::hash(&bytes).to_hex();
        self.holds(folder, name, hash.as_str())?;
        Ok(bytes)
    }

    /// Checks that a file of the folder is the one that the manifest names, without keeping its
    /// bytes.
    ///
    /// # Errors
    /// As [`Manifest::read_file`].
    pub fn check_file(&self, folder: &Path, name: &str) -> Result<(), ManifestError> {
        let found = files::hash(folder, name)?;
        self.holds(folder, name, &found.blake3)
    }

    fn holds(&self, folder: &Path, name: &str, blake3: &str) -> Result<(), ManifestError> {
        let wrong = |reason: String| ManifestError::Content { path: folder.join(name), reason };
        match self.files.iter().find(|file| file.path == name) {
            Some(file) if file.blake3 == blake3 => Ok(()),
            Some(file) => Err(wrong(format!(
                "it isn't what {FILE_NAME} names: BLAKE3 {blake3} found, {} expected",
                file.blake3
            ))),
            None => Err(wrong(format!("{FILE_NAME} doesn't name it"))),
        }
    }
}

/// Computes the SHA-256 of the manifest of a folder, hexadecimal.
///
/// # Errors
/// If it can't be read.
pub fn sha256_of(folder: &Path) -> Result<String, ManifestError> {
    Ok(files::hash(folder, FILE_NAME)?.sha256)
}

/// Renders a command line, with quotes where a POSIX shell needs them.
pub fn shell_line(words: &[String]) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=+,@%".contains(c);
    let quoted: Vec<String> = words
        .iter()
        .map(|word| {
            if !word.is_empty() && word.chars().all(plain) {
                word.clone()
            } else {
                format!("'{}'", word.replace('\'', r"'\''"))
            }
        })
        .collect();
    quoted.join(" ")
}

/// Renders a path as a word of a command line, with quotes where a POSIX shell needs them.
#[must_use]
pub fn shell_path(path: &Path) -> String {
    shell_line(&[path.display().to_string()])
}

/// A difference between a folder and its manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FolderDifference {
    /// The manifest names a file that isn't there.
    Missing(String),
    /// A file isn't named in the manifest.
    Unknown(String),
    /// A file has another content.
    Changed(String),
    /// An empty folder isn't named in the manifest.
    EmptyFolder(String),
    /// An entry is neither a file nor a folder; the kind stands beside the path.
    NoFile(String, &'static str),
    /// The lock of a run in progress is there.
    Locked,
    /// Manifest and journal differ in the answers of a person.
    Answers,
}

impl std::fmt::Display for FolderDifference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing(path) => write!(f, "{path} is missing"),
            Self::Unknown(path) => write!(f, "{path} was added: the manifest doesn't name it"),
            Self::Changed(path) => write!(f, "{path} was changed"),
            Self::EmptyFolder(path) => {
                write!(f, "{path}/ was added: an empty folder that the manifest doesn't name")
            }
            Self::NoFile(path, what) => {
                write!(f, "{path} is {what}: evidence is regular files and folders")
            }
            Self::Locked => {
                write!(f, "{LOCK} is there: the run goes on, or a kill left it")
            }
            Self::Answers => {
                write!(
                    f,
                    "the manifest's answers of the operator aren't those of {}",
                    journal::FILE_NAME
                )
            }
        }
    }
}
