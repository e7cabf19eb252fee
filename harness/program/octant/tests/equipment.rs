//! Certificates of the bench's equipment: compared with the run's own day, in its summary, and with
//! a permanent result.

use crate::chain::TOO_NEAR;
use crate::common::program::{octant_in, program};
use serde_json::{Value, json};
use std::path::Path;
use tempfile::TempDir;

const TABLE: &str = "[[equipment]]\nname = \"turntable\"\nserial = \"17\"\ncertificate = \"K-4\"\n";

/// Makes a run with a table whose certificate is valid until a day; returns its exit status too.
fn run(expires: &str, requirement: &str) -> (TempDir, i32, String) {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "schema = 1\ntitle = \"t\"\nseed = 3\n[procedure.calibration]\npositions = \"eight\"\n\
         duration = \"24 min\"\n[procedure.navigation]\nduration = \"1 min\"\n\
         {TABLE}expires = {expires}\n{requirement}"
    );
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let output = octant_in(folder.path(), &["run", "s.toml", "--out", "run"]);
    let said =
        String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
    (folder, output.status.code().unwrap(), said)
}

fn read(folder: &Path, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join(name)).unwrap()).unwrap()
}

const MET: &str = "[[requirements]]\nid = \"NAV-1\"\ntext = \"x\"\n\
    measure = \"navigation.radial_error_nmi.max\"\nlimit = \"100 nmi\"\n";

#[test]
fn what_was_measured_with_an_expired_certificate_shows_nothing() {
    // Neither a met nor a violated limit is shown.
    for requirement in [MET, TOO_NEAR] {
        let (folder, status, said) = run("\"2020-02-29\"", requirement);
        assert_eq!(status, 3, "{said}");
        let run = folder.path().join("run");
        let summary = read(&run, "summary.json");
        assert_eq!(summary["verdict"], "inconclusive");
        assert_eq!(summary["requirements"][0]["verdict"], "inconclusive");
        let reasons = summary["reasons"].to_string();
        for told in ["turntable", "17", "K-4", "until 2020-02-29"] {
            assert!(reasons.contains(told) && said.contains(told), "{told}: {reasons} {said}");
        }
        let manifest = read(&run, "manifest.json");
        assert_eq!(
            manifest["equipment"],
            json!([{ "name": "turntable", "serial": "17", "certificate": "K-4", "expires": "2020-02-29" }])
        );
        let verified = program(&["verify", run.to_str().unwrap()]).output().unwrap();
        assert_eq!(verified.status.code(), Some(0), "{verified:?}");
        // Judged again, the verdict is the same: by the day of its manifest, not by today's.
        let output = program(&["rejudge", run.to_str().unwrap(), "--json"]).output().unwrap();
        let again: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(output.status.code(), Some(3));
        assert_eq!(again["judged"][0]["reasons_now"], again["judged"][0]["reasons_then"]);
    }
    let (folder, status, said) = run("\"2999-12-31\"", MET);
    assert_eq!(status, 0, "{said}");
    assert_eq!(
        read(&folder.path().join("run"), "manifest.json")["equipment"][0]["certificate"],
        "K-4"
    );
}

/// The stored files are edited, and the manifest is made again.
#[test]
fn a_certificate_that_was_made_longer_is_found() {
    let (folder, _, _) = run("\"2020-02-29\"", MET);
    let run = folder.path().join("run");
    let edit = |name: &str, from: &str, to: &str| {
        let path = run.join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{name} has no {from}");
        std::fs::write(&path, text.replace(from, to)).unwrap();
    };
    let anew = || {
        use octant_evidence::Manifest;
        use sha2::{Digest, Sha256};
        let mut manifest = Manifest::read(&run).unwrap();
        for file in &mut manifest.files {
            let bytes = std::fs::read(run.join(&file.path)).unwrap();
            file.bytes = bytes.len() as u64;
            file.blake3 = blake3::hash(&bytes).to_hex().to_string();
            file.sha256 = Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
        }
        std::fs::write(run.join("manifest.json"), serde_json::to_string(&manifest).unwrap())
            .unwrap();
    };
    let verify = || {
        let output = program(&["verify", run.to_str().unwrap()]).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    anew();
    assert_eq!(verify().0, 0);
    // Edited in the manifest alone.
    let manifest = std::fs::read_to_string(run.join("manifest.json")).unwrap();
    edit("manifest.json", "2020-02-29", "2999-12-31");
    let (status, said) = verify();
    assert!(status == 1 && said.contains("isn't that of scenario.toml"), "{said}");
    std::fs::write(run.join("manifest.json"), &manifest).unwrap();
    // The finding is removed from the summary, with everything derived from it.
    let mut summary = read(&run, "summary.json");
    summary["findings"] = json!([]);
    summary["reasons"] = json!([]);
    summary["verdict"] = "pass".into();
    summary["requirements"][0]["verdict"] = "pass".into();
    summary["requirements"][0]["reason"] = Value::Null;
    std::fs::write(run.join("summary.json"), summary.to_string()).unwrap();
    anew();
    let (status, said) = verify();
    assert!(
        status == 1 && said.contains("summary.json: it doesn't tell that certificate K-4"),
        "{said}"
    );
    // Judged again, the certificate decides.
    let output = program(&["rejudge", run.to_str().unwrap()]).output().unwrap();
    assert_eq!(output.status.code(), Some(3), "{output:?}");
}

#[test]
fn a_day_that_is_none_is_refused_with_file_and_field() {
    for bad in ["\"2027-02-30\"", "\"31.03.2027\"", "\"soon\"", "\"\"", "2027"] {
        let (_folder, status, said) = run(bad, "");
        assert!(status == 2, "{bad}: {status} {said}");
        assert!(
            said.contains("s.toml") && said.contains("equipment") && said.contains("expires"),
            "{said}"
        );
    }
    let (_folder, status, said) = run(
        "\"2999-12-31\"",
        "[[equipment]]\nname = \"turntable\"\nserial = \"17\"\ncertificate = \" \"\nexpires = \"2999-12-31\"\n",
    );
    assert!(status == 2 && said.contains("certificate"), "{said}");
}

#[test]
fn cases_of_a_campaign_have_no_day() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = format!(
        "schema = 1\n[procedure.calibration]\npositions = \"eight\"\nduration = \"24 min\"\n\
         {TABLE}expires = \"2999-12-31\"\n"
    );
    std::fs::write(folder.path().join("s.toml"), scenario).unwrap();
    std::fs::write(
        folder.path().join("c.toml"),
        "schema = 1\ntitle = \"c\"\nreplicates = 2\n[[scenarios]]\nid = \"s\"\nfile = \"s.toml\"\n",
    )
    .unwrap();
    let output = octant_in(folder.path(), &["campaign", "plan", "c.toml", "--out", "c"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.code() == Some(2) && said.contains("expected no [[equipment]]"),
        "{said}"
    );
}
