//! Values of the factors of a case.

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Value of a factor in a case.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum FactorValue {
    /// Number, in the factor's unit.
    Number(f64),
    /// Anything else, as text.
    Text(String),
}

/// Values of the factors of a case, in the order of the names.
///
/// A plan can have millions of cases with one or two factors each, for which a tree would take ten
/// times the memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FactorValues(Box<[(Box<str>, FactorValue)]>);

impl FactorValues {
    /// Returns the value of a factor.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&FactorValue> {
        let at = self.0.binary_search_by(|(other, _)| (**other).cmp(name)).ok()?;
        self.0.get(at).map(|(_, value)| value)
    }

    /// Returns names and values, in the order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &FactorValue)> {
        self.0.iter().map(|(name, value)| (&**name, value))
    }
}

impl FromIterator<(String, FactorValue)> for FactorValues {
    /// The last value of a name counts.
    fn from_iter<I: IntoIterator<Item = (String, FactorValue)>>(values: I) -> Self {
        let all: std::collections::BTreeMap<String, FactorValue> = values.into_iter().collect();
        Self(all.into_iter().map(|(name, value)| (name.into_boxed_str(), value)).collect())
    }
}

impl Serialize for FactorValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for FactorValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Values;
        impl<'de> Visitor<'de> for Values {
            type Value = FactorValues;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("values by the names of factors")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<FactorValues, A::Error> {
                let mut all = Vec::new();
                while let Some(pair) = map.next_entry::<String, FactorValue>()? {
                    all.push(pair);
                }
                Ok(all.into_iter().collect())
            }
        }
        deserializer.deserialize_map(Values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_an_object_sorted_by_name() {
        let text = r#"{"b":1.5,"a":"x","b":2.0}"#;
        let values: FactorValues = serde_json::from_str(text).unwrap();
        assert_eq!(serde_json::to_string(&values).unwrap(), r#"{"a":"x","b":2.0}"#);
        assert_eq!(values.get("b"), Some(&FactorValue::Number(2.0)));
        assert_eq!((values.get("c"), values.iter().count()), (None, 2));
        assert!(serde_json::from_str::<FactorValues>("[1]").is_err());
        assert_eq!(serde_json::to_string(&FactorValues::default()).unwrap(), "{}");
    }
}
