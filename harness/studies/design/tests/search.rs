//! The search: how close it comes to the bound, and that nothing but problem and seed decides it.

use crate::cells::CELLS;
use octant_calibration::config::TurntableRates;
use octant_calibration::positions::{EIGHT, from_degrees};
use octant_calibration::schedule::moves_s;
use octant_design::bound::bound;
use octant_design::candidate::{Gimbals, Limits};
use octant_design::contribution::Contribution;
use octant_design::lead_in::quick_round_s;
use octant_design::measure::DesignMeasure;
use octant_design::search::{Found, SearchEffort, SearchError, SearchProblem, SearchState};
use octant_design::setup::Rotation;

fn problem(cell: usize, rotation: Rotation, limits: Limits) -> SearchProblem {
    let setup = CELLS[cell].setup(rotation);
    SearchProblem::new(setup, DesignMeasure::named("longitude").unwrap(), limits, 1).unwrap()
}

fn search(problem: &SearchProblem, effort: SearchEffort) -> Found {
    problem.search(effort, 2, None, &mut |_, _, _| true).unwrap()
}

/// Rates of a turntable by default.
const RATES: TurntableRates = TurntableRates {
    rate_radps: 10.0 * octant_earth::units::DEG,
    acceleration_radps2: 10.0 * octant_earth::units::DEG,
};
const SHORT: SearchEffort = SearchEffort { chains: 4, rounds: 3, steps: 10 };

#[test]
#[ignore = "a study: docs/testing.md"]
fn designs_come_close_to_the_bound() {
    let effort = SearchEffort { chains: 16, rounds: 40, steps: 100 };
    for (cell, rotation) in
        (0..6).flat_map(|c| [(c, Rotation::Sixteen), (c, Rotation::Tetrahedral)])
    {
        let problem = problem(cell, rotation, Limits::default());
        let started = std::time::Instant::now();
        let mut told = |state: &SearchState, _: usize, best: f64| {
            if state.round.is_multiple_of(10) {
                println!("  {} {best:.4}", state.round);
            }
            true
        };
        let found = problem.search(effort, 2, None, &mut told).unwrap();
        let bound = bound(&problem.judge(), problem.duration_s).unwrap().value;
        println!(
            "{cell} {rotation:?} {:.4} {bound:.4} {:+.1} % {:?}\n{:?}",
            found.score,
            100.0 * (found.score / bound - 1.0),
            started.elapsed(),
            found.stops
        );
        let best = CELLS[cell].best;
        println!("  found elsewhere for sixteen moves: {best}");
        let large = CELLS[cell].g >= 2e-3 || rotation == Rotation::Tetrahedral;
        assert!(!large || found.score < 1.05 * bound, "{} {bound}", found.score);
    }
}

#[test]
fn threads_and_interrupts_do_not_change_the_result() {
    let problem = problem(1, Rotation::Sixteen, Limits::default());
    let one = problem.search(SHORT, 1, None, &mut |_, _, _| true).unwrap();
    let three = problem.search(SHORT, 3, None, &mut |_, _, _| true).unwrap();
    assert_eq!((&one.stops, one.score.to_bits()), (&three.stops, three.score.to_bits()));
    let mut stored = None;
    let mut ended = |state: &SearchState, _: usize, _: f64| {
        stored = Some(serde_json::to_string(state).unwrap());
        false
    };
    let interrupted = problem.search(SHORT, 2, None, &mut ended).unwrap_err();
    assert!(matches!(interrupted, SearchError::Interrupted { done: 1, rounds: 3 }));
    let state: SearchState = serde_json::from_str(&stored.unwrap()).unwrap();
    let resumed = problem.search(SHORT, 2, Some(state.clone()), &mut |_, _, _| true).unwrap();
    assert_eq!((&one.stops, one.score.to_bits()), (&resumed.stops, resumed.score.to_bits()));
    let other = SearchProblem { seed: 2, ..problem };
    let refused = other.search(SHORT, 2, Some(state), &mut |_, _, _| true).unwrap_err();
    assert!(matches!(refused, SearchError::OtherSearch));
}

#[test]
fn designs_keep_the_limits() {
    let all = [
        Limits {
            gimbals: Gimbals::One,
            azimuth_deg: (0, 180),
            roll_deg: (-90, 90),
            ..Limits::default()
        },
        Limits { gimbals: Gimbals::Azimuth, grid_deg: 30, stops_max: 9, ..Limits::default() },
        Limits {
            gimbals: Gimbals::Roll,
            dwell_min_s: 600.0,
            lead_in_s: 1200.0,
            ..Limits::default()
        },
    ];
    for limits in all {
        let problem = problem(1, Rotation::Sixteen, limits);
        let found = search(&problem, SHORT);
        assert!(limits.keep(&found.stops), "{found:?}");
        let contributions = problem.contributions(&mut problem.judge(), &found.sequence).unwrap();
        assert!(contributions[0].dwell_s >= limits.lead_in_s);
        assert!(contributions.iter().all(|stop| stop.dwell_s >= limits.dwell_min_s));
        let last = contributions.last().unwrap();
        assert!((last.measure_so_far / found.score - 1.0).abs() < 1e-12);
        assert!((last.until_s - problem.duration_s).abs() < 1e-6);
    }
}

