//! An MCAP file that octant did not write, as a source: a mapping names topic and fields.

use super::counting::{Counted, Counting, Measured, RowWords};
use super::joined::Joined;
use super::messages::{TopicMessage, TopicMessages};
use super::temperature::TemperatureCheck;
use super::{Epoch, SourceError};
use octant_account::Account;
use octant_recorder::event::BenchRecord;
use octant_scenario::recorded::{MappedField, McapMapping, TemperatureUnit};
use std::io::Read;

/// Streams a foreign MCAP file.
pub(super) struct Foreign<R> {
    path: String,
    messages: Joined<R>,
    /// Offset and scale of each value.
    scales: Vec<(f64, f64)>,
    has_gimbal: bool,
    counting: Counting,
    /// Unit of the temperature, which is the last of the numbers.
    temperature: Option<TemperatureUnit>,
    temperatures: TemperatureCheck,
}

impl<R: Read> Foreign<R> {
    /// Makes a reader of the file, which `open` opens once for each topic.
    pub(super) fn new(
        mut open: impl FnMut() -> Result<R, SourceError>,
        path: &str,
        mapping: &McapMapping,
    ) -> Result<Self, SourceError> {
        let fail = |reason: String| SourceError::Read { path: path.into(), reason };
        let words = RowWords {
            unit: ["message", "messages"],
            at: "message",
            other_times: "another time_field, or none for the times of the log, may have the times",
        };
        // The order of the numbers: gyro, accelerometer, gimbal.
        let fields: Vec<&MappedField> = mapping
            .gyro
            .iter()
            .chain(&mapping.accelerometer)
            .chain(mapping.gimbal.iter().flatten())
            .collect();
        let temperature = mapping.temperature.iter().map(|field| field.path.as_str());
        let paths = |fields: &[&MappedField]| -> Vec<String> {
            fields.iter().map(|field| field.path.clone()).collect()
        };
        let reader = |source: R, topic: &str, paths: Vec<String>| {
            let paths = paths.iter().map(String::as_str);
            TopicMessages::new(source, topic, paths, &mapping.stamp).map_err(fail)
        };
        let messages = match &mapping.accelerometer_topic {
            None => {
                let all = paths(&fields).into_iter().chain(temperature.map(str::to_owned));
                Joined::one(reader(open()?, &mapping.topic, all.collect())?)
            }
            Some(topic) => {
                let gyro = paths(&fields[..3]).into_iter().chain(paths(&fields[6..]));
                let gyro = gyro.chain(temperature.map(str::to_owned));
                let gyro = reader(open()?, &mapping.topic, gyro.collect())?;
                Joined::two(gyro, reader(open()?, topic, paths(&fields[3..6]))?, 3, 3)
            }
        };
        Ok(Self {
            path: path.into(),
            messages,
            scales: fields.iter().map(|field| (field.offset, field.scale)).collect(),
            has_gimbal: mapping.gimbal.is_some(),
            counting: Counting::new(
                mapping.quantity,
                mapping.nominal_rate_hz,
                mapping.split,
                words,
            )
            .map_err(fail)?,
            temperature: mapping.temperature.as_ref().map(|field| field.unit),
            temperatures: TemperatureCheck::default(),
        })
    }

    pub(super) fn truncated(&self) -> bool {
        self.messages.truncated()
    }

    /// Describes gaps of which more messages are missing than a file may lack.
    pub(super) fn gaps(&self) -> Option<String> {
        self.counting.cut_short(&self.path)
    }

    /// Returns what the report says of a file with gaps.
    pub(super) fn bench(&self) -> Option<Box<BenchRecord>> {
        self.counting.bench(&self.path)
    }

    /// Account of the messages.
    pub(super) fn account(&self) -> Account {
        let account = self.counting.account(&self.path, self.messages.outside());
        self.messages.unpaired().into_iter().fold(account, Account::left_out)
    }

    pub(super) fn saturated(&self) -> u64 {
        self.counting.saturated()
    }

    pub(super) fn next(&mut self) -> Result<Option<Epoch>, SourceError> {
        self.advance().map_err(|reason| SourceError::Read { path: self.path.clone(), reason })
    }

    /// Temperature of the last message, °C.
    pub(super) fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        let Some(unit) = self.temperature else { return Ok(None) };
        let Some(row) = self.counting.row() else { return Ok(None) };
        let (place, time_ns) = (row.place, row.stamp_ns.unwrap_or_default());
        self.temperatures.take(time_ns, row.temperature, unit).map(Some).map_err(|reason| {
            let field = self.messages.path(self.scales.len());
            let reason =
                self.messages.in_message_number(place, &format!("field {field}: {reason}"));
            SourceError::Read { path: self.path.clone(), reason }
        })
    }

    fn advance(&mut self) -> Result<Option<Epoch>, String> {
        loop {
            let counted = self
                .counting
                .next()
                .map_err(|error| self.messages.in_message_number(error.place, &error.reason))?;
            match counted {
                Counted::Sample(sample) => return Ok(Some(Epoch { sample, aiding: None })),
                Counted::End if self.messages.number() == 0 => {
                    return Err(self.messages.no_message());
                }
                Counted::End => return Ok(None),
                Counted::More => match self.messages.next()? {
                    Some(message) => {
                        self.take(&message).map_err(|reason| self.messages.in_message(&reason))?
                    }
                    None => self.counting.end(),
                },
            }
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
        let temperature = message.numbers.get(self.scales.len());
        let [gx, gy, gz, ax, ay, az, azimuth, roll] = values;
        self.counting.push(Measured {
            place: self.messages.number(),
            stamp_ns: Some(message.time_ns),
            gyro: [gx, gy, gz],
            accel: [ax, ay, az],
            gimbal_rad: self.has_gimbal.then_some([azimuth, roll]),
            temperature: temperature.map_or(f64::NAN, |number| number.real()),
        });
        Ok(())
    }
}
