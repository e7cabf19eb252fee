//! `octant verify`: whether a folder of evidence is what was written.

use super::{Failure, print, print_json};
use crate::evidence::manifest::{self, Difference, Manifest};
use crate::evidence::signature::{self, Key};
use crate::score::verdict::Verdict;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
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
    /// Print one JSON object.
    #[arg(long)]
    json: bool,
}

/// What was found.
#[derive(Serialize)]
struct Found {
    folder: String,
    verdict: Verdict,
    files: usize,
    /// Every difference, in words.
    differences: Vec<String>,
    /// Who signed the manifest; null: nobody whose key was given.
    signed_by: Option<String>,
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
    let found = manifest.verify(folder).map_err(|error| Failure::bench(error).failed())?;
    differences.extend(found.iter().map(|difference| match difference {
        Difference::Missing(path) => format!("{path} is missing"),
        Difference::Unknown(path) => format!("{path} was added: the manifest doesn't name it"),
        Difference::Changed(path) => format!("{path} was changed"),
    }));
    let there = folder.join(signature::FILE_NAME).exists();
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
    let verdict = if differences.is_empty() { Verdict::Pass } else { Verdict::Fail };
    let found = Found {
        folder: folder.display().to_string(),
        verdict,
        files: manifest.files.len(),
        differences,
        signed_by,
        signature: manifest.signature,
    };
    if arguments.json {
        print_json(&found)?
    } else {
        print(&text(&found))?
    }
    Ok(verdict)
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
    if found.differences.is_empty() {
        text += "every file is as it was written\n";
    }
    found.differences.iter().for_each(|difference| text += &format!("  {difference}\n"));
    text
}

/// The key that the environment names, read before anything is run.
pub(super) fn signing_key() -> Result<Option<Arc<Key>>, Failure> {
    let key = Key::of_environment().map_err(|error| Failure::input(error).failed())?;
    Ok(key.map(Arc::new))
}
