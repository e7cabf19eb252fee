//! A table: columns with units, handed over in the Arrow C data interface.

use crate::columns::{Columns, UNIT};
use crate::failure::argument;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::ArrowPrimitiveType;
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, PrimitiveArray, RecordBatch,
    RecordBatchIterator, StringArray,
};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{DataType, Field};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList, PyTuple};

/// A table of columns with units.
///
/// pyarrow, polars, pandas and every other library that takes the Arrow PyCapsule interface read it
/// without a copy; `table["name"]` is a NumPy array on the same memory.
#[pyclass(module = "octant", frozen)]
#[derive(Debug)]
pub(crate) struct Table {
    batch: RecordBatch,
}

impl Table {
    /// Makes a table of columns.
    pub(crate) fn new(columns: Columns) -> PyResult<Self> {
        Ok(Self { batch: columns.batch().map_err(argument)? })
    }

    fn column(&self, name: &str) -> PyResult<(&Field, &ArrayRef)> {
        let schema = self.batch.schema_ref();
        let Ok(index) = schema.index_of(name) else {
            let names = schema.fields().iter().map(|field| field.name().as_str());
            let known = octant_base::names::suggestion(name, names, "columns");
            return Err(PyKeyError::new_err(format!("no column {name:?}, {known}")));
        };
        Ok((schema.field(index), self.batch.column(index)))
    }
}

#[pymethods]
impl Table {
    /// Names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        self.batch.schema_ref().fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Number of rows.
    #[getter]
    fn num_rows(&self) -> usize {
        self.batch.num_rows()
    }

    /// Units by column; "1" for a number without dimension, absent where a column has no numbers.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for field in self.batch.schema_ref().fields() {
            if let Some(unit) = field.metadata().get(UNIT) {
                units.set_item(field.name(), unit)?;
            }
        }
        Ok(units)
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    fn __contains__(&self, name: &str) -> bool {
        self.batch.schema_ref().index_of(name).is_ok()
    }

    fn __repr__(&self) -> String {
        let columns: Vec<String> = (self.batch.schema_ref().fields().iter())
            .map(|field| match field.metadata().get(UNIT) {
                Some(unit) => format!("{} [{unit}]", field.name()),
                None => field.name().clone(),
            })
            .collect();
        format!("Table of {} rows: {}", self.batch.num_rows(), columns.join(", "))
    }

    /// Column as a NumPy array, read only. Numbers share the table's memory; a missing number is NaN,
    /// a missing text None.
    fn __getitem__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (_, array) = slf.get().column(name)?;
        match array.data_type() {
            DataType::Float64 => numbers(slf, name, array),
            DataType::Int64 => integers(slf, name, array),
            DataType::Boolean => {
                let array = array.as_any().downcast_ref::<BooleanArray>();
                let values = array.into_iter().flatten().collect::<Vec<_>>();
                objects(py, &PyList::new(py, values)?)
            }
            _ => {
                let array = array.as_any().downcast_ref::<StringArray>();
                let values = array.into_iter().flatten().collect::<Vec<_>>();
                objects(py, &PyList::new(py, values)?)
            }
        }
    }

    /// The Arrow C stream of the table, in a capsule: what `pyarrow.table(x)`, `polars.from_arrow(x)`
    /// and `pandas.DataFrame.from_arrow(x)` ask for.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface allows to ignore a request: the consumer casts then.
        let _ = requested_schema;
        let batches = std::iter::once(Ok(self.batch.clone()));
        let reader = RecordBatchIterator::new(batches, self.batch.schema());
        let stream = FFI_ArrowArrayStream::new(Box::new(reader));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }

    /// The Arrow C schema of the table, in a capsule.
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.batch.schema_ref().as_ref());
        PyCapsule::new_with_value(py, schema.map_err(argument)?, c"arrow_schema")
    }

    /// The table as `pyarrow.Table`, without a copy.
    fn to_arrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("pyarrow")?.call_method1("table", (slf,))
    }

    /// The table as `polars.DataFrame`, without a copy.
    fn to_polars<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// The table as `pandas.DataFrame`.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let columns = PyDict::new(py);
        for name in slf.get().column_names() {
            columns.set_item(&name, slf.get_item(&name)?)?;
        }
        py.import("pandas")?.call_method1("DataFrame", (columns,))
    }
}

/// Makes an array of Python's objects.
fn objects<'py>(py: Python<'py>, list: &Bound<'py, PyList>) -> PyResult<Bound<'py, PyAny>> {
    let numpy = py.import("numpy")?;
    numpy.call_method1("array", (list, "O"))
}

fn numbers<'py>(
    table: &Bound<'py, Table>,
    name: &str,
    array: &ArrayRef,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(array) = array.as_any().downcast_ref::<Float64Array>() else {
        return Err(argument(format!("column {name} isn't of numbers")));
    };
    if array.null_count() == 0 {
        return shared(table, array, "<f8");
    }
    let values: Vec<f64> = array.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
    let py = table.py();
    py.import("numpy")?.call_method1("array", (PyList::new(py, values)?, "f8"))
}

fn integers<'py>(
    table: &Bound<'py, Table>,
    name: &str,
    array: &ArrayRef,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(array) = array.as_any().downcast_ref::<Int64Array>() else {
        return Err(argument(format!("column {name} isn't of whole numbers")));
    };
    if array.null_count() == 0 {
        return shared(table, array, "<i8");
    }
    let py = table.py();
    objects(py, &PyList::new(py, array.iter().collect::<Vec<_>>())?)
}

/// Values of a column where they are, for `numpy.asarray`. The table lives as long as they do.
#[pyclass(module = "octant", frozen)]
struct Shared {
    table: Py<Table>,
    interface: Py<PyDict>,
}

#[pymethods]
impl Shared {
    #[getter]
    fn __array_interface__(&self, py: Python<'_>) -> Py<PyDict> {
        self.interface.clone_ref(py)
    }

    #[getter]
    fn table(&self, py: Python<'_>) -> Py<Table> {
        self.table.clone_ref(py)
    }
}

fn shared<'py, T: ArrowPrimitiveType>(
    table: &Bound<'py, Table>,
    array: &PrimitiveArray<T>,
    kind: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let py = table.py();
    let values = array.values();
    let numpy = py.import("numpy")?;
    if values.is_empty() {
        return numpy.call_method1("empty", (0, kind));
    }
    let interface = PyDict::new(py);
    interface.set_item("version", 3)?;
    interface.set_item("typestr", kind)?;
    interface.set_item("shape", PyTuple::new(py, [values.len()])?)?;
    interface.set_item("data", (values.as_ptr() as usize, true))?;
    let shared = Shared { table: table.clone().unbind(), interface: interface.unbind() };
    numpy.call_method1("asarray", (Bound::new(py, shared)?,))
}
