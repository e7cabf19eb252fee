//! Heading test, and the parts of the scenario that have to fit it.

use crate::error::Problem;
use crate::keys::{At, HeadingTestKeys, ScenarioKeys};
use crate::model::{
    EndpointSpec, HeadingTestKind, HeadingTestSpec, MotionSpec, Scenario, SourceSpec,
};

/// Reads the heading test.
pub(super) fn spec(keys: &At<Option<HeadingTestKeys>>) -> Option<HeadingTestSpec> {
    keys.as_ref().map(|keys| HeadingTestSpec {
        test: *keys.test,
        run_ups: *keys.run_ups,
        off_s: keys.off,
        resolution_rad: *keys.resolution,
    })
}

/// Checks that the scenario has what the test needs.
pub(super) fn check(keys: &ScenarioKeys, scenario: &Scenario) -> Result<(), Problem> {
    let Some(test) = keys.procedure.heading_test.as_ref() else { return Ok(()) };
    let of_table = &keys.procedure.heading_test;
    if scenario.baseline.is_some() {
        return Err(of_table.problem(
            "found beside [baseline], expected a scenario of its own: one unit is tested",
        ));
    }
    if scenario.run_up_samples().is_none() {
        return Err(of_table.problem(
            "found with a navigation without a duration, expected procedure.navigation.duration, with which a run-up ends",
        ));
    }
    let span = match &scenario.motion {
        MotionSpec::Static(_) => None,
        MotionSpec::Dockside(ship) => Some(ship.span),
    };
    let name = &test.test.text;
    match (*test.test, span) {
        (HeadingTestKind::Settle, Some(_)) => {
            return Err(test.test.problem(format!(
                "found {name:?} with motion.kind = \"dockside\", expected \"static\": it is a test at rest"
            )));
        }
        (HeadingTestKind::Settle, None) | (HeadingTestKind::SettleInMotion, Some(_)) => {}
        (_, None) => {
            return Err(test.test.problem(format!(
                "found {name:?} with motion.kind = \"static\", expected \"dockside\" with [motion.ship], the motion of the \
                 table"
            )));
        }
        (_, Some(span)) => {
            let whole = span.is_some_and(|span| span.from_s > 0.0 && span.duration_s.is_some());
            if !whole {
                return Err(test.test.problem(format!(
                    "found {name:?} with a motion from the start or to the end, expected motion.ship.from and \
                     motion.ship.duration: the unit settles at rest before it"
                )));
            }
        }
    }
    if test.test_ends_late(scenario) {
        return Err(test.test.problem(format!(
            "found {name:?} with a motion of the table that ends after the run-up, expected a longer \
             procedure.navigation.duration"
        )));
    }
    if matches!(scenario.source, SourceSpec::Solution(_)) {
        return Ok(());
    }
    if test.azimuths.is_some() {
        return Err(test.azimuths.problem(
            "found without a solution as the source, expected source.uri = \"solution:…\": another unit's heading is motion.heading",
        ));
    }
    if *test.run_ups > 1 {
        let in_process = matches!(scenario.endpoint, EndpointSpec::InProcess);
        if !(scenario.source.is_plant_alone() && in_process) {
            return Err(test.run_ups.problem(format!(
                "found {}, expected 1 unless source and unit are simulated in this process (source.uri = \"plant\", \
                 endpoint.uri = \"in-process\")",
                *test.run_ups
            )));
        }
    }
    Ok(())
}

impl HeadingTestKeys {
    /// True if the table still moves when the run-up ends, in a test that reads the heading after it stopped.
    fn test_ends_late(&self, scenario: &Scenario) -> bool {
        let MotionSpec::Dockside(ship) = &scenario.motion else { return false };
        let end_s = ship.span.and_then(|span| span.from_to_s().1);
        let period_s = scenario.sample_period_ns as f64 * 1e-9;
        let run_up_s = scenario.run_up_samples().map(|samples| samples as f64 * period_s);
        let reads_after =
            !matches!(*self.test, HeadingTestKind::Dynamic | HeadingTestKind::SettleInMotion);
        reads_after && end_s.zip(run_up_s).is_some_and(|(end_s, run_up_s)| end_s >= run_up_s)
    }
}
