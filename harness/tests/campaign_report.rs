//! Reports of campaigns: their numbers by another path, their bytes, dispositions, manifests, and
//! everything that must not look like a pass.
#![allow(clippy::unwrap_used, clippy::cast_precision_loss)]

use octant::campaign::case;
use octant::campaign::plan::{Case, FactorValue, Plan};
use octant::campaign::report::Report;
use octant::evidence::discrepancy::Discrepancy;
use octant::report::number::significant;
use octant::run::Control;
use octant::score::verdict::Verdict;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::LazyLock;
use tempfile::TempDir;

const SCENARIO: &str = "schema = 1
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

const REQUIREMENTS: &str = "schema = 1
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

/// 2 latitudes of 40 instruments; names that a page has to escape.
const CAMPAIGN: &str = "schema = 1
title = \"T<script>alert(1)</script> & co\"
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

/// The result of one real case, whose numbers the tests change.
static TEMPLATE: LazyLock<Value> = LazyLock::new(|| {
    let bench = Bench::new(CAMPAIGN);
    let plan = bench.plan();
    let spiked = |case: &&Case| case.faults == Some(vec!["spike-1".to_owned()]);
    let case = plan.cases.iter().find(spiked).unwrap();
    let result = case::run(plan.planned(case).unwrap(), case, &Control::default()).unwrap();
    let value: Value = serde_json::from_str(&result.to_json().unwrap()).unwrap();
    assert_eq!((value["verdict"].as_str(), &value["error"]), (Some("pass"), &Value::Null));
    assert_eq!(value["summary"]["faults"][0]["fired"], true);
    value
});

struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new(campaign: &str) -> Self {
        let bench = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::write(bench.at("short.toml"), SCENARIO).unwrap();
        std::fs::write(bench.at("requirements.toml"), REQUIREMENTS).unwrap();
        std::fs::write(bench.at("campaign.toml"), campaign).unwrap();
        bench
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn plan(&self) -> Plan {
        Plan::of(&self.at("campaign.toml")).unwrap()
    }

    /// A plan with a result for each of its cases in `out`.
    fn filled(campaign: &str, change: impl Fn(usize, &Case, &mut Value)) -> (Self, Plan, PathBuf) {
        let bench = Self::new(campaign);
        let (plan, out) = (bench.plan(), bench.at("out"));
        plan.write(&out, false).unwrap();
        for (index, case) in plan.cases.iter().enumerate() {
            let mut result = synthetic(index, case);
            change(index, case, &mut result);
            put(&out, case, &result);
        }
        (bench, plan, out)
    }

    fn octant(&self, arguments: &[&str]) -> Output {
        self.octant_with(arguments, &[])
    }

    fn octant_with(&self, arguments: &[&str], variables: &[(&str, &Path)]) -> Output {
        std::process::Command::new(env!("CARGO_BIN_EXE_octant"))
            .current_dir(self.folder.path())
            .args(arguments)
            .envs(variables.iter().copied())
            .output()
            .unwrap()
    }

    fn report(&self) -> (i32, String) {
        let output = self.octant(&["campaign", "report", "out"]);
        let said =
            String::from_utf8(output.stdout).unwrap() + &String::from_utf8(output.stderr).unwrap();
        (output.status.code().unwrap(), said)
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.at("out").join(name)).unwrap()
    }

    fn statistics(&self) -> Value {
        serde_json::from_str(&self.read("statistics.json")).unwrap()
    }
}

fn put(folder: &Path, case: &Case, result: &Value) {
    let path = case::file(folder, &case.id);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(path, format!("{result}\n")).unwrap();
}

/// A number between 0 and 1 that looks drawn, no two alike.
fn drawn(index: usize) -> f64 {
    ((index * 37 + 11) % 101) as f64 / 101.0 + index as f64 * 1e-5
}

fn final_nmi(index: usize) -> f64 {
    0.2 + drawn(index) * drawn(index + 5)
}

fn rate(index: usize) -> f64 {
    0.05 + 0.4 * drawn(index + 3)
}

