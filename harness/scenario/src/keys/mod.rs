//! The one table of keys: what can be written in a scenario, with dimension, default and meaning.
//!
//! Checking, defaults, error messages, the JSON Schema and the test of the tour all read it.

mod calibration;
mod campaign;
mod connection;
mod drive;
mod faults;
mod fmu;
mod instrument;
mod link;
mod run;
mod source;
mod suite;

use super::quantity::Dimension;
use crate::channel::Channel;

pub use campaign::CAMPAIGN;
pub use connection::{CONNECTIONS, connection_section};
pub(crate) use faults::{dimension, kind_section};
pub(crate) use fmu::{ENDPOINT_FMU, ENDPOINT_MAP, SOURCE_FMU, SOURCE_MAP};
pub(crate) use link::ENDPOINT_LINK;
pub(crate) use run::{POSITIONS, SCENARIO};
pub(crate) use source::SOURCE_LIVE;
pub(crate) use suite::SUITE;

use super::document::{Table, Value};
use super::error::Problem;
use octant_base::names::{nearest, suggestion};

/// The version of the format that this program reads.
pub const SCHEMA: i64 = 1;

/// One key.
#[derive(Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// What holds where it is left out.
    pub default: Default,
    /// What it means: one sentence, shown in the schema.
    pub doc: &'static str,
}

