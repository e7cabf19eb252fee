//! Timing of the gimbals: dwell times that fill the calibration, and a cursor that visits the
//! stops.

use crate::sequence::{STOPS_MAX, Sequence, Stop};
use octant_sample::{GimbalAngles, GimbalCommand};

/// Time of a trapezoidal (or, when short, triangular) move over `angle_rad`, s.
#[must_use]
pub fn move_s(angle_rad: f64, rates: &TurntableRates) -> f64 {
    let angle = angle_rad.abs();
    let (rate, acceleration) = (rates.rate_radps, rates.acceleration_radps2);
    // The two branches agree to the last bit where the rate is just reached.
    if angle * acceleration >= rate * rate {
        angle / rate + rate / acceleration
    } else {
        2.0 * libm::sqrt(angle / acceleration)
    }
}

/// Angle turned `t_s` after the start of a move over `angle_rad` (signed), rad.
#[must_use]
pub fn turned_rad(angle_rad: f64, t_s: f64, rates: &TurntableRates) -> f64 {
    let (angle, total) = (angle_rad.abs(), move_s(angle_rad, rates));
    let t = t_s.clamp(0.0, total);
    let ramp = (rates.rate_radps / rates.acceleration_radps2).min(0.5 * total);
    let rising = |t: f64| 0.5 * rates.acceleration_radps2 * t * t;
    let turned = if t < ramp {
        rising(t)
    } else if t <= total - ramp {
        rising(ramp) + rates.acceleration_radps2 * ramp * (t - ramp)
    } else {
        angle - rising(total - t)
    };
    if angle_rad < 0.0 { -turned } else { turned }
}

/// Time of the move between two stops: both gimbals turn at once, and the slower one decides.
#[must_use]
pub fn move_between_s(from: &Stop, to: &Stop, rates: &TurntableRates) -> f64 {
    move_s(to.azimuth_rad - from.azimuth_rad, rates).max(move_s(to.roll_rad - from.roll_rad, rates))
}

/// The moves of a sequence do not fit into the time given.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the moves alone take {moves_s} s, which leaves no dwell of at least {dwell_min_s} s in {duration_s} s"
)]
pub struct DoesNotFit {
    /// Time of all moves, s.
    pub moves_s: f64,
    /// Time given, s.
    pub duration_s: f64,
    /// Shortest dwell that makes sense, s.
    pub dwell_min_s: f64,
}

/// Shortest dwell of weight 1 that a calibration may be planned with, s.
pub const DWELL_MIN_S: f64 = 1.0;

/// Time of all moves of a sequence with all its passes, starting from gimbals at zero, s.
#[must_use]
pub fn moves_s(sequence: &Sequence, rates: &TurntableRates) -> f64 {
    let stops = sequence.stops();
    let within: f64 = stops.windows(2).map(|w| move_between_s(&w[0], &w[1], rates)).sum();
    let back = move_between_s(&stops[stops.len() - 1], &stops[0], rates);
    let passes = f64::from(sequence.passes());
    move_between_s(&Stop::default(), &stops[0], rates) + passes * within + (passes - 1.0) * back
}

/// Dwell of weight 1 with which a sequence fills `duration_s`.
///
/// # Errors
/// If it would be less than [`DWELL_MIN_S`].
pub fn dwell_s(
    sequence: &Sequence,
    duration_s: f64,
    rates: &TurntableRates,
) -> Result<f64, DoesNotFit> {
    let moves_s = moves_s(sequence, rates);
    let weights: f64 = sequence.stops().iter().map(|stop| stop.weight).sum();
    let dwell = (duration_s - moves_s) / (weights * f64::from(sequence.passes()));
    if dwell >= DWELL_MIN_S {
        Ok(dwell)
    } else {
        Err(DoesNotFit { moves_s, duration_s, dwell_min_s: DWELL_MIN_S })
    }
}

/// Advances through a sequence in time: the commanded stop, and whether the gimbals are moving.
///
/// Ticks count samples since the start of the phase (calibration or navigation).
#[derive(Clone, Debug)]
pub struct Cursor {
    sequence: Sequence,
    rates: TurntableRates,
    dwell_s: f64,
    sample_s: f64,
    /// True: without end, as in navigation; else the passes of the sequence.
    endless: bool,
    stop: u32,
    /// Exact start of the present dwell and its end, s since the start of the phase, and the same
    /// to the nearest sample.
    arrival_s: f64,
    departure_s: f64,
    arrival_tick: u64,
    departure_tick: u64,
    command: GimbalCommand,
}

#[cfg(feature = "state")]
octant_state::state! {
    Cursor {
        values: stop, arrival_s, departure_s, arrival_tick, departure_tick, command;
        parts: ;
        kept: sequence, rates, dwell_s, sample_s, endless;
        check: |cursor: &Self| octant_state::check_count("arrival_tick", cursor.arrival_tick)
    }
}

