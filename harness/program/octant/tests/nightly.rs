//! Nightly regression: a regression is found, and nothing else is; and every problem of a history.

use crate::common::program::octant_in;
use octant_campaign::plan::Plan;
use octant_campaign::table::{ColumnValue as Cell, ExistingTable};
use serde_json::Value;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

const SCENARIO: &str = "schema = 1
title = \"short\"
seed = 1
[imu]
rate = \"50 Hz\"
[procedure.calibration]
positions = \"eight\"
duration = \"40 min\"
[procedure.navigation]
duration = \"30 min\"
[[requirements]]
id = \"NAV-1\"
text = \"It stays near.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
";

const CAMPAIGN: &str = "schema = 1
title = \"night\"
seed = 1
replicates = 16
[[scenarios]]
id = \"short\"
file = \"short.toml\"
";

const SUITE: &str = "schema = 1
[[cases]]
scenario = \"spike.toml\"
expect = \"pass\"
[[cases]]
scenario = \"broken.toml\"
expect = \"fail\"
because = \"NEVER\"
";

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        bench.write("short.toml", SCENARIO);
        bench.write("night.toml", CAMPAIGN);
        bench.write("suite.toml", SUITE);
        let requirement = "[[requirements]]\nid = \"NEVER\"\ntext = \"Nothing moves.\"\n\
            measure = \"counterfactual.worst_shift_sigma\"\nlimit = 3\n";
        let spike = "[[faults]]\nid = \"spike-1\"\nkind = \"spike\"\ntrigger = { at = \"500 s\" }\n\
            duration = \"2 samples\"\nchannels = \"gyro x\"\namplitude = \"10 deg/h\"\n";
        let calibration =
            "schema = 1\n[procedure.calibration]\npositions = \"eight\"\nduration = \"20 min\"\n";
        bench.write("spike.toml", &format!("{calibration}{spike}{requirement}"));
        let broken = requirement.replace("limit = 3", "limit = 0");
        bench.write("broken.toml", &format!("{calibration}{spike}{broken}"));
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.at(name), text).unwrap();
    }

    /// Changes a file.
    fn edit(&self, name: &str, from: &str, to: &str) {
        let text = std::fs::read_to_string(self.at(name)).unwrap();
        assert!(text.contains(from), "{from}");
        self.write(name, &text.replace(from, to));
    }

    fn octant(&self, words: &[&str]) -> (Option<i32>, String, String) {
        let output = octant_in(self.folder.path(), words);
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    }

    /// Runs a night of the campaign alone.
    fn night(&self, more: &[&str]) -> (Option<i32>, Value) {
        let mut words = vec!["nightly", "night.toml", "--history", "h", "--json"];
        words.extend_from_slice(more);
        let (status, out, err) = self.octant(&words);
        let value = serde_json::from_str(&out);
        (status, value.unwrap_or_else(|error| panic!("{error}: {out}{err}")))
    }
}

