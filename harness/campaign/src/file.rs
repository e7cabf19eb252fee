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

use octant_base::names::suggestion;
use octant_scenario::complete::complete;
use octant_scenario::document::{self, DocumentNode, DocumentTable, DocumentValue};
use octant_scenario::error::{Place, Problem, ScenarioError};
use octant_scenario::keys::CAMPAIGN;
use octant_scenario::read::TableReader;
use octant_statistics::proportion::Demand;
use std::path::{Path, PathBuf};

/// A campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Name.
    pub title: String,
    /// Seed of the draws, and of the first replicate.
    pub seed: u64,
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
}

/// Design of the draws over the replicates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Design {
    /// Independent draws.
    MonteCarlo,
    /// One draw in each of as many strips as there are replicates (McKay, Beckman and Conover,
    /// 1979).
    LatinHypercube,
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
    /// Evidence required.
    pub demand: Demand,
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
    pub fn load(path: &Path) -> Result<Self, ScenarioError> {
        let file = path.display().to_string();
        let text = ScenarioError::text_of(path)?;
        Self::parse(&text, &file, path.parent().unwrap_or(Path::new("")))
    }

    /// Parses the text of a campaign. `file` names it in errors, `folder` contains the other files.
    ///
    /// # Errors
    /// If it isn't TOML or isn't a campaign: every problem with its place.
    pub fn parse(text: &str, file: &str, folder: &Path) -> Result<Self, ScenarioError> {
        let with_file = |problems| ScenarioError { file: file.to_owned(), problems };
        let mut document = document::parse(text).map_err(with_file)?;
        let mut problems = Vec::new();
        let start = Place::File { line: 1, column: 1 };
        complete(&mut document, &CAMPAIGN, "", &start, &mut problems);
        if !problems.is_empty() {
            return Err(with_file(problems));
        }
        read(&document, folder).map_err(|problem| with_file(vec![problem]))
    }
}

fn read(document: &DocumentTable, folder: &Path) -> Result<Campaign, Problem> {
    let root = TableReader::root(document);
    let mut scenarios: Vec<Member> = Vec::new();
    for table in root.tables("scenarios") {
        let id = unique(&table, "id", scenarios.iter().map(|member| member.id.as_str()))?;
        let set = table.node("set").map_or(Vec::new(), settings);
        let verifies = table.node("verifies").map(names);
        scenarios.push(Member { id, file: folder.join(table.text("file")?), set, verifies });
    }
    let mut factors: Vec<FactorSpec> = Vec::new();
    for table in root.tables("factors") {
        let name = unique(&table, "name", factors.iter().map(|factor| factor.name.as_str()))?;
        let levels = levels(&table, &name)?;
        let other = factors.iter().find(|other| same_key(&other.levels, &levels));
        if let Some(other) = other {
            return Err(table.problem(
                "name",
                format!("{name:?} and {:?} set the same: expected one factor for it", other.name),
            ));
        }
        factors.push(FactorSpec { name, levels });
    }
    let mut correlations: Vec<CorrelationSpec> = Vec::new();
    for table in root.tables("correlations") {
        let [first, second] = ["first", "second"].map(|key| drawn(&table, key, &factors));
        let (first, second) = (first?, second?);
        if first == second {
            return Err(table.problem("second", "expected another factor than the first"));
        }
        let pair = |c: &CorrelationSpec| [c.first.min(c.second), c.first.max(c.second)];
        let correlation = CorrelationSpec { first, second, value: table.number("value")? };
        if correlations.iter().any(|other| pair(other) == pair(&correlation)) {
            return Err(table.problem("second", "these two have a correlation already"));
        }
        correlations.push(correlation);
    }
    let limits = root.table("limits")?;
    let stop = match root.optional_table("stop") {
        None => None,
        Some(stop) => Some(StopSpec {
            requirement: stop.text("requirement")?.to_owned(),
            demand: Demand { pass: stop.number("pass")?, confidence: stop.number("confidence")? },
            every: stop.integer("every")?,
        }),
    };
    Ok(Campaign {
        title: root.text("title")?.to_owned(),
        seed: root.integer("seed")?,
        replicates: root.integer("replicates")?,
        design: match root.text("design")? {
            "latin-hypercube" => Design::LatinHypercube,
            _ => Design::MonteCarlo,
        },
        requirements: root.optional_text("requirements").map(|file| folder.join(file)),
        scenarios,
        factors,
        correlations,
        limits: LimitsSpec {
            time_s: limits.si("time")?,
            memory_mib: limits.integer("memory_mib")?,
        },
        stop,
    })
}

