//! Links and other things that somebody plants in the folder of a run: nothing outside is read, written or removed.

use octant_operator::journal;
use octant_operator::mailbox::{self, DeskReply, DeskRequest, FOLDER, Mailbox, MailboxError};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;

const REQUEST: &str = r#"{"do":"abort","by":"Mallory"}"#;

/// A run's folder with its mailbox, and a file outside of it.
struct Bench {
    run: tempfile::TempDir,
    outside: tempfile::TempDir,
    open: Mailbox,
}

impl Bench {
    fn new() -> Self {
        let (run, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        std::fs::write(outside.path().join("secret"), REQUEST).unwrap();
        let open = Mailbox::open(run.path()).unwrap();
        Self { run, outside, open }
    }

    fn secret(&self) -> PathBuf {
        self.outside.path().join("secret")
    }

    fn mail(&self, name: &str) -> PathBuf {
        self.run.path().join(FOLDER).join(name)
    }

    /// Serves without a request that counts; returns what is told.
    #[track_caller]
    fn refuses(&self) -> Vec<String> {
        let told = self.open.serve(|request| panic!("{request:?} came from outside"));
        assert_eq!(std::fs::read_to_string(self.secret()).unwrap(), REQUEST, "it was altered");
        told
    }
}

fn pipe(path: &Path) {
    assert!(octant_test_processes::command("mkfifo").arg(path).status().unwrap().success());
}

#[test]
fn a_request_that_is_no_regular_file_is_refused_and_told() {
    let bench = Bench::new();
    symlink(bench.secret(), bench.mail("ask-1")).unwrap();
    pipe(&bench.mail("ask-2"));
    std::fs::create_dir(bench.mail("ask-3")).unwrap();
    std::fs::write(bench.mail("ask-4"), vec![b' '; 1 << 17]).unwrap();
    let told = bench.refuses();
    assert_eq!(told.len(), 4, "{told:?}");
    for (name, why) in [
        ("ask-1", "it is a link, expected a regular file"),
        ("ask-2", "it is a FIFO, expected a regular file"),
        ("ask-3", "found no request of an operator"),
        ("ask-4", "it is longer than 65536 bytes"),
    ] {
        assert!(told.iter().any(|line| line.contains(name) && line.contains(why)), "{told:?}");
    }
    // An entry that can't be removed is reported once.
    assert!(bench.refuses().is_empty());
}

#[test]
fn a_reply_is_written_through_no_link() {
    let bench = Bench::new();
    std::fs::write(bench.mail("ask-1"), REQUEST).unwrap();
    symlink(bench.secret(), bench.mail(".told-1")).unwrap();
    let told = bench.open.serve(|_| DeskReply::Taken("aborted".to_owned()));
    assert!(told.len() == 1 && told[0].contains("its reply can't be written"), "{told:?}");
    assert_eq!(std::fs::read_to_string(bench.secret()).unwrap(), REQUEST);
    // A link under the name of the reply itself is replaced.
    std::fs::write(bench.mail("ask-2"), REQUEST).unwrap();
    symlink(bench.secret(), bench.mail("told-2")).unwrap();
    assert!(bench.open.serve(|_| DeskReply::Taken("aborted".to_owned())).is_empty());
    assert_eq!(std::fs::read_to_string(bench.secret()).unwrap(), REQUEST);
    assert!(std::fs::symlink_metadata(bench.mail("told-2")).unwrap().is_file());
    std::fs::remove_file(bench.mail("told-2")).unwrap();
}

#[test]
fn a_folder_that_a_link_replaced_is_neither_read_nor_emptied() {
    let bench = Bench::new();
    let folder = bench.run.path().join(FOLDER);
    std::fs::rename(&folder, bench.run.path().join("aside")).unwrap();
    symlink(bench.outside.path(), &folder).unwrap();
    std::fs::write(bench.outside.path().join("ask-1"), REQUEST).unwrap();
    assert!(bench.refuses().is_empty(), "the folder that was made is served");
    assert!(bench.outside.path().join("ask-1").exists());
    // The other process refuses it too.
    let hold = DeskRequest::Hold { by: "Ada".to_owned() };
    let error = mailbox::request(bench.run.path(), &hold, Duration::ZERO).unwrap_err();
    assert!(matches!(error, MailboxError::System { .. }), "{error}");
    assert!(error.to_string().contains("it is a link, expected a folder"), "{error}");
    let outside = bench.outside;
    drop(bench.open);
    assert!(outside.path().join("ask-1").exists() && outside.path().join("secret").exists());
}

#[test]
fn neither_a_planted_mailbox_nor_a_linked_journal_is_used() {
    let (run, outside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    symlink(outside.path(), run.path().join(FOLDER)).unwrap();
    assert!(matches!(Mailbox::open(run.path()), Err(MailboxError::System { .. })));
    symlink("/dev/zero", run.path().join(journal::FILE_NAME)).unwrap();
    let error = journal::read(run.path()).unwrap_err().to_string();
    assert!(error.contains("it is a link, expected a regular file"), "{error}");
}
