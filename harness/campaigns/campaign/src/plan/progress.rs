//! Progress of the making of a plan.

/// Stage of the making of a plan, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlanStage {
    /// Cases are made.
    Making,
    /// Cases are checked.
    Checking,
    /// The id is computed from the cases.
    Hashing,
}

impl PlanStage {
    /// Returns what is done, for a bar of progress.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Making => "making cases",
            Self::Checking => "checking cases",
            Self::Hashing => "computing the id of the plan",
        }
    }
}

/// Function that is told a stage with how many cases are done, of how many.
pub type Tell<'a> = &'a dyn Fn(PlanStage, usize, usize);

/// Number of cases that are made or hashed between two reports.
const EVERY: usize = 1000;

/// Tells how far a list of cases is.
pub(super) fn told<'a, T>(
    cases: impl Iterator<Item = T> + 'a,
    stage: PlanStage,
    total: usize,
    tell: Tell<'a>,
) -> impl Iterator<Item = T> + 'a {
    cases.enumerate().map(move |(done, case)| {
        if done % EVERY == 0 {
            tell(stage, done, total);
        }
        case
    })
}
