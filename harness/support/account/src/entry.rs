//! One line of an account.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Effect of an entry on the verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weight {
    /// The entry can't have changed the verdict.
    #[default]
    Told,
    /// The entry could have changed the verdict.
    Doubt,
}

impl Weight {
    /// Returns [`Weight::Doubt`] where something holds.
    #[must_use]
    pub const fn doubt_if(doubtful: bool) -> Self {
        if doubtful { Self::Doubt } else { Self::Told }
    }

    fn is_told(&self) -> bool {
        *self == Self::Told
    }
}

/// Units of one kind.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AccountEntry {
    /// Kind of repair, reason, or fact, in plain words: `rows off their fitted time by more than 0.25 ms`.
    pub kind: String,
    /// Number of units.
    pub count: u64,
    /// Place and detail of the first one: `line 24002, 0.3 s`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first: Option<String>,
    /// Remedy: the words to write where the user may choose.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remedy: Option<String>,
    /// Effect on the verdict.
    #[serde(default, skip_serializing_if = "Weight::is_told")]
    pub weight: Weight,
    /// True for a fact about the whole input, which has no number.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_fact: bool,
}

impl AccountEntry {
    /// Creates an entry that can't have changed the verdict.
    #[must_use]
    pub fn new(count: u64, kind: impl Into<String>) -> Self {
        Self {
            kind: kind.into(),
            count,
            first: None,
            remedy: None,
            weight: Weight::Told,
            is_fact: false,
        }
    }

    /// Creates an entry for a fact about the whole input; none where it doesn't hold.
    #[must_use]
    pub fn fact(holds: bool, kind: impl Into<String>) -> Self {
        Self { is_fact: true, ..Self::new(u64::from(holds), kind) }
    }

    /// Adds the place of the first unit.
    #[must_use]
    pub fn first(mut self, place: impl Into<String>) -> Self {
        self.first = Some(place.into());
        self
    }

    /// Adds what the user may write.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    /// Sets the effect on the verdict.
    #[must_use]
    pub fn weight(mut self, weight: Weight) -> Self {
        self.weight = weight;
        self
    }

    /// Takes in a later entry of the same kind.
    pub(crate) fn merge(&mut self, later: Self) {
        self.count = self.count.saturating_add(later.count);
        self.first = self.first.take().or(later.first);
        self.remedy = self.remedy.take().or(later.remedy);
        if later.weight == Weight::Doubt {
            self.weight = Weight::Doubt;
        }
    }
}

/// `1200 rows off their fitted time, the first in line 12; write …`.
impl fmt::Display for AccountEntry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_fact {
            write!(f, "{}", self.kind)?;
        } else {
            write!(f, "{} {}", self.count, self.kind)?;
        }
        if let Some(first) = &self.first {
            write!(f, ", the first {first}")?;
        }
        if let Some(remedy) = &self.remedy {
            write!(f, "; {remedy}")?;
        }
        Ok(())
    }
}
