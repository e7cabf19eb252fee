//! Stamps by a time scale that a clock of the host has too.

use super::arrival::Arrival;
use octant_instruments::{Stamp, StampClock, StampScale};
use octant_realtime::hardware_clock::HardwareClock;
use octant_realtime::host_clocks::HostClocks;
use octant_realtime::kernel_clock::KernelClock;
use octant_scenario::KnownStamps;
use std::path::Path;
use std::time::{Duration, Instant};

/// Pause between two questions for the state of the kernel's clock.
const ASKED_EVERY: Duration = Duration::from_secs(1);
/// Longest delay of a line. Beyond it the scale is another one: scales differ by seconds.
const DELAY_MOST_S: f64 = 0.5;
/// Time by which a stamp may be after its arrival before the scale is another one: more than the bounds
/// of clocks, which [`super::dates`] judges.
const EARLY_MOST_S: f64 = 0.25;
/// Largest difference of rates of a network card's clock and the monotonic one: 0.05 % by which the
/// kernel may slew, and 0.01 % of crystals.
const RATE_DIFFERENCE_MOST: f64 = 6e-4;

/// Time between two looks at the rate of a network card's clock, s.
const RATE_LOOKED_EVERY_S: f64 = 1.0;

/// Clock of the host to which stamps are related.
#[derive(Debug)]
enum HostClock {
    /// The realtime clock: UTC.
    Realtime,
    /// Clock of a network card: TAI.
    Hardware(HardwareClock),
}

/// Dates readings by their stamps.
#[derive(Debug)]
pub(super) struct KnownClock {
    plan: KnownStamps,
    host: HostClock,
    host_within: Duration,
    tai_offset_s: u32,
    asked: Instant,
    /// Reading of the clocks with which the next one is compared.
    last: Option<HostClocks>,
}

/// Time of a reading, and the bound of its error.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownTime {
    pub(super) at: Instant,
    pub(super) within: Duration,
    /// Time from it to the arrival of its reading; negative: it arrived before.
    pub(super) delay_s: f64,
}

impl KnownClock {
    /// Opens the host's clock. A device that isn't absolute is relative to `folder`.
    pub(super) fn open(plan: &KnownStamps, folder: &Path) -> Result<Self, String> {
        let host = match &plan.host_clock {
            None => HostClock::Realtime,
            Some(path) => {
                let clock = HardwareClock::open(&folder.join(path));
                HostClock::Hardware(
                    clock.map_err(|error| format!("source.live.host_clock: {error}"))?,
                )
            }
        };
        Self::with(plan, host, KernelClock::read())
    }

    fn with(
        plan: &KnownStamps,
        host: HostClock,
        kernel: std::io::Result<KernelClock>,
    ) -> Result<Self, String> {
        let mut clock = Self {
            plan: plan.clone(),
            host,
            host_within: Duration::ZERO,
            tai_offset_s: 0,
            asked: Instant::now(),
            last: None,
        };
        clock.ask(kernel)?;
        Ok(clock)
    }

    /// Origin of the times: the scale, and the clock if it isn't the realtime one.
    pub(super) fn origin(&self) -> String {
        let scale = self.plan.scale.name();
        match &self.plan.host_clock {
            None => format!("stamps ({scale})"),
            Some(path) => format!("stamps ({scale}, {path})"),
        }
    }

    /// True if the offset between TAI and UTC counts: between stamps and a clock of different scales.
    const fn needs_offset(&self) -> bool {
        match self.host {
            HostClock::Realtime => !matches!(self.plan.scale, StampScale::Utc),
            HostClock::Hardware(_) => matches!(self.plan.scale, StampScale::Utc),
        }
    }

