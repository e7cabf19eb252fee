//! Offset and drift of one clock against another.
//!
//! Each exchange of the time gives an offset and a bound of its error: half of the round-trip delay.
//! The exchange with the least delay has the least error. So the best exchange of each stretch of time
//! is kept, and a line is fitted through those.

use octant_wire::message::{ClockTime, TimeReply};

/// Four timestamps of one exchange.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamps {
    /// Timestamps of the harness's sending and of the other end's receiving and answering.
    pub reply: TimeReply,
    /// Reception by the harness, by its own clock.
    pub harness_received: ClockTime,
}

/// Estimate of the other clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockEstimate {
    /// Offset by which the other clock is ahead at the time of the last exchange, ns.
    pub offset_ns: f64,
    /// Bound of the error of the offset, ns: half of the least delay.
    pub bound_ns: f64,
    /// Relative rate by which the other clock is fast, 1: with `skew` 1e-6 it gains a microsecond a
    /// second. `None` until there are exchanges from two stretches of time.
    pub skew: Option<f64>,
    /// Least round-trip delay of an exchange, without the other end's processing time, ns.
    pub delay_min_ns: f64,
    /// Exchanges accepted.
    pub exchanges: u64,
    /// Exchanges rejected because their timestamps contradict each other.
    pub contradictory: u64,
}

/// Number of stretches of which the best exchange is kept.
const STRETCHES: usize = 64;

/// Best exchange of a stretch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Best {
    /// Middle of the exchange by the harness's clock, ns since the first one.
    at_ns: f64,
    /// Offset, ns, relative to that of the first exchange.
    offset_ns: f64,
    delay_ns: f64,
}

/// Estimates offset and skew from exchanges, without allocating.
#[derive(Clone, Debug)]
pub struct ClockEstimator {
    stretch_ns: f64,
    origin: Option<(u64, i128)>,
    best: [Best; STRETCHES],
    /// Number of entries of `best` in use.
    used: usize,
    /// Number of the stretch being filled.
    current: u64,
    last: Best,
    exchanges: u64,
    contradictory: u64,
}

impl ClockEstimator {
    /// Keeps the best exchange of each stretch of `stretch_s` seconds, for the last 64 stretches.
    #[must_use]
    pub fn new(stretch_s: f64) -> Self {
        Self {
            stretch_ns: stretch_s.max(1e-3) * 1e9,
            origin: None,
            best: [Best::default(); STRETCHES],
            used: 0,
            current: 0,
            last: Best::default(),
            exchanges: 0,
            contradictory: 0,
        }
    }

    /// Takes an exchange, and counts it as contradictory if its timestamps are.
    pub fn add(&mut self, stamps: &Stamps) {
        let found = stamps.reply.offset(stamps.harness_received);
        let there_and_back = stamps.harness_received >= stamps.reply.harness_sent
            && stamps.reply.sent >= stamps.reply.received;
        if found.error_ns < 0 || !there_and_back {
            self.contradictory += 1;
            return;
        }
        self.exchanges += 1;
        let sent = stamps.reply.harness_sent.ns;
        let (start, offset) = *self.origin.get_or_insert((sent, found.ahead_ns));
        let middle = (i128::from(sent) + i128::from(stamps.harness_received.ns)) / 2;
        let exchange = Best {
            at_ns: (middle - i128::from(start)) as f64,
            offset_ns: (found.ahead_ns - offset) as f64,
            delay_ns: 2.0 * found.error_ns as f64,
        };
        self.last = exchange;
        // Exchanges come in the order of the harness's own clock.
        let stretch = (exchange.at_ns.max(0.0) / self.stretch_ns) as u64;
        if self.used == 0 || stretch > self.current {
            if self.used == STRETCHES {
                self.best.rotate_left(1);
                self.used -= 1;
            }
            self.best[self.used] = exchange;
            self.used += 1;
            self.current = stretch;
        } else if exchange.delay_ns < self.best[self.used - 1].delay_ns {
            self.best[self.used - 1] = exchange;
        }
    }

