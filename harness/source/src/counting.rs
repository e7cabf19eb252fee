//! Converts measured quantities of a real instrument into the integer counts of a sample.

use octant_sample::counts::{Accumulator, DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use octant_sample::{DeviceTime, GimbalAngles, Sample, Status};
use octant_scenario::recorded::{RecordedQuantity, SPLIT_MAX};

/// One row of a file in SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Stamp, ns.
    pub(super) time_ns: u64,
    /// Gyros x y z: rad/s or rad.
    pub(super) gyro: [f64; 3],
    /// Accelerometers x y z: m/s² or m/s.
    pub(super) accel: [f64; 3],
    /// Gimbal azimuth and roll, rad, if the file has them.
    pub(super) gimbal_rad: Option<[f64; 2]>,
}

/// Converts increments of both triads into counts and carries the remainder of each axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Triads {
    gyro: [Accumulator; 3],
    accel: [Accumulator; 3],
    saturated: u64,
}

impl Triads {
    /// Number of samples in which at least one count saturated.
    pub(super) fn saturated(&self) -> u64 {
        self.saturated
    }

    /// Converts increments, rad and m/s, to counts. An increment that is already a whole number of
    /// counts is passed unchanged.
    #[inline]
    pub(super) fn count(
        &mut self,
        theta: &[f64; 3],
        velocity: &[f64; 3],
        delta_theta: &mut [i32; 3],
        delta_velocity: &mut [i32; 3],
    ) -> Status {
        let mut status = Status::empty();
        let mut triad = |accumulators: &mut [Accumulator; 3],
                         increments: &[f64; 3],
                         lsb: f64,
                         flag: Status,
                         counts: &mut [i32; 3]| {
            for axis in 0..3 {
                let exact = increments[axis] / lsb;
                let whole = exact as i32;
                if accumulators[axis].remainder == 0.0 && f64::from(whole) == exact {
                    counts[axis] = whole;
                    continue;
                }
                let count = accumulators[axis].count(exact);
                if count.saturated {
                    status |= flag;
                }
                counts[axis] = count.value;
            }
        };
        let (rad, mps) = (DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS);
        triad(&mut self.gyro, theta, rad, Status::GYRO_SATURATED, delta_theta);
        triad(&mut self.accel, velocity, mps, Status::ACCELEROMETER_SATURATED, delta_velocity);
        self.saturated += u64::from(!status.is_empty());
        status
    }
}

/// Converts rows into counts and carries the remainder of each axis.
///
/// A row may be split into equal parts of its interval, so that counts can hold faster rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    quantity: RecordedQuantity,
    /// Interval assumed for the first row, ns.
    nominal_ns: u64,
    /// Number of samples per row.
    split: u64,
    previous_ns: Option<u64>,
    pending: Option<Pending>,
    sequence: u64,
    triads: Triads,
}

/// Row whose parts have not all been delivered.
#[derive(Clone, Copy, Debug)]
struct Pending {
    row: Measured,
    interval_ns: u64,
    /// Number of parts left.
    left: u64,
}

impl Counting {
    /// Creates the counting. `nominal_ns` is the interval of a row, `split` the number of samples
    /// made from it.
    pub(super) fn new(
        quantity: RecordedQuantity,
        nominal_ns: u64,
        split: u32,
    ) -> Result<Self, String> {
        if !(1..=SPLIT_MAX).contains(&split) {
            return Err(format!("split is {split}, expected 1 to {SPLIT_MAX}"));
        }
        Ok(Self {
            quantity,
            nominal_ns,
            split: u64::from(split),
            previous_ns: None,
            pending: None,
            sequence: 0,
            triads: Triads::default(),
        })
    }

    /// Number of samples in which at least one count saturated.
    pub(super) fn saturated(&self) -> u64 {
        self.triads.saturated()
    }

    /// Accepts a row; [`Self::next`] then delivers its samples.
    ///
    /// If the first row would begin before time 0, only its parts that end after time 0 are
    /// delivered.
    pub(super) fn begin(&mut self, row: Measured) -> Result<(), String> {
        let mut left = self.split;
        let interval_ns = match self.previous_ns {
            None => {
                let part_ns = (self.nominal_ns / self.split).max(1);
                left = left.min(row.time_ns / part_ns + 1);
                self.nominal_ns
            }
            Some(previous) => match row.time_ns.checked_sub(previous) {
                Some(interval) if interval >= self.split => interval,
                Some(interval) if interval > 0 => {
                    return Err(format!(
                        "stamp {} ns is {interval} ns after the one before, expected {} ns at \
                         least, one for each part",
                        row.time_ns, self.split
                    ));
                }
                _ => {
                    return Err(format!(
                        "stamp {} ns is not after the one before, {previous} ns",
                        row.time_ns
                    ));
                }
            },
        };
        self.previous_ns = Some(row.time_ns);
        self.pending = Some(Pending { row, interval_ns, left });
        Ok(())
    }

