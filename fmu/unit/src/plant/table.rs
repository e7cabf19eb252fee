//! The table of the Plant: every variable with its name, meaning, unit and range.

mod enumerations;
mod faults;
mod instrument;
mod ports;
#[doc(hidden)]
pub mod slot;
mod world;

pub(crate) use enumerations::acts_in_plant;
pub use enumerations::{AIDING, FAULT_KIND, MOTION, REFERENCE_KIND};
pub use faults::{FAULT_NUMBERS, FAULT_SLOTS};
pub use world::SINUSOIDS_MAX;

use crate::table::{DeclaredVariable, Model, concatenated, count};

const PARTS: &[&[DeclaredVariable]] = &[
    &ports::INPUTS,
    &faults::INPUTS,
    &ports::OUTPUTS,
    &faults::OUTPUTS,
    &world::PARAMETERS,
    &instrument::PARAMETERS,
    &faults::PARAMETERS,
];

const COUNT: usize = count(PARTS);

static VARIABLES: [DeclaredVariable; COUNT] = concatenated(PARTS);

/// The Plant.
pub static MODEL: Model = Model {
    name: "Plant",
    stem: "plant",
    description: "The truth of a dual-axis rotational inertial navigation system: motion of the \
                  case, two-axis turntable, gyros and accelerometers with their errors, the \
                  reference of a calibration, and faults in all of them.",
    variables: &VARIABLES,
    periods_per_step: (1, 1_000_000),
    sums_periods: true,
};
