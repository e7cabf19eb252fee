//! Names of the files that evidence has beside its contents.

/// Name of the manifest in a run folder.
pub const MANIFEST: &str = "manifest.json";
/// Name of the signature beside a manifest.
pub const SIGNATURE: &str = "manifest.json.minisig";
/// Name of the second person's signature beside the dispositions of a campaign.
pub const SECOND: &str = "dispositions.toml.minisig";
/// Lock file, held while a run is written; removed before the folder gets its name.
pub const LOCK: &str = ".writing";