    /// Returns the next sample of the current row; `None` when the whole row has been delivered.
    pub(super) fn next(&mut self) -> Option<Sample> {
        let Pending { row, interval_ns, left } = self.pending?;
        self.pending = (left > 1).then_some(Pending { row, interval_ns, left: left - 1 });
        // Exact integer arithmetic: the parts of an interval differ by a nanosecond at most.
        let until_end = |parts: u64| {
            (u128::from(interval_ns) * u128::from(parts) / u128::from(self.split)) as u64
        };
        let time_ns = row.time_ns.saturating_sub(until_end(left - 1));
        let part_ns = until_end(left) - until_end(left - 1);
        self.sequence += 1;
        let factor = match self.quantity {
            RecordedQuantity::Rates => part_ns as f64 * 1e-9,
            RecordedQuantity::Increments => part_ns as f64 / interval_ns as f64,
        };
        let mut sample = Sample {
            sequence: self.sequence,
            device_time: DeviceTime::from_ns(time_ns),
            ..Sample::default()
        };
        let mut status = self.triads.count(
            &row.gyro.map(|value| value * factor),
            &row.accel.map(|value| value * factor),
            &mut sample.delta_theta,
            &mut sample.delta_velocity,
        );
        match row.gimbal_rad {
            Some([azimuth, roll]) => sample.gimbal = GimbalAngles::from_rad(azimuth, roll),
            None => status |= Status::GIMBAL_INVALID,
        }
        sample.status = status;
        Some(sample)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time_ns: u64, rate: f64) -> Measured {
        Measured { time_ns, gyro: [rate, 0.0, 0.0], accel: [0.0, 0.0, 9.8], gimbal_rad: None }
    }

    #[test]
    fn parts_have_even_stamps_and_the_sum_of_the_row() {
        for quantity in [RecordedQuantity::Rates, RecordedQuantity::Increments] {
            let run = |split: u32| {
                let mut counting = Counting::new(quantity, 10_000_000, split).unwrap();
                let (mut stamps, mut sum, mut last) = (Vec::new(), 0i64, 0);
                for (k, rate) in [1e-3, -2e-3, 3e-3].into_iter().enumerate() {
                    counting.begin(row(20_000_000 + k as u64 * 10_000_001, rate)).unwrap();
                    while let Some(sample) = counting.next() {
                        last += 1;
                        assert_eq!(sample.sequence, last);
                        stamps.push(sample.device_time.ns);
                        sum += i64::from(sample.delta_theta[0]);
                    }
                }
                (stamps, sum)
            };
            let (whole, sum) = run(1);
            let (parts, split_sum) = run(3);
            assert_eq!((whole.len(), parts.len()), (3, 9));
            assert_eq!(sum, split_sum, "{quantity:?}: the remainder is carried");
            assert_eq!(parts.iter().skip(2).step_by(3).copied().collect::<Vec<_>>(), whole);
            let steps: Vec<u64> = parts.windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert!(steps.iter().all(|step| (3_333_333..=3_333_334).contains(step)), "{steps:?}");
        }
    }

    #[test]
    fn a_part_holds_a_faster_rate() {
        let flagged = |split: u32| {
            let mut counting = Counting::new(RecordedQuantity::Rates, 10_000_000, split).unwrap();
            // 390 °/s: 2³¹ counts in 10 ms are 179 °/s.
            counting.begin(row(10_000_000, 6.8)).unwrap();
            while counting.next().is_some() {}
            counting.saturated()
        };
        assert_eq!((flagged(1), flagged(2), flagged(3)), (1, 2, 0));
    }

    #[test]
    fn a_first_row_near_time_zero_has_no_stamp_before_it() {
        let mut counting = Counting::new(RecordedQuantity::Rates, 10, 5).unwrap();
        counting.begin(row(5, 0.0)).unwrap();
        let stamps: Vec<u64> =
            std::iter::from_fn(|| counting.next()).map(|sample| sample.device_time.ns).collect();
        assert_eq!(stamps, [1, 3, 5]);
        assert!(
            counting.begin(row(5, 0.0)).unwrap_err().contains("not after the one before, 5 ns")
        );
        assert!(counting.begin(row(9, 0.0)).unwrap_err().contains("expected 5 ns at least"));
        counting.begin(row(10, 0.0)).unwrap();
    }

    #[test]
    fn a_split_has_bounds() {
        for split in [0, SPLIT_MAX + 1] {
            assert!(Counting::new(RecordedQuantity::Rates, 10, split).is_err());
        }
    }
}
