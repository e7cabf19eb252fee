//! Protection levels: the error that a published parameter exceeds unnoticed with a small probability at most.

use crate::estimators::estimate::{RareEstimate, RarePlan, estimate};
use crate::estimators::point::RareStage;
use crate::estimators::subset::SubsetGoal;
use crate::runs::error::RareError;
use crate::runs::failure::{RARE_SCHEMA, RareReplicate, replicates};
use crate::runs::many::{RareRuns, SeverityOf, StageCounts};
use crate::runs::outcome::RareOutcome;
use crate::runs::words;
use octant_base::names::suggestion;
use octant_base::number::{counted, fixed, significant};
use octant_sample::parameters::{NAMES, ParameterGroup};
use octant_scenario::Scenario;
use octant_statistics::normal;
use octant_statistics::sample::mean;
use octant_verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Probability with which an error may be exceeded unnoticed, where none is given.
pub const RISK: &str = "1e-5";

/// Protection level of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ParameterLevel {
    /// The parameter.
    pub name: String,
    /// Unit of all of its values.
    pub unit: String,
    /// The level: the error exceeds it unnoticed with the integrity risk; null if it wasn't found.
    pub level: Option<f64>,
    /// Its interval; an end that isn't shown is null.
    pub interval: [Option<f64>; 2],
    /// Published σ, mean over the plain runs.
    pub sigma: Option<f64>,
    /// σ × the normal quantile of the risk: the level of an honest filter with normal errors.
    pub normal_level: Option<f64>,
    /// True if the interval is taken for shown.
    pub shown: bool,
    /// Reasons why it is not.
    pub doubts: Vec<String>,
    /// The subset simulations.
    pub replicates: Vec<RareReplicate>,
}

/// Protection levels of a calibration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProtectionLevels {
    /// [`RARE_SCHEMA`].
    pub schema: u32,
    /// Version of the program.
    pub octant: String,
    /// Title of the scenario.
    pub scenario: String,
    /// Sequence of positions.
    pub sequence: String,
    /// Integrity risk: probability of a larger error that goes unnoticed.
    pub risk: f64,
    /// Confidence of the intervals, two-sided.
    pub confidence: f64,
    /// Seed.
    pub seed: u64,
    /// Ids of the scenario's faults: none for levels without faults.
    pub faults: Vec<String>,
    /// Drawn instrument errors.
    pub components: usize,
    /// Runs in all.
    pub runs: usize,
    /// Runs of each stage by their end.
    pub stages: BTreeMap<RareStage, StageCounts>,
    /// Reasons of the runs that weren't published unnoticed.
    pub reasons: BTreeMap<String, usize>,
    /// Levels.
    pub parameters: Vec<ParameterLevel>,
    /// Inconclusive if a level isn't shown.
    pub verdict: Verdict,
}

/// Names of the parameters that were asked for; all of them without any.
///
/// # Errors
/// If there is none of a name.
pub fn parameters(asked: &[String]) -> Result<Vec<String>, RareError> {
    if asked.is_empty() {
        return Ok(NAMES.iter().map(|name| (*name).to_owned()).collect());
    }
    for name in asked {
        if !NAMES.contains(&name.as_str()) {
            let expected = suggestion(name, NAMES.iter().copied(), "parameters");
            return Err(RareError::NoParameter { found: name.clone(), expected });
        }
    }
    Ok(asked.to_vec())
}

