//! Points of the space of random inputs, and what runs them.

use octant_random::draws::Draws;
use serde::{Deserialize, Serialize};

/// Random inputs of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RarePoint {
    /// Drawn values as independent standard normal components.
    pub u: Vec<f64>,
    /// Seed of the noise: it can be drawn anew, and not moved.
    pub noise: u64,
}

impl RarePoint {
    /// A point as the runs of a campaign would have it.
    #[must_use]
    pub fn drawn(dimension: usize, draws: &mut Draws) -> Self {
        let u = (0..dimension).map(|_| draws.normal()).collect();
        Self { u, noise: noise_seed(draws) }
    }

    /// Distance from the mean of all components, in σ.
    #[must_use]
    pub fn radius(&self) -> f64 {
        libm::sqrt(self.u.iter().map(|u| u * u).sum())
    }
}

/// A seed for the noise of a run, that a scenario can name.
pub(crate) fn noise_seed(draws: &mut Draws) -> u64 {
    draws.below(1 << 53) as u64
}

/// Distribution that the points of a batch were drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RareStage {
    /// The inputs' own: plain Monte Carlo.
    Plain,
    /// Steps of Markov chains.
    Chain,
    /// A proposal near the failures.
    Weighted,
}

/// Runs points. The severity of a run is larger the worse it is; a run that can't be judged is
/// [`f64::NEG_INFINITY`], and none is NaN.
pub trait RareBench {
    /// Reason why it can't go on.
    type Error;
    /// Number of components of [`RarePoint::u`].
    fn dimension(&self) -> usize;
    /// Severities of the points, in their order.
    ///
    /// # Errors
    /// If it can't go on, or the end was asked for.
    fn severities(
        &mut self,
        points: &[RarePoint],
        stage: RareStage,
    ) -> Result<Vec<f64>, Self::Error>;
}

/// A point with its severity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RareSample {
    /// The point.
    pub point: RarePoint,
    /// Its severity.
    pub severity: f64,
}