fn measures(night: &Value, change: &str) -> Vec<String> {
    let tests = night["comparison"]["tests"].as_array().unwrap();
    let found = tests.iter().filter(|test| test["change"] == change);
    found.map(|test| test["measure"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn what_got_worse_is_found_and_what_is_the_same_is_the_same() {
    let bench = Bench::new();
    // Without a baseline nothing was compared: neither a failure nor a pass.
    let (status, first) = bench.night(&["--suite", "suite.toml", "--out", "shown"]);
    assert_eq!((status, &first["verdict"]), (Some(3), &Value::from("inconclusive")), "{first}");
    assert!(
        first["reasons"][0].as_str().unwrap().starts_with("there is no baseline to compare with")
    );
    assert_eq!(
        (&first["suite_cases"], first["suite_broken"].as_array().unwrap().len()),
        (&2.into(), 0)
    );
    let id = first["night"].as_str().unwrap().to_owned();
    let (status, out, err) = bench.octant(&["nightly", "accept", "--history", "h"]);
    assert_eq!((status, out), (Some(0), format!("night {id} is the baseline\n")), "{err}");

    // The same program with the same seeds: everything is exactly the same.
    let (status, same) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!(status, Some(0), "{same}");
    let comparison = &same["comparison"];
    assert_eq!(comparison["same_program"], true);
    let tests = comparison["tests"].as_array().unwrap();
    assert!(tests.len() > 10);
    assert_eq!(measures(&same, "same").len(), tests.len());
    let pairing = &comparison["pairings"][0];
    assert_eq!((&pairing["pairs"], &pairing["changed_results"]), (&16.into(), &0.into()));
    assert_eq!(same["reasons"][0], "no regression found");
    // The detectable change of sixteen pairs in this number of tests is stated.
    let power = same["reasons"][1].as_str().unwrap();
    assert!(power.starts_with("16 pairs find with 90 % a mean that moved by "), "{power}");
    let radial = tests.iter().find(|t| t["measure"] == "navigation.radial_error_nmi.max").unwrap();
    let (smallest, sigmas) =
        (radial["detectable"].as_f64().unwrap(), radial["detectable_sigma"].as_f64().unwrap());
    // All pairs are equal to the bit: the smallest change that counts is the smallest detected.
    assert!(smallest > 0.0 && smallest <= 0.01 * radial["baseline"].as_f64().unwrap() * 2.0);
    assert!((1.0..3.0).contains(&sigmas), "{sigmas}");

    // A worse gyro: ten times the random walk.
    bench.edit(
        "short.toml",
        "rate = \"50 Hz\"",
        "rate = \"50 Hz\"\nangle_random_walk = \"0.007 deg/sqrt(h)\"",
    );
    let (status, worse) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!((status, &worse["verdict"]), (Some(1), &Value::from("fail")), "{worse}");
    let pairing = &worse["comparison"]["pairings"][0];
    assert_eq!((&pairing["pairs"], &pairing["changed_inputs"]), (&16.into(), &16.into()));
    let found = measures(&worse, "worse");
    assert!(found.contains(&"calibration.parameters.gyro_bias.error_rms".to_owned()), "{found:?}");
    assert!(found.iter().any(|name| name.starts_with("navigation.")), "{found:?}");
    assert!(measures(&worse, "better").is_empty());
    // Nothing is called flaky, because the case is another one.
    assert!(worse["comparison"]["flaky"].as_array().unwrap().is_empty());
    let markdown = std::fs::read_to_string(
        bench.at("h").join(worse["folder"].as_str().unwrap()).join("nightly.md"),
    )
    .unwrap();
    assert!(markdown.contains("## Worse\n"), "{markdown}");

    // With the change undone the night is better than that one, and no worse than the baseline.
    bench.edit("short.toml", "\nangle_random_walk = \"0.007 deg/sqrt(h)\"", "");
    bench.octant(&["nightly", "accept", worse["night"].as_str().unwrap(), "--history", "h"]);
    let (status, better) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!(status, Some(0), "{better}");
    assert!(measures(&better, "worse").is_empty());
    assert!(!measures(&better, "better").is_empty());

    history(&bench, 4);
    assert!(bench.at("shown/nightly.md").exists() && bench.at("shown/trend.html").exists());
}

/// Lists the names of the nights in the history.
fn nights(bench: &Bench) -> Vec<String> {
    let table = ExistingTable::open(&bench.at("h/history.parquet")).unwrap();
    let names = table.column("night").unwrap().unwrap();
    let mut names: Vec<String> = (0..table.rows)
        .map(|row| match names.at(row) {
            Some(Cell::Text(text)) => text.to_string(),
            other => panic!("{other:?}"),
        })
        .collect();
    names.dedup();
    names
}

/// Checks that the history has each night, and that its page is drawn.
fn history(bench: &Bench, count: usize) {
    let table = ExistingTable::open(&bench.at("h/history.parquet")).unwrap();
    let column = |name: &str| table.column(name).unwrap().unwrap();
    assert_eq!(nights(bench).len(), count);
    let measure = Cell::Text("navigation.radial_error_nmi.max".into());
    let rows: Vec<usize> =
        (0..table.rows).filter(|row| column("measure").at(*row) == Some(measure.clone())).collect();
    assert_eq!(rows.len(), count);
    let changes: Vec<_> = rows.iter().map(|row| column("change").at(*row)).collect();
    let text = |text: &str| Some(Cell::Text(text.into()));
    assert_eq!(changes[..2], [None, text("same")]);
    assert_eq!(column("count").at(rows[0]), Some(Cell::Integer(16)));
    let page = std::fs::read_to_string(bench.at("h/trend.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("median of the baseline"));
    assert!(!page.contains("http://") && !page.contains("https://"), "no network");
}

#[test]
fn other_seeds_are_no_regression_and_growing_is_none() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 4");
    assert_eq!(bench.night(&["--first"]).0, Some(0));
    // Half of the seeds are in both: those are compared, and are the same.
    bench.edit("night.toml", "replicates = 4", "replicates = 6");
    let (status, grown) = bench.night(&[]);
    assert_eq!(status, Some(0), "{grown}");
    let pairing = &grown["comparison"]["pairings"][0];
    assert_eq!((&pairing["pairs"], &pairing["cases"]), (&4.into(), &6.into()));
    assert_eq!(
        measures(&grown, "same").len(),
        grown["comparison"]["tests"].as_array().unwrap().len()
    );
    // Other seeds: no conclusion is possible, and none is drawn.
    bench.edit("night.toml", "seed = 1", "seed = 1000");
    let (status, other) = bench.night(&[]);
    assert_eq!((status, &other["verdict"]), (Some(3), &Value::from("inconclusive")));
    assert_eq!(other["comparison"]["tests"], serde_json::json!([]));
    assert_eq!(
        other["reasons"][0],
        "night: no case is in both nights, so that nothing can be told"
    );
    // A missing campaign hides its results.
    let (status, out, err) =
        bench.octant(&["nightly", "--suite", "suite.toml", "--history", "h", "--json"]);
    assert_eq!(status, Some(3), "{err}");
    let left: Value = serde_json::from_str(&out).unwrap();
    assert_eq!(left["reasons"][0], "not in this night: night");
}

#[test]
fn a_history_is_started_by_name_and_once() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 2");
    // --accept alone makes no comparison either: a lost baseline isn't a pass.
    assert_eq!(bench.night(&["--accept"]).0, Some(3));
    std::fs::remove_dir_all(bench.at("h")).unwrap();
    let (status, first) = bench.night(&["--first"]);
    assert_eq!(
        (status, &first["reasons"][0]),
        (Some(0), &"the first night: nothing to compare with".into())
    );
    let (status, out, err) = bench.octant(&["nightly", "night.toml", "--history", "h", "--first"]);
    assert_eq!((status, out.as_str()), (Some(2), ""), "{err}");
    assert!(err.contains("--first is for a history without one"), "{err}");
    assert_eq!(bench.night(&[]).0, Some(0));
    // A first night that fails by itself doesn't become the baseline.
    std::fs::remove_dir_all(bench.at("h")).unwrap();
    bench.edit("spike.toml", "limit = 3", "limit = 0");
    assert_eq!(bench.night(&["--suite", "suite.toml", "--first"]).0, Some(1));
    assert!(!bench.at("h/baseline.json").exists());
}

#[test]
fn the_trend_has_the_units_that_are_chosen_or_those_of_the_scenario() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 2");
    bench.edit("short.toml", "[imu]", "[display]\nattitude = \"mrad\"\nposition = \"km\"\n[imu]");
    let page = || std::fs::read_to_string(bench.at("h/trend.html")).unwrap();
    let has = |all: &[&str]| {
        let page = page();
        all.iter().for_each(|words| assert!(page.contains(words), "{words}"));
    };
    assert_eq!(bench.night(&["--first", "--units", "deg,kn"]).0, Some(0));
    has(&[
        "navigation heading error rms, deg",
        "navigation velocity north error rms, kn",
        "navigation longitude error max, arcmin",
        "navigation radial error max, nmi",
        "although the scenario asks for km",
    ]);
    // The page that is made anew has the scenario's units.
    assert_eq!(bench.octant(&["nightly", "accept", "--history", "h"]).0, Some(0));
    has(&["navigation heading error rms, mrad", "navigation velocity north error rms, m/s"]);
    // The stored numbers have their own: those of heading in mrad are those in arcmin over 3.437 747.
    let table = ExistingTable::open(&bench.at("h/history.parquet")).unwrap();
    let column = |name: &str| table.column(name).unwrap().unwrap();
    let of_heading = Cell::Text("navigation.heading_error_arcmin.rms".into());
    let row = (0..table.rows).find(|row| column("measure").at(*row) == Some(of_heading.clone()));
    let Some(Cell::Number(arcmin)) = column("median").at(row.unwrap()) else { panic!("no median") };
    let mrad = octant_base::number::significant(arcmin / 3.437_746_770_784_939, 4);
    has(&[&format!("median {mrad}, 95th percentile")]);
}

#[test]
fn newly_failing_cases_are_named_with_the_line_that_runs_them_again() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 3");
    assert_eq!(bench.night(&["--suite", "suite.toml", "--first"]).0, Some(0));
    bench.edit("short.toml", "limit = \"10 nmi\"", "limit = \"1e-9 nmi\"");
    bench.edit("spike.toml", "limit = 3", "limit = 0");
    let (status, night) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!(status, Some(1), "{night}");
    let failing = night["comparison"]["newly_failing"].as_array().unwrap();
    assert_eq!(failing.len(), 4, "{night}");
    assert_eq!(failing[0]["requirements"], serde_json::json!(["NAV-1"]));
    assert_eq!((&failing[0]["before"], &failing[0]["now"]), (&"pass".into(), &"fail".into()));
    assert_eq!(failing[3]["case"], "spike");
    assert!(
        night["comparison"]["requirements_worse"][0]
            .as_str()
            .unwrap()
            .starts_with("night: NAV-1: pass before, fail now")
    );
    // The stated command line runs.
    let line = failing[0]["rerun"].as_str().unwrap();
    let words: Vec<&str> = line.split(' ').skip(1).chain(["--out", "again"]).collect();
    assert_eq!(bench.octant(&words).0, Some(1), "{line}");
    // The evidence of the suite's failing case is there, that of the good one isn't.
    let suite = bench.at("h").join(night["folder"].as_str().unwrap()).join("suite");
    assert!(suite.join("spike/report.html").exists() && !suite.join("broken").exists());
    // Accepted as it is, the failure is no longer a change; fixed, it is an improvement.
    bench.octant(&["nightly", "accept", "--history", "h"]);
    assert_eq!(bench.night(&["--suite", "suite.toml"]).0, Some(0));
    bench.edit("spike.toml", "limit = 0", "limit = 3");
    let (status, mended) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!(status, Some(0), "{mended}");
    assert_eq!(mended["comparison"]["newly_passing"][0]["case"], "spike");
}

#[test]
fn the_same_program_and_another_result_is_an_error() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 2");
    assert_eq!(bench.night(&["--suite", "suite.toml", "--first"]).0, Some(0));
    // As if the baseline's program had given another stream.
    let path = bench.at("h/baselines");
    let night =
        std::fs::read_dir(&path).unwrap().next().unwrap().unwrap().path().join("night.json");
    let text = std::fs::read_to_string(&night).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let hash = value["suite"][0]["stream_hash"].as_str().unwrap().to_owned();
    std::fs::write(&night, text.replace(&hash, &"0".repeat(64))).unwrap();
    let (status, found) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!((status, &found["verdict"]), (Some(4), &Value::from("error")), "{found}");
    assert!(found["comparison"]["flaky"][0].as_str().unwrap().starts_with("suite: "));
}

