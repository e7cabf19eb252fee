//! The bound: against an independent computation, alike in every attitude, and below every sequence.

use crate::cells::CELLS;
use octant_calibration::positions::{SEQUENCES, from_degrees};
use octant_calibration::sequence::{Sequence, Stop};
use octant_design::bound::{LEFT, bound, known_but_isotropic};
use octant_design::judge::{Judge, MeasureWeights};
use octant_design::measure::DesignMeasure;
use octant_design::setup::{Rotation, Setup};
use octant_earth::units::DEG;
use octant_random::normal::words;
use octant_random::stream::{Phase, key};

fn longitude(setup: &Setup) -> Judge {
    let measure = DesignMeasure::named("longitude").unwrap();
    Judge::new(setup, &MeasureWeights::new(setup, measure).unwrap())
}

/// Draws a sequence of up to forty stops anywhere within a turn, with shares from 1 to 50.
fn drawn(number: u64) -> Sequence {
    let key = key(7, "random sequences", Phase::Draw);
    let mut place = number * 64;
    let mut draw = |below: u64| {
        place += 1;
        words(key, place)[0] % below
    };
    let count = 1 + draw(40);
    let mut stop = || Stop {
        azimuth_rad: (draw(721) as f64 - 360.0) * DEG,
        roll_rad: (draw(721) as f64 - 360.0) * DEG,
        weight: (1 + draw(50)) as f64,
    };
    Sequence::new(&(0..count.min(20)).map(|_| stop()).collect::<Vec<_>>(), 1).unwrap()
}

#[test]
fn the_bound_is_that_of_independent_programs() {
    let golden = include_str!("../../../../fixtures/golden/design.json");
    let golden: serde_json::Value = serde_json::from_str(golden).unwrap();
    for (cell, golden) in CELLS.iter().zip(golden["cells"].as_array().unwrap()) {
        assert_eq!(golden["g_dependent_deg_per_hour_per_g"], cell.g);
        assert_eq!(golden["angle_random_walk_deg_per_sqrt_hour"], cell.arw);
        assert_eq!(golden["calibration_h"], cell.hours);
        let expected = golden["bound_arcmin"].as_f64().unwrap();
        for rotation in [Rotation::Sixteen, Rotation::Tetrahedral] {
            let found = bound(&longitude(&cell.setup(rotation)), cell.duration_s()).unwrap();
            println!("{rotation:?} {:.5} {expected:.5} {}", found.value, cell.bound);
            // 0.2 %: a Schuler oscillation's growth by sub-steps.
            assert!((found.value / expected - 1.0).abs() < 0.002, "{cell:?} {}", found.value);
            assert!((found.value / cell.bound - 1.0).abs() < 0.02, "{cell:?} {}", found.value);
        }
    }
}

#[test]
fn the_certificate_gives_the_bound() {
    let cell = &CELLS[3];
    let found = bound(&longitude(&cell.setup(Rotation::Tetrahedral)), cell.duration_s()).unwrap();
    let mut square = found.noise;
    for i in 0..LEFT {
        for j in 0..LEFT {
            square += found.weights[i][j] * found.covariance[i][j];
        }
    }
    assert!((square.sqrt() - found.value).abs() < 1e-12 * found.value);
    assert_eq!(found.errors.len(), LEFT);
}

#[test]
fn with_all_else_known_every_attitude_history_is_alike() {
    let cell = &CELLS[1];
    let setup = cell.setup(Rotation::Sixteen);
    let judge = longitude(&setup);
    let expected = bound(&judge, cell.duration_s()).unwrap().value;
    let mut knowing = judge.from_initial(known_but_isotropic(&setup.conditions.initial));
    let published = SEQUENCES.iter().map(|(_, stops, _)| from_degrees(stops, 1).unwrap());
    for sequence in published.chain((0..20).map(drawn)) {
        let found = knowing.score(&sequence, cell.duration_s()).unwrap();
        // Measurements in moves stand at the ends of parts of 5 s.
        assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
    }
}

#[test]
fn no_random_sequence_lies_below_the_bound() {
    for (cell, count) in [(&CELLS[1], 500), (&CELLS[5], 500)] {
        let setup = cell.setup(Rotation::Tetrahedral);
        let mut judge = longitude(&setup);
        let bound = bound(&judge, cell.duration_s()).unwrap().value;
        let mut least = f64::INFINITY;
        let started = std::time::Instant::now();
        for number in 0..count {
            if let Ok(found) = judge.score(&drawn(number), cell.duration_s()) {
                least = least.min(found);
                assert!(found > bound, "{number}: {found} {bound}");
            }
        }
        println!("{bound:.4} {least:.4} {:?}", started.elapsed());
        assert!(least.is_finite());
    }
}
