//! Columns of a table with their units.

use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, StringArray,
};
use arrow_schema::{ArrowError, Field, Schema};
use std::sync::Arc;

/// Key of a field's metadata that has the unit.
pub(crate) const UNIT: &str = "unit";

/// Columns of one table, in order.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    fields: Vec<Field>,
    arrays: Vec<ArrayRef>,
}

impl Columns {
    /// Adds a column. The unit is "1" for a number without dimension, and empty for what is no number.
    fn add(&mut self, name: &str, unit: &str, array: ArrayRef) {
        let field = Field::new(name, array.data_type().clone(), array.null_count() > 0);
        let metadata = [(UNIT.to_owned(), unit.to_owned())];
        let has_unit = !unit.is_empty();
        self.fields.push(if has_unit { field.with_metadata(metadata) } else { field });
        self.arrays.push(array);
    }

    /// Adds numbers.
    pub(crate) fn numbers(&mut self, name: &str, unit: &str, values: Vec<f64>) {
        self.add(name, unit, Arc::new(Float64Array::from(values)));
    }

    /// Adds numbers some of which are missing.
    pub(crate) fn some_numbers(&mut self, name: &str, unit: &str, values: Vec<Option<f64>>) {
        self.add(name, unit, Arc::new(Float64Array::from(values)));
    }

    /// Adds whole numbers.
    pub(crate) fn integers(&mut self, name: &str, unit: &str, values: Vec<i64>) {
        self.add(name, unit, Arc::new(Int64Array::from(values)));
    }

    /// Adds whole numbers some of which are missing.
    pub(crate) fn some_integers(&mut self, name: &str, unit: &str, values: Vec<Option<i64>>) {
        self.add(name, unit, Arc::new(Int64Array::from(values)));
    }

    /// Adds booleans.
    pub(crate) fn booleans(&mut self, name: &str, values: Vec<Option<bool>>) {
        self.add(name, "", Arc::new(BooleanArray::from(values)));
    }

    /// Adds texts.
    pub(crate) fn texts<T: AsRef<str>>(
        &mut self,
        name: &str,
        values: impl Iterator<Item = Option<T>>,
    ) {
        self.add(name, "", Arc::new(values.collect::<StringArray>()));
    }

    /// Makes the table's batch.
    pub(crate) fn batch(self) -> Result<RecordBatch, ArrowError> {
        RecordBatch::try_new(Arc::new(Schema::new(self.fields)), self.arrays)
    }
}
