//! Reader of a completed document: a table with its path and place.

use crate::error::{Place, Problem};
use crate::quantity::{self, Quantity};
use octant_toml_tree::{Node, Table, Value, join, number};

/// A table of the completed document with its path and place. The check guarantees the kinds of its
/// values; an accessor that meets anything else still reports a problem.
#[derive(Clone)]
pub(crate) struct Reader<'a> {
    pub(crate) table: &'a Table,
    pub(crate) path: String,
    pub(crate) place: Place,
}

impl<'a> Reader<'a> {
    /// Makes a reader for the table of a whole file.
    pub(crate) fn root(table: &'a Table) -> Self {
        Self { table, path: String::new(), place: Place::File { line: 1, column: 1 } }
    }

    /// Makes a reader for a table with its dotted path and place.
    pub(crate) fn new(table: &'a Table, path: &str, place: &Place) -> Self {
        Self { table, path: path.to_owned(), place: place.clone() }
    }

    /// Makes a problem of a key, or of the table if the key is omitted.
    pub(crate) fn problem(&self, key: &str, message: impl Into<String>) -> Problem {
        let place = match self.table.get(key) {
            Some(Node { place: Place::Default, .. }) | None => &self.place,
            Some(node) => &node.place,
        };
        Problem { place: place.clone(), path: join(&self.path, key), message: message.into() }
    }

    /// Value of a key.
    pub(crate) fn node(&self, key: &str) -> Option<&'a Node> {
        self.table.get(key)
    }

    /// Dotted path of a key.
    pub(crate) fn join(&self, key: &str) -> String {
        join(&self.path, key)
    }

    /// True if the scenario itself gives the key, without its default.
    pub(crate) fn given(&self, key: &str) -> bool {
        self.table.get(key).is_some_and(|node| node.place != Place::Default)
    }

    /// Key that was written first.
    pub(crate) fn first_key(&self) -> &'a str {
        let given = |entry: &&octant_toml_tree::Entry| entry.node.place != Place::Default;
        self.table.entries.iter().find(given).map_or("", |entry| &entry.key)
    }

    fn missing(&self, key: &str) -> Problem {
        self.problem(key, "missing")
    }

    /// Table under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub(crate) fn table(&self, key: &str) -> Result<Reader<'a>, Problem> {
        self.optional_table(key).ok_or_else(|| self.missing(key))
    }

    /// Table under a key, if it is given.
    pub(crate) fn optional_table(&self, key: &str) -> Option<Reader<'a>> {
        let Some(Node { value: Value::Table(table), place }) = self.node(key) else {
            return None;
        };
        let place = if *place == Place::Default { &self.place } else { place };
        Some(Reader::new(table, &join(&self.path, key), place))
    }

    /// Tables of an array.
    pub(crate) fn tables(&self, key: &str) -> Vec<Reader<'a>> {
        let path = join(&self.path, key);
        self.entries(key)
            .iter()
            .enumerate()
            .filter_map(|(index, node)| match &node.value {
                Value::Table(table) => {
                    Some(Reader::new(table, &format!("{path}[{index}]"), &node.place))
                }
                _ => None,
            })
            .collect()
    }

    /// Text under a key, if it is given.
    pub(crate) fn optional_text(&self, key: &str) -> Option<&'a str> {
        match &self.node(key)?.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Text under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub(crate) fn text(&self, key: &str) -> Result<&'a str, Problem> {
        self.optional_text(key).ok_or_else(|| self.missing(key))
    }

    /// Entries of an array.
    pub(crate) fn entries(&self, key: &str) -> &'a [Node] {
        match self.node(key) {
            Some(Node { value: Value::Array(entries), .. }) => entries,
            _ => &[],
        }
    }

    /// Texts of an array.
    pub(crate) fn texts(&self, key: &str) -> Vec<&'a str> {
        let text = |node: &'a Node| match &node.value {
            Value::Text(text) => Some(text.as_str()),
            _ => None,
        };
        self.entries(key).iter().filter_map(text).collect()
    }

    /// Boolean under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub(crate) fn boolean(&self, key: &str) -> Result<bool, Problem> {
        match self.node(key) {
            Some(Node { value: Value::Boolean(value), .. }) => Ok(*value),
            _ => Err(self.missing(key)),
        }
    }

    /// Whole number under a key.
    ///
    /// # Errors
    /// If it is missing, or too large for its type.
    pub(crate) fn integer<T: TryFrom<i64>>(&self, key: &str) -> Result<T, Problem> {
        match self.node(key) {
            Some(Node { value: Value::Integer(value), .. }) => {
                T::try_from(*value).map_err(|_| self.problem(key, format!("{value} is too large")))
            }
            _ => Err(self.missing(key)),
        }
    }

    /// Plain number under a key.
    ///
    /// # Errors
    /// If it is missing.
    pub(crate) fn number(&self, key: &str) -> Result<f64, Problem> {
        self.node(key).and_then(|node| number(&node.value)).ok_or_else(|| self.missing(key))
    }

    /// Plain numbers of an array of known length.
    ///
    /// # Errors
    /// If there are more or fewer.
    pub(crate) fn numbers<const N: usize>(&self, key: &str) -> Result<[f64; N], Problem> {
        let all: Vec<f64> =
            self.entries(key).iter().filter_map(|node| number(&node.value)).collect();
        all.try_into().map_err(|_| self.missing(key))
    }

    /// Quantity under a key, if it is given.
    pub(crate) fn optional_quantity(&self, key: &str) -> Option<Quantity> {
        quantity::parse(self.optional_text(key)?).ok()
    }

    /// Quantity under a key in SI, if it is given.
    pub(crate) fn optional_si(&self, key: &str) -> Option<f64> {
        self.optional_quantity(key).map(|quantity| quantity.si)
    }

    /// Quantities of an array in SI, if it is given.
    pub(crate) fn optional_si_vec(&self, key: &str) -> Option<Vec<f64>> {
        self.node(key)?;
        let texts = self.texts(key);
        texts.iter().map(|text| quantity::parse(text).ok().map(|quantity| quantity.si)).collect()
    }

    /// Quantities of an array of known length in SI, if it is given.
    pub(crate) fn optional_si_array<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        self.optional_si_vec(key)?.try_into().ok()
    }
}
