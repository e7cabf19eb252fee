//! Statistics compared with scipy and numpy.

use super::numbers::{Found, tight};
use crate::judge::Known;
use octant_statistics::draw::{Distribution, Factor};
use octant_statistics::outlier::{OutlierScale, outliers};
use octant_statistics::proportion::{
    Demand, Needed, further_at_rate, further_if_all_pass, success_lower_bound, success_upper_bound,
};
use octant_statistics::{normal, paired, quantile, rank, sample};
use serde_json::Value;

const GOLDEN: &str = include_str!("../../../../../fixtures/golden/statistics.json");

/// Expected numbers beside the computed ones, collected in one pass through the golden rows.
#[derive(Default)]
struct Pairs {
    known: Vec<Known>,
    found: Found,
}

impl Pairs {
    fn put(&mut self, name: String, found: f64, known: Option<f64>, relative: f64) {
        let Some(value) = known else { return };
        self.known.push(tight(&name, value, relative, 1e-300));
        self.found.insert(name, found);
    }
}

pub(super) fn known() -> Vec<Known> {
    pairs().map(|pairs| pairs.known).unwrap_or_default()
}

pub(super) fn found() -> Result<Found, String> {
    pairs().map(|pairs| pairs.found).ok_or_else(|| "read the golden statistics".to_owned())
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}

fn rows<'a>(golden: &'a Value, of: &str) -> impl Iterator<Item = (usize, &'a Value)> {
    golden[of].as_array().into_iter().flatten().enumerate()
}

fn pairs() -> Option<Pairs> {
    let golden: Value = serde_json::from_str(GOLDEN).ok()?;
    let mut all = Pairs::default();
    bounds(&golden, &mut all)?;
    quantiles(&golden, &mut all)?;
    tests(&golden, &mut all)?;
    distributions(&golden, &mut all)?;
    Some(all)
}

/// Converts a number of required runs; −1 if the requirement can't be met.
fn runs(needed: Needed) -> f64 {
    match needed {
        Needed::Runs(runs) => runs as f64,
        Needed::CannotBeMet => -1.0,
    }
}

fn bounds(golden: &Value, all: &mut Pairs) -> Option<()> {
    for (i, row) in rows(golden, "proportion") {
        let (failures, tries) = (row["failures"].as_u64()?, row["runs"].as_u64()?);
        let confidence = row["confidence"].as_f64()?;
        let lower = success_lower_bound(failures, tries, confidence);
        all.put(format!("proportion {i} lower"), lower, row["lower"].as_f64(), 1e-9);
        let upper = success_upper_bound(failures, tries, confidence);
        all.put(format!("proportion {i} upper"), upper, row["upper"].as_f64(), 1e-9);
    }
    for (i, row) in rows(golden, "further") {
        let (failures, tries) = (row["failures"].as_u64()?, row["runs"].as_u64()?);
        let demand =
            Demand { pass: row["pass"].as_f64()?, confidence: row["confidence"].as_f64()? };
        let needed = runs(further_if_all_pass(demand, failures, tries));
        all.put(format!("further {i} if all pass"), needed, row["if_all_pass"].as_f64(), 1e-9);
        let needed = runs(further_at_rate(demand, failures, tries));
        let known = row["at_rate"].as_f64().or(Some(-1.0));
        all.put(format!("further {i} at rate"), needed, known, 1e-9);
    }
    for (i, row) in rows(golden, "upper_rank") {
        let (n, p) = (row["n"].as_u64()?, row["p"].as_f64()?);
        let rank = quantile::upper_rank(n, p, row["confidence"].as_f64()?);
        let found = rank.map_or(-1.0, |rank| rank as f64);
        all.put(format!("upper rank {i}"), found, row["rank"].as_f64().or(Some(-1.0)), 1e-9);
    }
    Some(())
}

