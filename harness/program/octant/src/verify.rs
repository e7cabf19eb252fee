//! `octant verify`: checks that a folder of evidence is unchanged, and separately reports its
//! content.

use super::reexecute::{Count, Reexecuted};
use crate::failure::Failure;
use crate::place::{CampaignPlace, Needs};
use crate::terminal::{print, print_json};
use clap::Args;
use octant_base::number::counted;
use octant_campaign as campaign;
use octant_evidence::attestation;
use octant_evidence::disposition;
use octant_evidence::ended::is_partial;
use octant_evidence::files;
use octant_evidence::manifest::{self, FolderDifference, Manifest};
use octant_evidence::signature;
use octant_evidence::statements::{self, FolderStatements};
use octant_verdict::Verdict;
use serde::Serialize;
use sha2::Digest;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// Folder of a run or of a campaign; or the address of a campaign on object storage, s3://BUCKET/PREFIX.
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Public key that must have signed the manifest: a minisign file, or the key itself. Without it,
    /// only the files are compared with the manifest.
    #[arg(long, value_name = "KEY")]
    key: Option<String>,
    /// Public key of the second person, who must have signed the dispositions of a campaign; another than
    /// --key.
    #[arg(long, value_name = "KEY", requires = "key")]
    second_key: Option<String>,
    /// Expected content of the folder: scenario=TITLE, seed=N, run=HASH (the stream hash of a run or the
    /// plan of a campaign, 12 digits or more).
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', value_parser = Expected::parse)]
    expect: Vec<Expected>,
    /// Run the content again from the folder alone, and compare the stream hash and every measure: a run,
    /// or N cases of a campaign, or all of them.
    #[arg(long, value_name = "N|all", num_args = 0..=1, default_missing_value = "all",
          value_parser = Count::parse)]
    reexecute: Option<Count>,
    /// Seed of the draw of cases to run again; by default an unpredictable one.
    #[arg(long, value_name = "N", requires = "reexecute")]
    sample_seed: Option<u64>,
    /// Write an in-toto attestation (test-result) of a whole folder.
    #[arg(long, value_name = "FILE")]
    attest: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// Minimum number of digits of an expected hash.
const DIGITS_MIN: usize = 12;

/// Expected property of the folder.
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

    /// Describes why a folder doesn't have it.
    fn missed(&self, stated: &FolderStatements) -> Option<String> {
        let none = || "none".to_owned();
        let (what, found, expected, met) = match self {
            Self::Scenario(title) => {
                let found = stated.title.clone();
                let met = found.as_ref() == Some(title);
                (
                    "scenario",
                    found.map_or_else(none, |t| format!("{t:?}")),
                    format!("{title:?}"),
                    met,
                )
            }
            Self::Seed(seed) => {
                let found = stated.seed.map_or_else(none, |seed| seed.to_string());
                ("seed", found, seed.to_string(), stated.seed == Some(*seed))
            }
            Self::Run(hash) => {
                let met = stated.run.as_ref().is_some_and(|found| found.starts_with(hash));
                ("run", stated.run.clone().unwrap_or_else(none), hash.clone(), met)
            }
        };
        (!met).then(|| format!("another {what}: found {found}, expected {expected}"))
    }
}

/// Result of the check.
#[derive(Serialize)]
struct Found {
    folder: String,
    /// True if the folder is unchanged, consistent and the expected one.
    whole: bool,
    files: usize,
    /// Differences, as text.
    differences: Vec<String>,
    /// Verdict of the run or the campaign; null if it can't be determined.
    verdict: Option<Verdict>,
    /// Reasons, as stated by the run or the campaign.
    reasons: Vec<String>,
    /// Meaning of a numerics version that differs from this program's.
    numerics: Option<String>,
    scenario: Option<String>,
    seed: Option<u64>,
    run: Option<String>,
    /// Result of the re-execution; null if there was none.
    reexecuted: Option<Reexecuted>,
    /// Signer of the manifest; null if no given key signed it.
    signed_by: Option<String>,
    /// Second signer of the dispositions; null if no given key signed them.
    second_signed_by: Option<String>,
    /// True if a second signature is there for which no key was given.
    #[serde(skip)]
    second_ignored: bool,
    /// Key that the manifest names; null if it isn't signed.
    signature: Option<String>,
}