/// What stands in for a key that is left out.
#[derive(Clone, Copy, Debug)]
pub enum Default {
    /// It can't be left out.
    Required,
    /// A value, as TOML; texts without quotes.
    Value(&'static str),
    /// A value that depends on others, in words.
    Derived(&'static str),
    /// Nothing, in words.
    Absent(&'static str),
    /// A table with the defaults of its own keys.
    Section,
}

/// What a key takes.
#[derive(Debug)]
pub enum Kind {
    /// Any text.
    Text,
    /// A text with form `scheme` or `scheme:FILE`, of these schemes.
    Uri(&'static [(&'static str, &'static str)]),
    /// One of these, with their meaning.
    Choice(&'static [(&'static str, &'static str)]),
    /// A list of some of these.
    Choices(&'static [&'static str]),
    /// True or false.
    Boolean,
    /// A whole number within limits.
    Integer(i64, i64),
    /// A plain number.
    Number(Bounds),
    /// So many plain numbers.
    Numbers(usize),
    /// A quantity of one dimension, or of one of several (which depends on another key).
    Quantity(&'static [Dimension], Bounds),
    /// So many quantities.
    Quantities(Dimension, usize),
    /// A quantity for each of x, y, z, all of the same one of these dimensions.
    Vector(&'static [Dimension]),
    /// A quantity of any dimension, or a plain number.
    Limit,
    /// An array of times of the run.
    Times,
    /// A signal, above or below, and a value: `"nis above 25"`.
    Condition,
    /// Channels of the sensors: a name, or an array of names.
    Channels,
    /// A column of a text file: its number from 1, or its name in the header.
    Column,
    /// The variables of an FMU, or constants, that a channel is made of.
    Port(&'static Channel),
    /// A table of names of an FMU's variables with their values. Tables in it are parts of names.
    Settings,
    /// A list of values, at least one, each as any key may take it.
    Values,
    /// A list of names, which may be empty.
    Names,
    /// A list of lists of names, at least one list.
    Lists,
    /// Values of an FMU's variable: whole numbers or names of an enumeration, one or an array.
    Codes,
    /// A table of these keys.
    Table(&'static Section),
    /// An array of tables: at least so many, at most so many.
    Tables(&'static Section, usize, usize),
    /// A table whose keys depend on what is in it.
    Variants(&'static Variants),
    /// An array of such tables, at most so many.
    VariantTables(&'static Variants, usize),
    /// One of these, told apart by the kind of TOML value.
    Either(&'static [Kind]),
    /// A key that is known and not possible in this version, with the reason.
    Refused(&'static str),
}

impl Kind {
    /// The keys of a table, where a table can be given.
    pub fn section(&self) -> Option<&'static Section> {
        match self {
            Self::Table(section) => Some(section),
            Self::Either(kinds) => kinds.iter().find_map(Self::section),
            _ => None,
        }
    }
}

/// Limits of a number, or of a quantity in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// Every finite number.
    Any,
    /// Every finite number but zero.
    NotZero,
    /// Above zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// From, to, and how the user reads it.
    Within(f64, f64, &'static str),
}

impl Bounds {
    /// Whether a value lies within them; NaN never does.
    pub fn contain(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::NotZero => value != 0.0,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Within(from, to, _) => (from..=to).contains(&value),
            }
    }

    /// Reads after "expected a value".
    pub fn words(self) -> &'static str {
        match self {
            Self::Any => "that is finite",
            Self::NotZero => "other than 0: with 0 nothing would happen",
            Self::Positive => "above 0",
            Self::NotNegative => "of 0 or more",
            Self::Within(_, _, words) => words,
        }
    }
}

/// The keys of a table.
#[derive(Debug)]
pub struct Section {
    /// The keys.
    pub keys: &'static [Key],
    /// Exactly one of the keys is given.
    pub one_of: bool,
}

impl Section {
    /// The key of a name.
    pub fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// The names that can be given.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        let possible = |key: &&Key| !matches!(key.kind, Kind::Refused(_));
        self.keys.iter().filter(possible).map(|key| key.name)
    }
}

/// What tells the forms of a table apart.
#[derive(Clone, Copy, Debug)]
pub enum Tag {
    /// The text under this key.
    Value(&'static str),
    /// The key itself: exactly one of the names is a key of the table. The table is called so in
    /// messages.
    Key(&'static str),
}

/// The forms of a table.
#[derive(Debug)]
pub struct Variants {
    /// What tells them apart.
    pub tag: Tag,
    /// Name and keys of each form.
    pub forms: fn() -> &'static [(&'static str, &'static Section)],
}

impl Variants {
    /// The names that can be given.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        (self.forms)().iter().map(|(name, _)| *name)
    }

    fn form(&self, name: &str) -> Option<&'static Section> {
        (self.forms)().iter().find(|(known, _)| *known == name).map(|(_, section)| *section)
    }

    /// The keys of a table, by what is in it.
    pub fn section(&self, table: &Table) -> Option<&'static Section> {
        match self.tag {
            Tag::Value(key) => match &table.get(key)?.value {
                Value::Text(name) => self.form(name),
                _ => None,
            },
            Tag::Key(_) => {
                let mut given = table.entries.iter().filter_map(|entry| self.form(&entry.key));
                given.next().filter(|_| given.next().is_none())
            }
        }
    }

    /// Why a table has no form.
    pub fn problem(&self, table: &Table, path: &str, place: &super::Place) -> Problem {
        let problem = |place: &super::Place, path: String, message: String| Problem {
            place: place.clone(),
            path,
            message,
        };
        match self.tag {
            Tag::Value(key) => {
                let path = super::complete::join(path, key);
                let Some(node) = table.get(key) else {
                    let names = self.names().collect::<Vec<_>>().join(", ");
                    return problem(place, path, format!("missing, expected one of {names}"));
                };
                let found = node.value.describe();
                let text = if let Value::Text(text) = &node.value { text } else { "" };
                let known = suggestion(text, self.names(), "possible");
                problem(&node.place, path, format!("found {found}, {known}"))
            }
            Tag::Key(what) => {
                let names = self.names().collect::<Vec<_>>().join(", ");
                let given: Vec<&str> = (table.entries.iter())
                    .filter(|entry| self.form(&entry.key).is_some())
                    .map(|entry| entry.key.as_str())
                    .collect();
                if given.len() > 1 {
                    let message =
                        format!("found {}, expected exactly one of {names}", given.join(" and "));
                    return problem(place, path.to_owned(), message);
                }
                let typo = table.entries.iter().find_map(|entry| {
                    let name = nearest(&entry.key, self.names())?;
                    Some((entry, name))
                });
                match typo {
                    Some((entry, name)) => problem(
                        &entry.place,
                        super::complete::join(path, &entry.key),
                        format!("unknown key, did you mean \"{name}\"? {what}: one of {names}"),
                    ),
                    None => problem(
                        place,
                        path.to_owned(),
                        format!("found no {what}, expected exactly one of {names}"),
                    ),
                }
            }
        }
    }
}

const fn section(keys: &'static [Key]) -> Section {
    Section { keys, one_of: false }
}

const fn one_of(keys: &'static [Key]) -> Section {
    Section { keys, one_of: true }
}

const fn key(name: &'static str, kind: Kind, default: Default, doc: &'static str) -> Key {
    Key { name, kind, default, doc }
}
