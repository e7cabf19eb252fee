//! Rows as counts: parts, gaps, and the account of the rows.

use crate::counting::{Counted, Counting, CountingError, Measured, RowWords};
use octant_sample::Sample;
use octant_scenario::recorded::{RecordedQuantity, SPLIT_MAX};

const WORDS: RowWords =
    RowWords { unit: ["row", "rows"], at: "line", other_times: "write time_column" };

/// Samples of rows, up to an error.
fn samples(
    counting: &mut Counting,
    rows: impl Iterator<Item = Measured>,
) -> Result<Vec<Sample>, CountingError> {
    let (mut rows, mut samples) = (rows, Vec::new());
    loop {
        match counting.next()? {
            Counted::Sample(sample) => samples.push(sample),
            Counted::End => return Ok(samples),
            Counted::More => match rows.next() {
                Some(row) => counting.push(row),
                None => counting.end(),
            },
        }
    }
}

fn row(time_ns: u64, rate: f64) -> Measured {
    Measured {
        place: time_ns,
        stamp_ns: Some(time_ns),
        gyro: [rate, 0.0, 0.0],
        accel: [0.0, 0.0, 9.8],
        gimbal_rad: None,
        temperature: f64::NAN,
    }
}

#[test]
fn parts_have_even_stamps_and_the_sum_of_the_row() {
    for quantity in [RecordedQuantity::Rates, RecordedQuantity::Increments] {
        let run = |split: u32| {
            let mut counting = Counting::new(quantity, 100.0, split, WORDS).unwrap();
            let rows = [1e-3, -2e-3, 3e-3].into_iter().enumerate();
            let rows = rows.map(|(k, rate)| row(20_000_000 + k as u64 * 10_000_000, rate));
            let samples = samples(&mut counting, rows).unwrap();
            assert!(samples.iter().enumerate().all(|(k, sample)| sample.sequence == k as u64 + 1));
            let sum: i64 = samples.iter().map(|sample| i64::from(sample.delta_theta[0])).sum();
            (samples.iter().map(|sample| sample.device_time.ns).collect::<Vec<u64>>(), sum)
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
        let mut counting = Counting::new(RecordedQuantity::Rates, 100.0, split, WORDS).unwrap();
        // 390 °/s: 2³¹ counts in 10 ms are 179 °/s.
        samples(&mut counting, std::iter::once(row(10_000_000, 6.8))).unwrap();
        counting.saturated()
    };
    assert_eq!((flagged(1), flagged(2), flagged(3)), (1, 2, 0));
}

#[test]
fn a_first_row_near_time_zero_has_no_stamp_before_it() {
    let mut counting = Counting::new(RecordedQuantity::Rates, 1e8, 5, WORDS).unwrap();
    let samples = samples(&mut counting, [5, 15].into_iter().map(|ns| row(ns, 0.0))).unwrap();
    let stamps: Vec<u64> = samples.iter().map(|sample| sample.device_time.ns).collect();
    assert_eq!(stamps, [1, 3, 5, 7, 9, 11, 13, 15]);
}

#[test]
fn a_row_is_no_shorter_than_its_parts() {
    let mut counting = Counting::new(RecordedQuantity::Rates, 1e8, 20, WORDS).unwrap();
    let error = samples(&mut counting, std::iter::once(row(5, 0.0))).unwrap_err();
    assert_eq!(error.place, 5);
    assert!(error.reason.contains("expected 20 ns at least"), "{error:?}");
}

/// Counts rows of 1e-3 rad/s with these stamps in periods of 5 ms; returns samples, and the record of the gaps.
fn counted_rows(
    quantity: RecordedQuantity,
    split: u32,
    stamps: impl Iterator<Item = u64>,
) -> (Vec<Sample>, Counting) {
    let mut counting = Counting::new(quantity, 200.0, split, WORDS).unwrap();
    let value = if quantity == RecordedQuantity::Rates { 1e-3 } else { 5e-6 };
    let samples = samples(&mut counting, stamps.map(|ns| row(ns, value))).unwrap();
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
            "a.csv: 199 rows, 2 gaps, the longest 1 s, the first after the one of 0.2 s"
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
fn rows_of_another_rate_are_refused_with_the_rate_to_write() {
    let half = (1..=100).map(|k| row(k * 10_000_000, 1e-3));
    let mut counting = Counting::new(RecordedQuantity::Rates, 200.0, 1, WORDS).unwrap();
    let error = samples(&mut counting, half).unwrap_err();
    assert!(error.reason.contains("rows come at 100 Hz"), "{error:?}");
}

#[test]
fn what_becomes_of_each_row_is_in_the_account() {
    // Row 100 is there twice, row 150 has a late stamp, rows 200 to 219 are missing.
    let stamps = (1..=400_u64).filter(|k| !(200..220).contains(k)).flat_map(|k| {
        let ns = k * 5_000_000 + if k == 150 { 2_000_000 } else { 0 };
        std::iter::repeat_n(ns, if k == 100 { 2 } else { 1 })
    });
    let (samples, counting) = counted_rows(RecordedQuantity::Rates, 1, stamps);
    assert_eq!(samples.len(), 380);
    let account = counting.account("a.csv", None);
    // One stamp of 380 is off by 2 ms: 2 / sqrt(380) = 0.103 ms, and sqrt(12) 0.103 ms / (380 * 400^2)^(1/2) / 5 ms of the
    // rate, 9 ppm.
    assert_eq!(
        account.lines(),
        [
            "a.csv: 381 rows read, 380 used, 1 repaired, 1 left out, 20 missing",
            "repaired: 1 row off the fitted time by more than 0.25 ms, and given that time, the first in line 752000000",
            "left out: 1 rows that are there twice, the first in line 500000000",
            "missing: 20 rows in 1 gap, the longest 0.1 s, the first before line 1100000000, after the one of 0.995 s; \
             the core bridges it",
            "clock: 200.000751 Hz, +3.754 ± 8.9 ppm from the configured 200 Hz; stamps scatter by 0.103 ms (1 sigma), 2 ms at most; \
             no clock outside shows the error of this one",
        ]
    );
}

#[test]
fn a_split_has_bounds() {
    for split in [0, SPLIT_MAX + 1] {
        assert!(Counting::new(RecordedQuantity::Rates, 10.0, split, WORDS).is_err());
    }
}
