//! The bytes that an instrument sent, as a file: decoded as those of a port, at the speed of the host.
//!
//! Damaged frames are skipped, and a gap stays a gap, as on a port. The file has no time of its own: stamps
//! are those of the readings, and where the protocol has none, readings follow each other.

use crate::counting::MISSING_MAX;
use crate::described::decoder;
use crate::rate_check::RateCheck;
use crate::sampled::account;
use crate::temperature::TemperatureCheck;
use crate::traffic::traffic;
use crate::{Epoch, Source, SourceError};
use octant_account::Account;
use octant_base::number::counted;
use octant_instruments::{
    AnyDecoder, FramingEvent, Reading, ReadingDefect, Sampler, SamplerCounters, SamplerSettings,
    Unusable,
};
use octant_plant::Truth;
use octant_recorder::event::{BenchReadings, BenchRecord};
use octant_sample::GimbalCommand;
use octant_scenario::InstrumentLog;
use octant_scenario::recorded::TemperatureUnit;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

/// Number of bytes that are read at a time.
const READ_BYTES: usize = 1 << 16;

/// A file of what an instrument sent.
pub struct LogSource {
    path: String,
    file: File,
    /// Protocol, as messages name it.
    protocol: String,
    decoder: AnyDecoder,
    /// Why the first intact frame that can't be read can't.
    unread: Option<ReadingDefect>,
    buffer: Box<[u8]>,
    /// Range of the buffer that is not decoded yet.
    rest: Range<usize>,
    /// Number of lost bytes when the end of the file was reached: those lost after it are of an incomplete
    /// frame.
    lost_before_end: Option<u64>,
    sampler: Sampler,
    rate: RateCheck,
    temperatures: TemperatureCheck,
    /// Stamp, ns, of the last sample, and the temperature that the instrument sent last, °C.
    last: (u64, Option<f32>),
}

impl LogSource {
    /// Opens a file. Its samples have a rate, Hz. The name of a description's file is relative to `folder`.
    ///
    /// # Errors
    /// If the file can't be opened, or the description of its frames isn't one.
    pub fn open(
        path: &Path,
        log: &InstrumentLog,
        folder: &Path,
        rate_hz: f64,
    ) -> Result<Self, SourceError> {
        let decoder = decoder(&log.speaks, log.count, folder)?;
        let decoder = decoder.ok_or_else(|| SourceError::Read {
            path: path.display().to_string(),
            reason: "found the protocol of a CAN bus, expected one of a line of bytes".to_owned(),
        })?;
        let name = path.display().to_string();
        let wrong =
            |e: std::io::Error| SourceError::Read { path: name.clone(), reason: e.to_string() };
        let file = File::open(path).map_err(wrong)?;
        // A folder opens as well.
        if file.metadata().map_err(wrong)?.is_dir() {
            let reason = "found a folder, expected a file".to_owned();
            return Err(SourceError::Read { path: name, reason });
        }
        Ok(Self {
            path: name,
            file,
            protocol: log.speaks.told(),
            decoder,
            unread: None,
            buffer: vec![0; READ_BYTES].into_boxed_slice(),
            rest: 0..0,
            lost_before_end: None,
            sampler: Sampler::new(SamplerSettings { axes: log.axes, rate_hz }),
            rate: RateCheck::new(rate_hz),
            temperatures: TemperatureCheck::default(),
            last: (0, None),
        })
    }

    fn error(&self, reason: String) -> SourceError {
        SourceError::Read { path: self.path.clone(), reason }
    }

    /// Describes the bytes that were decoded.
    fn said(&self) -> String {
        traffic(self.decoder.counters(), self.unread, &self.protocol, "log")
    }

    /// Returns the next reading; `None` at the end of the file.
    fn reading(&mut self) -> Result<Option<Reading>, SourceError> {
        loop {
            let mut bytes = self.buffer.get(self.rest.clone()).unwrap_or_default();
            let event = match self.lost_before_end {
                None => self.decoder.next(&mut bytes),
                Some(_) => self.decoder.end(),
            };
            self.rest.start = self.rest.end - bytes.len();
            match event {
                Some(FramingEvent::Reading(reading)) => return Ok(Some(reading)),
                Some(FramingEvent::Lost(lost)) if lost.cause.is_final() => {
                    return Err(self.error(lost.cause.to_string()));
                }
                Some(FramingEvent::Lost(lost)) if lost.cause.is_intact() => {
                    self.unread.get_or_insert(lost.cause);
                }
                Some(FramingEvent::Lost(_)) => {}
                None if self.lost_before_end.is_some() => return Ok(None),
                None => {
                    let came = self.file.read(&mut self.buffer);
                    let came = came.map_err(|error| self.error(error.to_string()))?;
                    self.rest = 0..came;
                    if came == 0 {
                        self.lost_before_end = Some(self.decoder.counters().bytes_lost);
                    }
                }
            }
        }
    }
}

