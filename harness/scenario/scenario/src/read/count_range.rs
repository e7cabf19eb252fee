//! Increments against the range of their counts: a rate at which gravity or a turn of the gimbals doesn't fit into one
//! sample is refused before the run.

use crate::error::Problem;
use crate::keys::At;
use crate::model::{MotionSpec, Scenario, SourceSpec};
use octant_earth::ellipsoid::{EARTH_RATE_RADPS, Ellipsoid};
use octant_earth::units::DEG;
use octant_sample::counts::{DELTA_THETA_LSB_RAD, DELTA_VELOCITY_LSB_MPS};
use std::f64::consts::PI;

/// Largest increments of a sample, rad and m/s.
const RANGE_RAD: f64 = i32::MAX as f64 * DELTA_THETA_LSB_RAD;
const RANGE_MPS: f64 = i32::MAX as f64 * DELTA_VELOCITY_LSB_MPS;
/// Share of the range that motion may take: the rest is for the sensors' errors and noise.
const SHARE: f64 = 0.99;

/// Refuses a rate that is too low for the format of the counts.
pub(super) fn check(rate: &At<f64>, scenario: &Scenario) -> Result<(), Problem> {
    if matches!(scenario.source, SourceSpec::Solution(_)) {
        return Ok(());
    }
    let (turn_radps, force_mps2) = largest(scenario);
    let lowest_hz = (force_mps2 / RANGE_MPS).max(turn_radps / RANGE_RAD) / SHARE;
    if **rate >= lowest_hz {
        return Ok(());
    }
    let period_s = 1.0 / **rate;
    let mut found = Vec::new();
    if force_mps2 * period_s > SHARE * RANGE_MPS {
        found.push(format!(
            "the specific force of {force_mps2:.2} m/s^2 makes increments of {:.3} m/s, and a count holds {RANGE_MPS:.3} m/s",
            force_mps2 * period_s
        ));
    }
    if turn_radps * period_s > SHARE * RANGE_RAD {
        found.push(format!(
            "a turn at {:.3} deg/s makes increments of {:.3} deg, and a count holds {:.3} deg",
            turn_radps / DEG,
            turn_radps * period_s / DEG,
            RANGE_RAD / DEG
        ));
    }
    // A rate has a period of whole nanoseconds.
    let works = (1..=10_000u32).find(|hz| f64::from(*hz) >= lowest_hz && 1_000_000_000 % hz == 0);
    let expected = works.map_or_else(
        || "slower motion: no rate is high enough".to_owned(),
        |hz| format!("\"{hz} Hz\" or more"),
    );
    Err(rate.problem(format!("found {:?}: {}; expected {expected}", rate.text, found.join("; "))))
}

/// Largest rate of turn about an axis, rad/s, and largest specific force, m/s²: of a source that isn't simulated gravity
/// alone is known.
fn largest(scenario: &Scenario) -> (f64, f64) {
    let gravity = Ellipsoid::at(scenario.site.latitude_rad, scenario.site.height_m).gravity_mps2;
    if !matches!(scenario.source, SourceSpec::Plant) {
        return (0.0, gravity);
    }
    let rotates =
        |plan: &octant_calibration::config::NavigationPlan| plan.rotation.stops().len() > 1;
    let turns = scenario.calibration.is_some() || scenario.navigation.as_ref().is_some_and(rotates);
    let gimbals = if turns { scenario.turntable.rate_radps } else { 0.0 };
    let (ship_radps, ship_mps2) = match &scenario.motion {
        MotionSpec::Static(_) => (0.0, 0.0),
        MotionSpec::Dockside(ship) => {
            let sum = |motions: std::ops::Range<usize>, order: i32| -> f64 {
                let parts = ship.components[motions].iter().flatten();
                parts
                    .map(|part| part.amplitude.abs() * (2.0 * PI / part.period_s).powi(order))
                    .sum()
            };
            (sum(0..3, 1), sum(3..6, 2))
        }
    };
    (gimbals + ship_radps + EARTH_RATE_RADPS, gravity + ship_mps2)
}

#[cfg(test)]
mod tests {
    use crate::Scenario;
    use std::path::Path;

    fn said(toml: &str) -> Option<String> {
        let text = format!("schema = 1\n{toml}");
        Scenario::parse(&text, "r.toml", Path::new(""), &[]).err().map(|error| error.to_string())
    }

    /// A count of 32 bits is 2⁻³⁰ m/s and 2⁻³⁶ rad: 2 m/s and 1.79°.
    #[test]
    fn a_rate_at_which_gravity_or_a_turn_exceeds_a_count_is_refused_with_the_lowest_that_works() {
        let calibrates =
            |rate: &str| said(&format!("imu.rate = \"{rate}\"\n[procedure.calibration]\n"));
        for rate in ["1 Hz", "2 Hz", "4 Hz", "5 Hz"] {
            let said = calibrates(rate).unwrap();
            assert!(
                said.contains("imu.rate") && said.contains("expected \"8 Hz\" or more"),
                "{said}"
            );
            assert!(said.contains("and a count holds 1.790 deg"), "{said}");
        }
        let four = calibrates("4 Hz").unwrap();
        // 9.79 m/s² over a quarter of a second; 10 °/s over it.
        assert!(four.contains("increments of 2.448 m/s, and a count holds 2.000 m/s"), "{four}");
        assert!(four.contains("increments of 2.501 deg"), "{four}");
        // At 5 Hz gravity fits and the turn doesn't.
        let five = calibrates("5 Hz").unwrap();
        assert!(
            !five.contains("specific force") && five.contains("increments of 2.001 deg"),
            "{five}"
        );
        assert_eq!(calibrates("8 Hz"), None);
        assert_eq!(calibrates("200 Hz"), None);
    }

    #[test]
    fn what_does_not_turn_needs_no_room_for_turns() {
        let stands = "[procedure.navigation]\nduration = \"1 h\"\nrotation = \"none\"\n";
        assert_eq!(said(&format!("imu.rate = \"5 Hz\"\n{stands}")), None);
        assert!(
            said(&format!("imu.rate = \"4 Hz\"\n{stands}")).unwrap().contains("\"5 Hz\" or more")
        );
        // 300 °/s need 168 Hz and more.
        let fast =
            "imu.rate = \"100 Hz\"\nturntable.rate = \"300 deg/s\"\n[procedure.calibration]\n";
        assert!(said(fast).unwrap().contains("\"200 Hz\" or more"));
    }
}
