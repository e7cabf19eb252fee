//! Campaigns whose results are derived from one real result.

use crate::common::program::program;
use crate::common::results;
use octant_base::control::Control;
use octant_campaign::execute::case;
use octant_campaign::plan::{Case, Plan};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::LazyLock;
use tempfile::TempDir;

pub(crate) const SCENARIO: &str = "schema = 1
title = \"short\"
seed = 1
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
[[faults]]
id = \"spike-1\"
kind = \"spike\"
trigger = { at = \"500 s\" }
duration = \"10 samples\"
channels = \"gyro x\"
amplitude = \"100 deg/h\"
[[requirements]]
id = \"CAL-1\"
text = \"No parameter is <far> off.\"
measure = \"calibration.worst_normalized_error\"
limit = 50
";

pub(crate) const REQUIREMENTS: &str = "schema = 1
title = \"Requirements\"
[[requirements]]
id = \"NAV-1\"
text = \"The position stays <b>near</b> & known.\"
measure = \"navigation.radial_error_nmi.max\"
limit = \"10 nmi\"
pass = \"80 %\"
confidence = \"90 %\"
clause = \"Spec 3.1\"
[[requirements]]
id = \"DOC-1\"
text = \"There is a manual.\"
verification = \"inspection\"
";

/// 2 latitudes of 40 instruments; the names need escaping on a page.
pub(crate) const CAMPAIGN: &str = "schema = 1
title = \"T<script>alert(1)</script> & co\"
seed = 1
replicates = 40
requirements = \"requirements.toml\"
[[scenarios]]
id = \"short <i>&\"
file = \"short.toml\"
[[factors]]
name = \"latitude\"
key = \"site.latitude\"
values = [\"0 deg\", \"60 deg\"]
[[factors]]
name = \"fault\"
faults = [[], [\"spike-1\"]]
draw = true
[[factors]]
name = \"amp <b>\"
key = \"faults.spike-1.amplitude\"
unit = \"deg/h\"
uniform = [10, 1000]
[[factors]]
name = \"north\"
key = \"site.height\"
unit = \"m\"
uniform = [0, 100]
";

/// Result of one real case, whose numbers the tests change.
pub(crate) static TEMPLATE: LazyLock<Value> = LazyLock::new(|| {
    let bench = Bench::new(CAMPAIGN);
    let plan = bench.plan();
    let spiked = |case: &&Case| case.faults == Some(["spike-1"].into_iter().collect());
    let case = plan.cases.iter().find(spiked).unwrap();
    let result = case::run(plan.planned(case).unwrap(), case, &Control::default()).unwrap();
    let value: Value = serde_json::from_str(&result.to_json().unwrap()).unwrap();
    assert_eq!((value["verdict"].as_str(), &value["error"]), (Some("pass"), &Value::Null));
    assert_eq!(value["summary"]["faults"][0]["fired"], true);
    value
});

pub(crate) struct Bench {
    folder: TempDir,
}

impl Bench {
    pub(crate) fn new(campaign: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
        std::fs::write(bench.at("requirements.toml"), REQUIREMENTS).unwrap();
        std::fs::write(bench.at("campaign.toml"), campaign).unwrap();
        bench
    }

    pub(crate) fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn plan(&self) -> Plan {
        Plan::of(&self.at("campaign.toml")).unwrap()
    }

    /// Makes a plan with a result for each of its cases in `out`.
    pub(crate) fn filled(
        campaign: &str,
        change: impl Fn(usize, &Case, &mut Value),
    ) -> (Self, Plan, PathBuf) {
        Self::new(campaign).fill(change)
    }

    /// Fills the campaign that is already in the folder.
    pub(crate) fn fill(self, change: impl Fn(usize, &Case, &mut Value)) -> (Self, Plan, PathBuf) {
        let bench = self;
        let (plan, out) = (bench.plan(), bench.at("out"));
        plan.write(&out, false).unwrap();
        for (index, case) in plan.cases.iter().enumerate() {
            let mut result = synthetic(&plan, index, case);
            change(index, case, &mut result);
            put(&out, case, &result);
        }
        (bench, plan, out)
    }

    pub(crate) fn octant(&self, arguments: &[&str]) -> Output {
        self.octant_with(arguments, &[])
    }

    pub(crate) fn octant_with(&self, arguments: &[&str], variables: &[(&str, &Path)]) -> Output {
        program(arguments)
            .current_dir(self.folder.path())
            .envs(variables.iter().copied())
            .output()
            .unwrap()
    }

    pub(crate) fn report(&self) -> (i32, String) {
        let output = self.octant(&["campaign", "report", "out"]);
        let said =
            String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        (output.status.code().unwrap(), said)
    }

    pub(crate) fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at("out").join(name)).unwrap()
    }

    pub(crate) fn statistics(&self) -> Value {
        serde_json::from_str(&self.read("statistics.json")).unwrap()
    }
}

pub(crate) fn put(folder: &Path, case: &Case, result: &Value) {
    let mut result = result.clone();
    if !result["summary"].is_null() {
        result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
    }
    results::put(folder, &case.id, &format!("{result}\n"));
}

/// Returns a number between 0 and 1 that looks random, no two alike.
pub(crate) fn drawn(index: usize) -> f64 {
    ((index * 37 + 11) % 101) as f64 / 101.0 + index as f64 * 1e-5
}

pub(crate) fn final_nmi(index: usize) -> f64 {
    0.2 + drawn(index) * drawn(index + 5)
}

pub(crate) fn rate(index: usize) -> f64 {
    0.05 + 0.4 * drawn(index + 3)
}

pub(crate) fn synthetic(plan: &Plan, index: usize, case: &Case) -> Value {
    let mut result = TEMPLATE.clone();
    result["case_blake3"] = case::hash_of(plan.planned(case).unwrap(), case).into();
    result["case"] = case.id.as_str().into();
    let summary = &mut result["summary"];
    summary["seed"] = case.seed.into();
    summary["stream_hash"] = format!("{index:064x}").into();
    let spiked = case.faults.as_ref().is_some_and(|faults| !faults.is_empty());
    if !spiked {
        summary["faults"] = json!([]);
    }
    let navigation = &mut summary["navigation"];
    let radial = &mut navigation["radial_error_nmi"];
    radial["final"] = final_nmi(index).into();
    radial["max"] = (1.5 * final_nmi(index)).into();
    radial["rms"] = (0.7 * final_nmi(index)).into();
    radial["rate_per_h"] = rate(index).into();
    // Ramps: their values are known at any time, whatever points are kept.
    let end = navigation["duration_h"].as_f64().unwrap();
    let bend = end * (0.3 + 0.002 * (index % 40) as f64);
    let at = |hours: f64| json!([hours, drawn(index) * hours, -2.0 * drawn(index + 1) * hours]);
    navigation["series_hours"] = json!([at(0.0), at(bend), at(end)]);
    check(&mut result, "NAV-1", 1.5 * final_nmi(index), 10.0);
    result
}

/// Sets the value of a check, and the resulting verdict of the case.
pub(crate) fn check(result: &mut Value, id: &str, value: f64, limit: f64) {
    let summary = &mut result["summary"];
    let verdict = if value <= limit { "pass" } else { "fail" };
    match id {
        "NAV-1" => summary["navigation"]["radial_error_nmi"]["max"] = value.into(),
        "CAL-1" => summary["calibration"]["worst_normalized_error"] = value.into(),
        _ => panic!("no measure of {id} is known"),
    }
    for check in summary["requirements"].as_array_mut().unwrap() {
        if check["id"] == id {
            check["value"] = value.into();
            check["margin"] = (limit - value).into();
            check["verdict"] = verdict.into();
        }
    }
    if verdict == "fail" {
        summary["verdict"] = "fail".into();
        summary["reasons"] = json!([format!("{id} is broken")]);
        result["verdict"] = "fail".into();
    }
}

/// Reads every file of a folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![folder.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                found.insert(path.clone(), std::fs::read(&path).unwrap());
            }
        }
    }
    found
}

/// Gives cases every kind of problem.
pub(crate) fn troubled(index: usize, _: &Case, result: &mut Value) {
    match index {
        0 => check(result, "CAL-1", 99.0, 50.0),
        3 => {
            *result = json!({"schema": 1, "case": result["case"], "verdict": "error",
                             "error": "it took <more> than its 2 s", "summary": null});
        }
        5 => {
            let receipt = &mut TEMPLATE["summary"]["faults"][0].clone();
            receipt["fired"] = false.into();
            result["summary"]["faults"] = json!([receipt]);
            result["summary"]["verdict"] = "inconclusive".into();
            result["verdict"] = "inconclusive".into();
        }
        7 => {
            // A hundred times as large as the others.
            check(result, "NAV-1", 9.0, 10.0);
            result["summary"]["navigation"]["radial_error_nmi"]["rate_per_h"] = 40.0.into();
        }
        _ => {}
    }
}
