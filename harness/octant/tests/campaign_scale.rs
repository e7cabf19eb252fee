//! A campaign of many cases: files, seconds and memory of the commands that read all of its results.
//!
//! The results are made from one real case, whose numbers differ from case to case, so that they compress
//! as real ones do. `OCTANT_SCALE=1000,10000,100000` measures campaigns of these sizes and prints a row of
//! the table of `docs/campaigns.md` for each.

use crate::campaign_report::bench::{Bench, drawn};
use crate::common::program::program;
use octant_base::control::Control;
use octant_campaign::case;
use octant_campaign::plan::Plan;
use octant_campaign::store::{keep_in, writer::PartWriter};
use serde_json::Value;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Four hours of calibration and four of navigation, as in the certification campaign.
const SCENARIO: &str = "schema = 1
title = \"scale\"
seed = 1
[procedure.calibration]
positions = \"eight\"
duration = \"4 h\"
[procedure.navigation]
duration = \"4 h\"
[[requirements]]
id = \"CAL-1\"
text = \"No parameter is far off.\"
measure = \"calibration.worst_normalized_error\"
limit = 50
";

/// Two latitudes of each instrument.
fn campaign(cases: usize) -> String {
    format!(
        "schema = 1\ntitle = \"scale\"\nreplicates = {}\nrequirements = \"requirements.toml\"\n\
         [[scenarios]]\nid = \"scale\"\nfile = \"short.toml\"\n\
         [[factors]]\nname = \"latitude\"\nkey = \"site.latitude\"\nvalues = [\"0 deg\", \"60 deg\"]\n",
        cases / 2
    )
}

/// Multiplies every number of a series of errors.
fn scale(value: &mut Value, by: f64) {
    match value {
        Value::Number(number) => *value = (number.as_f64().unwrap() * by).into(),
        Value::Array(all) => all.iter_mut().for_each(|one| scale(one, by)),
        Value::Object(all) => all.values_mut().for_each(|one| scale(one, by)),
        _ => {}
    }
}

/// Makes the results of a plan in parts, as two processes would have written them.
fn fill(plan: &Plan, folder: &Path) {
    let first = &plan.cases[0];
    let result = case::run(plan.planned(first).unwrap(), first, &Control::default()).unwrap();
    let template: Value = serde_json::from_str(&result.to_json().unwrap()).unwrap();
    assert_eq!(template["verdict"], "pass", "{}", template["summary"]["reasons"]);
    let mut writers = ["1-of-2", "2-of-2"].map(|stem| PartWriter::new(folder, stem).unsynced());
    for (index, case) in plan.cases.iter().enumerate() {
        let mut result = template.clone();
        result["case"] = case.id.as_str().into();
        result["case_blake3"] = case::hash_of(plan.planned(case).unwrap(), case).into();
        let summary = &mut result["summary"];
        summary["seed"] = case.seed.into();
        summary["stream_hash"] = format!("{index:064x}").into();
        let by = 0.5 + drawn(index) / std::f64::consts::PI;
        let navigation = &mut summary["navigation"];
        for part in ["radial_error_nmi", "latitude_error_arcmin", "longitude_error_arcmin"] {
            scale(&mut navigation[part], by);
        }
        for point in navigation["series_hours"].as_array_mut().unwrap() {
            point.as_array_mut().unwrap()[1..].iter_mut().for_each(|error| scale(error, by));
        }
        let max = navigation["radial_error_nmi"]["max"].as_f64().unwrap();
        for check in summary["requirements"].as_array_mut().unwrap() {
            if check["id"] == "NAV-1" {
                check["value"] = max.into();
                check["margin"] = (check["limit"].as_f64().unwrap() - max).into();
            }
        }
        result["summary_blake3"] = case::hash_of_summary(&result["summary"]).into();
        let text = format!("{result}\n");
        keep_in(&mut writers[index % 2], &case.id, text.as_bytes(), &[]).unwrap();
    }
}

/// Seconds and peak memory of a command.
struct Cost {
    seconds: f64,
    mib: f64,
    said: String,
}

/// Runs a command of a campaign to its end.
fn cost(bench: &Bench, command: &str) -> Cost {
    let begun = Instant::now();
    let mut command = program(&["campaign", command, "out"]);
    command.current_dir(bench.at("")).stdout(Stdio::piped()).stderr(Stdio::inherit());
    let mut child = command.spawn().unwrap();
    let path = format!("/proc/{}/status", child.id());
    let mut kib = 0.0;
    while child.try_wait().unwrap().is_none() {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let found = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
        kib = found.unwrap_or(kib);
        std::thread::sleep(Duration::from_millis(2));
    }
    let seconds = begun.elapsed().as_secs_f64();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{command:?}: {:?}: {said}", output.status);
    Cost { seconds, mib: kib / 1024.0, said }
}

/// Makes a campaign, and measures all commands that read its results.
fn measured(cases: usize) -> [Cost; 4] {
    let bench = Bench::new(&campaign(cases));
    std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
    let (plan, out) = (bench.plan(), bench.at("out"));
    assert_eq!(plan.cases.len(), cases);
    plan.write(&out, false).unwrap();
    fill(&plan, &out);
    let parts: Vec<u64> = std::fs::read_dir(out.join("results"))
        .unwrap()
        .map(|entry| entry.unwrap().metadata().unwrap().len())
        .collect();
    let costs = ["run", "status", "merge", "report"].map(|command| cost(&bench, command));
    let bytes: u64 = parts.iter().sum();
    let figures = costs.iter().map(|cost| format!("{:.2} s, {:.0} MB", cost.seconds, cost.mib));
    println!(
        "| {cases} | {} | {:.1} MB | {} |",
        parts.len(),
        bytes as f64 / 1e6,
        figures.collect::<Vec<_>>().join(" | ")
    );
    costs
}

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "memory as Linux tells it")]
fn many_results_are_read_in_little_memory() {
    let sizes = std::env::var("OCTANT_SCALE").unwrap_or_else(|_| "400".to_owned());
    for cases in sizes.split(',') {
        let cases: usize = cases.trim().parse().unwrap();
        let [run, status, merge, _] = measured(cases);
        assert!(run.said.contains(&format!("{cases} with a result already")), "{}", run.said);
        assert!(
            status.said.contains(&format!("{cases} of {cases} cases have run")),
            "{}",
            status.said
        );
        assert!(merge.said.starts_with(&format!("{cases} of {cases} cases")), "{}", merge.said);
        // The goals of the documentation, for any number of cases up to the largest measured.
        for cost in [&status, &merge] {
            assert!(cost.mib < 300.0, "{cases} cases: {} MB", cost.mib);
        }
    }
}
