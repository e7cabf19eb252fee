//! Checks tables against the results from which they were made.
//!
//! A table names the BLAKE3 of each result. If the results are there too, every value of every row
//! is compared; if they aren't, as for a part made on another machine, the rows are checked for
//! consistency: the verdict of a check with its value and limit, that of a case with its checks.

use super::factors::FactorColumns;
use super::results::{self, RESULT, TABLES};
use super::rows::{CaseColumn, CaseTable};
use crate::plan::{CasePlaces, Plan};
use crate::store::CampaignResults;
use crate::table::spill::SpilledRows;
use crate::table::{ColumnKind, ColumnValue, TableError};
use octant_score::rederive::stands;
use octant_verdict::{Comparison, Verdict};
use std::path::PathBuf;

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
    let place = CasePlaces::of(plan);
    let [cases, checks, drift] = TABLES.map(|(name, _)| CaseTable::open(&path(name), &place));
    let tables = [cases?, checks?, drift?];
    let there = |index: &usize| stored.has(&plan.cases[*index].id);
    let alone: Vec<usize> = tables[0].cases().filter(|index| !there(index)).collect();
    consistent(plan, &alone, &tables[0], &tables[1])?;
    drop(alone);
    for table in &tables[1..] {
        if let Some(index) = table.cases().find(|index| tables[0].rows(*index).is_empty()) {
            let id = &plan.cases[index].id;
            return Err(wrong(table, format!("it has case {id}, and {} hasn't", TABLES[0].0)));
        }
    }
    let is_text = |factor: &str| {
        tables[0].table.columns.contains(&(format!("factor.{factor}"), ColumnKind::Text))
    };
    let factors = FactorColumns::of(plan).without_units(is_text, plan);
    // In a temporary folder of the system: the folder of the tables may be write-protected.
    // A plan has at most ten million cases.
    let compared = tables[0].cases().filter(there).map(|index| u32::try_from(index).unwrap_or(0));
    let compared: Vec<u32> = compared.collect();
    let expected = results::rows(plan, stored, &compared, &factors, &std::env::temp_dir())?;
    for (number, (table, rows)) in tables.iter().zip(&expected.tables).enumerate() {
        let counts = expected.counts.iter().map(|counts| counts[number] as usize);
        let cases = compared.iter().map(|index| *index as usize).zip(counts);
        same(plan, stored, cases, table, rows)?;
    }
    Ok(())
}

/// Makes the error of a table that contradicts something.
fn wrong(table: &CaseTable, reason: String) -> TableError {
    TableError::Form { path: table.path.clone(), reason }
}

/// Checks that the rows of cases are those of their results. `cases` holds the place of each in the
/// plan, and the number of rows that its result gives.
fn same(
    plan: &Plan,
    stored: &CampaignResults,
    cases: impl Iterator<Item = (usize, usize)> + Clone,
    table: &CaseTable,
    expected: &SpilledRows,
) -> Result<(), TableError> {
    let id = |case: usize| &plan.cases[case].id;
    let place = |case| stored.place(id(case)).map_or_else(String::new, |place| place.to_string());
    for (case, count) in cases.clone() {
        let found = table.count(case);
        if found != count {
            return Err(wrong(
                table,
                format!(
                    "case {} has {found} rows, its result {} gives {count}",
                    id(case),
                    place(case)
                ),
            ));
        }
    }
    for (name, kind) in &table.table.columns {
        let mut values = table.values(name)?;
        let mut of_results = expected.column(name);
        for (case, _) in cases.clone() {
            for row in table.rows(case).iter().flat_map(|rows| rows.each()) {
                let said = values.at(row)?;
                // Converted as for a column of this kind.
                let now = kind.converted(of_results.next().transpose()?.flatten());
                if now == said {
                    continue;
                }
                return Err(wrong(
                    table,
                    format!(
                        "case {} has {} in column {name}, its result {} has {}: it isn't what this \
                         result gives",
                        id(case),
                        in_words(&said),
                        place(case),
                        in_words(&now)
                    ),
                ));
            }
        }
    }
    Ok(())
}

