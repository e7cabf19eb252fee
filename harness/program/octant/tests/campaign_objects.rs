//! Campaigns at an address: on object storage where the program is built with it, refused in plain words elsewhere.

use crate::common::program::{ended, octant_in};
use std::path::Path;
use tempfile::TempDir;

const SCENARIO: &str = "schema = 1
title = \"short\"
[procedure.calibration]
duration = \"20 s\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]
[procedure.navigation]
duration = \"5 s\"
";
const CAMPAIGN: &str = "schema = 1
title = \"stored\"
replicates = 6
[[scenarios]]
id = \"short\"
file = \"short.toml\"
";

/// A planned campaign in the folder `alone`.
fn planned() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.toml"), SCENARIO).unwrap();
    std::fs::write(folder.path().join("campaign.toml"), CAMPAIGN).unwrap();
    says(folder.path(), &["campaign", "plan", "campaign.toml", "--out", "alone"], 0);
    folder
}

/// Runs a command in a folder; returns stdout and stderr.
#[track_caller]
fn says(folder: &Path, arguments: &[&str], status: i32) -> String {
    let (out, error) = ended(octant_in(folder, arguments), status);
    out + &error
}

#[cfg(not(feature = "object-storage"))]
#[test]
fn a_program_without_object_storage_refuses_an_address() {
    let folder = planned();
    for command in [
        &["campaign", "run", "s3://bucket/cert"][..],
        &["campaign", "status", "file:///data/cert"],
        &["campaign", "bundle", "alone", "--out", "s3://bucket/cert"],
        &["verify", "s3://bucket/cert"],
    ] {
        let said = says(folder.path(), command, 2);
        assert!(said.contains("built without object storage, expected a folder"), "{said}");
    }
}

#[cfg(feature = "object-storage")]
mod with_storage {
    use super::{planned, says};
    use std::path::Path;

    const TABLES: [&str; 3] = ["cases.parquet", "checks.parquet", "drift.parquet"];

    fn tables(folder: &Path) -> Vec<Vec<u8>> {
        TABLES.iter().map(|table| std::fs::read(folder.join(table)).unwrap()).collect()
    }

    /// Addresses of a folder are the same thing without a service: `tests/rigs/objects` has one.
    #[test]
    fn a_campaign_at_an_address_is_that_of_a_folder() {
        let folder = planned();
        let at = folder.path();
        let stored = at.join("stored");
        let address = format!("file://{}", stored.display());
        let address = address.as_str();
        // Nothing is checked in it: inconclusive.
        says(at, &["campaign", "run", "alone", "--jobs", "1"], 3);
        says(at, &["campaign", "merge", "alone"], 0);
        let said = says(at, &["campaign", "bundle", "alone", "--out", address], 0);
        assert!(said.ends_with(&format!("{address}\n")), "{said}");
        assert_eq!(
            says(at, &["campaign", "merge", address], 3).lines().next(),
            Some("0 of 6 cases from 1 part, 6 without a result yet")
        );
        let part = ["campaign", "run", address, "--shard", "2/2", "--jobs", "1"];
        let said = says(at, &part, 3);
        assert!(said.contains("3 cases run, 0 with a result already"), "{said}");
        assert!(said.contains("3 records uploaded"), "{said}");
        assert!(stored.join("results/2-of-2/00000001.octres").exists());
        assert!(says(at, &part, 3).contains("0 cases run, 3 with a result already"));
        let any = ["campaign", "run", address, "--jobs", "1", "--any-verdict"];
        assert!(says(at, &any, 0).contains("3 cases run, 3 with a result already"));
        let said = says(at, &["campaign", "merge", address], 0);
        assert!(said.contains(&format!("{address}/cases.parquet")), "{said}");
        assert_eq!(tables(&stored), tables(&at.join("alone")));
        let status = ["campaign", "status", address];
        assert_eq!(says(at, &status, 3), says(at, &["campaign", "status", "alone"], 3));
        let said = says(at, &["campaign", "report", address], 3);
        assert!(said.contains(&format!("{address}/report.html")), "{said}");
        assert!(says(at, &["verify", address], 0).contains(address));
        says(at, &["campaign", "unbundle", address, "fetched"], 0);
        says(at, &["verify", "fetched"], 0);
    }

    #[test]
    fn options_of_the_other_place_are_refused() {
        let folder = planned();
        let address = format!("file://{}", folder.path().join("stored").display());
        says(folder.path(), &["campaign", "bundle", "alone", "--out", &address], 0);
        let run = ["campaign", "run", "alone"];
        let emit = ["campaign", "emit", "k8s", "--shards", "2"];
        let one = |words: &[&str], more: &[&str]| -> String {
            says(folder.path(), &[words, more].concat(), 2)
        };
        assert!(one(&run, &["--work", "w"]).contains("--work: found the folder alone"));
        assert!(one(&run, &["--upload-every", "0.5"]).contains("--upload-every: found the folder"));
        assert!(one(&run, &["--upload-every", "0"]).contains("from 0.1 to 3600"));
        assert!(one(&emit, &["/data/x", "--secret", "s"]).contains("--secret: found /data/x"));
        assert!(one(&emit, &["s3://b/x", "--claim", "c"]).contains("--claim: found s3://b/x"));
        assert!(one(&emit, &[&address]).contains("expected s3://BUCKET/PREFIX"));
        let said = one(&["campaign", "status"], &["gs://bucket/x"]);
        assert!(said.contains("found the scheme \"gs\""), "{said}");
        let said = one(&["campaign", "status"], &["file:///nowhere/at/all"]);
        assert!(said.contains("file:///nowhere/at/all/bundle.zip: found no such object"), "{said}");
    }
}
