//! Comparison with numbers of scipy and numpy: `fixtures/golden/statistics.json`, with the way they
//! were made beside it.

use octant_statistics::draw::{Distribution, DrawnFactor, Factor};
use octant_statistics::outlier::{OutlierScale, outliers};
use octant_statistics::proportion::{
    Demand, Needed, further_at_rate, further_if_all_pass, success_lower_bound, success_upper_bound,
};
use octant_statistics::{normal, paired, quantile, rank, sample};
use serde_json::Value as Json;

pub(super) fn golden_of(name: &str) -> Json {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../fixtures/golden/");
    serde_json::from_str(&std::fs::read_to_string(format!("{folder}{name}")).unwrap()).unwrap()
}

fn golden() -> Json {
    golden_of("statistics.json")
}

fn rows(of: &str) -> Vec<Json> {
    golden()[of].as_array().unwrap().clone()
}

fn number(value: &Json) -> f64 {
    value.as_f64().unwrap()
}

fn numbers(value: &Json) -> Vec<f64> {
    value.as_array().unwrap().iter().map(number).collect()
}

#[track_caller]
pub(super) fn assert_near(found: f64, expected: f64, relative: f64) {
    let error = (found - expected).abs();
    assert!(error <= relative * expected.abs().max(1e-300), "found {found}, expected {expected}");
}

#[test]
fn bounds_of_a_pass_probability() {
    for row in rows("proportion") {
        let (failures, runs) = (row["failures"].as_u64().unwrap(), row["runs"].as_u64().unwrap());
        let confidence = number(&row["confidence"]);
        assert_near(success_lower_bound(failures, runs, confidence), number(&row["lower"]), 1e-9);
        assert_near(success_upper_bound(failures, runs, confidence), number(&row["upper"]), 1e-9);
    }
    assert!(success_lower_bound(0, 59, 0.95) >= 0.95);
    assert!(success_lower_bound(0, 58, 0.95) < 0.95);
}

/// If no run passes, the upper bound is 1 − (1 − confidence)^(1/n).
#[test]
fn what_is_refuted() {
    let half = Demand { pass: 0.5, confidence: 0.95 };
    assert!(!half.is_refuted(4, 4), "52.7 %");
    assert!(half.is_refuted(5, 5), "45.1 %");
    assert!(!half.is_refuted(0, 5));
    assert!(!half.is_refuted(0, 0), "nothing is refuted by nothing");
    assert!(!half.is_shown(0, 0));
    for (pass, confidence) in [(0.0, 0.95), (1.0, 0.95), (0.5, 0.0), (0.5, 1.0), (f64::NAN, 0.5)] {
        assert!(!Demand { pass, confidence }.is_refuted(1000, 1000));
    }
}

#[test]
fn runs_that_are_still_needed() {
    for row in rows("further") {
        let (failures, runs) = (row["failures"].as_u64().unwrap(), row["runs"].as_u64().unwrap());
        let demand = Demand { pass: number(&row["pass"]), confidence: number(&row["confidence"]) };
        let all_pass = Needed::Runs(row["if_all_pass"].as_u64().unwrap());
        assert_eq!(further_if_all_pass(demand, failures, runs), all_pass, "{row}");
        let at_rate = row["at_rate"].as_u64().map_or(Needed::CannotBeMet, Needed::Runs);
        assert_eq!(further_at_rate(demand, failures, runs), at_rate, "{row}");
    }
    // Demands that no number of runs can show.
    for (pass, confidence) in [(1.0, 0.95), (0.95, 1.0), (f64::NAN, 0.5), (0.999_999_99, 0.95)] {
        let demand = Demand { pass, confidence };
        assert_eq!(further_if_all_pass(demand, 0, 10), Needed::CannotBeMet);
        assert_eq!(further_at_rate(demand, 1, 10), Needed::CannotBeMet);
        assert!(!demand.is_shown(0, 1_000_000));
    }
}

