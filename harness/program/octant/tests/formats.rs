//! Stored formats of earlier versions: each is read, and a newer one is refused in plain words.
//!
//! The samples are in `fixtures/formats`, as the program once wrote them.

use crate::common::program::program;
use octant_calibration::table::CalibrationTable;
use octant_campaign::execute::Shard;
use octant_campaign::execute::case::CaseResult;
use octant_campaign::judge::status;
use octant_campaign::merge;
use octant_campaign::plan::Plan;
use octant_campaign::plan::requirements;
use octant_campaign::store::{CampaignResults, file};
use octant_campaign::table::{ColumnKind, ColumnValue, ExistingTable};
use octant_dispatch::bundle::unpack::unpack;
use octant_evidence::manifest::Manifest;
use octant_evidence::signature::{self, SigningKey};
use octant_recorder::reader::{Item, Recording};
use octant_scenario::Scenario;
use octant_scenario::campaign::Campaign;
use octant_score::summary::Summary;
use octant_verdict::Verdict;
use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const KEY: &str = "key.pub";
const WRITTEN: [&str; 3] = ["short.toml", "campaign.toml", "requirements.toml"];

fn samples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../fixtures/formats")
}

fn sample(name: &str) -> PathBuf {
    samples().join(name)
}

/// Makes a copy of a sample's text with one piece of it changed, and returns its folder too.
fn changed(name: &str, from: &str, to: &str) -> (TempDir, PathBuf) {
    let text = std::fs::read_to_string(sample(name)).unwrap();
    assert!(text.contains(from), "{name} has no {from:?}");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(Path::new(name).file_name().unwrap());
    std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
    (folder, path)
}

/// Checks that a refusal names the version found and the one supported, and that nothing else went
/// wrong.
fn assert_refused(refusal: &str) {
    let has =
        |number: &str| refusal.split(|c: char| !c.is_ascii_digit()).any(|word| word == number);
    assert!(has("2") && has("1"), "{refusal}");
    let plain = ["version", "schema"].iter().any(|word| refusal.contains(word));
    assert!(plain, "{refusal}");
    for alien in ["missing field", "unknown key", "unknown field", "invalid type"] {
        assert!(!refusal.contains(alien), "{refusal}");
    }
}

#[test]
fn a_scenario() {
    let scenario = Scenario::load(&sample("short.toml"), &[]).unwrap();
    assert_eq!((scenario.title.as_str(), scenario.seed), ("a short run", 7));
    assert_eq!(scenario.sample_period_ns, 50_000_000);
    assert_eq!(scenario.faults[0].spec.id, "spike-1");
    // As resolved by a run: the same run.
    let resolved = Scenario::load(&sample("run/scenario.toml"), &[]).unwrap();
    assert_eq!(resolved.samples(), scenario.samples());
    assert_eq!(resolved.requirements, scenario.requirements);

    let (_folder, newer) = changed("short.toml", "schema = 1", "schema = 2");
    assert_refused(&Scenario::load(&newer, &[]).unwrap_err().to_string());
}

#[test]
fn a_campaign_and_its_requirements() {
    let campaign = Campaign::load(&sample("campaign.toml")).unwrap();
    assert_eq!((campaign.seed, campaign.replicates, campaign.factors.len()), (Some(3), 2, 1));
    let read = requirements::load(&sample("requirements.toml")).unwrap();
    let demand = read.get("NAV-2").unwrap().check().unwrap().ensemble.unwrap();
    assert_eq!((demand.pass, demand.confidence), (0.5, 0.6));
    assert!(read.get("SYS-1").unwrap().check().is_none());

    let (_folder, newer) = changed("campaign.toml", "schema = 1", "schema = 2");
    assert_refused(&Campaign::load(&newer).unwrap_err().to_string());
    let (_folder, newer) = changed("requirements.toml", "schema = 1", "schema = 2");
    assert_refused(&requirements::load(&newer).unwrap_err().to_string());
}

