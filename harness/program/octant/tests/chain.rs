//! Tampering with evidence: edited verdicts, values, limits, tables and summaries. Each edit is
//! found.

use crate::campaign_report::bench::{Bench, CAMPAIGN, check};
use crate::common::program::{ends, octant_in, program};
use crate::common::results as stored;
use octant_campaign::execute::Shard;
use octant_campaign::execute::case;
use octant_campaign::merge;
use octant_campaign::merge::results;
use octant_campaign::plan::Plan;
use octant_campaign::table::{ColumnValue as Cell, ColumnValues, ExistingTable, write};
use octant_test_processes::command;
use serde_json::{Value, json};
use std::borrow::Cow;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Makes two by two cases, the first of which is over its limit.
fn campaign() -> (Bench, Plan, PathBuf) {
    let small = CAMPAIGN.replace("replicates = 40", "replicates = 2");
    Bench::filled(&small, |index, _, result| {
        if index == 0 {
            check(result, "CAL-1", 99.0, 50.0);
        }
    })
}

fn parts(plan: &Plan, out: &Path) {
    results::tables(plan, out, 0..plan.cases.len(), |table| merge::part(out, Shard::WHOLE, table))
        .unwrap();
}

/// Runs each reader of a campaign; returns status and output.
fn readers(bench: &Bench) -> Vec<(&'static str, i32, String)> {
    ["status", "report", "merge", "trace"]
        .into_iter()
        .map(|command| {
            let output = bench.octant(&["campaign", command, "out"]);
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            (command, output.status.code().unwrap(), said)
        })
        .collect()
}

#[test]
fn an_edited_case_result_is_refused_by_every_reader_and_named() {
    let (bench, plan, out) = campaign();
    parts(&plan, &out);
    let id = plan.cases[0].id.as_str();
    let put = |result: &Value| stored::put(&out, id, &format!("{result}\n"));
    let whole = stored::value(&out, id);
    assert_eq!(whole["verdict"], "fail");
    assert!(readers(&bench).iter().all(|(_, status, _)| [0, 1, 3].contains(status)));

    let forged_verdict = |result: &mut Value| {
        result["verdict"] = "pass".into();
        result["summary"]["verdict"] = "pass".into();
        result["summary"]["reasons"] = json!([]);
        for check in result["summary"]["requirements"].as_array_mut().unwrap() {
            check["verdict"] = "pass".into();
        }
    };
    let forged_check = |field: &str, to: Value| {
        let field = field.to_owned();
        move |result: &mut Value| {
            forged_verdict(result);
            let checks = result["summary"]["requirements"].as_array_mut().unwrap();
            let check = checks.iter_mut().find(|check| check["id"] == "CAL-1").unwrap();
            check[&field] = to.clone();
        }
    };
    type Edit = Box<dyn Fn(&mut Value)>;
    let edits: Vec<(&str, Edit)> = vec![
        ("the verdict alone", Box::new(|result| result["verdict"] = "pass".into())),
        ("every verdict", Box::new(forged_verdict)),
        ("the value too", Box::new(forged_check("value", 9.0.into()))),
        ("the margin too", Box::new(forged_check("margin", 1.0.into()))),
        ("no value", Box::new(forged_check("value", Value::Null))),
        ("the seed", Box::new(|result| result["summary"]["seed"] = 4711.into())),
        ("an error that passes", Box::new(|result| result["summary"] = Value::Null)),
        ("the hash of the case", Box::new(|result| result["case_blake3"] = "ab".repeat(32).into())),
        ("no hash of the case", Box::new(|result| result["case_blake3"] = Value::Null)),
    ];
    for (what, edit) in &edits {
        // Once as edited by hand, and once with the hash of the summary computed again.
        for rehash in [false, true] {
            let mut result = whole.clone();
            edit(&mut result);
            if rehash && !result["summary"].is_null() {
                let hash = case::hash_of_summary(&result["summary"]);
                result["summary_blake3"] = hash.into();
            }
            put(&result);
            for (command, status, said) in readers(&bench) {
                assert!(![0, 1, 3].contains(&status), "{what}, {rehash}: {command}: {status}");
                assert!(said.contains(id) && said.contains("results/"), "{said}");
            }
        }
    }
    // A number from which nothing is derived: only the hash reveals the edit.
    let mut result = whole.clone();
    result["summary"]["navigation"]["latitude_error_arcmin"]["max"] = 0.001.into();
    put(&result);
    assert!(readers(&bench).iter().all(|(_, status, said)| *status == 4 || said.contains("read")));
    // With the original content restored, every reader works.
    put(&whole);
    parts(&plan, &out);
    assert!(readers(&bench).iter().all(|(_, status, _)| [0, 1, 3].contains(status)));
}

