//! Origin and uncertainty of the samples' times, as a run reports them.

use super::arrival::Arrival;
use octant_base::number::counted;
use octant_recorder::event::{BenchDelay, BenchPulses, BenchTime};
use std::time::Duration;

/// Arcseconds that a rate of a degree a second turns in a second.
const ARCSEC_PER_DEG: f64 = 3600.0;

/// Counts of arrivals and delays.
#[derive(Debug, Default)]
pub(super) struct Dates {
    by_kernel: u64,
    by_read: u64,
    converted_within: Duration,
    /// Delays of readings after their time, ns: number, sum, sum of squares, least and largest.
    delays: u64,
    sum_ns: f64,
    sum_ns2: f64,
    least_ns: f64,
    largest_ns: f64,
    early: u64,
    within_ns: f64,
}

impl Dates {
    /// Notes the arrival of a reading.
    pub(super) fn came(&mut self, came: Arrival) {
        match came.by_kernel {
            Some(within) => {
                self.by_kernel += 1;
                self.converted_within = self.converted_within.max(within);
            }
            None => self.by_read += 1,
        }
    }

    /// Notes a time that doesn't rest on its arrival, which came so much later.
    pub(super) fn dated(&mut self, delay_ns: f64, within_ns: f64) {
        let first = self.delays == 0;
        self.delays += 1;
        self.sum_ns += delay_ns;
        self.sum_ns2 += delay_ns * delay_ns;
        self.least_ns = if first { delay_ns } else { self.least_ns.min(delay_ns) };
        self.largest_ns = if first { delay_ns } else { self.largest_ns.max(delay_ns) };
        self.early += u64::from(delay_ns < -within_ns);
        self.within_ns = self.within_ns.max(within_ns);
    }

    fn delay(&self) -> Option<BenchDelay> {
        let count = (self.delays > 0).then_some(self.delays as f64)?;
        let mean_ns = self.sum_ns / count;
        let variance = (self.sum_ns2 / count - mean_ns * mean_ns).max(0.0);
        Some(BenchDelay {
            early: self.early,
            largest_ms: self.largest_ns * 1e-6,
            least_ms: self.least_ns * 1e-6,
            mean_ms: mean_ns * 1e-6,
            sigma_ms: variance.sqrt() * 1e-6,
        })
    }

    /// Summarises the run, in words and figures. The table's looks, if it has one, are within
    /// `looks_ms` of their times.
    pub(super) fn told(
        &self,
        pulses: Option<BenchPulses>,
        stamps: Option<String>,
        rate_degps: Option<f64>,
        looks_ms: Option<f64>,
    ) -> (String, BenchTime) {
        let line_delay = self.delay();
        let is_known = pulses.is_some() || stamps.is_some();
        // A reading that came before its time contradicts the bound: then there is none.
        let is_bounded = is_known && self.delays > 0 && self.early == 0;
        let within_us = is_bounded.then_some(self.within_ns * 1e-3);
        let arcsec = |ms: f64| rate_degps.map(|rate| rate * ms * 1e-3 * ARCSEC_PER_DEG);
        let within_ms = within_us.map(|us| us * 1e-3);
        let angle_within_arcsec =
            within_ms.and_then(|ms| arcsec(ms + looks_ms.unwrap_or_default()));
        let origin = match (&pulses, stamps) {
            (Some(_), _) => "pulses".to_owned(),
            (None, Some(stamps)) => stamps,
            (None, None) if self.by_kernel > self.by_read => "arrivals by the kernel".to_owned(),
            (None, None) => "arrivals by the read".to_owned(),
        };
        let figures = BenchTime {
            angle_within_arcsec,
            arrivals_by_kernel: self.by_kernel,
            arrivals_by_read: self.by_read,
            arrivals_within_us: self.converted_within.as_secs_f64() * 1e6,
            line_delay,
            origin,
            pulses,
            rate_degps,
            within_us,
        };
        if is_known && self.delays == 0 {
            return (undated(&figures), figures);
        }
        (words(&figures, looks_ms, arcsec(1.0)), figures)
    }
}

/// Words where no sample got its time.
fn undated(time: &BenchTime) -> String {
    let by = time.pulses.as_ref().map_or_else(
        || format!("by {}", time.origin),
        |pulses| format!("after {} at {}", counted(pulses.taken, "pulse", "pulses"), pulses.device),
    );
    format!("none: no sample got its time {by}")
}

