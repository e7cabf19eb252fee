//! Known-answer tests: numbers of every part on which a report's figures are based, compared with
//! independent arithmetic.
//!
//! Each group computes its numbers here, in this process; the expected ones are in
//! `fixtures/golden`, with the script that made them. `tests/mutate-constants` changes a constant
//! of the program and checks that one of these tests detects it.

mod bridge;
mod campaign;
mod core;
mod defaults;
mod disturbance;
mod draws;
mod earth;
mod errors;
mod faults;
mod limits;
mod more;
mod navigation;
mod numbers;
mod plant;
mod procedure;
mod recovery;
mod scores;
mod statistics;
mod strapdown;
mod units;

use super::bench::CaseBench;
use super::case::{COMPUTED_LIMIT, Case};
use super::error::CaseSetupError;
use super::judge::{CaseOutcome, Expectation, Known};
use numbers::{Found, known};

fn outcome(numbers: Found) -> CaseOutcome {
    CaseOutcome { status: Some(0), numbers, ..CaseOutcome::default() }
}

fn computed(numbers: Result<Found, String>) -> Result<CaseOutcome, CaseSetupError> {
    Ok(outcome(numbers?))
}

fn case(
    id: &'static str,
    about: &'static str,
    known: Vec<Known>,
    source: &'static str,
    run: fn(&CaseBench<'_>) -> Result<CaseOutcome, CaseSetupError>,
) -> Case {
    let expectation = Expectation::Numbers { known, source };
    Case { id, about, expectation, limit: COMPUTED_LIMIT, run }
}

/// Whole runs with known numbers that take less than a second.
const QUICK_RUNS: [&str; 3] = ["g-dependent-drift", "observability", "posterior-sigma"];

/// Lists the cases that `octant selftest --answers` runs. No hash of our own output is among them.
#[must_use]
pub fn with_runs() -> Vec<Case> {
    let mut all = cases();
    all.extend(super::golden::cases().into_iter().filter(|case| QUICK_RUNS.contains(&case.id)));
    all
}

/// Lists the known-answer tests of every part.
#[must_use]
pub fn cases() -> Vec<Case> {
    vec![
        case(
            "answers-earth",
            "Radii, gravity, rates, rotations and closed forms of drift, at four latitudes.",
            known("earth"),
            "NIMA TR8350.2 and closed forms, in 40 digits by mpmath (golden/answers.py)",
            |_| Ok(outcome(earth::found())),
        ),
        case(
            "answers-units",
            "Every unit that a scenario can name, and those of the parameters.",
            known("units"),
            "what the units are defined as (golden/answers.py)",
            |_| computed(units::found()),
        ),
        case(
            "answers-draws",
            "Random words, normal numbers, an instrument, its alignment and a sea, drawn from seeds.",
            known("draws"),
            "vectors of Random123; ziggurat and spectra in 40 digits by mpmath (golden/answers.py)",
            |_| Ok(outcome(draws::found())),
        ),
        case(
            "answers-plant",
            "Counts, truth and reference of seven instruments that turn, sway, shake, warm up and lag.",
            known("plant"),
            "integrals of the derivatives of an Earth-fixed motion (golden/motion.py, golden/answers.py)",
            |_| computed(plant::found()),
        ),
        case(
            "answers-faults",
            "Counts under shock, vibration, jerk, sway, slip and ringing of known sizes; biases that wander \
             and references that are disturbed.",
            known("faults"),
            "integrals of the motions that the pages of the faults give (golden/harm.py)",
            |_| Ok(outcome(faults::found()?.into_iter().chain(errors::found()?).collect())),
        ),
        case(
            "answers-scores",
            "Maximum, rms, final value, slope and rate of known drifts, and the floor of the noise.",
            known("scores"),
            "sums over the same points, and matrix exponentials by mpmath (golden/answers.py)",
            |_| computed(scores::found()),
        ),
        case(
            "answers-campaign",
            "Bounds that a campaign of six runs states, where nobody asked for a confidence.",
            known("campaign"),
            "Clopper and Pearson (golden/answers.py)",
            campaign::found,
        ),
        case(
            "answers-core",
            "Limits of the core's screens, a corrected attitude, units of states, references.",
            known("core"),
            "formulas of their pages, by numpy and mpmath (golden/answers.py)",
            |_| computed(core::found()),
        ),
        case(
            "answers-defaults",
            "What a scenario has where nothing is given: site, sensors, table, ships.",
            known("defaults"),
            "the reference of scenarios and the paper's Table 1 (golden/answers.py)",
            |_| computed(defaults::found()),
        ),
        case(
            "answers-more-statistics",
            "Powers, ratios, distances in the plane, hypercubes and correlated draws.",
            known("more"),
            "scipy and mpmath (golden/answers.py)",
            |_| computed(more::found()),
        ),
        case(
            "answers-bridge",
            "Attitude and velocity through moves, with every sample and with some missing in the middle.",
            bridge::known(),
            "there is no error; steps of the encoders, and the coning of a sample without a predecessor",
            |_| computed(bridge::found()),
        ),
        case(
            "answers-strapdown",
            "Attitude, velocity and position after increments that no vehicle makes.",
            known("strapdown"),
            "the two-sample algorithm of Savage, 1998 (golden/answers.py)",
            |_| computed(strapdown::found()),
        ),
        case(
            "answers-filter",
            "The σ of all states after seconds and minutes at rest with a velocity a second.",
            known("filter"),
            "matrix exponentials of the system error model, by scipy (golden/answers.py)",
            |_| computed(recovery::rest()),
        ),
        case(
            "answers-navigation",
            "A perfect instrument navigates for an hour without error, leaning and on a ship.",
            navigation::known(),
            "there is no error; half a step of the output's position (2^-27 rad) on each axis, and what \
             two samples leave of a ship's coning and sculling",
            navigation::found,
        ),
        case(
            "answers-procedure",
            "The stops of the named sequences, and the dwells that a calibration time leaves for them.",
            known("procedure"),
            "the tables of docs/method.md (golden/answers.py)",
            |_| computed(procedure::found()),
        ),
        case(
            "answers-recovery",
            "How wide a recovery of the filter opens what, for how long, and how far it goes back.",
            known("recovery"),
            "the table of docs/method.md (golden/answers.py)",
            |_| computed(recovery::found()),
        ),
        case(
            "answers-limits",
            "Values on both sides of limits, a turn between two intervals, a disturbance at rest.",
            known("limits"),
            "docs/scenario.md and the pages of the core, by mpmath (golden/answers.py)",
            |_| {
                computed(
                    limits::found()
                        .and_then(|all| Ok(all.into_iter().chain(disturbance::found()?).collect())),
                )
            },
        ),
        case(
            "answers-statistics",
            "Bounds, quantiles, percentiles, tests, powers, radii and truncated distributions.",
            statistics::known(),
            "scipy and numpy (golden/statistics.py)",
            |_| computed(statistics::found()),
        ),
    ]
}
