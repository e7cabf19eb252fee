//! Converts measured quantities of a real instrument into the integer counts of a sample.
//!
//! Rows may be missing. A gap is not repaired here: the row after it stands for one period, as every other row does, its
//! sample's number is advanced by the missing samples, and the core bridges the gap.

use octant_base::number::{counted, plain};
use octant_recorder::event::{BenchReadings, BenchRecord};
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

/// More missing rows than one for so many that are there make a file incomplete.
pub(super) const MISSING_MAX: u64 = 10;

/// Converts rows into counts and carries the remainder of each axis.
///
/// A row may be split into equal parts of its interval, so that counts can hold faster rates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counting {
    quantity: RecordedQuantity,
    period: FittedPeriod,
    /// Number of samples per row.
    split: u64,
    previous_ns: Option<u64>,
    pending: Option<Pending>,
    sequence: u64,
    rows: u64,
    gaps: Gaps,
    triads: Triads,
}

/// Mean interval of the rows so far that follow each other without a gap; the nominal one counts as the first.
#[derive(Clone, Copy, Debug)]
struct FittedPeriod {
    sum_ns: u64,
    intervals: u64,
}

impl FittedPeriod {
    fn ns(self) -> u64 {
        self.sum_ns / self.intervals
    }

    /// Takes the interval before a row: returns the number of missing rows, 0 for an interval of up to one and a half
    /// periods.
    fn missing(&mut self, interval_ns: u64) -> u64 {
        let period_ns = self.ns();
        if u128::from(interval_ns) * 2 <= u128::from(period_ns) * 3 {
            self.sum_ns = self.sum_ns.saturating_add(interval_ns);
            self.intervals += 1;
            return 0;
        }
        // Rounded to whole rows, and one at least.
        ((interval_ns - period_ns / 2) / period_ns).max(1)
    }
}

