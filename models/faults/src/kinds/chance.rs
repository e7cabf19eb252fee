//! Loss at random.

use crate::catalogue::{Dimension, FaultParameter, ParameterBounds, Takes};
use crate::setup::FaultBuildError;
use crate::values::Values;

/// Probability of a loss.
pub(crate) const LOSS: FaultParameter = FaultParameter {
    name: "loss",
    takes: Takes::Quantity(
        &[Dimension::Ratio],
        ParameterBounds::Within(0.0, 1.0, "above 0, up to 100 %"),
    ),
    default: Some("100 %"),
    doc: "Probability that one is lost, above 0; 100 %: all are.",
};

/// Reads and checks [`LOSS`].
pub(crate) fn loss(values: &Values) -> Result<f64, FaultBuildError> {
    let loss = values.quantity("loss")?;
    if loss > 0.0 && loss <= 1.0 {
        return Ok(loss);
    }
    let problem = alloc::format!("{loss}, a probability above 0 up to 1 is expected");
    Err(FaultBuildError::value("loss", problem))
}