    /// Takes the kernel's state of its clock, where the scenario doesn't say it.
    fn ask(&mut self, kernel: std::io::Result<KernelClock>) -> Result<(), String> {
        self.asked = Instant::now();
        if let Some(within_s) = self.plan.host_within_s {
            self.host_within = Duration::from_secs_f64(within_s);
        }
        if let Some(offset_s) = self.plan.tai_offset_s {
            self.tai_offset_s = offset_s;
        }
        let needs_offset = self.plan.tai_offset_s.is_none() && self.needs_offset();
        if self.plan.host_within_s.is_some() && !needs_offset {
            return Ok(());
        }
        let kernel = kernel.map_err(|reason| {
            format!("source.live.stamps: failed to ask the kernel for its clock: {reason}")
        })?;
        if self.plan.host_within_s.is_none() {
            if !kernel.is_synchronised {
                let message = "source.live.stamps: found the host's realtime clock unsynchronised, expected one \
                               that NTP or PTP keeps set, or source.live.host_within with the bound of its \
                               error";
                return Err(message.to_owned());
            }
            self.host_within = kernel.error_most;
        }
        if needs_offset {
            if kernel.tai_offset_s == 0 {
                return Err(format!(
                    "source.live.stamps: found no offset of TAI in the kernel, expected one for {:?}, or \
                     source.live.tai_offset",
                    self.plan.scale.name()
                ));
            }
            self.tai_offset_s = kernel.tai_offset_s;
        }
        Ok(())
    }

    /// Reads the host's clock, and judges whether it was set.
    fn clocks(&mut self) -> Result<HostClocks, String> {
        match &self.host {
            HostClock::Hardware(clock) => {
                let clocks =
                    clock.read().map_err(|error| format!("source.live.host_clock: {error}"))?;
                let last = *self.last.get_or_insert(clocks);
                let seconds = (clocks.monotonic - last.monotonic).as_secs_f64();
                if seconds > RATE_LOOKED_EVERY_S {
                    self.last = Some(clocks);
                    let apart_s = (clocks.other_ns - last.other_ns) as f64 * 1e-9 - seconds;
                    let allowed_s = RATE_DIFFERENCE_MOST * seconds
                        + (clocks.within + last.within).as_secs_f64()
                        + 2.0 * self.host_within.as_secs_f64();
                    if apart_s.abs() > allowed_s {
                        return Err(format!(
                            "source.live.host_clock: found a clock that went {:.6} s in {seconds:.6} s, expected \
                             as many within {:.3} ms: it stands, was set, or nobody keeps it",
                            seconds + apart_s,
                            allowed_s * 1e3
                        ));
                    }
                }
                Ok(clocks)
            }
            HostClock::Realtime => {
                let clocks = HostClocks::read();
                let last = self.last.replace(clocks);
                let step_ns = last.and_then(|last| clocks.step_since_ns(&last)).unwrap_or(0);
                if step_ns.unsigned_abs() > self.host_within.as_nanos() {
                    return Err(format!(
                        "source.live.stamps: found the host's realtime clock set by {:+.3} ms, expected \
                         steps within the bound of its error, {:.3} ms",
                        step_ns as f64 * 1e-6,
                        self.host_within.as_secs_f64() * 1e3
                    ));
                }
                Ok(clocks)
            }
        }
    }

