//! Which variables of an FMU are what: channels of the harness, and the variables that they are made
//! of.
//!
//! | module | idea |
//! |---|---|
//! | [`channel`] | what crosses between the harness and an FMU |
//! | [`find`] | variables by the names that people write |
//! | [`convert`] | between the unit of a variable and SI |

pub mod channel;
pub mod convert;
pub mod find;