pub(super) fn command(arguments: &Arguments) -> Result<Verdict, Failure> {
    let Arguments {
        folder: given,
        key,
        second_key,
        expect,
        reexecute: count,
        sample_seed,
        attest,
        json,
    } = arguments;
    let place = CampaignPlace::of(given, Needs::All)?;
    let folder = crate::run_folder::folder_of(place.folder());
    let mut differences = Vec::new();
    let path = folder.join(manifest::FILE_NAME);
    let mut signed_by = None;
    // The signature comes first: a changed manifest is no reference.
    if let Some(key) = key {
        match signature::verify(&path, key) {
            Ok(id) => signed_by = Some(format!("minisign key {id}")),
            Err(error @ signature::SignatureError::Key { .. }) => {
                return Err(Failure::input(error).failed());
            }
            Err(error) => differences.push(format!("failed to {error}")),
        }
    }
    let manifest = Manifest::read(folder).map_err(|error| Failure::input(error).failed())?;
    // Refused although the folder may not be whole: the same command line has the same status for every run.
    if let (Some(count), None) = (count, &manifest.campaign) {
        count.refuse_for_run(given, *sample_seed)?;
    }
    if is_partial(folder) {
        differences.push("the folder is a .partial: its run didn't finish".to_owned());
    }
    let found = manifest.verify(folder).map_err(|error| Failure::bench(error).failed())?;
    differences.extend(found.iter().map(FolderDifference::to_string));
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
    let second = second((key, second_key), folder, &manifest, &mut differences)?;
    // A folder with a FIFO in it is reported, and its contents are not opened.
    let opened = !found.iter().any(|difference| matches!(difference, FolderDifference::NoFile(..)));
    let stated = match &manifest.campaign {
        _ if !opened => FolderStatements::default(),
        Some(facts) => campaign::judge::consistency::look(folder, facts),
        None => statements::of_run(folder, &manifest),
    };
    differences.extend(stated.contradictions.iter().cloned());
    differences.extend(expect.iter().filter_map(|expected| expected.missed(&stated)));
    let whole = differences.is_empty();
    // A folder that isn't whole is neither run again nor attested.
    let reexecuted = match count.filter(|_| whole) {
        Some(count) => Some(super::reexecute::command(folder, &manifest, count, *sample_seed)?),
        None => None,
    };
    let again = reexecuted.as_ref().map_or(Verdict::Pass, |found| found.verdict);
    if let Some(out) = attest.as_ref().filter(|_| whole && again == Verdict::Pass) {
        let bytes = files::read(&path).map_err(|error| {
            Failure::bench(format!("failed to read {}: {error}", path.display()))
        })?;
        let sha256: String =
            sha2::Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect();
        let statement = attestation::statement(&manifest, &sha256, &stated);
        crate::terminal::write(out, format!("{statement:#}\n"))?;
    }
    let found = Found {
        folder: place.shown(folder),
        whole,
        files: manifest.files.len(),
        differences,
        verdict: stated.verdict,
        reasons: stated.reasons,
        numerics: stated.numerics,
        scenario: stated.title,
        seed: stated.seed,
        run: stated.run,
        reexecuted,
        signed_by,
        second_signed_by: second.signed_by,
        second_ignored: second.ignored,
        signature: manifest.signature,
    };
    if *json {
        print_json(&found)?
    } else {
        print(&text(&found))?
    }
    // The status reports integrity alone: 0 for a whole folder, whatever the verdict in it.
    Ok(if whole { again } else { Verdict::Fail })
}

/// Signature of the second person.
struct Second {
    /// True if it is there and no key was given for it.
    ignored: bool,
    signed_by: Option<String>,
}

/// Checks the second signature if a key is given, or if it belongs to nothing.
fn second(
    (first_key, second_key): (&Option<String>, &Option<String>),
    folder: &Path,
    manifest: &Manifest,
    differences: &mut Vec<String>,
) -> Result<Second, Failure> {
    let there = std::fs::symlink_metadata(folder.join(signature::SECOND)).is_ok();
    // A signature with a given key is reported by the result of its check.
    let ignored = there && second_key.is_none();
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
        if second_key.is_some() && manifest.campaign.is_none() {
            differences.push(
                "--second-key: found the folder of a run, expected a campaign, whose dispositions are signed"
                    .to_owned(),
            );
        }
        return Ok(found);
    };
    let (Some(first), Some(second)) = (first_key, second_key) else {
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
            "{} of {} without a disposition, expected one for each, signed by two persons",
            facts.open_discrepancies,
            counted(facts.discrepancies, "discrepancy", "discrepancies")
        ));
    }
    Ok(found)
}

fn text(found: &Found) -> String {
    let signed = match (&found.signed_by, &found.signature) {
        (Some(key), _) => format!("signed by {key}"),
        (None, Some(key)) => {
            format!("signature not checked: expected the public part of {key} with --key")
        }
        (None, None) => {
            "unsigned: anyone who can write here could have changed the manifest too".to_owned()
        }
    };
    let mut text =
        format!("{}: {}, {signed}\n", found.folder, counted(found.files, "file", "files"));
    if found.whole {
        text += "integrity: whole: every file is as it was written, and the files agree with each other\n";
    } else {
        text += "integrity: not whole\n";
    }
    found.differences.iter().for_each(|difference| text += &format!("  {difference}\n"));
    match (&found.second_signed_by, found.second_ignored) {
        (Some(key), _) => text += &format!("dispositions: signed by a second person, {key}\n"),
        (None, true) => {
            text += "dispositions: second signature not checked: expected its public part with --second-key\n"
        }
        (None, false) => {}
    }
    if let Some(told) = &found.numerics {
        text += &format!("{told} (octant rejudge derives the verdict again)\n");
    }
    if let Some(again) = &found.reexecuted {
        text += &again.text();
    }
    match found.verdict {
        // The content of a folder that isn't whole is not reliable.
        _ if !found.whole => text += "verdict: none, because the folder is not whole\n",
        Some(verdict) => {
            text += &format!("verdict: {}\n", verdict.name());
            found.reasons.iter().for_each(|reason| text += &format!("  {reason}\n"));
        }
        None => text += "verdict: none\n",
    }
    text
}