#[test]
fn a_limit_that_differs_from_the_plan_is_refused() {
    let (bench, plan, out) = campaign();
    let mut result = stored::value(&out, &plan.cases[1].id);
    let checks = result["summary"]["requirements"].as_array_mut().unwrap();
    let check = checks.iter_mut().find(|check| check["id"] == "NAV-1").unwrap();
    let value = check["value"].as_f64().unwrap();
    (check["limit"], check["margin"]) = (1000.0.into(), (1000.0 - value).into());
    result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
    stored::put(&out, &plan.cases[1].id, &format!("{result}\n"));
    let (status, said) = bench.report();
    assert!(status != 0 && said.contains("1000") && said.contains("<= 10"), "{said}");
}

/// Changes cells of a table.
fn edited(path: &Path, column: &str, change: impl Fn(usize, Option<Cell>) -> Option<Cell>) {
    let table = ExistingTable::open(path).unwrap();
    let all: Vec<ColumnValues> = table
        .columns
        .iter()
        .map(|(name, kind)| {
            let values = table.column(name).unwrap().unwrap();
            let mut new = ColumnValues::new(*kind);
            for row in 0..table.rows {
                let value = values.at(row);
                new.push(if name == column { change(row, value) } else { value });
            }
            new
        })
        .collect();
    let (plan, columns) = (table.plan.clone(), table.columns.clone());
    write(path, &plan, &columns, |index| Ok(Cow::Borrowed(&all[index]))).unwrap();
}