impl Source for LogSource {
    fn next(&mut self, _command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        while let Some(reading) = self.reading()? {
            // Not a number: the unit has no thermometer, or didn't read it.
            let sent = reading.temperature_c.filter(|temperature| temperature.is_finite());
            self.last.1 = sent.or(self.last.1);
            self.rate.reading(&reading).map_err(|reason| self.error(reason))?;
            match self.sampler.sample(&reading, None) {
                Ok(sample) => {
                    (epoch.sample, epoch.aiding) = (sample, None);
                    self.last.0 = sample.device_time.ns;
                    return Ok(true);
                }
                Err(Unusable::Behind) => {}
                Err(unusable) => return Err(self.error(unusable.to_string())),
            }
        }
        if self.sampler.counters().samples == 0 {
            return Err(self.error(format!("it has no reading: {}", self.said())));
        }
        self.rate.end().map_err(|reason| self.error(reason))?;
        Ok(false)
    }

    fn truth(&self) -> Option<Truth> {
        None
    }

    fn temperature_c(&mut self) -> Result<Option<f64>, SourceError> {
        let (time_ns, Some(sent)) = self.last else { return Ok(None) };
        let checked = self.temperatures.take(time_ns, f64::from(sent), TemperatureUnit::Celsius);
        let sample = self.sampler.counters().samples;
        checked.map(Some).map_err(|reason| self.error(format!("sample {sample}: {reason}")))
    }

    fn samples_total(&self) -> Option<u64> {
        None
    }

    fn cut_short(&self) -> Option<String> {
        let SamplerCounters { samples, missing, .. } = *self.sampler.counters();
        if missing > samples / MISSING_MAX {
            let missing = counted(missing, "sample", "samples");
            return Some(format!("{} has gaps: {missing} missing, {samples} there", self.path));
        }
        let torn = self.decoder.counters().bytes_lost - self.lost_before_end?;
        (torn > 0).then(|| {
            let bytes = counted(torn, "byte", "bytes");
            format!("{} ends with {bytes} of an incomplete frame", self.path)
        })
    }

    fn accounts(&self) -> Vec<Account> {
        vec![account(&self.path, &self.sampler, Some(self.decoder.counters()), None)]
    }

