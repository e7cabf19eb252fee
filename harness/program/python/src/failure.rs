//! Errors of the harness as Python exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyValueError};
use pyo3::prelude::*;

create_exception!(octant, OctantError, PyException, "The harness could not do its work.");
create_exception!(
    octant,
    InputError,
    OctantError,
    "Input was refused: a file, a key, a value. The message names it, and what was expected."
);
create_exception!(
    octant,
    BenchError,
    OctantError,
    "The bench failed: a device is gone, a disk is full, a callable raised an exception."
);

/// Adds the exceptions to the module.
pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("OctantError", py.get_type::<OctantError>())?;
    module.add("InputError", py.get_type::<InputError>())?;
    module.add("BenchError", py.get_type::<BenchError>())
}

/// Makes an [`InputError`].
pub(crate) fn input(error: impl std::fmt::Display) -> PyErr {
    InputError::new_err(error.to_string())
}

/// Makes a `ValueError`, for an argument of a call.
pub(crate) fn argument(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// Makes the exception of a failed command: [`InputError`] for bad input, else [`BenchError`].
pub(crate) fn failed(failure: octant::embedded::Failure) -> PyErr {
    match failure.status() {
        2 => InputError::new_err(failure.to_string()),
        _ => BenchError::new_err(failure.to_string()),
    }
}