fn words(time: &BenchTime, looks_ms: Option<f64>, arcsec_per_ms: Option<f64>) -> String {
    let rate = time.rate_degps.unwrap_or_default();
    if let Some(delay) = time.line_delay.filter(|delay| delay.early > 0) {
        return format!(
            "by {}, without a bound: {} came before their time by more than it, expected none; the least delay of \
             the line is {:+.3} ms",
            time.origin,
            counted(delay.early, "reading", "readings"),
            delay.least_ms
        );
    }
    let Some(within_us) = time.within_us else {
        let angle = arcsec_per_ms.map_or_else(String::new, |arcsec| {
            format!("; each millisecond of it is {arcsec:.1}″ at {rate} °/s")
        });
        return format!(
            "by {}, without a bound: later than the sample by the least delay of the line, which isn't \
             known{angle}",
            time.origin
        );
    };
    let angle = match (time.angle_within_arcsec, looks_ms) {
        (None, _) => String::new(),
        (Some(arcsec), None) => format!(", {arcsec:.1}″ at {rate} °/s"),
        (Some(arcsec), Some(looks_ms)) => {
            format!(
                ", with the looks at the table within {looks_ms:.1} ms {arcsec:.1}″ at {rate} °/s"
            )
        }
    };
    let delay = time.line_delay.map_or_else(String::new, |delay| {
        format!(
            "; delay of the line from {:.3} ms, mean {:.3} ms, 1σ {:.3} ms",
            delay.least_ms, delay.mean_ms, delay.sigma_ms,
        )
    });
    let (origin, steps) = time.pulses.as_ref().map_or_else(|| (time.origin.clone(), None), counts);
    let steps = steps.unwrap_or_default();
    format!("by {origin}: within {within_us:.1} µs{angle}{delay}{steps}")
}

/// Counts of pulses in words, and of the clock's steps if there were any.
fn counts(pulses: &BenchPulses) -> (String, Option<String>) {
    let steps = (pulses.clock_steps > 0).then(|| {
        format!(
            "; {} of the host's realtime clock, the largest {:+.3} ms",
            counted(pulses.clock_steps, "step", "steps"),
            pulses.clock_step_largest_ms
        )
    });
    let found = format!(
        "{} at {}, {} missing, {} off",
        counted(pulses.taken, "pulse", "pulses"),
        pulses.device,
        pulses.missing,
        pulses.off,
    );
    (found, steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pulses() -> BenchPulses {
        BenchPulses {
            clock_steps: 0,
            clock_step_largest_ms: 0.0,
            device: "/dev/pps0".to_owned(),
            off: 0,
            missing: 0,
            repeated: 0,
            residual_us: Some(5.0),
            sigma_us: Some(2.0),
            skew_ppm: Some(0.0),
            taken: 9,
            unread: 0,
            untimely: 0,
        }
    }

    #[test]
    fn a_reading_before_its_time_takes_the_bound_away() {
        let mut dates = Dates::default();
        let (words, told) = dates.told(Some(pulses()), None, Some(10.0), None);
        assert_eq!(told.within_us, None);
        assert_eq!(words, "none: no sample got its time after 9 pulses at /dev/pps0");
        let (words, told) = dates.told(None, Some("stamps (tai)".to_owned()), Some(10.0), None);
        assert_eq!(told.within_us, None);
        assert_eq!(words, "none: no sample got its time by stamps (tai)");
        dates.dated(3e6, 25e3);
        let (words, _) = dates.told(None, Some("stamps (tai)".to_owned()), Some(10.0), None);
        assert!(words.starts_with("by stamps (tai): within 25.0 µs, 0.9″ at 10 °/s; "), "{words}");
        dates.dated(-20e3, 25e3);
        let (words, told) = dates.told(Some(pulses()), None, Some(10.0), Some(1.0));
        assert_eq!((told.within_us, told.line_delay.unwrap().early), (Some(25.0), 0));
        // 10 °/s for 1.025 ms.
        assert!((told.angle_within_arcsec.unwrap() - 36.9).abs() < 1e-9);
        assert!(words.contains("within 25.0 µs"), "{words}");
        dates.dated(-30e3, 25e3);
        let (words, told) = dates.told(Some(pulses()), None, Some(10.0), Some(1.0));
        assert_eq!((told.within_us, told.angle_within_arcsec), (None, None));
        assert!(words.contains("without a bound: 1 reading came before"), "{words}");
    }
}
