//! Numbers of a report, computed independently and compared with its page.

use super::bench::{Bench, CAMPAIGN, check, drawn, final_nmi, rate};
use crate::common::results;
use octant_base::number::significant;
use octant_campaign::plan::factor_values::FactorValue;
use serde_json::{Value, json};

/// Computes a percentile, definition 7 of Hyndman and Fan.
pub(crate) fn percentile(values: &[f64], p: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = p * (sorted.len() - 1) as f64;
    let low = at.floor() as usize;
    let high = (low + 1).min(sorted.len() - 1);
    sorted[low] * (1.0 - at.fract()) + sorted[high] * at.fract()
}

/// Computes P(X ≤ k) of a binomial by summation.
fn binomial(k: u64, n: u64, p: f64) -> f64 {
    let choose = |i: u64| (0..i).map(|j| ((n - j) as f64 / (j + 1) as f64).ln()).sum::<f64>();
    (0..=k).map(|i| (choose(i) + i as f64 * p.ln() + (n - i) as f64 * (1.0 - p).ln()).exp()).sum()
}

/// Returns the order statistics that bound a quantile at 95 %, two-sided: by the definition, rank
/// by rank.
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

/// Computes Spearman's ρ of values without ties.
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

/// Compares an interval; an end that isn't finite is null.
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
    // Every ninth case fails NAV-1.
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

        // A factor of a fault counts only where the fault is injected.
        for factor in found["sensitivity"].as_array().unwrap() {
            let name = factor["factor"].as_str().unwrap();
            let takes = |index: &&usize| {
                let faults = plan.cases[**index].faults.as_ref().unwrap();
                name == "north" || !faults.is_empty()
            };
            let part: Vec<usize> = mine.iter().filter(takes).copied().collect();
            let x: Vec<f64> = part
                .iter()
                .map(|index| match plan.cases[*index].factors.get(name) {
                    Some(FactorValue::Number(number)) => *number,
                    _ => unreachable!(),
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
    // Both latitudes have the same 40 instruments, which are the draws, and no two failing cases
    // belong to the same one. The bound is the probability at which so few failures have a
    // probability of 10 %.
    assert_eq!(nav["draws"], json!({"passed": 31, "not_passed": 9, "open": 0, "rows": 80}));
    let bound = nav["lower_bound"].as_f64().unwrap();
    assert!((binomial(fails, 40, 1.0 - bound) - 0.1).abs() < 1e-9, "{bound}");
    assert!(page.contains(&format!("{} %", (bound * 1e4).floor() / 1e2)), "{bound}");
    near(&nav["nearest"]["margin"], -2.5);
    let verdict = if bound >= 0.8 { "pass" } else { "inconclusive" };
    assert_eq!(nav["verdict"], verdict);
    // The number of further passes is sufficient, and one less isn't.
    let needed = nav["needed_if_all_pass"]["runs"].as_u64().unwrap();
    let shown = |runs: u64| binomial(fails, runs, 0.2) <= 0.1;
    assert!(shown(40 + needed) && (needed == 0 || !shown(39 + needed)), "{needed}");
    let settled = nav["convergence"].as_array().unwrap().last().unwrap();
    assert_eq!(settled["runs"], 40);
    near(&settled["estimate"]["value"], 31.0 / 40.0);
    let exit = if verdict == "pass" { 0 } else { 3 };
    assert_eq!(status, exit, "{said}");
    // Nine cases failed, in two combinations: whatever the verdict, each needs a disposition.
    let failed: Vec<&Value> = (statistics["discrepancies"].as_array().unwrap().iter())
        .filter(|found| found["kind"] == "check")
        .collect();
    assert_eq!(failed.len(), 2);
    let cases: usize = failed.iter().map(|found| found["cases"].as_array().unwrap().len()).sum();
    assert_eq!(cases, 9);
}

/// Cases that differ by their seed alone are an ensemble: the page compares them with its
/// prediction, and states that there are too few. Without the scenario's file there is still a
/// report.
#[test]
fn predictions_stand_beside_the_cases() {
    let draws = CAMPAIGN.find("[[factors]]\nname = \"amp").unwrap();
    let campaign = CAMPAIGN[..draws]
        .replace("replicates = 40", "replicates = 3")
        .replace("faults = [[], [\"spike-1\"]]\ndraw = true", "faults = [[], [\"spike-1\"]]");
    let bench = Bench::new(&campaign);
    bench.plan().write(&bench.at("out"), false).unwrap();
    assert_eq!(bench.octant(&["campaign", "run", "out"]).status.code(), Some(3));
    // Three draws don't show 80 % at 90 %, whatever the number of combinations.
    assert_eq!(bench.report().0, 3);
    let prediction: Value = serde_json::from_str(&bench.read("prediction.json")).unwrap();
    let compared = prediction["compared"].as_array().unwrap();
    assert_eq!((prediction["schema"].as_u64(), compared.len()), (Some(1), 2), "two latitudes");
    for comparison in compared {
        assert_eq!(comparison["runs"], 3);
        assert_eq!(comparison["states"].as_array().unwrap().len(), 30);
        // One of the σ computed independently: about the mean, from the results of the cases.
        let set = comparison["set"].as_array().unwrap();
        let mut errors = Vec::new();
        for case in bench
            .plan()
            .cases
            .iter()
            .filter(|case| case.faults.as_ref().is_some_and(|faults| faults.is_empty()))
        {
            if set.iter().all(|one| case.set.iter().any(|other| one == other.as_str())) {
                let result = results::value(&bench.at("out"), &case.id);
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
    assert_eq!(bench.report().0, 3);
    let prediction: Value = serde_json::from_str(&bench.read("prediction.json")).unwrap();
    assert_eq!(prediction["compared"], json!([]));
    assert!(prediction["left_out"].to_string().contains("short.toml"), "{prediction}");
}
