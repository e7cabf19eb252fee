//! Bundles that are made, and run where none of their files was.

use super::bench::{Bench, SCENARIO, core, entries, names};
use crate::common::program::{ends, json};
use octant_campaign::plan::Plan;
use octant_dispatch::bundle::contents::{BundleContents, SCHEMA};
use octant_test_processes::command;
use std::path::{Path, PathBuf};

#[test]
fn a_bundle_runs_where_no_file_of_its_campaign_is() {
    let bench = Bench::new(core(), true);
    bench.octant(&["campaign", "run", "cert", "--jobs", "2"], 0);
    bench.octant(&["campaign", "merge", "cert"], 0);
    let expected = bench.tables("cert");
    let bundle = bench.bundled();
    let bytes = std::fs::read(&bundle).unwrap();
    std::fs::create_dir(bench.at("medium")).unwrap();
    std::fs::rename(&bundle, bench.at("medium/cert.zip")).unwrap();
    // Nothing of the planning computer is left.
    std::fs::remove_dir_all(bench.at("plan")).unwrap();
    std::fs::remove_dir_all(bench.at("cert")).unwrap();
    read_only(&bench.at("medium/cert.zip"), &bench.at("medium"));

    let (told, warned) =
        bench.octant(&["campaign", "unbundle", "medium/cert.zip", "a node/cert"], 0);
    assert!(told.contains("6 files") && warned.is_empty(), "{told}{warned}");
    bench.octant(&["campaign", "status", "a node/cert"], 3);
    // In parts, and the folder moves between them.
    bench.octant(&["campaign", "run", "a node/cert", "--shard", "1/2"], 0);
    std::fs::create_dir(bench.at("another node")).unwrap();
    std::fs::rename(bench.at("a node/cert"), bench.at("another node/its cert")).unwrap();
    let cert = "another node/its cert";
    let (_, warned) = bench.octant(&["campaign", "run", cert, "--shard", "2/2"], 0);
    assert!(!warned.contains("another program"), "{warned}");
    bench.octant(&["campaign", "merge", cert], 0);
    assert!(bench.tables(cert) == expected, "the tables differ");

    bench.octant(&["campaign", "status", cert], 0);
    let (trace, _) = bench.octant(&["campaign", "trace", cert], 0);
    assert!(
        trace.contains("NAV-1") && trace.contains("NAV-2") && trace.contains("SYS-1"),
        "{trace}"
    );
    bench.octant(&["campaign", "report", cert], 0);
    for input in ["campaign.toml", "requirements.toml"] {
        assert!(bench.at(cert).join("inputs").join(input).is_file(), "{input}");
    }
    bench.octant(&["verify", cert], 0);
    let (again, _) = bench.octant(&["verify", cert, "--reexecute", "2"], 0);
    assert!(again.contains("2 the same"), "{again}");

    let plan = Plan::read(&bench.at(cert).join("plan.json")).unwrap();
    for case in [&plan.cases[0], &plan.cases[1]] {
        let out = format!("runs/{}", case.id);
        bench.octant(&["campaign", "case", cert, &case.id, "--out", &out], 0);
        let (stored, _) = bench.octant(&["campaign", "result", cert, &case.id], 0);
        let stored: serde_json::Value = serde_json::from_str(&stored).unwrap();
        let run = json(&bench.at(&out).join("summary.json"));
        assert_eq!(run["stream_hash"], stored["summary"]["stream_hash"]);
        // The requirements of the campaign too, and their results.
        assert_eq!(run["requirements"], stored["summary"]["requirements"]);
        assert!(!run["requirements"].as_array().unwrap().is_empty());
        let manifest = json(&bench.at(&out).join("manifest.json"));
        let again = ["octant", "campaign", "case", cert, &*case.id];
        assert_eq!(manifest["command_line"], serde_json::json!(again));
        bench.octant(&["verify", &out], 0);
        // The resolved scenario names files that are there.
        let resolved = bench.at(&out).join("scenario.toml");
        let twice = bench.at(&out).join("again");
        ends(&["run", resolved.to_str().unwrap(), "--out", twice.to_str().unwrap()], 0);
        assert_eq!(json(&twice.join("summary.json"))["stream_hash"], run["stream_hash"]);
    }
    // The folder makes the same bundle as the one that it came from.
    bench.octant(&["campaign", "bundle", cert, "--out", "again.zip"], 0);
    assert!(std::fs::read(bench.at("again.zip")).unwrap() == bytes, "the bundles differ");
}

