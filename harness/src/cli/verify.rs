//! `octant verify`: whether a folder of evidence is what was written, and, apart from that, what it says.

use super::reexecute::{Count, Reexecuted};
use super::{Failure, print, print_json};
use crate::campaign;
use crate::evidence::attestation;
use crate::evidence::disposition;
use crate::evidence::files;
use crate::evidence::inside::{self, Inside};
use crate::evidence::manifest::{self, Difference, Manifest};
use crate::evidence::signature::{self, Key};
use clap::Args;
use octant_requirements::Verdict;
use serde::Serialize;
use sha2::Digest;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run or of a campaign.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// The public key that has to have signed it: a file of minisign, or the key itself. Without it, only
    /// the files are held against the manifest.
    #[arg(long, value_name = "KEY")]
    key: Option<String>,
    /// The public key of a second person, who has to have signed the dispositions of a campaign: not the first.
    #[arg(long, value_name = "KEY", requires = "key")]
    second_key: Option<String>,
    /// What the folder has to be of: scenario=TITLE, seed=N, run=HASH (the stream hash of a run or the plan
    /// of a campaign, 12 digits or more).
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', value_parser = Expected::parse)]
    expect: Vec<Expected>,
    /// Run it again from the folder alone, and compare the stream hash and every measure: a run, or so many
    /// cases of a campaign, or all of them.
    #[arg(long, value_name = "N|all", num_args = 0..=1, default_missing_value = "all",
          value_parser = Count::parse)]
    reexecute: Option<Count>,
    /// Seed by which the cases are drawn that are run again; by default one that nobody knows before.
    #[arg(long, value_name = "N", requires = "reexecute")]
    sample_seed: Option<u64>,
    /// Write an in-toto attestation (test-result) of a folder that is whole.
    #[arg(long, value_name = "FILE")]
    attest: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Least digits of a hash that is expected.
const DIGITS_MIN: usize = 12;

/// Something that the folder has to be of.
#[derive(Clone, Debug)]
enum Expected {
    Scenario(String),
    Seed(u64),
    Run(String),
}

impl Expected {
    fn parse(text: &str) -> Result<Self, String> {
        let expected = "expected scenario=TITLE, seed=N or run=HASH";
        let (name, value) = text.split_once('=').ok_or(expected)?;
        match name.trim() {
            "scenario" => Ok(Self::Scenario(value.to_owned())),
            "seed" => {
                let seed = value.trim().parse();
                Ok(Self::Seed(
                    seed.map_err(|_| format!("found seed {value:?}, expected a number"))?,
                ))
            }
            "run" => {
                let hash = value.trim().to_ascii_lowercase();
                let is_hash = hash.chars().all(|c| c.is_ascii_hexdigit());
                if !is_hash || hash.len() < DIGITS_MIN {
                    return Err(format!(
                        "found run {value:?}, expected {DIGITS_MIN} hexadecimal digits or more"
                    ));
                }
                Ok(Self::Run(hash))
            }
            _ => Err(format!("found {name:?}, {expected}")),
        }
    }

    /// Why a folder isn't it.
    fn missed(&self, inside: &Inside) -> Option<String> {
        let none = || "none".to_owned();
        let (what, found, expected, met) = match self {
            Self::Scenario(title) => {
                let found = inside.title.clone();
                let met = found.as_ref() == Some(title);
                (
                    "scenario",
                    found.map_or_else(none, |t| format!("{t:?}")),
                    format!("{title:?}"),
                    met,
                )
            }
            Self::Seed(seed) => {
                let found = inside.seed.map_or_else(none, |seed| seed.to_string());
                ("seed", found, seed.to_string(), inside.seed == Some(*seed))
            }
            Self::Run(hash) => {
                let met = inside.run.as_ref().is_some_and(|found| found.starts_with(hash));
                ("run", inside.run.clone().unwrap_or_else(none), hash.clone(), met)
            }
        };
        (!met).then(|| format!("it is of another {what}: found {found}, expected {expected}"))
    }
}