fn synthetic(index: usize, case: &Case) -> Value {
    let mut result = TEMPLATE.clone();
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
    // Ramps: what they are at any time is known, whatever points are kept of them.
    let end = navigation["duration_h"].as_f64().unwrap();
    let bend = end * (0.3 + 0.002 * (index % 40) as f64);
    let at = |hours: f64| json!([hours, drawn(index) * hours, -2.0 * drawn(index + 1) * hours]);
    navigation["series_hours"] = json!([at(0.0), at(bend), at(end)]);
    check(&mut result, "NAV-1", 1.5 * final_nmi(index), 10.0);
    result
}

/// Gives a check another value, and the case what comes of it.
fn check(result: &mut Value, id: &str, value: f64, limit: f64) {
    let summary = &mut result["summary"];
    let verdict = if value <= limit { "pass" } else { "fail" };
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

/// Percentile, definition 7 of Hyndman and Fan.
fn percentile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p * (sorted.len() - 1) as f64;
    let low = at.floor() as usize;
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] * (1.0 - at.fract()) + sorted[high] * at.fract()
}

/// P(X ≤ k) of a binomial, by adding up.
fn binomial(k: u64, n: u64, p: f64) -> f64 {
    let choose = |i: u64| (0..i).map(|j| ((n - j) as f64 / (j + 1) as f64).ln()).sum::<f64>();
    (0..=k).map(|i| (choose(i) + i as f64 * p.ln() + (n - i) as f64 * (1.0 - p).ln()).exp()).sum()
}

/// The order statistics that bound a quantile at 95 %, two-sided: the definition, rank by rank.
fn bounds(values: &[f64], p: f64) -> (f64, f64) {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as u64;
    let above = |rank: u64| binomial(rank - 1, n, p) >= 0.975;
    let below = |rank: u64| 1.0 - binomial(rank - 1, n, p) >= 0.975;
    let high = (1..=n).find(|rank| above(*rank));
    let low = (1..=n).rev().find(|rank| below(*rank));
    let at = |rank: Option<u64>, none| rank.map_or(none, |rank| sorted[rank as usize - 1]);
    (at(low, f64::NEG_INFINITY), at(high, f64::INFINITY))
}

/// Spearman's ρ of values without ties.
fn spearman(x: &[f64], y: &[f64]) -> f64 {
    let rank = |all: &[f64], v: f64| all.iter().filter(|other| **other < v).count() as f64;
    let n = x.len() as f64;
    let squares: f64 = x.iter().zip(y).map(|(a, b)| (rank(x, *a) - rank(y, *b)).powi(2)).sum();
    1.0 - 6.0 * squares / (n * (n * n - 1.0))
}

fn near(found: &Value, expected: f64) {
    let number = found.as_f64().unwrap_or_else(|| panic!("found {found}, expected {expected}"));
    assert!((number - expected).abs() <= 1e-9 * expected.abs().max(1.0), "{number} {expected}");
}

/// An interval; an end that isn't finite is null.
fn interval(found: &Value, value: f64, (low, high): (f64, f64)) {
    near(&found["value"], value);
    for (end, expected) in [("low", low), ("high", high)] {
        if expected.is_finite() {
            near(&found[end], expected)
        } else {
            assert!(found[end].is_null())
        }
    }
}