/// A program with other numerics gives other bits, which is neither non-determinism nor a
/// regression of the unit.
#[test]
fn a_night_is_judged_anew_campaign_by_campaign() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 2");
    assert_eq!(bench.night(&["--first"]).0, Some(0));
    let night = bench.at("h/nights").join(&nights(&bench)[0]);
    let rejudge = || {
        let (status, out, err) = bench.octant(&["rejudge", night.to_str().unwrap(), "--json"]);
        let found: Value =
            serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why}: {out}{err}"));
        (status, found)
    };
    let (status, found) = rejudge();
    let judged = &found["judged"][0];
    assert_eq!((status, judged["then"].as_str()), (Some(0), Some("pass")), "{found}");
    assert_eq!((&judged["what"], &judged["now"]), (&"campaign".into(), &"pass".into()));
    assert_eq!(judged["requirements"][0]["then"], "pass");
    // A result whose value is above its limit fails, whatever verdict is stored with it.
    let plan = Plan::read(&night.join("night/plan.json")).unwrap();
    let (folder, id) = (night.join("night"), &plan.cases[0].id);
    let mut result = crate::common::results::value(&folder, id);
    result["summary"]["navigation"]["radial_error_nmi"]["max"] = 4711.0.into();
    crate::common::results::put(&folder, id, &result.to_string());
    let (status, found) = rejudge();
    let judged = &found["judged"][0];
    assert_eq!((status, &found["verdict"]), (Some(1), &"fail".into()), "{found}");
    assert_eq!(judged["cases"][0]["case"], plan.cases[0].id.as_str());
    // A night without its campaign's folder is an error that names the missing part.
    std::fs::remove_file(night.join("night/plan.json")).unwrap();
    let (status, _, err) = bench.octant(&["rejudge", night.to_str().unwrap()]);
    assert!(status == Some(2) && err.contains("night/plan.json"), "{err}");
}

