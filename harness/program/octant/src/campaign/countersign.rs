//! `octant campaign countersign`: the second person's signature over the dispositions of a campaign.

use crate::failure::Failure;
use crate::signing::signing_key;
use crate::terminal::print;
use octant_base::number::counted;
use octant_evidence::Manifest;
use octant_evidence::disposition::{self, Dispositions};
use octant_evidence::signature;
use octant_verdict::Verdict;
use std::path::Path;

pub(super) fn command(folder: &Path) -> Result<Verdict, Failure> {
    let refused = |reason: String| {
        Failure::input(format!("failed to countersign {}: {reason}", folder.display()))
    };
    let Some(key) = signing_key()? else {
        return Err(refused(format!(
            "{} names no key, expected that of the second person",
            signature::KEY
        )));
    };
    let manifest = Manifest::read(folder).map_err(|error| Failure::input(error).failed())?;
    let Some(facts) = &manifest.campaign else {
        return Err(refused("found a run, expected a reported campaign".to_owned()));
    };
    // A countersignature applies only to the folder that the first person signed.
    let differences = manifest.verify(folder).map_err(|error| Failure::bench(error).failed())?;
    if !differences.is_empty() {
        let words: Vec<String> = differences.iter().map(ToString::to_string).collect();
        return Err(refused(format!("it isn't whole: {}", words.join("; "))));
    }
    let Some(first) = &manifest.signature else {
        return Err(refused(format!(
            "found an unsigned manifest, expected the first signature: octant campaign report with {}",
            signature::KEY
        )));
    };
    if *first == format!("minisign key {}", key.id()) {
        return Err(refused(format!(
            "found {first}, which signed the manifest, expected the key of a second person"
        )));
    }
    let path = folder.join(disposition::FILE_NAME);
    let said =
        Dispositions::read(&path).map_err(|error| Failure::input(format!("failed to {error}")))?;
    if said.text.is_empty() {
        return Err(refused("found no discrepancy, so there is no disposition to sign".to_owned()));
    }
    for entry in &said.entries {
        for (field, text) in [("disposition", &entry.disposition), ("by", &entry.by)] {
            if text.trim().is_empty() {
                return Err(refused(format!(
                    "{}: {field} of {:?} is empty, expected a text to sign",
                    path.display(),
                    entry.id
                )));
            }
        }
    }
    key.sign_dispositions(&path, &facts.plan, &facts.results_blake3)
        .map_err(|error| Failure::input(error).failed())?;
    print(&format!(
        "{} signed by minisign key {}\n{}\n",
        counted(said.entries.len(), "disposition", "dispositions"),
        key.id(),
        folder.join(signature::SECOND).display()
    ))?;
    Ok(Verdict::Pass)
}
