//! A campaign of many cases: files, processor time and memory of the commands that read all of its results.
//!
//! The results are made from one real case, whose drift is different in each. `OCTANT_SCALE=1000,10000,100000`
//! measures campaigns of these sizes and prints a row of the table of `docs/campaigns.md` for each;
//! `OCTANT_SCALE_COMMANDS=run,status` measures these commands alone, and `plan` a plan without results.
//! `OCTANT_SCALE_POINTS=10` keeps this number of points of each drift, for a million results on a small
//! disk. `OCTANT_SCALE_FOLDER=PATH` keeps the campaigns there, and takes those that are there.
//! `OCTANT_SCALE_PROGRAM=PATH` measures another program than the one under test.

use crate::campaign_report::bench::{Bench, drawn};
use crate::common::program::program;
use octant_base::control::Control;
use octant_campaign::execute::case;
use octant_campaign::plan::{Case, Plan};
use octant_campaign::store::{keep_in, writer::PartWriter};
use octant_test_processes::start;
use serde_json::Value;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Short runs: what is measured is the cost of many results, not of long ones.
const SCENARIO: &str = "schema = 1
title = \"scale\"
seed = 1
[procedure.calibration]
positions = \"eight\"
duration = \"24 min\"
[procedure.navigation]
duration = \"10 min\"
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
fn fill(plan: &Plan, folder: &Path, points: Option<usize>) {
    let first = &plan.cases[0];
    let result = case::run(plan.planned(first).unwrap(), first, &Control::default()).unwrap();
    let template: Value = serde_json::from_str(&result.to_json().unwrap()).unwrap();
    assert_eq!(template["verdict"], "pass", "{}", template["summary"]["reasons"]);
    let mut template = template;
    if let Some(points) = points {
        let series = &mut template["summary"]["navigation"]["series_hours"];
        let all = series.as_array().unwrap();
        let last = all.len() - 1;
        let kept = (0..points).map(|point| all[point * last / (points - 1)].clone());
        *series = kept.collect::<Vec<_>>().into();
    }
    let template = &template;
    // Two processes would have run every other case.
    std::thread::scope(|scope| {
        for (part, stem) in ["1-of-2", "2-of-2"].into_iter().enumerate() {
            let mut writer = PartWriter::new(folder, stem).unsynced();
            scope.spawn(move || {
                for (index, case) in plan.cases.iter().enumerate().skip(part).step_by(2) {
                    let text = made(plan, index, case, template);
                    keep_in(&mut writer, &case.id, text.as_bytes(), &[]).unwrap();
                }
            });
        }
    });
}

/// Makes the result of a case from another one.
fn made(plan: &Plan, index: usize, case: &Case, template: &Value) -> String {
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
    format!("{result}\n")
}

/// Cost of a command.
struct Cost {
    wall_s: f64,
    /// Time of processors, s.
    processor_s: f64,
    /// Peak of the memory, MiB.
    mib: f64,
    said: String,
}