#[test]
fn the_numbers_are_those_of_another_path_and_stand_on_the_page() {
    // Every ninth case breaks NAV-1.
    let broken = |index: usize| index % 9 == 4;
    let (bench, plan, _) = Bench::filled(CAMPAIGN, |index, _, result| {
        if broken(index) {
            check(result, "NAV-1", 12.5, 10.0);
        }
    });
    let (status, said) = bench.report();
    assert_eq!(plan.cases.len(), 80);
    let (statistics, page) = (bench.statistics(), bench.read("report.html"));
    assert_eq!(statistics["combinations"].as_array().unwrap().len(), 2);
    let mut tests = 0;
    for (place, latitude) in ["0 deg", "60 deg"].into_iter().enumerate() {
        let found = &statistics["combinations"][place];
        assert_eq!(found["factors"]["latitude"], latitude);
        let mine: Vec<usize> = (0..80).filter(|index| index % 2 == place).collect();
        let of = |f: &dyn Fn(usize) -> f64| mine.iter().map(|i| f(*i)).collect::<Vec<f64>>();
        let (last, rates) = (of(&final_nmi), of(&rate));
        let shown = |value: f64, (low, high): (f64, f64)| {
            let end = |v: f64, none: &str| {
                if v.is_finite() { significant(v, 3) } else { none.to_owned() }
            };
            let text = format!(
                "{}<div class=\"reason\">{} to {}</div>",
                significant(value, 3),
                end(low, "0"),
                end(high, "∞")
            );
            assert!(page.contains(&text), "{text}");
        };
        for (name, values, p) in [
            ("/at_end/cep50", &last, 0.5),
            ("/at_end/r95", &last, 0.95),
            ("/rate_nmi_per_h/rate50", &rates, 0.5),
            ("/rate_nmi_per_h/rate95", &rates, 0.95),
            ("/time_rms_nmi/p95", &last.iter().map(|v| 0.7 * v).collect(), 0.95),
        ] {
            let (value, ends) = (percentile(values, p), bounds(values, p));
            interval(found.pointer(name).unwrap(), value, ends);
            shown(value, ends);
        }
        let squares: f64 = last.iter().map(|v| v * v).sum();
        near(&found["at_end"]["drms"], (squares / last.len() as f64).sqrt());

        // The envelope of ramps is the percentile of their slopes, times the time.
        let envelope = &found["envelope"];
        let hours = envelope["hours"].as_array().unwrap();
        assert!(hours.len() > 100, "{}", hours.len());
        for (curve, p) in [0.05, 0.25, 0.5, 0.75, 0.95].into_iter().enumerate() {
            let slope = percentile(&of(&|index| -2.0 * drawn(index + 1)), p);
            for (k, time) in hours.iter().enumerate() {
                near(&envelope["longitude_arcmin"][curve][k], slope * time.as_f64().unwrap());
            }
        }

        // A factor of a fault counts where the fault is injected.
        for factor in found["sensitivity"].as_array().unwrap() {
            let name = factor["factor"].as_str().unwrap();
            let takes = |index: &&usize| {
                let faults = plan.cases[**index].faults.as_ref().unwrap();
                name == "north" || !faults.is_empty()
            };
            let part: Vec<usize> = mine.iter().filter(takes).copied().collect();
            let x: Vec<f64> = part
                .iter()
                .map(|index| match plan.cases[*index].factors[name] {
                    FactorValue::Number(number) => number,
                    FactorValue::Text(_) => unreachable!(),
                })
                .collect();
            let y: Vec<f64> = part.iter().map(|index| rate(*index)).collect();
            assert_eq!(factor["cases"], part.len());
            assert!(part.len() > 5 && (name == "north") == (part.len() == 40), "{name}");
            near(&factor["correlation"]["rho"], spearman(&x, &y));
            tests += 1;
        }
    }
    assert_eq!(tests, 4, "two factors in each combination");

    let nav = &statistics["requirements"][1];
    assert_eq!((nav["id"].as_str(), nav["clause"].as_str()), (Some("NAV-1"), Some("Spec 3.1")));
    let fails = (0..80).filter(|index| broken(*index)).count() as u64;
    assert_eq!((fails, nav["counts"]["fail"].as_u64()), (9, Some(9)));
    // The bound is where so few failures have a probability of 10 %.
    let bound = nav["lower_bound"].as_f64().unwrap();
    assert!((binomial(fails, 80, 1.0 - bound) - 0.1).abs() < 1e-9, "{bound}");
    assert!(page.contains(&format!("{} %", (bound * 1e4).floor() / 1e2)), "{bound}");
    near(&nav["nearest"]["margin"], -2.5);
    let verdict = if bound >= 0.8 { "pass" } else { "inconclusive" };
    assert_eq!(nav["verdict"], verdict);
    // As many more passes as it takes, and not one less.
    let needed = nav["needed_if_all_pass"]["runs"].as_u64().unwrap();
    let shown = |runs: u64| binomial(fails, runs, 0.2) <= 0.1;
    assert!(shown(80 + needed) && (needed == 0 || !shown(79 + needed)), "{needed}");
    let settled = nav["convergence"].as_array().unwrap().last().unwrap();
    assert_eq!(settled["runs"], 80);
    near(&settled["estimate"]["value"], 71.0 / 80.0);
    let exit = if verdict == "pass" { 0 } else { 3 };
    assert_eq!(status, exit, "{said}");
    // Nine cases failed, in two combinations: whatever the verdict, somebody has to say something.
    let failed: Vec<&Value> = (statistics["discrepancies"].as_array().unwrap().iter())
        .filter(|found| found["kind"] == "check")
        .collect();
    assert_eq!(failed.len(), 2);
    let cases: usize = failed.iter().map(|found| found["cases"].as_array().unwrap().len()).sum();
    assert_eq!(cases, 9);
}

