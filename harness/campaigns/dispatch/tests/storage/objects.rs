//! Objects are written once, or over another, and an interrupt ends reading.

use octant_dispatch::storage::{PutOutcome, Storage, StorageAddress, StorageError, StorageOptions};
use octant_test_processes::command;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tempfile::TempDir;

fn in_folder(folder: &Path, cancel: Option<&'static AtomicBool>) -> Storage {
    let address = StorageAddress::parse(&format!("file://{}", folder.display())).unwrap();
    Storage::open(&address, StorageOptions { retry: Duration::ZERO, cancel }).unwrap()
}

fn storages() -> (TempDir, [Storage; 2]) {
    let folder = tempfile::tempdir().unwrap();
    let storage = in_folder(folder.path(), None);
    (folder, [Storage::in_memory().unwrap(), storage])
}

#[test]
fn an_object_that_is_written_once_is_never_replaced() {
    let (_folder, storages) = storages();
    for storage in storages {
        assert_eq!(storage.get("a/1").unwrap(), None);
        assert_eq!(storage.put_new("a/1", b"one").unwrap(), PutOutcome::New);
        // As after a request whose answer was lost.
        assert_eq!(storage.put_new("a/1", b"one").unwrap(), PutOutcome::Same);
        assert_eq!(storage.put_new("a/1", b"two").unwrap(), PutOutcome::Other(b"one".to_vec()));
        assert_eq!(storage.get("a/1").unwrap().as_deref(), Some(&b"one"[..]));
        storage.put("a/1", b"three".to_vec()).unwrap();
        assert_eq!(storage.get("a/1").unwrap().as_deref(), Some(&b"three"[..]));
    }
}

#[test]
fn objects_are_listed_and_read_in_the_order_of_their_names() {
    let (_folder, storages) = storages();
    for storage in storages {
        assert_eq!(storage.list("").unwrap(), BTreeMap::new());
        let names: Vec<String> = (0..20).map(|k| format!("results/{k:02} of it")).collect();
        for name in names.iter().rev() {
            storage.put(name, name.as_bytes().to_vec()).unwrap();
        }
        storage.put("resultsbeside", vec![1]).unwrap();
        let listed: Vec<String> = storage.list("results").unwrap().into_keys().collect();
        assert_eq!(listed, names);
        assert_eq!(storage.list("").unwrap()["resultsbeside"], 1);
        let mut read = Vec::new();
        let each = |name: &str, bytes: Vec<u8>| {
            assert_eq!(name.as_bytes(), bytes);
            read.push(name.to_owned());
            Ok(())
        };
        storage.get_all(&names, each).unwrap();
        assert_eq!(read, names);
        let missing = ["results/01 of it".to_owned(), "results/gone".to_owned()];
        let error = storage.get_all(&missing, |_, _| Ok(())).unwrap_err();
        assert!(
            matches!(&error, StorageError::Absent { object } if object.ends_with("/results/gone")),
            "{error}"
        );
    }
}

#[test]
fn a_folder_that_is_not_there_has_no_campaign() {
    let address = StorageAddress::parse("file:///nowhere/at/all").unwrap();
    let options = StorageOptions { retry: Duration::ZERO, cancel: None };
    let error = Storage::open(&address, options).unwrap_err().to_string();
    assert!(
        error.contains("read file:///nowhere/at/all/bundle.zip: found no such object"),
        "{error}"
    );
}

#[test]
fn an_interrupt_does_not_keep_results_from_being_written() {
    static CANCEL: AtomicBool = AtomicBool::new(false);
    let folder = tempfile::tempdir().unwrap();
    let storage = in_folder(folder.path(), Some(&CANCEL));
    CANCEL.store(true, Ordering::Relaxed);
    for _ in 0..20 {
        assert!(matches!(
            storage.put_new("one", b"1").unwrap(),
            PutOutcome::New | PutOutcome::Same
        ));
        assert_eq!(storage.put_new("one", b"2").unwrap(), PutOutcome::Other(b"1".to_vec()));
    }
}

/// A service that accepts connections and never answers.
#[test]
fn an_interrupt_ends_reading() {
    static CANCEL: AtomicBool = AtomicBool::new(false);
    let folder = tempfile::tempdir().unwrap();
    let storage = in_folder(folder.path(), Some(&CANCEL));
    // A pipe that nobody writes: opening it waits.
    let pipe = folder.path().join("pipe");
    if !command("mkfifo").arg(&pipe).status().is_ok_and(|made| made.success()) {
        return;
    }
    let error = std::thread::scope(|scope| {
        scope.spawn(|| {
            std::thread::sleep(Duration::from_millis(100));
            CANCEL.store(true, Ordering::Relaxed);
        });
        storage.get("pipe").unwrap_err()
    });
    // The thread that waits for the pipe would keep the process from ending.
    drop(std::fs::File::options().write(true).open(&pipe).unwrap());
    assert!(matches!(error, StorageError::Interrupted { .. }), "{error}");
}

#[test]
fn a_failure_names_the_object() {
    let folder = tempfile::tempdir().unwrap();
    let storage = in_folder(folder.path(), None);
    std::fs::write(folder.path().join("results"), "in the way").unwrap();
    let error = storage.put_new("results/1-of-1/00000001.octres", b"x").unwrap_err().to_string();
    let begin =
        format!("write file://{}/results/1-of-1/00000001.octres: ", folder.path().display());
    assert!(error.starts_with(&begin), "{error}");
}
