//! Follow-up error in turns, and error of transmission and resolution (MSC.116(73), 4.3.2.1 and 4.3.2.4).

use crate::angle;
use crate::reading::Reading;

/// Class of rates of turn, deg/s: above the first, up to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateClass {
    /// Rate above which it begins, deg/s.
    pub above_degps: f64,
    /// Rate up to which it goes, deg/s.
    pub up_to_degps: f64,
}

/// Rates of turn up to 10 °/s.
pub const SLOW: RateClass = RateClass { above_degps: 0.0, up_to_degps: 10.0 };
/// Rates of turn above 10 °/s, up to 20 °/s.
pub const FAST: RateClass = RateClass { above_degps: 10.0, up_to_degps: 20.0 };

/// Largest magnitude of the error in turns of a class, deg, against the error at rest. The rate of turn at a reading is that
/// of the true heading from the reading before to the one after. `None` if no reading has a rate of the class.
///
/// Readings have to be close enough that the heading turns by less than half a turn between two.
#[must_use]
pub fn follow_up_error_deg(
    readings: &[Reading],
    class: RateClass,
    error_at_rest_deg: f64,
) -> Option<f64> {
    readings
        .windows(3)
        .filter_map(|three| {
            let [before, at, after] = three else { return None };
            let turned = angle::difference(after.true_deg?, at.true_deg?)
                + angle::difference(at.true_deg?, before.true_deg?);
            let rate_degps = (turned / (after.t_s - before.t_s)).abs();
            let in_class = rate_degps > class.above_degps && rate_degps <= class.up_to_degps;
            let error_deg = in_class.then(|| at.error_deg())??;
            Some((error_deg - error_at_rest_deg).abs())
        })
        .reduce(f64::max)
}

/// Largest magnitude of the difference of a transmitted heading from the heading that was put in, deg; `None` without a
/// pair. Of a pair, the first is the heading that was put in.
#[must_use]
pub fn transmission_error_deg(pairs: &[[f64; 2]]) -> Option<f64> {
    pairs.iter().map(|[put_in, sent]| angle::difference(*sent, *put_in).abs()).reduce(f64::max)
}

/// Smallest step of transmitted headings that differ, deg: their resolution, if the heading moved through neighbouring ones.
/// `None` if none differ.
#[must_use]
pub fn resolution_deg(sent_deg: &[f64]) -> Option<f64> {
    let steps = sent_deg.windows(2).map(|pair| angle::difference(pair[1], pair[0]).abs());
    // Differences of numbers with few decimals are off by their last bits.
    steps.filter(|step| *step > 1e-9).reduce(f64::min)
}