/// Takes the permission to write away, which counts for anyone but root.
fn read_only(file: &Path, folder: &Path) {
    for path in [file, folder] {
        let mut permissions = std::fs::metadata(path).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(path, permissions).unwrap();
    }
}

#[test]
fn the_same_plan_gives_the_same_bytes_wherever_it_was_made() {
    let [first, second] = [Bench::new(b"core", false), Bench::new(b"core", false)];
    let bytes = [&first, &second].map(|bench| std::fs::read(bench.bundled()).unwrap());
    assert!(bytes[0] == bytes[1], "the bundles differ");
    // Again under the same name: the file is kept.
    first.bundled();
    let contents = entries(&bytes[0]);
    assert_eq!(contents[0].0, "bundle.json");
    let list = BundleContents::from_json(Path::new("it"), &contents[0].1).unwrap();
    assert_eq!(list.schema, SCHEMA);
    let octant = crate::common::program::OCTANT;
    let digest = command("sha256sum").arg(octant).output().unwrap().stdout;
    let digest = String::from_utf8(digest).unwrap();
    assert_eq!(list.program_sha256.as_deref(), digest.split_whitespace().next());
    // Each entry is in the folder of its own hash; no path of the planning computer is inside.
    let place = first.folder.path().display().to_string();
    for (name, content) in &contents[1..] {
        let hash = blake3::hash(content).to_hex();
        assert!(name == "plan.json" || name.split('/').nth(1) == Some(hash.as_str()), "{name}");
        assert!(!String::from_utf8_lossy(content).contains(&place), "{name}");
    }
    // Another file of the same name changes it, and isn't written over the first one.
    std::fs::write(first.at("plan/the models/core.fmu"), b"another core").unwrap();
    let out = ["campaign", "bundle", "cert", "--out", "cert.zip"];
    let (_, error) = first.octant(&out, 2);
    assert!(error.contains("cert.zip: something else is there"), "{error}");
    assert!(std::fs::read(first.at("cert.zip")).unwrap() == bytes[0]);
    assert_eq!(names(first.folder.path()), ["cert", "cert.zip", "plan"]);
}

#[test]
fn what_has_changed_since_the_planning_is_refused() {
    let bench = Bench::new(b"core", false);
    let out = ["campaign", "bundle", "cert", "--out", "cert.zip"];
    for (file, found) in [
        ("requirements.toml", "it was changed after the campaign was planned"),
        ("scenarios/short.toml", "it was changed after the campaign was planned"),
    ] {
        let path = bench.at("plan").join(file);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace("10 nmi", "11 nmi").replace("10 arcmin", "11 arcmin"))
            .unwrap();
        let (_, error) = bench.octant(&out, 2);
        assert!(error.contains(file) && error.contains(found), "{error}");
        std::fs::write(&path, text).unwrap();
    }
    let fmu = bench.at("plan/the models/core.fmu");
    std::fs::remove_file(&fmu).unwrap();
    let (_, error) = bench.octant(&out, 2);
    assert!(error.contains("core.fmu"), "{error}");
    std::fs::create_dir(&fmu).unwrap();
    let (_, error) = bench.octant(&out, 2);
    assert!(error.contains("core.fmu: found a folder"), "{error}");
    assert_eq!(names(bench.folder.path()), ["cert", "plan"]);
}

