//! Reasons why factors can't be drawn.

/// Error of factors that can't be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DrawError {
    /// A distribution has no value.
    #[error("draw {factor}: {message}")]
    Factor {
        /// The factor.
        factor: String,
        /// Description of the error.
        message: String,
    },
    /// Two factors have the same name, and would have the same draws.
    #[error("draw {0}: there are two factors of this name")]
    Duplicate(String),
    /// A correlation is invalid.
    #[error("correlate {first} with {second}: {message}")]
    Correlation {
        /// First factor.
        first: String,
        /// Second factor.
        second: String,
        /// Description of the error.
        message: String,
    },
    /// The correlations contradict each other.
    #[error(
        "correlate {}: no quantities are correlated like this (the matrix is not positive definite; \
         it breaks at {})",
        .factors.join(", "), .breaks_at
    )]
    NotPositiveDefinite {
        /// Factors of the matrix, in its order.
        factors: Vec<String>,
        /// First factor at which the leading minor isn't positive.
        breaks_at: String,
    },
    /// A Latin hypercube has no runs, or too few for the correlations.
    #[error("draw a Latin hypercube: {found} runs, at least {expected} are needed")]
    Runs {
        /// Number of runs found.
        found: usize,
        /// Smallest number of runs.
        expected: usize,
    },
}
