//! Cases of a plan, of which the same parts are shared.

use super::factor_values::{FactorValue, FactorValues};
use super::planned::Case;
use super::shared::{LastValues, SharedText, SharedTexts};
use serde::Deserializer;
use serde::de::{SeqAccess, Visitor};
use std::fmt;

/// Parts of the cases that came last.
#[derive(Debug, Default)]
pub(crate) struct SharedParts {
    texts: LastValues<SharedText>,
    lists: LastValues<SharedTexts>,
    factors: LastValues<FactorValues>,
}

impl SharedParts {
    /// Returns the case with the parts of others, where they are the same.
    pub(crate) fn share(&mut self, case: Case) -> Case {
        Case {
            scenario: self.texts.share(case.scenario),
            set: self.list(&case.set),
            faults: case.faults.map(|faults| self.list(&faults)),
            factors: self.factors(&case.factors),
            ..case
        }
    }

    fn list(&mut self, list: &SharedTexts) -> SharedTexts {
        // A list of its own has the texts of others.
        let list = list.iter().map(|text| self.texts.share(text.clone())).collect();
        self.lists.share(list)
    }

    fn factors(&mut self, factors: &FactorValues) -> FactorValues {
        let one = |(name, value): (&SharedText, &FactorValue)| {
            let value = match value {
                FactorValue::Number(number) => FactorValue::Number(*number),
                FactorValue::Text(text) => FactorValue::Text(self.texts.share(text.clone())),
            };
            (self.texts.share(name.clone()), value)
        };
        let factors: FactorValues = factors.shared().map(one).collect();
        self.factors.share_by(factors, FactorValues::hash, FactorValues::is_same)
    }
}

/// Reads a list of cases.
pub(crate) fn read<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Case>, D::Error> {
    struct Cases;
    impl<'de> Visitor<'de> for Cases {
        type Value = Vec<Case>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a list of cases")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<Case>, A::Error> {
            let (mut cases, mut parts) = (Vec::new(), SharedParts::default());
            while let Some(case) = list.next_element()? {
                cases.push(parts.share(case));
            }
            cases.shrink_to_fit();
            Ok(cases)
        }
    }
    deserializer.deserialize_seq(Cases)
}
