//! Stored results, read and changed as a person with an editor for them would.

use octant_campaign::store::{CampaignResults, keep};
use serde_json::Value;
use std::path::Path;

/// Returns the stored text of a case's result.
pub fn text(folder: &Path, id: &str) -> String {
    let stored = CampaignResults::open(folder).unwrap().bytes(id).unwrap();
    String::from_utf8(stored.unwrap_or_else(|| panic!("{id} has no result")).bytes).unwrap()
}

/// Returns the stored result of a case.
pub fn value(folder: &Path, id: &str) -> Value {
    serde_json::from_str(&text(folder, id)).unwrap()
}

/// Stores the result of a case in place of the one that is there.
pub fn put(folder: &Path, id: &str, text: &str) {
    if CampaignResults::open(folder).unwrap().has(id) {
        remove(folder, id);
    }
    keep(folder, id, text.as_bytes()).unwrap();
}

/// Stores another result of a case beside the one that is there.
pub fn put_beside(folder: &Path, id: &str, text: &str) {
    let kept = keep(folder, id, text.as_bytes()).unwrap();
    assert!(matches!(kept, octant_campaign::store::StoreOutcome::Differs(_)), "{kept:?}");
}

/// Removes the results of a case: all the others are stored anew.
pub fn remove(folder: &Path, id: &str) {
    let results = CampaignResults::open(folder).unwrap();
    assert!(results.has(id), "{id} has no result");
    let others = results.ids().filter(|other| *other != id);
    let others: Vec<_> = others
        .map(|other| (other.to_owned(), results.bytes(other).unwrap().unwrap().bytes))
        .collect();
    clear(folder);
    for (other, bytes) in others {
        keep(folder, &other, &bytes).unwrap();
    }
}

/// Removes all results.
pub fn clear(folder: &Path) {
    for part in ["results", "cases"] {
        let _ = std::fs::remove_dir_all(folder.join(part));
    }
}
