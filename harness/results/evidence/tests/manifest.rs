//! Manifests.

use octant_evidence::manifest::{FILE_NAME, FolderDifference};
use octant_evidence::{Manifest, RunFacts};
use std::time::SystemTime;

fn facts() -> RunFacts {
    let (began, length) = (SystemTime::UNIX_EPOCH, std::time::Duration::from_millis(86_400_250));
    RunFacts {
        seed: Some(7),
        command_line: ["octant", "run", "my run.toml", "--set", "imu.x='1 ug'"]
            .map(String::from)
            .to_vec(),
        ..RunFacts::between(began, began + length)
    }
}

#[test]
fn a_report_shows_where_a_run_comes_from() {
    let folder = tempfile::tempdir().unwrap();
    let manifest = Manifest::write(folder.path(), &facts()).unwrap();
    let entries = manifest.entries();
    let names: Vec<&str> = entries.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "octant",
            "numerics version",
            "source revision",
            "program, SHA-256",
            "compiler",
            "host",
            "operator",
            "started",
            "ended",
            "signature"
        ]
    );
    let value = |name: &str| entries.iter().find(|(n, _)| n == name).unwrap().1.as_str();
    assert_eq!(value("octant"), env!("CARGO_PKG_VERSION"));
    assert_eq!(value("ended"), "1970-01-02T00:00:00.250Z");
    assert_eq!(value("signature"), "unsigned");
}

#[test]
fn a_manifest_has_the_hashes_and_finds_every_change() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.txt"), "abc").unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    std::fs::write(folder.path().join("sub/b.txt"), "").unwrap();
    let written = Manifest::write(folder.path(), &facts()).unwrap();
    let manifest = Manifest::read(folder.path()).unwrap();
    assert_eq!(manifest, written);
    // FIPS 180-4 and the BLAKE3 paper give these for "abc".
    assert_eq!(
        manifest.files[0].sha256,
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    );
    assert_eq!(
        manifest.files[0].blake3,
        "6437b3ac38465133ffb63b75273a8db548c558465d79db03fd359c6cd5bd9d85"
    );
    assert_eq!(manifest.files[1].path, "sub/b.txt");
    assert_eq!(manifest.ended, "1970-01-02T00:00:00.250Z");
    assert_eq!(manifest.rerun, r"octant run 'my run.toml' --set 'imu.x='\''1 ug'\'''");
    let text = std::fs::read_to_string(folder.path().join(FILE_NAME)).unwrap();
    assert!(text.contains("\"signature\": null"));

    assert!(manifest.verify(folder.path()).unwrap().is_empty());
    std::fs::write(folder.path().join("a.txt"), "abd").unwrap();
    std::fs::remove_file(folder.path().join("sub/b.txt")).unwrap();
    std::fs::write(folder.path().join("c.txt"), "").unwrap();
    assert_eq!(
        manifest.verify(folder.path()).unwrap(),
        [
            FolderDifference::Changed("a.txt".into()),
            FolderDifference::Missing("sub/b.txt".into()),
            FolderDifference::Unknown("c.txt".into()),
        ]
    );
}

#[test]
fn a_manifest_of_another_version_is_refused_by_its_version() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(FILE_NAME), r#"{"schema": 2, "all": "new"}"#).unwrap();
    let error = Manifest::read(folder.path()).unwrap_err().to_string();
    assert!(error.contains("schema 2, this octant reads 1"), "{error}");
}
