//! Bundles that were truncated, damaged or edited.

use super::bench::{Bench, Entries, entries, names, pack};
use octant_dispatch::bundle::contents::{BundleContents, SCHEMA};
use octant_dispatch::bundle::unpack::unpack;

#[test]
fn a_damaged_bundle_is_refused_or_gives_the_same_files() {
    let bench = Bench::new(b"core", false);
    let bundle = bench.bundled();
    let whole = std::fs::read(&bundle).unwrap();
    let damaged = bench.at("damaged.zip");
    for length in (0..whole.len()).step_by(97).chain([whole.len() - 1]) {
        std::fs::write(&damaged, &whole[..length]).unwrap();
        bench.refusal(&damaged);
    }
    let expected = entries(&whole);
    let mut harmless = 0;
    let places: Vec<usize> = (0..whole.len()).step_by(11).collect();
    for at in &places {
        let mut bytes = whole.clone();
        bytes[*at] ^= 0x10;
        std::fs::write(&damaged, &bytes).unwrap();
        let folder = bench.at("unpacked");
        // Times and attributes in the archive's headers say nothing.
        if unpack(&damaged, &folder).is_ok() {
            harmless += 1;
            for (name, content) in &expected {
                assert!(std::fs::read(folder.join(name)).unwrap() == *content, "{at}: {name}");
            }
            std::fs::remove_dir_all(&folder).unwrap();
        } else {
            assert!(!folder.exists(), "{at}");
        }
    }
    assert!(harmless < places.len() / 4, "{harmless} of {}", places.len());
    assert_eq!(names(bench.folder.path()), ["cert", "cert.zip", "damaged.zip", "plan"]);
}

#[test]
fn an_edited_bundle_is_refused_with_its_entry() {
    let bench = Bench::new(b"core", false);
    let whole = entries(&std::fs::read(bench.bundled()).unwrap());
    let edited = bench.at("edited.zip");
    // As it is, packed by another program, it is whole.
    pack(&edited, &whole);
    unpack(&edited, &bench.at("whole")).unwrap();
    let refusal = |change: &dyn Fn(&mut Entries)| {
        let mut entries = whole.clone();
        change(&mut entries);
        pack(&edited, &entries);
        bench.refusal(&edited)
    };
    for (index, (name, content)) in whole.iter().enumerate() {
        // A byte more, a byte less, another byte.
        let mut other = content.clone();
        other[content.len() / 2] ^= 1;
        for content in [[&**content, b" "].concat(), content[1..].to_vec(), other] {
            let error = refusal(&|all| all[index].1.clone_from(&content));
            assert!(error.contains(name), "{name}: {error}");
        }
        let error = refusal(&|all| drop(all.remove(index)));
        assert!(error.contains(name), "{error}");
        for wrong in ["/etc/evil", "../evil", "files/../../evil", "C:\\evil", "files/evil"] {
            let error = refusal(&|all| wrong.clone_into(&mut all[index].0));
            assert!(error.contains(&format!("{wrong:?}")), "{error}");
        }
    }
    let more = format!("files/{}/more", "0".repeat(64));
    let error = refusal(&|all| all.push((more.clone(), Vec::new())));
    assert!(error.contains(&more) && error.contains("not in the list"), "{error}");

    // Lists that fit themselves: of a newer version, or of other files.
    let list = |change: &dyn Fn(&mut BundleContents)| {
        let mut contents = BundleContents::from_json(&edited, &whole[0].1).unwrap();
        change(&mut contents);
        contents.blake3 = String::new();
        contents.blake3 = blake3::hash(contents.to_json().as_bytes()).to_hex().to_string();
        contents.to_json().into_bytes()
    };
    let error = refusal(&|all| all[0].1 = list(&|contents| contents.schema = SCHEMA + 1));
    assert!(error.contains("bundle.json") && error.contains("version 2"), "{error}");
    assert!(error.contains("reads version 1: a newer Octant wrote it"), "{error}");
    let error = refusal(&|all| all[0].1 = list(&|contents| contents.files[0].path = "../x".into()));
    assert!(error.contains("\"../x\""), "{error}");
    let error = refusal(&|all| all[0].1 = list(&|contents| contents.plan = "0".repeat(64)));
    assert!(error.contains("plan.json") && error.contains("000000000000"), "{error}");
    // A plan that names a file outside of the bundle.
    let error = refusal(&|all| {
        let text = String::from_utf8(all[1].1.clone()).unwrap();
        let at = text.find("files/").unwrap();
        let end = at + text[at..].find('"').unwrap();
        let text = format!("{}/etc/evil{}", &text[..at], &text[end..]);
        all[0].1 = list(&|contents| {
            let plan = contents.files.iter_mut().find(|file| file.path == "plan.json").unwrap();
            plan.bytes = text.len() as u64;
            plan.blake3 = blake3::hash(text.as_bytes()).to_hex().to_string();
        });
        all[1].1 = text.into_bytes();
    });
    assert!(error.contains("plan.json") && error.contains("/etc/evil"), "{error}");

    // No bundle at all.
    pack(&edited, &[("plan.json".to_owned(), b"{}".to_vec())]);
    assert!(bench.refusal(&edited).contains("without bundle.json"));
    std::fs::write(&edited, b"schema = 1").unwrap();
    assert!(bench.refusal(&edited).contains("no whole bundle"));
}
