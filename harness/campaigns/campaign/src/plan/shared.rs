//! Texts of cases in little memory: a plan can have millions of cases, and most of their texts are the
//! same in many of them.

use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Borrow;
use std::fmt;
use std::hash::{BuildHasher, Hash, RandomState};
use std::ops::Deref;
use std::sync::Arc;

/// A text that others may share.
#[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SharedText(Arc<str>);

/// A list of texts that others may share.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct SharedTexts(Arc<[SharedText]>);

impl SharedText {
    /// Returns the text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Deref for SharedText {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl Borrow<str> for SharedText {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl AsRef<str> for SharedText {
    fn as_ref(&self) -> &str {
        &self.0
    }
}

impl From<&str> for SharedText {
    fn from(text: &str) -> Self {
        Self(text.into())
    }
}

impl From<String> for SharedText {
    fn from(text: String) -> Self {
        Self(text.into())
    }
}

impl PartialEq<str> for SharedText {
    fn eq(&self, other: &str) -> bool {
        *self.0 == *other
    }
}

impl PartialEq<SharedText> for String {
    fn eq(&self, other: &SharedText) -> bool {
        **self == *other.0
    }
}

impl PartialEq<String> for SharedText {
    fn eq(&self, other: &String) -> bool {
        *self.0 == **other
    }
}

impl fmt::Debug for SharedText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&*self.0, f)
    }
}

impl fmt::Display for SharedText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(&*self.0, f)
    }
}

impl Serialize for SharedText {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.0)
    }
}

impl<'de> Deserialize<'de> for SharedText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;
        impl Visitor<'_> for Text {
            type Value = SharedText;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a string")
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<SharedText, E> {
                Ok(text.into())
            }
        }
        deserializer.deserialize_str(Text)
    }
}

impl SharedTexts {
    /// Returns whether both are the same list in memory, which is faster to tell than whether they are equal.
    pub(crate) fn is_shared(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Returns the texts, each with memory of its own.
    #[must_use]
    pub fn to_strings(&self) -> Vec<String> {
        self.0.iter().map(ToString::to_string).collect()
    }
}

impl Deref for SharedTexts {
    type Target = [SharedText];

    fn deref(&self) -> &[SharedText] {
        &self.0
    }
}

impl<T: Into<SharedText>> FromIterator<T> for SharedTexts {
    fn from_iter<I: IntoIterator<Item = T>>(texts: I) -> Self {
        Self(texts.into_iter().map(Into::into).collect())
    }
}

impl Serialize for SharedTexts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter())
    }
}

impl<'de> Deserialize<'de> for SharedTexts {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Vec::<SharedText>::deserialize(deserializer)?.into_iter().collect())
    }
}

/// Values that came last, of which later ones that are the same can take a share. Their number is fixed:
/// drawn values are all different, and to look for them among all before would take more memory than
/// sharing saves.
#[derive(Debug)]
pub(crate) struct LastValues<T> {
    slots: Vec<Option<T>>,
    hasher: RandomState,
}

impl<T> Default for LastValues<T> {
    fn default() -> Self {
        Self {
            slots: std::iter::repeat_with(|| None).take(SLOTS).collect(),
            hasher: RandomState::new(),
        }
    }
}

/// Number of values that are remembered.
const SLOTS: usize = 1 << 12;

impl<T: Clone> LastValues<T> {
    /// Returns the value, or a share of the same one.
    pub(crate) fn share(&mut self, value: T) -> T
    where
        T: Hash + Eq,
    {
        self.share_by(value, |value, hasher| hasher.hash_one(value), T::eq)
    }

    /// Returns the value, or a share of the same one. The same values have the same hash.
    pub(crate) fn share_by(
        &mut self,
        value: T,
        hash: impl Fn(&T, &RandomState) -> u64,
        is_same: impl Fn(&T, &T) -> bool,
    ) -> T {
        let at = usize::try_from(hash(&value, &self.hasher) % SLOTS as u64).unwrap_or(0);
        let Some(slot) = self.slots.get_mut(at) else { return value };
        match slot {
            Some(last) if is_same(last, &value) => last.clone(),
            slot => slot.insert(value).clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_texts_are_one_in_memory() {
        let mut last = LastValues::default();
        let mut share = |text: &str| last.share(SharedText::from(text));
        let [first, other, again] = ["a", "b", "a"].map(&mut share);
        assert!(Arc::ptr_eq(&first.0, &again.0) && first == again && first != other);
        // More values than are remembered: each is still itself.
        for number in 0..3 * SLOTS {
            assert_eq!(*share(&number.to_string()), *number.to_string());
        }
    }

    #[test]
    fn lists_of_texts_are_lists_in_json() {
        let texts: SharedTexts = serde_json::from_str(r#"["x=1","y=\"ü\""]"#).unwrap();
        assert_eq!(texts.to_strings(), ["x=1", "y=\"ü\""]);
        assert_eq!(serde_json::to_string(&texts).unwrap(), r#"["x=1","y=\"ü\""]"#);
    }
}
