//! A planned campaign on object storage, and results that a worker could have stored.

use crate::planned::planned;
use octant_campaign::execute::Shard;
use octant_campaign::execute::case::CaseResult;
use octant_campaign::plan::{FILE_NAME, Plan};
use octant_campaign::store::writer::PartWriter;
use octant_campaign::store::{StoreOutcome, keep_in};
use octant_dispatch::bundle::write::write;
use octant_dispatch::storage::layout::BUNDLE;
use octant_dispatch::storage::{PutOutcome, Storage, WorkFolder, WorkScope};
use std::path::Path;

/// Bytes of the bundle of a campaign with so many cases, and their ids.
pub(crate) fn bundle(cases: usize) -> (Vec<u8>, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    planned(folder.path(), "stored", cases).write(&at("planned"), false).unwrap();
    let plan = Plan::read(&at("planned").join(FILE_NAME)).unwrap();
    let ids = plan.cases.iter().map(|case| case.id.to_string()).collect();
    write(plan, &at("bundle.zip")).unwrap();
    (std::fs::read(at("bundle.zip")).unwrap(), ids)
}

/// A storage in memory with a campaign of so many cases, and their ids.
pub(crate) fn stored(cases: usize) -> (Storage, Vec<String>) {
    let storage = Storage::in_memory().unwrap();
    let (bytes, ids) = bundle(cases);
    assert_eq!(storage.put_new(BUNDLE, &bytes).unwrap(), PutOutcome::New);
    (storage, ids)
}

pub(crate) fn fetched(storage: &Storage, shard: Shard) -> WorkFolder {
    WorkFolder::fetch(storage, None, WorkScope::Shard(shard)).unwrap()
}

/// Stores the result of a case in the part file of a worker, as large as is asked for.
pub(crate) fn put(folder: &Path, shard: Shard, case: &str, bytes: usize) {
    // Zstandard makes nothing of equal digits.
    let mut state = case.bytes().fold(1_u64, |state, byte| state * 31 % 65_521 + u64::from(byte));
    let mut digits = String::new();
    while digits.len() < bytes {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        digits += &format!("{state:016x}");
    }
    put_text(folder, shard, case, &digits);
}

/// Stores an error as the result of a case.
pub(crate) fn put_text(folder: &Path, shard: Shard, case: &str, error: &str) {
    let json = CaseResult::broken(case, error.to_owned()).to_json().unwrap();
    let mut writer = PartWriter::new(folder, &shard.stem()).unsynced();
    let kept = keep_in(&mut writer, case, json.as_bytes(), &[]).unwrap();
    assert!(matches!(kept, StoreOutcome::New(_)), "{kept:?}");
}

pub(crate) fn shard(number: u32, of: u32) -> Shard {
    Shard { number, of }
}
