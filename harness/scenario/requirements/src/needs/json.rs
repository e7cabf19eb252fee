//! The outer objects of the file, in their order.

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::Value;
use std::fmt;
use std::marker::PhantomData;

/// An object whose keys keep their order. A key can be there twice.
#[derive(Debug)]
pub(super) struct Ordered<T>(pub(super) Vec<(String, T)>);

impl<T> Default for Ordered<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Ordered<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for Entries<T> {
            type Value = Ordered<T>;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries: Vec<(String, T)> = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Ordered(entries))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}

/// The file.
#[derive(Debug, Deserialize)]
#[serde(expecting = "an object")]
pub(super) struct NeedsFile {
    pub(super) format_version: Option<Value>,
    pub(super) current_version: Option<String>,
    pub(super) project: Option<String>,
    pub(super) versions: Option<Ordered<NeedsVersion>>,
}

/// A version of the needs.
#[derive(Debug, Deserialize)]
#[serde(expecting = "an object")]
pub(super) struct NeedsVersion {
    pub(super) needs: Option<Ordered<Value>>,
    #[serde(default)]
    pub(super) needs_schema: Value,
    #[serde(default)]
    pub(super) needs_defaults_removed: bool,
    #[serde(default)]
    pub(super) creator: Value,
    #[serde(default)]
    pub(super) octant_escaped: bool,
}