/// Cases that differ by their seed alone are an ensemble: the page holds its prediction against them, and
/// says that there are too few. Without the file of the scenario there is a report all the same.
#[test]
fn predictions_stand_beside_the_cases() {
    let draws = CAMPAIGN.find("[[factors]]\nname = \"amp").unwrap();
    let campaign = CAMPAIGN[..draws]
        .replace("replicates = 40", "replicates = 3")
        .replace("faults = [[], [\"spike-1\"]]\ndraw = true", "faults = [[], [\"spike-1\"]]");
    let bench = Bench::new(&campaign);
    bench.plan().write(&bench.at("out"), false).unwrap();
    assert_eq!(bench.octant(&["campaign", "run", "out"]).status.code(), Some(0));
    assert_eq!(bench.report().0, 0);
    let prediction: Value = serde_json::from_str(&bench.read("prediction.json")).unwrap();
    let compared = prediction["compared"].as_array().unwrap();
    assert_eq!((prediction["schema"].as_u64(), compared.len()), (Some(1), 2), "two latitudes");
    for comparison in compared {
        assert_eq!(comparison["runs"], 3);
        assert_eq!(comparison["states"].as_array().unwrap().len(), 30);
        // One of them by another path: σ about the mean, from the results of the cases.
        let set = comparison["set"].as_array().unwrap();
        let mut errors = Vec::new();
        for case in bench.plan().cases.iter().filter(|case| case.faults == Some(Vec::new())) {
            if set.iter().all(|one| case.set.iter().any(|other| one == other.as_str())) {
                let text = std::fs::read_to_string(case::file(&bench.at("out"), &case.id)).unwrap();
                let result: Value = serde_json::from_str(&text).unwrap();
                let parameters = &result["summary"]["calibration"]["parameters"];
                errors.push(parameters["gyro_bias_z"]["error"].as_f64().unwrap());
            }
        }
        assert_eq!(errors.len(), 3);
        let mean = errors.iter().sum::<f64>() / 3.0;
        let sigma = (errors.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
        let states = comparison["states"].as_array().unwrap();
        let row = states.iter().find(|row| row["name"] == "gyro_bias_z").unwrap();
        near(&row["simulated_sigma"]["value"], sigma);
        assert!(row["predicted_sigma"].as_f64().unwrap() > 0.0);
    }
    let left_out = prediction["left_out"].to_string();
    assert!(left_out.contains("cases have faults"), "{left_out}");
    let page = bench.read("report.html");
    for words in ["Predicted and simulated", "3 runs know σ to", "gyro_bias_z", "cases have faults"]
    {
        assert!(page.contains(words), "{words}");
    }
    std::fs::remove_file(bench.at("short.toml")).unwrap();
    assert_eq!(bench.report().0, 0);
    let prediction: Value = serde_json::from_str(&bench.read("prediction.json")).unwrap();
    assert_eq!(prediction["compared"], json!([]));
    assert!(prediction["left_out"].to_string().contains("short.toml"), "{prediction}");
}

#[test]
fn names_are_escaped() {
    let (bench, ..) = Bench::filled(CAMPAIGN, |_, _, _| {});
    assert_eq!(bench.report().0, 0);
    let page = bench.read("report.html");
    for text in ["T<script>", "short <i>", "amp <b>", "is <far> off", "<b>near</b>"] {
        assert!(!page.contains(text), "{text} is on the page as it is");
        assert!(
            page.contains(&text.replace('<', "&lt;").replace('>', "&gt;")),
            "{text} is missing"
        );
    }
    assert!(page.contains("DOC-1"), "what no run verifies is told");
    // One script that nothing depends on, and nothing from elsewhere.
    assert_eq!(page.matches("<script").count(), 1);
    for outside in ["http://", "https://", "src=", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    // Every anchor that is gone to is there.
    for link in page.split("href=\"#").skip(1) {
        let anchor = link.split('"').next().unwrap();
        assert!(page.contains(&format!("id=\"{anchor}\"")), "{anchor}");
    }
    // So are the files of the cases.
    let linked: Vec<&str> = page.split("href=\"cases/").skip(1).collect();
    assert!(linked.len() >= 80);
    for link in linked {
        let path = bench.at("out/cases").join(link.split('"').next().unwrap());
        assert!(path.is_file(), "{}", path.display());
    }
    let xml = bench.read("junit.xml");
    assert!(xml.contains("T&lt;script"), "the title is escaped");
    assert_eq!(xml.matches("name=\"verifies\"").count(), 2 * 80 + 2);
    assert!(!xml.contains("<failure") && !xml.contains("<error"));
}

/// Every file of a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
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

/// Cases with everything that can be wrong with one.
fn troubled(index: usize, _: &Case, result: &mut Value) {
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
            // A hundred times as far as the others.
            result["summary"]["navigation"]["radial_error_nmi"]["max"] = 9.0.into();
            result["summary"]["navigation"]["radial_error_nmi"]["rate_per_h"] = 40.0.into();
        }
        _ => {}
    }
}

