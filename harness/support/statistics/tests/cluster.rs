//! The unit of inference: independent draws, not rows.

use octant_statistics::cluster::{DrawCounts, DrawTally, Growing, RowResult, draws};
use octant_statistics::proportion::Demand;
use proptest::prelude::*;
use std::collections::BTreeMap;

const ASKED: Demand = Demand { pass: 0.95, confidence: 0.95 };

/// Counts the draws of a design whose rows all passed, and tests whether they show the demand.
fn shown(rows: impl IntoIterator<Item = (u64, Option<String>)>) -> (DrawCounts, bool) {
    let of = draws(rows);
    let counts = DrawCounts::of(of.into_iter().map(|draw| (draw as usize, RowResult::Passed)));
    (counts, ASKED.is_shown(counts.not_passed, counts.known()))
}

#[test]
fn one_replicate_with_59_labels_is_one_draw() {
    let rows = || (0..59).map(|_| (1, Some("the same stream".to_owned())));
    let (counts, is_shown) = shown(rows());
    assert_eq!((counts.known(), counts.rows, is_shown), (1, 59, false));
    // Different seeds don't help if the streams are the same.
    let (counts, is_shown) = shown(rows().zip(1..).map(|((_, stream), seed)| (seed, stream)));
    assert_eq!((counts.known(), is_shown), (1, false));
}

#[test]
fn five_instruments_at_twelve_longitudes_are_five_draws() {
    let rows = (0..5)
        .flat_map(|seed| (0..12).map(move |at| (seed, Some(format!("stream {seed} at {at}")))));
    let (counts, is_shown) = shown(rows);
    assert_eq!((counts.known(), counts.rows, is_shown), (5, 60, false));
}

#[test]
fn fifty_nine_instruments_are_what_it_takes() {
    let of = |count: u64| shown((0..count).map(|seed| (seed, Some(seed.to_string()))));
    assert!(!of(58).1);
    assert!(of(59).1);
    // A valid counterpart of the labels: draws in twelve combinations with different streams.
    let rows = |count: u64| (0..count * 12).map(|row| (row / 12, Some(row.to_string())));
    assert!(!shown(rows(58)).1);
    assert!(shown(rows(59)).1);
}

#[test]
fn a_stream_that_two_draws_share_joins_all_their_rows() {
    let stream = |text: &str| Some(text.to_owned());
    let rows = vec![
        (1, stream("a")),
        (2, stream("b")),
        (3, stream("c")),
        (1, stream("d")),
        (3, stream("d")),
        (4, None),
        (5, None),
    ];
    assert_eq!(draws(rows), [0, 1, 0, 0, 0, 2, 3]);
}

#[test]
fn a_draw_passes_if_all_of_its_rows_do() {
    let rows = [
        (0, Some(true)),
        (0, Some(true)),
        (1, Some(true)),
        (1, Some(false)),
        (2, Some(true)),
        (2, None),
        (3, None),
        (3, Some(false)),
    ];
    let counts = DrawCounts::of(rows.map(|(draw, passed)| (draw, RowResult::of(passed))));
    assert_eq!(counts, DrawCounts { passed: 1, not_passed: 2, unknown: 0, open: 1, rows: 8 });
    assert_eq!((counts.known(), counts.all()), (3, 4));
}

#[test]
fn a_row_that_came_to_nothing_is_neither_kept_nor_broken() {
    let rows = [
        (0, RowResult::Passed),
        (0, RowResult::Unknown),
        (1, RowResult::Open),
        (1, RowResult::Unknown),
        (2, RowResult::Unknown),
        (2, RowResult::Failed),
    ];
    let counts = DrawCounts::of(rows);
    assert_eq!(counts, DrawCounts { passed: 0, not_passed: 3, unknown: 2, open: 0, rows: 6 });
    assert_eq!(counts.failed(), 1);
    let mut growing = Growing::default();
    for draw in 0..3 {
        growing.add(rows.iter().filter(|row| row.0 == draw).map(|row| (row.1, None::<u8>)));
    }
    assert_eq!(growing.counts(), counts);
}

/// Draws by their definition: rows are joined until nothing changes.
fn joined(rows: &[(u8, Option<u8>)]) -> Vec<usize> {
    let mut of: Vec<usize> = (0..rows.len()).collect();
    loop {
        let before = of.clone();
        for (a, (seed, stream)) in rows.iter().enumerate() {
            for (b, (other, of_other)) in rows.iter().enumerate() {
                if seed == other || (stream.is_some() && stream == of_other) {
                    of[a] = of[a].min(of[b]);
                }
            }
        }
        if of == before {
            break;
        }
    }
    let mut numbers = BTreeMap::new();
    for first in &of {
        let next = numbers.len();
        numbers.entry(*first).or_insert(next);
    }
    of.iter().map(|first| numbers[first]).collect()
}

proptest! {
    #[test]
    fn rows_are_joined_by_seeds_and_streams(
        rows in prop::collection::vec((0u8..12, prop::option::of(0u8..12)), 0..30),
    ) {
        let found: Vec<usize> = draws(rows.iter().copied()).into_iter().map(|d| d as usize).collect();
        prop_assert_eq!(found, joined(&rows));
    }

    /// Numbers near each other and far apart, in any order.
    #[test]
    fn a_tally_keeps_the_worst_of_each_draw(
        rows in prop::collection::vec(
            (prop_oneof![0usize..9, 4090usize..4105, any::<usize>()], prop::option::of(any::<bool>())),
            0..60,
        ),
    ) {
        let (mut tally, mut worst) = (DrawTally::default(), BTreeMap::new());
        for (draw, passed) in &rows {
            tally.add(*draw, RowResult::of(*passed));
            let all: &mut Vec<Option<bool>> = worst.entry(*draw).or_default();
            all.push(*passed);
        }
        let results: Vec<Option<bool>> = worst
            .values()
            .map(|all| match all {
                all if all.contains(&Some(false)) => Some(false),
                all if all.contains(&None) => None,
                _ => Some(true),
            })
            .collect();
        let expected: Vec<_> = results.iter().map(|passed| RowResult::of(*passed)).collect();
        prop_assert_eq!(tally.results().collect::<Vec<_>>(), expected);
        let count = |wanted| results.iter().filter(|result| **result == wanted).count() as u64;
        let counts = tally.counts();
        prop_assert_eq!((counts.passed, counts.not_passed), (count(Some(true)), count(Some(false))));
        prop_assert_eq!((counts.open, counts.rows), (count(None), rows.len() as u64));
    }

    #[test]
    fn draws_that_come_one_by_one_are_the_same(
        seeds in prop::collection::vec(
            prop::collection::vec((any::<bool>(), prop::option::of(0u8..12)), 1..5), 0..20),
    ) {
        let mut growing = Growing::default();
        for so_far in 0..seeds.len() {
            growing.add(seeds[so_far].iter().map(|(passed, stream)| (RowResult::of(Some(*passed)), *stream)));
            let rows: Vec<_> = (seeds[..=so_far].iter().enumerate())
                .flat_map(|(seed, rows)| rows.iter().map(move |(passed, stream)| (seed, *passed, *stream)))
                .collect();
            let of = draws(rows.iter().map(|(seed, _, stream)| (*seed, *stream)));
            let all = DrawCounts::of(of.into_iter().zip(&rows).map(|(draw, row)| (draw as usize, RowResult::of(Some(row.1)))));
            prop_assert_eq!(growing.counts(), all);
        }
    }
}
