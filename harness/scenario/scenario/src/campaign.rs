//! Campaign file: scenarios, factors, and early stopping.
//!
//! ```toml
//! schema = 1
//! title = "Latitudes"
//! replicates = 100
//!
//! [[scenarios]]
//! id = "static"
//! file = "static.toml"
//!
//! [[factors]]
//! name = "site.latitude"
//! values = ["0 deg", "45 deg", "75 deg"]
//!
//! [[factors]]
//! name = "spike"
//! key = "faults.spike-1.amplitude"
//! unit = "deg/h"
//! uniform = [1, 1000]
//! ```

use crate::error::{FileProblems, Problem};
use crate::keys::{
    At, CampaignKeys, CorrelationKeys, EarlyStopKeys, FactorKeys, Keys, LimitsKeys, MemberKeys,
};
pub use crate::keys::{Design, LookSpec};
use crate::other_format;
use octant_base::names::suggestion;
use octant_toml_tree::{Node, Table, Value};
use std::path::{Path, PathBuf};

/// A campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Name.
    pub title: String,
    /// Seed of the draws, and of the first replicate; `None`: that of the plan.
    pub seed: Option<u64>,
    /// Number of runs of every combination.
    pub replicates: u32,
    /// Design of the draws.
    pub design: Design,
    /// File with the requirements.
    pub requirements: Option<PathBuf>,
    /// Scenarios to run.
    pub scenarios: Vec<Member>,
    /// Factors; the last one of the grid runs fastest.
    pub factors: Vec<FactorSpec>,
    /// Correlated draws.
    pub correlations: Vec<CorrelationSpec>,
    /// Limits of a case.
    pub limits: LimitsSpec,
    /// Early stopping.
    pub stop: Option<StopSpec>,
    /// How often the results are looked at.
    pub looks: LookSpec,
}

/// A scenario of a campaign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// Name in the campaign.
    pub id: String,
    /// File.
    pub file: PathBuf,
    /// Keys that are set in the scenario, as `KEY=VALUE`.
    pub set: Vec<String>,
    /// Requirements of the campaign's file that its cases check; `None`: all that are verified by
    /// test.
    pub verifies: Option<Vec<String>>,
}

/// Varied quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorSpec {
    /// Name: a column of the results.
    pub name: String,
    /// Levels of the factor.
    pub levels: Levels,
}

/// Levels of a factor.
#[derive(Clone, Debug, PartialEq)]
pub enum Levels {
    /// Values of a key.
    Values {
        /// The key.
        key: String,
        /// The values, as TOML.
        values: Vec<String>,
        /// True if one is drawn for each replicate, instead of running every one.
        drawn: bool,
    },
    /// Sets of the scenario's faults to inject.
    Faults {
        /// Lists of ids.
        lists: Vec<Vec<String>>,
        /// True if one is drawn for each replicate, instead of running every one.
        drawn: bool,
    },
    /// Numbers from a distribution.
    Distributed {
        /// The key.
        key: String,
        /// Unit of the numbers; `None`: plain numbers.
        unit: Option<String>,
        /// The distribution.
        distribution: DistributionSpec,
    },
}

/// Distribution of drawn numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DistributionSpec {
    /// Uniform between two limits.
    Uniform {
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Gaussian, truncated at two limits.
    Normal {
        /// Mean, before it is truncated.
        mean: f64,
        /// Standard deviation, before it is truncated.
        sigma: f64,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
}

/// Correlation of two draws.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrelationSpec {
    /// Index of a factor.
    pub first: usize,
    /// Index of the other factor.
    pub second: usize,
    /// Correlation of the Gaussian copula that joins them: for normal factors it is their own.
    pub value: f64,
}

/// Limits of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitsSpec {
    /// Time, s.
    pub time_s: f64,
    /// Address space, MiB.
    pub memory_mib: u64,
}

/// Early stopping.
#[derive(Clone, Debug, PartialEq)]
pub struct StopSpec {
    /// Requirement that decides.
    pub requirement: String,
    /// Least probability with which it is kept.
    pub pass: f64,
    /// Confidence in that, one-sided.
    pub confidence: f64,
    /// Number of cases between evaluations.
    pub every: u64,
}

