//! Integer counts: the resolution in which increments and gimbal angles travel.
//!
//! A count is the difference of the rounded running integral, as for the fringes of a ring laser:
//! the remainder is carried ([`Accumulator`]). Rounding every sample on its own would bias a still
//! base by 2.6e-4 °/h. Every count is exact in f64.

/// Radians per count of `delta_theta`: 2⁻³⁶.
pub const DELTA_THETA_LSB_RAD: f64 = 1.0 / (1u64 << 36) as f64;
/// Metres per second per count of `delta_velocity`: 2⁻³⁰.
pub const DELTA_VELOCITY_LSB_MPS: f64 = 1.0 / (1u64 << 30) as f64;
/// Radians per count of a gimbal angle: 2⁻²⁷ (±16 rad in an i32).
pub const GIMBAL_LSB_RAD: f64 = 1.0 / (1u64 << 27) as f64;

/// Rounding constant 1.5·2⁵²: adding and subtracting it rounds an f64 below 2⁵¹ to an integer, ties
/// to even, without a call to a library.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Magnitude from which on a count doesn't fit into an i32.
const COUNT_LIMIT: f64 = 2_147_483_647.0;

/// One axis of an integrating sensor: turns increments into counts and carries the remainder.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Accumulator {
    /// Remainder that the counts so far have not delivered, in counts, within ±½ unless saturated.
    pub remainder: f64,
}

/// The outcome of [`Accumulator::count`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// The count to send.
    pub value: i32,
    /// True if the increment did not fit; the excess is lost, as in a real counter.
    pub saturated: bool,
}

impl Accumulator {
    /// Counts an increment given in units of the LSB (a real number of counts).
    ///
    /// Saturates at the range of an i32, flags it, and loses the excess. An increment that is not
    /// finite saturates at the sign's end (NaN: zero) and leaves the remainder untouched.
    #[inline]
    pub fn count(&mut self, increment_counts: f64) -> Count {
        let total = self.remainder + increment_counts;
        if total.abs() < COUNT_LIMIT {
            let shifted = total + ROUND;
            self.remainder = total - (shifted - ROUND);
            // The integer is in the lowest bits of the mantissa, in two's complement.
            Count { value: shifted.to_bits() as i32, saturated: false }
        } else {
            Count { value: total as i32, saturated: true }
        }
    }
}

/// Counts the increments of three axes, as [`Accumulator::count`] does one after the other; returns true if one of
/// them saturated.
#[inline(always)]
pub fn count_triad(
    accumulators: &mut [Accumulator; 3],
    increments_counts: [f64; 3],
    counts: &mut [i32; 3],
) -> bool {
    let totals = [0, 1, 2].map(|axis| accumulators[axis].remainder + increments_counts[axis]);
    // One comparison for three axes: none is larger than the sum, and what is no number fails.
    if !(totals[0].abs() + totals[1].abs() + totals[2].abs() < COUNT_LIMIT) {
        return count_one_by_one(accumulators, increments_counts, counts);
    }
    let shifted = totals.map(|total| total + ROUND);
    for axis in 0..3 {
        accumulators[axis].remainder = totals[axis] - (shifted[axis] - ROUND);
        counts[axis] = shifted[axis].to_bits() as i32;
    }
    false
}

#[cold]
#[inline(never)]
fn count_one_by_one(
    accumulators: &mut [Accumulator; 3],
    increments_counts: [f64; 3],
    counts: &mut [i32; 3],
) -> bool {
    let mut saturated = false;
    for axis in 0..3 {
        let count = accumulators[axis].count(increments_counts[axis]);
        counts[axis] = count.value;
        saturated |= count.saturated;
    }
    saturated
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_counts_follows_the_integral_within_half_a_count() {
        let mut accumulator = Accumulator::default();
        let (mut sum, step) = (0i64, 0.123_456_789);
        for k in 1..=1_000_000i64 {
            sum += i64::from(accumulator.count(step).value);
            assert!((sum as f64 - step * k as f64).abs() <= 0.5 + 1e-6);
        }
    }

    #[test]
    fn a_count_is_the_nearest_integer_ties_to_even() {
        let near = [-2_147_483_646.5, -70_000.5, -1.5, -0.5, -0.25, 0.0, 0.5, 1.5, 2.75, 8e8];
        let far = (0..1000).map(|k| f64::from(k - 500) * 4_294_957.3);
        for increment in near.into_iter().chain(far) {
            let mut accumulator = Accumulator::default();
            let count = accumulator.count(increment);
            assert_eq!(f64::from(count.value), increment.round_ties_even(), "{increment}");
            assert_eq!(accumulator.remainder, increment - increment.round_ties_even());
        }
    }

    #[test]
    fn an_increment_out_of_range_saturates_and_says_so() {
        let mut accumulator = Accumulator::default();
        assert_eq!(accumulator.count(3e9), Count { value: i32::MAX, saturated: true });
        assert_eq!(accumulator.count(-3e9), Count { value: i32::MIN, saturated: true });
        assert_eq!(accumulator.count(f64::NAN), Count { value: 0, saturated: true });
        assert_eq!(accumulator.count(2.0), Count { value: 2, saturated: false });
    }

    #[test]
    fn three_axes_count_as_one_after_the_other() {
        let values =
            [0.0, -0.4, 0.5, 1.5, -7.25e8, 7.2e8, 2.147_483_646e9, -3e9, f64::INFINITY, f64::NAN];
        let (mut triad, mut single) = ([Accumulator::default(); 3], [Accumulator::default(); 3]);
        for step in 0..1000usize {
            let increments = [1, 3, 7].map(|stride| values[step * stride / 7 % values.len()]);
            let mut counts = [0; 3];
            let saturated = count_triad(&mut triad, increments, &mut counts);
            let alone = [0, 1, 2].map(|axis| single[axis].count(increments[axis]));
            assert_eq!(counts, alone.map(|count| count.value), "{increments:?}");
            assert_eq!(saturated, alone.iter().any(|count| count.saturated), "{increments:?}");
            assert_eq!(
                triad.map(|axis| axis.remainder.to_bits()),
                single.map(|axis| axis.remainder.to_bits())
            );
        }
    }
}
