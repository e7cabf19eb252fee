//! A real instrument on a port, as it sends.
//!
//! A sample is delivered when its reading has come: the run goes as fast as the instrument. What the
//! line damaged is looked over, a gap stays one, and a silence ends the run.

use super::{Epoch, Source, SourceError};
use crate::scenario::Instrument;
use octant_instruments::{AnyDecoder, Event, Sampler, Settings, Unusable};
use octant_link::port::{self, Bytes, Port};
use octant_plant::Truth;
use octant_sample::GimbalCommand;
use octant_wire::Role;
use std::time::{Duration, Instant};

/// How long one look at the port waits.
const WAIT: Duration = Duration::from_millis(50);

/// An instrument on a port.
#[derive(Debug)]
pub struct LiveSource {
    port: Box<dyn Bytes>,
    instrument: Instrument,
    decoder: AnyDecoder,
    sampler: Sampler,
    buffer: Box<[u8; 4096]>,
    /// What of the buffer was not decoded yet.
    rest: std::ops::Range<usize>,
    total: u64,
    delivered: u64,
}

impl LiveSource {
    /// Opens the port of an instrument, which will be asked for so many samples.
    ///
    /// # Errors
    /// If the port can't be opened, or carries no bytes.
    pub fn open(
        instrument: &Instrument,
        sample_period_ns: u64,
        samples: Option<u64>,
    ) -> Result<Self, SourceError> {
        let gone = |reason: String| SourceError::Gone { uri: instrument.uri.to_string(), reason };
        // It waits for who sends, as a device does.
        let port = match port::open(&instrument.uri, Role::Device) {
            Ok(Port::Bytes(port)) => port,
            Ok(Port::Frames(_)) => return Err(gone("it carries no bytes".to_owned())),
            Err(error) => return Err(gone(error.to_string())),
        };
        let settings = Settings { axes: instrument.axes, period_ns: sample_period_ns };
        Ok(Self {
            port,
            decoder: AnyDecoder::new(instrument.protocol),
            instrument: instrument.clone(),
            sampler: Sampler::new(settings),
            buffer: Box::new([0; 4096]),
            rest: 0..0,
            total: samples.unwrap_or(u64::MAX),
            delivered: 0,
        })
    }

    /// The name by which the instrument reaches the port.
    #[must_use]
    pub fn reached_at(&self) -> String {
        self.port.reached_at()
    }

    /// What the decoder says of the bytes that are there.
    fn decoded(&mut self) -> Option<Event> {
        let mut bytes = &self.buffer[self.rest.clone()];
        let event = self.decoder.next(&mut bytes);
        self.rest.start = self.rest.end - bytes.len();
        // A frame doesn't go on in the next datagram.
        if event.is_none() && self.port.datagrams() { self.decoder.end() } else { event }
    }

    fn gone(&self, reason: String) -> SourceError {
        SourceError::Gone { uri: self.instrument.uri.to_string(), reason }
    }

    fn silent(&self) -> SourceError {
        let counters = self.decoder.counters();
        self.gone(format!(
            "no reading for {} s; so far {} bytes came, {} readings, {} other frames of protocol {}, \
             and {} with another checksum",
            self.instrument.silence_s,
            counters.bytes,
            counters.readings,
            counters.other,
            self.instrument.protocol.name(),
            counters.checksum,
        ))
    }
}

impl Source for LiveSource {
    fn next(&mut self, _command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        if self.delivered == self.total {
            return Ok(false);
        }
        let until = Instant::now() + Duration::from_secs_f64(self.instrument.silence_s);
        loop {
            while let Some(event) = self.decoded() {
                let Event::Reading(reading) = event else { continue };
                match self.sampler.sample(&reading, None) {
                    Ok(sample) => {
                        // From now on nobody else is heard.
                        self.port.hold_peer(true);
                        self.delivered += 1;
                        (epoch.sample, epoch.aiding) = (sample, None);
                        return Ok(true);
                    }
                    Err(Unusable::Behind) => {}
                    Err(unusable) => return Err(self.gone(unusable.to_string())),
                }
            }
            if Instant::now() >= until {
                return Err(self.silent());
            }
            let came = self.port.receive(&mut self.buffer[..], WAIT);
            self.rest = 0..came.map_err(|error| self.gone(error.to_string()))?;
        }
    }

    fn truth(&self) -> Option<Truth> {
        None
    }

    fn samples_total(&self) -> Option<u64> {
        (self.total < u64::MAX).then_some(self.total)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_instruments::{AnyEncoder, Axes, Protocol, Reading};
    use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
    use std::net::UdpSocket;

    const PERIOD_NS: u64 = 5_000_000;

    fn sample(number: u64) -> Sample {
        let k = number as i32;
        Sample {
            sequence: number,
            device_time: DeviceTime { ns: number * PERIOD_NS },
            delta_theta: [17_000 + k, -k, 3],
            delta_velocity: [k, 40 - k, -52_600_000],
            gimbal: GimbalAngles { azimuth: 5, roll: -k },
            status: Status::empty(),
        }
    }

    fn source(protocol: Protocol, samples: u64) -> (LiveSource, UdpSocket) {
        let uri = "udp:127.0.0.1:0".parse().unwrap();
        let instrument = Instrument { uri, protocol, axes: Axes::SAME, silence_s: 0.3 };
        let source = LiveSource::open(&instrument, PERIOD_NS, Some(samples)).unwrap();
        let address = source.reached_at();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.connect(address.strip_prefix("udp:").unwrap()).unwrap();
        (source, socket)
    }

    #[test]
    fn samples_of_our_own_wire_arrive_to_the_last_bit() {
        let (mut source, socket) = source(Protocol::Octant, 20);
        let mut encoder = AnyEncoder::new(Protocol::Octant);
        for number in 1..=20 {
            let frame = encoder.encode(&Reading::of_sample(&sample(number))).unwrap();
            socket.send(frame).unwrap();
            // Between two of them there is garbage.
            socket.send(&[0xA5; 40]).unwrap();
        }
        let mut epoch = Epoch::default();
        for number in 1..=20 {
            assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
            assert_eq!((epoch.sample, epoch.aiding), (sample(number), None));
        }
        assert!(!source.next(&GimbalCommand::default(), &mut epoch).unwrap());
    }

    #[test]
    fn a_gap_stays_one_and_a_silence_ends_it() {
        let (mut source, socket) = source(Protocol::VectorNav, 1000);
        let mut encoder = AnyEncoder::new(Protocol::VectorNav);
        for number in [1, 2, 5] {
            let reading =
                Reading { interval_s: Some(0.005), ..Reading::of_sample(&sample(number)) };
            socket.send(encoder.encode(&reading).unwrap()).unwrap();
        }
        let mut epoch = Epoch::default();
        for number in [1, 2, 5] {
            assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
            assert_eq!(epoch.sample.sequence, number);
            assert_eq!(epoch.sample.device_time.ns, number * PERIOD_NS);
            assert_eq!(epoch.sample.status, Status::GIMBAL_INVALID);
        }
        socket.send(b"no frame at all").unwrap();
        let error = source.next(&GimbalCommand::default(), &mut epoch).unwrap_err().to_string();
        assert_eq!(
            error,
            "source udp:127.0.0.1:0 is gone: no reading for 0.3 s; so far 165 bytes came, 3 readings, 0 \
             other frames of protocol vectornav, and 0 with another checksum"
        );
    }
}