#[test]
fn the_same_results_give_the_same_bytes_wherever_they_lie() {
    let (first, plan, out) = Bench::filled(CAMPAIGN, troubled);
    let (second, ..) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!((first.report().0, second.report().0), (4, 4));
    let of = |bench: &Bench| {
        ["statistics.json", "junit.xml", "dispositions.toml"].map(|f| bench.read(f))
    };
    assert!(of(&first) == of(&second), "the place of the folder is in the results");
    // The manifest has times; everything else is the same to the byte.
    let before = files(&out);
    assert_eq!(first.report().0, 4);
    let after = files(&out);
    assert_eq!(before.keys().collect::<Vec<_>>(), after.keys().collect::<Vec<_>>());
    for (path, bytes) in &before {
        assert!(*bytes == after[path] || path.ends_with("manifest.json"), "{}", path.display());
    }
    // The page alone, elsewhere: the folder stays.
    let output = first.octant(&["campaign", "report", "out", "--out", "alone.html"]);
    assert_eq!(output.status.code(), Some(4));
    assert!(files(&out) == after, "--out leaves the folder as it is");
    let alone = std::fs::read_to_string(first.at("alone.html")).unwrap();
    assert!(alone.contains(&plan.cases[3].id) && !alone.contains("href=\"cases/"));
}

#[test]
fn what_is_wrong_with_cases_is_told_with_the_line_that_runs_them_again() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, troubled);
    // A second result of a case.
    let path = case::file(&out, &plan.cases[10].id);
    let other = path.with_file_name(format!("{}.differs-12345678.json", plan.cases[10].id));
    std::fs::write(other, "{}\n").unwrap();
    assert_eq!(bench.report().0, 4);
    let (page, statistics) = (bench.read("report.html"), bench.statistics());
    for index in [3, 5, 7, 10] {
        let line = format!("octant campaign case out {}", plan.cases[index].id);
        assert!(page.contains(&line), "case {index}");
    }
    assert!(page.contains("it took &lt;more&gt; than its 2 s"));
    let found: Vec<Discrepancy> = Report::of(&plan, &out).unwrap().statistics.discrepancies;
    let kinds: Vec<(&str, Verdict, usize)> =
        found.iter().map(|d| (d.kind, d.verdict, d.cases.len())).collect();
    assert_eq!(
        kinds,
        [
            ("requirement", Verdict::Error, 0),
            ("requirement", Verdict::Error, 0),
            ("two results", Verdict::Error, 1),
            ("check", Verdict::Fail, 1),
            ("error", Verdict::Error, 1),
            ("fault", Verdict::Inconclusive, 1),
        ]
    );
    assert!(page.contains("6 in all, <strong>6 without a disposition</strong>"));
    for found in &found {
        assert!(page.contains(&format!("id=\"{}\"", found.id)), "{}", found.what);
        assert_eq!(found.id.len(), 12);
    }
    let outlier = &statistics["outliers"][0];
    assert_eq!(outlier["case"], plan.cases[7].id);
    assert_eq!(outlier["measure"], "navigation.radial_error_nmi.rate_per_h");
    let xml = bench.read("junit.xml");
    assert!(xml.contains("<failure") && xml.contains("type=\"inconclusive\""));
}

