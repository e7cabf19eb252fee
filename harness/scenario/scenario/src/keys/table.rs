//! Tables whose keys are declared once: name, type, kind, default and meaning of a key give its row in the
//! table of keys and the field into which it is read.
//!
//! A field that nobody takes is a warning of the compiler, and a key that isn't declared has no field.

use super::definition::{Bounds, Default, Key, Kind, Section, Variants, key};
use crate::complete::complete;
use crate::error::{FileProblems, Place, Problem};
use crate::quantity::{Quantity, UnitDimension};
use crate::read::reader::Reader;
use octant_toml_tree::{Node, Table};
use std::ops::Deref;

/// Declares a table of a scenario, its keys in the order of the schema:
/// `name: Type = kind, default, "Meaning.";`, where the default is TOML, `required`, `section`,
/// `absent("its meaning")`, `derived("in words")` or `by_case(CASES)`.
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
        }

        impl $crate::keys::table::FromTable for $name {
            fn of(
                table: &$crate::read::reader::Reader<'_>,
            ) -> Result<Self, $crate::error::Problem> {
                Ok(Self {
                    $( $field: $crate::keys::table::field(table, stringify!($field), &$kind)?, )+
                })
            }
        }
    };
}
pub(crate) use keys;

/// Declares the forms of a table, each with the key that distinguishes it and the table of its keys:
/// `"key" => Form(TableOfKeys);`. The text in front names the table in messages.
macro_rules! forms {
    ($(#[$attribute:meta])* $visible:vis enum $name:ident($words:literal) { $(
        $key:literal => $form:ident($keys:ty);
    )+ }) => {
        $(#[$attribute])*
        #[derive(Clone, Debug)]
        $visible enum $name { $( $form($keys), )+ }

        impl $crate::keys::table::Forms for $name {
            const VARIANTS: &'static $crate::keys::Variants = &$crate::keys::Variants {
                tag: $crate::keys::Tag::Key($words),
                forms: || &[$( ($key, <$keys as $crate::keys::table::Keys>::SECTION), )+],
            };
        }

        impl $crate::keys::table::FromTable for $name {
            fn of(
                table: &$crate::read::reader::Reader<'_>,
            ) -> Result<Self, $crate::error::Problem> {
                $( if table.node($key).is_some() {
                    return $crate::keys::table::FromTable::of(table).map(Self::$form);
                } )+
                Err(table.problem("", concat!("missing ", $words)))
            }
        }
    };
}
pub(crate) use forms;

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
    (by_case($cases:expr)) => {
        $crate::keys::Default::ByCase($cases)
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
            $crate::keys::Kind::Choice(&[$(($text, $doc)),+]),
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
                $crate::keys::Kind::Either(&[
                    $crate::keys::Kind::Choice(&[($text, $doc)]),
                    $kind,
                ])
            },
            const { &[None] },
        )
    };
}
pub(crate) use or_text;

/// A table that is read as a whole.
pub(crate) trait FromTable: Sized {
    /// Reads a checked and completed table.
    fn of(table: &Reader<'_>) -> Result<Self, Problem>;
}

/// A table with one set of keys.
pub(crate) trait Keys: FromTable {
    /// Keys, in the order of the schema.
    const SECTION: &'static Section;

