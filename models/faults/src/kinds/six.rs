//! Random numbers for the six channels.

use crate::rule::Context;
use crate::setup::{Setup, Stream};
use crate::values::Channels;

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
