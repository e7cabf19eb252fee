//! The folder as evidence: its bytes, its manifest, the self-test.

use super::bench::{Bench, CAMPAIGN, SCENARIO, check, files, troubled};
use serde_json::{Value, json};
use std::path::Path;

#[test]
fn the_same_results_give_the_same_bytes_wherever_they_lie() {
    let (first, plan, out) = Bench::filled(CAMPAIGN, troubled);
    let (second, ..) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!((first.report().0, second.report().0), (4, 4));
    let of = |bench: &Bench| {
        let mut texts =
            ["statistics.json", "junit.xml", "dispositions.toml"].map(|f| bench.read(f));
        // The times are those at which the results were stored.
        let times =
            texts[1].lines().find(|line| line.contains(" timestamp=\"")).unwrap().to_owned();
        assert!(times.contains(" time=\""), "{times}");
        texts[1] = texts[1].replace(&times, "");
        let times = texts[1].lines().find(|line| line.contains(" time=\"")).unwrap().to_owned();
        texts[1] = texts[1].replace(&times, "");
        assert!(!texts[1].contains(" time=\""));
        texts
    };
    assert!(of(&first) == of(&second), "the place of the folder is in the results");
    // The manifest contains times; everything else is the same to the byte.
    let before = files(&out);
    assert_eq!(first.report().0, 4);
    let after = files(&out);
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    for (path, bytes) in &before {
        assert!(*bytes == after[path] || path.ends_with("manifest.json"), "{}", path.display());
    }
    // Only the page, written elsewhere: the folder stays as it is.
    let output = first.octant(&["campaign", "report", "out", "--out", "alone.html"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(files(&out) == after, "--out leaves the folder as it is");
    let alone = std::fs::read_to_string(first.at("alone.html")).unwrap();
    assert!(alone.contains(plan.cases[3].id.as_str()) && !alone.contains("href=\"cases/"));
}

#[test]
fn every_change_of_the_folder_is_found() {
    let small = CAMPAIGN.replace("replicates = 40", "replicates = 2");
    let (bench, _, out) = Bench::filled(&small, |index, _, result| {
        if index == 1 {
            check(result, "CAL-1", 99.0, 50.0);
        }
    });
    let keys = |name: &str| {
        let pair = minisign::KeyPair::generate_unencrypted_keypair().unwrap();
        let path = bench.at(name);
        std::fs::write(&path, pair.sk.to_box(None).unwrap().to_string()).unwrap();
        #[cfg(unix)]
        {
            let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
            std::fs::set_permissions(&path, mode).unwrap();
        }
        (path, pair.pk.to_base64())
    };
    let ((secret, public), (_, other)) = (keys("mine"), keys("other"));
    let verify = |key: Option<&str>| {
        let mut arguments = vec!["verify", "out"];
        arguments.extend(key.iter().flat_map(|key| ["--key", key]));
        let output = bench.octant(&arguments);
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    let report = || {
        let output = bench.octant_with(
            &["campaign", "report", "out"],
            &[("OCTANT_SIGNING_KEY", &secret), ("OCTANT_OPERATOR", Path::new("somebody"))],
        );
        assert_eq!(output.status.code(), Some(1), "{output:?}");
    };
    report();
    assert_eq!(verify(Some(&public)).0, 0, "{:?}", verify(Some(&public)));
    let manifest: Value = serde_json::from_str(&bench.read("manifest.json")).unwrap();
    let of = |path: &str| manifest.pointer(path).unwrap();
    assert_eq!(of("/campaign/verdict"), "fail");
    assert_eq!(of("/campaign/plan"), &bench.statistics()["plan"]);
    assert_eq!(of("/campaign/results_blake3"), &bench.statistics()["results_blake3"]);
    assert_eq!((of("/campaign/cases"), of("/campaign/open_discrepancies")), (&json!(4), &json!(3)));
    assert_eq!(of("/operator"), "somebody");
    assert!(of("/lock_file").as_str().unwrap().len() == 64 && of("/host/cpus").as_u64() > Some(0));
    let rerun = of("/rerun").as_str().unwrap();
    assert!(rerun.contains("campaign.toml --out out && octant campaign run out"), "{rerun}");
    let named: Vec<&str> =
        of("/files").as_array().unwrap().iter().map(|f| f["path"].as_str().unwrap()).collect();
    // Two parts, where a child of another test holds the lock of the first for a moment.
    let mut parts: Vec<String> = std::fs::read_dir(out.join("results"))
        .unwrap()
        .map(|entry| format!("results/{}", entry.unwrap().file_name().to_str().unwrap()))
        .collect();
    parts.sort();
    let told: Vec<&str> = named.iter().copied().filter(|p| p.starts_with("results/")).collect();
    assert!(!parts.is_empty() && told == parts, "{told:?}, {parts:?}");
    for file in [
        "plan.json",
        "report.html",
        "statistics.json",
        "junit.xml",
        "dispositions.toml",
        "inputs/campaign.toml",
        "inputs/requirements.toml",
    ] {
        assert!(named.contains(&file), "{file} in {named:?}");
    }
    let copies: Vec<&&str> = named.iter().filter(|path| path.ends_with("-short.toml")).collect();
    let copy = std::fs::read_to_string(out.join(copies[0])).unwrap();
    assert_eq!((copies.len(), copy.as_str()), (1, SCENARIO));

    // One flipped bit in any file, including the manifest and its signature.
    for (path, bytes) in &files(&out) {
        let mut changed = bytes.clone();
        let middle = changed.len() / 2;
        changed[middle] ^= 1 << (middle % 8);
        std::fs::write(path, changed).unwrap();
        // An unreadable manifest is bad input; for any other file its name is reported.
        let name = path.strip_prefix(&out).unwrap().to_string_lossy().into_owned();
        let own = name.starts_with("manifest.json");
        let found = |change: &str| {
            let (status, said) = verify(Some(&public));
            let told = status == 1 && said.contains(&format!("{name} {change}"));
            assert!(told || (own && status != 0), "{name} {change}: {status} {said}");
        };
        found("was changed");
        std::fs::remove_file(path).unwrap();
        found("is missing");
        std::fs::write(path, bytes).unwrap();
    }
    assert_eq!(verify(Some(&public)).0, 0);
    std::fs::write(out.join("results/extra.json"), "{}").unwrap();
    let (status, said) = verify(Some(&public));
    assert!(status == 1 && said.contains("results/extra.json was added"), "{said}");
    std::fs::remove_file(out.join("results/extra.json")).unwrap();
    assert_eq!(verify(Some(&other)).0, 1, "a wrong key");

    // A disposition is a change, until the report is made again.
    let text = bench.read("dispositions.toml").replacen(
        "disposition = \"\"",
        "disposition = \"known\"",
        1,
    );
    std::fs::write(out.join("dispositions.toml"), text).unwrap();
    let (status, said) = verify(Some(&public));
    assert!(status == 1 && said.contains("dispositions.toml was changed"), "{said}");
    report();
    assert_eq!(verify(Some(&public)).0, 0);
    // Without a key the old signature is removed.
    assert_eq!(bench.report().0, 1);
    let (status, said) = verify(None);
    assert!(status == 0 && said.contains("unsigned"), "{said}");
}

#[test]
fn the_self_test_is_shown_and_bound() {
    let (bench, _, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    let path = out.join("selftest.json");
    // This process has stored the results.
    let program = octant_evidence::manifest::program_sha256().unwrap();
    let test = json!({"schema": 1, "verdict": "fail", "program_sha256": program,
                      "at": "2026-01-02T03:04:05Z", "cases": []});
    for (text, words) in [
        (test.to_string(), "the self-test of the program came to fail"),
        (test.to_string().replace(":1,", ":2,"), "selftest.json is of version 2"),
        ("nonsense".to_owned(), "selftest.json is no result of a self-test"),
    ] {
        std::fs::write(&path, text).unwrap();
        assert_eq!(bench.report().0, 0);
        assert!(bench.read("report.html").contains(words), "{words}");
        let found = bench.statistics()["discrepancies"].as_array().unwrap().len();
        assert_eq!(found, 1);
    }
    std::fs::write(&path, test.to_string().replace("fail", "pass")).unwrap();
    assert_eq!(bench.report().0, 0);
    let (page, manifest) = (bench.read("report.html"), bench.read("manifest.json"));
    assert!(page.contains("pass, 2026-01-02T03:04:05Z") && page.contains(&program));
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["campaign"]["selftest"], "pass");
    assert_eq!(bench.statistics()["discrepancies"], json!([]));
    assert!(manifest["files"].as_array().unwrap().iter().any(|f| f["path"] == "selftest.json"));
    let made_by = &manifest["campaign"]["made_by"];
    assert_eq!(made_by[0]["maker"]["program_sha256"], program);
    assert_eq!(made_by[0]["results"], 80);
    // A self-test of another program says nothing of these results.
    std::fs::write(
        &path,
        test.to_string().replace("fail", "pass").replace(&program, &"ab".repeat(32)),
    )
    .unwrap();
    assert_eq!(bench.report().0, 0);
    let found = bench.statistics()["discrepancies"][0]["what"].as_str().unwrap().to_owned();
    assert!(
        found.contains("the self-test is of program abababababab, and 80 results are by another"),
        "{found}"
    );
}