#[test]
fn dispositions_survive_to_the_letter_and_change_no_verdict() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!(bench.report().0, 4);
    let written = bench.read("dispositions.toml");
    assert_eq!(written.matches("[[discrepancies]]").count(), 5);
    // A person fills one in, in their own way.
    let fault = Report::of(&plan, &out).unwrap().statistics.discrepancies.pop().unwrap();
    assert_eq!(fault.kind, "fault");
    let (head, tail) = written.split_once(&format!("id = \"{}\"", fault.id)).unwrap();
    let tail = tail
        .replacen(
            "disposition = \"\"",
            "disposition   = '''Not <relevant>:\n the trigger is late.'''  # ok",
            1,
        )
        .replacen("by = \"\"", "by = \"A. Person\"", 1);
    let filled = format!("# mine\n{head}id = \"{}\"{tail}\n\n# the end\n", fault.id);
    let path = out.join("dispositions.toml");
    std::fs::write(&path, &filled).unwrap();
    let (status, said) = bench.report();
    assert_eq!(status, 4, "{said}");
    assert!(said.contains("5 discrepancies, 4 without a disposition"), "{said}");
    assert_eq!(bench.read("dispositions.toml"), filled);
    let page = bench.read("report.html");
    assert!(
        page.contains("Not &lt;relevant&gt;:\n the trigger is late.") && page.contains("A. Person")
    );
    assert!(!page.contains("not occurring"));

    // Another case fails, and one of the others doesn't any more.
    let mut result = synthetic(5, &plan.cases[5]);
    put(&out, &plan.cases[5], &result);
    result = synthetic(2, &plan.cases[2]);
    check(&mut result, "CAL-1", 77.0, 50.0);
    put(&out, &plan.cases[2], &result);
    let (status, _) = bench.report();
    assert_eq!(status, 4);
    let now = bench.read("dispositions.toml");
    assert!(now.starts_with(&filled), "what was there stays to the letter");
    // The cases of the failed check are others: what was said of it doesn't hold for the new one.
    assert_eq!(now.matches("[[discrepancies]]").count(), 6);
    let page = bench.read("report.html");
    assert_eq!(page.matches(">not occurring<").count(), 2);
    assert!(page.contains("the trigger is late."), "what was said is still shown");
    assert!(page.contains("4 without a disposition"));
}

/// As the first version wrote it: later ones have to read it.
const FIRST_VERSION: &str = "# Discrepancies of this campaign, and what is said of them.
schema = 1

[[discrepancies]]
id = \"D-0123456789\"
what = \"NAV-1 failed in 2 cases of static; latitude 0 deg\"
requirement = \"NAV-1\"
cases = [\"00112233445566aa\", \"00112233445566ab\"]
disposition = \"Accepted for the prototype, see PR-12.\"
by = \"A. Person\"

[[discrepancies]]
id = \"D-9876543210\"
what = \"1 case has no result\"
disposition = \"\"
by = \"\"
";

#[test]
fn dispositions_of_the_first_version_are_read() {
    use octant::evidence::disposition::Dispositions;
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("dispositions.toml"), FIRST_VERSION).unwrap();
    let read = Dispositions::read(&folder.path().join("dispositions.toml")).unwrap();
    let entry = read.of("D-0123456789").unwrap();
    assert_eq!(
        (entry.disposition.as_str(), entry.by.as_str(), entry.cases.len(), entry.is_open()),
        ("Accepted for the prototype, see PR-12.", "A. Person", 2, false)
    );
    assert!(read.of("D-9876543210").unwrap().is_open());
}

