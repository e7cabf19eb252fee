//! Folders of runs, and what kills leave of them.

use octant_evidence::leftover::{self, put_aside};
use octant_evidence::{Existing, FolderError, LOCK, RunFolder};
use std::fs;
use std::path::{Path, PathBuf};

fn finished(path: &Path, content: &str) {
    let run = RunFolder::create(path, Existing::Replace).unwrap();
    fs::write(run.path().join("manifest.json"), content).unwrap();
    assert_eq!(run.finish().unwrap(), path);
}

#[test]
fn a_run_gets_its_name_when_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/RUN");
    let run = RunFolder::create(&path, Existing::Refuse).unwrap();
    assert_eq!(run.path(), folder.path().join("deep/RUN.partial"));
    assert!(!path.exists());
    let other = RunFolder::create(&path, Existing::Replace).unwrap_err();
    assert!(matches!(other, FolderError::Busy { .. }), "{other}");
    let path_of_run = run.path().to_owned();
    assert!(matches!(run.finish(), Err(FolderError::NotARun { .. })), "no manifest");
    assert!(path_of_run.exists());
    finished(&path, "one");
    assert!(!path_of_run.exists());
    assert!(!path.join(LOCK).exists());
}

#[test]
fn a_finished_run_is_replaced_only_when_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("RUN");
    finished(&path, "one");
    let error = RunFolder::create(&path, Existing::Refuse).unwrap_err();
    assert!(matches!(error, FolderError::Finished { .. }), "{error}");
    finished(&path, "two");
    assert_eq!(fs::read_to_string(path.join("manifest.json")).unwrap(), "two");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left over");
}

#[test]
fn what_a_kill_left_is_kept_until_told_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("RUN");
    drop(RunFolder::create(&path, Existing::Refuse).unwrap());
    let error = RunFolder::create(&path, Existing::Refuse).unwrap_err();
    assert!(matches!(error, FolderError::Unfinished { .. }), "{error}");
    finished(&path, "one");
}

/// A run that is whole takes its name only where the name is free.
#[test]
fn a_whole_run_never_takes_the_place_of_a_finished_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("RUN");
    let run = RunFolder::create(&path, Existing::Refuse).unwrap();
    fs::write(run.path().join("manifest.json"), "whole").unwrap();
    fs::remove_file(run.path().join(LOCK)).unwrap();
    let partial = run.path().to_owned();
    drop(run);
    fs::create_dir(&path).unwrap();
    let error = RunFolder::clear_partial(&partial, &path, Existing::Refuse).unwrap_err();
    assert!(matches!(error, FolderError::Unfinished { .. }), "{error}");
    assert_eq!(fs::read_to_string(partial.join("manifest.json")).unwrap(), "whole");
}

#[cfg(unix)]
#[test]
fn a_lock_that_cannot_be_opened_is_no_missing_one() {
    let folder = tempfile::tempdir().unwrap();
    let partial = folder.path().join("RUN.partial");
    fs::create_dir(&partial).unwrap();
    std::os::unix::fs::symlink(LOCK, partial.join(LOCK)).unwrap();
    let error = RunFolder::create(&folder.path().join("RUN"), Existing::Replace).unwrap_err();
    assert!(matches!(error, FolderError::System { action: "open", .. }), "{error}");
}