#[test]
fn files_are_checked_when_they_are_used_and_another_program_is_told() {
    let bench = Bench::new(b"core", false);
    bench.bundled();
    bench.octant(&["campaign", "unbundle", "cert.zip", "there"], 0);
    let (_, error) = bench.octant(&["campaign", "unbundle", "cert.zip", "there"], 2);
    assert!(error.contains("the folder isn't empty"), "{error}");
    let (_, error) = bench.octant(&["campaign", "run", "cert.zip"], 2);
    assert!(error.contains("octant campaign unbundle cert.zip DIR makes one"), "{error}");
    let plan = Plan::read(&bench.at("there/plan.json")).unwrap();
    let bundled = plan.bundled.clone().unwrap();
    let mut files: Vec<PathBuf> =
        plan.scenarios.iter().flat_map(|s| s.files.values().map(|f| f.file.clone())).collect();
    assert_eq!(files.len(), 2);
    files.extend([plan.scenarios[0].file.clone(), bundled.campaign.file]);
    files.extend(bundled.requirements.map(|planned| planned.file));
    for file in files {
        let content = std::fs::read(&file).unwrap();
        std::fs::write(&file, [&*content, b"\n"].concat()).unwrap();
        let (_, error) = bench.octant(&["campaign", "run", "there"], 2);
        let name = file.display().to_string();
        assert!(error.contains(&name) && error.contains("it was changed after"), "{error}");
        std::fs::remove_file(&file).unwrap();
        let (_, error) = bench.octant(&["campaign", "run", "there"], 2);
        assert!(error.contains(&name), "{error}");
        std::fs::write(&file, content).unwrap();
    }
    // An FMU that somebody put into the plan, whose id says nothing of it.
    let plan_file = bench.at("there/plan.json");
    let text = std::fs::read_to_string(&plan_file).unwrap();
    let core = blake3::hash(b"core").to_hex().to_string();
    let other = blake3::hash(b"another").to_hex().to_string();
    assert!(text.contains(&core), "{text}");
    let placed = bench.at(&format!("there/files/{other}"));
    std::fs::create_dir(&placed).unwrap();
    std::fs::write(placed.join("core.fmu"), "another").unwrap();
    std::fs::write(&plan_file, text.replace(&core, &other)).unwrap();
    let (_, error) = bench.octant(&["campaign", "run", "there"], 2);
    assert!(error.contains("plan.json") && error.contains("isn't in the bundle"), "{error}");
    // Its content in the place of the other, with its hash in the plan.
    let original = bench.at(&format!("there/files/{core}/core.fmu"));
    std::fs::write(&original, "another").unwrap();
    let hash_alone =
        text.replace(&format!("\"blake3\": \"{core}\""), &format!("\"blake3\": \"{other}\""));
    assert_ne!(hash_alone, text);
    std::fs::write(&plan_file, hash_alone).unwrap();
    let (_, error) = bench.octant(&["campaign", "run", "there"], 2);
    assert!(error.contains("plan.json") && error.contains("with another hash"), "{error}");
    std::fs::write(&original, "core").unwrap();
    std::fs::write(&plan_file, text).unwrap();
    // The same bundle by another program of other numerics.
    let list = bench.at("there/bundle.json");
    let mut contents = BundleContents::of_folder(&bench.at("there")).unwrap().unwrap();
    contents.program_sha256 = Some("f".repeat(64));
    contents.numerics += 1;
    contents.blake3 = String::new();
    contents.blake3 = blake3::hash(contents.to_json().as_bytes()).to_hex().to_string();
    std::fs::write(&list, contents.to_json()).unwrap();
    // The FMU is a text: its cases are errors.
    let (_, warned) = bench.octant(&["campaign", "run", "there"], 4);
    assert!(
        warned.contains("made by another program") && warned.contains("ffffffffffff"),
        "{warned}"
    );
    assert!(warned.contains("numerics version"), "{warned}");
}

#[test]
fn devices_and_programs_outside_are_named() {
    let bench = Bench::new(b"core", false);
    let text = SCENARIO.replace("fmu:../the models/core.fmu", "exec:./core --fast");
    std::fs::write(bench.at("plan/scenarios/short.toml"), text).unwrap();
    bench.octant(&["campaign", "plan", "plan/campaign.toml", "--out", "talks"], 0);
    let (_, told) = bench.octant(&["campaign", "bundle", "talks", "--out", "talks.zip"], 0);
    let expected = "not in the bundle: exec:./core --fast of scenario \"relative\"";
    assert!(told.contains(expected), "{told}");
    let (_, told) = bench.octant(&["campaign", "unbundle", "talks.zip", "there"], 0);
    assert!(told.contains(expected), "{told}");
}
