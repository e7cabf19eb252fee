//! Units that are keys of their own.

use crate::error::Problem;
use crate::keys::At;

/// SI value of a unit.
pub(super) fn unit_si(unit: &At<String>) -> Result<f64, Problem> {
    crate::quantity::parse(&format!("1 {}", **unit))
        .map(|quantity| quantity.si)
        .map_err(|_| unit.problem(format!("found the unknown unit {:?}", **unit)))
}
