//! Errors by a motion of the table: after it, and in it.
//!
//! An error here is a difference from the settle point (draft of ISO 22090-1, 3.13): the settle point error is a subject
//! of its own.

use crate::reading::{Reading, Series};

/// Amplitude above which the frequency of a dynamic error counts, deg (MSC.116(73), 4.3.2.3).
pub const SLOW_ABOVE_DEG: f64 = 0.5;

/// Error of the reading after a motion, deg: heading − true heading − settle point error, at the first reading of the
/// table at rest again, `stopped_s` after switching on. `None` without that reading.
#[must_use]
pub fn error_after_deg(series: &Series, settle_error_deg: f64, stopped_s: f64) -> Option<f64> {
    let reading = series.at(stopped_s).filter(|reading| !reading.moving)?;
    Some(reading.error_deg()? - settle_error_deg)
}

/// Error in a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DynamicError {
    /// Largest magnitude, deg.
    pub amplitude_deg: f64,
    /// Frequency of its largest component, Hz, where the amplitude is above [`SLOW_ABOVE_DEG`]; 0 where it isn't.
    pub frequency_hz: f64,
}

/// Error of the readings from one time to another, against the settle point error. `None` if there are fewer than two
/// readings, or a gap of more than one and a half of their interval.
#[must_use]
pub fn dynamic_error(
    series: &Series,
    settle_error_deg: f64,
    from_s: f64,
    to_s: f64,
) -> Option<DynamicError> {
    let readings = series.between(from_s, to_s);
    let [first, second, ..] = readings else { return None };
    let interval_s = second.t_s - first.t_s;
    let longest_s = 1.5 * interval_s;
    let has_gap = readings.windows(2).any(|pair| pair[1].t_s - pair[0].t_s > longest_s);
    let last_s = readings.last()?.t_s;
    if has_gap || first.t_s - from_s > longest_s || to_s - last_s > longest_s {
        return None;
    }
    let errors: Option<Vec<f64>> = readings.iter().map(Reading::error_deg).collect();
    let errors: Vec<f64> = errors?.iter().map(|error| error - settle_error_deg).collect();
    let amplitude_deg = errors.iter().fold(0.0, |most: f64, error| most.max(error.abs()));
    let frequency_hz = if amplitude_deg > SLOW_ABOVE_DEG {
        largest_component_hz(&errors, interval_s)?
    } else {
        0.0
    };
    Some(DynamicError { amplitude_deg, frequency_hz })
}

/// Frequency of the largest component of values at equal intervals, Hz: the largest of their discrete Fourier transform,
/// from 0 to half of the rate. A resolution of 1 over their time is that of the values themselves.
fn largest_component_hz(values: &[f64], interval_s: f64) -> Option<f64> {
    let count = values.len();
    let power = |bin: usize| {
        let (step_sin, step_cos) =
            libm::sincos(2.0 * core::f64::consts::PI * bin as f64 / count as f64);
        // A phasor that turns from value to value; its rounding is far below the bins' differences.
        let (mut sin, mut cos, mut along, mut across) = (0.0, 1.0, 0.0, 0.0);
        for value in values {
            along += value * cos;
            across += value * sin;
            (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        }
        let both = if bin == 0 || 2 * bin == count { 0.25 } else { 1.0 };
        both * (along * along + across * across)
    };
    let largest = (0..=count / 2)
        .map(|bin| (bin, power(bin)))
        .reduce(|most, next| if next.1 > most.1 { next } else { most })?;
    Some(largest.0 as f64 / (count as f64 * interval_s))
}
