//! `octant diff`: equal runs are equal, and the first difference of others is told.

use crate::common::epochs::{Step, push};
use crate::common::program::{ended, octant_in};
use crate::common::stream::stream;
use octant_campaign::table::{ColumnKind, ColumnValue as Cell, ExistingTable};
use octant_recorder::{Policy, Recorder, RecorderOptions, Samples};
use serde_json::Value;
use std::path::Path;

fn record(path: &Path, scenario: &str, samples: Samples, steps: &[Step]) {
    let options = RecorderOptions {
        policy: Policy { samples, ..Policy::default() },
        scenario: scenario.into(),
        metadata: [("seed".to_owned(), "7".to_owned())].into(),
        ..RecorderOptions::default()
    };
    let mut recorder = Recorder::to_file(path, &options).unwrap();
    for step in steps {
        push(&mut recorder, step).unwrap();
    }
    recorder.finish().unwrap();
}

fn diff(folder: &Path, words: &[&str], status: i32) -> String {
    ended(octant_in(folder, &[&["diff"], words].concat()), status).0
}

const SCENARIO: &str = "schema = 1\n[site]\nlatitude = \"30.5 deg\"\n";

#[test]
fn equal_recordings_are_equal() {
    let folder = tempfile::tempdir().unwrap();
    let steps = stream(1000);
    for name in ["a.mcap", "b.mcap"] {
        record(&folder.path().join(name), SCENARIO, Samples::Full, &steps);
    }
    let text = diff(folder.path(), &["a.mcap", "b.mcap"], 0);
    assert!(text.contains("settings: the same") && text.ends_with("\nequal\n"), "{text}");
    assert!(text.contains("a.mcap has no summary of an ended run"), "{text}");
}