#[test]
fn a_summary() {
    let summary =
        Summary::from_json(&std::fs::read_to_string(sample("run/summary.json")).unwrap()).unwrap();
    assert_eq!((summary.scenario.as_str(), summary.seed), ("a short run", 7));
    assert_eq!(summary.verdict, Verdict::Pass);
    assert_eq!(summary.requirements[0].id, "NAV-1");
    assert!(summary.requirements[0].value.unwrap() < 10.0);
    assert!(summary.faults[0].fired);
    assert_eq!(summary.calibration.unwrap().parameters.len(), 30);
    assert_eq!(summary.navigation.unwrap().duration_h, 1.0 / 6.0);
    assert_eq!(summary.stream_hash.len(), 64);

    let newest = octant_score::summary::SCHEMA;
    let next = format!("\"schema\": {}", newest + 1);
    let (_folder, newer) = changed("run/summary.json", "\"schema\": 1", &next);
    let text = std::fs::read_to_string(newer).unwrap();
    let refusal = Summary::from_json(&text).unwrap_err().to_string();
    let expected = format!("schema {} found, 1 to {newest} expected", newest + 1);
    assert!(refusal.contains(&expected), "{refusal}");
}

/// Null in the place of a number is NaN. The programs before schema 3 wrote it, and couldn't read it.
#[test]
fn a_summary_with_a_number_that_is_not_finite() {
    let (_folder, path) =
        changed("run/summary.json", "\"estimate\": ", "\"estimate\": null, \"was\": ");
    let text = std::fs::read_to_string(path).unwrap();
    let mut summary = Summary::from_json(&text).unwrap();
    let parameters = &summary.calibration.as_ref().unwrap().parameters;
    assert_eq!(parameters.values().filter(|one| one.estimate.is_nan()).count(), 1);
    assert_eq!(summary.needed_schema().unwrap(), octant_score::summary::NOT_FINITE);
    summary.calibration = None;
    assert_eq!(summary.needed_schema().unwrap(), octant_score::summary::WITH_FINDINGS);
}

#[test]
fn a_calibration_table() {
    let bytes = std::fs::read(sample("run/calibration.octcal")).unwrap();
    let table = CalibrationTable::from_bytes(&bytes).unwrap();
    let summary = std::fs::read_to_string(sample("run/summary.json")).unwrap();
    let summary = Summary::from_json(&summary).unwrap().calibration.unwrap();
    for (i, name) in octant_sample::parameters::NAMES.iter().enumerate() {
        let si = octant_sample::parameters::ParameterGroup::of(i).si_per_unit();
        let estimate = table.parameters.to_array()[i] / si;
        let expected = summary.parameters[*name].estimate;
        assert!((estimate - expected).abs() <= 1e-12 * expected.abs(), "{name}");
    }
    assert_eq!(table.provenance.duration_s, 24.0 * 60.0);

    // The present version is 2; two bytes of it follow the magic number.
    let mut newer = bytes;
    newer[6] = 3;
    let refusal = CalibrationTable::from_bytes(&newer).unwrap_err().to_string();
    assert!(refusal.contains("version 3") && refusal.contains('2'), "{refusal}");
}

#[test]
fn a_recording() {
    let path = sample("run/recording.mcap");
    let mut recording = Recording::open(&path).unwrap();
    assert_eq!(recording.info().version, 1);
    assert_eq!(recording.info().run["seed"], "7");
    let scenario =
        Scenario::parse(&recording.info().scenario, "recording", Path::new(""), &[]).unwrap();
    assert_eq!(scenario.title, "a short run");
    let (mut truths, mut outputs, mut parameters, mut last) = (0, 0, 0, 0);
    while let Some((_, item)) = recording.next_item().unwrap() {
        match item {
            Item::Truth(_) => truths += 1,
            Item::Output(output) => {
                outputs += 1;
                last = output.device_time.ns;
            }
            Item::Parameters(_, estimate) => {
                parameters += 1;
                assert!(estimate.parameters.to_array().iter().all(|p| p.is_finite()));
            }
            _ => {}
        }
    }
    assert!(!recording.truncated());
    // 34 min, a record every 20 s.
    assert!(truths >= 102 && outputs >= 102 && parameters >= 12, "{truths} {outputs} {parameters}");
    assert_eq!(last, 34 * 60 * 1_000_000_000);

    // The format's version is text in a metadata record, which has no checksum of its own.
    let mut bytes = std::fs::read(&path).unwrap();
    patch(&mut bytes, b"\x07\0\0\0version\x01\0\0\x001", b'2');
    let error = Recording::new(bytes.as_slice()).map(|_| ()).unwrap_err();
    assert_refused(&error.to_string());
}

/// Changes the byte at the end of the first occurrence of a piece.
fn patch(bytes: &mut [u8], piece: &[u8], to: u8) {
    let at = bytes.windows(piece.len()).position(|window| window == piece).unwrap();
    bytes[at + piece.len() - 1] = to;
}