    /// Time of a stamp whose reading arrived.
    pub(super) fn when(&mut self, stamp: Stamp, came: Arrival) -> Result<KnownTime, String> {
        if stamp.clock == StampClock::Gps && self.plan.scale != StampScale::Gps {
            return Err(format!(
                "source.live.stamps: found {:?}, expected \"gps\": this protocol's stamps are GPS time",
                self.plan.scale.name()
            ));
        }
        if self.asked.elapsed() > ASKED_EVERY {
            self.ask(KernelClock::read())?;
        }
        let clocks = self.clocks()?;
        let stamp_ns = match &self.host {
            HostClock::Realtime => self.plan.scale.utc_ns(stamp.ns, self.tai_offset_s),
            HostClock::Hardware(_) => self.plan.scale.tai_ns(stamp.ns, self.tai_offset_s),
        };
        let before_ns = match clocks.monotonic.checked_duration_since(came.at) {
            Some(before) => before.as_nanos() as i128,
            None => -((came.at - clocks.monotonic).as_nanos() as i128),
        };
        let delay_s = (clocks.other_ns - before_ns - stamp_ns) as f64 * 1e-9;
        let drift_s = match self.host {
            HostClock::Realtime => 0.0,
            HostClock::Hardware(_) => {
                (clocks.other_ns - stamp_ns) as f64 * 1e-9 * RATE_DIFFERENCE_MOST
            }
        };
        let at = clocks.at(stamp_ns);
        let Some(at) = at.filter(|_| (-EARLY_MOST_S..=DELAY_MOST_S).contains(&delay_s)) else {
            let side = if delay_s < 0.0 { "after" } else { "before" };
            return Err(format!(
                "source.live.stamps: found a stamp {:.3} s {side} its arrival by {:?}, expected at most \
                 {DELAY_MOST_S} s before: the stamps have another scale, or the clocks differ",
                delay_s.abs(),
                self.plan.scale.name()
            ));
        };
        let given_s = self.plan.within_s + drift_s.abs();
        let within = Duration::from_secs_f64(given_s) + self.host_within + clocks.within;
        Ok(KnownTime { at, within, delay_s })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::live::LiveSource;
    use crate::{Epoch, Source};
    use octant_instruments::Axes;
    use octant_realtime::host_clocks::since_1970_ns;
    use octant_sample::GimbalCommand;
    use octant_scenario::{DescriptionChoice, FileName, Instrument, Speaks};
    use std::net::UdpSocket;
    use std::time::SystemTime;

    const SECOND_NS: i128 = 1_000_000_000;
    const SET: KernelClock = KernelClock {
        is_synchronised: true,
        error_most: Duration::from_micros(300),
        tai_offset_s: 37,
    };

    fn plan(scale: StampScale) -> KnownStamps {
        KnownStamps {
            scale,
            within_s: 50e-6,
            host_clock: None,
            host_within_s: None,
            tai_offset_s: None,
        }
    }

    fn clock(plan: &KnownStamps, kernel: KernelClock) -> Result<KnownClock, String> {
        KnownClock::with(plan, HostClock::Realtime, Ok(kernel))
    }

    fn stamp(ns: i128) -> Stamp {
        Stamp { ns: u64::try_from(ns).unwrap(), clock: StampClock::Startup }
    }

    #[test]
    fn a_stamp_by_a_known_scale_is_the_time_itself() {
        let ahead_s = [
            (StampScale::Utc, 0),
            (StampScale::Tai, 37),
            // GPS time began with 1980-01-06 and is 18 s ahead of UTC where TAI is 37 s.
            (StampScale::Gps, 18 - 315_964_800),
        ];
        // The given bound and the kernel's are 350 µs. The rest is the reading of both clocks, between which a busy
        // host may do something else: then they are read again.
        let read = |scale, ahead_s: i128| {
            let mut clock = clock(&plan(scale), SET).unwrap();
            let made = Instant::now();
            let ns = since_1970_ns(SystemTime::now()) + ahead_s * SECOND_NS;
            let after = Instant::now();
            let came = Arrival::read(made + Duration::from_millis(2));
            let time = clock.when(stamp(ns), came).unwrap();
            assert!(time.at + time.within >= made && time.at <= after + time.within, "{scale:?}");
            assert!((time.delay_s - 2e-3).abs() < (after - made).as_secs_f64() + 1e-3, "{time:?}");
            let error = clock.when(stamp(ns - SECOND_NS), came).unwrap_err();
            assert!(error.contains("another scale"), "{error}");
            time.within - Duration::from_micros(350)
        };
        for (scale, ahead_s) in ahead_s {
            let least = (0..100).map(|_| read(scale, ahead_s)).min().unwrap();
            assert!(least > Duration::ZERO && least < Duration::from_millis(5), "{least:?}");
        }
    }

    #[test]
    fn a_clock_that_nobody_sets_and_an_unknown_offset_are_refused() {
        let unset = KernelClock { is_synchronised: false, ..SET };
        let error = clock(&plan(StampScale::Utc), unset).unwrap_err();
        assert!(error.contains("found the host's realtime clock unsynchronised"), "{error}");
        let given = KnownStamps { host_within_s: Some(1e-6), ..plan(StampScale::Utc) };
        assert_eq!(clock(&given, unset).unwrap().host_within, Duration::from_micros(1));
        let unknown = KernelClock { tai_offset_s: 0, ..SET };
        assert!(clock(&plan(StampScale::Utc), unknown).is_ok());
        let error = clock(&plan(StampScale::Gps), unknown).unwrap_err();
        assert!(error.contains("found no offset of TAI in the kernel"), "{error}");
        let given = KnownStamps { tai_offset_s: Some(37), ..plan(StampScale::Gps) };
        assert_eq!(clock(&given, unknown).unwrap().tai_offset_s, 37);
    }

    #[test]
    fn a_realtime_clock_that_is_set_and_stamps_of_another_scale_end_the_run() {
        let mut clock = clock(&plan(StampScale::Tai), SET).unwrap();
        let now = HostClocks::read();
        clock.last = Some(HostClocks { other_ns: now.other_ns - 20_000_000, ..now });
        let ns = now.other_ns + 37 * SECOND_NS;
        let error = clock.when(stamp(ns), Arrival::read(Instant::now())).unwrap_err();
        assert!(error.contains("set by +20.0"), "{error}");
        let of_gps = Stamp { clock: StampClock::Gps, ..stamp(ns) };
        let error = clock.when(of_gps, Arrival::read(Instant::now())).unwrap_err();
        assert!(error.contains("found \"tai\", expected \"gps\""), "{error}");
    }

    /// A unit whose description has a field of UTC, on a line that takes 20 ms.
    #[test]
    fn stamps_by_utc_are_the_times_and_show_the_lines_delay() {
        let folder = tempfile::tempdir().unwrap();
        let fields = ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"]
            .iter()
            .enumerate()
            .map(|(k, name)| {
                let unit = if k < 3 { "rad/s" } else { "m/s2" };
                format!(
                    "{{ is = {name:?}, at = {}, type = \"f32\", unit = {unit:?} }},",
                    10 + 4 * k
                )
            })
            .collect::<String>();
        let description = format!(
            "version = 1\nname = \"unit\"\nbyte_order = \"little\"\n[checksum]\nkind = \"none\"\n[[frame]]\n\
             sync = [80, 84]\nlength = 34\nfield = [{{ is = \"stamp\", at = 2, type = \"u64\", unit = \"ns\" }},{fields}]\n"
        );
        std::fs::write(folder.path().join("unit.toml"), description).unwrap();
        let file = FileName("unit.toml".to_owned());
        let speaks = Speaks::Described(DescriptionChoice::File(file));
        let known_stamps = Some(KnownStamps {
            scale: StampScale::Utc,
            within_s: 10e-6,
            host_clock: None,
            host_within_s: Some(5e-6),
            tai_offset_s: None,
        });
        let (uri, axes) = ("udp:127.0.0.1:0".parse().unwrap(), Axes::SAME);
        let instrument = Instrument {
            uri,
            speaks,
            count: None,
            axes,
            silence_s: 60.0,
            pulses: None,
            known_stamps,
        };
        let mut source = LiveSource::open(&instrument, folder.path(), 10.0, Some(5)).unwrap();
        source.turning_radps = Some(10f64.to_radians());
        let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
        socket.connect(source.reached_at().strip_prefix("udp:").unwrap()).unwrap();
        let mut epoch = Epoch::default();
        let mut sent_ms = f64::INFINITY;
        for _ in 0..5 {
            let made = Instant::now();
            let now = since_1970_ns(SystemTime::now());
            let mut frame = [0; 34];
            frame[..2].copy_from_slice(b"PT");
            frame[2..10].copy_from_slice(&u64::try_from(now).unwrap().to_le_bytes());
            std::thread::sleep(Duration::from_millis(20));
            socket.send(&frame).unwrap();
            sent_ms = sent_ms.min(made.elapsed().as_secs_f64() * 1e3);
            std::thread::sleep(Duration::from_millis(80));
            assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
        }
        let (bench, ended) = source.conclude(None);
        assert!(ended.is_none());
        let time = bench.unwrap().time.unwrap();
        assert_eq!(time.origin, "stamps (utc)");
        let (within_us, delay) = (time.within_us.unwrap(), time.line_delay.unwrap());
        // A busy host reads the clocks less exactly.
        assert!((15.0..20_000.0).contains(&within_us), "{within_us}");
        // The time of arrival, not that of the reading 80 ms later.
        assert!((20.0..sent_ms + 80.0).contains(&delay.least_ms), "{delay:?} {sent_ms}");
        assert_eq!(delay.early, 0);
        // 36 arcseconds a millisecond.
        assert!((time.angle_within_arcsec.unwrap() - 0.036 * within_us).abs() < 1e-9);
    }
}