/// What was found.
#[derive(Serialize)]
struct Found {
    folder: String,
    /// Whether the folder is what was written, agrees with itself and is the one that was expected.
    whole: bool,
    files: usize,
    /// Every difference, in words.
    differences: Vec<String>,
    /// What the run or the campaign in it came to; null: it can't be told.
    verdict: Option<Verdict>,
    /// Why, as the run or the campaign tells it.
    reasons: Vec<String>,
    /// Where it has another numerics version than this program, what that means.
    numerics: Option<String>,
    scenario: Option<String>,
    seed: Option<u64>,
    run: Option<String>,
    /// What came of running it again; null: it wasn't.
    reexecuted: Option<Reexecuted>,
    /// Who signed the manifest; null: nobody whose key was given.
    signed_by: Option<String>,
    /// Who signed the dispositions as second person; null: nobody whose key was given.
    second_signed_by: Option<String>,
    /// A second signature is there that nobody asked for.
    #[serde(skip)]
    second_ignored: bool,
    /// The key that the manifest names; null: it isn't signed.
    signature: Option<String>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let folder = &arguments.folder;
    let mut differences = Vec::new();
    let path = folder.join(manifest::FILE_NAME);
    let mut signed_by = None;
    // The signature first: a manifest that was changed says nothing.
    if let Some(key) = &arguments.key {
        match signature::verify(&path, key) {
            Ok(id) => signed_by = Some(format!("minisign key {id}")),
            Err(error @ signature::SignatureError::Key { .. }) => {
                return Err(Failure::input(error).failed());
            }
            Err(error) => differences.push(format!("failed to {error}")),
        }
    }
    let manifest = Manifest::read(folder).map_err(|error| Failure::input(error).failed())?;
    if is_partial(folder) {
        differences.push("it is a .partial: the run in it didn't end as a run does".to_owned());
    }
    let found = manifest.verify(folder).map_err(|error| Failure::bench(error).failed())?;
    differences.extend(found.iter().map(Difference::to_string));
    let there = std::fs::symlink_metadata(folder.join(signature::FILE_NAME)).is_ok();
    if manifest.signature.is_none() && there && signed_by.is_none() {
        differences.push(format!("{} was added: the manifest names no key", signature::FILE_NAME));
    }
    if manifest.signature.is_some() && !there {
        differences.push(format!("{} is missing", signature::FILE_NAME));
    }
    if signed_by.is_some() && signed_by != manifest.signature {
        let named = manifest.signature.as_deref().unwrap_or("none");
        differences.push(format!("the manifest names another key: {named}"));
    }
    let second = second(arguments, &manifest, &mut differences)?;
    // A folder with a FIFO in it is told, and its contents are left alone.
    let opened = !found.iter().any(|difference| matches!(difference, Difference::NoFile(..)));
    let inside = match &manifest.campaign {
        _ if !opened => Inside::default(),
        Some(facts) => campaign::inside::look(folder, facts),
        None => inside::of_run(folder, &manifest),
    };
    differences.extend(inside.contradictions.iter().cloned());
    differences.extend(arguments.expect.iter().filter_map(|expected| expected.missed(&inside)));
    let whole = differences.is_empty();
    // What isn't whole is no input of a run, and attests nothing.
    let reexecuted = match arguments.reexecute.filter(|_| whole) {
        Some(count) => {
            Some(super::reexecute::command(folder, &manifest, count, arguments.sample_seed)?)
        }
        None => None,
    };
    let again = reexecuted.as_ref().map_or(Verdict::Pass, |found| found.verdict);
    if let Some(out) = arguments.attest.as_ref().filter(|_| whole && again == Verdict::Pass) {
        let bytes = files::read(&path).map_err(|error| {
            Failure::bench(format!("failed to read {}: {error}", path.display()))
        })?;
        let sha256: String =
            sha2::Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect();
        let statement = attestation::statement(&manifest, &sha256, &inside);
        super::write(out, format!("{statement:#}\n"))?;
    }
    let found = Found {
        folder: folder.display().to_string(),
        whole,
        files: manifest.files.len(),
        differences,
        verdict: inside.verdict,
        reasons: inside.reasons,
        numerics: inside.numerics,
        scenario: inside.title,
        seed: inside.seed,
        run: inside.run,
        reexecuted,
        signed_by,
        second_signed_by: second.signed_by,
        second_ignored: second.ignored,
        signature: manifest.signature,
    };
    if arguments.json {
        print_json(&found)?
    } else {
        print(&text(&found))?
    }
    // The status tells integrity alone: 0 of a whole folder, whatever the run in it came to.
    Ok(if whole { again } else { Verdict::Fail })
}