#[test]
fn other_numerics_are_no_regression_and_no_non_determinism() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 2");
    assert_eq!(bench.night(&["--suite", "suite.toml", "--first"]).0, Some(0));
    let path = bench.at("h/baselines");
    let night =
        std::fs::read_dir(&path).unwrap().next().unwrap().unwrap().path().join("night.json");
    let text = std::fs::read_to_string(&night).unwrap();
    let value: Value = serde_json::from_str(&text).unwrap();
    let hash = value["suite"][0]["stream_hash"].as_str().unwrap().to_owned();
    let numerics = octant_score::numerics::NUMERICS;
    let written = format!("\"numerics\": {numerics}");
    assert!(text.contains(&written), "{text}");
    let other = text.replace(&hash, &"0".repeat(64));
    // Another version, and one from before versions existed.
    for (found, told) in [
        (other.replace(&written, "\"numerics\": 4711"), "numerics version 4711"),
        (other.replace(&format!("{written},"), ""), "from before there was one"),
    ] {
        std::fs::write(&night, found).unwrap();
        // The unit would be worse, if a conclusion were possible.
        bench.edit("short.toml", "limit = \"10 nmi\"", "limit = \"1e-9 nmi\"");
        let (status, now) = bench.night(&["--suite", "suite.toml"]);
        bench.edit("short.toml", "limit = \"1e-9 nmi\"", "limit = \"10 nmi\"");
        assert_eq!((status, &now["verdict"]), (Some(3), &Value::from("inconclusive")), "{now}");
        let comparison = &now["comparison"];
        assert_eq!(
            (&comparison["same_program"], &comparison["flaky"]),
            (&false.into(), &serde_json::json!([]))
        );
        let reasons = now["reasons"].to_string();
        assert!(reasons.contains("the numerics changed") && reasons.contains(told), "{reasons}");
        assert!(
            reasons.contains("octant nightly accept") && !reasons.contains("worse"),
            "{reasons}"
        );
    }
    // Problems of this night itself are still reported.
    bench.edit("spike.toml", "limit = 3", "limit = 0");
    assert_eq!(bench.night(&["--suite", "suite.toml"]).0, Some(1));
}