impl Levels {
    /// Returns the number of levels that are run as a grid; `None` if one is drawn.
    #[must_use]
    pub fn grid(&self) -> Option<usize> {
        match self {
            Self::Values { values, drawn: false, .. } => Some(values.len()),
            Self::Faults { lists, drawn: false } => Some(lists.len()),
            Self::Values { .. } | Self::Faults { .. } | Self::Distributed { .. } => None,
        }
    }
}

impl Campaign {
    /// Reads a campaign file. Names of other files are relative to its folder.
    ///
    /// # Errors
    /// If the file can't be read, isn't TOML, or isn't a campaign: every problem with its place.
    pub fn load(path: &Path) -> Result<Self, FileProblems> {
        let file = path.display().to_string();
        let text = FileProblems::text_of(path)?;
        Self::parse(&text, &file, path.parent().unwrap_or(Path::new("")))
    }

    /// Parses the text of a campaign. `file` names it in errors, `folder` contains the other files.
    ///
    /// # Errors
    /// If it isn't TOML or isn't a campaign: every problem with its place.
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, FileProblems> {
        other_format::refuse(text, file, "a campaign")?;
        let read = |keys| read(keys, folder);
        CampaignKeys::parse(text, file, |_, _| (), read)
    }
}

fn read(keys: CampaignKeys, folder: &Path) -> Result<Campaign, Problem> {
    let mut scenarios: Vec<Member> = Vec::new();
    for MemberKeys { id, file, set, verifies } in keys.scenarios {
        let id = unique(&id, scenarios.iter().map(|member| member.id.as_str()))?;
        let set = set.map_or(Vec::new(), |set| settings(&set.table));
        scenarios.push(Member { id, file: folder.join(file), set, verifies });
    }
    let mut factors: Vec<FactorSpec> = Vec::new();
    for keys in keys.factors.into_iter().flatten() {
        let at = keys.name().clone();
        let name = unique(&at, factors.iter().map(|factor| factor.name.as_str()))?;
        let levels = levels(keys)?;
        let other = factors.iter().find(|other| same_key(&other.levels, &levels));
        if let Some(other) = other {
            return Err(at.problem(format!(
                "{name:?} and {:?} set the same: expected one factor for it",
                other.name
            )));
        }
        factors.push(FactorSpec { name, levels });
    }
    let mut correlations: Vec<CorrelationSpec> = Vec::new();
    for CorrelationKeys { first: one, second: other, value } in
        keys.correlations.into_iter().flatten()
    {
        let (first, second) = (drawn(&one, &factors)?, drawn(&other, &factors)?);
        if first == second {
            return Err(other.problem("expected another factor than the first"));
        }
        let pair = |c: &CorrelationSpec| [c.first.min(c.second), c.first.max(c.second)];
        let correlation = CorrelationSpec { first, second, value };
        if correlations.iter().any(|other| pair(other) == pair(&correlation)) {
            return Err(other.problem("these two have a correlation already"));
        }
        correlations.push(correlation);
    }
    if keys.stop.is_some() && *keys.looks != LookSpec::Once {
        return Err(keys
            .looks
            .problem("found [stop] too, whose looks are counted already: expected one of both"));
    }
    let LimitsKeys { time: time_s, memory_mib } = keys.limits;
    let stop = |EarlyStopKeys { requirement, pass, confidence, every }| StopSpec {
        requirement,
        pass,
        confidence,
        every,
    };
    Ok(Campaign {
        title: keys.title,
        seed: keys.seed,
        replicates: keys.replicates,
        design: keys.design,
        requirements: keys.requirements.map(|file| folder.join(file)),
        scenarios,
        factors,
        correlations,
        limits: LimitsSpec { time_s, memory_mib },
        stop: keys.stop.map(stop),
        looks: keys.looks.value,
    })
}

/// Reads a name that isn't taken yet.
fn unique<'a>(
    name: &At<String>,
    mut taken: impl Iterator<Item = &'a str>,
) -> Result<String, Problem> {
    if name.trim().is_empty() {
        return Err(name.problem("found an empty text, expected a name"));
    }
    if taken.any(|other| other == **name) {
        let message = format!("found {:?} a second time, expected unique names", **name);
        return Err(name.problem(message));
    }
    Ok(name.value.clone())
}

