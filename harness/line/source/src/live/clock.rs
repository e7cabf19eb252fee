//! Relates the instrument's clock to the host's.

use super::arrival::Arrival;
use super::dates::Dates;
use super::known_stamps::KnownClock;
use super::pulses::Pulses;
use octant_account::OutsideClock;
use octant_instruments::Stamp;
use octant_instruments::align::ClockAlignment;
use octant_recorder::event::{BenchClock, BenchTime};
use std::time::{Duration, Instant, SystemTime};

/// Host time at which the alignment starts, ns: an hour above zero, so that slightly earlier events
/// have a time too.
const BASE_NS: u64 = 3_600_000_000_000;

/// Standard deviation of the rate of a host's clock, ppm: of a crystal without temperature compensation.
const HOST_PPM: f64 = 20.0;

/// Estimates when, on the host's clock, a reading was made.
#[derive(Debug)]
pub(super) struct Clock {
    base: Instant,
    utc: SystemTime,
    alignment: ClockAlignment,
    /// Of readings without stamps: their count at the configured rate in place of the stamps.
    counted: ClockAlignment,
    period_ns: f64,
    reference: Reference,
    dates: Dates,
    span: Span,
}

/// Host time of an instant, ns.
fn host_ns(base: Instant, at: Instant) -> u64 {
    let since = at.saturating_duration_since(base).as_nanos();
    BASE_NS.saturating_add(u64::try_from(since).unwrap_or(u64::MAX))
}

/// First and last arrivals and stamps, and the number of readings.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    arrivals: Option<(Instant, Instant)>,
    stamps: Option<(u64, u64)>,
    readings: u64,
}

/// Relation between stamps and the host's clock.
#[derive(Debug)]
pub(super) enum Reference {
    /// Arrivals alone.
    Arrivals,
    /// Pulses at the whole seconds of the stamps.
    Pulses(Box<Pulses>),
    /// The time scale of the stamps.
    Scale(KnownClock),
}

impl Clock {
    /// Creates the clock of a unit at a configured rate, Hz.
    pub(super) fn new(reference: Reference, rate_hz: f64) -> Self {
        Self {
            base: Instant::now(),
            utc: SystemTime::now(),
            alignment: ClockAlignment::new(),
            counted: ClockAlignment::new(),
            period_ns: 1e9 / rate_hz,
            reference,
            dates: Dates::default(),
            span: Span::default(),
        }
    }

    /// Returns when the interval of a reading ended: from its stamp by the time scale, by the clock
    /// relation of pulses, or by that of arrivals, with the least delay of the line; without a stamp, the
    /// time of arrival. `None`: there are too few pulses yet.
    pub(super) fn when(
        &mut self,
        stamp: Option<Stamp>,
        came: Arrival,
    ) -> Result<Option<Instant>, String> {
        self.dates.came(came);
        self.span.readings += 1;
        let (first, _) = self.span.arrivals.unwrap_or((came.at, came.at));
        self.span.arrivals = Some((first, came.at));
        if let Some(stamp) = stamp {
            let (first, _) = self.span.stamps.unwrap_or((stamp.ns, stamp.ns));
            self.span.stamps = Some((first, stamp.ns));
        }
        let Some(stamp) = stamp else {
            let needed = match &self.reference {
                Reference::Arrivals => {
                    // Its count at the configured rate is the only time that the unit has.
                    let own_ns = self.span.readings as f64 * self.period_ns;
                    self.counted.add(own_ns.round() as u64, host_ns(self.base, came.at));
                    return Ok(Some(came.at));
                }
                Reference::Pulses(_) => "source.live.pps",
                Reference::Scale(_) => "source.live.stamps",
            };
            return Err(format!(
                "found a reading without a stamp, expected one on each: {needed} dates readings by their \
                 stamps"
            ));
        };
        let base = self.base;
        let host_ns = |at: Instant| host_ns(base, at);
        self.alignment.add(stamp.ns, host_ns(came.at));
        if let Reference::Scale(known) = &mut self.reference {
            let time = known.when(stamp, came)?;
            self.dates.dated(time.delay_s * 1e9, time.within.as_secs_f64() * 1e9);
            return Ok(Some(time.at));
        }
        let Some(arrivals) = self.alignment.estimate() else { return Ok(Some(came.at)) };
        let Reference::Pulses(pulses) = &mut self.reference else {
            // A reading can't be made after it arrived.
            let when = self.instant(arrivals.host_ns(stamp.ns));
            return Ok(Some(when.map_or(came.at, |when| when.min(came.at))));
        };
        let Some(line) = pulses.take(&arrivals, came.at, host_ns)? else { return Ok(None) };
        let at_ns = line.host_ns(stamp.ns);
        let within_ns = line.within_ns(stamp.ns) + pulses.within().as_secs_f64() * 1e9;
        self.dates.dated(host_ns(came.at) as f64 - at_ns, within_ns);
        Ok(Some(self.instant(at_ns).unwrap_or(came.at)))
    }

