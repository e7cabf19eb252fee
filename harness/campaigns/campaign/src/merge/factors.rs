//! Factors as columns: which are texts, and which are numbers with a unit.

use crate::plan::factor_values::FactorValue;
use crate::plan::{Case, Plan};
use crate::table::ColumnValue;
use octant_scenario::quantity_of;
use std::collections::{BTreeMap, BTreeSet};

/// Unit of a factor's column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FactorUnit {
    /// Unit as the first case writes it.
    text: String,
    /// One of it in SI.
    si: f64,
}

/// Forms of the columns of a plan's factors.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FactorColumns<'a> {
    /// Factors whose numbers become texts, because another case has a text.
    texts: BTreeSet<&'a str>,
    /// Factors whose values all have units of one dimension: numbers in the unit of the first.
    units: BTreeMap<&'a str, FactorUnit>,
}

impl<'a> FactorColumns<'a> {
    /// Finds the form of every factor.
    pub(crate) fn of(plan: &'a Plan) -> Self {
        let mut all = Self::default();
        let mut refused: BTreeSet<&str> = BTreeSet::new();
        for case in &plan.cases {
            for (name, value) in case.factors.iter() {
                if matches!(value, FactorValue::Text(_)) {
                    all.texts.insert(name);
                }
                let Some(text) = written(case, value) else {
                    refused.insert(name);
                    continue;
                };
                match all.units.get(name) {
                    Some(unit) if number_in(unit, text).is_some() => {}
                    None if !refused.contains(name) => match unit_of(text) {
                        Some(unit) => _ = all.units.insert(name, unit),
                        None => _ = refused.insert(name),
                    },
                    _ => _ = refused.insert(name),
                }
            }
        }
        all.units.retain(|name, _| !refused.contains(name));
        all.texts.retain(|name| !all.units.contains_key(name));
        all
    }

    /// Takes the units from factors whose stored columns are texts: those of tables that are older than units.
    pub(crate) fn without_units(mut self, is_text: impl Fn(&str) -> bool, plan: &'a Plan) -> Self {
        let old: BTreeSet<&str> = self.units.keys().copied().filter(|name| is_text(name)).collect();
        self.units.retain(|name, _| !old.contains(name));
        let factors = plan.cases.iter().flat_map(|case| case.factors.iter());
        self.texts.extend(
            factors
                .filter(|(name, value)| old.contains(name) && matches!(value, FactorValue::Text(_)))
                .map(|(name, _)| name),
        );
        self
    }

    /// Value of a factor in its column.
    pub(crate) fn value(&self, name: &str, value: &FactorValue) -> ColumnValue {
        match value {
            FactorValue::Number(number) if self.texts.contains(name) => {
                ColumnValue::Text(number.to_string().into())
            }
            FactorValue::Number(number) => ColumnValue::Number(*number),
            FactorValue::Text(text) => {
                let number = self.units.get(name).and_then(|unit| number_in(unit, text));
                number.map_or_else(|| ColumnValue::Text(text.as_str().into()), ColumnValue::Number)
            }
        }
    }

    /// Units by the names of the columns.
    pub(crate) fn units(&self) -> BTreeMap<String, String> {
        let column =
            |(name, unit): (&&str, &FactorUnit)| (format!("factor.{name}"), unit.text.clone());
        self.units.iter().map(column).collect()
    }
}

/// Quantity of a value as the case writes it; `None` for one without a unit.
///
/// A drawn number has its unit in the case's settings, `KEY="NUMBER UNIT"`.
fn written<'a>(case: &'a Case, value: &'a FactorValue) -> Option<&'a str> {
    match value {
        FactorValue::Text(text) => Some(text),
        FactorValue::Number(number) => {
            let start = format!("=\"{number} ");
            case.set.iter().find_map(|set| {
                let at = set.find(&start)?;
                set.get(at + 2..)?.strip_suffix('"')
            })
        }
    }
}

/// Number and unit of a quantity, as written.
#[must_use]
pub fn parts(text: &str) -> Option<(f64, &str)> {
    quantity_of(text).ok()?;
    let at = text.find(|c: char| c.is_alphabetic() || "%°µ".contains(c))?;
    // An exponent is a letter too.
    let (number, unit) = match text.split_once(' ') {
        Some((number, unit)) => (number, unit),
        None => text.split_at(at),
    };
    Some((number.trim().parse().ok()?, unit.trim()))
}

fn unit_of(text: &str) -> Option<FactorUnit> {
    let (_, unit) = parts(text)?;
    let one = quantity_of(&format!("1 {unit}")).ok()?;
    (one.si > 0.0).then(|| FactorUnit { text: unit.to_owned(), si: one.si })
}

/// Number of a quantity in a unit: as written where the unit is the same.
fn number_in(unit: &FactorUnit, text: &str) -> Option<f64> {
    let (number, own) = parts(text)?;
    if own == unit.text {
        return Some(number);
    }
    let (quantity, one) = (quantity_of(text).ok()?, quantity_of(&format!("1 {}", unit.text)).ok()?);
    quantity.same_dimension(one).then(|| quantity.si / unit.si)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_has_a_number_in_the_unit_of_the_first() {
        let unit = unit_of("0.005 deg/h").unwrap();
        assert_eq!(unit.text, "deg/h");
        assert_eq!(number_in(&unit, "0.0125 deg/h"), Some(0.0125));
        let other = number_in(&unit, "1 arcsec/s").unwrap();
        assert!((other - 1.0).abs() < 1e-12, "{other}");
        assert_eq!(number_in(&unit, "3 m"), None);
        assert_eq!(number_in(&unit, "spike-1"), None);
        assert_eq!(unit_of("none"), None);
        assert_eq!(unit_of("12"), None);
    }

    #[test]
    fn numbers_with_exponents_keep_their_units() {
        assert_eq!(parts("5e-4 deg/h/g"), Some((5e-4, "deg/h/g")));
        assert_eq!(parts("-2.5 m"), Some((-2.5, "m")));
        assert_eq!(parts("spike-1 slip-1"), None);
    }
}
