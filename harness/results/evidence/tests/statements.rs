//! Facts that evidence takes from the folder of a system.

use octant_evidence::statements::{FolderStatements, SUMMARY, of_run};
use octant_evidence::{Manifest, RunFacts};
use octant_verdict::Verdict;
use serde_json::Value;
use serde_json::json;
use std::time::{Duration, SystemTime};

fn read(document: &Value) -> FolderStatements {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(SUMMARY), document.to_string()).unwrap();
    let (began, length) = (SystemTime::UNIX_EPOCH, Duration::from_secs(1));
    let facts = RunFacts::between(began, began + length);
    let manifest = Manifest::write(folder.path(), &facts).unwrap();
    of_run(folder.path(), &manifest)
}

#[test]
fn a_system_is_no_better_than_its_end_and_its_faults() {
    let system = |verdict: &str, how: &str, fired: bool| {
        read(&json!({
            "system": "two", "verdict": verdict, "ended": { "how": how },
            "faults": [{ "id": "a", "fired": true }, { "id": "b", "fired": fired }],
        }))
    };
    let whole = system("none", "complete", true);
    assert_eq!((whole.verdict, whole.contradictions.len()), (Some(Verdict::None), 0));
    for (how, fired, least) in [
        ("complete", false, Verdict::Inconclusive),
        ("interrupted", true, Verdict::Inconclusive),
        ("failed", true, Verdict::Error),
    ] {
        let told = system(least.name(), how, fired);
        assert_eq!((told.verdict, told.contradictions.len()), (Some(least), 0), "{how}");
        let better = system("none", how, fired);
        assert_eq!((better.verdict, better.contradictions.len()), (Some(least), 1), "{how}");
    }
    assert_eq!(system("splendid", "complete", true).verdict, Some(Verdict::Error));
}