/// Reads a name that isn't taken yet.
fn unique<'a>(
    table: &TableReader<'_>,
    key: &str,
    mut taken: impl Iterator<Item = &'a str>,
) -> Result<String, Problem> {
    let name = table.text(key)?;
    if name.trim().is_empty() {
        return Err(table.problem(key, "found an empty text, expected a name"));
    }
    if taken.any(|other| other == name) {
        return Err(
            table.problem(key, format!("found {name:?} a second time, expected unique names"))
        );
    }
    Ok(name.to_owned())
}

/// Lists the settings of a table as `KEY=VALUE`; nested tables are parts of keys.
fn settings(node: &DocumentNode) -> Vec<String> {
    fn walk(prefix: &str, node: &DocumentNode, all: &mut Vec<String>) {
        match &node.value {
            DocumentValue::Table(table) => {
                for entry in &table.entries {
                    let path = octant_scenario::complete::join(prefix, &entry.key);
                    walk(&path, &entry.node, all);
                }
            }
            value => all.push(format!("{prefix}={}", toml(value))),
        }
    }
    let mut all = Vec::new();
    walk("", node, &mut all);
    all
}

fn toml(value: &DocumentValue) -> String {
    let mut text = String::new();
    document::write_value(value, &mut text);
    text
}

fn levels(table: &TableReader<'_>, name: &str) -> Result<Levels, Problem> {
    let key = || table.optional_text("key").unwrap_or(name).to_owned();
    let unit = || table.optional_text("unit").map(str::to_owned);
    let distributed = |distribution| Levels::Distributed { key: key(), unit: unit(), distribution };
    for (list, drawn) in [("values", false), ("choose", true)] {
        if let Some(DocumentNode { value: DocumentValue::Array(entries), .. }) = table.node(list) {
            let values: Vec<String> = entries.iter().map(|entry| toml(&entry.value)).collect();
            once(table, list, &values)?;
            return Ok(Levels::Values { key: key(), values, drawn });
        }
    }
    if let Some(DocumentNode { value: DocumentValue::Array(entries), .. }) = table.node("faults") {
        let lists: Vec<Vec<String>> = entries.iter().map(names).collect();
        once(table, "faults", &lists)?;
        return Ok(Levels::Faults { lists, drawn: table.boolean("draw")? });
    }
    if table.node("uniform").is_some() {
        let [low, high] = table.numbers("uniform")?;
        ascending(table, "uniform", low, high)?;
        return Ok(distributed(DistributionSpec::Uniform { low, high }));
    }
    let [mean, sigma] = table.numbers("normal")?;
    if sigma <= 0.0 {
        let message = format!("found a standard deviation of {sigma}, expected one above 0");
        return Err(table.problem("normal", message));
    }
    let mut within = [f64::NEG_INFINITY, f64::INFINITY];
    if table.node("within").is_some() {
        within = table.numbers("within")?;
        ascending(table, "within", within[0], within[1])?;
        // The part of the distribution beyond this limit is less than 1e-15.
        if within[0] > mean + 8.0 * sigma || within[1] < mean - 8.0 * sigma {
            let message = "nothing of the distribution is between these limits".to_owned();
            return Err(table.problem("within", message));
        }
    }
    let [low, high] = within;
    Ok(distributed(DistributionSpec::Normal { mean, sigma, low, high }))
}

fn names(node: &DocumentNode) -> Vec<String> {
    let DocumentValue::Array(entries) = &node.value else { return Vec::new() };
    let text = |entry: &DocumentNode| match &entry.value {
        DocumentValue::Text(text) => Some(text.clone()),
        _ => None,
    };
    entries.iter().filter_map(text).collect()
}

fn ascending(table: &TableReader<'_>, key: &str, low: f64, high: f64) -> Result<(), Problem> {
    if low < high {
        return Ok(());
    }
    Err(table.problem(key, format!("found {low} and {high}, expected the smaller one first")))
}

/// Refuses a grid that contains a value twice, because it would run the same case twice.
fn once<T: PartialEq + std::fmt::Debug>(
    table: &TableReader<'_>,
    key: &str,
    values: &[T],
) -> Result<(), Problem> {
    let again = values.iter().enumerate().find(|(i, value)| values[..*i].contains(value));
    match again {
        Some((_, value)) => {
            Err(table.problem(key, format!("found {value:?} a second time, expected it once")))
        }
        None => Ok(()),
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
fn drawn(table: &TableReader<'_>, key: &str, factors: &[FactorSpec]) -> Result<usize, Problem> {
    let name = table.text(key)?;
    let of = |factor: &FactorSpec| matches!(factor.levels, Levels::Distributed { .. });
    let Some(index) = factors.iter().position(|factor| factor.name == name) else {
        let known = suggestion(name, factors.iter().map(|factor| factor.name.as_str()), "factors");
        return Err(table.problem(key, format!("found {name:?}, {known}")));
    };
    if !of(&factors[index]) {
        let message =
            format!("{name:?} has no distribution: expected a factor with uniform or normal");
        return Err(table.problem(key, message));
    }
    Ok(index)
}
