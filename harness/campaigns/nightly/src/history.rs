//! `history.parquet`: the numbers of all nights, one row per measure and scenario.

use super::compare::NightComparison;
use super::night::Night;
use super::results::CaseRow;
use octant_campaign::table::{
    ColumnKind, ColumnValue, ColumnValues, ExistingTable, TableError, write,
};
use octant_statistics::sample::{mean, percentile, rms};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Value in place of the plan's id in the table's metadata: this table isn't of a campaign.
const OF: &str = "nightly";

/// Columns.
const COLUMNS: [(&str, ColumnKind); 20] = [
    ("night", ColumnKind::Text),
    ("started", ColumnKind::Text),
    ("verdict", ColumnKind::Text),
    ("baseline", ColumnKind::Text),
    ("octant", ColumnKind::Text),
    ("commit", ColumnKind::Text),
    ("changed", ColumnKind::Boolean),
    ("program_sha256", ColumnKind::Text),
    ("host", ColumnKind::Text),
    ("campaign", ColumnKind::Text),
    ("plan", ColumnKind::Text),
    ("scenario", ColumnKind::Text),
    ("measure", ColumnKind::Text),
    ("count", ColumnKind::Integer),
    ("mean", ColumnKind::Number),
    ("rms", ColumnKind::Number),
    ("median", ColumnKind::Number),
    ("p95", ColumnKind::Number),
    ("max", ColumnKind::Number),
    ("change", ColumnKind::Text),
];

/// All nights so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    rows: Vec<Row>,
}

/// Row: a value, or null, for each column.
type Row = Vec<Option<ColumnValue>>;

/// Line of the trend: one measure over the nights.
#[derive(Clone, Debug, PartialEq)]
pub struct TrendLine {
    /// The campaign.
    pub campaign: String,
    /// The scenario.
    pub scenario: String,
    /// The measure.
    pub measure: String,
    /// Nights.
    pub points: Vec<TrendPoint>,
}

/// A measure in a night.
#[derive(Clone, Debug, PartialEq)]
pub struct TrendPoint {
    /// Index of the night.
    pub night: usize,
    /// Median over its cases.
    pub median: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Change against the baseline; empty if nothing was compared.
    pub change: String,
}

/// Returns the file of the history in its folder.
#[must_use]
pub fn file(folder: &Path) -> PathBuf {
    folder.join("history.parquet")
}

impl History {
    /// Reads the history of a folder; empty before the first night.
    ///
    /// # Errors
    /// If it is damaged, or a newer version wrote it.
    pub fn read(folder: &Path) -> Result<Self, TableError> {
        let path = file(folder);
        if !path.exists() {
            return Ok(Self::default());
        }
        let table = ExistingTable::open(&path)?;
        let form = |reason: String| TableError::Form { path: path.clone(), reason };
        if table.plan != OF {
            return Err(form("it is a table of a campaign: expected a history".to_owned()));
        }
        let columns = COLUMNS.iter().map(|(name, kind)| {
            let values = table.column(name)?;
            let values = values.filter(|values| values.kind() == *kind);
            values.ok_or_else(|| form(format!("it has no column {name} of its kind")))
        });
        let columns = columns.collect::<Result<Vec<ColumnValues>, _>>()?;
        let row = |row| columns.iter().map(|values| values.at(row)).collect();
        Ok(Self { rows: (0..table.rows).map(row).collect() })
    }

    /// Adds a night, and replaces an existing one of the same name.
    pub fn put(
        &mut self,
        night: &Night,
        verdict: &str,
        rows: &BTreeMap<String, Vec<CaseRow>>,
        comparison: Option<&NightComparison>,
    ) {
        let name = Some(ColumnValue::Text(night.id.as_str().into()));
        self.rows.retain(|row| row.first() != Some(&name));
        let text = |text: &str| Some(ColumnValue::Text(text.into()));
        let git = night.program.git.as_ref();
        let head: Row = vec![
            name,
            text(&night.started),
            text(verdict),
            comparison.and_then(|comparison| text(&comparison.baseline)),
            text(&night.program.octant),
            git.and_then(|git| text(&git.commit)),
            git.map(|git| ColumnValue::Boolean(git.dirty)),
            text(&night.program.sha256),
            text(&night.host.name),
        ];
        for measured in measured(night, rows) {
            let Measured { campaign, plan, scenario, measure, values } = measured;
            let change = comparison.and_then(|comparison| {
                comparison.tests.iter().find(|test| {
                    (&test.campaign, &test.scenario, &test.measure)
                        == (&campaign, &scenario, &measure)
                })
            });
            let number = |number: Option<f64>| {
                number.filter(|number| number.is_finite()).map(ColumnValue::Number)
            };
            let max = values.iter().copied().fold(None, |max: Option<f64>, value| {
                Some(max.map_or(value, |max| max.max(value)))
            });
            let mut row = head.clone();
            row.extend([
                text(&campaign),
                plan.as_deref().and_then(text),
                text(&scenario),
                text(&measure),
                i64::try_from(values.len()).ok().map(ColumnValue::Integer),
                number(mean(&values)),
                number(rms(&values)),
                number(percentile(&values, 0.5)),
                number(percentile(&values, 0.95)),
                number(max),
                change.and_then(|test| text(test.change.name())),
            ]);
            self.rows.push(row);
        }
    }