    fn conclude(
        &mut self,
        _broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        let counters = self.sampler.counters();
        let readings = BenchReadings {
            behind: counters.behind,
            irregular: counters.irregular,
            missing: counters.missing,
            samples: counters.samples,
        };
        let instrument = format!("{}: {}", self.path, self.said());
        (Some(Box::new(BenchRecord::of_file(instrument, readings))), None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::tests::{PERIOD_NS, sample};
    use octant_instruments::{AnyEncoder, Axes, Protocol, Stamp, StampClock};
    use octant_sample::Sample;
    use octant_scenario::{FileName, Speaks};

    /// Frames of a protocol with the samples of these numbers, and bytes between them that are no frame.
    fn bytes(protocol: Protocol, numbers: impl Iterator<Item = u64>) -> Vec<u8> {
        let mut encoder = AnyEncoder::new(protocol);
        let mut bytes = Vec::new();
        for number in numbers {
            let stamp = Some(Stamp { ns: number * PERIOD_NS, clock: StampClock::Gps });
            let interval_s = Some(PERIOD_NS as f64 * 1e-9);
            let sent = match protocol {
                Protocol::Octant => Reading::of_sample(&sample(number)),
                _ => Reading { stamp, interval_s, ..Reading::of_sample(&sample(number)) },
            };
            bytes.extend(encoder.encode(&sent).unwrap());
            if number % 7 == 0 {
                bytes.extend([0x55; 30]);
            }
        }
        bytes
    }

    fn source(bytes: &[u8], protocol: Protocol) -> (tempfile::TempDir, LogSource) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("unit.bin");
        std::fs::write(&path, bytes).unwrap();
        let file = FileName("unit.bin".to_owned());
        let speaks = Speaks::Bytes(protocol);
        let log = InstrumentLog { file, speaks, count: None, axes: Axes::SAME };
        let source = LogSource::open(&path, &log, folder.path(), 200.0).unwrap();
        (folder, source)
    }

    fn all(source: &mut LogSource) -> Vec<Sample> {
        let mut epoch = Epoch::default();
        let command = GimbalCommand::default();
        std::iter::from_fn(|| source.next(&command, &mut epoch).unwrap().then_some(epoch.sample))
            .collect()
    }

    #[test]
    fn a_file_gives_what_was_sent_in_every_protocol() {
        // More bytes than are read at a time.
        const COUNT: u64 = 3000;
        for protocol in Protocol::ALL {
            let (_folder, mut source) = source(&bytes(protocol, 1..=COUNT), protocol);
            let found = all(&mut source);
            assert_eq!(found.len() as u64, COUNT, "{}", source.said());
            // Sums of counts, as some protocols round each increment and carry the rest.
            let sum = |of: &dyn Fn(&Sample) -> i32| -> f64 {
                found.iter().map(|sample| f64::from(of(sample))).sum()
            };
            let sent = |of: &dyn Fn(&Sample) -> i32| -> f64 {
                (1..=COUNT).map(|number| f64::from(of(&sample(number)))).sum()
            };
            for axis in 0..3 {
                let [rotation, velocity] = protocol.facts().resolution;
                // A float of 32 bits has 24 of a value, in each of the samples.
                let lost = |sum: f64| sum.abs() * 2f64.powi(-24) + 2.0;
                let of = |sample: &Sample| sample.delta_theta[axis];
                let margin = rotation / 1.455e-11 + lost(sent(&of));
                assert!((sum(&of) - sent(&of)).abs() < margin, "{protocol:?} {axis}");
                let of = |sample: &Sample| sample.delta_velocity[axis];
                let margin = velocity / 9.313e-10 + lost(sent(&of));
                assert!((sum(&of) - sent(&of)).abs() < margin, "{protocol:?} {axis}");
            }
            if protocol == Protocol::Octant {
                assert!(found.iter().zip(1..).all(|(found, number)| *found == sample(number)));
            }
            assert_eq!(source.cut_short(), None, "{protocol:?}");
            let told = source.conclude(None).0.unwrap();
            assert_eq!((told.readings.samples, told.readings.missing), (COUNT, 0));
        }
    }

    #[test]
    fn gaps_and_a_torn_end_are_told() {
        let sent =
            bytes(Protocol::VectorNav, (1..=40).filter(|number| !(11..=13).contains(number)));
        let torn = &sent[..sent.len() - 35];
        let (_folder, mut torn) = source(torn, Protocol::VectorNav);
        assert_eq!(all(&mut torn).iter().filter(|sample| sample.sequence > 13).count(), 26);
        let told = torn.conclude(None).0.unwrap();
        assert_eq!((told.readings.samples, told.readings.missing), (36, 3));
        let said = torn.cut_short().unwrap();
        assert!(said.ends_with("bytes of an incomplete frame"), "{said}");
        // One in five lost is no complete file.
        let sent = bytes(Protocol::VectorNav, (1..=200).filter(|number| number % 5 != 3));
        let (_folder, mut source) = source(&sent, Protocol::VectorNav);
        assert_eq!(all(&mut source).len(), 160);
        let said = source.cut_short().unwrap();
        assert!(said.ends_with("has gaps: 40 samples missing, 160 there"), "{said}");
    }

    #[test]
    fn another_rate_than_the_scenarios_is_an_error() {
        let (_folder, mut source) =
            source(&bytes(Protocol::VectorNav, 1..=200), Protocol::VectorNav);
        source.rate = RateCheck::new(100.0);
        let mut epoch = Epoch::default();
        let mut next = || source.next(&GimbalCommand::default(), &mut epoch);
        let error =
            std::iter::from_fn(|| next().err().map(|e| e.to_string()).or(Some(String::new())))
                .find(|error| !error.is_empty())
                .unwrap();
        assert!(error.contains("5.0000 ms apart, 200.0 Hz, expected 10.0000 ms"), "{error}");
    }

    #[test]
    fn bytes_of_another_protocol_are_an_error() {
        let (_folder, mut source) = source(&bytes(Protocol::Sbg, 1..=40), Protocol::Xsens);
        let error = source.next(&GimbalCommand::default(), &mut Epoch::default()).unwrap_err();
        let error = error.to_string();
        assert!(error.contains("unit.bin: it has no reading: "), "{error}");
        assert!(error.contains("0 readings, 0 other frames of protocol xsens"), "{error}");
        assert!(error.contains("bytes belong to no frame of this protocol"), "{error}");
    }
}
