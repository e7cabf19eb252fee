//! Campaigns whose cases have twins, from the plan to tables, report and night.

use crate::common::program::octant_in;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

/// A calibration of 100 s with two spikes, and a limit on what each of them does.
pub const SCENARIO: &str = "schema = 1
title = \"twins\"
seed = 1
[imu]
rate = \"50 Hz\"
[procedure.calibration]
duration = \"100 s\"
stops = [{ azimuth = \"0 deg\", roll = \"0 deg\" }, { azimuth = \"0 deg\", roll = \"45 deg\" }]
[[faults]]
id = \"spike-1\"
kind = \"spike\"
trigger = { at = \"60 s\" }
duration = \"2 samples\"
channels = \"gyro x\"
amplitude = \"30 deg/h\"
[[faults]]
id = \"spike-2\"
kind = \"spike\"
trigger = { at = \"70 s\" }
duration = \"2 samples\"
channels = \"gyro y\"
amplitude = \"30 deg/h\"
[[requirements]]
id = \"SHIFT\"
text = \"No parameter moves.\"
measure = \"counterfactual.worst_shift_sigma\"
limit = 3
[[requirements]]
id = \"SEEN\"
text = \"The fault is noticed.\"
measure = \"counterfactual.undetected\"
limit = 0
[[requirements]]
id = \"SOON\"
text = \"It is noticed soon.\"
measure = \"counterfactual.detection_delay_max_s\"
limit = \"1 s\"
[[requirements]]
id = \"QUIET\"
text = \"No false alarms.\"
measure = \"counterfactual.false_alarms\"
limit = 0
";

pub const CAMPAIGN: &str = "schema = 1
title = \"twins\"
replicates = 6
[[scenarios]]
id = \"twins\"
file = \"twins.toml\"
[[factors]]
name = \"fault\"
faults = [[\"spike-1\"], [\"spike-2\"]]
";

/// Writes the inputs of a campaign.
pub fn written(folder: &Path, scenario: &str, campaign: &str) {
    std::fs::write(folder.join("twins.toml"), scenario).unwrap();
    std::fs::write(folder.join("campaign.toml"), campaign).unwrap();
}

struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().unwrap());
        written(bench.0.path(), SCENARIO, CAMPAIGN);
        bench
    }

    fn octant(&self, words: &[&str]) -> String {
        let output = octant_in(self.0.path(), words);
        let text = [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned());
        assert_eq!(output.status.code(), Some(0), "{words:?}: {}{}", text[0], text[1]);
        text[0].clone()
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.0.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }
}

#[test]
fn tables_statistics_page_and_junit_have_the_effects_whole_or_in_shards() {
    let bench = Bench::new();
    for out in ["whole", "shards", "undivided"] {
        bench.octant(&["campaign", "plan", "campaign.toml", "--out", out]);
    }
    bench.octant(&["campaign", "run", "whole", "--jobs", "2"]);
    // A shard has cases of a draw whose twin another shard computes too.
    for shard in ["1/3", "2/3", "3/3"] {
        bench.octant(&["campaign", "run", "shards", "--shard", shard, "--jobs", "1"]);
    }
    bench.octant(&["campaign", "run", "undivided", "--undivided"]);
    for out in ["whole", "shards", "undivided"] {
        bench.octant(&["campaign", "merge", out]);
        for table in ["cases", "checks", "drift"] {
            let [this, whole] =
                [out, "whole"].map(|of| bench.bytes(&format!("{of}/{table}.parquet")));
            assert!(this == whole, "{out}/{table}");
        }
    }
    let columns = String::from_utf8_lossy(&bench.bytes("whole/cases.parquet")).into_owned();
    assert!(columns.contains("counterfactual.worst_shift_sigma"));

    bench.octant(&["campaign", "report", "whole"]);
    let statistics: Value = serde_json::from_str(&bench.text("whole/statistics.json")).unwrap();
    assert_eq!(statistics["verdict"], "pass");
    for combination in statistics["combinations"].as_array().unwrap() {
        let effects = &combination["effects"];
        let counted = ["compared", "beyond", "missed", "refused", "with_false_alarms"]
            .map(|name| effects[name].as_u64().unwrap());
        assert_eq!(counted, [6, 0, 0, 0, 0], "{effects}");
        assert_eq!(effects["detected"]["value"], 1.0);
        // Six of six, 95 %: 0.025^(1/6).
        let low = effects["detected"]["low"].as_f64().unwrap();
        assert!((low - 0.025f64.powf(1.0 / 6.0)).abs() < 1e-9, "{low}");
        assert!(effects["worst_shift_sigma"]["p50"]["value"].as_f64().unwrap() < 3.0);
        assert!(effects["detection_delay_s"]["p95"]["value"].as_f64().unwrap() <= 1.0);
    }
    let ids =
        statistics["requirements"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap());
    assert_eq!(ids.collect::<Vec<_>>(), ["QUIET", "SEEN", "SHIFT", "SOON"]);
    let page = bench.text("whole/report.html");
    assert!(
        page.contains("Effects of faults") && page.contains("Largest shift 50 %"),
        "no section"
    );
    let junit = bench.text("whole/junit.xml");
    for id in ["SHIFT", "SEEN", "SOON", "QUIET"] {
        assert!(junit.contains(id), "{id}");
    }
    bench.octant(&["verify", "whole"]);
    bench.octant(&["verify", "whole", "--reexecute", "4"]);
}

#[test]
fn a_night_compares_the_effects_of_its_campaigns() {
    let bench = Bench::new();
    bench.octant(&["nightly", "campaign.toml", "--history", "h", "--first"]);
    let night: Value = serde_json::from_str(&bench.octant(&[
        "nightly",
        "campaign.toml",
        "--history",
        "h",
        "--json",
    ]))
    .unwrap();
    assert_eq!(night["verdict"], "pass", "{night}");
    let tests = night["comparison"]["tests"].as_array().unwrap();
    let measures: Vec<&str> = tests.iter().map(|test| test["measure"].as_str().unwrap()).collect();
    for id in ["SHIFT", "SOON"] {
        assert!(measures.iter().any(|measure| measure.contains(id)), "{id}: {measures:?}");
    }
    assert!(tests.iter().all(|test| test["change"] == "same"), "{night}");
}