#[test]
fn tables_that_contradict_the_cases_are_refused() {
    let (bench, plan, out) = campaign();
    parts(&plan, &out);
    let octant = |command: &str| {
        let output = bench.octant(&["campaign", command, "out"]);
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(octant("merge").0, 0);
    assert_eq!(bench.report().0, 1);
    let pass = |_: usize, _: Option<Cell>| Some(Cell::Text("pass".into()));
    for (table, column) in [("cases", "verdict"), ("checks", "verdict")] {
        for path in [merge::merged(&out, table), merge::part(&out, Shard::WHOLE, table)] {
            let whole = std::fs::read(&path).unwrap();
            edited(&path, column, pass);
            let is_part = path.parent() != Some(&out);
            let (status, said) = if is_part { octant("merge") } else { bench.report() };
            let name = path.file_name().unwrap().to_str().unwrap();
            assert!(status == 2 && said.contains(name), "{table}: {status}: {said}");
            assert!(said.contains(plan.cases[0].id.as_str()), "{said}");
            std::fs::write(&path, whole).unwrap();
        }
    }
    let path = merge::merged(&out, "drift");
    let whole = std::fs::read(&path).unwrap();
    edited(&path, "hours", |row, value| if row == 1 { None } else { value });
    assert_eq!(bench.report().0, 2);
    std::fs::write(&path, whole).unwrap();
    assert_eq!(bench.report().0, 1);

    // Parts of another machine, without its results: the rows are checked for consistency.
    let other = bench.at("other");
    std::fs::create_dir_all(other.join("parts")).unwrap();
    for table in ["cases", "checks", "drift"] {
        std::fs::copy(
            merge::part(&out, Shard::WHOLE, table),
            merge::part(&other, Shard::WHOLE, table),
        )
        .unwrap();
    }
    std::fs::copy(out.join("plan.json"), other.join("plan.json")).unwrap();
    let merged = || {
        let output = bench.octant(&["campaign", "merge", "other"]);
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(merged().0, 0);
    for table in ["cases", "checks"] {
        let path = merge::part(&other, Shard::WHOLE, table);
        let whole = std::fs::read(&path).unwrap();
        edited(&path, "verdict", pass);
        let (status, said) = merged();
        assert!(status == 2 && said.contains(plan.cases[0].id.as_str()), "{table}: {said}");
        std::fs::write(&path, whole).unwrap();
    }
}

/// Makes a short run in a folder.
pub(crate) fn run(requirement: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let text = format!(
        "schema = 1\ntitle = \"t\"\nseed = 3\n[procedure.calibration]\npositions = \"eight\"\n\
         duration = \"24 min\"\n[procedure.navigation]\nduration = \"1 min\"\n{requirement}"
    );
    std::fs::write(folder.path().join("s.toml"), text).unwrap();
    let output = octant_in(folder.path(), &["run", "s.toml", "--out", "run"]);
    assert!([0, 1].contains(&output.status.code().unwrap()), "{output:?}");
    folder
}

pub(crate) const TOO_NEAR: &str = "[[requirements]]\nid = \"NAV-1\"\ntext = \"x\"\n\
    measure = \"navigation.radial_error_nmi.max\"\nlimit = \"1e-9 nmi\"\n";

#[test]
fn the_report_of_a_run_refuses_what_the_manifest_contradicts() {
    let folder = run(TOO_NEAR);
    let path = folder.path().join("run/summary.json");
    let whole = std::fs::read_to_string(&path).unwrap();
    let out = folder.path().join("again.html");
    let run = folder.path().join("run");
    let report = || {
        let arguments = ["report", run.to_str().unwrap(), "--out", out.to_str().unwrap()];
        let output = program(&arguments).output().unwrap();
        (output.status.code().unwrap(), String::from_utf8(output.stderr).unwrap())
    };
    assert_eq!(report().0, 0);
    std::fs::write(&path, whole.replace("\"fail\"", "\"pass\"")).unwrap();
    std::fs::remove_file(&out).unwrap();
    let (status, said) = report();
    assert!(status == 2 && said.contains("summary.json"), "{status} {said}");
    assert!(!out.exists());
    // With the manifest made again, the summary contradicts itself.
    let manifest = std::fs::read_to_string(run.join("manifest.json")).unwrap();
    renew(&run, "summary.json");
    let (status, said) = report();
    assert!(status == 2 && said.contains("NAV-1 says pass"), "{status} {said}");
    let (said, _) = ends(&["verify", run.to_str().unwrap()], 1);
    assert!(said.contains("NAV-1 says pass"), "{said}");
    // The recording, from which the report draws, is checked too.
    std::fs::write(&path, &whole).unwrap();
    std::fs::write(run.join("manifest.json"), manifest).unwrap();
    assert_eq!(report().0, 0);
    let recording = run.join("recording.mcap");
    let mut bytes = std::fs::read(&recording).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&recording, bytes).unwrap();
    let (status, said) = report();
    assert!(status == 2 && said.contains("recording.mcap"), "{status} {said}");
}

/// Makes the manifest of a run again, for a file that was changed.
fn renew(run: &Path, name: &str) {
    use sha2::{Digest, Sha256};
    let path = run.join("manifest.json");
    let mut all: Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    let bytes = std::fs::read(run.join(name)).unwrap();
    let files = all["files"].as_array_mut().unwrap();
    let file = files.iter_mut().find(|file| file["path"] == name).unwrap();
    let sha256 = Sha256::digest(&bytes);
    file["blake3"] = blake3::hash(&bytes).to_hex().as_str().into();
    file["sha256"] = sha256.iter().map(|byte| format!("{byte:02x}")).collect::<String>().into();
    file["bytes"] = bytes.len().into();
    std::fs::write(path, all.to_string()).unwrap();
}

/// Edits that leave a summary consistent in itself: whoever reads it holds it against the scenario.
#[test]
fn limits_and_requirements_come_from_the_scenario_and_not_from_the_summary() {
    let folder = run(TOO_NEAR);
    let run = folder.path().join("run");
    let path = run.join("summary.json");
    let whole = std::fs::read_to_string(&path).unwrap();
    let summary: Value = serde_json::from_str(&whole).unwrap();
    assert_eq!(summary["verdict"], "fail");
    let value = summary["requirements"][0]["value"].as_f64().unwrap();
    let passed = |summary: &mut Value| {
        summary["verdict"] = "pass".into();
        summary["reasons"] = json!([]);
    };
    let further = |summary: &mut Value, limit: f64| {
        passed(summary);
        let check = &mut summary["requirements"][0];
        check["limit"] = limit.into();
        check["margin"] = (limit - value).into();
        check["verdict"] = "pass".into();
        check.as_object_mut().unwrap().remove("reason");
    };
    let raised = |summary: &mut Value| further(summary, 2.0 * value);
    let dropped = |summary: &mut Value| {
        summary["requirements"] = json!([]);
        summary["verdict"] = "none".into();
        summary["reasons"] = json!([]);
    };
    let renamed = |summary: &mut Value| {
        further(summary, 2.0 * value);
        summary["requirements"][0]["id"] = "NAV-9".into();
    };
    let accepted = |summary: &mut Value| {
        summary["decision"]["rule"] = "simple-acceptance".into();
    };
    type Edit<'a> = (&'a str, &'a dyn Fn(&mut Value));
    let edits: [Edit<'_>; 4] = [
        ("NAV-1 is navigation.radial_error_nmi.max", &raised),
        ("NAV-1 is missing: scenario.toml requires", &dropped),
        ("NAV-9 isn't a requirement of scenario.toml", &renamed),
        ("it was decided by simple acceptance, scenario.toml asks for guard band", &accepted),
    ];
    let run = run.to_str().unwrap();
    let out = folder.path().join("other.html");
    for (words, edit) in edits {
        let mut edited = summary.clone();
        edit(&mut edited);
        std::fs::write(&path, edited.to_string()).unwrap();
        renew(Path::new(run), "summary.json");
        for (arguments, status) in [
            (&["verify", run][..], 1),
            (&["verify", run, "--reexecute"], 1),
            (&["rejudge", run], 2),
            (&["report", run, "--out", out.to_str().unwrap()], 2),
            (&["watch", run, "--once"], 4),
        ] {
            let (said, error) = ends(arguments, status);
            assert!(said.contains(words) || error.contains(words), "{arguments:?}: {said} {error}");
        }
    }
    let mut edited = summary.clone();
    raised(&mut edited);
    std::fs::write(&path, edited.to_string()).unwrap();
    let scenario = Path::new(run).join("scenario.toml");
    std::fs::remove_file(&scenario).unwrap();
    let (said, _) = ends(&["verify", run], 1);
    assert!(said.contains("the limits of summary.json can't be held against"), "{said}");
}

/// Runs `verify` on a folder; returns its status and its JSON object.
fn verified(folder: &Path, more: &[&str]) -> (i32, Value) {
    let mut arguments = vec!["verify", folder.to_str().unwrap(), "--json"];
    arguments.extend_from_slice(more);
    let output = program(&arguments).output().unwrap();
    let found = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    (output.status.code().unwrap(), found)
}

#[test]
fn integrity_and_the_verdict_inside_are_two_answers() {
    let folder = run(TOO_NEAR);
    let run = folder.path().join("run");
    let (status, found) = verified(&run, &[]);
    assert_eq!((status, &found["whole"], &found["verdict"]), (0, &json!(true), &json!("fail")));
    let (said, _) = ends(&["verify", run.to_str().unwrap()], 0);
    assert!(said.contains("verdict: fail") && said.contains("NAV-1"), "{said}");
    assert!(!said.contains("pass"), "{said}");

    // The expectation matches this run only.
    let hash = found["run"].as_str().unwrap().to_owned();
    for (expected, status) in [
        ("scenario=t,seed=3".to_owned(), 0),
        (format!("run={}", &hash[..12]), 0),
        (format!("run={hash}"), 0),
        ("scenario=T".to_owned(), 1),
        ("seed=4".to_owned(), 1),
        (format!("run={}", "ab".repeat(8)), 1),
        ("seed=three".to_owned(), 2),
        ("run=ab".to_owned(), 2),
        ("case=3".to_owned(), 2),
    ] {
        assert_eq!(verified(&run, &["--expect", &expected]).0, status, "{expected}");
    }
    // A folder with the name of an unfinished run.
    let partial = folder.path().join("run.partial");
    std::fs::rename(&run, &partial).unwrap();
    let (status, found) = verified(&partial, &[]);
    assert!(status == 1 && found["differences"][0].as_str().unwrap().contains(".partial"));
    let output = octant_in(&partial, &["verify", "."]);
    assert_eq!(output.status.code(), Some(1), "also from inside");
}

#[test]
fn watching_a_run_tells_its_verdict_and_never_one_that_its_numbers_deny() {
    let folder = run(TOO_NEAR);
    let watched = |more: &[&str]| {
        let arguments = [&["watch", "run"], more].concat();
        let output = octant_in(folder.path(), &arguments);
        (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
    };
    assert_eq!((watched(&["--once"]).0, watched(&["--plain"]).0), (1, 1));
    let path = folder.path().join("run/summary.json");
    let whole = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, whole.replace("\"fail\"", "\"pass\"")).unwrap();
    for more in ["--once", "--plain"] {
        let (status, said) = watched(&[more]);
        assert!(status == 4 && !said.contains("pass"), "{status} {said}");
    }
    // A run that was aborted.
    std::fs::rename(folder.path().join("run"), folder.path().join("run.partial")).unwrap();
    std::fs::remove_file(folder.path().join("run.partial/summary.json")).unwrap();
    assert_eq!((watched(&["--once"]).0, watched(&["--plain"]).0), (4, 4));
}

#[cfg(unix)]
#[test]
fn what_is_added_to_a_folder_is_found_and_nothing_hangs() {
    let folder = run(TOO_NEAR);
    let run = folder.path().join("run");
    let fifo = |path: &Path| {
        let made = command("mkfifo").arg(path).status().unwrap();
        assert!(made.success());
    };
    let added = |name: &str, add: &dyn Fn(&Path), words: &str| {
        let path = run.join(name);
        let before = std::fs::read(&path).ok();
        add(&path);
        let (status, found) = verified(&run, &[]);
        let told = found["differences"].as_array().unwrap();
        let told = told.iter().any(|what| {
            let what = what.as_str().unwrap();
            what.contains(name) && what.contains(words)
        });
        assert!(status == 1 && told, "{name}: {status} {found}");
        if path.is_dir() && !path.is_symlink() {
            std::fs::remove_dir(&path).unwrap();
        } else {
            std::fs::remove_file(&path).unwrap();
        }
        if let Some(bytes) = before {
            std::fs::write(&path, bytes).unwrap();
        }
        assert_eq!(verified(&run, &[]).0, 0);
    };
    let secret = folder.path().join("secret");
    std::fs::write(&secret, "x").unwrap();
    let link = |path: &Path| std::os::unix::fs::symlink(&secret, path).unwrap();
    let instead = |add: fn(&Path)| {
        move |path: &Path| {
            std::fs::remove_file(path).unwrap();
            add(path);
        }
    };
    added("extra.txt", &|path| std::fs::write(path, "").unwrap(), "was added");
    added("empty", &|path| std::fs::create_dir(path).unwrap(), "empty folder");
    added(".writing", &|path| std::fs::write(path, "").unwrap(), "goes on");
    added("link", &link, "a link");
    added("fifo", &fifo, "a FIFO");
    added("socket", &|path| drop(std::os::unix::net::UnixListener::bind(path)), "a socket");
    // FIFOs in place of files that are read.
    let made = |path: &Path| {
        std::fs::remove_file(path).unwrap();
        fifo(path);
    };
    added("summary.json", &made, "a FIFO");
    added("recording.mcap", &made, "a FIFO");
    added(
        "summary.json",
        &instead(|path| {
            std::os::unix::fs::symlink("/dev/zero", path).unwrap();
        }),
        "a link",
    );
    for name in ["manifest.json", "manifest.json.minisig"] {
        let path = run.join(name);
        let before = std::fs::read(&path).ok();
        let _ = std::fs::remove_file(&path);
        fifo(&path);
        assert_ne!(verified(&run, &[]).0, 0, "{name}");
        std::fs::remove_file(&path).unwrap();
        if let Some(bytes) = before {
            std::fs::write(&path, bytes).unwrap();
        }
    }
    assert_eq!(verified(&run, &[]).0, 0);
}

#[test]
fn what_a_terminal_obeys_is_refused_in_files_and_escaped_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let text = "schema = 1\ntitle = \"t\"\n[procedure.navigation]\nduration = \"4 s\"\n";
    let path = folder.path().join("s.toml");
    let run = |text: &str, more: &[&str]| {
        std::fs::write(&path, text).unwrap();
        let arguments = [&["run", "s.toml", "--out", "run"], more].concat();
        let output = octant_in(folder.path(), &arguments);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(!said.contains('\u{1b}') && !said.contains('\u{202e}'), "{said:?}");
        (output.status.code().unwrap(), said)
    };
    for (found, told) in [
        ("t\\u001b[2J", "title"),
        ("t\\nverdict: pass", "title"),
        ("\\u202Essap", "title"),
        ("t\\u009b31m", "title"),
    ] {
        let (status, said) = run(&text.replace("\"t\"", &format!("\"{found}\"")), &[]);
        assert!(status == 2 && said.contains(told) && said.contains("control"), "{said}");
    }
    let fault = "[[faults]]\nid = \"a\\u0007b\"\nkind = \"spike\"\n";
    let (status, said) = run(&format!("{text}{fault}"), &[]);
    assert!(status == 2 && said.contains("faults.id") && said.contains("s.toml:6"), "{said}");
    let (status, said) = run(text, &["--set", "title=a\u{1b}[31mb"]);
    assert!(status == 2 && said.contains("control character"), "{said}");
    // A name from elsewhere: that of a folder.
    let (_, said) = run(text, &["--set", "site.latitude=\u{1b}[31m"]);
    assert!(said.contains("\\u001b"), "{said}");
    let output = octant_in(folder.path(), &["verify", "a\u{1b}[2Jb\u{202e}"]);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("a\\u001b[2Jb\\u202e") && !said.contains('\u{1b}'), "{said:?}");
}

