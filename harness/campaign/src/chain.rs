//! Checks tables against the results from which they were made.
//!
//! A table names the BLAKE3 of each result. If the results are there too, every value of every row
//! is compared; if they aren't, as for a part made on another machine, the rows are checked for
//! consistency: the verdict of a check with its value and limit, that of a case with its checks.

use super::factors::FactorColumns;
use super::plan::Plan;
use super::results::{self, RESULT, Rows, TABLES};
use super::store::CampaignResults;
use super::table::{ColumnValue, ColumnValues, ExistingTable, TableError};
use octant_requirements::{Comparison, Verdict};
use octant_score::rederive::stands;
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;

/// Table with the rows of each case.
struct Read {
    path: PathBuf,
    columns: BTreeMap<String, ColumnValues>,
    cases: BTreeMap<usize, Vec<usize>>,
}

impl Read {
    fn of(path: PathBuf, place: &HashMap<&str, usize>) -> Result<Self, TableError> {
        let form = |reason: String| TableError::Form { path: path.clone(), reason };
        let table = ExistingTable::open(&path)?;
        let mut columns = BTreeMap::new();
        for (name, _) in &table.columns {
            columns.extend(table.column(name)?.map(|values| (name.clone(), values)));
        }
        let Some(ColumnValues::Text(ids)) = columns.get("case") else {
            return Err(form("it has no column case".to_owned()));
        };
        let mut cases: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (row, id) in ids.iter().enumerate() {
            let id = id.as_deref().unwrap_or("");
            let index = place.get(id);
            let index = index.ok_or_else(|| form(format!("the plan has no case {id}")))?;
            cases.entry(*index).or_default().push(row);
        }
        Ok(Self { path, columns, cases })
    }

    fn rows(&self, case: usize) -> &[usize] {
        self.cases.get(&case).map_or(&[], Vec::as_slice)
    }

    fn text(&self, column: &str, row: usize) -> Option<String> {
        match self.columns.get(column)?.at(row)? {
            ColumnValue::Text(text) => Some(text.to_string()),
            _ => None,
        }
    }

    fn number(&self, column: &str, row: usize) -> Option<f64> {
        match self.columns.get(column)?.at(row)? {
            ColumnValue::Number(number) => Some(number),
            _ => None,
        }
    }

    fn verdict(&self, row: usize) -> Option<Verdict> {
        let name = self.text("verdict", row)?;
        Verdict::ALL.into_iter().find(|verdict| verdict.name() == name)
    }

    fn wrong(&self, reason: String) -> TableError {
        TableError::Form { path: self.path.clone(), reason }
    }
}

/// Checks the tables at `paths`, named as by a merge, against the results of their folder, or for
/// consistency where there is none.
///
/// # Errors
/// If one can't be read, or contradicts a result or itself.
pub fn check(
    plan: &Plan,
    stored: &CampaignResults,
    path: impl Fn(&str) -> PathBuf,
) -> Result<(), TableError> {
    let place: HashMap<&str, usize> =
        plan.cases.iter().enumerate().map(|(index, case)| (case.id.as_str(), index)).collect();
    let [cases, checks, drift] = TABLES.map(|(name, _)| Read::of(path(name), &place));
    let tables = [cases?, checks?, drift?];
    let there = |index: &usize| stored.has(&plan.cases[*index].id);
    let (compared, alone): (Vec<usize>, Vec<usize>) =
        tables[0].cases.keys().copied().partition(there);
    for index in alone {
        consistent(plan, index, &tables[0], &tables[1])?;
    }
    for table in &tables[1..] {
        if let Some(index) = table.cases.keys().find(|index| !tables[0].cases.contains_key(index)) {
            let id = &plan.cases[*index].id;
            return Err(table.wrong(format!("it has case {id}, and {} hasn't", TABLES[0].0)));
        }
    }
    // One after another, because memory would hold the rows of a large campaign twice.
    let is_text = |factor: &str| {
        matches!(tables[0].columns.get(&format!("factor.{factor}")), Some(ColumnValues::Text(_)))
    };
    let factors = FactorColumns::of(plan).without_units(is_text, plan);
    for index in compared {
        let expected = results::rows(plan, stored, std::iter::once(index), &factors)?;
        for (table, rows) in tables.iter().zip(&expected) {
            same(plan, stored, index, table, rows)?;
        }
    }
    Ok(())
}

/// Checks that the rows of a case are those of its result.
fn same(
    plan: &Plan,
    stored: &CampaignResults,
    index: usize,
    table: &Read,
    expected: &Rows,
) -> Result<(), TableError> {
    let id = &plan.cases[index].id;
    let place = || stored.place(id).map_or_else(String::new, |place| place.to_string());
    let found = table.rows(index);
    if found.len() != expected.rows {
        return Err(table.wrong(format!(
            "case {id} has {} rows, its result {} gives {}",
            found.len(),
            place(),
            expected.rows
        )));
    }
    for (name, values) in &table.columns {
        for (row, at) in found.iter().enumerate() {
            let now = expected.columns.get(name).and_then(|values| values.at(row));
            // Converted as for a column of this kind.
            let mut cell = ColumnValues::new(values.kind());
            cell.push(now.clone());
            let said = values.at(*at);
            if cell.at(0) == said {
                continue;
            }
            let text = |value: &Option<ColumnValue>| match value {
                None => "nothing".to_owned(),
                Some(ColumnValue::Text(text)) => text.to_string(),
                Some(ColumnValue::Number(number)) => number.to_string(),
                Some(ColumnValue::Integer(number)) => number.to_string(),
                Some(ColumnValue::Boolean(value)) => value.to_string(),
            };
            return Err(table.wrong(format!(
                "case {id} has {} in column {name}, its result {} has {}: it isn't what this result gives",
                text(&said),
                place(),
                text(&cell.at(0))
            )));
        }
    }
    Ok(())
}

/// Checks the rows of a case for consistency with each other.
fn consistent(plan: &Plan, index: usize, cases: &Read, checks: &Read) -> Result<(), TableError> {
    let id = &plan.cases[index].id;
    let mut worst = Verdict::Pass;
    for row in checks.rows(index) {
        let requirement = checks.text("requirement", *row).unwrap_or_default();
        let sign = checks.text("comparison", *row).unwrap_or_default();
        let comparison = Comparison::ALL.into_iter().find(|known| known.sign() == sign);
        let (verdict, limit) = (checks.verdict(*row), checks.number("limit", *row));
        let (Some(verdict), Some(comparison), Some(limit)) = (verdict, comparison, limit) else {
            return Err(checks
                .wrong(format!("case {id} has no verdict, comparison or limit of {requirement}")));
        };
        let value = checks.number("value", *row);
        if !stands(verdict, comparison, value, limit) {
            let value = value.map_or("none".to_owned(), |value| value.to_string());
            return Err(checks.wrong(format!(
                "case {id} says {} of {requirement}, whose value is {value} and whose limit is {sign} {limit}",
                verdict.name()
            )));
        }
        worst = worst.worst(verdict);
    }
    for row in cases.rows(index) {
        let Some(verdict) = cases.verdict(*row) else {
            return Err(cases.wrong(format!("case {id} has no verdict")));
        };
        if verdict < worst {
            let [said, worst] = [verdict, worst].map(Verdict::name);
            return Err(cases.wrong(format!("case {id} says {said}, its checks come to {worst}")));
        }
        if cases.columns.contains_key(RESULT)
            && cases.text(RESULT, *row).is_none_or(|hash| hash.len() != 64)
        {
            return Err(cases.wrong(format!("case {id} has no hash of its result")));
        }
    }
    Ok(())
}
