//! What a command needs of a campaign.

/// Files of a campaign that a command needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    /// The plan and its files.
    Plan,
    /// These and the results.
    Results,
    /// Everything, tables and report too.
    All,
}