#[test]
fn a_run_and_a_campaign_are_run_again_from_their_folders_alone() {
    let folder = run(TOO_NEAR);
    let run = folder.path().join("run");
    std::fs::remove_file(folder.path().join("s.toml")).unwrap();
    let statement = folder.path().join("statement.json");
    let more = ["--reexecute", "--attest", statement.to_str().unwrap()];
    let (status, found) = verified(&run, &more);
    assert_eq!((status, &found["reexecuted"]["matches"]), (0, &json!(true)), "{found}");
    // The attestation of a failing run states the failure.
    let statement: Value = serde_json::from_slice(&std::fs::read(statement).unwrap()).unwrap();
    assert_eq!(statement["_type"], "https://in-toto.io/Statement/v1");
    assert_eq!(statement["predicateType"], "https://in-toto.io/attestation/test-result/v0.1");
    let predicate = &statement["predicate"];
    assert_eq!(
        (&predicate["result"], &predicate["failedTests"]),
        (&json!("FAILED"), &json!(["NAV-1"]))
    );
    assert_eq!(predicate["configuration"][0]["name"], "scenario.toml");
    let subjects = statement["subject"].as_array().unwrap();
    let names: Vec<&str> = subjects.iter().map(|s| s["name"].as_str().unwrap()).collect();
    assert!(names[0] == "manifest.json" && names.contains(&"summary.json"), "{names:?}");

    // Another program: never a match.
    let path = run.join("manifest.json");
    let whole = std::fs::read_to_string(&path).unwrap();
    let manifest: Value = serde_json::from_str(&whole).unwrap();
    let program = manifest["program_sha256"].as_str().unwrap();
    std::fs::write(&path, whole.replace(program, &"ab".repeat(32))).unwrap();
    let (status, found) = verified(&run, &["--reexecute"]);
    assert_eq!((status, &found["reexecuted"]["matches"]), (3, &json!(false)));
    assert!(found["reexecuted"]["told"].to_string().contains("another program"), "{found}");
    std::fs::write(&path, whole).unwrap();

    // A campaign whose results were altered, with all dependent files made again.
    let campaign = CAMPAIGN.replace("replicates = 40", "replicates = 2");
    let bench = Bench::new(&campaign);
    let plan = bench.plan();
    let out = bench.at("out");
    plan.write(&out, false).unwrap();
    let octant = |arguments: &[&str]| {
        let output = bench.octant(arguments);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        (output.status.code().unwrap(), said, output)
    };
    octant(&["campaign", "run", "out"]);
    octant(&["campaign", "merge", "out"]);
    octant(&["campaign", "report", "out"]);
    for file in ["short.toml", "requirements.toml", "campaign.toml"] {
        std::fs::remove_file(bench.at(file)).unwrap();
    }
    let (status, said, output) = octant(&["verify", "out", "--reexecute", "all"]);
    assert_eq!(status, 0, "{said}{output:?}");
    assert!(said.contains("at most 0 of 4 results are altered"), "{said}");
    let (status, said, _) = octant(&["verify", "out", "--reexecute", "2", "--sample-seed", "7"]);
    assert!(status == 0 && said.contains("2 of 4 cases, drawn with --sample-seed 7"), "{said}");
    let case = &plan.cases[0];
    let mut result = stored::value(&out, &case.id);
    result["summary"]["navigation"]["latitude_error_arcmin"]["rms"] = 0.001.into();
    result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
    stored::put(&out, &case.id, &format!("{result}\n"));
    parts(&plan, &out);
    octant(&["campaign", "merge", "out"]);
    octant(&["campaign", "report", "out"]);
    assert_eq!(octant(&["verify", "out"]).0, 0, "nothing contradicts it");
    let (status, said, _) = octant(&["verify", "out", "--reexecute", "all"]);
    assert!(
        status == 1
            && said.contains(case.id.as_str())
            && said.contains("latitude_error_arcmin.rms"),
        "{said}"
    );
}

