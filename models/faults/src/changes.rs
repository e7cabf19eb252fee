//! Differences of two streams of epochs that count as the effect of a fault.

use octant_sample::{Epoch, Sample};

/// Differences of the sums of counts of two plants, with the range of each since the last sample that was altered.
///
/// Two counters that have counted the same may carry different remainders: from then on their counts differ by one now
/// and then, their sums by no more than one, for good. That is no effect on the sample in which it shows.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(crate) struct CountSums {
    difference: [i64; 6],
    smallest: [i64; 6],
    largest: [i64; 6],
}

fn counts(sample: &Sample) -> [i64; 6] {
    let ([a, b, c], [d, e, f]) = (sample.delta_theta, sample.delta_velocity);
    [a, b, c, d, e, f].map(i64::from)
}

impl CountSums {
    /// Takes the next pair of epochs. Returns whether it was altered: anything but counts differs, or the difference of
    /// the sums of a channel has varied by more than remainders make since the last one that was.
    pub(crate) fn is_altered(
        &mut self,
        (without, with): (&Epoch, &Epoch),
        remainder: [i64; 2],
    ) -> bool {
        let (a, b) = (counts(&without.sample), counts(&with.sample));
        let mut altered = false;
        for channel in 0..6 {
            let sum = &mut self.difference[channel];
            // 64 bits hold the counts of 2³² samples; beyond, and in a state that no run makes, they wrap.
            *sum = sum.wrapping_add(b[channel] - a[channel]);
            self.smallest[channel] = self.smallest[channel].min(*sum);
            self.largest[channel] = self.largest[channel].max(*sum);
            let varied = self.largest[channel].wrapping_sub(self.smallest[channel]);
            altered |= varied > remainder[channel / 3];
        }
        let mut same_counts = *with;
        same_counts.sample.delta_theta = without.sample.delta_theta;
        same_counts.sample.delta_velocity = without.sample.delta_velocity;
        altered |= !same_counts.same_bits(without);
        if altered {
            (self.smallest, self.largest) = (self.difference, self.difference);
        }
        altered
    }
}
