//! Definition of keys: their kinds, defaults and bounds.

use crate::channel::Channel;
use crate::error::{Place, Problem};
use crate::quantity::UnitDimension;
use octant_base::names::{nearest, suggestion};
use octant_toml_tree::{Table, Value, join};

/// Version of the format that this program reads.
pub const SCHEMA: i64 = 1;

/// Definition of a key.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    /// Name.
    pub name: &'static str,
    /// Kind of its values.
    pub kind: Kind,
    /// Default.
    pub default: Default,
    /// Meaning, in one sentence, shown in the schema.
    pub doc: &'static str,
}

/// Default of a key.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Default {
    /// No default: the key is required.
    Required,
    /// A value, as TOML; texts without quotes.
    Value(&'static str),
    /// A value that depends on other keys, described in words.
    Derived(&'static str),
    /// A value that depends on other keys: each case with its value.
    ByCase(&'static [(&'static str, CaseValue)]),
    /// No value; its meaning is described in words.
    Absent(&'static str),
    /// A table with the defaults of its own keys.
    Section,
}

/// Value of a default in one of its cases.
#[derive(Clone, Copy, Debug)]
pub(crate) enum CaseValue {
    /// A value, as TOML; texts without quotes.
    Value(&'static str),
    /// A plain number.
    Number(f64),
    /// Where the value is from, in words.
    Words(&'static str),
}

/// Cases of a default in words: `CASE: VALUE; CASE: VALUE`.
pub(crate) fn cases_in_words(cases: &[(&str, CaseValue)]) -> String {
    let words = cases.iter().map(|(case, value)| match value {
        CaseValue::Value(value) => format!("{case}: \"{value}\""),
        CaseValue::Number(value) => format!("{case}: {value}"),
        CaseValue::Words(words) => format!("{case}: {words}"),
    });
    words.collect::<Vec<_>>().join("; ")
}

/// Kind of a key's values.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// Any text.
    Text,
    /// A text of the form `scheme` or `scheme:FILE`, with one of these schemes.
    Uri(&'static [(&'static str, &'static str)]),
    /// One of these texts, with their meanings.
    Choice(&'static [(&'static str, &'static str)]),
    /// A list of some of these texts.
    Choices(&'static [&'static str]),
    /// True or false.
    Boolean,
    /// A whole number within these limits.
    Integer(i64, i64),
    /// A plain number.
    Number(Bounds),
    /// This many plain numbers.
    Numbers(usize),
    /// A quantity of this dimension, or of one of several (depending on another key).
    Quantity(&'static [UnitDimension], Bounds),
    /// This many quantities.
    Quantities(UnitDimension, usize),
    /// A quantity for each of x, y, z, all of one of these dimensions.
    Vector(&'static [UnitDimension]),
    /// A quantity of any dimension, or a plain number.
    Limit,
    /// An array of times of the run.
    Times,
    /// A signal, a side and a value: `"nis above 25"`.
    Condition,
    /// Channels of the sensors: one name, or an array of names.
    Channels,
    /// A column of a text file: its number from 1, or its name in the header.
    Column,
    /// Variables of an FMU, or constants, that a channel consists of.
    Port(&'static Channel),
    /// A table of names of an FMU's variables with their values. Nested tables are parts of names.
    Settings,
    /// A list of values, at least one, each of any kind.
    Values,
    /// A list of names, which may be empty.
    Names,
    /// A list of lists of names, at least one list.
    Lists,
    /// Values of an FMU's variable: whole numbers or names of an enumeration, one or an array.
    Codes,
    /// A table with these keys.
    Table(&'static Section),
    /// An array of tables, with a least and a largest number.
    Tables(&'static Section, usize, usize),
    /// A table whose keys depend on its content.
    Variants(&'static Variants),
    /// An array of such tables, with a largest number.
    VariantTables(&'static Variants, usize),
    /// One of these kinds, distinguished by the type of the TOML value.
    Either(&'static [Kind]),
    /// A known key that isn't possible in this version, with the reason.
    Refused(&'static str),
}

impl Kind {
    /// Keys of a table, if a table can be given.
    pub(crate) fn section(&self) -> Option<&'static Section> {
        match self {
            Self::Table(section) => Some(section),
            Self::Either(kinds) => kinds.iter().find_map(Self::section),
            _ => None,
        }
    }
}

/// Bounds of a number, or of a quantity in SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Bounds {
    /// Every finite number.
    Any,
    /// Every finite number except zero.
    NotZero,
    /// Above zero.
    Positive,
    /// Zero or more.
    NotNegative,
    /// Lower and upper bound, and their description for the user.
    Within(f64, f64, &'static str),
}

impl Bounds {
    /// True if a value lies within the bounds; never for NaN.
    pub(crate) fn contain(self, value: f64) -> bool {
        value.is_finite()
            && match self {
                Self::Any => true,
                Self::NotZero => value != 0.0,
                Self::Positive => value > 0.0,
                Self::NotNegative => value >= 0.0,
                Self::Within(from, to, _) => (from..=to).contains(&value),
            }
    }

    /// Description that fits after "expected a value".
    pub(crate) fn words(self) -> &'static str {
        match self {
            Self::Any => "that is finite",
            Self::NotZero => "other than 0: with 0 nothing would happen",
            Self::Positive => "above 0",
            Self::NotNegative => "of 0 or more",
            Self::Within(_, _, words) => words,
        }
    }
}

/// Keys of a table.
#[derive(Debug)]
pub(crate) struct Section {
    /// Keys.
    pub keys: &'static [Key],
    /// True if exactly one of the keys must be given.
    pub one_of: bool,
}

impl Section {
    /// Key of a name.
    pub(crate) fn key(&self, name: &str) -> Option<&Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// Key at a dotted path, through tables that have one set of keys.
    pub(crate) fn at(&self, path: &str) -> Option<&Key> {
        match path.split_once('.') {
            None => self.key(path),
            Some((first, rest)) => self.key(first)?.kind.section()?.at(rest),
        }
    }

    /// Names of all keys that can be given.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        let possible = |key: &&Key| !matches!(key.kind, Kind::Refused(_));
        self.keys.iter().filter(possible).map(|key| key.name)
    }
}

/// Distinction between the forms of a table.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Tag {
    /// Text under this key.
    Value(&'static str),
    /// The key itself: exactly one of the names is a key of the table. This text names the table in
    /// messages.
    Key(&'static str),
}

/// Forms of a table.
#[derive(Debug)]
pub(crate) struct Variants {
    /// Distinction between them.
    pub tag: Tag,
    /// Name and keys of each form.
    pub forms: fn() -> &'static [(&'static str, &'static Section)],
}

impl Variants {
    /// Names of all forms.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        (self.forms)().iter().map(|(name, _)| *name)
    }

    fn form(&self, name: &str) -> Option<&'static Section> {
        (self.forms)().iter().find(|(known, _)| *known == name).map(|(_, section)| *section)
    }

    /// Keys of a table, by its content.
    pub(crate) fn section(&self, table: &Table) -> Option<&'static Section> {
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

    /// Problem of a table without a form.
    pub(crate) fn problem(&self, table: &Table, path: &str, place: &Place) -> Problem {
        let problem = |place: &Place, path: String, message: String| Problem {
            place: place.clone(),
            path,
            message,
        };
        match self.tag {
            Tag::Value(key) => {
                let path = join(path, key);
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
                        join(path, &entry.key),
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

pub(super) const fn section(keys: &'static [Key]) -> Section {
    Section { keys, one_of: false }
}

pub(super) const fn key(
    name: &'static str,
    kind: Kind,
    default: Default,
    doc: &'static str,
) -> Key {
    Key { name, kind, default, doc }
}
