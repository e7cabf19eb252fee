//! A real instrument on a port, and the real table under it.
//!
//! A sample is delivered when its reading has come: the run goes as fast as the instrument. Damaged
//! frames are skipped, a gap stays a gap, and a silence ends the run. A driven table follows the
//! core's gimbal command; its angles are put into samples whose instrument has no valid angles of
//! its own.

mod arrival;
#[cfg(feature = "can")]
mod bus;
#[cfg(not(feature = "can"))]
#[path = "no_bus.rs"]
mod bus;
mod clock;
mod dates;
mod feed;
mod known_stamps;
mod pulses;
mod table;

use self::clock::{Clock, Reference};
use self::feed::Feed;
use self::known_stamps::KnownClock;
use self::pulses::Pulses;
pub use self::table::Table as BenchTable;
use self::table::Table;
use super::{Epoch, Source, SourceError};
use crate::described::port_decoder;
use crate::rate_check::RateCheck;
use crate::sampled::account;
use octant_account::{Account, AccountEntry, Weight};
use octant_base::number::plain;
use octant_instruments::{Sampler, SamplerSettings, Unusable};
use octant_plant::Truth;
use octant_recorder::event::{BenchReadings, BenchRecord};
use octant_sample::{GimbalCommand, Status};
use octant_scenario::{Instrument, Scenario, Speaks};
use std::path::Path;
use std::time::{Duration, Instant};

/// Longest wait in one poll of the port.
const WAIT: Duration = Duration::from_millis(50);

/// Shortest time, of the unit or of the host, that shows another pace, s, and the difference that does, as a share.
const PACED_S: f64 = 5.0;
const PACE_TOLERANCE: f64 = 0.05;

/// An instrument on a port.
#[derive(Debug)]
pub struct LiveSource {
    feed: Feed,
    instrument: Instrument,
    sampler: Sampler,
    rate: RateCheck,
    clock: Clock,
    table: Option<Table>,
    /// Turning rate of the procedure, rad/s.
    turning_radps: Option<f64>,
    total: u64,
    delivered: u64,
}

impl LiveSource {
    /// Opens the port of a scenario's instrument, and takes over its table if there is one.
    ///
    /// # Errors
    /// If a port can't be opened, or the table doesn't obey its commands.
    pub fn of(scenario: &Scenario, instrument: &Instrument) -> Result<Self, SourceError> {
        let (rate_hz, samples) = (scenario.sample_rate_hz, scenario.samples());
        let mut source = Self::open(instrument, &scenario.folder, rate_hz, samples)?;
        source.turning_radps = Some(scenario.turntable.rate_radps);
        if let Some(drive) = &scenario.drive {
            source.table = Some(Table::start(drive, &scenario.folder)?);
            source.forget()?;
        }
        Ok(source)
    }

    /// Checks that the files of a scenario can be used; opens nothing and moves nothing.
    ///
    /// # Errors
    /// If a file can't be read or isn't valid.
    pub fn check(scenario: &Scenario, instrument: &Instrument) -> Result<(), SourceError> {
        match &instrument.speaks {
            Speaks::Can(messages) => bus::check(messages, &scenario.folder)?,
            line => {
                port_decoder(line, instrument.count, &scenario.folder)?;
            }
        }
        match &scenario.drive {
            Some(drive) => drive.plan(&scenario.folder).map(drop).map_err(SourceError::Table),
            None => Ok(()),
        }
    }

    /// Opens the port of an instrument that will be asked for `samples` samples. Its file names are
    /// relative to `folder`.
    ///
    /// # Errors
    /// If the port can't be opened, or a file can't be used.
    pub fn open(
        instrument: &Instrument,
        folder: &Path,
        rate_hz: f64,
        samples: Option<u64>,
    ) -> Result<Self, SourceError> {
        let feed = Feed::open(instrument, folder)?;
        let settings = SamplerSettings { axes: instrument.axes, rate_hz };
        let gone = |reason| SourceError::Gone { uri: instrument.uri.to_string(), reason };
        let reference = match (&instrument.pulses, &instrument.known_stamps) {
            (Some(pulses), _) => {
                Reference::Pulses(Box::new(Pulses::open(pulses, folder).map_err(gone)?))
            }
            (None, Some(known)) => Reference::Scale(KnownClock::open(known, folder).map_err(gone)?),
            (None, None) => Reference::Arrivals,
        };
        Ok(Self {
            feed,
            instrument: instrument.clone(),
            sampler: Sampler::new(settings),
            rate: RateCheck::new(rate_hz),
            clock: Clock::new(reference, rate_hz),
            table: None,
            turning_radps: None,
            total: samples.unwrap_or(u64::MAX),
            delivered: 0,
        })
    }