#[test]
fn a_manifest_with_its_signature() {
    let folder = sample("run");
    let manifest = Manifest::read(&folder).unwrap();
    assert_eq!((manifest.seed, manifest.host.name.as_str()), (Some(7), "bench"));
    assert_eq!(manifest.verify(&folder).unwrap(), []);
    let names: Vec<&str> = manifest.files.iter().map(|file| file.path.as_str()).collect();
    for name in ["recording.mcap", "scenario.toml", "summary.json"] {
        assert!(names.contains(&name), "{names:?}");
    }
    let key = sample(KEY).display().to_string();
    let signed_by = signature::verify(&folder.join("manifest.json"), &key).unwrap();
    assert_eq!(manifest.signature, Some(format!("minisign key {signed_by}")));

    let (newer, _) = changed("run/manifest.json", "\"schema\": 1", "\"schema\": 2");
    assert_refused(&Manifest::read(newer.path()).unwrap_err().to_string());
}

#[test]
fn a_plan_and_the_results_of_its_cases() {
    let plan = Plan::read(&sample("campaign/plan.json")).unwrap();
    assert_eq!((plan.title.as_str(), plan.cases.len()), ("four short runs", 4));
    assert_eq!(plan.not_by_test, ["SYS-1"]);
    assert_eq!(plan.requirements[0].check.id, "NAV-2");
    let folder = sample("campaign");
    for case in &plan.cases {
        let result = CaseResult::read(&file(&folder, &case.id)).unwrap();
        assert_eq!((result.verdict, result.case.as_str()), (Verdict::Pass, case.id.as_str()));
        assert_eq!(result.summary.unwrap().seed, case.seed);
    }
    let status = status::of(&plan, &folder, Shard::WHOLE).unwrap();
    assert_eq!((status.cases, status.open, status.verdict()), (4, 0, Verdict::Pass));

    let (_folder, newer) = changed("campaign/plan.json", "\"schema\": 1", "\"schema\": 2");
    assert_refused(&Plan::read(&newer).unwrap_err().to_string());
    let id = plan.cases[0].id.as_str();
    let name = format!("campaign/cases/{}/{id}.json", &id[..2]);
    let (_folder, newer) = changed(&name, "\"schema\":1", "\"schema\":4");
    let refusal = CaseResult::read(&newer).unwrap_err().to_string();
    assert!(
        refusal.contains('4') && refusal.contains('3') && refusal.contains("version"),
        "{refusal}"
    );
}

/// The folder was made from the bundle, and has run.
#[test]
fn a_bundle_and_results_in_a_part() {
    let bundle = sample("bundle.zip");
    let folder = tempfile::tempdir().unwrap();
    let unpacked = folder.path().join("unpacked");
    let contents = unpack(&bundle, &unpacked).unwrap();
    assert_eq!((contents.schema, contents.files.len()), (1, 4));
    let parts = sample("parts");
    let plan = Plan::read(&parts.join("plan.json")).unwrap();
    assert_eq!(Plan::read(&unpacked.join("plan.json")).unwrap().id, plan.id);
    let stored = CampaignResults::open(&parts).unwrap();
    for case in &plan.cases {
        let (result, _) = stored.result(&case.id).unwrap().unwrap();
        assert_eq!((result.verdict, result.case.as_str()), (Verdict::Pass, case.id.as_str()));
        assert_eq!(result.summary.unwrap().seed, case.seed);
    }
    let status = status::of(&plan, &parts, Shard::WHOLE).unwrap();
    assert_eq!((status.cases, status.open, status.verdict()), (4, 0, Verdict::Pass));

    let mut archive = ZipArchive::new(File::open(&bundle).unwrap()).unwrap();
    let newer = folder.path().join("newer.zip");
    let mut out = ZipWriter::new(File::create(&newer).unwrap());
    for index in 0..archive.len() {
        let mut entry = archive.by_index(index).unwrap();
        let name = entry.name().unwrap().into_owned();
        let mut text = String::new();
        entry.read_to_string(&mut text).unwrap();
        if name == "bundle.json" {
            text = text.replacen("\"schema\": 1", "\"schema\": 2", 1);
        }
        out.start_file(name, SimpleFileOptions::default()).unwrap();
        out.write_all(text.as_bytes()).unwrap();
    }
    out.finish().unwrap();
    assert_refused(&unpack(&newer, &folder.path().join("newer")).unwrap_err().to_string());

    // The version of a part follows its magic number, and the first bytes of the hash of both come next.
    let name =
        std::fs::read_dir(parts.join("results")).unwrap().next().unwrap().unwrap().file_name();
    let mut bytes = std::fs::read(parts.join("results").join(&name)).unwrap();
    bytes[8] = 3;
    let hash = *blake3::hash(&bytes[..12]).as_bytes();
    bytes[12..16].copy_from_slice(&hash[..4]);
    let newer = folder.path().join("newer");
    std::fs::create_dir_all(newer.join("results")).unwrap();
    std::fs::write(newer.join("results").join(&name), bytes).unwrap();
    assert_refused(&CampaignResults::open(&newer).unwrap_err().to_string());
}

