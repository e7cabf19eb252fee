//! Ids of cases.

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;
use std::ops::Deref;
use std::str::FromStr;

/// Number of characters of an id.
const LENGTH: usize = 16;

/// Id of a case: 16 characters, which make up all of its memory.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CaseId([u8; LENGTH]);

/// Error of a text that is no id of a case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("found {0:?}, expected the id of a case, {LENGTH} hexadecimal digits")]
pub struct NoCaseId(pub String);

impl FromStr for CaseId {
    type Err = NoCaseId;

    fn from_str(text: &str) -> Result<Self, NoCaseId> {
        let bytes = <[u8; LENGTH]>::try_from(text.as_bytes());
        let digits = bytes.ok().filter(|bytes| bytes.iter().all(u8::is_ascii_hexdigit));
        digits.map(Self).ok_or_else(|| NoCaseId(text.to_owned()))
    }
}

impl CaseId {
    /// Returns the id as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        // Hexadecimal digits are always a text.
        std::str::from_utf8(&self.0).unwrap_or_default()
    }
}

impl Deref for CaseId {
    type Target = str;

    fn deref(&self) -> &str {
        self.as_str()
    }
}

impl PartialEq<str> for CaseId {
    fn eq(&self, other: &str) -> bool {
        self.0 == *other.as_bytes()
    }
}

impl PartialEq<&str> for CaseId {
    fn eq(&self, other: &&str) -> bool {
        *self == **other
    }
}

impl fmt::Debug for CaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}

impl fmt::Display for CaseId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self.as_str(), f)
    }
}

impl Serialize for CaseId {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for CaseId {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Id;
        impl Visitor<'_> for Id {
            type Value = CaseId;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "the id of a case, {LENGTH} hexadecimal digits")
            }

            // Without a text of its own: a plan can have millions.
            fn visit_str<E: Error>(self, text: &str) -> Result<CaseId, E> {
                text.parse().map_err(E::custom)
            }
        }
        deserializer.deserialize_str(Id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_id_is_sixteen_digits() {
        let id: CaseId = serde_json::from_str("\"00ff00ff00ff00ff\"").unwrap();
        assert_eq!((id.as_str(), id.len(), size_of::<CaseId>()), ("00ff00ff00ff00ff", 16, 16));
        assert_eq!(serde_json::to_string(&id).unwrap(), "\"00ff00ff00ff00ff\"");
        for wrong in ["", "00ff", "00ff00ff00ff00ff0", "00ff00ff00ff00fg", "00ff00ff00ff00é"] {
            let error = serde_json::from_str::<CaseId>(&format!("{wrong:?}")).unwrap_err();
            assert!(error.to_string().contains("16 hexadecimal digits"), "{error}");
        }
    }
}
