//! Rates of messages, from which the load of a line or bus is computed.

use crate::message::{EndRole, MessageKind};

/// Rates of the messages of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Samples from the harness, Hz.
    pub samples_hz: f64,
    /// Outputs from the device, Hz.
    pub outputs_hz: f64,
    /// Aiding from the harness, Hz.
    pub aiding_hz: f64,
    /// Changes of the parameters, each with all of its segments, Hz.
    pub parameters_hz: f64,
    /// Heartbeats from either end, Hz.
    pub heartbeat_hz: f64,
    /// Status from the device, Hz.
    pub status_hz: f64,
    /// Exchanges of the time, Hz.
    pub time_hz: f64,
}

impl Traffic {
    /// Traffic of samples only, in one direction.
    #[must_use]
    pub fn samples(rate_hz: f64) -> Self {
        Self { samples_hz: rate_hz, ..Self::default() }
    }

    /// Traffic of a session at a sample rate: samples and as many outputs; aiding, parameters and
    /// status once a second, heartbeats ten times and the time four times a second.
    #[must_use]
    pub fn session(rate_hz: f64) -> Self {
        Self {
            samples_hz: rate_hz,
            outputs_hz: rate_hz,
            aiding_hz: 1.0,
            parameters_hz: 1.0,
            heartbeat_hz: 10.0,
            status_hz: 1.0,
            time_hz: 4.0,
        }
    }

    /// Sender, kind and rate of each message, Hz. Parameters count once for all segments.
    pub fn messages(&self) -> impl Iterator<Item = (EndRole, MessageKind, f64)> {
        [
            (EndRole::Harness, MessageKind::Sample, self.samples_hz),
            (EndRole::Harness, MessageKind::Aiding, self.aiding_hz),
            (EndRole::Harness, MessageKind::Heartbeat, self.heartbeat_hz),
            (EndRole::Harness, MessageKind::TimeRequest, self.time_hz),
            (EndRole::Device, MessageKind::Output, self.outputs_hz),
            (EndRole::Device, MessageKind::Parameters, self.parameters_hz),
            (EndRole::Device, MessageKind::Heartbeat, self.heartbeat_hz),
            (EndRole::Device, MessageKind::Status, self.status_hz),
            (EndRole::Device, MessageKind::TimeReply, self.time_hz),
        ]
        .into_iter()
    }
}
