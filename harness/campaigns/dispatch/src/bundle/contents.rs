//! The list of a bundle, `bundle.json`: version, plan, program, and every file with its BLAKE3.

use super::entry_name::{self, LIST};
use super::error::BundleError;
use octant_campaign::plan::{FILE_NAME as PLAN, Plan, PlannedFile, short};
use octant_evidence::manifest::program_sha256;
use octant_score::numerics::{NUMERICS, differs};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Version of bundles.
pub const SCHEMA: u32 = 1;

/// The list of a bundle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BundleContents {
    /// Version of this form: [`SCHEMA`].
    pub schema: u32,
    /// BLAKE3 of this list as JSON, in the form in which it is stored, with an empty text here.
    pub blake3: String,
    /// Id of the plan.
    pub plan: String,
    /// Version of the program that made the bundle.
    pub octant: String,
    /// Numerics version of that program.
    pub numerics: u32,
    /// SHA-256 of that program, hexadecimal; null if it can't be read.
    pub program_sha256: Option<String>,
    /// Devices and programs outside that cases talk to, which no bundle holds.
    pub outside: Vec<String>,
    /// Every other entry, in the order of the paths.
    pub files: Vec<BundledFile>,
}

/// File of a bundle.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BundledFile {
    /// Path, with forward slashes: `plan.json`, or `files/BLAKE3/NAME`.
    pub path: String,
    /// Length.
    pub bytes: u64,
    /// BLAKE3, hexadecimal.
    pub blake3: String,
}

#[derive(Deserialize)]
struct Version {
    schema: u32,
}

impl BundleContents {
    /// Makes the list of a bundle that this program makes.
    #[must_use]
    pub fn new(plan: &str, outside: Vec<String>, files: Vec<BundledFile>) -> Self {
        let mut contents = Self {
            schema: SCHEMA,
            blake3: String::new(),
            plan: plan.to_owned(),
            octant: env!("CARGO_PKG_VERSION").to_owned(),
            numerics: NUMERICS,
            program_sha256: program_sha256(),
            outside,
            files,
        };
        contents.blake3 = contents.hash();
        contents
    }

    /// Returns the bytes of the list.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Values of these types can always be serialised.
        serde_json::to_string_pretty(self).unwrap_or_default() + "\n"
    }

    fn hash(&self) -> String {
        let unsigned = Self { blake3: String::new(), ..self.clone() };
        blake3::hash(unsigned.to_json().as_bytes()).to_hex().to_string()
    }

    /// Reads the list of a bundle; `path` names the bundle, or the folder made from it, in errors.
    ///
    /// # Errors
    /// If it isn't one of this version, was changed, or names a file outside of its folder.
    pub fn from_json(path: &Path, bytes: &[u8]) -> Result<Self, BundleError> {
        let wrong = |entry: &str, reason: String| BundleError::Entry {
            path: path.to_owned(),
            entry: entry.to_owned(),
            reason,
        };
        let form =
            |error: serde_json::Error| wrong(LIST, format!("is not the list of a bundle: {error}"));
        // The version is checked first: nothing else is reliable in a newer list.
        let Version { schema } = serde_json::from_slice(bytes).map_err(form)?;
        if schema != SCHEMA {
            return Err(wrong(
                LIST,
                format!(
                    "has version {schema}, this program reads version {SCHEMA}{}",
                    if schema > SCHEMA { ": a newer Octant wrote it" } else { "" }
                ),
            ));
        }
        let contents: Self = serde_json::from_slice(bytes).map_err(form)?;
        let hash = contents.hash();
        // Nor may anything be there that isn't read: the bytes are those of this form.
        if hash != contents.blake3 || contents.to_json().as_bytes() != bytes {
            return Err(wrong(
                LIST,
                format!(
                    "was changed after it was made: its contents give {}, expected {} and nothing else",
                    short(&hash),
                    short(&contents.blake3)
                ),
            ));
        }
        for file in &contents.files {
            entry_name::check(&file.path).map_err(|error| wrong(&file.path, error.to_string()))?;
            if file.path != PLAN && file.path.split('/').nth(1) != Some(&file.blake3) {
                let reason = format!(
                    "is listed with another hash than that of its name: found {}",
                    short(&file.blake3)
                );
                return Err(wrong(&file.path, reason));
            }
        }
        Ok(contents)
    }

    /// Reads the list in the folder of a campaign; `None` if the folder wasn't made from a bundle.
    ///
    /// # Errors
    /// If it can't be read, or as [`Self::from_json`].
    pub fn of_folder(folder: &Path) -> Result<Option<Self>, BundleError> {
        let path = folder.join(LIST);
        match std::fs::read(&path) {
            Ok(bytes) => Self::from_json(folder, &bytes).map(Some),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(BundleError::system("read", path)(error)),
        }
    }

    /// Checks that a plan is the one of the list, and that every file that it names is in the list, with its hash;
    /// `bundle` names the bundle, or the folder made from it, in errors. The files themselves aren't read.
    ///
    /// # Errors
    /// If the plan is another one, or names another file.
    pub fn check_plan(&self, bundle: &Path, plan: &Plan, folder: &Path) -> Result<(), BundleError> {
        let wrong = |reason: String| {
            Err(BundleError::Entry { path: bundle.to_owned(), entry: PLAN.to_owned(), reason })
        };
        if plan.id != self.plan {
            let (found, expected) = (short(&plan.id), short(&self.plan));
            return wrong(format!("has the id {found}, the list {expected}"));
        }
        let folder = std::path::absolute(folder).map_err(BundleError::system("find", folder))?;
        let known: BTreeMap<PathBuf, &str> =
            self.files.iter().map(|file| (folder.join(&file.path), &*file.blake3)).collect();
        let Some(campaign) = &plan.bundled else {
            return wrong("is not the plan of a bundle".to_owned());
        };
        let of_scenarios = plan.scenarios.iter().flat_map(|scenario| scenario.files.values());
        let placed = campaign.requirements.iter().chain([&campaign.campaign]).chain(of_scenarios);
        let placed = placed.map(|PlannedFile { file, blake3 }| (file, Some(&**blake3)));
        // The hashes of these are in the id of the plan.
        let scenarios = plan.scenarios.iter().map(|scenario| &scenario.file);
        let planned = scenarios.chain([&plan.campaign]).map(|file| (file, None));
        for (file, blake3) in placed.chain(planned) {
            match known.get(file) {
                None => {
                    return wrong(format!("names {}, which isn't in the bundle", file.display()));
                }
                Some(listed) if blake3.is_some_and(|blake3| blake3 != *listed) => {
                    let (file, expected) = (file.display(), short(listed));
                    return wrong(format!("names {file} with another hash, expected {expected}"));
                }
                Some(_) => {}
            }
        }
        Ok(())
    }

    /// Tells that another program made the bundle, and what that means; `None` if it was this one.
    #[must_use]
    pub fn by_another(&self) -> Option<String> {
        let now = program_sha256();
        if now.is_some() && now == self.program_sha256 {
            return None;
        }
        let name =
            |hash: Option<&str>| hash.map_or("unknown".to_owned(), |hash| short(hash).into());
        let mut told = format!(
            "the bundle was made by another program: found Octant {} with SHA-256 {}, this is {} with SHA-256 {}",
            self.octant,
            name(self.program_sha256.as_deref()),
            env!("CARGO_PKG_VERSION"),
            name(now.as_deref())
        );
        if let Some(numerics) = differs(Some(self.numerics)) {
            told += &format!("; the bundle was {numerics}");
        }
        Some(told)
    }
}