#[test]
fn tables() {
    let plan = Plan::read(&sample("campaign/plan.json")).unwrap();
    let path = |table: &str| merge::merged(&sample("campaign"), table);
    let cases = ExistingTable::open(&path("cases")).unwrap();
    assert_eq!((cases.rows, &cases.plan), (4, &plan.id));
    let kind = |name: &str| {
        let column = cases.columns.iter().find(|(column, _)| column == name);
        column.map(|(_, kind)| *kind)
    };
    assert_eq!(kind("seed"), Some(ColumnKind::Integer));
    assert_eq!(kind("navigation.latitude_error_arcmin.max"), Some(ColumnKind::Number));
    let ids = cases.column("case").unwrap().unwrap();
    for (row, case) in plan.cases.iter().enumerate() {
        assert_eq!(ids.at(row), Some(ColumnValue::Text(case.id.as_str().into())));
    }
    let checks = ExistingTable::open(&path("checks")).unwrap();
    assert_eq!(checks.rows, 8, "two requirements of each case");
    let drift = ExistingTable::open(&path("drift")).unwrap();
    assert!(drift.rows > 40 && drift.column("hours").unwrap().is_some());

    // The version is text in the footer of a Parquet file, which has no checksum.
    let mut bytes = std::fs::read(path("cases")).unwrap();
    patch(&mut bytes, b"octant.schema\x18\x011", b'3');
    let folder = tempfile::tempdir().unwrap();
    let newer = folder.path().join("cases.parquet");
    std::fs::write(&newer, bytes).unwrap();
    assert_refused(&ExistingTable::open(&newer).unwrap_err().to_string());
}

/// Writes samples of the present version into the folder that `OCTANT_FORMATS` names.
#[test]
#[ignore = "makes samples of a new version"]
fn make() {
    let out = PathBuf::from(std::env::var("OCTANT_FORMATS").unwrap());
    std::fs::create_dir_all(&out).unwrap();
    for name in WRITTEN {
        std::fs::copy(sample(name), out.join(name)).unwrap();
    }
    let octant = |arguments: &[&str]| {
        let mut command = program(arguments);
        command.current_dir(&out).env("OCTANT_OPERATOR", "an operator").env_remove(signature::KEY);
        assert!(command.status().unwrap().success(), "{arguments:?}");
    };
    octant(&["run", "short.toml", "--out", "run"]);
    octant(&["campaign", "plan", "campaign.toml", "--out", "campaign"]);
    octant(&["campaign", "run", "campaign"]);
    octant(&["campaign", "merge", "campaign"]);
    octant(&["campaign", "bundle", "campaign", "--out", "bundle.zip"]);
    octant(&["campaign", "unbundle", "bundle.zip", "parts"]);
    octant(&["campaign", "run", "parts", "--jobs", "1"]);

    let run = out.join("run");
    let pair = minisign::KeyPair::generate_unencrypted_keypair().unwrap();
    let secret = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(secret.path(), pair.sk.to_box(None).unwrap().to_string()).unwrap();
    std::fs::write(out.join(KEY), pair.pk.to_box().unwrap().to_string()).unwrap();
    let key = SigningKey::read(secret.path(), None).unwrap();
    // Without facts of the host, and without the report, which is large and isn't read again.
    let mut manifest = Manifest::read(&run).unwrap();
    std::fs::remove_file(run.join("report.html")).unwrap();
    manifest.files.retain(|file| file.path != "report.html");
    manifest.host.name = "bench".to_owned();
    manifest.host.cpu = None;
    manifest.signature = Some(format!("minisign key {}", key.id()));
    let text = serde_json::to_string_pretty(&manifest).unwrap() + "\n";
    std::fs::write(run.join("manifest.json"), text).unwrap();
    key.sign(&run.join("manifest.json")).unwrap();
}