#[test]
fn ranks_that_bound_a_quantile() {
    for row in rows("upper_rank") {
        let found = quantile::upper_rank(
            row["n"].as_u64().unwrap(),
            number(&row["p"]),
            number(&row["confidence"]),
        );
        assert_eq!(found, row["rank"].as_u64(), "{row}");
    }
    assert_eq!(quantile::values_needed(0.95, 0.95), Some(59));
    assert_eq!(quantile::values_needed(0.5, 0.95), Some(5));
    // The number needed is the first for which the largest value is a bound.
    for (p, confidence) in [(0.9, 0.9), (0.99, 0.95), (0.5, 0.999)] {
        let n = quantile::values_needed(p, confidence).unwrap();
        assert_eq!(quantile::upper_rank(n, p, confidence), Some(n));
        assert_eq!(quantile::upper_rank(n - 1, p, confidence), None);
    }
    // A lower bound is an upper bound of the negated values.
    let values: Vec<f64> = (0..100).map(f64::from).collect();
    let mirrored: Vec<f64> = values.iter().map(|v| -v).collect();
    let upper = quantile::upper_bound(&values, 0.7, 0.9).unwrap();
    assert_eq!(quantile::lower_bound(&mirrored, 0.3, 0.9), Some(-upper));
}

#[test]
fn percentiles_as_numpy_has_them() {
    let golden = golden();
    let values = numbers(&golden["percentiles"]["values"]);
    for row in golden["percentiles"]["rows"].as_array().unwrap() {
        let row = numbers(row);
        assert_near(sample::percentile(&values, row[0]).unwrap(), row[1], 1e-14);
    }
    assert_eq!(sample::percentile(&[], 0.5), None);
    assert_eq!(sample::percentile(&[1.0, f64::NAN], 0.5), None);
}

#[test]
fn the_normal_distribution_and_its_inverse() {
    for row in rows("normal") {
        let row = numbers(&row);
        assert_near(normal::quantile(row[0]), row[1], 4e-15);
    }
    for row in rows("normal_cdf") {
        let row = numbers(&row);
        // Far out the density changes by z² times the relative error of z: the last bit of z/√2
        // matters.
        assert_near(normal::cdf(row[0]), row[1], 2.3e-16 * (4.0 + row[0] * row[0]));
    }
    assert_eq!(normal::quantile(0.0), f64::NEG_INFINITY);
    assert_eq!(normal::quantile(1.0), f64::INFINITY);
    assert!(normal::quantile(1.5).is_nan() && normal::quantile(f64::NAN).is_nan());
}

#[test]
fn rank_correlations() {
    for row in rows("spearman") {
        let found = rank::spearman(&numbers(&row["x"]), &numbers(&row["y"])).unwrap();
        assert_near(found.rho, number(&row["rho"]), 1e-13);
        assert_near(found.p, number(&row["p"]), 1e-9);
    }
    // Of three values in order, 2 of 6 orders are as extreme: nothing stands out.
    let three = rank::spearman(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]).unwrap();
    assert_near(three.rho, 1.0, 1e-13);
    assert_near(three.p, 1.0 / 3.0, 1e-13);
    assert!(!three.stands_out(0.05, 1));
    // Exact probabilities of five values (Zar, 1972, JASA 67: ρ of 1.0 and 0.9).
    let five = |y: [f64; 5]| rank::spearman(&[1.0, 2.0, 3.0, 4.0, 5.0], &y).unwrap().p;
    assert_near(five([1.0, 2.0, 3.0, 4.0, 5.0]), 2.0 / 120.0, 1e-13);
    assert_near(five([2.0, 1.0, 3.0, 4.0, 5.0]), 10.0 / 120.0, 1e-13);
    let nine: Vec<f64> = (0..9).map(f64::from).collect();
    assert_near(rank::spearman(&nine, &nine).unwrap().p, 2.0 / 362_880.0, 1e-13);
    assert_eq!(rank::spearman(&[1.0; 5], &[1.0, 2.0, 3.0, 4.0, 5.0]), None);
    assert_eq!(rank::spearman(&[1.0, 2.0], &[1.0, 2.0]), None);
}