/// Processor time of a process that runs, s; Linux counts hundredths.
fn processor_s(id: u32) -> Option<f64> {
    let text = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    let fields: Vec<&str> = text.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |index: usize| fields.get(index)?.parse::<f64>().ok();
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

/// Runs a command on the campaign to its end.
fn cost(folder: &Path, command: &[&str]) -> Cost {
    let begun = Instant::now();
    let mut program = match variable("OCTANT_SCALE_PROGRAM") {
        None => program(command),
        Some(path) => {
            let mut other = octant_test_processes::command(path);
            other.args(command);
            other
        }
    };
    program.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::inherit());
    let mut child = start(&mut program);
    let path = format!("/proc/{}/status", child.id());
    let (mut kib, mut used_s) = (0.0, 0.0);
    loop {
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let found = line.and_then(|line| line.trim().trim_end_matches(" kB").parse::<f64>().ok());
        kib = found.unwrap_or(kib);
        used_s = processor_s(child.id()).unwrap_or(used_s);
        if child.try_wait().unwrap().is_some() {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let output = child.output();
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{command:?}: {:?}: {said}", output.status);
    Cost { wall_s, processor_s: used_s, mib: kib / 1024.0, said }
}

/// Makes a campaign, and measures the commands that read its results.
fn measured(cases: usize, commands: &[&str]) -> Vec<Cost> {
    let bench = Bench::new(&campaign(cases));
    std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
    let folder = match variable("OCTANT_SCALE_FOLDER") {
        None => bench.at(""),
        Some(folder) => {
            let folder = Path::new(&folder).join(cases.to_string());
            std::fs::create_dir_all(&folder).unwrap();
            for file in ["short.toml", "requirements.toml", "campaign.toml"] {
                std::fs::copy(bench.at(file), folder.join(file)).unwrap();
            }
            folder
        }
    };
    let planned = cost(&folder, &["campaign", "plan", "campaign.toml", "--out", "out"]);
    let out = folder.join("out");
    let commands = commands.strip_prefix(&["plan"]).unwrap_or(commands);
    if !commands.is_empty() && !out.join("results").exists() {
        let plan = Plan::read(&out.join("plan.json")).unwrap();
        assert_eq!(plan.cases.len(), cases);
        let points = variable("OCTANT_SCALE_POINTS").map(|points| points.parse().unwrap());
        fill(&plan, &out, points);
    }
    let parts: Vec<u64> = std::fs::read_dir(out.join("results"))
        .into_iter()
        .flatten()
        .map(|entry| entry.unwrap().metadata().unwrap().len())
        .collect();
    let bytes: u64 = parts.iter().sum();
    let row = |cost: &Cost| {
        format!("{:.2} s ({:.2} s), {:.0} MB", cost.processor_s, cost.wall_s, cost.mib)
    };
    print!("| {cases} | {} | {:.1} MB | {}", parts.len(), bytes as f64 / 1e6, row(&planned));
    assert!(planned.said.starts_with(&format!("{cases} cases")), "{}", planned.said);
    let mut costs = vec![planned];
    for command in commands {
        let arguments = match *command {
            "verify" => vec!["verify", "out"],
            command => vec!["campaign", command, "out"],
        };
        let cost = cost(&folder, &arguments);
        print!(" | {command} {}", row(&cost));
        let expected = match *command {
            "run" => format!("{cases} with a result already"),
            "status" => format!("{cases} of {cases} cases have run"),
            "merge" => format!("{cases} of {cases} cases"),
            _ => String::new(),
        };
        assert!(cost.said.contains(&expected), "{}", cost.said);
        costs.push(cost);
    }
    println!(" |");
    costs
}

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

/// Largest memory of a command, MiB.
const MIB_MAX: f64 = 300.0;
/// Most by which the memory of a command grows for each further case, kB, once what waits in its threads and buffers is
/// there, as it is with some hundreds of cases, beside what differs from run to run, MiB. A
/// result takes 40 kB in memory.
const GROWTH_KB: f64 = 0.3;
const NOISE_MIB: f64 = 6.0;

#[test]
#[cfg_attr(not(target_os = "linux"), ignore = "memory as Linux tells it")]
fn many_results_are_read_in_little_memory() {
    let of = |name: &str, default: &str| variable(name).unwrap_or_else(|| default.to_owned());
    let commands = of("OCTANT_SCALE_COMMANDS", "run,status,merge,report,verify");
    let commands: Vec<&str> = commands.split(',').collect();
    let mut smallest: Option<(usize, Vec<f64>)> = None;
    for cases in of("OCTANT_SCALE", "300,900").split(',') {
        let cases: usize = cases.trim().parse().unwrap();
        let names = std::iter::once(&"plan").chain(commands.iter().filter(|name| **name != "plan"));
        let costs = measured(cases, &commands);
        let (fewest, least) =
            smallest.get_or_insert_with(|| (cases, costs.iter().map(|cost| cost.mib).collect()));
        let more = cases.saturating_sub(*fewest) as f64;
        for ((cost, command), least) in costs.iter().zip(names).zip(least) {
            assert!(cost.mib < MIB_MAX, "{command} of {cases} cases: {} MB", cost.mib);
            let grown = cost.mib - *least;
            assert!(
                grown < NOISE_MIB + GROWTH_KB * more / 1024.0,
                "{command}: {grown} MB more for {more} more cases"
            );
        }
    }
}
