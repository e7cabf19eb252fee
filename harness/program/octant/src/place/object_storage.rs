//! Campaigns on object storage.

use super::needs::Needs;
use crate::failure::Failure;
use crate::terminal::{note, print};
use octant_base::control::SetAtEnd;
use octant_base::interrupt;
use octant_base::number::counted;
use octant_campaign::execute::Shard;
use octant_campaign::plan::Plan;
use octant_dispatch::bundle::contents::BundleContents;
use octant_dispatch::bundle::write::write;
use octant_dispatch::storage::layout::BUNDLE;
use octant_dispatch::storage::{
    PutOutcome, SegmentUploads, Storage, StorageAddress, StorageError, StorageOptions,
    UploadLimits, WorkFolder, WorkScope,
};
use octant_verdict::Verdict;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A campaign on object storage, with a folder made of its objects.
#[derive(Debug)]
pub(crate) struct StoredCampaign {
    storage: Storage,
    work: WorkFolder,
}

impl From<StorageError> for Failure {
    fn from(error: StorageError) -> Self {
        match error {
            StorageError::Bundle(error) => error.into(),
            StorageError::Address { .. }
            | StorageError::Environment { .. }
            | StorageError::Absent { .. }
            | StorageError::Taken { .. }
            | StorageError::Work { .. } => Self::input(error).failed(),
            StorageError::Interrupted { .. } => Self {
                status: Verdict::Inconclusive.exit_code(),
                message: format!("failed to {error}"),
            },
            StorageError::Failed { .. }
            | StorageError::NotKept { .. }
            | StorageError::Form { .. }
            | StorageError::Part(_)
            | StorageError::System { .. } => Self::bench(error).failed(),
        }
    }
}

impl StoredCampaign {
    /// Makes a folder of a campaign's objects: the one that is given, or a temporary one.
    pub(crate) fn fetch(text: &str, given: Option<&Path>, needs: Needs) -> Result<Self, Failure> {
        let scope = match needs {
            Needs::Plan => WorkScope::Plan,
            Needs::Results => WorkScope::Results,
            Needs::All => WorkScope::All,
        };
        let storage = open(text)?;
        let work = WorkFolder::fetch(&storage, given, scope)?;
        Ok(Self { storage, work })
    }

    /// Returns the folder.
    pub(crate) fn folder(&self) -> &Path {
        self.work.path()
    }

    /// Returns the address.
    pub(crate) fn address(&self) -> String {
        self.storage.address().to_string()
    }

    /// Stores what was written into the folder, which stays if it can't be stored.
    pub(crate) fn put_back(&mut self) -> Result<(), Failure> {
        match self.work.put_back(&self.storage) {
            Ok(_) => Ok(()),
            Err(error) => {
                let failure = Failure::from(error);
                let folder = self.work.keep().display();
                let message = format!("{}; its files are in {folder}", failure.message);
                Err(Failure { message, ..failure })
            }
        }
    }
}

fn open(text: &str) -> Result<Storage, Failure> {
    let address = StorageAddress::parse(text)?;
    let options = StorageOptions::from_environment(interrupt::flag())?;
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let known = [
        "AWS_ACCESS_KEY_ID",
        "AWS_SECRET_ACCESS_KEY",
        "AWS_WEB_IDENTITY_TOKEN_FILE",
        "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI",
        "AWS_CONTAINER_CREDENTIALS_FULL_URI",
        "AWS_SKIP_SIGNATURE",
    ];
    if address.folder().is_none() && !known.into_iter().any(is_set) {
        note!(
            "octant: found no AWS_ACCESS_KEY_ID in the environment: asking this host for its role"
        );
    }
    Ok(Storage::open(&address, options)?)
}

/// Puts the bundle of a campaign at an address.
pub(crate) fn push(plan: Plan, text: &str) -> Result<BundleContents, Failure> {
    let address = StorageAddress::parse(text)?;
    if let Some(folder) = address.folder() {
        std::fs::create_dir_all(folder).map_err(|error| {
            Failure::bench(format!("failed to create {}: {error}", folder.display()))
        })?;
    }
    let storage = open(text)?;
    let system =
        |error: std::io::Error| Failure::bench(format!("failed to make a bundle: {error}"));
    let scratch = tempfile::tempdir().map_err(system)?;
    let file = scratch.path().join(BUNDLE);
    let contents = write(plan, &file)?;
    let bytes = std::fs::read(&file).map_err(system)?;
    match storage.put_new(BUNDLE, &bytes)? {
        PutOutcome::New | PutOutcome::Same => Ok(contents),
        PutOutcome::Other(_) => Err(StorageError::Taken {
            object: address.of(BUNDLE),
            reason: "found another bundle, expected a prefix of its own for each plan".to_owned(),
        }
        .into()),
    }
}

/// Runs a part of a campaign, and uploads its results while it runs and at its end.
///
/// `run` runs the part in the working folder: the one that is given, or a temporary one, which stays if its results
/// can't be uploaded.
pub(crate) fn run_part(
    text: &str,
    given: Option<&Path>,
    shard: Shard,
    every: Duration,
    run: impl FnOnce(&Path) -> Result<Verdict, Failure>,
) -> Result<Verdict, Failure> {
    let storage = open(text)?;
    let mut work = WorkFolder::fetch(&storage, given, WorkScope::Shard(shard))?;
    let limits = UploadLimits { every, ..UploadLimits::default() };
    let mut uploads = SegmentUploads::of(&storage, &work, shard, limits)?;
    let is_done = AtomicBool::new(false);
    // Results that can't be stored are of no use: no more cases are begun then.
    let stop = || interrupt::flag().store(true, Ordering::Relaxed);
    let (ran, uploaded) = std::thread::scope(|scope| {
        let follow = scope.spawn(|| uploads.follow(&is_done, stop));
        let ran = {
            let _done = SetAtEnd(&is_done);
            run(work.path())
        };
        (ran, follow.join())
    });
    let (results, segments) = uploads.uploaded();
    match uploaded {
        Ok(Ok(())) => {}
        Ok(Err(error)) => {
            let folder = work.keep().display();
            let failure = Failure::from(error);
            let message = format!(
                "{}; its results are in {folder}: --work {folder} goes on with them",
                failure.message
            );
            return Err(Failure { status: Verdict::Error.exit_code(), message });
        }
        Err(panic) => std::panic::resume_unwind(panic),
    }
    if results > 0 {
        let results = counted(results, "record", "records");
        let segments = counted(segments, "segment", "segments");
        print(&format!("{results} uploaded to {} in {segments}\n", storage.address()))?;
    }
    ran
}
