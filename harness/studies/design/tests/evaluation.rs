//! The fast evaluation against the full recursion, and against figures of another program.

use crate::cells::{CELLS, Cell};
use octant_calibration::config::Estimator;
use octant_calibration::covariance::{Covariance, PARAMETERS, STATE_COUNT};
use octant_calibration::filter::prior_sigmas;
use octant_calibration::positions::{SEQUENCES, from_degrees, named};
use octant_calibration::sequence::{Sequence, Stop};
use octant_design::evaluate::Evaluator;
use octant_design::judge::{Judge, MeasureWeights};
use octant_design::measure::DesignMeasure;
use octant_design::setup::{Rotation, Setup};
use octant_earth::ellipsoid::Ellipsoid;
use octant_earth::units::DEG;
use octant_observe::covariance::arcmin_m;

/// Allowed difference of a measure from the full recursion: times of measurements are simplified.
const PART: f64 = 0.01;

fn judge(setup: &Setup, name: &str) -> Judge {
    Judge::new(setup, &MeasureWeights::new(setup, DesignMeasure::named(name).unwrap()).unwrap())
}

/// Root mean square of the longitude error over hours 69 to 72 by the full recursion, arcmin.
fn observed_rms72(setup: &Setup, sequence: &Sequence, duration_s: f64) -> f64 {
    let predicted = setup.observe(sequence, duration_s).unwrap();
    let earth = Ellipsoid::at(setup.config.site.latitude_rad, setup.config.site.height_m);
    let last: Vec<f64> = predicted
        .drift
        .iter()
        .filter(|at| at.hours > 69.0 - 1e-6)
        .map(|at| at.variances_m2[1] + at.mean_m[1] * at.mean_m[1])
        .collect();
    (last.iter().sum::<f64>() / last.len() as f64).sqrt() / arcmin_m(&earth)[1]
}

fn own(stops: &[(f64, f64, f64)]) -> Sequence {
    let stop = |&(azimuth, roll, weight): &(f64, f64, f64)| Stop {
        azimuth_rad: azimuth * DEG,
        roll_rad: roll * DEG,
        weight,
    };
    Sequence::new(&stops.iter().map(stop).collect::<Vec<_>>(), 1).unwrap()
}

fn prior(setup: &Setup) -> Covariance {
    let calibration = setup.config.calibration.as_ref().unwrap();
    let Estimator::Kalman(kalman) = &calibration.estimator else { panic!("{calibration:?}") };
    Covariance::from_sigmas(&prior_sigmas(kalman))
}

#[test]
fn the_covariance_is_that_of_the_full_recursion() {
    let cell: &Cell = &CELLS[1];
    let setup = cell.setup(Rotation::Sixteen);
    let mut judge = judge(&setup, "longitude");
    let mut exact = setup.clone();
    (exact.conditions.initial, exact.conditions.part_s) = (prior(&setup), 1.0);
    let mut filter = Evaluator::new(exact.conditions);
    let odd = own(&[
        (0.0, 0.0, 1.0),
        (37.0, -61.0, 2.5),
        (211.0, 140.0, 0.4),
        (-95.0, 140.0, 3.0),
        (-95.0, -20.0, 1.0),
        (180.0, 77.0, 1.7),
        (0.0, 12.0, 0.9),
    ]);
    let thrice = from_degrees(named("six").unwrap(), 3).unwrap();
    let all = SEQUENCES.iter().map(|(_, stops, _)| from_degrees(stops, 1).unwrap());
    for sequence in all.chain([odd, thrice]) {
        // The filter's own covariance, from its own prior.
        let full = setup.observe(&sequence, cell.duration_s()).unwrap();
        let fast = filter.calibrate(&sequence, cell.duration_s()).unwrap();
        for state in (0..6).chain(PARAMETERS..STATE_COUNT) {
            let (expected, found) = (full.believed.sigma(state), fast.sigma(state));
            // The velocity at the very end depends on the time of the last measurement, which can be most of
            // a second off.
            let part = if (3..6).contains(&state) { 3.0 * PART } else { PART };
            assert!((found / expected - 1.0).abs() < part, "{state}: {found} {expected}");
        }
        let expected = observed_rms72(&setup, &sequence, cell.duration_s());
        let found = judge.score(&sequence, cell.duration_s()).unwrap();
        println!("{found:.4} {expected:.4}");
        assert!((found / expected - 1.0).abs() < PART, "{found} {expected}");
    }
}

#[test]
fn eight_positions_are_as_another_program_says() {
    for cell in CELLS {
        let setup = cell.setup(Rotation::Sixteen);
        let mut judge = judge(&setup, "longitude");
        for (name, expected) in [("eight", cell.eight), ("eight-level", cell.level)] {
            let sequence = from_degrees(named(name).unwrap(), 1).unwrap();
            let found = judge.score(&sequence, cell.duration_s()).unwrap();
            assert!((found / expected - 1.0).abs() < 0.025, "{cell:?} {name} {found}");
        }
    }
}

/// A moored ship: what the filter takes for white noise of the dock's position is the ship's sway.
const DOCKSIDE: &str = "[motion]\nkind = \"dockside\"\n[motion.ship]\npreset = \"default\"\n\
    [procedure.calibration.aiding]\nreference = \"dock-position\"\n";

#[test]
fn dockside_the_covariance_is_that_of_the_full_recursion() {
    let cell: &Cell = &CELLS[1];
    let setup = Setup::of(&cell.scenario(DOCKSIDE)).unwrap();
    let mut judge = judge(&setup, "longitude");
    let mut exact = setup.clone();
    (exact.conditions.initial, exact.conditions.part_s) = (prior(&setup), 1.0);
    let mut filter = Evaluator::new(exact.conditions);
    for name in ["six", "eight", "eight-level", "nineteen"] {
        let sequence = from_degrees(named(name).unwrap(), 1).unwrap();
        let full = setup.observe(&sequence, cell.duration_s()).unwrap();
        let fast = filter.calibrate(&sequence, cell.duration_s()).unwrap();
        for state in (0..3).chain(PARAMETERS..STATE_COUNT) {
            let (expected, found) = (full.believed.sigma(state), fast.sigma(state));
            println!("{name} {state} {:+.2} %", 100.0 * (found / expected - 1.0));
            assert!((found / expected - 1.0).abs() < PART, "{state}: {found} {expected}");
        }
        // The drift of the true errors, with the sway as it is.
        let expected = observed_rms72(&setup, &sequence, cell.duration_s());
        let found = judge.score(&sequence, cell.duration_s()).unwrap();
        println!("{name} {found:.4} {expected:.4}");
        assert!((found / expected - 1.0).abs() < PART, "{found} {expected}");
    }
}