#[test]
fn the_first_difference_is_told_with_both_values() {
    let folder = tempfile::tempdir().unwrap();
    let mut steps = stream(1000);
    record(&folder.path().join("a.mcap"), SCENARIO, Samples::Full, &steps);
    let before = steps[400].output.navigation.longitude_rad;
    for step in &mut steps[400..] {
        step.output.navigation.longitude_rad += 1e-6;
    }
    let other = SCENARIO.replace("30.5", "30.6");
    record(&folder.path().join("b.mcap"), &other, Samples::Full, &steps);
    let words = ["a.mcap", "b.mcap", "--json", "--out", "diff.html"];
    let found: Value = serde_json::from_str(&diff(folder.path(), &words, 1)).unwrap();
    assert_eq!(found["equal"], false);
    assert_eq!(found["settings"][0]["key"], "site.latitude");
    assert_eq!(found["settings"][0]["second"], "\"30.6 deg\"");
    let first = &found["stream"]["first"];
    assert_eq!((&first["channel"], &first["field"]), (&"/output".into(), &"longitude_rad".into()));
    assert_eq!(first["time_s"], 2.005);
    assert_eq!(first["first"], before.to_string());
    let output = found["stream"]["channels"].as_array().unwrap();
    let output = output.iter().find(|channel| channel["channel"] == "/output").unwrap();
    assert_eq!((&output["compared"], &output["differing"]), (&1000.into(), &600.into()));
    let text = diff(folder.path(), &["a.mcap", "b.mcap"], 1);
    assert!(text.contains("first difference: /output at 2.005 s, longitude_rad: "), "{text}");
    let page = std::fs::read_to_string(folder.path().join("diff.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("site.latitude"));
}

#[test]
fn recordings_of_other_policies_are_compared_where_both_have_messages() {
    let folder = tempfile::tempdir().unwrap();
    let mut steps = stream(1000);
    record(&folder.path().join("full.mcap"), SCENARIO, Samples::Full, &steps);
    record(&folder.path().join("few.mcap"), SCENARIO, Samples::Decimated, &steps);
    let text = diff(folder.path(), &["full.mcap", "few.mcap"], 0);
    assert!(text.contains("keep different samples"), "{text}");
    steps[399].faulted.sample.delta_theta[0] += 1;
    record(&folder.path().join("other.mcap"), SCENARIO, Samples::Decimated, &steps);
    let text = diff(folder.path(), &["full.mcap", "other.mcap"], 1);
    assert!(text.contains("/imu at 2 s, delta_theta[0]"), "{text}");
}

#[test]
fn a_lost_message_is_a_difference() {
    let folder = tempfile::tempdir().unwrap();
    let steps = stream(1000);
    record(&folder.path().join("a.mcap"), SCENARIO, Samples::Full, &steps);
    record(&folder.path().join("b.mcap"), SCENARIO, Samples::Full, &steps[..900]);
    let text = diff(folder.path(), &["a.mcap", "b.mcap"], 1);
    assert!(text.contains("at 4.505 s, message: recorded | missing"), "{text}");
}

#[test]
fn bad_input_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    std::fs::write(folder.path().join("bad.mcap"), "no").unwrap();
    for (first, told) in [("empty", "expected the folder of a run"), ("bad.mcap", "bad.mcap")] {
        let (_, error) = ended(octant_in(folder.path(), &["diff", first, "empty"]), 2);
        assert!(error.contains(told), "{error}");
    }
}

const SHORT: &str = "schema = 1\ntitle = \"short\"\n[imu]\nrate = \"50 Hz\"\n\
    [procedure.calibration]\npositions = \"eight\"\nduration = \"40 min\"\n\
    [procedure.navigation]\nduration = \"10 min\"\n";

const CAMPAIGN: &str = "schema = 1\ntitle = \"both\"\nseed = 1\nreplicates = 2\n\
    [[scenarios]]\nid = \"short\"\nfile = \"short.toml\"\n\
    [[factors]]\nname = \"latitude\"\nkey = \"site.latitude\"\nvalues = [\"60 deg\", \"1800 arcmin\"]\n";

#[test]
fn campaigns_are_compared_over_their_pairs() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("a.toml"), CAMPAIGN).unwrap();
    let ran = |name: &str, scenario: &str| {
        std::fs::write(at("short.toml"), scenario).unwrap();
        for words in [
            &["campaign", "plan", "a.toml", "--out", name][..],
            &["campaign", "run", name],
            &["campaign", "merge", name],
        ] {
            let output = octant_in(folder.path(), words);
            let error = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(matches!(output.status.code(), Some(0 | 3)), "{words:?}: {error}");
        }
    };
    ran("a", SHORT);
    ran("b", &SHORT.replace("40 min", "41 min"));
    // The factor is a number in the unit of its first value, which the column's metadata names.
    let table = ExistingTable::open(&at("a/cases.parquet")).unwrap();
    assert!(table.columns.contains(&("factor.latitude".to_owned(), ColumnKind::Number)));
    assert_eq!(table.units["factor.latitude"], "deg");
    let latitudes = table.column("factor.latitude").unwrap().unwrap();
    let latitudes: Vec<_> = (0..4).map(|row| latitudes.at(row).unwrap()).collect();
    assert!(latitudes.contains(&Cell::Number(60.0)), "{latitudes:?}");
    let is_thirty = |cell: &Cell| matches!(cell, Cell::Number(x) if (x - 30.0).abs() < 1e-12);
    assert!(latitudes.iter().any(is_thirty), "{latitudes:?}");

    assert!(diff(folder.path(), &["a", "a"], 0).ends_with("\nequal\n"));
    let words = ["a", "b", "--json", "--out", "diff.html"];
    let found: Value = serde_json::from_str(&diff(folder.path(), &words, 1)).unwrap();
    assert_eq!(found["settings"][0]["key"], "scenarios[short].blake3");
    assert_eq!(found["comparison"]["pairings"][0]["pairs"], 4);
    assert_eq!(found["streams"]["differing"], 4);
    assert!(std::fs::read_to_string(at("diff.html")).unwrap().contains("<svg"));
    std::fs::write(at("run.mcap"), "").unwrap();
    let (_, error) = ended(octant_in(folder.path(), &["diff", "a", "run.mcap"]), 2);
    assert!(error.contains("a is a campaign and run.mcap isn't"), "{error}");
}