/// Limits of the requirements' file are in the plan; those of a scenario itself are in its copy.
#[test]
fn a_limit_that_differs_from_the_scenario_is_found_by_verify() {
    let (bench, plan, out) = campaign();
    bench.octant(&["campaign", "report", "out"]);
    assert_eq!(bench.octant(&["verify", "out"]).status.code(), Some(0));
    let whole = stored::value(&out, &plan.cases[0].id);
    type Edit = fn(&mut Vec<Value>);
    let edits: [(Edit, &str); 2] = [
        (
            |checks| {
                // The case is over its limit of 50 and passes with 100: everything derived from it
                // is consistent.
                let check = checks.iter_mut().find(|check| check["id"] == "CAL-1").unwrap();
                check["limit"] = 100.0.into();
                check["margin"] = (100.0 - check["value"].as_f64().unwrap()).into();
                check["verdict"] = "pass".into();
            },
            "CAL-1 is calibration.worst_normalized_error <= 100, its scenario has",
        ),
        (|checks| checks.retain(|check| check["id"] != "CAL-1"), "it didn't check CAL-1"),
    ];
    for (edit, told) in edits {
        let mut result = whole.clone();
        edit(result["summary"]["requirements"].as_array_mut().unwrap());
        result["summary"]["reasons"] = json!([]);
        result["summary"]["verdict"] = "pass".into();
        result["verdict"] = "pass".into();
        result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
        stored::put(&out, &plan.cases[0].id, &format!("{result}\n"));
        bench.octant(&["campaign", "report", "out"]);
        let output = bench.octant(&["verify", "out"]);
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.code() == Some(1) && said.contains(told), "{told}: {said}");
    }
}

