//! The extension module of the Python package `octant`.
//!
//! Start at `python/octant/__init__.py`, the package that users see. This crate gives it what Python
//! would be slow at: [`recording`] reads the topics of a recording as tables, [`parquet`] the tables of
//! campaigns; [`table`] hands tables over in the Arrow C data interface, without a copy. [`request`] runs
//! scenarios; [`bench`] steps one, with [`parts`] that are Python callables, sample by sample
//! ([`epoch`]) or in blocks ([`records`]). Errors of the harness become exceptions in [`failure`].
//! [`program`] is the program `octant` of the wheel, so that its code is there once.

mod bench;
mod columns;
mod epoch;
mod failure;
mod parquet;
mod parts;
mod program;
mod recording;
mod records;
mod request;
mod table;

use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Functions and classes of the package that are written in Rust.
#[pymodule]
fn _octant(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<table::Table>()?;
    module.add_class::<recording::RawRecording>()?;
    module.add_function(wrap_pyfunction!(recording::read_calibration, module)?)?;
    module.add_function(wrap_pyfunction!(parquet::read_parquet, module)?)?;
    for function in [
        wrap_pyfunction!(request::run, module)?,
        wrap_pyfunction!(request::check_scenario, module)?,
        wrap_pyfunction!(request::toml_to_json, module)?,
        wrap_pyfunction!(request::json_to_toml, module)?,
        wrap_pyfunction!(request::schema, module)?,
    ] {
        module.add_function(function)?;
    }
    module.add_class::<bench::RawBench>()?;
    module.add_class::<epoch::PyEpoch>()?;
    module.add_class::<epoch::PyOutput>()?;
    module.add_class::<epoch::PyTruth>()?;
    module.add("PARAMETERS", PyTuple::new(module.py(), octant_sample::parameters::NAMES)?)?;
    octant::embedded::say_build();
    failure::add(module)
}
