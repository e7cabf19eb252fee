//! What can be wrong with a description, and the version of the format.

use std::string::String;

/// Version of the format of descriptions.
pub const VERSION: i64 = 1;

/// Error of a description.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{place}: {what}")]
pub struct DescriptionProblem {
    /// File with line.
    pub place: String,
    /// Key, what was found, what was expected.
    pub what: String,
}
