//! Values of the factors of a case.

use super::shared::SharedText;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::hash::{BuildHasher, Hash, Hasher};
use std::sync::Arc;

/// Value of a factor in a case.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum FactorValue {
    /// Number, in the factor's unit.
    Number(f64),
    /// Anything else, as text.
    Text(SharedText),
}

/// Values of the factors of a case, in the order of the names.
///
/// A plan can have millions of cases with one or two factors each, for which a tree would take ten
/// times the memory, and many of which have the same values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FactorValues(Arc<[(SharedText, FactorValue)]>);

impl FactorValues {
    /// Returns the value of a factor.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&FactorValue> {
        let at = self.0.binary_search_by(|(other, _)| (**other).cmp(name)).ok()?;
        self.0.get(at).map(|(_, value)| value)
    }

    /// Returns a number that is the same for values that are the same.
    pub(crate) fn hash(&self, hasher: &impl BuildHasher) -> u64 {
        let mut state = hasher.build_hasher();
        for (name, value) in self.iter() {
            name.hash(&mut state);
            match value {
                FactorValue::Number(number) => number.to_bits().hash(&mut state),
                FactorValue::Text(text) => text.hash(&mut state),
            }
        }
        state.finish()
    }

    /// Returns whether they can stand for others: 0 and -0 are equal, and not the same.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        self.0.len() == other.0.len()
            && self.0.iter().zip(other.0.iter()).all(|((a_name, a), (b_name, b))| {
                a_name == b_name
                    && match (a, b) {
                        (FactorValue::Number(a), FactorValue::Number(b)) => {
                            a.to_bits() == b.to_bits()
                        }
                        _ => a == b,
                    }
            })
    }

    /// Returns names and values as they are shared, in the order of the names.
    pub(crate) fn shared(&self) -> impl Iterator<Item = (&SharedText, &FactorValue)> {
        self.0.iter().map(|(name, value)| (name, value))
    }

    /// Returns names and values, in the order of the names.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &FactorValue)> {
        self.0.iter().map(|(name, value)| (&**name, value))
    }
}

impl FromIterator<(SharedText, FactorValue)> for FactorValues {
    /// The last value of a name counts.
    fn from_iter<I: IntoIterator<Item = (SharedText, FactorValue)>>(values: I) -> Self {
        let all: std::collections::BTreeMap<SharedText, FactorValue> = values.into_iter().collect();
        Self(all.into_iter().collect())
    }
}

impl Serialize for FactorValues {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for FactorValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Value;
        impl Visitor<'_> for Value {
            type Value = FactorValue;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a text")
            }

            fn visit_f64<E>(self, number: f64) -> Result<FactorValue, E> {
                Ok(FactorValue::Number(number))
            }

            fn visit_u64<E>(self, number: u64) -> Result<FactorValue, E> {
                Ok(FactorValue::Number(number as f64))
            }

            fn visit_i64<E>(self, number: i64) -> Result<FactorValue, E> {
                Ok(FactorValue::Number(number as f64))
            }

            fn visit_str<E>(self, text: &str) -> Result<FactorValue, E> {
                Ok(FactorValue::Text(text.into()))
            }
        }
        deserializer.deserialize_any(Value)
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
                while let Some(pair) = map.next_entry::<SharedText, FactorValue>()? {
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
        let [zero, minus]: [FactorValues; 2] = [0.0, -0.0]
            .map(|number| [("a".into(), FactorValue::Number(number))].into_iter().collect());
        assert!(zero == minus && !zero.is_same(&minus) && zero.is_same(&zero.clone()));
        assert_eq!((values.get("c"), values.iter().count()), (None, 2));
        assert!(serde_json::from_str::<FactorValues>("[1]").is_err());
        assert_eq!(serde_json::to_string(&FactorValues::default()).unwrap(), "{}");
    }
}