#[test]
fn a_night_that_was_broken_off_goes_on() {
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 3");
    let (_, night) = bench.night(&["--suite", "suite.toml"]);
    let folder = bench.at("h").join(night["folder"].as_str().unwrap());
    // State after a kill: some results, no end.
    let path = folder.join("night.json");
    let text = std::fs::read_to_string(&path).unwrap();
    let ended = format!("\"ended\": {}", night["ended"]);
    assert!(text.contains(&ended));
    std::fs::write(&path, text.replace(&ended, "\"ended\": null")).unwrap();
    let (_, out, err) = bench.octant(&["nightly", "accept", "--history", "h"]);
    assert!(err.contains("found no finished night in h"), "{out}{err}");
    std::fs::remove_file(folder.join("suite/spike.json")).unwrap();
    std::fs::remove_dir_all(folder.join("night/parts")).unwrap();
    let plan = Plan::read(&folder.join("night/plan.json")).unwrap();
    crate::common::results::remove(&folder.join("night"), &plan.cases[1].id);
    let (status, again) = bench.night(&["--suite", "suite.toml"]);
    // Complete, and without a baseline.
    assert_eq!((status, &again["night"]), (Some(3), &night["night"]));
    assert_eq!(again["campaigns"], night["campaigns"]);
    assert_eq!(nights(&bench), [night["night"].as_str().unwrap()]);
}

