//! `octant requirements convert` and `check` on files of other tools.

use crate::common::program::{ended, octant_in};
use std::path::Path;

const SAMPLES: &str =
    concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/requirements/dialects");

const MAPPING: &str = "schema = 1\n[attributes]\nmeasure = \"Octant Measure\"\nlimit = \"Octant Limit\"\n\
                       verification = \"Verification Method\"\n[values.verification]\nReview = \"inspection\"\n";

fn convert(folder: &Path, arguments: &[&str], status: i32) -> String {
    let all: Vec<&str> = ["requirements", "convert"].iter().chain(arguments).copied().collect();
    ended(octant_in(folder, &all), status).1
}

#[test]
fn a_file_of_doors_is_converted_with_a_mapping_and_what_is_missing_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("m.toml"), MAPPING).unwrap();
    let from = format!("{SAMPLES}/doors.reqif");
    // Two objects have no text or no id: the file is written, and not complete.
    let said = convert(path, &[&from, "r.toml", "--mapping", "m.toml"], 3);
    assert!(said.contains("the object _d5 has no text: it is left out"), "{said}");
    assert!(said.contains("doors.reqif: 7 objects read, 4 used, 3 left out"), "{said}");
    assert!(
        said.contains("octant:   left out: 1 without a text, the first _d5 in line "),
        "{said}"
    );
    assert!(said.contains("2 requirements could not be read: the file is not complete"), "{said}");
    let (said, _) = ended(octant_in(path, &["requirements", "check", "r.toml"]), 3);
    assert_eq!(said, "r.toml: 3 requirements, 1 by test, 0 by analysis, 1 by inspection, 1 open\n");
    // An existing file is overwritten only by request.
    let said = convert(path, &[&from, "r.toml"], 2);
    assert!(said.contains("failed to write r.toml: the file exists already; --force"), "{said}");
    convert(path, &[&from, "r.toml", "--force"], 3);
    let (said, _) = ended(octant_in(path, &["requirements", "check", "r.toml"]), 3);
    assert!(said.contains("3 requirements, 0 by test"), "{said}");
    // Each step of a round names what it can't keep, and the file at its end is whole.
    let said = convert(path, &["r.toml", "r.reqifz"], 3);
    assert!(said.contains("only .toml keeps the accounts of the documents before it"), "{said}");
    convert(path, &["r.reqifz", "again.toml"], 0);
    let without_accounts = |name: &str| {
        let text = std::fs::read_to_string(path.join(name)).unwrap();
        text.split("\n[[accounts]]").next().unwrap().to_owned()
    };
    assert_eq!(without_accounts("again.toml"), without_accounts("r.toml"));
    let said = convert(path, &["r.reqifz", "needs.json"], 0);
    assert!(said.contains("needs.json: the formatting of texts is left out: 3"), "{said}");
    assert!(convert(path, &["r.toml", "r.docx"], 2).contains("expected a file that ends in .toml"));
    std::fs::write(path.join("cut.reqifz"), b"PK\x03\x04").unwrap();
    let said = convert(path, &["cut.reqifz", "x.toml"], 2);
    assert!(said.contains("cut.reqifz: not a readable ZIP archive"), "{said}");
    assert!(!path.join("x.toml").exists());
}

#[test]
fn a_measure_that_no_run_has_is_told_when_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("m.toml"), MAPPING).unwrap();
    let text = std::fs::read_to_string(format!("{SAMPLES}/doors.reqif")).unwrap();
    let text = text.replace("navigation.marks.24h.longitude_max_arcmin", "navigation.longitude");
    std::fs::write(path.join("d.reqif"), text).unwrap();
    let said = convert(path, &["d.reqif", "r.toml", "--mapping", "m.toml"], 3);
    assert!(said.contains("octant: d.reqif: 3: ") && said.contains("longitude"), "{said}");
}
