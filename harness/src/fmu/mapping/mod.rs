//! Which variables of an FMU are what: channels of the harness bound to variables, with their units,
//! and values that are set before the start.
//!
//! | module | idea |
//! |---|---|
//! | [`find`] | variables by the names that people write |
//! | [`convert`] | between the unit of a variable and SI |
//! | [`bind`] | channels bound to variables: where each number lies |
//! | [`settings`] | parameters, checked against the description |
//! | [`open`] | from a scenario to an FMU that can be started |
//! | [`stepper`] | an FMU that is started, and stepped in time |

pub mod bind;
pub mod convert;
pub mod find;
pub mod open;
pub mod settings;
pub mod stepper;
#[cfg(test)]
pub(crate) mod testing;