    /// Instant of a host time.
    fn instant(&self, host_ns: f64) -> Option<Instant> {
        let since_ns = host_ns - BASE_NS as f64;
        if !since_ns.is_finite() {
            return None;
        }
        let since = Duration::from_secs_f64((since_ns.abs() * 1e-9).min(1e9));
        if since_ns < 0.0 { self.base.checked_sub(since) } else { self.base.checked_add(since) }
    }

    /// Describes origin and uncertainty of the times in words and figures, at a turning rate and with
    /// looks of the table within so much.
    pub(super) fn dated(
        &self,
        rate_degps: Option<f64>,
        looks_ms: Option<f64>,
    ) -> (String, BenchTime) {
        let (pulses, stamps) = match &self.reference {
            Reference::Arrivals => (None, None),
            Reference::Pulses(pulses) => (Some(pulses.told()), None),
            Reference::Scale(known) => (None, Some(known.origin())),
        };
        self.dates.told(pulses, stamps, rate_degps, looks_ms)
    }

    /// Time that passed by the readings' stamps, or by their number where they have none, and time that passed between
    /// their arrivals, s.
    pub(super) fn pace(&self, period_s: f64) -> Option<(f64, f64)> {
        let (first, last) = self.span.arrivals?;
        let own_s = match self.span.stamps {
            Some((first, last)) => last.saturating_sub(first) as f64 * 1e-9,
            None => self.span.readings.saturating_sub(1) as f64 * period_s,
        };
        Some((own_s, last.saturating_duration_since(first).as_secs_f64()))
    }

    /// Clock of the unit's stamps against the pulses, else against the host's by arrivals.
    pub(super) fn outside(&self) -> Option<OutsideClock> {
        if let Reference::Pulses(pulses) = &self.reference
            && let Some(skew_ppm) = pulses.told().skew_ppm
        {
            let sigma_ppm = None;
            return Some(OutsideClock {
                name: "its pulses".to_owned(),
                fast_ppm: -skew_ppm,
                sigma_ppm,
            });
        }
        let (estimate, name) = match self.alignment.estimate() {
            Some(estimate) => (estimate, "the host's clock, by arrivals"),
            None => (
                self.counted.estimate()?,
                "the host's clock, by the arrivals of readings that have no stamps",
            ),
        };
        // A corner of the hull may be as late as the others are; the host's own clock is a crystal.
        let arrivals_ppm = 1e-3 * estimate.late_mean_ns / estimate.span_s;
        Some(OutsideClock {
            name: name.to_owned(),
            fast_ppm: -1e6 * estimate.skew?,
            sigma_ppm: Some(arrivals_ppm.hypot(HOST_PPM)),
        })
    }

