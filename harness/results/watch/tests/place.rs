//! Runs found by their names.

use octant_evidence::{Existing, RunFolder};
use octant_watch::place::{RECORDING, RunPlace};
use std::fs;
use std::path::PathBuf;

#[test]
fn a_run_is_found_under_each_of_its_names() {
    let here = tempfile::tempdir().unwrap();
    let path = here.path().join("one");
    let folder = RunFolder::create(&path, Existing::Refuse).unwrap();
    // The run is starting: there is no recording yet.
    let place = RunPlace::of(&path).unwrap();
    assert_eq!((place.recording(), place.is_written()), (None, true));
    let partial = folder.path().to_owned();
    fs::write(partial.join(RECORDING), "x").unwrap();
    for name in [path.clone(), partial.clone(), partial.join(RECORDING), path.join(RECORDING)] {
        assert_eq!(RunPlace::of(&name).unwrap(), place, "{}", name.display());
    }
    assert_eq!(place.recording().unwrap(), partial.join(RECORDING));
    assert_eq!(RunPlace::newest(here.path()).unwrap(), place);
    fs::write(partial.join("manifest.json"), "{}").unwrap();
    folder.finish().unwrap();
    assert_eq!(place.recording().unwrap(), path.join(RECORDING));
    assert!(!place.is_written());
    assert_eq!(place.folder(), path);
}

#[test]
fn a_run_that_goes_on_comes_before_what_a_killed_one_left() {
    let here = tempfile::tempdir().unwrap();
    let going = RunFolder::create(&here.path().join("a"), Existing::Refuse).unwrap();
    fs::write(going.path().join(RECORDING), "x").unwrap();
    // Begun later, but its lock isn't held.
    drop(RunFolder::create(&here.path().join("b"), Existing::Refuse).unwrap());
    fs::write(here.path().join("b.partial").join(RECORDING), "x").unwrap();
    assert_eq!(RunPlace::newest(here.path()).unwrap().folder(), going.path());
    drop(going);
    assert!(!RunPlace::of(&here.path().join("a")).unwrap().is_written());
}

#[test]
fn what_is_no_run_is_told() {
    let here = tempfile::tempdir().unwrap();
    let error = |path: PathBuf| RunPlace::of(&path).unwrap_err().to_string();
    assert!(error(here.path().join("no")).contains("neither"));
    assert!(error(here.path().to_owned()).contains("recording.mcap is missing"));
    assert!(error(here.path().join("no.mcap")).contains("no.mcap is missing"));
    let none = RunPlace::newest(&here.path().join("runs")).unwrap_err().to_string();
    assert!(none.contains("no folder *.partial"), "{none}");
}
