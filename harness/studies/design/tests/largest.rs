//! Largest errors by draws: against figures of another program, and of the runs.

use crate::cells::{CELLS, Cell};
use octant_calibration::covariance::{Covariance, PARAMETERS, STATE_COUNT};
use octant_calibration::positions::{from_degrees, named};
use octant_design::bound::bound;
use octant_design::candidate::Limits;
use octant_design::judge::{Judge, MeasureWeights};
use octant_design::largest::LargestErrors;
use octant_design::measure::DesignMeasure;
use octant_design::search::{SearchEffort, SearchProblem};
use octant_design::setup::{Rotation, Setup};
use octant_earth::ellipsoid::EARTH_RATE_RADPS;
use octant_earth::units::ARCMIN;

fn judge(setup: &Setup, name: &str) -> Judge {
    Judge::new(setup, &MeasureWeights::new(setup, DesignMeasure::named(name).unwrap()).unwrap())
}

/// Largest errors to 72 h after eight positions, once per 4 h.
fn eight(setup: &Setup, duration_s: f64) -> LargestErrors {
    let passes = (duration_s / (4.0 * 3600.0)) as u32;
    let sequence = from_degrees(named("eight").unwrap(), passes).unwrap();
    let all = setup.largest_after(&sequence, duration_s).unwrap();
    assert_eq!(all.iter().map(|at| at.hours).collect::<Vec<_>>(), [24.0, 72.0]);
    all[1]
}

#[test]
fn the_bound_of_the_largest_error_is_that_of_an_independent_program() {
    let golden = include_str!("../../../../fixtures/golden/design.json");
    let golden: serde_json::Value = serde_json::from_str(golden).unwrap();
    for (cell, golden) in CELLS.iter().zip(golden["cells"].as_array().unwrap()) {
        let number = |key: &str| golden[key].as_f64().unwrap();
        let expected = number("largest_bound_arcmin");
        let judge = judge(&cell.setup(Rotation::Tetrahedral), "longitude.largest");
        let found = bound(&judge, cell.duration_s()).unwrap();
        println!("{} ± {}, {expected}", found.value, found.sampling);
        assert!(found.sampling < 0.01 * found.value, "{found:?}");
        // Both are sampled. Points lie 200 s apart here and 120 s there: 0.3 % of an oscillation.
        let error = number("largest_bound_standard_error_arcmin").hypot(found.sampling);
        assert!(
            (found.value - expected).abs() < 3.0 * error + 0.003 * expected,
            "{cell:?} {} {expected} {error}",
            found.value
        );
    }
}

/// Cells, and the rms of the largest longitude error in 72 h by another program, arcmin: eight positions with
/// sixteen moves and with the tetrahedral scheme, and the bound.
fn expected() -> [(Cell, [f64; 3]); 6] {
    let other = Cell { g: 5e-3, arw: 7e-4, hours: 12, ..CELLS[0] };
    let last = Cell { g: 5e-4, arw: 1e-4, hours: 24, ..CELLS[0] };
    [
        (CELLS[1], [3.71, 2.75, 2.41]),
        (CELLS[2], [2.20, 1.49, 1.38]),
        (CELLS[0], [5.28, 4.46, 3.18]),
        (other, [2.35, 1.56, 1.40]),
        (CELLS[3], [1.70, 1.36, 1.32]),
        (last, [0.56, 0.29, 0.26]),
    ]
}

#[test]
fn largest_errors_are_those_of_another_program() {
    let mut sum = 0.0;
    for (cell, expected) in expected() {
        let [sixteen, tetrahedral] =
            [Rotation::Sixteen, Rotation::Tetrahedral].map(|rotation| cell.setup(rotation));
        let judge = judge(&sixteen, "longitude.largest");
        let found = [
            eight(&sixteen, cell.duration_s()).longitude_arcmin.value,
            eight(&tetrahedral, cell.duration_s()).longitude_arcmin.value,
            bound(&judge, cell.duration_s()).unwrap().value,
        ];
        println!("{} {}: {found:?} {expected:?}", cell.g, cell.hours);
        for (found, expected) in found.iter().zip(expected) {
            let part = found / expected - 1.0;
            println!("  {:+.1} %", 100.0 * part);
            // The other program's figures are plain means of draws, of a number that isn't known: a relative
            // standard error of 3 %, as of five hundred draws of one normal error, is what is allowed for.
            assert!(part.abs() < 3.0 * 0.03, "{cell:?} {found} {expected}");
            sum += part;
        }
    }
    // Of eighteen figures, not all independent.
    assert!((sum / 18.0).abs() < 0.03, "{sum}");
}

#[test]
fn of_one_error_alone_the_largest_is_that_of_the_closed_form() {
    // The isotropic part of G is a drift d = γ g about down. In a day it turns the latitude by
    // (d/Ω) cos L (1 − cos Ωt), at most 2 (d/Ω) cos L, beside Schuler oscillations of a part in hundred.
    let mut setup = CELLS[0].setup(Rotation::Tetrahedral);
    setup.conditions.platform.noise = (0.0, 0.0);
    let (gamma, diagonal) = (3e-9, [PARAMETERS + 12, PARAMETERS + 16, PARAMETERS + 20]);
    let mut start = Covariance::from_sigmas(&[0.0; STATE_COUNT]);
    for i in diagonal {
        for j in diagonal {
            start.rows_mut()[i][j] = gamma * gamma;
        }
    }
    let all = setup.largest().of(&start);
    let earth = &setup.conditions.platform.earth;
    let expected_rad = 2.0 * gamma * earth.gravity_mps2 / EARTH_RATE_RADPS * earth.cos_latitude;
    let expected = expected_rad / ARCMIN;
    for at in &all {
        println!("{} {expected} {}", at.hours, at.latitude_arcmin.value);
        assert!((at.latitude_arcmin.value / expected - 1.0).abs() < 0.02, "{at:?} {expected}");
    }
}

#[test]
fn designs_of_the_largest_error_are_ranked_by_it() {
    let cell = &CELLS[1];
    let setup = cell.setup(Rotation::Tetrahedral);
    let measure = DesignMeasure::named("longitude.largest").unwrap();
    let problem = SearchProblem::new(setup, measure, Limits::default(), 1).unwrap();
    let effort = SearchEffort { chains: 8, rounds: 4, steps: 20 };
    let found = problem.search(effort, 2, None, &mut |_, _, _| true).unwrap();
    let again = problem.search(effort, 1, None, &mut |_, _, _| true).unwrap();
    assert_eq!((&found.stops, found.score.to_bits()), (&again.stops, again.score.to_bits()));
    let mut judge = problem.judge();
    let bound = bound(&judge, cell.duration_s()).unwrap().value;
    let mut last = 0.0;
    assert!(!found.others.is_empty());
    for candidate in std::iter::once(&found).chain(&found.others) {
        let score = judge.score(&candidate.sequence, cell.duration_s()).unwrap();
        assert!((score / candidate.score - 1.0).abs() < 1e-12);
        // The same draws for both.
        assert!(score >= last && score > bound, "{score} {last} {bound}");
        last = score;
    }
    let eight = eight(&problem.setup, cell.duration_s()).longitude_arcmin.value;
    println!("{} {eight} {bound}", found.score);
    assert!(found.score < eight);
}
