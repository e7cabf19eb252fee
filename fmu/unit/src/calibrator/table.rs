//! The table of the Calibrator: every variable with its name, meaning, unit and range.

mod enumerations;
mod parameters;
mod ports;
#[doc(hidden)]
pub mod slot;

pub use enumerations::*;
pub(crate) use parameters::PARAMETERS;
pub(crate) use ports::OUTPUTS;

use crate::table::{DeclaredVariable, Model, concatenated};

const COUNT: usize = ports::INPUTS.len() + ports::OUTPUTS.len() + parameters::PARAMETERS.len();

static VARIABLES: [DeclaredVariable; COUNT] =
    concatenated(&[&ports::INPUTS, &ports::OUTPUTS, &parameters::PARAMETERS]);

/// The Calibrator.
pub static MODEL: Model = Model {
    name: "Calibrator",
    stem: "calibrator",
    description: "Calibration core of a dual-axis rotational inertial navigation system: it aligns, \
                  turns the gimbals through a position sequence, estimates its sensors' errors, \
                  compensates them and navigates.",
    variables: &VARIABLES,
    periods_per_step: (1, 1),
    sums_periods: false,
};
