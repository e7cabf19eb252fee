//! An MCAP file that octant did not write, as a source: a mapping names topic and fields.

use super::counting::{Counting, Measured};
use super::messages::{TopicMessage, TopicMessages};
use super::{Epoch, SourceError};
use octant_scenario::recorded::{MappedField, McapMapping};
use std::io::Read;

/// Streams a foreign MCAP file.
pub(super) struct Foreign<R> {
    path: String,
    messages: TopicMessages<R>,
    /// Offset and scale of each value.
    scales: Vec<(f64, f64)>,
    has_gimbal: bool,
    counting: Counting,
}

impl<R: Read> Foreign<R> {
    pub(super) fn new(source: R, path: &str, mapping: &McapMapping) -> Result<Self, SourceError> {
        let fail = |reason: String| SourceError::Read { path: path.into(), reason };
        let nominal_ns = super::nominal_period_ns(mapping.nominal_rate_hz).map_err(fail)?;
        // The order of the numbers: gyro, accelerometer, gimbal.
        let fields: Vec<&MappedField> = mapping
            .gyro
            .iter()
            .chain(&mapping.accelerometer)
            .chain(mapping.gimbal.iter().flatten())
            .collect();
        let paths = fields.iter().map(|field| field.path.as_str());
        Ok(Self {
            path: path.into(),
            messages: TopicMessages::new(source, &mapping.topic, paths, &mapping.stamp)
                .map_err(fail)?,
            scales: fields.iter().map(|field| (field.offset, field.scale)).collect(),
            has_gimbal: mapping.gimbal.is_some(),
            counting: Counting::new(mapping.quantity, nominal_ns, mapping.split).map_err(fail)?,
        })
    }

    pub(super) fn truncated(&self) -> bool {
        self.messages.truncated()
    }

    pub(super) fn saturated(&self) -> u64 {
        self.counting.saturated()
    }

    pub(super) fn next(&mut self) -> Result<Option<Epoch>, SourceError> {
        self.advance().map_err(|reason| SourceError::Read { path: self.path.clone(), reason })
    }

    fn advance(&mut self) -> Result<Option<Epoch>, String> {
        loop {
            if let Some(sample) = self.counting.next() {
                return Ok(Some(Epoch { sample, aiding: None }));
            }
            let Some(message) = self.messages.next()? else { return Ok(None) };
            self.take(&message).map_err(|reason| self.messages.in_message(&reason))?;
        }
    }

    /// Passes a message to the counting.
    fn take(&mut self, message: &TopicMessage) -> Result<(), String> {
        let mut values = [0.0; 8];
        for (index, (offset, scale)) in self.scales.iter().enumerate() {
            let raw = message.numbers[index].real();
            let value = (raw - offset) * scale;
            if !value.is_finite() {
                let path = self.messages.path(index);
                return Err(format!("field {path} is {raw}, expected a finite number"));
            }
            values[index] = value;
        }
        let [gx, gy, gz, ax, ay, az, azimuth, roll] = values;
        self.counting.begin(Measured {
            time_ns: message.time_ns,
            gyro: [gx, gy, gz],
            accel: [ax, ay, az],
            gimbal_rad: self.has_gimbal.then_some([azimuth, roll]),
        })
    }
}