    /// Describes the clock relation in words and figures; `None` without stamps.
    pub(super) fn told(&self) -> Option<(String, BenchClock)> {
        let estimate = self.alignment.estimate()?;
        let since_ns = estimate.offset_ns - BASE_NS as f64;
        let since = Duration::from_secs_f64((since_ns.abs() * 1e-9).min(1e9));
        let first =
            if since_ns < 0.0 { self.utc.checked_sub(since) } else { self.utc.checked_add(since) };
        let first = first.map(octant_base::utc::nanos);
        let skew =
            estimate.skew.map_or("unknown".to_owned(), |skew| format!("{:+.3} ppm", skew * 1e6));
        let words = format!(
            "host faster by {skew} over {:.1} s; readings arrived {:.3} ms after the earliest, \
             1σ {:.3} ms",
            estimate.span_s,
            estimate.late_mean_ns * 1e-6,
            estimate.late_sigma_ns * 1e-6,
        );
        let figures = BenchClock {
            first_stamp_ns: estimate.origin_ns,
            first_stamp_utc: first,
            late_mean_us: estimate.late_mean_ns * 1e-3,
            late_sigma_us: estimate.late_sigma_ns * 1e-3,
            skew_ppm: estimate.skew.map(|skew| skew * 1e6),
            span_s: estimate.span_s,
            stamps: estimate.readings,
            stamps_behind: estimate.behind,
        };
        Some((words, figures))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octant_instruments::StampClock;
    use octant_realtime::host_clocks::HostClocks;
    use octant_scenario::UnitPulses;

    fn stamp(ns: u64) -> Option<Stamp> {
        Some(Stamp { ns, clock: StampClock::Startup })
    }

    /// The clock of this instrument is slow by 100 ppm. One reading in four comes without delay,
    /// the others come 2 ms later; each must be dated as if it had come without delay.
    #[test]
    fn a_reading_that_came_late_was_made_when_it_was_made() {
        let mut clock = Clock::new(Reference::Arrivals, 200.0);
        let mut worst = Duration::ZERO;
        for number in 0..2000u64 {
            let true_at = clock.base + Duration::from_nanos(7_000_000 + number * 5_000_500);
            let late = Duration::from_millis(if number % 4 == 0 { 0 } else { 2 });
            let came = Arrival::read(true_at + late);
            let when = clock.when(stamp(90_000 + number * 5_000_000), came).unwrap().unwrap();
            if number > 100 {
                worst = worst.max(when.max(true_at) - when.min(true_at));
            }
        }
        assert!(worst < Duration::from_micros(1), "{worst:?}");
        let (words, figures) = clock.told().unwrap();
        assert!((figures.skew_ppm.unwrap() - 100.0).abs() < 0.01, "{figures:?}");
        assert!((figures.late_mean_us - 1500.0).abs() < 1.0, "{figures:?}");
        assert_eq!(figures.first_stamp_ns, 90_000);
        assert!(words.starts_with("host faster by +100.0"), "{words}");
    }

    /// A unit that is slow by 50 ppm, on a line that delays each reading by 23 ms, with pulses in a file
    /// of the kernel's form: by arrivals its readings would be dated 23 ms late.
    #[test]
    fn by_pulses_a_reading_was_made_without_the_delay_of_the_line() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("assert");
        let pulse = |at: Instant, sequence: u64| {
            let clocks = HostClocks::read();
            let ns = clocks.other_ns - (clocks.monotonic - at).as_nanos() as i128;
            let line = format!("{}.{:09}#{sequence}\n", ns / 1_000_000_000, ns % 1_000_000_000);
            std::fs::write(file.with_extension("next"), line).unwrap();
            std::fs::rename(file.with_extension("next"), &file).unwrap();
        };
        pulse(Instant::now(), 0);
        let plan = UnitPulses {
            device: "assert".to_owned(),
            at_clear: false,
            silence_s: 60.0,
            within_s: 20e-6,
        };
        let mut clock = Clock::new(
            Reference::Pulses(Box::new(Pulses::open(&plan, folder.path()).unwrap())),
            200.0,
        );
        let delay = Duration::from_millis(23);
        let (start, first_ns) = (clock.base, 1_000_100_000_000u64);
        let made = |number: u64| start + Duration::from_nanos(number * 5_000_250);
        let (mut dated, mut worst) = (0, Duration::ZERO);
        for number in 0..1000u64 {
            let at = made(number);
            std::thread::sleep((at + delay).saturating_duration_since(Instant::now()));
            let stamp_ns = first_ns + number * 5_000_000;
            if stamp_ns.is_multiple_of(1_000_000_000) {
                pulse(at, number);
            }
            if let Some(when) = clock.when(stamp(stamp_ns), Arrival::read(at + delay)).unwrap() {
                dated += 1;
                worst = worst.max(when.max(at) - when.min(at));
            }
        }
        let (words, figures) = clock.dated(Some(10.0), None);
        assert!(dated > 200, "{words}");
        let within_us = figures.within_us.unwrap();
        assert!(within_us >= 20.0 && worst.as_secs_f64() * 1e6 < within_us, "{worst:?} {words}");
        let line = figures.line_delay.unwrap();
        assert!((line.least_ms - 23.0).abs() * 1e3 < within_us, "{words}");
        assert_eq!((line.early, figures.origin.as_str()), (0, "pulses"));
        // 36 arcseconds a millisecond.
        let angle = figures.angle_within_arcsec.unwrap();
        assert!((angle - 0.036 * within_us).abs() < 1e-9, "{words}");
        assert!(words.starts_with("by 5 pulses at assert, 0 missing, 0 off"), "{words}");
        let error = clock.when(None, Arrival::read(Instant::now())).unwrap_err();
        assert!(error.contains("a reading without a stamp"), "{error}");
    }

    /// Readings without stamps that come at 198 Hz where 200 are configured: 1 % of every increment's time is missing.
    #[test]
    fn the_rate_of_readings_without_stamps_is_held_against_the_hosts_clock() {
        let mut clock = Clock::new(Reference::Arrivals, 200.0);
        for number in 0..4000_u64 {
            let late_ns = if number % 3 == 0 { 0 } else { 1_500_000 };
            let at = clock.base + Duration::from_nanos(number * 1_000_000_000 / 198 + late_ns);
            clock.when(None, Arrival::read(at)).unwrap();
        }
        let outside = clock.outside().unwrap();
        // A second of the count takes 200/198 s of the host's: 1/99 more.
        assert!((outside.fast_ppm + 1e6 / 99.0).abs() < 60.0, "{outside:?}");
        assert!(outside.sigma_ppm.unwrap() < 100.0, "{outside:?}");
    }

    #[test]
    fn without_a_stamp_it_is_when_it_came() {
        let mut clock = Clock::new(Reference::Arrivals, 200.0);
        let came = clock.base + Duration::from_millis(3);
        assert_eq!(clock.when(None, Arrival::read(came)), Ok(Some(came)));
        assert!(clock.told().is_none());
    }
}
