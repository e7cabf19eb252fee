//! Bundles of campaigns: a plan with all of its files, run where none of them is, and refused with any
//! damage.

use crate::common::program::{ended, ends, json, octant_in};
use octant_campaign::bundle::contents::{BundleContents, SCHEMA};
use octant_campaign::bundle::unpack::unpack;
use octant_campaign::plan::Plan;
use octant_fmu_build::{Options, build};
use std::io::{Cursor, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

const TABLES: [&str; 3] = ["cases.parquet", "checks.parquet", "drift.parquet"];

const SCENARIO: &str = "schema = 1
title = \"short\"
[imu]
rate = \"20 Hz\"
[endpoint]
uri = \"fmu:../the models/core.fmu\"
[procedure.initial_parameters]
table = \"../earlier.octcal\"
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
[[requirements]]
id = \"NAV-1\"
text = \"It stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
";

/// Names and contents of the entries of a bundle.
type Entries = Vec<(String, Vec<u8>)>;

/// The second scenario has its FMU by an absolute name, set by the campaign.
fn campaign(core: &Path) -> String {
    format!(
        "schema = 1
title = \"bundled\"
replicates = 2
requirements = \"requirements.toml\"
[[scenarios]]
id = \"relative\"
file = \"scenarios/short.toml\"
[[scenarios]]
id = \"absolute\"
file = \"scenarios/short.toml\"
set = {{ \"endpoint.uri\" = \"fmu:{}\" }}
",
        core.display()
    )
}

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/formats").join(name)
}

/// Our own FMU of the core, built once.
fn core() -> &'static [u8] {
    static CORE: OnceLock<Vec<u8>> = OnceLock::new();
    CORE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        build(&Options { out: folder.path().to_owned(), ..Options::default() }).unwrap();
        std::fs::read(folder.path().join("calibrator_fmi3.fmu")).unwrap()
    })
}

/// The computer on which a campaign is planned, and any others.
struct Bench {
    folder: TempDir,
}

impl Bench {
    /// Writes the files of a campaign. Without `core` the FMU is a text, which can be planned and not run.
    fn new(core: &[u8], is_absolute: bool) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        for folder in ["plan/scenarios", "plan/the models"] {
            std::fs::create_dir_all(bench.at(folder)).unwrap();
        }
        let fmu = bench.at("plan/the models/core.fmu");
        std::fs::write(&fmu, core).unwrap();
        std::fs::write(bench.at("plan/scenarios/short.toml"), SCENARIO).unwrap();
        let text = campaign(&fmu);
        let relative = text.split("[[scenarios]]\nid = \"absolute\"").next().unwrap().to_owned();
        let text = if is_absolute { text } else { relative };
        std::fs::write(bench.at("plan/campaign.toml"), text).unwrap();
        for (from, to) in [
            ("requirements.toml", "requirements.toml"),
            ("run/calibration.octcal", "earlier.octcal"),
        ] {
            std::fs::copy(fixture(from), bench.at("plan").join(to)).unwrap();
        }
        bench.octant(&["campaign", "plan", "plan/campaign.toml", "--out", "cert"], 0);
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    #[track_caller]
    fn octant(&self, arguments: &[&str], status: i32) -> (String, String) {
        ended(octant_in(self.folder.path(), arguments), status)
    }

    fn bundled(&self) -> PathBuf {
        self.octant(&["campaign", "bundle", "cert", "--out", "cert.zip"], 0);
        self.at("cert.zip")
    }

    fn tables(&self, folder: &str) -> Vec<Vec<u8>> {
        TABLES.map(|table| std::fs::read(self.at(folder).join(table)).unwrap()).to_vec()
    }

    /// Unpacks, and checks that nothing is left where it is refused.
    #[track_caller]
    fn refusal(&self, bundle: &Path) -> String {
        let before = names(self.folder.path());
        let error = unpack(bundle, &self.at("refused")).unwrap_err().to_string();
        assert_eq!(names(self.folder.path()), before, "{error}");
        assert!(error.contains(&bundle.display().to_string()), "{error}");
        error
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Entries of an archive in their order.
fn entries(bytes: &[u8]) -> Entries {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
    let count = archive.len();
    let one = |index| {
        let mut entry = archive.by_index(index).unwrap();
        let mut content = Vec::new();
        entry.read_to_end(&mut content).unwrap();
        (entry.name().unwrap().into_owned(), content)
    };
    (0..count).map(one).collect()
}

/// Writes a whole archive, as an editor of archives does: its checksums are right.
fn pack(path: &Path, entries: &[(String, Vec<u8>)]) {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        archive.start_file(name.as_str(), SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    std::fs::write(path, archive.finish().unwrap().into_inner()).unwrap();
}

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
    let digest = std::process::Command::new("sha256sum").arg(octant).output().unwrap().stdout;
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

#[test]
fn files_are_checked_when_they_are_used_and_another_program_is_told() {
    let bench = Bench::new(b"core", false);
    bench.bundled();
    bench.octant(&["campaign", "unbundle", "cert.zip", "there"], 0);
    let (_, error) = bench.octant(&["campaign", "unbundle", "cert.zip", "there"], 2);
    assert!(error.contains("the folder isn't empty"), "{error}");
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