/// A recording is an input: it is hashed, and another one in its place isn't accepted as the run's
/// input.
#[test]
fn the_recording_of_a_run_is_in_its_manifest() {
    let folder = run("");
    let at = |name: &str| folder.path().join(name);
    let full = ["run", "s.toml", "--set", "record.samples=\"full\"", "--out", "full"];
    assert!(octant_in(folder.path(), &full).status.success());
    std::fs::copy(at("full/recording.mcap"), at("input.mcap")).unwrap();
    let output = octant_in(
        folder.path(),
        &["run", "s.toml", "--source", "replay:input.mcap", "--out", "again"],
    );
    assert!(output.status.success(), "{output:?}");
    let manifest: Value =
        serde_json::from_slice(&std::fs::read(at("again/manifest.json")).unwrap()).unwrap();
    let first: Value =
        serde_json::from_slice(&std::fs::read(at("full/manifest.json")).unwrap()).unwrap();
    let files = first["files"].as_array().unwrap();
    let recording = files.iter().find(|file| file["path"] == "recording.mcap").unwrap();
    assert_eq!(manifest["inputs"][0]["sha256"], recording["sha256"]);
    assert_eq!(first.get("inputs"), None, "a run without a recording");
    let (status, found) = verified(&at("again"), &["--reexecute"]);
    assert_eq!(status, 0, "{found}");
    let mut bytes = std::fs::read(at("input.mcap")).unwrap();
    bytes.push(0);
    std::fs::write(at("input.mcap"), bytes).unwrap();
    let (status, found) = verified(&at("again"), &["--reexecute"]);
    let told = found["reexecuted"]["told"].to_string();
    assert!(status == 3 && told.contains("input.mcap has changed"), "{found}");
    std::fs::remove_file(at("input.mcap")).unwrap();
    let (status, found) = verified(&at("again"), &["--reexecute"]);
    assert!(
        status == 3 && found["reexecuted"]["told"].to_string().contains("input.mcap"),
        "{found}"
    );
}