/// Covers every state that a kill can leave: the next run starts, and only that run is there
/// afterwards.
#[test]
fn what_kills_leave_is_cleaned_by_the_next_run() {
    type Left = fn(&Path);
    let make = |path: PathBuf, files: &[&str]| {
        fs::create_dir(&path).unwrap();
        files.iter().for_each(|name| fs::write(path.join(name), "old").unwrap());
    };
    let all: [(&str, Left); 7] = [
        ("the folder alone", |here| fs::create_dir(here.join("RUN.partial")).unwrap()),
        ("a run that is whole but for its name", |here| {
            let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
            fs::write(run.path().join("manifest.json"), "old").unwrap();
            fs::remove_file(run.path().join(LOCK)).unwrap();
        }),
        ("a removal that was broken off", |here| {
            let path = here.join("RUN.partial");
            fs::create_dir(&path).unwrap();
            fs::write(path.join("recording.mcap"), "old").unwrap();
            fs::write(path.join(".octant-x.new"), "old").unwrap();
        }),
        ("a run put aside by an older version", |here| {
            let path = here.join("RUN.replaced");
            fs::create_dir(&path).unwrap();
            fs::write(path.join("manifest.json"), "old").unwrap();
        }),
        ("a run put aside, half removed", |here| {
            let run = here.join("RUN");
            fs::create_dir(&run).unwrap();
            fs::write(run.join("manifest.json"), "old").unwrap();
            let aside = put_aside(&run).unwrap();
            fs::remove_file(aside.join("manifest.json")).unwrap();
        }),
        ("both names gone, the new run whole", |here| {
            let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
            fs::write(run.path().join("manifest.json"), "new").unwrap();
            fs::remove_file(run.path().join(LOCK)).unwrap();
            let path = here.join("RUN.replaced");
            fs::create_dir(&path).unwrap();
            fs::write(path.join("manifest.json"), "old").unwrap();
        }),
        ("a file that was not whole", |here| {
            let run = RunFolder::create(&here.join("RUN"), Existing::Refuse).unwrap();
            fs::write(run.path().join(".octant-y.new"), "old").unwrap();
        }),
    ];
    for (what, leave) in all {
        let folder = tempfile::tempdir().unwrap();
        leave(folder.path());
        finished(&folder.path().join("RUN"), "next");
        let names: Vec<_> =
            fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(names, ["RUN"], "{what}");
        assert_eq!(
            fs::read_to_string(folder.path().join("RUN/manifest.json")).unwrap(),
            "next",
            "{what}"
        );
    }
    // A foreign folder with such a name stays, and doesn't disturb the end of a run.
    let folder = tempfile::tempdir().unwrap();
    finished(&folder.path().join("RUN"), "one");
    make(folder.path().join("RUN.replaced"), &["thesis.tex"]);
    finished(&folder.path().join("RUN"), "two");
    assert!(folder.path().join("RUN.replaced/thesis.tex").exists());
    // Without --force a run that only lacked its name gets it, and stays.
    let folder = tempfile::tempdir().unwrap();
    make(folder.path().join("RUN.partial"), &["manifest.json"]);
    let error = RunFolder::create(&folder.path().join("RUN"), Existing::Refuse).unwrap_err();
    assert!(matches!(error, FolderError::Finished { .. }), "{error}");
    assert!(folder.path().join("RUN/manifest.json").exists());
    // A run that was put aside comes back if the new one never got its name.
    let folder = tempfile::tempdir().unwrap();
    make(folder.path().join("RUN"), &["manifest.json"]);
    put_aside(&folder.path().join("RUN")).unwrap();
    let error = RunFolder::create(&folder.path().join("RUN"), Existing::Refuse).unwrap_err();
    assert!(matches!(error, FolderError::Finished { .. }), "{error}");
}

#[test]
fn a_folder_that_is_no_run_is_never_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("home");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("thesis.tex"), "years of work").unwrap();
    let error = RunFolder::create(&path, Existing::Replace).unwrap_err();
    assert!(matches!(error, FolderError::NotARun { .. }), "{error}");
    fs::create_dir(folder.path().join("x.partial")).unwrap();
    fs::write(folder.path().join("x.partial/thesis.tex"), "more of it").unwrap();
    let error = RunFolder::create(&folder.path().join("x"), Existing::Replace).unwrap_err();
    assert!(matches!(error, FolderError::NotARun { .. }), "{error}");
    let error = RunFolder::create(Path::new("/"), Existing::Replace).unwrap_err();
    assert!(matches!(error, FolderError::NoName { .. }), "{error}");
}

#[test]
fn a_replacement_that_fails_leaves_the_previous_run_and_says_where_it_is() {
    let here = tempfile::tempdir().unwrap();
    let (old, new) = (here.path().join("run"), here.path().join("run.partial"));
    std::fs::create_dir(&old).unwrap();
    std::fs::write(old.join("manifest.json"), "the previous one").unwrap();
    let error = leftover::replace(&old, &new).unwrap_err();
    let FolderError::NotReplaced { old: kept, .. } = &error else { panic!("{error}") };
    assert_eq!(std::fs::read_to_string(kept.join("manifest.json")).unwrap(), "the previous one");
    let said = error.to_string();
    assert!(
        said.ends_with(&format!("the run that it was to replace is in {}", kept.display())),
        "{said}"
    );
    // The new folder went while its run was being finished.
    let run = RunFolder::create(&old, Existing::Replace).unwrap();
    std::fs::write(run.path().join("manifest.json"), "{}").unwrap();
    let finished = run.finish().unwrap();
    assert_eq!(std::fs::read_to_string(finished.join("manifest.json")).unwrap(), "{}");
    assert_eq!(std::fs::read_dir(here.path()).unwrap().count(), 1, "nothing is left beside it");
}
