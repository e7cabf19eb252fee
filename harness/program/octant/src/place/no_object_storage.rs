//! Stand-in for object storage in a program that was built without it.

use super::needs::Needs;
use crate::failure::Failure;
use octant_campaign::execute::Shard;
use octant_campaign::plan::Plan;
use octant_dispatch::bundle::contents::BundleContents;
use octant_verdict::Verdict;
use std::path::Path;
use std::time::Duration;

/// Uninhabited: this program is built without object storage.
#[derive(Debug)]
pub(crate) enum StoredCampaign {}

impl StoredCampaign {
    /// Refuses an address.
    pub(crate) fn fetch(text: &str, _: Option<&Path>, _: Needs) -> Result<Self, Failure> {
        Err(refused(text))
    }

    /// Never called.
    pub(crate) fn folder(&self) -> &Path {
        match *self {}
    }

    /// Never called.
    pub(crate) fn address(&self) -> String {
        match *self {}
    }

    /// Never called.
    pub(crate) fn put_back(&mut self) -> Result<(), Failure> {
        match *self {}
    }
}

/// Refuses an address.
pub(crate) fn push(_: Plan, text: &str) -> Result<BundleContents, Failure> {
    Err(refused(text))
}

/// Refuses an address.
pub(crate) fn run_part(
    text: &str,
    _: Option<&Path>,
    _: Shard,
    _: Duration,
    _: impl FnOnce(&Path) -> Result<Verdict, Failure>,
) -> Result<Verdict, Failure> {
    Err(refused(text))
}

fn refused(text: &str) -> Failure {
    Failure::input(format!(
        "found the address {text}: this program was built without object storage, expected a folder, or a \
         program built with cargo build --release --features octant/object-storage"
    ))
}