    /// Present estimate; `None` before the first exchange.
    #[must_use]
    pub fn estimate(&self) -> Option<ClockEstimate> {
        let (_, origin_offset) = self.origin?;
        let best = &self.best[..self.used];
        let delay_min_ns = best.iter().map(|b| b.delay_ns).fold(f64::INFINITY, f64::min);
        // Exchanges far above the least delay get a small weight: their error is that of the path.
        let weight = |b: &Best| {
            let excess = b.delay_ns - delay_min_ns;
            let scale = 0.5 * delay_min_ns + 1e3;
            1.0 / (1.0 + (excess / scale).powi(2))
        };
        let sum = |f: &dyn Fn(&Best) -> f64| best.iter().map(|b| weight(b) * f(b)).sum::<f64>();
        let total = sum(&|_| 1.0);
        let (at, offset) = (sum(&|b| b.at_ns) / total, sum(&|b| b.offset_ns) / total);
        let spread = sum(&|b| (b.at_ns - at).powi(2));
        let skew = (self.used >= 2 && spread > 0.0)
            .then(|| sum(&|b| (b.at_ns - at) * (b.offset_ns - offset)) / spread);
        let now = offset + skew.unwrap_or(0.0) * (self.last.at_ns - at);
        Some(ClockEstimate {
            offset_ns: origin_offset as f64 + now,
            bound_ns: 0.5 * delay_min_ns,
            skew,
            delay_min_ns,
            exchanges: self.exchanges,
            contradictory: self.contradictory,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exchange at a time, s, with a clock that is ahead by `ahead_ns` and fast by `skew`, with the
    /// delays there and back, ns.
    fn exchange(at_s: f64, ahead_ns: f64, skew: f64, there_ns: f64, back_ns: f64) -> Stamps {
        let start = 1e12;
        let t1 = start + at_s * 1e9;
        let other = |t: f64| t + ahead_ns + skew * (t - start);
        let (t2, t3) = (t1 + there_ns, t1 + there_ns + 3000.0);
        let time = |ns: f64| ClockTime::from_ns(ns.round() as u64);
        Stamps {
            reply: TimeReply {
                id: 0,
                harness_sent: time(t1),
                received: time(other(t2)),
                sent: time(other(t3)),
            },
            harness_received: time(t3 + back_ns),
        }
    }

    #[test]
    fn equal_delays_give_offset_and_skew_as_they_are() {
        let mut clock = ClockEstimator::new(1.0);
        assert_eq!(clock.estimate(), None);
        for i in 0..120 {
            clock.add(&exchange(f64::from(i) * 0.25, 5e9, 20e-6, 50e3, 50e3));
        }
        let found = clock.estimate().unwrap();
        let at = 119.0 * 0.25 * 1e9 + 51_500.0;
        assert!((found.offset_ns - (5e9 + 20e-6 * at)).abs() < 5.0, "{found:?}");
        assert!((found.skew.unwrap() - 20e-6).abs() < 1e-9, "{found:?}");
        assert!((found.delay_min_ns - 100e3).abs() < 10.0);
        assert_eq!((found.exchanges, found.contradictory), (120, 0));
    }

    #[test]
    fn what_is_delayed_on_one_way_is_left_out() {
        let mut clock = ClockEstimator::new(1.0);
        // Three of four exchanges are held up on the way back, by up to 9 ms.
        for i in 0..240 {
            let held = if i % 4 == 1 { 0.0 } else { 1e6 * f64::from(1 + i % 9) };
            clock.add(&exchange(f64::from(i) * 0.25, -3e6, -50e-6, 40e3, 40e3 + held));
        }
        let found = clock.estimate().unwrap();
        assert!((found.skew.unwrap() + 50e-6).abs() < 1e-8, "{found:?}");
        let at = 239.0 * 0.25 * 1e9 + 41_500.0;
        assert!((found.offset_ns - (-3e6 - 50e-6 * at)).abs() < 600e3, "{found:?}");
        assert_eq!(found.delay_min_ns, 80e3);
    }

    #[test]
    fn the_offset_is_within_its_bound() {
        // Worst case: all of the delay is on one way.
        let mut clock = ClockEstimator::new(1.0);
        clock.add(&exchange(0.0, 1e6, 0.0, 200e3, 0.0));
        let found = clock.estimate().unwrap();
        assert_eq!(found.skew, None);
        assert!((found.offset_ns - 1e6).abs() <= found.bound_ns + 2.0, "{found:?}");
    }

    #[test]
    fn old_stretches_are_forgotten() {
        let mut clock = ClockEstimator::new(1.0);
        for i in 0..300 {
            // The other clock is set back after 100 s.
            let ahead = if i < 100 { 7e9 } else { 1e6 };
            clock.add(&exchange(f64::from(i), ahead, 0.0, 10e3, 10e3));
        }
        let found = clock.estimate().unwrap();
        assert!((found.offset_ns - 1e6).abs() < 5.0, "{found:?}");
    }

    #[test]
    fn stamps_that_contradict_each_other_are_not_taken() {
        let mut clock = ClockEstimator::new(1.0);
        let mut stamps = exchange(0.0, 0.0, 0.0, 10e3, 10e3);
        stamps.harness_received = ClockTime::from_ns(5);
        clock.add(&stamps);
        assert_eq!(clock.estimate(), None);
        clock.add(&exchange(1.0, 0.0, 0.0, 10e3, 10e3));
        assert_eq!(clock.estimate().unwrap().contradictory, 1);
    }
}
