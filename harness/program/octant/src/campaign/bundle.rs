//! `octant campaign bundle` and `unbundle`: a plan with its files, as one file.

use super::planned::read;
use crate::failure::Failure;
use crate::place::{self, Needs, StoredCampaign};
use crate::terminal::{note, print};
use octant_base::number::counted;
use octant_campaign::plan::Plan;
use octant_dispatch::bundle::contents::BundleContents;
use octant_dispatch::bundle::error::BundleError;
use octant_dispatch::bundle::unpack::unpack;
use octant_dispatch::bundle::write::write;
use octant_verdict::Verdict;
use std::path::Path;

impl From<BundleError> for Failure {
    fn from(error: BundleError) -> Self {
        let failure = Self::of(&error);
        match error {
            BundleError::Plan(error) => error.into(),
            BundleError::Scenario(_) => failure,
            BundleError::Name(_)
            | BundleError::System { .. }
            | BundleError::Unfit { .. }
            | BundleError::Exists { .. }
            | BundleError::Form { .. }
            | BundleError::Entry { .. } => failure.failed(),
        }
    }
}

/// Writes the bundle of a campaign, as a file or to object storage.
pub(super) fn bundle(folder: &Path, out: &Path) -> Result<Verdict, Failure> {
    let plan = read(folder)?;
    let contents = match place::address(out) {
        Some(text) => place::push(plan, text)?,
        None => write(plan, out)?,
    };
    outside(&contents);
    told(&contents, out)
}

/// Makes the folder of a campaign from its bundle, or from all of its objects.
pub(super) fn unbundle(bundle: &Path, folder: &Path) -> Result<Verdict, Failure> {
    if let Some(text) = place::address(bundle) {
        StoredCampaign::fetch(text, Some(folder), Needs::All)?;
        check_origin(&read(folder)?, folder)?;
        print(&format!("{}\n", folder.display()))?;
        return Ok(Verdict::Pass);
    }
    let contents = unpack(bundle, folder)?;
    outside(&contents);
    if let Some(told) = contents.by_another() {
        note!("octant: {told}");
    }
    told(&contents, folder)
}

/// Checks the plan of a folder against the bundle that the folder comes from, and warns if another program
/// made that.
pub(super) fn check_origin(plan: &Plan, folder: &Path) -> Result<(), Failure> {
    let contents = BundleContents::of_folder(folder)?;
    // A plan that was extended is that of this program.
    if let Some(contents) = contents.filter(|contents| contents.plan == plan.id) {
        contents.check_plan(folder, plan, folder)?;
        if let Some(told) = contents.by_another() {
            note!("octant: {told}");
        }
    }
    Ok(())
}

fn outside(contents: &BundleContents) {
    for device in &contents.outside {
        note!("octant: not in the bundle: {device}");
    }
}

fn told(contents: &BundleContents, place: &Path) -> Result<Verdict, Failure> {
    let bytes: u64 = contents.files.iter().map(|file| file.bytes).sum();
    let files = counted(contents.files.len(), "file", "files");
    print(&format!("{files} with {bytes} bytes\n{}\n", place.display()))?;
    Ok(Verdict::Pass)
}
