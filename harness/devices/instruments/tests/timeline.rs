//! Times of readings: jitter, bursts, gaps, repeated readings, clocks that go back, other rates.

use octant_instruments::timeline::{AHEAD, Ahead, Misplaced, Placed, Timeline};
use proptest::prelude::*;

/// Places stamps, each with those behind it; a repeated reading is left out.
fn placed(rate_hz: f64, stamps: &[u64]) -> (Vec<Placed>, Timeline, Option<(usize, Misplaced)>) {
    let mut timeline = Timeline::new(rate_hz);
    let mut all = Vec::new();
    for (k, stamp) in stamps.iter().enumerate() {
        let until = (k + 1 + AHEAD).min(stamps.len());
        match timeline.place(Some(*stamp), None, || Ahead::of(&stamps[k + 1..until], &[])) {
            Ok(one) => all.push(one),
            Err(Misplaced::Repeated) => {}
            Err(end) => return (all, timeline, Some((k, end))),
        }
    }
    (all, timeline, None)
}

/// Uniform numbers from 0 to 1 (Knuth's linear congruential generator, MMIX).
fn uniform(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Numbers of the readings that are there, from 0.
fn numbers(count: u64, is_lost: impl Fn(u64) -> bool) -> Vec<u64> {
    (0..count).filter(|k| !is_lost(*k)).collect()
}

#[test]
fn regular_stamps_are_their_own_times() {
    // Rates of whole and of broken nanoseconds, at the rate that is configured and 300 ppm beside it.
    for (rate_hz, period_ns) in
        [(200.0, 5e6), (60.0, 1e9 / 60.0), (819.2, 1e9 / 819.2), (2460.0, 1e9 / 2460.0)]
    {
        for error in [0.0, 3e-4, -3e-4] {
            let stamps: Vec<u64> = (0..20_000_u64)
                .map(|k| {
                    1_700_000_000_000_000_000
                        + (k as f64 * period_ns * (1.0 + error)).round() as u64
                })
                .collect();
            let (all, timeline, end) = placed(rate_hz, &stamps);
            assert_eq!((end, all.len()), (None, stamps.len()));
            for (one, stamp) in all.iter().zip(&stamps) {
                assert!(one.time_ns.abs_diff(*stamp) <= 1, "{rate_hz} Hz: {one:?}, stamp {stamp}");
            }
            let exact = error == 0.0 && period_ns.fract() == 0.0;
            let is_exact = all.iter().zip(&stamps).all(|(one, stamp)| one.time_ns == *stamp);
            assert!(!exact || is_exact);
            let rate = timeline.rate().unwrap();
            assert!((rate.ppm + error * 1e6).abs() < 0.1 + 1e-3 * rate.ppm.abs(), "{rate:?}");
            assert!(rate.sigma_ppm < 0.01, "{rate:?}");
            let tally = timeline.tally();
            assert_eq!((tally.gaps, tally.shifted, tally.repeated), (0, 0, 0), "{tally:?}");
        }
    }
}

#[test]
fn intervals_sum_up_to_the_time_and_follow_the_fit_and_not_the_jitter() {
    let mut random = uniform(7);
    // Arrivals up to 4 ms late of readings every 5 ms, by a clock 200 ppm off.
    let stamps: Vec<u64> = (0..60_000_u64)
        .map(|k| 1_000_000_000 + (k as f64 * 5.001e6 + 4e6 * random()) as u64)
        .collect();
    let (all, timeline, end) = placed(200.0, &stamps);
    assert_eq!((end, all.len()), (None, 60_000));
    assert_eq!(timeline.tally().gaps, 0);
    for pair in all.windows(2) {
        assert_eq!(pair[1].time_ns - pair[0].time_ns, pair[1].interval_ns);
    }
    for (k, one) in all.iter().enumerate().skip(2000) {
        // The mean delay of 2 ms is a constant; the fit of 2000 stamps of 1.15 ms scatter has 2 x 1.15 / sqrt(2000) = 0.05 ms.
        let off_ns = one.time_ns as f64 - 1_002_000_000.0 - k as f64 * 5.001e6;
        assert!(off_ns.abs() < 0.35e6, "reading {k}: {off_ns} ns");
        assert!((one.interval_ns as f64 - 5.001e6).abs() < 0.02e6, "reading {k}: {one:?}");
    }
    let rate = timeline.rate().unwrap();
    // Uniform over 4 ms: 4/sqrt(12) ms.
    assert!((rate.scatter_s - 4e-3 / 12_f64.sqrt()).abs() < 2e-5, "{rate:?}");
    // sqrt(12) sigma / (n^1.5 period) = 0.054 ppm.
    let sigma_ppm = 12_f64.sqrt() * 4e-3 / 12_f64.sqrt() / 60_000_f64.powf(1.5) / 5e-3 * 1e6;
    assert!((rate.sigma_ppm / sigma_ppm - 1.0).abs() < 0.05, "{rate:?}, expected {sigma_ppm}");
    assert!((rate.ppm + 199.96).abs() < 4.0 * rate.sigma_ppm + 0.01, "{rate:?}");
    assert!(!timeline.is_blind());
}

#[test]
fn every_gap_is_found_where_it_is_and_as_long_as_it_is() {
    let mut random = uniform(3);
    for (jitter_ns, lost) in [
        (0.0, vec![(100, 1), (300, 2), (310, 1), (400, 60), (900, 1000), (2400, 1)]),
        (1.5e6, vec![(100, 1), (300, 2), (400, 60), (900, 1000), (2400, 1)]),
        (4e6, vec![(400, 2), (900, 1000), (2400, 60), (3000, 1)]),
    ] {
        let is_lost = |k: u64| lost.iter().any(|(from, n)| (*from..from + n).contains(&k));
        let there = numbers(4000, is_lost);
        let stamps: Vec<u64> = there
            .iter()
            .map(|k| 7_000_000 + k * 5_000_000 + (jitter_ns * random()) as u64)
            .collect();
        let (all, timeline, end) = placed(200.0, &stamps);
        assert_eq!(end, None);
        let tally = timeline.tally();
        let missing: u64 = lost.iter().map(|(_, n)| n).sum();
        assert_eq!(
            (tally.gaps, tally.missing),
            (lost.len() as u64, missing),
            "{jitter_ns}: {tally:?}"
        );
        assert!((tally.longest_s - 5.0).abs() < 0.01);
        // With jitter the place may be a few readings off; far from a gap the number is right.
        let near = if jitter_ns < 2e6 { 0 } else { AHEAD as u64 };
        for (one, k) in all.iter().zip(&there) {
            let is_near = lost.iter().any(|(from, n)| k + near > *from && *k < from + n + near);
            assert!(one.number == *k || (near > 0 && is_near), "{jitter_ns}: {one:?}, reading {k}");
        }
        for one in all.iter().filter(|one| one.missing > 0) {
            assert!(
                (one.interval_ns as f64 - 5e6).abs() < 0.3e6,
                "{one:?}: one period behind a gap"
            );
        }
    }
}

#[test]
fn stamps_of_bursts_and_of_few_digits_are_no_gaps_and_a_gap_among_them_is_one() {
    type Digits = fn(u64) -> u64;
    let of = |digits: Digits, lost: u64| {
        let there = numbers(4000, |k| (1000..1000 + lost).contains(&k));
        let stamps: Vec<u64> = there.iter().map(|k| digits(k * 5_000_000)).collect();
        placed(200.0, &stamps)
    };
    let forms: [(&str, Digits); 4] = [
        ("four readings of one stamp", |ns| ns / 20_000_000 * 20_000_000),
        ("10 ms", |ns| (ns + 5_000_000) / 10_000_000 * 10_000_000),
        (
            "one stamp in eight twice",
            |ns| if ns / 5_000_000 % 8 == 3 { ns - 5_000_000 } else { ns },
        ),
        ("a hiccup of the host, caught up", |ns| {
            let k = ns / 5_000_000;
            if (2000..2010).contains(&k) { 2010 * 5_000_000 + (k - 2000) * 100_000 } else { ns }
        }),
    ];
    for (name, digits) in forms {
        for lost in [0, 1, 40] {
            let (all, timeline, end) = of(digits, lost);
            assert_eq!(end, None, "{name}");
            let tally = timeline.tally();
            // A gap may be seen in two parts where stamps scatter by more than a period.
            assert_eq!((tally.missing, tally.repeated), (lost, 0), "{name}: {tally:?}");
            assert!(tally.gaps <= lost.min(2), "{name}: {tally:?}");
            assert!(tally.shifted > 8, "{name}: {tally:?}");
            let last = all.last().unwrap();
            assert_eq!(last.number, 3999, "{name}");
            assert!(last.time_ns.abs_diff(3999 * 5_000_000) < 15_000_000, "{name}: {last:?}");
            assert!(all.windows(2).all(|pair| pair[1].time_ns > pair[0].time_ns), "{name}");
        }
    }
}

#[test]
fn stamps_that_can_not_show_a_missing_reading_say_so() {
    let mut random = uniform(11);
    let stamps: Vec<u64> =
        (0..4000_u64).map(|k| k * 5_000_000 + (30e6 * random()) as u64).collect();
    let (_, timeline, end) = placed(200.0, &stamps);
    assert_eq!(end, None);
    assert!(timeline.is_blind(), "{:?}", timeline.rate());
    assert_eq!(timeline.tally().gaps, 0);
}

#[test]
fn a_reading_that_is_there_twice_is_left_out() {
    let stamps: Vec<u64> = (0..1000_u64)
        .flat_map(|k| std::iter::repeat_n(k * 5_000_000, if k % 100 == 50 { 2 } else { 1 }))
        .collect();
    let (all, timeline, end) = placed(200.0, &stamps);
    assert_eq!((end, all.len()), (None, 1000));
    assert_eq!((timeline.tally().repeated, timeline.tally().first_repeated), (10, 52));
    assert!(
        all.iter()
            .enumerate()
            .all(|(k, one)| one.number == k as u64 && one.time_ns == k as u64 * 5_000_000)
    );
}

#[test]
fn a_clock_that_goes_back_or_far_ahead_ends_the_line() {
    let jumped = |by_ns: i64| {
        let stamps: Vec<u64> = (0..1000_u64)
            .map(|k| {
                let ns = 5_000_000_000_000_000 + k * 5_000_000;
                if k < 600 { ns } else { ns.saturating_add_signed(by_ns) }
            })
            .collect();
        placed(200.0, &stamps).2
    };
    let Some((600, Misplaced::Back { from_s, to_s })) = jumped(-1_900_000_000) else { panic!() };
    assert!((from_s - to_s - 1.895).abs() < 1e-6, "{from_s} {to_s}");
    assert!(matches!(jumped(-4_000_000_000_000_000), Some((600, Misplaced::Back { .. }))));
    assert!(matches!(jumped(100_000_000_000_000), Some((600, Misplaced::Ahead { .. }))));
    assert_eq!(jumped(2_000_000_000), None, "a gap of two seconds");
}

#[test]
fn another_rate_is_told_with_what_was_found() {
    let of = |period_ns: u64, then_ns: u64| {
        let stamps: Vec<u64> = (0..1000_u64)
            .map(|k| k.min(500) * period_ns + k.saturating_sub(500) * then_ns)
            .collect();
        placed(100.0, &stamps).2
    };
    for (period_ns, found) in
        [(5_000_000, 200.0), (20_000_000, 50.0), (11_000_000, 90.909), (9_000_000, 111.11)]
    {
        let Some((_, Misplaced::Rate { found_hz, expected_hz, .. })) = of(period_ns, period_ns)
        else {
            panic!("{period_ns}");
        };
        assert!(
            (found_hz / found - 1.0).abs() < 0.01 && expected_hz > 99.0,
            "{found_hz} {expected_hz}"
        );
    }
    for (then_ns, found) in [(5_000_000, 200.0), (20_000_000, 50.0)] {
        let Some((k, Misplaced::Rate { found_hz, changed: true, .. })) = of(10_000_000, then_ns)
        else {
            panic!("{then_ns}");
        };
        assert!((found_hz - found).abs() < 1e-6 && (500..=502).contains(&k), "{k}: {found_hz}");
    }
    assert_eq!(of(10_200_000, 10_200_000), None, "two per cent are a cheap oscillator's");
}

#[test]
fn a_counter_decides_and_stamps_that_disagree_are_counted() {
    let mut timeline = Timeline::new(200.0);
    let place = |timeline: &mut Timeline, k: u64, stamp: Option<u64>| {
        timeline.place(stamp, Some(k), || Ahead::NONE)
    };
    for k in 100..200 {
        assert_eq!(place(&mut timeline, k, Some(k * 5_000_000)).unwrap().missing, 0);
    }
    assert_eq!(place(&mut timeline, 205, Some(205 * 5_000_000)).unwrap().missing, 5);
    assert_eq!(place(&mut timeline, 205, Some(205 * 5_000_000)), Err(Misplaced::Repeated));
    assert_eq!(place(&mut timeline, 206, Some(216 * 5_000_000)).unwrap().missing, 0);
    assert_eq!(timeline.tally().disagreeing, 1);
    assert!(matches!(place(&mut timeline, 3, Some(1)), Err(Misplaced::Back { .. })));
    // Without stamps, the count times the period: also one that isn't whole nanoseconds.
    let mut timeline = Timeline::new(60.0);
    let mut last = None;
    for k in 0..6000 {
        last = Some(place(&mut timeline, k, None).unwrap());
    }
    assert_eq!(last.unwrap().time_ns, 16_666_667 + (5999.0 * 1e9 / 60.0_f64).round() as u64);
    assert_eq!(timeline.rate(), None);
}

#[test]
fn readings_whose_stamp_is_missing_follow_the_line_of_the_others() {
    let mut timeline = Timeline::new(200.0);
    let mut last: Option<Placed> = None;
    // A clock 1000 ppm slow since long before, of which every third reading, and a stretch of 500, has no stamp.
    for k in 0..6000_u64 {
        let stamp_ns = 7_000_000_000_000 + k * 5_005_000;
        let has_stamp = k == 0 || (k % 3 != 1 && !(3000..3500).contains(&k));
        let one = timeline.place(has_stamp.then_some(stamp_ns), None, || Ahead::NONE).unwrap();
        if k > 1000 {
            assert!(one.time_ns.abs_diff(stamp_ns) < 20_000, "reading {k}: {one:?}");
            assert!(one.interval_ns.abs_diff(5_005_000) < 2_000, "reading {k}: {one:?}");
        }
        assert!(last.is_none_or(|last| one.number == last.number + 1), "reading {k}: {one:?}");
        last = Some(one);
    }
    assert_eq!(timeline.tally().gaps, 0);
}

proptest! {
    /// Times increase, and gaps and readings together are the count, whatever the stamps.
    #[test]
    fn nonsense_has_a_time_or_an_error(stamps in proptest::collection::vec(any::<u64>(), 0..60), small in any::<bool>()) {
        let stamps: Vec<u64> = stamps.iter().map(|s| if small { s % 1_000_000_000 } else { *s }).collect();
        let (all, timeline, _) = placed(200.0, &stamps);
        for pair in all.windows(2) {
            prop_assert!(pair[1].time_ns > pair[0].time_ns && pair[1].number > pair[0].number);
        }
        let tally = timeline.tally();
        if let Some(last) = all.last() {
            prop_assert!(last.number < all.len() as u64 + tally.missing);
        }
    }
}
