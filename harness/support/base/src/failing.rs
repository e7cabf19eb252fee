//! Kinds of failures, from which the exit status of a command follows.

/// Side on which the cause of a failure lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureKind {
    /// The input is wrong: a file, an option, settings that contradict each other.
    Input,
    /// The bench failed: a device, a library, the file system, this program.
    Bench,
    /// Nothing failed and nothing is shown, as after an interruption.
    Inconclusive,
    /// The device or program under test failed.
    Fail,
}

/// Errors that know on which side their cause lies.
///
/// Each type says it of each of its variants, in the crate that defines them: a new variant doesn't compile without it.
pub trait Failing {
    /// Returns the kind of this failure.
    fn kind(&self) -> FailureKind;
}
