//! Continuous rotation: above the bound, and no better than dwells.

use crate::cells::CELLS;
use octant_design::bound::bound;
use octant_design::candidate::{Gimbals, Limits};
use octant_design::measure::DesignMeasure;
use octant_design::search::{SearchEffort, SearchProblem};
use octant_design::setup::Rotation;

#[test]
fn continuous_rotation_is_no_better_than_dwells() {
    let cell = &CELLS[1];
    let setup = cell.setup(Rotation::Tetrahedral);
    let measure = DesignMeasure::named("longitude").unwrap();
    let problem = SearchProblem::new(setup, measure, Limits::default(), 1).unwrap();
    let effort = SearchEffort { chains: 8, rounds: 10, steps: 40 };
    let found = problem.search(effort, 2, None, &mut |_, _, _| true).unwrap();
    let bound = bound(&problem.judge(), cell.duration_s()).unwrap().value;
    let started = std::time::Instant::now();
    let continuous = problem.continuous(&found.sequence).unwrap();
    println!("{bound} {} {:?}", found.score, started.elapsed());
    for (what, all) in
        [("calibration", &continuous.calibration), ("navigation", &continuous.navigation)]
    {
        assert!(all.len() >= 12, "{what} {}", all.len());
        for one in all {
            println!("{what} {one:?}");
            // The part in thousand is that of the measurements in moves.
            assert!(one.score > 0.999 * bound, "{one:?} {bound}");
        }
        assert!(all[0].score > 0.999 * found.score, "{:?} {}", all[0], found.score);
    }
}

#[test]
fn one_gimbal_has_one_scheme() {
    let limits = Limits { gimbals: Gimbals::Azimuth, ..Limits::default() };
    let measure = DesignMeasure::named("sigma.g_zz").unwrap();
    let setup = CELLS[1].setup(Rotation::Sixteen);
    let problem = SearchProblem::new(setup, measure, limits, 1).unwrap();
    let effort = SearchEffort { chains: 2, rounds: 1, steps: 2 };
    let found = problem.search(effort, 1, None, &mut |_, _, _| true).unwrap();
    let continuous = problem.continuous(&found.sequence).unwrap();
    assert!(continuous.calibration.iter().all(|one| one.scheme == "azimuth"));
    assert!(!continuous.calibration.is_empty() && continuous.navigation.is_empty());
}
