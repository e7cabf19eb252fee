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