impl Cursor {
    /// Starts towards the first stop from gimbals at `from`.
    #[must_use]
    pub fn new(
        sequence: Sequence,
        from: GimbalAngles,
        rates: TurntableRates,
        dwell_s: f64,
        sample_s: f64,
        endless: bool,
    ) -> Self {
        let from = Stop { azimuth_rad: from.azimuth_rad(), roll_rad: from.roll_rad(), weight: 1.0 };
        let first = sequence.stops()[0];
        // An encoder reading within 1 mrad of the first stop needs no move.
        let there = (from.azimuth_rad - first.azimuth_rad).abs() < 1e-3
            && (from.roll_rad - first.roll_rad).abs() < 1e-3;
        let arrival_s = if there { 0.0 } else { move_between_s(&from, &first, &rates) };
        let mut cursor = Self {
            sequence,
            rates,
            dwell_s,
            sample_s,
            endless,
            stop: 0,
            arrival_s,
            departure_s: 0.0,
            arrival_tick: 0,
            departure_tick: 0,
            command: GimbalCommand::default(),
        };
        cursor.plan_dwell();
        cursor
    }

    /// Computes the data that follow from the present stop and the arrival at it.
    fn plan_dwell(&mut self) {
        let stop = self.target();
        self.departure_s = self.arrival_s + stop.weight * self.dwell_s;
        // Beyond any run, and small enough for additions.
        let tick = |time_s: f64| ((time_s / self.sample_s + 0.5) as u64).min(u64::MAX / 4);
        (self.arrival_tick, self.departure_tick) = (tick(self.arrival_s), tick(self.departure_s));
        self.command.target = GimbalAngles::from_rad(stop.azimuth_rad, stop.roll_rad);
    }

    /// Advances to the output of sample `tick` (from 1) of the phase.
    ///
    /// A command in the output of sample k acts from the end of interval k + 1, so a move that is
    /// to start at time t is commanded one sample early.
    #[inline]
    pub fn advance(&mut self, tick: u64) {
        if tick.saturating_add(1) >= self.departure_tick {
            self.catch_up(tick);
        }
    }

    /// Advances by several stops, as after a gap.
    #[cold]
    fn catch_up(&mut self, tick: u64) {
        for _ in 0..STOPS_MAX {
            if tick.saturating_add(1) < self.departure_tick || !self.depart() {
                return;
            }
        }
    }

    /// Departs to the next stop; `false` at the last.
    fn depart(&mut self) -> bool {
        let count = self.sequence.stops().len() as u32;
        let next = self.stop.wrapping_add(1);
        if !self.endless && next >= count.saturating_mul(self.sequence.passes()) {
            return false;
        }
        let to = self.sequence.stops()[(next % count) as usize];
        let from = self.target();
        self.stop = next;
        self.arrival_s = self.departure_s + move_between_s(&from, &to, &self.rates);
        self.plan_dwell();
        true
    }

    fn target(&self) -> Stop {
        let stops = self.sequence.stops();
        stops[self.stop as usize % stops.len()]
    }

    /// Returns whether the cursor repeats the sequence without end, as in navigation.
    #[must_use]
    #[inline]
    pub fn is_endless(&self) -> bool {
        self.endless
    }

    /// Stop that the gimbals are at or move to, from 0, over all passes.
    #[must_use]
    #[inline]
    pub fn stop(&self) -> u32 {
        self.stop
    }

    /// Returns whether the gimbals are moving at the end of sample `tick`.
    #[must_use]
    #[inline]
    pub fn moving(&self, tick: u64) -> bool {
        tick < self.arrival_tick
    }

    /// Sample at whose end the present dwell starts.
    #[must_use]
    #[inline]
    pub fn arrival_tick(&self) -> u64 {
        self.arrival_tick
    }

    /// Sample at whose end the present dwell ends.
    #[must_use]
    #[inline]
    pub fn departure_tick(&self) -> u64 {
        self.departure_tick
    }

    /// Start of the present dwell, s since the start of the phase.
    #[must_use]
    pub fn arrival_s(&self) -> f64 {
        self.arrival_s
    }

    /// End of the present dwell, s since the start of the phase.
    #[must_use]
    pub fn departure_s(&self) -> f64 {
        self.departure_s
    }

    /// Set point of the gimbals.
    #[must_use]
    #[inline]
    pub fn command(&self) -> GimbalCommand {
        self.command
    }
}

/// Rates of the turntable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "state", derive(serde::Serialize, serde::Deserialize))]
pub struct TurntableRates {
    /// Largest rate of a move, rad/s.
    pub rate_radps: f64,
    /// Acceleration of a move, rad/s².
    pub acceleration_radps2: f64,
}
