//! The list of a bundle, and names of its entries.

use octant_dispatch::bundle::contents::BundleContents;
use octant_dispatch::bundle::entry_name::{check, plain};
use octant_dispatch::bundle::error::EntryNameError;
use octant_score::numerics::NUMERICS;
use std::path::Path;

#[test]
fn entries_stay_in_their_folder() {
    let hash = "0".repeat(64);
    for good in ["plan.json".to_owned(), format!("files/{hash}/a b.fmu")] {
        assert_eq!(check(&good), Ok(()));
    }
    for (bad, reason) in [
        ("/etc/passwd".to_owned(), EntryNameError::Absolute),
        ("\\\\host\\share".to_owned(), EntryNameError::Absolute),
        ("C:\\windows".to_owned(), EntryNameError::Absolute),
        (format!("files/{hash}/../../a"), EntryNameError::Outside),
        ("..\\a".to_owned(), EntryNameError::Outside),
        (format!("files/{hash}/a/b"), EntryNameError::Unknown),
        (format!("files/{hash}/"), EntryNameError::Unknown),
        (format!("files/{hash}/a:b"), EntryNameError::Unknown),
        (format!("files/{}/a", "0".repeat(63)), EntryNameError::Unknown),
        (format!("files/{}/a", "G".repeat(64)), EntryNameError::Unknown),
        ("results/a.octres".to_owned(), EntryNameError::Unknown),
    ] {
        assert_eq!(check(&bad), Err(reason), "{bad}");
    }
}

#[test]
fn names_of_files_are_made_plain() {
    for (name, expected) in [
        ("ship 1.fmu", "ship 1.fmu"),
        ("a:b\n", "a_b_"),
        ("..", "file"),
        (".", "file"),
        ("", "file"),
    ] {
        assert_eq!(plain(name), expected);
        assert_eq!(check(&format!("files/{}/{}", "a".repeat(64), plain(name))), Ok(()));
    }
}

#[test]
fn a_list_that_was_changed_is_refused() {
    let contents = BundleContents::new("p", vec!["exec:./core".to_owned()], Vec::new());
    let path = Path::new("b.zip");
    let json = contents.to_json();
    assert_eq!(BundleContents::from_json(path, json.as_bytes()).unwrap(), contents);
    let edited = json.replace("exec:./core", "exec:./cord");
    let error = BundleContents::from_json(path, edited.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("b.zip") && error.contains("was changed"), "{error}");
}

#[test]
fn another_program_is_told_with_its_numerics() {
    let own = BundleContents::new("p", Vec::new(), Vec::new());
    assert_eq!(own.by_another(), None);
    let other = BundleContents { program_sha256: Some("f".repeat(64)), ..own.clone() };
    let told = other.by_another().unwrap();
    assert!(told.contains("ffffffffffff") && !told.contains("numerics"), "{told}");
    let numerics = BundleContents { numerics: NUMERICS + 1, ..other };
    assert!(numerics.by_another().unwrap().contains("numerics version"));
}
