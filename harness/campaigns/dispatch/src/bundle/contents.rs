//! The list of a bundle, `bundle.json`: version, plan, program, and every file with its BLAKE3.

use super::error::{BundleError, EntryNameError};
use octant_campaign::plan::{FILE_NAME as PLAN, Plan, PlannedFile, short};
use octant_evidence::manifest::program_sha256;
use octant_score::numerics::{NUMERICS, differs};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

/// Version of bundles.
pub const SCHEMA: u32 = 1;
/// Name of the list, in a bundle and in the folder that is made from it.
pub const FILE_NAME: &str = "bundle.json";
/// Folder of the files, in both.
pub const FILES: &str = "files";

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
        let form = |error: serde_json::Error| {
            wrong(FILE_NAME, format!("is not the list of a bundle: {error}"))
        };
        // The version is checked first: nothing else is reliable in a newer list.
        let Version { schema } = serde_json::from_slice(bytes).map_err(form)?;
        if schema != SCHEMA {
            return Err(wrong(
                FILE_NAME,
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
                FILE_NAME,
                format!(
                    "was changed after it was made: its contents give {}, expected {} and nothing else",
                    short(&hash),
                    short(&contents.blake3)
                ),
            ));
        }
        for file in &contents.files {
            check_path(&file.path).map_err(|error| wrong(&file.path, error.to_string()))?;
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
        let path = folder.join(FILE_NAME);
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

/// Checks the name of an entry: one of the two lists, or a file in the folder of its hash.
pub(super) fn check_path(path: &str) -> Result<(), EntryNameError> {
    if path == PLAN || path == FILE_NAME {
        return Ok(());
    }
    if path.starts_with(['/', '\\']) || path.get(1..2) == Some(":") {
        return Err(EntryNameError::Absolute);
    }
    if path.split(['/', '\\']).any(|part| part == "..") {
        return Err(EntryNameError::Outside);
    }
    let parts: Vec<&str> = path.split('/').collect();
    let is_hash = |text: &str| {
        text.len() == 64 && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
    };
    match parts[..] {
        [FILES, hash, name] if is_hash(hash) && name == plain(name) => Ok(()),
        _ => Err(EntryNameError::Unknown),
    }
}

/// Returns a name that every system takes as the name of a file in a folder.
pub(super) fn plain(name: &str) -> String {
    let forbidden = |c: char| {
        c.is_control() || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
    };
    let name: String = name.chars().map(|c| if forbidden(c) { '_' } else { c }).collect();
    let mut parts = Path::new(&name).components();
    match (parts.next(), parts.next()) {
        (Some(Component::Normal(_)), None) => name,
        _ => "file".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_stay_in_their_folder() {
        let hash = "0".repeat(64);
        for good in ["plan.json".to_owned(), format!("files/{hash}/a b.fmu")] {
            assert_eq!(check_path(&good), Ok(()));
        }
        for (bad, reason) in [
            ("/etc/passwd".to_owned(), EntryNameError::Absolute),
            ("\\\\host\\share".to_owned(), EntryNameError::Absolute),
            ("C:\\windows".to_owned(), EntryNameError::Absolute),
            (format!("files/{hash}/../../a"), EntryNameError::Outside),
            ("..\\a".to_owned(), EntryNameError::Outside),
            (format!("files/{hash}/a/b"), EntryNameError::Unknown),
            (format!("files/{hash}/"), EntryNameError::Unknown),
            (format!("files/{hash}/a:b"), EntryNameError::Unknown),
            (format!("files/{}/a", "0".repeat(63)), EntryNameError::Unknown),
            (format!("files/{}/a", "G".repeat(64)), EntryNameError::Unknown),
            ("results/a.octres".to_owned(), EntryNameError::Unknown),
        ] {
            assert_eq!(check_path(&bad), Err(reason), "{bad}");
        }
    }

    #[test]
    fn names_of_files_are_made_plain() {
        for (name, expected) in [
            ("ship 1.fmu", "ship 1.fmu"),
            ("a:b\n", "a_b_"),
            ("..", "file"),
            (".", "file"),
            ("", "file"),
        ] {
            assert_eq!(plain(name), expected);
            assert_eq!(check_path(&format!("files/{}/{}", "a".repeat(64), plain(name))), Ok(()));
        }
    }

    #[test]
    fn a_list_that_was_changed_is_refused() {
        let contents = BundleContents::new("p", vec!["exec:./core".to_owned()], Vec::new());
        let path = Path::new("b.zip");
        let json = contents.to_json();
        assert_eq!(BundleContents::from_json(path, json.as_bytes()).unwrap(), contents);
        let edited = json.replace("exec:./core", "exec:./cord");
        let error = BundleContents::from_json(path, edited.as_bytes()).unwrap_err().to_string();
        assert!(error.contains("b.zip") && error.contains("was changed"), "{error}");
    }

    #[test]
    fn another_program_is_told_with_its_numerics() {
        let own = BundleContents::new("p", Vec::new(), Vec::new());
        assert_eq!(own.by_another(), None);
        let other = BundleContents { program_sha256: Some("f".repeat(64)), ..own.clone() };
        let told = other.by_another().unwrap();
        assert!(told.contains("ffffffffffff") && !told.contains("numerics"), "{told}");
        let numerics = BundleContents { numerics: NUMERICS + 1, ..other };
        assert!(numerics.by_another().unwrap().contains("numerics version"));
    }
}