    /// Parses the text of a file that is such a table; `file` names it in errors. `prepare` changes the
    /// document before it is checked, `make` reads what the keys mean together.
    fn parse<T>(
        text: &str,
        file: &str,
        prepare: impl FnOnce(&mut Table, &mut Vec<Problem>),
        make: impl FnOnce(Self) -> Result<T, Problem>,
    ) -> Result<T, FileProblems> {
        let with_file = |problems| FileProblems { file: file.to_owned(), problems };
        let mut document = octant_toml_tree::parse(text).map_err(with_file)?;
        let mut problems = Vec::new();
        prepare(&mut document, &mut problems);
        let start = Place::File { line: 1, column: 1 };
        complete(&mut document, Self::SECTION, "", &start, &mut problems);
        if !problems.is_empty() {
            return Err(with_file(problems));
        }
        let keys = Self::of(&Reader::root(&document));
        keys.and_then(make).map_err(|problem| with_file(vec![problem]))
    }
}

/// A table with one of several sets of keys.
pub(crate) trait Forms: FromTable {
    /// Forms, in the order of the schema.
    const VARIANTS: &'static Variants;
}

/// A value under a key.
pub(crate) trait Value: Sized {
    /// Reads it; `None`: there is none, or one of another kind.
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem>;
}

/// A table that is read as a whole, by what else is known of its keys.
#[derive(Clone, Debug)]
pub(crate) struct Raw {
    pub(crate) table: Table,
    pub(crate) path: String,
    place: Place,
}

impl FromTable for Raw {
    fn of(table: &Reader<'_>) -> Result<Self, Problem> {
        let Reader { table, path, place } = table.clone();
        Ok(Self { table: table.clone(), path, place })
    }
}

impl Raw {
    pub(crate) fn reader(&self) -> Reader<'_> {
        Reader::new(&self.table, &self.path, &self.place)
    }
}

