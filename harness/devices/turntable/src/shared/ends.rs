//! How runs at a table of another one end.

/// How a guest's run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GuestEnd {
    /// It is still going on.
    Open,
    /// It had all its samples.
    Done,
    /// It left, or was lost, for this reason.
    Left(String),
}
