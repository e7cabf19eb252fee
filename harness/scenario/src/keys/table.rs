//! Tables whose keys are declared once: name, type, kind, default and meaning of a key give its row in the
//! table of keys and the field into which it is read.
//!
//! A field that nobody takes is a warning of the compiler, and a key that isn't declared has no field.

use super::definition::{Default, KeyBounds, KeyDefinition, KeyKind, Section, key};
use crate::document::DocumentTable;
use crate::error::{Place, Problem};
use crate::quantity::UnitDimension;
use crate::read::reader::TableReader;
use std::ops::Deref;

/// Declares a table of a scenario, its keys in the order of the schema:
/// `name: Type = kind, default, "Meaning.";`, where the default is TOML, `required`, `section`,
/// `absent("its meaning")` or `derived("in words")`.
macro_rules! keys {
    ($(#[$attribute:meta])* $visible:vis struct $name:ident { $(
        $(#[$of_field:meta])*
        $field:ident: $type:ty = $kind:expr, $default:tt $(($words:expr))?, $doc:expr;
    )+ }) => {
        keys! { @ false, $(#[$attribute])* $visible struct $name { $(
            $(#[$of_field])* $field: $type = $kind, $default $(($words))?, $doc;
        )+ } }
    };
    ($(#[$attribute:meta])* $visible:vis one of $name:ident { $(
        $field:ident: $type:ty = $kind:expr, $doc:expr;
    )+ }) => {
        keys! { @ true, $(#[$attribute])* $visible struct $name { $(
            $field: $type = $kind, absent("another is given"), $doc;
        )+ } }
    };
    (@ $one_of:literal, $(#[$attribute:meta])* $visible:vis struct $name:ident { $(
        $(#[$of_field:meta])*
        $field:ident: $type:ty = $kind:expr, $default:tt $(($words:expr))?, $doc:expr;
    )+ }) => {
        $(#[$attribute])*
        #[derive(Clone, Debug)]
        $visible struct $name { $( $(#[$of_field])* $visible $field: $type, )+ }

        impl $crate::keys::table::Keys for $name {
            const SECTION: &'static $crate::keys::Section = &$crate::keys::Section {
                keys: &[$( $crate::keys::table::row::<_, $type>(
                    stringify!($field),
                    $kind,
                    $crate::keys::table::default!($default $(($words))?),
                    $doc,
                ), )+],
                one_of: $one_of,
            };

            fn of(
                table: &$crate::read::reader::TableReader<'_>,
            ) -> Result<Self, $crate::error::Problem> {
                Ok(Self {
                    $( $field: $crate::keys::table::field(table, stringify!($field), &$kind)?, )+
                })
            }
        }

        impl $crate::keys::table::Value for $name {
            fn read(
                table: &$crate::read::reader::TableReader<'_>,
                key: &str,
            ) -> Result<Option<Self>, $crate::error::Problem> {
                use $crate::keys::table::Keys;
                table.optional_table(key).map(|table| Self::of(&table)).transpose()
            }
        }

        impl $crate::keys::table::Value for Vec<$name> {
            fn read(
                table: &$crate::read::reader::TableReader<'_>,
                key: &str,
            ) -> Result<Option<Self>, $crate::error::Problem> {
                use $crate::keys::table::Keys;
                if table.node(key).is_none() {
                    return Ok(None);
                }
                table.tables(key).iter().map($name::of).collect::<Result<_, _>>().map(Some)
            }
        }
    };
}
pub(crate) use keys;

/// Default of a key, from its short form in a table.
macro_rules! default {
    (required) => {
        $crate::keys::Default::Required
    };
    (section) => {
        $crate::keys::Default::Section
    };
    (absent($words:expr)) => {
        $crate::keys::Default::Absent($words)
    };
    (derived($words:expr)) => {
        $crate::keys::Default::Derived($words)
    };
    ($value:expr) => {
        $crate::keys::Default::Value($value)
    };
}
pub(crate) use default;

/// Texts of a choice, each with what it is read as and its meaning.
macro_rules! choice {
    ($($text:literal => $value:expr, $doc:literal;)+) => {
        $crate::keys::table::Of::choice(
            $crate::keys::KeyKind::Choice(&[$(($text, $doc)),+]),
            const { &[$($value),+] },
        )
    };
}
pub(crate) use choice;

/// One text, which is read as nothing, or a value of another kind.
macro_rules! or_text {
    ($text:literal, $doc:literal, $kind:expr) => {
        $crate::keys::table::Of::or_choice(
            const {
                $crate::keys::KeyKind::Either(&[
                    $crate::keys::KeyKind::Choice(&[($text, $doc)]),
                    $kind,
                ])
            },
            const { &[None] },
        )
    };
}
pub(crate) use or_text;

/// Keys of a table, and the table read.
pub(crate) trait Keys: Sized {
    /// Keys, in the order of the schema.
    const SECTION: &'static Section;

    /// Reads a checked and completed table.
    fn of(table: &TableReader<'_>) -> Result<Self, Problem>;
}

/// A value under a key.
pub(crate) trait Value: Sized {
    /// Reads it; `None`: there is none, or one of another kind.
    fn read(table: &TableReader<'_>, key: &str) -> Result<Option<Self>, Problem>;
}

/// A table that is read as a whole, by what else is known of its keys.
#[derive(Clone, Debug)]
pub(crate) struct Raw {
    pub(crate) table: DocumentTable,
    pub(crate) path: String,
    place: Place,
}

impl Raw {
    fn of(table: &TableReader<'_>) -> Self {
        Self { table: table.table.clone(), path: table.path.clone(), place: table.place.clone() }
    }

    pub(crate) fn reader(&self) -> TableReader<'_> {
        TableReader::new(&self.table, &self.path, &self.place)
    }
}

macro_rules! values {
    ($($type:ty $([$count:ident])?: $read:expr;)+) => { $(
        impl$(<const $count: usize>)? Value for $type {
            fn read(table: &TableReader<'_>, key: &str) -> Result<Option<Self>, Problem> {
                if table.node(key).is_none() {
                    return Ok(None);
                }
                let read: fn(&TableReader<'_>, &str) -> Result<Option<Self>, Problem> = $read;
                read(table, key)
            }
        }
    )+ };
}
values! {
    bool: |table, key| table.boolean(key).map(Some);
    String: |table, key| Ok(table.optional_text(key).map(str::to_owned));
    Vec<String>: |table, key| Ok(Some(table.texts(key).into_iter().map(str::to_owned).collect()));
    Vec<f64>: |table, key| Ok(table.optional_si_vec(key));
    u8: |table, key| table.integer(key).map(Some);
    u16: |table, key| table.integer(key).map(Some);
    u32: |table, key| table.integer(key).map(Some);
    u64: |table, key| table.integer(key).map(Some);
    usize: |table, key| table.integer(key).map(Some);
    Raw: |table, key| Ok(table.optional_table(key).as_ref().map(Raw::of));
    Vec<Raw>: |table, key| Ok(Some(table.tables(key).iter().map(Raw::of).collect()));
    f64: |table, key| match table.optional_si(key) {
        None => table.number(key).map(Some),
        si => Ok(si),
    };
    [f64; N] [N]: |table, key| match table.optional_si_array(key) {
        None => table.numbers(key).map(Some),
        si => Ok(si),
    };
}

impl<T: Value> Value for Option<T> {
    fn read(table: &TableReader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        T::read(table, key).map(|value| value.map(Some))
    }
}

/// Kind of a key's values and their type.
pub(crate) struct Of<T: 'static> {
    kind: KeyKind,
    /// Meanings of the texts of a choice.
    choices: &'static [T],
    read: fn(&TableReader<'_>, &str) -> Result<Option<T>, Problem>,
}

impl<T> Of<T> {
    /// Values of a type that has one reading.
    pub(crate) const fn kind(kind: KeyKind) -> Self
    where
        T: Value,
    {
        Self { kind, choices: &[], read: T::read }
    }

    /// Texts and their meanings.
    pub(crate) const fn choice(kind: KeyKind, choices: &'static [T]) -> Self {
        Self { kind, choices, read: |_, _| Ok(None) }
    }

    /// Texts and their meanings, or another value.
    pub(crate) const fn or_choice(kind: KeyKind, choices: &'static [T]) -> Self
    where
        T: Value,
    {
        Self { kind, choices, read: T::read }
    }

    fn of(&self, table: &TableReader<'_>, key: &str) -> Result<Option<T>, Problem>
    where
        T: Clone,
    {
        let texts = match &self.kind {
            KeyKind::Choice(texts) | KeyKind::Either([KeyKind::Choice(texts), ..]) => *texts,
            _ => &[],
        };
        let text = table.optional_text(key);
        let chosen = texts.iter().position(|(known, _)| Some(*known) == text);
        match chosen.and_then(|index| self.choices.get(index)) {
            Some(value) => Ok(Some(value.clone())),
            None => (self.read)(table, key),
        }
    }
}

/// Type of a field, which a value or its absence becomes.
pub(crate) trait Field<T>: Sized {
    /// True if there can be no value.
    const OPTIONAL: bool;

    fn field(found: Option<T>, table: &TableReader<'_>, key: &str) -> Result<Self, Problem>;
}

impl<T> Field<T> for T {
    const OPTIONAL: bool = false;

    fn field(found: Option<T>, table: &TableReader<'_>, key: &str) -> Result<Self, Problem> {
        found.ok_or_else(|| table.problem(key, "missing"))
    }
}

impl<T> Field<T> for Option<T> {
    const OPTIONAL: bool = true;

    fn field(found: Option<T>, _: &TableReader<'_>, _: &str) -> Result<Self, Problem> {
        Ok(found)
    }
}

/// A value with its place and its words, for problems.
#[derive(Clone, Debug)]
pub(crate) struct At<T> {
    pub(crate) value: T,
    /// Text as it was written; of an array: its first to its last.
    pub(crate) text: String,
    /// True if the scenario itself gives it.
    pub(crate) given: bool,
    pub(crate) place: Place,
    pub(crate) path: String,
}

impl<T> At<T> {
    fn new(value: T, table: &TableReader<'_>, key: &str) -> Self {
        let Problem { place, path, .. } = table.problem(key, "");
        let text = table.optional_text(key).map(str::to_owned);
        let text = text.unwrap_or_else(|| table.texts(key).join(" to "));
        Self { value, text, given: table.given(key), place, path }
    }

    /// Makes a problem of it.
    pub(crate) fn problem(&self, message: impl Into<String>) -> Problem {
        Problem { place: self.place.clone(), path: self.path.clone(), message: message.into() }
    }
}

impl<T> Deref for At<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> Field<T> for At<T> {
    const OPTIONAL: bool = false;

    fn field(found: Option<T>, table: &TableReader<'_>, key: &str) -> Result<Self, Problem> {
        Ok(Self::new(T::field(found, table, key)?, table, key))
    }
}

impl<T> Field<T> for At<Option<T>> {
    const OPTIONAL: bool = true;

    fn field(found: Option<T>, table: &TableReader<'_>, key: &str) -> Result<Self, Problem> {
        Ok(Self::new(found, table, key))
    }
}

/// Row of a field in the table of keys.
pub(crate) const fn row<T, F: Field<T>>(
    name: &'static str,
    of: Of<T>,
    default: Default,
    doc: &'static str,
) -> KeyDefinition {
    let fits = match default {
        Default::Required | Default::Value(_) | Default::Section => !F::OPTIONAL,
        Default::Absent(_) => F::OPTIONAL,
        Default::Derived(_) => true,
    };
    assert!(fits, "a key that can be absent has an optional field, and no other has one");
    key(name, of.kind, default, doc)
}

/// Value of a field.
pub(crate) fn field<T: Clone, F: Field<T>>(
    table: &TableReader<'_>,
    key: &str,
    of: &Of<T>,
) -> Result<F, Problem> {
    F::field(of.of(table, key)?, table, key)
}

pub(super) const fn text() -> Of<String> {
    Of::kind(KeyKind::Text)
}

pub(super) const fn boolean() -> Of<bool> {
    Of::kind(KeyKind::Boolean)
}

pub(super) const fn integer<T: Value>(from: i64, to: i64) -> Of<T> {
    Of::kind(KeyKind::Integer(from, to))
}

pub(super) const fn number(bounds: KeyBounds) -> Of<f64> {
    Of::kind(KeyKind::Number(bounds))
}

pub(super) const fn numbers<const N: usize>() -> Of<[f64; N]> {
    Of::kind(KeyKind::Numbers(N))
}

pub(super) const fn si(dimensions: &'static [UnitDimension], bounds: KeyBounds) -> Of<f64> {
    Of::kind(KeyKind::Quantity(dimensions, bounds))
}

pub(super) const fn within(
    dimensions: &'static [UnitDimension],
    from: f64,
    to: f64,
    words: &'static str,
) -> Of<f64> {
    si(dimensions, KeyBounds::Within(from, to, words))
}

pub(super) const fn time(from_s: f64, to_s: f64, words: &'static str) -> Of<f64> {
    within(&[UnitDimension::TIME], from_s, to_s, words)
}

pub(super) const fn si_array<const N: usize>(dimension: UnitDimension) -> Of<[f64; N]> {
    Of::kind(KeyKind::Quantities(dimension, N))
}

/// A list whose length differs between groups of parameters.
pub(super) const fn si_list(dimension: UnitDimension, count: usize) -> Of<Vec<f64>> {
    Of::kind(KeyKind::Quantities(dimension, count))
}

pub(super) const fn table<T: Keys + Value>() -> Of<T> {
    Of::kind(KeyKind::Table(T::SECTION))
}

pub(super) const fn tables<T: Keys>(at_least: usize, at_most: usize) -> Of<Vec<T>>
where
    Vec<T>: Value,
{
    Of::kind(KeyKind::Tables(T::SECTION, at_least, at_most))
}
