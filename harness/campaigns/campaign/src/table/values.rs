//! Columns and values of tables.

use std::sync::Arc;

/// Values of a column, by row.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// Texts; equal neighbours share one allocation.
    Text(Vec<Option<Arc<str>>>),
    /// Numbers.
    Number(Vec<Option<f64>>),
    /// Whole numbers.
    Integer(Vec<Option<i64>>),
    /// Booleans.
    Boolean(Vec<Option<bool>>),
}

/// Kind of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColumnKind {
    /// Texts.
    Text,
    /// Numbers.
    Number,
    /// Whole numbers.
    Integer,
    /// Booleans.
    Boolean,
}

/// One value.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValue {
    /// A text.
    Text(Arc<str>),
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// Boolean.
    Boolean(bool),
}

impl ColumnKind {
    /// Returns a value as a column of this kind holds it: of another kind as text in a text column, and
    /// null in any other.
    #[must_use]
    pub fn converted(self, value: Option<ColumnValue>) -> Option<ColumnValue> {
        match (self, value?) {
            (Self::Text, ColumnValue::Text(text)) => Some(ColumnValue::Text(text)),
            (Self::Text, ColumnValue::Number(number)) => {
                Some(ColumnValue::Text(number.to_string().into()))
            }
            (Self::Text, ColumnValue::Integer(number)) => {
                Some(ColumnValue::Text(number.to_string().into()))
            }
            (Self::Text, ColumnValue::Boolean(value)) => {
                Some(ColumnValue::Text(value.to_string().into()))
            }
            (Self::Number, ColumnValue::Integer(number)) => {
                Some(ColumnValue::Number(number as f64))
            }
            (kind, value) => (kind == value.kind()).then_some(value),
        }
    }
}

impl ColumnValue {
    /// Returns the kind of column that holds it.
    #[must_use]
    pub const fn kind(&self) -> ColumnKind {
        match self {
            Self::Text(_) => ColumnKind::Text,
            Self::Number(_) => ColumnKind::Number,
            Self::Integer(_) => ColumnKind::Integer,
            Self::Boolean(_) => ColumnKind::Boolean,
        }
    }
}

impl ColumnValues {
    /// Creates an empty column of a kind.
    #[must_use]
    pub const fn new(kind: ColumnKind) -> Self {
        match kind {
            ColumnKind::Text => Self::Text(Vec::new()),
            ColumnKind::Number => Self::Number(Vec::new()),
            ColumnKind::Integer => Self::Integer(Vec::new()),
            ColumnKind::Boolean => Self::Boolean(Vec::new()),
        }
    }

    /// Returns the kind.
    #[must_use]
    pub const fn kind(&self) -> ColumnKind {
        match self {
            Self::Text(_) => ColumnKind::Text,
            Self::Number(_) => ColumnKind::Number,
            Self::Integer(_) => ColumnKind::Integer,
            Self::Boolean(_) => ColumnKind::Boolean,
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Text(all) => all.len(),
            Self::Number(all) => all.len(),
            Self::Integer(all) => all.len(),
            Self::Boolean(all) => all.len(),
        }
    }

    /// Returns whether there are no rows.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends a value, or null; a value of another kind becomes text in a text column, and null in
    /// any other.
    pub fn push(&mut self, value: Option<ColumnValue>) {
        let value = self.kind().converted(value);
        match (self, value) {
            (Self::Text(all), Some(ColumnValue::Text(text))) => push_text(all, Some(text)),
            (Self::Number(all), Some(ColumnValue::Number(number))) => all.push(Some(number)),
            (Self::Integer(all), Some(ColumnValue::Integer(number))) => all.push(Some(number)),
            (Self::Boolean(all), Some(ColumnValue::Boolean(value))) => all.push(Some(value)),
            (Self::Text(all), _) => all.push(None),
            (Self::Number(all), _) => all.push(None),
            (Self::Integer(all), _) => all.push(None),
            (Self::Boolean(all), _) => all.push(None),
        }
    }

    /// Returns the value of a row.
    #[must_use]
    pub fn at(&self, row: usize) -> Option<ColumnValue> {
        match self {
            Self::Text(all) => all.get(row)?.clone().map(ColumnValue::Text),
            Self::Number(all) => (*all.get(row)?).map(ColumnValue::Number),
            Self::Integer(all) => (*all.get(row)?).map(ColumnValue::Integer),
            Self::Boolean(all) => (*all.get(row)?).map(ColumnValue::Boolean),
        }
    }
}

/// Appends a text, sharing it with the last one if they are equal.
fn push_text(all: &mut Vec<Option<Arc<str>>>, text: Option<Arc<str>>) {
    let text = text.map(|text| match all.last() {
        Some(Some(last)) if *last == text => Arc::clone(last),
        _ => text,
    });
    all.push(text);
}