fn quantiles(golden: &Value, all: &mut Pairs) -> Option<()> {
    let values = numbers(&golden["percentiles"]["values"])?;
    for (i, row) in rows(&golden["percentiles"], "rows") {
        let row = numbers(row)?;
        let found = sample::percentile(&values, row[0])?;
        all.put(format!("percentile {i}"), found, Some(row[1]), 1e-14);
    }
    for (i, row) in rows(golden, "normal") {
        let row = numbers(row)?;
        all.put(format!("normal quantile {i}"), normal::quantile(row[0]), Some(row[1]), 4e-15);
    }
    for (i, row) in rows(golden, "normal_cdf") {
        let row = numbers(row)?;
        // Far out the density changes by z² times the error of z: the last bit of z/√2 has an
        // effect.
        let relative = 2.3e-16 * (4.0 + row[0] * row[0]);
        all.put(format!("normal cdf {i}"), normal::cdf(row[0]), Some(row[1]), relative);
    }
    let scores = numbers(&golden["mad"]["scores"])?;
    let values = numbers(&golden["mad"]["values"])?;
    for outlier in outliers(&values, OutlierScale::Linear, 0.0) {
        let name = format!("robust score {}", outlier.index);
        all.put(name, outlier.score, Some(scores[outlier.index]), 1e-12);
    }
    Some(())
}

fn tests(golden: &Value, all: &mut Pairs) -> Option<()> {
    for (i, row) in rows(golden, "spearman") {
        let found = rank::spearman(&numbers(&row["x"])?, &numbers(&row["y"])?)?;
        all.put(format!("spearman {i} rho"), found.rho, row["rho"].as_f64(), 1e-13);
        all.put(format!("spearman {i} p"), found.p, row["p"].as_f64(), 1e-9);
    }
    for (i, row) in rows(golden, "paired") {
        let (first, second) = (numbers(&row["first"])?, numbers(&row["second"])?);
        let found = paired::difference(&first, &second, 0.9)?;
        let mean = found.mean?;
        for (name, found, relative) in [
            ("mean", mean.value, 1e-12),
            ("low", mean.low, 1e-8),
            ("high", mean.high, 1e-8),
            ("sign_p", found.sign_p, 1e-10),
            ("wilcoxon_p", found.wilcoxon_p, 1e-11),
        ] {
            all.put(format!("paired {i} {name}"), found, row[name].as_f64(), relative);
        }
    }
    for (i, row) in rows(golden, "wilcoxon_ties") {
        let p = paired::wilcoxon(&numbers(&row["differences"])?);
        all.put(format!("wilcoxon with ties {i}"), p, row["p"].as_f64(), 1e-13);
    }
    let many = &golden["wilcoxon_many"];
    let p = paired::wilcoxon(&numbers(&many["differences"])?);
    all.put("wilcoxon of many".to_owned(), p, many["p"].as_f64(), 1e-9);
    for (i, row) in rows(golden, "mcnemar") {
        let (only_first, only_second) = (row[0].as_u64()?, row[1].as_u64()?);
        let pairs = paired::PassPairs { both: 50, only_first, only_second, neither: 3 };
        all.put(format!("mcnemar {i}"), pairs.mcnemar(), row[2].as_f64(), 1e-10);
    }
    Some(())
}

fn distributions(golden: &Value, all: &mut Pairs) -> Option<()> {
    for (i, row) in rows(golden, "distributions") {
        let of = |key: &str| row[key].as_f64();
        let distribution = match row["distribution"].as_str()? {
            "normal" => Distribution::Normal { mean: of("mean")?, sigma: of("sigma")? },
            "log_normal" => {
                Distribution::LogNormal { median: of("median")?, sigma_ln: of("sigma_ln")? }
            }
            _ => Distribution::Uniform { low: of("from")?, high: of("to")? },
        };
        let mut factor = Factor::new("x", distribution);
        (factor.low, factor.high) = (of("low"), of("high"));
        for (k, pair) in rows(row, "rows") {
            let pair = numbers(pair)?;
            let found = factor.at(pair[0]).ok()?.number();
            all.put(format!("distribution {i} at {k}"), found, Some(pair[1]), 1e-9);
        }
    }
    Some(())
}
