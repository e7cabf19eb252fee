//! Common parts of the kinds that act inside the plant.

use crate::catalogue::{Dimension, FaultParameter, ParameterBounds, Takes};
use crate::rule::{Context, FaultRule, PlantRule};
use crate::setup::{FaultBuildError, Setup};
use crate::values::Values;
use alloc::boxed::Box;
use alloc::format;
use octant_sample::disturbance::{Disturbance, Motor};

/// A disturbance that is the same at every onset.
#[derive(Clone, Debug)]
struct Fixed {
    disturbance: Disturbance,
}

octant_state::state! { Fixed { values: ; parts: ; kept: disturbance } }

impl PlantRule for Fixed {
    fn begin(&mut self, _: &Context<'_>, _: &Motor) -> Disturbance {
        self.disturbance.clone()
    }
}

/// The rule of a disturbance that is the same at every onset.
pub(crate) fn fixed(disturbance: Disturbance) -> FaultRule {
    FaultRule::Plant(Box::new(Fixed { disturbance }))
}

/// Time over which a motion swells and fades.
pub(crate) const EDGE: FaultParameter = FaultParameter {
    name: "edge",
    takes: Takes::Quantity(&[Dimension::Time], ParameterBounds::Positive),
    default: Some("0.5 s"),
    doc: "Time over which it swells after the onset and fades after the end.",
};

/// Reads a vector with at least one entry that isn't zero, each of a size up to `limit`.
pub(crate) fn something(
    values: &Values,
    name: &'static str,
    limit: f64,
    unit: &str,
) -> Result<[f64; 3], FaultBuildError> {
    let vector = values.vector(name)?;
    if vector == [0.0; 3] {
        let problem = "three zeros were found, at least one that isn't zero is expected";
        return Err(FaultBuildError::value(name, problem));
    }
    within(name, &vector, limit, unit)?;
    Ok(vector)
}

/// Checks that sizes are within a limit.
pub(crate) fn within(
    name: &'static str,
    values: &[f64],
    limit: f64,
    unit: &str,
) -> Result<(), FaultBuildError> {
    match values.iter().find(|value| !(value.abs() <= limit)) {
        Some(value) => {
            let problem = format!("{value} {unit} was found, at most {limit} {unit} is expected");
            Err(FaultBuildError::value(name, problem))
        }
        None => Ok(()),
    }
}

/// Checks that one of two vectors has an entry that isn't zero.
pub(crate) fn not_nothing(
    name: &'static str,
    other: &str,
    vectors: [&[f64; 3]; 2],
) -> Result<(), FaultBuildError> {
    if vectors.iter().all(|vector| **vector == [0.0; 3]) {
        let problem = format!("zeros were found, here or in {other} one that isn't is expected");
        return Err(FaultBuildError::value(name, problem));
    }
    Ok(())
}

/// Reads a frequency that the plant can integrate: at most 100 periods in a sample.
pub(crate) fn frequency(
    values: &Values,
    name: &'static str,
    setup: &Setup,
) -> Result<f64, FaultBuildError> {
    let frequency = values.quantity(name)?;
    let limit = 100.0 / setup.dt_s();
    if frequency >= 1e-4 && frequency <= limit {
        return Ok(frequency);
    }
    let problem = format!(
        "{frequency} Hz was found, 0.0001 Hz to {limit} Hz is expected, 100 periods in a sample"
    );
    Err(FaultBuildError::value(name, problem))
}

/// Angular frequency, rad/s.
pub(crate) fn angular(frequency_hz: f64) -> f64 {
    2.0 * core::f64::consts::PI * frequency_hz
}