    /// Returns the address at which the instrument reaches the port.
    #[must_use]
    pub fn reached_at(&self) -> String {
        self.feed.reached_at().unwrap_or_else(|| self.instrument.uri.to_string())
    }

    /// Discards data that came before the run: the run begins with the data that comes from now on.
    fn forget(&mut self) -> Result<(), SourceError> {
        let until = Instant::now() + WAIT;
        while Instant::now() < until {
            while self.feed.reading().is_some() {}
            let came = self.feed.receive(Duration::ZERO);
            if !came.map_err(|reason| self.gone(reason))? {
                break;
            }
        }
        while self.feed.reading().is_some() {}
        Ok(())
    }

    fn gone(&self, reason: String) -> SourceError {
        SourceError::Gone { uri: self.instrument.uri.to_string(), reason }
    }

    /// Entry of readings that came at another rate than they say, by the host's clock.
    fn pace(&self) -> AccountEntry {
        let pace = self.clock.pace(1.0 / self.sampler.rate_hz());
        pace.map_or(AccountEntry::fact(false, ""), |(own_s, arrived_s)| paced(own_s, arrived_s))
    }

    fn silent(&mut self) -> SourceError {
        let said = self.feed.said(&self.instrument.speaks.told());
        self.gone(format!(
            "no reading for {} s; received so far: {said}",
            self.instrument.silence_s
        ))
    }
}

/// Entry of a unit whose readings cover `own_s` and arrived in `arrived_s`; counts none where the two agree.
fn paced(own_s: f64, arrived_s: f64) -> AccountEntry {
    let times = own_s / arrived_s;
    let is_off = own_s.max(arrived_s) >= PACED_S && (times - 1.0).abs() > PACE_TOLERANCE;
    let kind = format!(
        "its time goes {} times as fast as the host's: {} s of it came in {} s",
        plain(times, 3),
        plain(own_s, 4),
        plain(arrived_s, 4)
    );
    AccountEntry::fact(is_off, kind).weight(Weight::Doubt)
}

impl Source for LiveSource {
    fn next(&mut self, command: &GimbalCommand, epoch: &mut Epoch) -> Result<bool, SourceError> {
        if self.delivered == self.total {
            return Ok(false);
        }
        if let Some(table) = &mut self.table {
            table.command(command)?;
        }
        let silence = Duration::from_secs_f64(self.instrument.silence_s);
        let mut until = Instant::now() + silence;
        loop {
            while let Some((mut reading, came)) = self.feed.reading() {
                self.rate.reading(&reading).map_err(|reason| self.gone(reason))?;
                let when =
                    self.clock.when(reading.stamp, came).map_err(|reason| self.gone(reason))?;
                let Some(when) = when else {
                    // The run begins once there are pulses enough to date a sample.
                    until = Instant::now() + silence;
                    continue;
                };
                let has_own =
                    reading.gimbal.is_some() && !reading.status.contains(Status::GIMBAL_INVALID);
                if !has_own && let Some(table) = &mut self.table {
                    reading.gimbal = table.angles(when);
                    reading.status.set(Status::GIMBAL_INVALID, reading.gimbal.is_none());
                }
                match self.sampler.sample(&reading, None) {
                    Ok(sample) => {
                        self.feed.hold_peer();
                        self.delivered += 1;
                        (epoch.sample, epoch.aiding) = (sample, None);
                        return Ok(true);
                    }
                    Err(Unusable::Behind) => {}
                    Err(unusable) => return Err(self.gone(unusable.to_string())),
                }
            }
            if let Some(table) = &self.table {
                table.check()?;
            }
            if Instant::now() >= until {
                return Err(self.silent());
            }
            let came = self.feed.receive(WAIT);
            came.map_err(|reason| self.gone(reason))?;
        }
    }

    fn truth(&self) -> Option<Truth> {
        None
    }

    fn samples_total(&self) -> Option<u64> {
        (self.total < u64::MAX).then_some(self.total)
    }

    fn accounts(&self) -> Vec<Account> {
        let name = self.instrument.uri.to_string();
        let outside = self.clock.outside();
        let account = account(&name, &self.sampler, self.feed.counters(), outside);
        vec![self.feed.losses(account).note(self.pace())]
    }

    fn is_live(&self) -> bool {
        true
    }