macro_rules! values {
    ($($type:ty $([$count:ident])?: $read:expr;)+) => { $(
        impl$(<const $count: usize>)? Value for $type {
            fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
                if table.node(key).is_none() {
                    return Ok(None);
                }
                let read: fn(&Reader<'_>, &str) -> Result<Option<Self>, Problem> = $read;
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
    Vec<Vec<String>>: |table, key| Ok(Some(table.entries(key).iter().map(Node::texts).collect()));
    Vec<Node>: |table, key| Ok(Some(table.entries(key).to_vec()));
    Quantity: |table, key| Ok(table.optional_quantity(key));
    f64: |table, key| match table.optional_si(key) {
        None => table.number(key).map(Some),
        si => Ok(si),
    };
    [f64; N] [N]: |table, key| match table.optional_si_array(key) {
        None => table.numbers(key).map(Some),
        si => Ok(si),
    };
}

impl<T: FromTable> Value for T {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        table.optional_table(key).map(|table| Self::of(&table)).transpose()
    }
}

impl<T: FromTable> Value for Vec<T> {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        if table.node(key).is_none() {
            return Ok(None);
        }
        table.tables(key).iter().map(T::of).collect::<Result<_, _>>().map(Some)
    }
}

impl<T: Value> Value for Option<T> {
    fn read(table: &Reader<'_>, key: &str) -> Result<Option<Self>, Problem> {
        T::read(table, key).map(|value| value.map(Some))
    }
}

/// Kind of a key's values and their type.
pub(crate) struct Of<T: 'static> {
    kind: Kind,
    /// Meanings of the texts of a choice.
    choices: &'static [T],
    read: fn(&Reader<'_>, &str) -> Result<Option<T>, Problem>,
}

impl<T> Of<T> {
    /// Values of a type that has one reading.
    pub(crate) const fn kind(kind: Kind) -> Self
    where
        T: Value,
    {
        Self { kind, choices: &[], read: T::read }
    }

    /// Texts and their meanings.
    pub(crate) const fn choice(kind: Kind, choices: &'static [T]) -> Self {
        Self { kind, choices, read: |_, _| Ok(None) }
    }

    /// Texts and their meanings, or another value.
    pub(crate) const fn or_choice(kind: Kind, choices: &'static [T]) -> Self
    where
        T: Value,
    {
        Self { kind, choices, read: T::read }
    }

    fn of(&self, table: &Reader<'_>, key: &str) -> Result<Option<T>, Problem>
    where
        T: Clone,
    {
        let texts = match &self.kind {
            Kind::Choice(texts) | Kind::Either([Kind::Choice(texts), ..]) => *texts,
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

    fn field(found: Option<T>, table: &Reader<'_>, key: &str) -> Result<Self, Problem>;
}

impl<T> Field<T> for T {
    const OPTIONAL: bool = false;

    fn field(found: Option<T>, table: &Reader<'_>, key: &str) -> Result<Self, Problem> {
        found.ok_or_else(|| table.problem(key, "missing"))
    }
}

impl<T> Field<T> for Option<T> {
    const OPTIONAL: bool = true;

    fn field(found: Option<T>, _: &Reader<'_>, _: &str) -> Result<Self, Problem> {
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
    fn new(value: T, table: &Reader<'_>, key: &str) -> Self {
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

impl At<String> {
    /// SI value of a unit, which is a key of its own.
    pub(crate) fn unit_si(&self) -> Result<f64, Problem> {
        crate::quantity::parse(&format!("1 {}", self.value))
            .map(|quantity| quantity.si)
            .map_err(|_| self.problem(format!("found the unknown unit {:?}", self.value)))
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

    fn field(found: Option<T>, table: &Reader<'_>, key: &str) -> Result<Self, Problem> {
        Ok(Self::new(T::field(found, table, key)?, table, key))
    }
}

impl<T> Field<T> for At<Option<T>> {
    const OPTIONAL: bool = true;

    fn field(found: Option<T>, table: &Reader<'_>, key: &str) -> Result<Self, Problem> {
        Ok(Self::new(found, table, key))
    }
}

/// Row of a field in the table of keys.
pub(crate) const fn row<T, F: Field<T>>(
    name: &'static str,
    of: Of<T>,
    default: Default,
    doc: &'static str,
) -> Key {
    let fits = match default {
        Default::Required | Default::Value(_) | Default::Section => !F::OPTIONAL,
        Default::Absent(_) => F::OPTIONAL,
        Default::Derived(_) | Default::ByCase(_) => true,
    };
    assert!(fits, "a key that can be absent has an optional field, and no other has one");
    key(name, of.kind, default, doc)
}

/// Value of a field.
pub(crate) fn field<T: Clone, F: Field<T>>(
    table: &Reader<'_>,
    key: &str,
    of: &Of<T>,
) -> Result<F, Problem> {
    F::field(of.of(table, key)?, table, key)
}

pub(super) const fn text() -> Of<String> {
    Of::kind(Kind::Text)
}

pub(super) const fn boolean() -> Of<bool> {
    Of::kind(Kind::Boolean)
}

pub(super) const fn integer<T: Value>(from: i64, to: i64) -> Of<T> {
    Of::kind(Kind::Integer(from, to))
}

pub(super) const fn number(bounds: Bounds) -> Of<f64> {
    Of::kind(Kind::Number(bounds))
}

pub(super) const fn numbers<const N: usize>() -> Of<[f64; N]> {
    Of::kind(Kind::Numbers(N))
}

pub(super) const fn si(dimensions: &'static [UnitDimension], bounds: Bounds) -> Of<f64> {
    Of::kind(Kind::Quantity(dimensions, bounds))
}

pub(super) const fn within(
    dimensions: &'static [UnitDimension],
    from: f64,
    to: f64,
    words: &'static str,
) -> Of<f64> {
    si(dimensions, Bounds::Within(from, to, words))
}

pub(super) const fn time(from_s: f64, to_s: f64, words: &'static str) -> Of<f64> {
    within(&[UnitDimension::TIME], from_s, to_s, words)
}

pub(super) const fn si_array<const N: usize>(dimension: UnitDimension) -> Of<[f64; N]> {
    Of::kind(Kind::Quantities(dimension, N))
}

/// A list whose length differs between groups of parameters.
pub(super) const fn si_list(dimension: UnitDimension, count: usize) -> Of<Vec<f64>> {
    Of::kind(Kind::Quantities(dimension, count))
}

pub(super) const fn table<T: Keys>() -> Of<T> {
    Of::kind(Kind::Table(T::SECTION))
}

pub(super) const fn tables<T: Keys>(at_least: usize, at_most: usize) -> Of<Vec<T>> {
    Of::kind(Kind::Tables(T::SECTION, at_least, at_most))
}

pub(super) const fn form<T: Forms>() -> Of<T> {
    Of::kind(Kind::Variants(T::VARIANTS))
}

pub(super) const fn form_tables<T: Forms>(at_most: usize) -> Of<Vec<T>> {
    Of::kind(Kind::VariantTables(T::VARIANTS, at_most))
}
