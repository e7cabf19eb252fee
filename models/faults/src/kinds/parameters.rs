//! Parameters that several kinds of faults have, and how their values are read.

use crate::catalogue::{Dimension, FaultParameter, ParameterBounds, Takes};
use crate::rule::Context;
use crate::setup::{FaultBuildError, Setup, Stream};
use crate::values::{Channels, Values};
use core::ops::RangeInclusive;

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

/// Reads a parameter that is a time or a number of samples, to the nearest whole sample.
pub(crate) fn samples(
    values: &Values,
    name: &'static str,
    within: RangeInclusive<u64>,
    setup: &Setup,
) -> Result<u64, FaultBuildError> {
    let (value, dimension) = values.quantity_and_dimension(name)?;
    let samples = match dimension {
        Dimension::Samples => value,
        _ => value / setup.dt_s(),
    };
    // The cast saturates, and takes NaN to zero.
    let whole = libm::round(samples) as u64;
    if within.contains(&whole) {
        return Ok(whole);
    }
    let problem = alloc::format!(
        "{whole} samples of {} s, {} to {} are expected",
        setup.dt_s(),
        within.start(),
        within.end()
    );
    Err(FaultBuildError::value(name, problem))
}

/// One random number per channel and sample; numbers that no channel needs aren't drawn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Six {
    gyro: Option<Stream>,
    accelerometer: Option<Stream>,
}

impl Six {
    /// The streams `<name>.gyro` and `<name>.accelerometer` of the fault.
    pub(crate) fn new(setup: &Setup, channels: Channels, name: &str) -> Self {
        let stream = |part| setup.stream(&alloc::format!("{name}.{part}"));
        Self {
            gyro: (!channels.accelerometers_only()).then(|| stream("gyro")),
            accelerometer: (!channels.gyros_only()).then(|| stream("accelerometer")),
        }
    }

    /// Independent standard normals of this sample; 0 for a triad without a channel in the set.
    pub(crate) fn normals(&self, now: &Context<'_>) -> [f64; 6] {
        let three = |stream: &Option<Stream>| stream.map_or([0.0; 3], |it| now.normals(&it));
        let ([a, b, c], [d, e, f]) = (three(&self.gyro), three(&self.accelerometer));
        [a, b, c, d, e, f]
    }

    /// Independent numbers in (0, 1) of this sample; 0 for a triad without a channel in the set.
    pub(crate) fn uniforms(&self, now: &Context<'_>) -> [f64; 6] {
        let four = |stream: &Option<Stream>| stream.map_or([0.0; 4], |it| now.uniforms(&it));
        let ([a, b, c, _], [d, e, f, _]) = (four(&self.gyro), four(&self.accelerometer));
        [a, b, c, d, e, f]
    }
}