    /// Writes the file: whole or not at all.
    ///
    /// # Errors
    /// If the operating system refuses; an earlier file then stays unchanged.
    pub fn write(&self, folder: &Path) -> Result<(), TableError> {
        let columns = COLUMNS.map(|(name, kind)| (name.to_owned(), kind));
        write(&file(folder), OF, &columns, |index| {
            let mut values = ColumnValues::new(columns[index].1);
            for row in &self.rows {
                values.push(row.get(index).cloned().flatten());
            }
            Ok(Cow::Owned(values))
        })
    }

    fn text(row: &Row, column: &str) -> String {
        let index = COLUMNS.iter().position(|(name, _)| *name == column);
        match index.and_then(|index| row.get(index)) {
            Some(Some(ColumnValue::Text(text))) => text.to_string(),
            _ => String::new(),
        }
    }

    fn number(row: &Row, column: &str) -> f64 {
        let index = COLUMNS.iter().position(|(name, _)| *name == column);
        match index.and_then(|index| row.get(index)) {
            Some(Some(ColumnValue::Number(number))) => *number,
            _ => f64::NAN,
        }
    }

    /// Lists the nights, the oldest first, with the columns of each.
    #[must_use]
    pub fn nights(&self) -> Vec<BTreeMap<&'static str, String>> {
        let mut seen = BTreeSet::new();
        let first = self.rows.iter().filter(|row| seen.insert(Self::text(row, "night")));
        let told =
            ["night", "started", "verdict", "baseline", "octant", "commit", "program_sha256"];
        first.map(|row| told.map(|name| (name, Self::text(row, name))).into()).collect()
    }

    /// Returns the lines of the trend.
    #[must_use]
    pub fn lines(&self) -> Vec<TrendLine> {
        let nights: Vec<String> =
            self.nights().iter().filter_map(|night| night.get("night").cloned()).collect();
        let mut lines: BTreeMap<[String; 3], Vec<TrendPoint>> = BTreeMap::new();
        for row in &self.rows {
            let Some(night) = nights.iter().position(|n| *n == Self::text(row, "night")) else {
                continue;
            };
            let key = ["campaign", "scenario", "measure"].map(|name| Self::text(row, name));
            lines.entry(key).or_default().push(TrendPoint {
                night,
                median: Self::number(row, "median"),
                p95: Self::number(row, "p95"),
                change: Self::text(row, "change"),
            });
        }
        let line = |([campaign, scenario, measure], points): ([String; 3], _)| TrendLine {
            campaign,
            scenario,
            measure,
            points,
        };
        lines.into_iter().map(line).collect()
    }
}

struct Measured {
    campaign: String,
    plan: Option<String>,
    scenario: String,
    measure: String,
    values: Vec<f64>,
}

/// Collects all measures of a night. For passes, a value is 1 or 0.
fn measured(night: &Night, rows: &BTreeMap<String, Vec<CaseRow>>) -> Vec<Measured> {
    let mut all: BTreeMap<[String; 3], Vec<f64>> = BTreeMap::new();
    let fraction = |passed: bool| f64::from(u8::from(passed));
    for (campaign, rows) in rows {
        for row in rows {
            let mut put = |measure: String, value: f64| {
                let key = [campaign.clone(), row.scenario.clone(), measure];
                all.entry(key).or_default().push(value);
            };
            for (name, value) in &row.measures {
                put(name.clone(), *value);
            }
            for (id, (verdict, margin)) in &row.checks {
                if let Some(margin) = margin {
                    put(format!("margin of {id}"), *margin);
                }
                let passed = *verdict == octant_verdict::Verdict::Pass;
                put(format!("passes of {id}"), fraction(passed));
            }
        }
    }
    for result in &night.suite {
        let key = ["suite", "every case", "ended as expected"].map(str::to_owned);
        all.entry(key).or_default().push(fraction(result.problem.is_none()));
    }
    let plan = |name: &str| {
        let campaign = night.campaigns.iter().find(|campaign| campaign.name == name)?;
        Some(campaign.plan.clone())
    };
    let one = |([campaign, scenario, measure], values): ([String; 3], _)| Measured {
        plan: plan(&campaign),
        campaign,
        scenario,
        measure,
        values,
    };
    all.into_iter().map(one).collect()
}