/// Lists the settings of a table as `KEY=VALUE`; nested tables are parts of keys.
fn settings(table: &Table) -> Vec<String> {
    fn walk(prefix: &str, table: &Table, all: &mut Vec<String>) {
        for entry in &table.entries {
            let path = octant_toml_tree::join(prefix, &entry.key);
            match &entry.node.value {
                Value::Table(table) => walk(&path, table, all),
                value => all.push(format!("{path}={}", toml(value))),
            }
        }
    }
    let mut all = Vec::new();
    walk("", table, &mut all);
    all
}

fn toml(value: &Value) -> String {
    let mut text = String::new();
    octant_toml_tree::write_value(value, &mut text);
    text
}

fn levels(keys: FactorKeys) -> Result<Levels, Problem> {
    let key = |name: At<String>, key: Option<String>| key.unwrap_or(name.value);
    let values = |values: &At<Vec<Node>>| {
        once(values, values.iter().map(|entry| toml(&entry.value)).collect())
    };
    Ok(match keys {
        FactorKeys::Grid(keys) => Levels::Values {
            values: values(&keys.values)?,
            key: key(keys.name, keys.key),
            drawn: false,
        },
        FactorKeys::Choose(keys) => Levels::Values {
            values: values(&keys.choose)?,
            key: key(keys.name, keys.key),
            drawn: true,
        },
        FactorKeys::Faults(keys) => Levels::Faults {
            lists: once(&keys.faults, keys.faults.value.clone())?,
            drawn: keys.draw,
        },
        FactorKeys::Uniform(keys) => {
            let [low, high] = *keys.uniform;
            ascending(&keys.uniform, low, high)?;
            Levels::Distributed {
                key: key(keys.name, keys.key),
                unit: keys.unit,
                distribution: DistributionSpec::Uniform { low, high },
            }
        }
        FactorKeys::Normal(keys) => {
            let [mean, sigma] = *keys.normal;
            if sigma <= 0.0 {
                let message =
                    format!("found a standard deviation of {sigma}, expected one above 0");
                return Err(keys.normal.problem(message));
            }
            let [low, high] = keys.within.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            ascending(&keys.within, low, high)?;
            // The part of the distribution beyond this limit is less than 1e-15.
            if low > mean + 8.0 * sigma || high < mean - 8.0 * sigma {
                let message = "nothing of the distribution is between these limits";
                return Err(keys.within.problem(message));
            }
            Levels::Distributed {
                key: key(keys.name, keys.key),
                unit: keys.unit,
                distribution: DistributionSpec::Normal { mean, sigma, low, high },
            }
        }
    })
}

fn ascending<T>(at: &At<T>, low: f64, high: f64) -> Result<(), Problem> {
    if low < high {
        return Ok(());
    }
    Err(at.problem(format!("found {low} and {high}, expected the smaller one first")))
}

/// Refuses a grid that contains a value twice, because it would run the same case twice.
fn once<T: PartialEq + std::fmt::Debug, A>(at: &At<A>, values: Vec<T>) -> Result<Vec<T>, Problem> {
    let again = values.iter().enumerate().find(|(i, value)| values[..*i].contains(value));
    match again {
        Some((_, value)) => {
            Err(at.problem(format!("found {value:?} a second time, expected it once")))
        }
        None => Ok(values),
    }
}

/// Returns whether two factors set the same key.
fn same_key(a: &Levels, b: &Levels) -> bool {
    fn key(levels: &Levels) -> Option<&str> {
        match levels {
            Levels::Values { key, .. } | Levels::Distributed { key, .. } => Some(key),
            Levels::Faults { .. } => None,
        }
    }
    key(a) == key(b)
}

/// Returns the index of a factor that is drawn from a distribution.
fn drawn(name: &At<String>, factors: &[FactorSpec]) -> Result<usize, Problem> {
    let Some(index) = factors.iter().position(|factor| factor.name == **name) else {
        let known = suggestion(name, factors.iter().map(|factor| factor.name.as_str()), "factors");
        return Err(name.problem(format!("found {:?}, {known}", **name)));
    };
    if !matches!(factors[index].levels, Levels::Distributed { .. }) {
        return Err(name.problem(format!(
            "{:?} has no distribution: expected a factor with uniform or normal",
            **name
        )));
    }
    Ok(index)
}