#[test]
fn a_quick_round_of_the_eight_positions_leads_in() {
    let limits = Limits { round_s: 900.0, ..Limits::default() };
    let problem = problem(1, Rotation::Tetrahedral, limits);
    let found = search(&problem, SHORT);
    let contributions = problem.contributions(&mut problem.judge(), &found.sequence).unwrap();
    let angles = |stop: &Contribution| (stop.azimuth_deg.round(), stop.roll_deg.round());
    let round: Vec<(f64, f64)> = EIGHT.iter().map(|(azimuth, roll, _)| (*azimuth, *roll)).collect();
    assert_eq!(contributions[..EIGHT.len()].iter().map(angles).collect::<Vec<_>>(), round);
    // Alignment and round take as long as asked for; shares of the time are whole numbers.
    assert!(contributions[0].dwell_s >= limits.lead_in_s);
    // Shares are whole numbers: each dwell is longer by less than a share and a part in hundred.
    let share_s = contributions[1].dwell_s / f64::from(found.stops[1].share);
    let moves_s = moves_s(&from_degrees(EIGHT, 1).unwrap(), &RATES);
    for (stop, (.., weight)) in contributions[1..EIGHT.len() - 1].iter().zip(&EIGHT[1..]) {
        let least_s = (900.0 - moves_s) / 20.0 * weight;
        let longer_s = stop.dwell_s - least_s;
        assert!((-1e-3..1.1 * share_s).contains(&longer_s), "{longer_s} {share_s}");
    }
    // The dwell that ends the round is part of the next one.
    let ended_s = contributions[EIGHT.len() - 2].until_s;
    let asked_s = 300.0 + 900.0 - (900.0 - moves_s) / 20.0;
    assert!((0.0..21.0 * share_s).contains(&(ended_s - asked_s)), "{ended_s} {asked_s} {share_s}");
    let narrow = Limits { azimuth_deg: (0, 90), ..limits };
    let short = Limits { round_s: 300.0, ..limits };
    let many = Limits { stops_max: 60, ..limits };
    for refused in [narrow, short, many] {
        let made = SearchProblem::new(problem.setup.clone(), problem.measure, refused, 1);
        assert!(made.is_err(), "{refused:?}");
    }
    let rates = &problem.setup.conditions.platform.rates;
    assert_eq!(quick_round_s(&Limits::default(), 4.0 * 3600.0, rates), Some(1200.0));
    assert_eq!(quick_round_s(&limits, 4.0 * 3600.0, rates), None);
    assert_eq!(quick_round_s(&Limits { round_s: 0.0, ..narrow }, 4.0 * 3600.0, rates), None);
}

#[test]
fn limits_that_leave_nothing_are_refused() {
    let setup = CELLS[1].setup(Rotation::Sixteen);
    let measure = DesignMeasure::named("longitude").unwrap();
    for limits in [
        Limits { grid_deg: 0, ..Limits::default() },
        Limits { azimuth_deg: (30, 90), ..Limits::default() },
        Limits { roll_deg: (0, 30), gimbals: Gimbals::Roll, ..Limits::default() },
        Limits { stops_max: 65, ..Limits::default() },
    ] {
        assert!(SearchProblem::new(setup.clone(), measure, limits, 1).is_err(), "{limits:?}");
    }
    let late = Limits { lead_in_s: 5.0 * 3600.0, ..Limits::default() };
    let problem = SearchProblem::new(setup, measure, late, 1).unwrap();
    let found = problem.search(SHORT, 2, None, &mut |_, _, _| true).unwrap_err();
    assert!(matches!(found, SearchError::NothingFits { .. }));
}

#[test]
fn a_shorter_calibration_keeps_the_drift_of_eight_positions() {
    let problem = problem(1, Rotation::Tetrahedral, Limits::default());
    let effort = SearchEffort { chains: 4, rounds: 4, steps: 30 };
    // Eight positions in 4 h with sixteen moves.
    let shortest = problem.shortest(3.29, effort, 2, &mut |_, _, _, _| true).unwrap().unwrap();
    println!("{} {}", shortest.duration_s, shortest.bound_s);
    assert!(shortest.found.score <= 3.29);
    assert!(shortest.bound_s <= shortest.duration_s && shortest.duration_s < 4.0 * 3600.0);
    // No sequence reaches a drift below the bound.
    assert!(problem.shortest(1.0, effort, 2, &mut |_, _, _, _| true).unwrap().is_none());
}
