//! The same bytes on any number of threads and after an interruption; an edited journal is refused.

use super::known::{SHORT, g_zz, scenario};
use octant_base::control::Control;
use octant_rare::estimators::estimate::RarePlan;
use octant_rare::runs::error::RareError;
use octant_rare::runs::failure::{failure, requirement};
use octant_rare::runs::journal::{RARE_JOURNAL_SCHEMA, RareIdentity};
use octant_rare::runs::many::{RareRuns, SeverityOf};
use octant_rare::runs::outcome::RareSubject;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

fn identity() -> RareIdentity {
    RareIdentity {
        schema: RARE_JOURNAL_SCHEMA,
        octant: "test".to_owned(),
        numerics: 1,
        scenario_blake3: "one".to_owned(),
        subject: "requirement G".to_owned(),
        plan: "seed 1".to_owned(),
    }
}

/// An estimate with a journal; it is interrupted after so many runs.
fn journalled(
    path: &Path,
    jobs: usize,
    interrupted: usize,
    identity: &RareIdentity,
) -> Result<String, RareError> {
    let scenario = scenario(&(SHORT.to_owned() + &g_zz(2.5)));
    let of = requirement(&scenario, None).unwrap();
    let control = Control::default();
    let count = AtomicUsize::new(0);
    let tell = || {
        if count.fetch_add(1, Ordering::Relaxed) + 1 == interrupted {
            control.cancel.store(true, Ordering::Relaxed);
        }
    };
    let subject = RareSubject::Requirement("G".to_owned());
    let severity = SeverityOf::Margin(false);
    let mut runs = RareRuns::new(&scenario, subject, severity, jobs, &control, &tell).unwrap();
    runs.resume(path, identity)?;
    let plan = RarePlan { runs: 700, samples: 60, pilot: 100, error: 0.2, ..RarePlan::default() };
    let (found, file) = failure(&mut runs, &scenario, of, &plan, (None, false))?;
    Ok(serde_json::to_string(&found).unwrap() + &file.unwrap_or_default())
}

#[test]
fn the_same_bytes_on_any_number_of_threads_and_after_an_interruption() {
    let folder = tempfile::tempdir().unwrap();
    let [one, three, cut] = ["one", "three", "cut"].map(|name| folder.path().join(name));
    let whole = journalled(&one, 1, usize::MAX, &identity()).unwrap();
    assert_eq!(journalled(&three, 3, usize::MAX, &identity()).unwrap(), whole);
    let interrupted = journalled(&cut, 2, 200, &identity());
    assert!(matches!(interrupted, Err(RareError::Cancelled)), "{interrupted:?}");
    // A line that was being written.
    let text = std::fs::read_to_string(&cut).unwrap();
    assert!(text.lines().count() > 100);
    std::fs::write(&cut, text + "0123456789abcdef {\"point").unwrap();
    assert_eq!(journalled(&cut, 2, usize::MAX, &identity()).unwrap(), whole);
    let bytes = [&one, &three, &cut].map(|path| std::fs::read(path).unwrap());
    assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2]);
}

#[test]
fn an_edited_or_foreign_journal_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rare.jsonl");
    let _ = journalled(&path, 2, 150, &identity());
    let text = std::fs::read_to_string(&path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let refused = |text: String, expected: &str| {
        std::fs::write(&path, text).unwrap();
        let error = journalled(&path, 2, usize::MAX, &identity()).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}");
    };
    let without = |left: usize| {
        let kept = lines.iter().enumerate().filter(|(index, _)| *index != left);
        kept.map(|(_, line)| format!("{line}\n")).collect::<String>()
    };
    refused(without(5), "line 6: the checksum doesn't fit");
    refused(text.replacen("true]", "false]", 1), "the checksum doesn't fit");
    refused(text.replacen("seed 1", "seed 2", 1), "it is the journal of another estimate");
    std::fs::write(&path, &text).unwrap();
    let other = RareIdentity { subject: "calibration".to_owned(), ..identity() };
    let error = journalled(&path, 2, usize::MAX, &other).unwrap_err().to_string();
    assert!(error.contains("line 1: found subject \"requirement G\""), "{error}");
}
