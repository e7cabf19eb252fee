//! Tables of campaigns and nights, from their Parquet files.

use crate::columns::Columns;
use crate::failure::input;
use crate::table::Table;
use octant_campaign::table::{ColumnValues, ExistingTable as File, TableError};
use pyo3::prelude::*;
use std::path::PathBuf;

/// Reads a table of a campaign or of a history: `cases.parquet`, `checks.parquet`, `drift.parquet`,
/// `history.parquet`.
#[pyfunction]
pub(crate) fn read_parquet(py: Python<'_>, path: PathBuf) -> PyResult<Table> {
    let columns = py.detach(|| read(&path)).map_err(|error| input(format!("failed to {error}")))?;
    Table::new(columns)
}

fn read(path: &std::path::Path) -> Result<Columns, TableError> {
    let file = File::open(path)?;
    let mut columns = Columns::default();
    for (name, _) in &file.columns {
        let unit = unit_of(name);
        match file.column(name)? {
            None => {}
            Some(ColumnValues::Text(values)) => columns.texts(name, values.into_iter()),
            Some(ColumnValues::Number(values)) => columns.some_numbers(name, unit, values),
            Some(ColumnValues::Integer(values)) => columns.some_integers(name, unit, values),
            Some(ColumnValues::Boolean(values)) => columns.booleans(name, values),
        }
    }
    Ok(columns)
}

/// Units by the end of a name, the longest first.
const UNITS: [(&str, &str); 14] = [
    ("_deg_per_h_per_g", "deg/h/g"),
    ("_arcmin_per_day", "arcmin/day"),
    ("_arcmin", "arcmin"),
    ("_arcsec", "arcsec"),
    ("_nmi", "nmi"),
    ("_mps", "m/s"),
    ("_deg", "deg"),
    ("_rad", "rad"),
    ("_min", "min"),
    ("_ppm", "ppm"),
    ("_ms", "ms"),
    ("_us", "us"),
    ("_h", "h"),
    ("_s", "s"),
];

/// Returns the unit of a column by its name: the end of a part of its path. Empty where it has none.
fn unit_of(name: &str) -> &'static str {
    if name == "hours" || name.ends_with(".hours") {
        return "h";
    }
    // "navigation.radial_error_nmi.rate_per_h" is in nmi/h: the part's own end is the last word.
    let parts: Vec<&str> = name.split('.').collect();
    let found =
        |part: &str| UNITS.iter().find(|(end, _)| part.ends_with(end)).map_or("", |(_, unit)| unit);
    match parts.as_slice() {
        [.., above, "rate_per_h"] if found(above) == "nmi" => "nmi/h",
        [.., above, "slope_per_day"] if found(above) == "arcmin" => "arcmin/day",
        [.., above, "max" | "rms" | "final"] => found(above),
        [.., last] => found(last),
        [] => "",
    }
}
