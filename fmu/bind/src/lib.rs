//! Maps the variables of an FMU: channels of the harness bound to variables, with their units,
//! and values that are set before the start.
//!
//! | module | idea |
//! |---|---|
//! | [`find`] | variables by the names that users write |
//! | [`convert`] | conversion between the unit of a variable and SI |
//! | [`bind`] | channels bound to variables: place of each number |
//! | [`settings`] | parameters, checked against the description |
//! | [`open`] | from a scenario to an FMU that can be started |
//! | [`OpenedFmus`] | FMUs of a run, each opened once |
//! | `starts` | values with which an FMU starts |
//! | [`stepper`] | a started FMU, stepped in time |

pub mod bind;
pub mod convert;
pub mod find;
pub mod open;
mod opened;
pub mod settings;
mod starts;
pub mod stepper;
#[cfg(any(test, feature = "testing"))]
pub mod testing;

pub use opened::OpenedFmus;