/// Gaps between rows.
#[derive(Clone, Copy, Debug, Default)]
struct Gaps {
    count: u64,
    /// Number of rows that are missing in all of them.
    missing: u64,
    longest_ns: u64,
    /// Stamp of the row before the first gap, ns.
    first_ns: u64,
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
            period: FittedPeriod { sum_ns: nominal_ns, intervals: 1 },
            split: u64::from(split),
            previous_ns: None,
            pending: None,
            sequence: 0,
            rows: 0,
            gaps: Gaps::default(),
            triads: Triads::default(),
        })
    }

    /// Describes gaps of which more rows are missing than a file may lack.
    pub(super) fn cut_short(&self, path: &str) -> Option<String> {
        let Gaps { missing, .. } = self.gaps;
        (missing > self.rows / MISSING_MAX).then(|| {
            format!(
                "{path} has gaps: {} missing, {} there",
                counted(missing, "row", "rows"),
                self.rows
            )
        })
    }

    /// Returns what the report says of a file with gaps; `None` without any.
    pub(super) fn bench(&self, path: &str) -> Option<Box<BenchRecord>> {
        let Gaps { count, missing, longest_ns, first_ns } = self.gaps;
        if count == 0 {
            return None;
        }
        let seconds = |ns: u64| plain(ns as f64 * 1e-9, 9);
        let instrument = format!(
            "{path}: {}, {}, the longest {} s, the first after the row of {} s",
            counted(self.rows, "row", "rows"),
            counted(count, "gap", "gaps"),
            seconds(longest_ns),
            seconds(first_ns),
        );
        let readings = BenchReadings {
            behind: 0,
            irregular: 0,
            missing: missing.saturating_mul(self.split),
            samples: self.sequence.saturating_sub(missing.saturating_mul(self.split)),
        };
        Some(Box::new(BenchRecord::of_file(instrument, readings)))
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
                let nominal_ns = self.period.ns();
                let part_ns = (nominal_ns / self.split).max(1);
                left = left.min(row.time_ns / part_ns + 1);
                nominal_ns
            }
            Some(previous) => match row.time_ns.checked_sub(previous) {
                Some(interval) if interval >= self.split => {
                    let missing = self.period.missing(interval);
                    if missing == 0 { interval } else { self.gap(previous, interval, missing) }
                }
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
        self.rows += 1;
        self.previous_ns = Some(row.time_ns);
        self.pending = Some(Pending { row, interval_ns, left });
        Ok(())
    }

    /// Counts a gap before a row; returns the interval for which the row stands, ns.
    #[cold]
    fn gap(&mut self, previous_ns: u64, interval_ns: u64, missing: u64) -> u64 {
        if self.gaps.count == 0 {
            self.gaps.first_ns = previous_ns;
        }
        let gap_ns = interval_ns.saturating_sub(self.period.ns());
        self.gaps.count += 1;
        self.gaps.missing = self.gaps.missing.saturating_add(missing);
        self.gaps.longest_ns = self.gaps.longest_ns.max(gap_ns);
        self.sequence = self.sequence.saturating_add(missing.saturating_mul(self.split));
        self.period.ns()
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
        self.sequence = self.sequence.saturating_add(1);
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

    /// Counts rows of 1e-3 rad/s with these stamps in periods of 5 ms; returns samples, and the record of the gaps.
    fn counted_rows(
        quantity: RecordedQuantity,
        split: u32,
        stamps: impl Iterator<Item = u64>,
    ) -> (Vec<Sample>, Counting) {
        let mut counting = Counting::new(quantity, 5_000_000, split).unwrap();
        let mut samples = Vec::new();
        let value = if quantity == RecordedQuantity::Rates { 1e-3 } else { 5e-6 };
        for stamp_ns in stamps {
            counting.begin(row(stamp_ns, value)).unwrap();
            samples.extend(std::iter::from_fn(|| counting.next()));
        }
        (samples, counting)
    }

    #[test]
    fn a_row_after_a_gap_stands_for_one_period() {
        for quantity in [RecordedQuantity::Rates, RecordedQuantity::Increments] {
            // Rows 41 to 240 are missing, 1 s, and row 261.
            let present = |k: &u64| !(41..=240).contains(k) && *k != 261;
            let stamps = (1..=400).filter(present).map(|k| k * 5_000_000);
            let (samples, counting) = counted_rows(quantity, 1, stamps);
            assert_eq!(samples.len(), 199);
            for sample in &samples {
                // 5e-6 rad are 343 597.4 counts.
                assert!((343_597..=343_598).contains(&sample.delta_theta[0]), "{sample:?}");
                assert_eq!(sample.sequence * 5_000_000, sample.device_time.ns);
            }
            let bench = counting.bench("a.csv").unwrap();
            assert_eq!(
                bench.instrument,
                "a.csv: 199 rows, 2 gaps, the longest 1 s, the first after the row of 0.2 s"
            );
            assert_eq!((bench.readings.samples, bench.readings.missing), (199, 201));
            assert_eq!(
                counting.cut_short("a.csv").unwrap(),
                "a.csv has gaps: 201 rows missing, 199 there"
            );
        }
    }

    #[test]
    fn parts_of_a_row_after_a_gap_have_its_period() {
        let (samples, counting) = counted_rows(
            RecordedQuantity::Rates,
            5,
            (1..=60).filter(|k| *k != 30).map(|k| k * 5_000_000),
        );
        assert_eq!(samples.len(), 5 * 59);
        for sample in &samples {
            assert_eq!(sample.sequence * 1_000_000, sample.device_time.ns);
            assert!((68_719..=68_720).contains(&sample.delta_theta[0]), "{sample:?}");
        }
        assert_eq!(counting.bench("a.csv").unwrap().readings.missing, 5);
        assert_eq!(counting.cut_short("a.csv"), None);
    }

    #[test]
    fn an_interval_of_up_to_one_and_a_half_fitted_periods_is_no_gap() {
        // The unit's clock is 4 % slow: its period is 5.2 ms, of which 7.7 ms is less than one and a half.
        let slow = (1..=400).map(|k| k * 5_200_000);
        let late = slow.clone().chain(std::iter::once(400 * 5_200_000 + 7_700_000));
        let (samples, counting) = counted_rows(RecordedQuantity::Rates, 1, late);
        assert!(counting.bench("a.csv").is_none());
        let last = samples.last().unwrap();
        assert_eq!((last.sequence, last.delta_theta[0]), (401, 529_140), "7.7e-6 rad");
        let beyond = slow.chain(std::iter::once(400 * 5_200_000 + 7_900_000));
        let (samples, counting) = counted_rows(RecordedQuantity::Rates, 1, beyond);
        let last = samples.last().unwrap();
        assert!((357_000..358_000).contains(&last.delta_theta[0]), "one fitted period: {last:?}");
        assert_eq!((last.sequence, counting.gaps.count), (402, 1));
    }

    #[test]
    fn rows_of_half_the_rate_are_a_file_with_gaps() {
        let half = (1..=100).map(|k| k * 10_000_000);
        let (_, counting) = counted_rows(RecordedQuantity::Rates, 1, half);
        assert_eq!(
            counting.cut_short("a.csv").unwrap(),
            "a.csv has gaps: 99 rows missing, 100 there"
        );
    }

    #[test]
    fn a_split_has_bounds() {
        for split in [0, SPLIT_MAX + 1] {
            assert!(Counting::new(RecordedQuantity::Rates, 10, split).is_err());
        }
    }
}