/// The second person's signature.
struct Second {
    /// It is there, and nobody asked for it.
    ignored: bool,
    signed_by: Option<String>,
}

/// Looks at the second signature: where one is asked for, and where it belongs to nothing.
fn second(
    arguments: &Arguments,
    manifest: &Manifest,
    differences: &mut Vec<String>,
) -> Result<Second, Failure> {
    let folder = &arguments.folder;
    let there = std::fs::symlink_metadata(folder.join(signature::SECOND)).is_ok();
    // One that is looked at is told by what came of it.
    let ignored = there && arguments.second_key.is_none();
    let mut found = Second { ignored, signed_by: None };
    let is_named = manifest.files.iter().any(|file| file.path == disposition::FILE_NAME);
    let facts = manifest.campaign.as_ref().filter(|_| is_named);
    let Some(facts) = facts else {
        if there {
            differences.push(format!(
                "{} was added: the manifest names no {}",
                signature::SECOND,
                disposition::FILE_NAME
            ));
        }
        if arguments.second_key.is_some() && manifest.campaign.is_none() {
            differences.push(
                "a second person signs the dispositions of a campaign: this is a run, which has none in its folder"
                    .to_owned(),
            );
        }
        return Ok(found);
    };
    let (Some(first), Some(second)) = (&arguments.key, &arguments.second_key) else {
        return Ok(found);
    };
    let path = folder.join(disposition::FILE_NAME);
    let of = (facts.plan.as_str(), facts.results_blake3.as_str());
    match signature::verify_dispositions(&path, of, first, second) {
        Ok(id) => found.signed_by = Some(format!("minisign key {id}")),
        Err(error @ signature::SignatureError::Key { .. }) => {
            return Err(Failure::input(error).failed());
        }
        Err(error) => differences.push(format!("failed to {error}")),
    }
    if facts.open_discrepancies > 0 {
        differences.push(format!(
            "{} of {} discrepancies have no disposition that two persons could sign",
            facts.open_discrepancies, facts.discrepancies
        ));
    }
    Ok(found)
}

/// Whether a folder has the name of one that isn't finished, by whatever path it is named.
fn is_partial(folder: &Path) -> bool {
    let named = |path: &Path| {
        path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(".partial"))
    };
    named(folder) || std::fs::canonicalize(folder).is_ok_and(|path| named(&path))
}

fn text(found: &Found) -> String {
    let signed = match (&found.signed_by, &found.signature) {
        (Some(key), _) => format!("signed by {key}"),
        (None, Some(key)) => {
            format!("the signature was not looked at: --key has the public part of {key}")
        }
        (None, None) => {
            "unsigned: who can write here could have changed the manifest too".to_owned()
        }
    };
    let mut text = format!("{}: {} files, {signed}\n", found.folder, found.files);
    if found.whole {
        text +=
            "integrity: whole: every file is as it was written, and they agree with each other\n";
    } else {
        text += "integrity: not whole\n";
    }
    found.differences.iter().for_each(|difference| text += &format!("  {difference}\n"));
    match (&found.second_signed_by, found.second_ignored) {
        (Some(key), _) => text += &format!("dispositions: signed by a second person, {key}\n"),
        (None, true) => {
            text += "dispositions: a second signature was not looked at: --second-key has its public part\n"
        }
        (None, false) => {}
    }
    if let Some(told) = &found.numerics {
        text += &format!("{told} (octant rejudge derives the verdict anew)\n");
    }
    if let Some(again) = &found.reexecuted {
        text += &again.text();
    }
    match found.verdict {
        // Of a folder that isn't whole nothing is believed.
        _ if !found.whole => text += "verdict: none to be relied on\n",
        Some(verdict) => {
            text += &format!("verdict: {}\n", verdict.name());
            found.reasons.iter().for_each(|reason| text += &format!("  {reason}\n"));
        }
        None => text += "verdict: none\n",
    }
    text
}

/// The key that the environment names, read before anything is run.
pub(super) fn signing_key() -> Result<Option<Arc<Key>>, Failure> {
    let key = Key::of_environment().map_err(|error| Failure::input(error).failed())?;
    Ok(key.map(Arc::new))
}