    fn conclude(
        &mut self,
        broken: Option<&str>,
    ) -> (Option<Box<BenchRecord>>, Option<SourceError>) {
        let table = self.table.take();
        // A run that has all its samples leaves the table to the others at it; one that ends early doesn't.
        let is_whole = broken.is_none() && self.delivered == self.total;
        let waited =
            table.as_ref().filter(|_| is_whole).and_then(|table| table.wait_for_others().err());
        let summary = table.as_ref().map(Table::summary);
        // The table is stopped before anything else is done.
        let ended = table.and_then(|table| table.end(broken).err());
        let ended = waited.or(ended);
        let counters = self.sampler.counters();
        let said = self.feed.said(&self.instrument.speaks.told());
        let (instruments_clock, clock) = self.clock.told().unzip();
        let looks_ms = summary.as_ref().map(|summary| summary.figures.angles.time_within_ms);
        let (samples_times, time) =
            self.clock.dated(self.turning_radps.map(f64::to_degrees), looks_ms);
        let (table, tables_angles, turntable) = match summary {
            Some(summary) => (Some(summary.figures), Some(summary.angles), Some(summary.table)),
            None => (None, None, None),
        };
        let bench = BenchRecord {
            clock,
            instrument: format!("{}: {said}", self.instrument.uri),
            instruments_clock,
            readings: BenchReadings {
                behind: counters.behind,
                irregular: counters.irregular,
                missing: counters.missing,
                samples: counters.samples,
            },
            samples_times: Some(samples_times),
            table,
            tables_angles,
            time: Some(time),
            turntable,
        };
        (Some(Box::new(bench)), ended)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use octant_instruments::{AnyEncoder, Axes, MeasuredTriad, Protocol, Reading, ReadingKind};
    use octant_instruments::{Stamp, StampClock, novatel};
    use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
    use std::net::UdpSocket;

    pub(crate) const PERIOD_NS: u64 = 5_000_000;
    const RATE_HZ: f64 = 200.0;

    pub(crate) fn sample(number: u64) -> Sample {
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
        source_with(protocol, None, samples)
    }

    fn source_with(
        protocol: Protocol,
        count: Option<novatel::CountScale>,
        samples: u64,
    ) -> (LiveSource, UdpSocket) {
        let uri = "udp:127.0.0.1:0".parse().unwrap();
        let speaks = Speaks::Bytes(protocol);
        let instrument = Instrument {
            uri,
            speaks,
            count,
            axes: Axes::SAME,
            silence_s: 0.3,
            pulses: None,
            known_stamps: None,
        };
        let source = LiveSource::open(&instrument, Path::new(""), RATE_HZ, Some(samples)).unwrap();
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
            // Garbage between two frames.
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
    fn a_described_unit_is_read_over_udp() {
        // A frame of a KVH 1750 in the unit test of a ROS driver.
        let frame: [u8; 36] = [
            0xFE, 0x81, 0xFF, 0x55, 0x37, 0xA9, 0x6A, 0x6E, 0x38, 0x58, 0x6C, 0x1F, 0xB7, 0x5B,
            0xF8, 0x62, 0xBF, 0x80, 0x3E, 0x78, 0xBB, 0x65, 0x0D, 0x28, 0x3B, 0x0A, 0x37, 0xAC,
            0x77, 0x3D, 0x00, 0x28, 0x4B, 0xFA, 0x34, 0xD8,
        ];
        let choice = octant_scenario::DescriptionChoice::Ready("kvh-1775-rate".to_owned());
        let instrument = Instrument {
            uri: "udp:127.0.0.1:0".parse().unwrap(),
            speaks: Speaks::Described(choice),
            count: None,
            axes: Axes::SAME,
            silence_s: 0.3,
            pulses: None,
            known_stamps: None,
        };
        let mut source = LiveSource::open(&instrument, Path::new(""), RATE_HZ, Some(2)).unwrap();
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.connect(source.reached_at().strip_prefix("udp:").unwrap()).unwrap();
        socket.send(&frame).unwrap();
        let mut epoch = Epoch::default();
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        // 2.019593e-5 rad/s over 5 ms in counts of 2^-36 rad; −1.0019064 g in counts of 2^-30 m/s.
        assert_eq!(epoch.sample.delta_theta[0], 6939);
        assert_eq!(epoch.sample.delta_velocity[0], -52_749_421);
        socket.send(&frame[..20]).unwrap();
        let error = source.next(&GimbalCommand::default(), &mut epoch).unwrap_err().to_string();
        assert!(
            error.contains("1 reading, 0 other frames of protocol described as kvh-1775-rate"),
            "{error}"
        );
    }

    #[test]
    fn a_unit_whose_time_goes_otherwise_than_the_hosts_is_a_doubt() {
        for (own_s, arrived_s, count) in
            [(50.0, 10.0, 1), (5.0, 10.0, 1), (60.0, 0.1, 1), (10.3, 10.0, 0), (4.0, 0.1, 0)]
        {
            let account =
                Account::new("udp", ["reading", "readings"]).note(paced(own_s, arrived_s));
            assert_eq!(
                account.doubts().len(),
                count,
                "{own_s} s in {arrived_s} s: {:?}",
                account.lines()
            );
        }
        let fast = Account::new("udp", ["reading", "readings"]).note(paced(50.0, 10.0));
        assert_eq!(
            fast.doubts(),
            ["udp: its time goes 5 times as fast as the host's: 50 s of it came in 10 s"]
        );
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
            "source udp:127.0.0.1:0 is gone: no reading for 0.3 s; received so far: 165 bytes, 3 \
             readings, 0 other frames of protocol vectornav, 0 frames with a wrong checksum; 15 bytes belong \
             to no frame of this protocol"
        );
    }

    #[test]
    fn bytes_without_a_reading_are_told_with_their_cause() {
        let (mut source, socket) = source(Protocol::NovAtel, 1000);
        // A KVH 1750, whose scale isn't in the maker's table.
        let scale = novatel::scale_of(58).unwrap();
        let mut encoder = novatel::NovatelEncoder::new(33, scale);
        let stamp = Some(Stamp { ns: 5_000_000, clock: StampClock::Gps });
        let reading = Reading { stamp, ..Reading::of_sample(&sample(1)) };
        for _ in 0..3 {
            socket.send(encoder.encode(&reading).unwrap()).unwrap();
        }
        // The start of a log with the long header.
        socket.send(b"\xaa\x44\x12\x1c").unwrap();
        let mut epoch = Epoch::default();
        let error = source.next(&GimbalCommand::default(), &mut epoch).unwrap_err().to_string();
        assert_eq!(
            error,
            "source udp:127.0.0.1:0 is gone: no reading for 0.3 s; received so far: 172 bytes, 0 \
             readings, 0 other frames of protocol novatel, 0 frames with a wrong checksum, 3 frames that \
             can't be read, the first: the frame is intact, but its IMU type 33 isn't known (with \
             source.live.gyro_count and accel_count it is read); 4 bytes belong to no frame of this \
             protocol"
        );
    }

    #[test]
    fn counts_of_a_unit_that_is_in_no_table_have_the_given_size() {
        // A tenth of an arcsecond in 8 more bits; 0.05 m/s in 15 bits.
        let rotation_rad = 0.1 / 256.0 / 3600.0 * std::f64::consts::PI / 180.0;
        let scale = novatel::CountScale { rotation_rad, velocity_mps: 0.05 / 32768.0 };
        let (mut source, socket) = source_with(Protocol::NovAtel, Some(scale), 1);
        // Kind 33 of the log, counts z, -y, x; the CRC is the encoder's.
        let mut encoder = novatel::NovatelEncoder::new(33, scale);
        let stamp = Some(Stamp { ns: 5_000_000, clock: StampClock::Gps });
        let triad = |counts, lsb| Some(MeasuredTriad::counts(ReadingKind::Increment, counts, lsb));
        let reading = Reading {
            rotation: triad([4000, -5, 6], scale.rotation_rad),
            velocity: triad([7, 8, -32_000], scale.velocity_mps),
            stamp,
            ..Reading::NOTHING
        };
        socket.send(encoder.encode(&reading).unwrap()).unwrap();
        let mut epoch = Epoch::default();
        assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        // 4000 tenths of 256ths of an arcsecond are 7.5752e-6 rad, in counts of 2^-36 rad; 32 000 of
        // 32 768 parts of 0.05 m/s in counts of 2^-30 m/s.
        let turned = (7.575_213_8e-6 * 2f64.powi(36)).round() as i32;
        assert!((epoch.sample.delta_theta[0] - turned).abs() <= 1, "{:?}", epoch.sample);
        let fell = (-0.048_828_125 * 2f64.powi(30)).round() as i32;
        assert!((epoch.sample.delta_velocity[2] - fell).abs() <= 1, "{:?}", epoch.sample);
    }
}