#[test]
fn paired_differences() {
    for row in rows("paired") {
        let (first, second) = (numbers(&row["first"]), numbers(&row["second"]));
        let found = paired::difference(&first, &second, 0.9).unwrap();
        let mean = found.mean.unwrap();
        assert_near(mean.value, number(&row["mean"]), 1e-12);
        assert_near(mean.low, number(&row["low"]), 1e-8);
        assert_near(mean.high, number(&row["high"]), 1e-8);
        assert_near(found.sign_p, number(&row["sign_p"]), 1e-10);
        assert_near(found.wilcoxon_p, number(&row["wilcoxon_p"]), 1e-11);
    }
    for row in rows("wilcoxon_ties") {
        assert_near(paired::wilcoxon(&numbers(&row["differences"])), number(&row["p"]), 1e-13);
    }
    let many = &golden()["wilcoxon_many"];
    assert_near(paired::wilcoxon(&numbers(&many["differences"])), number(&many["p"]), 1e-9);
    assert_eq!(paired::wilcoxon(&[0.0, 0.0]), 1.0);
    // The largest number of differences with the exact distribution: the number of subsets of the ranks up to a sum,
    // counted in whole numbers. The normal approximation would give 0.01856.
    let signed = |k: i32| f64::from(if matches!(k % 5, 0 | 3) { -k } else { k });
    let differences: Vec<f64> = (1..=200).map(signed).collect();
    assert_near(paired::wilcoxon(&differences), 0.018_330_701_271_282_6, 1e-11);
}

#[test]
fn passes_in_pairs() {
    for row in rows("mcnemar") {
        let (b, c) = (row[0].as_u64().unwrap(), row[1].as_u64().unwrap());
        let pairs = paired::PassPairs { both: 50, only_first: b, only_second: c, neither: 3 };
        assert_near(pairs.mcnemar(), number(&row[2]), 1e-10);
    }
    let pairs = paired::PassPairs::of(&[true, true, false, false], &[true, false, true, false]);
    let expected = paired::PassPairs { both: 1, only_first: 1, only_second: 1, neither: 1 };
    assert_eq!(pairs, Some(expected));
    assert_eq!(paired::PassPairs::of(&[true], &[]), None);
}

#[test]
fn truncated_distributions_by_their_inverse() {
    for row in rows("distributions") {
        let of = |key: &str| number(&row[key]);
        let distribution = match row["distribution"].as_str().unwrap() {
            "normal" => Distribution::Normal { mean: of("mean"), sigma: of("sigma") },
            "log_normal" => {
                Distribution::LogNormal { median: of("median"), sigma_ln: of("sigma_ln") }
            }
            _ => Distribution::Uniform { low: of("from"), high: of("to") },
        };
        let mut factor = Factor::new("x", distribution);
        (factor.low, factor.high) = (row["low"].as_f64(), row["high"].as_f64());
        for pair in row["rows"].as_array().unwrap() {
            let pair = numbers(pair);
            let DrawnFactor::Number(found) = factor.at(pair[0]).unwrap() else { panic!("{row}") };
            assert!(
                (found - pair[1]).abs() < 1e-9 * pair[1].abs().max(1.0),
                "{row} {pair:?} {found}"
            );
        }
    }
}

#[test]
fn modified_scores_by_the_median() {
    let golden = golden();
    let (values, scores) = (numbers(&golden["mad"]["values"]), numbers(&golden["mad"]["scores"]));
    let found = outliers(&values, OutlierScale::Linear, 0.0);
    // All values except the median itself, whose score is 0.
    assert_eq!(found.len(), values.len() - 1);
    for outlier in &found {
        assert_near(outlier.score, scores[outlier.index], 1e-12);
    }
    assert!(found.windows(2).all(|pair| pair[0].score.abs() >= pair[1].score.abs()));
}