fn in_words(value: &Option<ColumnValue>) -> String {
    match value {
        None => "nothing".to_owned(),
        Some(ColumnValue::Text(text)) => text.to_string(),
        Some(ColumnValue::Number(number)) => number.to_string(),
        Some(ColumnValue::Integer(number)) => number.to_string(),
        Some(ColumnValue::Boolean(value)) => value.to_string(),
    }
}

/// Texts and numbers of a column.
struct Cells(CaseColumn);

impl Cells {
    fn of(table: &CaseTable, column: &str) -> Result<Self, TableError> {
        table.values(column).map(Self)
    }

    fn text(&mut self, row: usize) -> Result<Option<String>, TableError> {
        Ok(match self.0.at(row)? {
            Some(ColumnValue::Text(text)) => Some(text.to_string()),
            _ => None,
        })
    }

    fn number(&mut self, row: usize) -> Result<Option<f64>, TableError> {
        Ok(match self.0.at(row)? {
            Some(ColumnValue::Number(number)) => Some(number),
            _ => None,
        })
    }

    fn verdict(&mut self, row: usize) -> Result<Option<Verdict>, TableError> {
        let name = self.text(row)?;
        Ok(Verdict::ALL.into_iter().find(|verdict| Some(verdict.name()) == name.as_deref()))
    }
}

/// Checks the rows of cases for consistency with each other.
fn consistent(
    plan: &Plan,
    alone: &[usize],
    cases: &CaseTable,
    checks: &CaseTable,
) -> Result<(), TableError> {
    let of_checks = |column: &str| Cells::of(checks, column);
    let (mut requirements, mut signs) = (of_checks("requirement")?, of_checks("comparison")?);
    let (mut verdicts, mut limits) = (of_checks("verdict")?, of_checks("limit")?);
    let mut values = of_checks("value")?;
    let mut of_cases = Cells::of(cases, "verdict")?;
    let mut hashes = Cells::of(cases, RESULT)?;
    let has_hashes = cases.table.columns.iter().any(|(name, _)| name == RESULT);
    for index in alone {
        let id = &plan.cases[*index].id;
        let mut worst = Verdict::Pass;
        for row in checks.rows(*index).iter().flat_map(|rows| rows.each()) {
            let requirement = requirements.text(row)?.unwrap_or_default();
            let sign = signs.text(row)?.unwrap_or_default();
            let comparison = Comparison::ALL.into_iter().find(|known| known.sign() == sign);
            let (verdict, limit) = (verdicts.verdict(row)?, limits.number(row)?);
            let value = values.number(row)?;
            let (Some(verdict), Some(comparison), Some(limit)) = (verdict, comparison, limit)
            else {
                return Err(wrong(
                    checks,
                    format!("case {id} has no verdict, comparison or limit of {requirement}"),
                ));
            };
            if !stands(verdict, comparison, value, limit) {
                let value = value.map_or("none".to_owned(), |value| value.to_string());
                return Err(wrong(
                    checks,
                    format!(
                        "case {id} says {} of {requirement}, whose value is {value} and whose limit is \
                         {sign} {limit}",
                        verdict.name()
                    ),
                ));
            }
            worst = worst.worst(verdict);
        }
        for row in cases.rows(*index).iter().flat_map(|rows| rows.each()) {
            let Some(verdict) = of_cases.verdict(row)? else {
                return Err(wrong(cases, format!("case {id} has no verdict")));
            };
            if verdict < worst {
                let [said, worst] = [verdict, worst].map(Verdict::name);
                let reason = format!("case {id} says {said}, its checks come to {worst}");
                return Err(wrong(cases, reason));
            }
            if has_hashes && hashes.text(row)?.is_none_or(|hash| hash.len() != 64) {
                return Err(wrong(cases, format!("case {id} has no hash of its result")));
            }
        }
    }
    Ok(())
}