#[test]
fn what_is_wrong_with_a_history_is_told_before_anything_runs() {
    let bench = Bench::new();
    let refused = |words: &[&str], expected: &str| {
        let (status, out, err) = bench.octant(words);
        assert_eq!((status, out.as_str()), (Some(2), ""), "{err}");
        assert!(err.contains(expected), "{err}");
    };
    let night = ["nightly", "night.toml", "--history", "h"];
    refused(
        &["nightly", "--history", "h"],
        "found neither a campaign nor --suite, expected one or both",
    );
    refused(&["nightly", "night.toml"], "--history");
    refused(
        &["nightly", "night.toml", "night.toml", "--history", "h"],
        "found the campaign name \"night\", which is taken",
    );
    refused(&["nightly", "accept", "--history", "h"], "found no finished night in h");
    refused(
        &[&night[..], &["--alpha", "2"]].concat(),
        "expected a number of 0 or more and below 1",
    );
    refused(&["nightly", "gone.toml", "--history", "h"], "gone.toml");
    refused(
        &[&night[..], &["--units", "nmi,deg"]].concat(),
        "--units: found \"nmi\" as the unit of position: the history keeps percentiles",
    );
    std::fs::create_dir(bench.at("h")).unwrap();
    bench.write("h/history.parquet", "PAR1 and no more");
    refused(&night, "failed to read h/history.parquet");
    std::fs::remove_file(bench.at("h/history.parquet")).unwrap();
    bench.write("h/baseline.json", "{\"schema\": 2}");
    refused(&night, "found version 2, this program reads version 1");
    bench.write(
        "h/baseline.json",
        "{\"schema\": 1, \"night\": \"n\", \"accepted\": \"\", \"operator\": null}",
    );
    refused(&night, "octant nightly accept --history h accepts another");
    std::fs::remove_file(bench.at("h/baseline.json")).unwrap();
    assert!(!bench.at("h/nights").exists(), "nothing has run");
}

/// Every command line of the CI examples is accepted by the program, and the files are consistently
/// indented YAML.
#[test]
fn the_examples_for_ci_call_the_program_as_it_is() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/nightly"));
    for name in ["github.yml", "gitlab.yml"] {
        let text = std::fs::read_to_string(folder.join(name)).unwrap();
        let joined = text.replace("\\\n", " ");
        let lines: Vec<&str> = joined
            .lines()
            .map(|line| line.trim().trim_start_matches("- ").trim_start_matches("run: "))
            .filter(|line| line.starts_with("octant "))
            .collect();
        assert!(lines.len() >= 2, "{name}: {lines:?}");
        for line in lines {
            // The part after a shell operator doesn't belong to the program.
            let line = line.split(" || ").next().unwrap().split(" > ").next().unwrap();
            let words = line.split_whitespace().map(|word| word.trim_matches('"'));
            octant::parses(words).unwrap_or_else(|error| panic!("{name}: {line}\n{error}"));
        }
        assert!(!text.contains('\t'), "{name}");
    }
}

/// A signal leaves no result and finds nothing, and the same command resumes the same night.
#[cfg(target_os = "linux")]
#[test]
fn a_night_that_is_interrupted_goes_on_and_finds_nothing() {
    use crate::common::running::{Running, Target, gone};
    use rustix::process::Signal;
    let bench = Bench::new();
    bench.edit("night.toml", "replicates = 16", "replicates = 4");
    bench.edit("short.toml", "40 min", "3 h");
    assert_eq!(bench.night(&["--suite", "suite.toml", "--first"]).0, Some(0));
    let words = [
        "nightly",
        "night.toml",
        "--suite",
        "suite.toml",
        "--history",
        "h",
        "--json",
        "--jobs",
        "2",
    ];
    for (target, signal) in [
        (Target::Group, Signal::INT),
        (Target::Parent, Signal::KILL),
        (Target::Child, Signal::INT),
        (Target::Group, Signal::TERM),
        (Target::Child, Signal::KILL),
    ] {
        let mut running = Running::start(bench.folder.path(), &words);
        let children = running.children();
        running.signal(target, signal);
        let output = running.end();
        gone(&children);
        let status = output.status.code();
        assert!(matches!(status, None | Some(0 | 3)), "{signal:?}: {output:?}");
    }
    let (status, night) = bench.night(&["--suite", "suite.toml"]);
    assert_eq!((status, &night["verdict"]), (Some(0), &Value::from("pass")), "{night}");
    assert_eq!(night["reasons"], serde_json::json!(["no regression found"]));
    assert_eq!(night["campaigns"][0]["differing"], serde_json::json!([]));
}