#[test]
fn dispositions_that_cannot_be_read_are_left_alone() {
    let (bench, _, out) = Bench::filled(CAMPAIGN, troubled);
    assert_eq!(bench.report().0, 4);
    let path = out.join("dispositions.toml");
    let good = bench.read("dispositions.toml");
    let twice = good.clone() + "\n" + good.split_once("\n\n").unwrap().1;
    for (text, words) in [
        (
            good.replace("schema = 1", "schema = 2"),
            "found version 2, this program reads version 1: a newer Octant",
        ),
        (good.replacen("by = ", "bye = ", 1), "unknown field `bye`"),
        (good.replacen("[[discrepancies]]", "[[discrepancy]]", 1), "unknown field `discrepancy`"),
        (good.replacen("by = \"\"", "by = \"", 1), "line 1"),
        (good.replace("schema = 1\n", ""), "missing field `schema`"),
        (twice, "a second time"),
        ("schema = 1\ndiscrepancies = []\n".to_owned(), "nothing can be added to it"),
    ] {
        std::fs::write(&path, &text).unwrap();
        let before = files(&out);
        let (status, said) = bench.report();
        assert_eq!(status, 2, "{said}");
        assert!(said.contains("dispositions.toml: ") && said.contains(words), "{words}: {said}");
        assert!(files(&out) == before, "{words}: something was written");
    }
    std::fs::write(&path, [0xff, 0xfe]).unwrap();
    let (status, said) = bench.report();
    assert!(status == 4 && said.contains("failed to read out/dispositions.toml"), "{said}");
    assert_eq!(std::fs::read(&path).unwrap(), [0xff, 0xfe]);
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
    assert_eq!(named.iter().filter(|path| path.starts_with("cases/")).count(), 4);
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

    // One bit of any file, the manifest and its signature among them.
    for (path, bytes) in &files(&out) {
        let mut changed = bytes.clone();
        let middle = changed.len() / 2;
        changed[middle] ^= 1 << (middle % 8);
        std::fs::write(path, changed).unwrap();
        // A manifest that can't be read any more is bad input; of any other file it tells the name.
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
    std::fs::write(out.join("cases/extra.json"), "{}").unwrap();
    let (status, said) = verify(Some(&public));
    assert!(status == 1 && said.contains("cases/extra.json was added"), "{said}");
    std::fs::remove_file(out.join("cases/extra.json")).unwrap();
    assert_eq!(verify(Some(&other)).0, 1, "a wrong key");

    // What a person says is a change, until the report is made again.
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
    // Without a key the signature of before goes.
    assert_eq!(bench.report().0, 1);
    let (status, said) = verify(None);
    assert!(status == 0 && said.contains("unsigned"), "{said}");
}

#[test]
fn nothing_looks_like_a_pass_that_is_none() {
    let shows = |bench: &Bench, words: &str| {
        let (page, xml) = (bench.read("report.html"), bench.read("junit.xml"));
        assert!(page.contains(
            "<title>T&lt;script&gt;alert(1)&lt;/script&gt; &amp; co: inconclusive</title>"
        ));
        assert!(page.contains(words), "{words}");
        assert_eq!(bench.statistics()["verdict"], "inconclusive");
        // No requirement and no campaign is a success.
        let verified = xml.split("all cases together").nth(1);
        assert!(
            verified.is_none_or(|text| text
                .split("</testcase>")
                .next()
                .unwrap()
                .contains("<error"))
        );
        assert!(
            xml.contains("<error type=\"inconclusive\"") || xml.contains("type=\"inconclusive\"")
        );
    };
    // Nothing has run.
    let bench = Bench::new(CAMPAIGN);
    bench.plan().write(&bench.at("out"), false).unwrap();
    let (status, said) = bench.report();
    assert!(status == 3 && said.contains("inconclusive"), "{said}");
    shows(&bench, "80 cases have no result");

    // One case is missing of many that pass.
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    std::fs::remove_file(case::file(&out, &plan.cases[79].id)).unwrap();
    assert_eq!(bench.report().0, 3);
    shows(&bench, "1 case has no result");

    // A requirement that no case checks.
    let campaign =
        CAMPAIGN.replace("file = \"short.toml\"", "file = \"short.toml\"\nverifies = []");
    let (bench, ..) = Bench::filled(&campaign, |_, _, result| {
        let checks = result["summary"]["requirements"].as_array_mut().unwrap();
        checks.retain(|check| check["id"] != "NAV-1");
    });
    assert_eq!(bench.report().0, 3);
    let nav = &bench.statistics()["requirements"][1];
    assert_eq!(
        (nav["verdict"].as_str(), &nav["lower_bound"]),
        (Some("inconclusive"), &Value::Null)
    );
    let page = bench.read("report.html");
    assert!(page.contains("no case verifies it"));
    let missing = page.split("Requirements without a case").nth(1).unwrap();
    assert!(missing.split("</p>").next().unwrap().contains("NAV-1"));

    // A campaign without requirements, and one without cases.
    let bench = Bench::new(&CAMPAIGN.replace("requirements = \"requirements.toml\"\n", ""));
    let without = SCENARIO.split("[[requirements]]").next().unwrap();
    std::fs::write(bench.at("short.toml"), without).unwrap();
    let plan = bench.plan();
    plan.write(&bench.at("out"), false).unwrap();
    for (index, case) in plan.cases.iter().enumerate() {
        let mut result = synthetic(index, case);
        result["summary"]["requirements"] = json!([]);
        result["verdict"] = "inconclusive".into();
        put(&bench.at("out"), case, &result);
    }
    assert_eq!(bench.report().0, 3);
    shows(&bench, "no requirement is checked: nothing is shown");
    let empty = Plan { cases: Vec::new(), ..Bench::new(CAMPAIGN).plan() };
    let folder = tempfile::tempdir().unwrap();
    let report = Report::of(&empty, folder.path()).unwrap();
    assert_eq!(report.statistics.verdict, Verdict::Inconclusive);
    assert!(octant::report::campaign::render(&report, true).contains("there is no case"));
    assert!(report.open() > 0);
}

#[test]
fn what_is_not_of_the_plan_is_refused_and_nothing_is_written() {
    let (bench, plan, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    let stray = case::file(&out, &plan.cases[0].id).with_file_name("0123456789abcdef.json");
    std::fs::write(&stray, "{}").unwrap();
    let before = files(&out);
    let (status, said) = bench.report();
    assert!(
        status == 2 && said.contains("results of 1 cases that the plan doesn't have"),
        "{said}"
    );
    assert!(files(&out) == before);
    std::fs::remove_file(stray).unwrap();
    std::fs::write(case::file(&out, &plan.cases[0].id), "{\"schema\": 1").unwrap();
    let (status, said) = bench.report();
    assert!(status == 4 && said.contains("expected the result of a case"), "{said}");
    assert!(!out.join("report.html").exists() && !out.join("manifest.json").exists());
    let (status, said) = {
        let output = bench.octant_with(
            &["campaign", "report", "out"],
            &[("OCTANT_SIGNING_KEY", Path::new("no/such/key"))],
        );
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    assert!(status == Some(2) && said.contains("no/such/key"), "{said}");
    // A table of before, when there were fewer cases.
    put(&out, &plan.cases[0], &synthetic(0, &plan.cases[0]));
    octant::campaign::results::tables(&plan, &out, 0..79, |table| {
        octant::campaign::merge::merged(&out, table)
    })
    .unwrap();
    assert_eq!(bench.report().0, 0);
    let page = bench.read("report.html");
    assert!(page.contains("cases.parquet has 79 cases and the folder 80 results"));
}

#[test]
fn the_self_test_is_shown_and_bound() {
    let (bench, _, out) = Bench::filled(CAMPAIGN, |_, _, _| {});
    let path = out.join("selftest.json");
    let test = json!({"schema": 1, "verdict": "fail", "program_sha256": "ab".repeat(32),
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
    assert!(page.contains("pass, 2026-01-02T03:04:05Z") && page.contains(&"ab".repeat(32)));
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    assert_eq!(manifest["campaign"]["selftest"], "pass");
    assert_eq!(bench.statistics()["discrepancies"], json!([]));
    assert!(manifest["files"].as_array().unwrap().iter().any(|f| f["path"] == "selftest.json"));
}