/// Finds the protection levels of parameters. Those that the calibration doesn't estimate are left out, if all were
/// asked for.
///
/// # Errors
/// If it can't run, or the end was asked for.
pub fn protection(
    runs: &mut RareRuns<'_>,
    scenario: &Scenario,
    names: &[String],
    risk: f64,
    plan: &RarePlan,
) -> Result<ProtectionLevels, RareError> {
    let mut levels = Vec::new();
    for name in names {
        runs.look_at(SeverityOf::Error(name.clone()));
        // The first plain samples are the same for every parameter, and run once.
        if names.len() == NAMES.len() && !runs.publishes(name, plan)? {
            continue;
        }
        let found = estimate(runs, SubsetGoal::Probability(risk), plan)?;
        levels.push(level(runs, name, &found, risk, plan.confidence));
    }
    let all = words::together(runs.counts());
    if all.broken > 0 {
        let were = counted(all.broken, "run", "runs");
        for level in &mut levels {
            level.shown = false;
            level.doubts.push(format!("{were} broke down"));
        }
    }
    let is_shown = !levels.is_empty() && levels.iter().all(|level| level.shown);
    let sequence = scenario.calibration.as_ref().map(|c| c.name.clone());
    Ok(ProtectionLevels {
        schema: RARE_SCHEMA,
        octant: env!("CARGO_PKG_VERSION").to_owned(),
        scenario: scenario.title.clone(),
        sequence: sequence.unwrap_or_default(),
        risk,
        confidence: plan.confidence,
        seed: plan.seed,
        faults: scenario.faults.iter().map(|fault| fault.spec.id.clone()).collect(),
        components: runs.inputs().len(),
        runs: all.runs,
        stages: runs.counts().clone(),
        reasons: runs.reasons().clone(),
        parameters: levels,
        verdict: if is_shown { Verdict::None } else { Verdict::Inconclusive },
    })
}

fn level(
    runs: &RareRuns<'_>,
    name: &str,
    found: &RareEstimate,
    risk: f64,
    confidence: f64,
) -> ParameterLevel {
    let sigmas = found.found.iter().flat_map(|found| &found.plain).filter_map(|sample| match runs
        .outcome_of(&sample.point)
    {
        Some(RareOutcome::Published(parameters)) => parameters.get(name).map(|[_, s]| *s),
        _ => None,
    });
    let sigma = mean(&sigmas.collect::<Vec<f64>>());
    let [low, level, high] = found.level(risk, confidence).unwrap_or([f64::NAN; 3]);
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let mut doubts: Vec<String> = found.doubts.iter().map(words::doubt).collect();
    if finite(level).is_some() && finite(high).is_none() {
        doubts.push("the weighted samples don't show the upper end".to_owned());
    }
    let index = NAMES.iter().position(|known| *known == name).unwrap_or(0);
    ParameterLevel {
        name: name.to_owned(),
        unit: ParameterGroup::of(index).unit().to_owned(),
        level: finite(level),
        interval: [finite(low), finite(high)],
        sigma,
        normal_level: sigma.map(|sigma| -normal::quantile(0.5 * risk) * sigma),
        shown: doubts.is_empty() && finite(high).is_some(),
        doubts,
        replicates: replicates(found),
    }
}

impl ProtectionLevels {
    /// Describes the levels for a terminal.
    #[must_use]
    pub fn text(&self) -> String {
        let mut out = format!(
            "{}: protection levels, {}, risk {}\n  hypothesis: {}\n",
            self.scenario,
            self.sequence,
            significant(self.risk, 3),
            match self.faults.as_slice() {
                [] => "no fault".to_owned(),
                faults => format!("faults {} in every run", faults.join(", ")),
            }
        );
        out += &words::counts(&self.stages);
        for (reason, count) in self.reasons.iter().take(5) {
            out += &format!("    {count} × {reason}\n");
        }
        let percent = fixed(100.0 * self.confidence, 0);
        out += &format!(
            "  parameter, level, {percent} % interval, published σ × normal quantile, unit\n"
        );
        for of in &self.parameters {
            let number = |value: Option<f64>| {
                value.map_or_else(|| "–".to_owned(), |value| significant(value, 3))
            };
            let [low, high] = of.interval.map(number);
            out += &format!(
                "  {:22} {:>9} {:>9} to {:>9} {:>9} {}\n",
                of.name,
                number(of.level),
                low,
                high,
                number(of.normal_level),
                of.unit
            );
            for doubt in &of.doubts {
                out += &format!("    not shown: {doubt}\n");
            }
        }
        out
    }
}
