//! Keys of a scenario that follow from the file of a solution.

use crate::failure::Failure;
use octant_scenario::Scenario;
use octant_scenario::trajectory::SolutionSpec;
use octant_trajectory::{TrajectorySurvey, point::SECOND_NS};
use std::f64::consts::{PI, TAU};

/// Keys that follow from the file of a solution: the rate of its points, and where it begins.
pub(crate) fn keys_of_solution(
    scenario: &Scenario,
    spec: &SolutionSpec,
) -> Result<Vec<String>, Failure> {
    let file = spec.solution.file.path(&scenario.folder).map_err(Failure::input)?;
    let survey = TrajectorySurvey::of(&file, &spec.solution.format).map_err(Failure::input)?;
    if survey.period_ns > SECOND_NS {
        return Err(Failure::input(format!(
            "{}: its points are {} s apart, expected 1 s or less",
            file.display(),
            octant_base::number::plain(survey.period_ns as f64 * 1e-9, 9)
        )));
    }
    // Readings of a heading test have their own times, which no rate gives.
    let is_test = scenario.heading_test.is_some();
    let period_ns = if is_test { SECOND_NS } else { survey.period_ns };
    // With all digits, so that the period comes out as the whole number of ns that it is.
    let rate = format!("{}", 1e9 / period_ns as f64);
    let deg = |rad: f64| format!("{:.9} deg", rad.to_degrees());
    let mut found = vec![format!("imu.rate={rate} Hz"), format!("record.rate={rate} Hz")];
    if let Some(first) = survey.first.position {
        found.extend([
            format!("site.latitude={}", deg(first.latitude_rad)),
            // Files may count from 0 to 360°, the scenario from -180 to 180.
            format!("site.longitude={}", deg((first.longitude_rad + PI).rem_euclid(TAU) - PI)),
            format!("site.height={:.3} m", first.height_m),
        ]);
    }
    Ok(found)
}
